//! Runs of nodes that are contiguous in two arrays.

/// Nodes that are contiguous in the source array and in the target array.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    pub from: u32,
    pub to: u32,
    pub length: u32,
    /// Whether the source is read backwards, starting with its last node (at `from`).
    pub reversed: bool,
}

impl Run {
    /// Indices in the source array, in reading order.
    pub fn sources(self) -> impl Iterator<Item = usize> {
        let place = move |k: u32| if self.reversed { self.from - k } else { self.from + k };
        (0..self.length).map(move |k| place(k) as usize)
    }

    /// Indices in the target array.
    pub fn targets(self) -> std::ops::Range<usize> {
        self.to as usize..(self.to + self.length) as usize
    }
}

/// Merges pairs of indices into runs.
pub(crate) fn runs(pairs: impl Iterator<Item = (u32, u32)>, reversed: bool) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for (from, to) in pairs {
        if let Some(last) = runs.last_mut() {
            let next = if reversed {
                last.from.checked_sub(last.length)
            } else {
                Some(last.from + last.length)
            };
            if next == Some(from) && last.to + last.length == to {
                last.length += 1;
                continue;
            }
        }
        runs.push(Run { from, to, length: 1, reversed });
    }
    runs
}
