//! Conversion between bytes and the 64-bit words of a message.

/// Packs `bytes` into words, preceded by the number of bytes.
pub fn words_of(bytes: &[u8]) -> Vec<u64> {
    let mut words = vec![bytes.len() as u64];
    words.extend(bytes.chunks(8).map(|c| {
        let mut word = [0; 8];
        word[..c.len()].copy_from_slice(c);
        u64::from_le_bytes(word)
    }));
    words
}

/// Recovers the bytes from `words` that [`words_of`] has packed.
pub fn bytes_of(words: &[u64]) -> Vec<u8> {
    let Some((&length, words)) = words.split_first() else { return Vec::new() };
    let mut bytes: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
    bytes.truncate(length as usize);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_come_back() {
        for length in 0..20u8 {
            let bytes: Vec<u8> = (0..length).collect();
            assert_eq!(bytes_of(&words_of(&bytes)), bytes);
        }
        assert_eq!(bytes_of(&[]), []);
    }
}
