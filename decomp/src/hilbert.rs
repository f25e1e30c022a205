//! Hilbert curve over a box of patches. Neighbours on the curve are neighbours in space, so
//! sections of the curve are compact groups of patches.
//!
//! The curve runs through the smallest cube with a power-of-two edge that contains the box (the
//! transposed form of J. Skilling (2004), "Programming the Hilbert curve"), and leaves out places
//! outside of the box. It is followed from the whole cube into ever smaller ones. Position and place
//! of a patch follow from each other in a number of steps of the order of the logarithm of the edge,
//! without a table.

/// Passage of the curve through a cube.
#[derive(Clone, Copy, Debug)]
struct Passage<const D: usize> {
    /// Direction of the box for each direction of the curve, and whether it is inverted.
    axes: [(usize, bool); D],
    /// Whether the parts of the cube are counted backwards.
    reversed: bool,
}

impl<const D: usize> Passage<D> {
    fn whole() -> Self {
        Passage { axes: std::array::from_fn(|a| (a, false)), reversed: false }
    }

    /// The part `number` of the 2^D halves in each direction, in the order of the curve: whether it is
    /// the upper half in each direction.
    fn part(&self, number: usize) -> [bool; D] {
        let (mut halves, mut before) = ([false; D], false);
        for (i, (axis, inverted)) in self.axes.into_iter().enumerate() {
            let gray = (number >> (D - 1 - i) & 1 == 1) != self.reversed;
            halves[axis] = (gray != before) != inverted;
            before = gray;
        }
        halves
    }

    /// Number of the part with these halves; the inverse of [`part`](Self::part).
    fn number(&self, halves: [bool; D]) -> usize {
        let (mut number, mut gray) = (0, false);
        for (axis, inverted) in self.axes {
            gray ^= halves[axis] != inverted;
            number = number << 1 | usize::from(gray != self.reversed);
        }
        number
    }

    /// The passage through the part with these halves.
    fn within(mut self, halves: [bool; D]) -> Self {
        let upper = self.axes.map(|(axis, inverted)| halves[axis] != inverted);
        for (i, upper) in upper.into_iter().enumerate() {
            match upper {
                true => self.axes[0].1 = !self.axes[0].1,
                false => self.axes.swap(0, i),
            }
            // the Gray code of the last direction
            self.reversed ^= upper;
        }
        self
    }
}

/// A cube of places, and the passage of the curve through it.
#[derive(Clone, Copy, Debug)]
struct Cube<const D: usize> {
    corner: [usize; D],
    edge: usize,
    passage: Passage<D>,
}

impl<const D: usize> Cube<D> {
    /// The smallest cube around the box `parts`.
    fn around(parts: [usize; D]) -> Self {
        let longest = parts.iter().copied().max().unwrap_or(1);
        Cube { corner: [0; D], edge: longest.next_power_of_two(), passage: Passage::whole() }
    }

    /// The part with these halves.
    fn within(&self, halves: [bool; D]) -> Self {
        let edge = self.edge / 2;
        let corner = std::array::from_fn(|a| self.corner[a] + if halves[a] { edge } else { 0 });
        Cube { corner, edge, passage: self.passage.within(halves) }
    }

    /// The 2^D halves in each direction, in the order of the curve.
    fn parts(self) -> impl Iterator<Item = Self> {
        (0..1 << D).map(move |number| self.within(self.passage.part(number)))
    }

    /// Number of places that are in the box `parts`.
    fn count(&self, parts: [usize; D]) -> usize {
        (0..D).map(|a| parts[a].saturating_sub(self.corner[a]).min(self.edge)).product()
    }

    fn walk(self, parts: [usize; D], take: &mut dyn FnMut([usize; D])) {
        match self.count(parts) {
            0 => {}
            1 if self.edge == 1 => take(self.corner),
            _ => self.parts().for_each(|part| part.walk(parts, take)),
        }
    }
}

/// Position on the curve of `place` in a box with `parts` entries per direction.
pub(crate) fn position<const D: usize>(parts: [usize; D], place: [usize; D]) -> usize {
    let (mut cube, mut before) = (Cube::around(parts), 0);
    while cube.edge > 1 {
        let middle = cube.corner.map(|c| c + cube.edge / 2);
        let halves = std::array::from_fn(|a| place[a] >= middle[a]);
        let number = cube.passage.number(halves);
        before += cube.parts().take(number).map(|part| part.count(parts)).sum::<usize>();
        cube = cube.within(halves);
    }
    before
}

/// Place at a position on the curve; the inverse of [`position`].
pub(crate) fn place_at<const D: usize>(parts: [usize; D], mut position: usize) -> [usize; D] {
    let mut cube = Cube::around(parts);
    while cube.edge > 1 {
        let has_it = |part: &Cube<D>| {
            let count = part.count(parts);
            let there = position < count;
            position -= if there { 0 } else { count };
            there
        };
        cube = cube.parts().find(has_it).expect("a position of the box");
    }
    cube.corner
}

/// Calls `take` with each place of a box with `parts` entries per direction, along the curve.
pub(crate) fn walk<const D: usize>(parts: [usize; D], take: &mut dyn FnMut([usize; D])) {
    Cube::around(parts).walk(parts, take);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places<const D: usize>(parts: [usize; D]) -> Vec<[usize; D]> {
        let mut all = Vec::new();
        walk(parts, &mut |place| all.push(place));
        all
    }

    /// Position on the curve through a cube of 2^`bits` in each direction, as Skilling gives it.
    fn skilling<const D: usize>(mut x: [usize; D], bits: u32) -> usize {
        // undo the excess work of the inverse transform (Skilling's AxestoTranspose)
        for q in (1..bits).rev().map(|b| 1 << b) {
            let p = q - 1;
            for i in 0..D {
                if x[i] & q != 0 {
                    x[0] ^= p;
                } else {
                    let t = (x[0] ^ x[i]) & p;
                    x[0] ^= t;
                    x[i] ^= t;
                }
            }
        }
        // Gray code
        for i in 1..D {
            x[i] ^= x[i - 1];
        }
        let ones = (1..bits).map(|b| 1 << b).filter(|q| x[D - 1] & q != 0);
        let t = ones.fold(0, |t, q| t ^ (q - 1));
        x.iter_mut().for_each(|x| *x ^= t);
        // interleave the bits of all directions, the highest first
        (0..bits).rev().flat_map(|b| x.map(|x| x >> b & 1)).fold(0, |h, bit| h << 1 | bit)
    }

    #[test]
    fn the_curve_is_that_of_skilling_without_the_places_outside_of_the_box() {
        for parts in [[1usize, 1], [2, 2], [5, 3], [1, 9], [7, 7], [8, 16], [33, 20]] {
            let bits = parts[0].max(parts[1]).next_power_of_two().ilog2();
            let mut expected: Vec<[usize; 2]> =
                (0..parts[0] * parts[1]).map(|p| [p % parts[0], p / parts[0]]).collect();
            expected.sort_by_key(|&place| skilling(place, bits));
            assert_eq!(places(parts), expected, "{parts:?}");
        }
        let mut cube: Vec<[usize; 3]> = (0..512).map(|p| [p % 8, p / 8 % 8, p / 64]).collect();
        cube.sort_by_key(|&place| skilling(place, 3));
        assert_eq!(places([8, 8, 8]), cube);
    }

    #[test]
    fn position_and_place_follow_from_each_other() {
        for parts in [[1, 1], [5, 3], [1, 9], [7, 7], [33, 20]] {
            for (k, place) in places(parts).into_iter().enumerate() {
                assert_eq!((position(parts, place), place_at(parts, k)), (k, place));
            }
        }
    }

    #[test]
    fn neighbours_on_the_curve_are_neighbours_in_the_square() {
        for n in [2, 4, 8, 16] {
            let places = places([n, n]);
            let distance = |w: &[[usize; 2]]| w[0][0].abs_diff(w[1][0]) + w[0][1].abs_diff(w[1][1]);
            assert!(places.windows(2).all(|w| distance(w) == 1), "{n}: {places:?}");
        }
    }

    #[test]
    fn on_a_line_the_order_is_that_of_the_line() {
        assert_eq!(places([5]), [[0], [1], [2], [3], [4]]);
    }
}
