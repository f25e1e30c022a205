//! Digest of the whole state of the particles that does not depend on their order, so that each rank
//! digests its own particles.

use decomp::Comm;
use sha2::{Digest, Sha256};

/// Sum over particles of the SHA-256 of each, as a number of 256 bits, modulo 2^256. Equal states
/// have equal sums in any order and on any ranks; a particle that is lost, doubled or changed changes
/// the sum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StateDigest {
    /// Digits of 32 bits, the lowest first.
    limbs: [u64; 8],
}

impl StateDigest {
    /// Adds particles: id and columns of each, as little-endian bytes.
    pub fn add(&mut self, ids: &[u64], columns: &[&[f64]]) {
        let mut bytes = vec![0; 8 * (1 + columns.len())];
        for (r, id) in ids.iter().enumerate() {
            bytes[..8].copy_from_slice(&id.to_le_bytes());
            for (bytes, column) in bytes[8..].chunks_exact_mut(8).zip(columns) {
                bytes.copy_from_slice(&column[r].to_le_bytes());
            }
            let digest: [u8; 32] = Sha256::digest(&bytes).into();
            self.add_number(
                digest.as_chunks::<4>().0.iter().map(|&b| u64::from(u32::from_le_bytes(b))),
            );
        }
    }

    /// Adds a number of 256 bits, given by its digits.
    fn add_number(&mut self, digits: impl Iterator<Item = u64>) {
        let mut carry = 0;
        for (limb, digit) in self.limbs.iter_mut().zip(digits) {
            let sum = *limb + digit + carry;
            (*limb, carry) = (sum & u64::from(u32::MAX), sum >> 32);
        }
    }

    /// The digest of the particles of all ranks. Collective.
    pub fn over_ranks(self, comm: &dyn Comm) -> StateDigest {
        // digits of 32 bits leave room for the sum over 2^31 ranks
        let mut sums = self.limbs.map(|limb| limb as i64);
        comm.sum(&mut sums);
        let mut all = StateDigest::default();
        let mut carry = 0;
        for (limb, sum) in all.limbs.iter_mut().zip(sums) {
            let sum = sum as u64 + carry;
            (*limb, carry) = (sum & u64::from(u32::MAX), sum >> 32);
        }
        all
    }

    /// The number in hexadecimal, 64 digits, the lowest byte first.
    pub fn to_hexadecimal(self) -> String {
        let bytes = self.limbs.iter().flat_map(|&limb| (limb as u32).to_le_bytes());
        bytes.map(|b| format!("{b:02x}")).collect()
    }
}

#[cfg(test)]
mod tests {
    use decomp::comm::local::run_ranks;

    use super::*;

    fn digest(ids: &[u64], columns: &[&[f64]]) -> StateDigest {
        let mut digest = StateDigest::default();
        digest.add(ids, columns);
        digest
    }

    #[test]
    fn one_particle_has_the_digest_of_its_bytes() {
        let bytes = [7u64.to_le_bytes(), 0.5f64.to_le_bytes(), (-0.0f64).to_le_bytes()].concat();
        let expected: String = Sha256::digest(&bytes).iter().map(|b| format!("{b:02x}")).collect();
        assert_eq!(digest(&[7], &[&[0.5], &[-0.0]]).to_hexadecimal(), expected);
        assert_ne!(digest(&[7], &[&[0.5], &[0.0]]).to_hexadecimal(), expected);
        assert_eq!(StateDigest::default().to_hexadecimal(), "0".repeat(64));
    }

    #[test]
    fn order_and_ranks_do_not_matter() {
        let ids: Vec<u64> = (0..700).map(|k| 3 * k).collect();
        let values: Vec<f64> = (0..700).map(|k| 0.1 * f64::from(k)).collect();
        let whole = digest(&ids, &[&values]);
        let back = |all: &[u64]| all.iter().rev().copied().collect::<Vec<_>>();
        let turned: Vec<f64> = values.iter().rev().copied().collect();
        assert_eq!(digest(&back(&ids), &[&turned]), whole);
        for ranks in [1, 3] {
            let sums = run_ranks(ranks, |comm| {
                let mine = |k: &usize| k % ranks == comm.rank();
                let which: Vec<usize> = (0..700).filter(mine).collect();
                let ids: Vec<u64> = which.iter().map(|&k| ids[k]).collect();
                let values: Vec<f64> = which.iter().map(|&k| values[k]).collect();
                digest(&ids, &[&values]).over_ranks(comm)
            });
            assert!(sums.iter().all(|sum| *sum == whole));
        }
        // lost, doubled, or with the values of two particles exchanged
        assert_ne!(digest(&ids[1..], &[&values[1..]]), whole);
        assert_ne!(
            digest(&[&ids[..], &ids[..1]].concat(), &[&[&values[..], &values[..1]].concat()]),
            whole
        );
        let mut exchanged = values.clone();
        exchanged.swap(3, 4);
        assert_ne!(digest(&ids, &[&exchanged]), whole);
    }
}
