//! Arrays of fixed length in inner loops.
//!
//! The compiler inlines [`std::array::from_fn`] and the method `map` of arrays only where they and
//! their caller fall into one code-generation unit; so does it with sums of iterators. The functions
//! here are inlined in every unit.

use std::mem::MaybeUninit;

/// The array of `f(0)`, `f(1)`, ..., as [`std::array::from_fn`].
#[inline(always)]
pub fn from_fn<T, const N: usize, F: FnMut(usize) -> T>(mut f: F) -> [T; N] {
    let mut values = [const { MaybeUninit::<T>::uninit() }; N];
    let mut i = 0;
    while i < N {
        values[i] = MaybeUninit::new(f(i));
        i += 1;
    }
    // SAFETY: all N values have been written; an array of `MaybeUninit<T>` has the layout of an
    // array of `T`, and drops nothing
    unsafe { std::mem::transmute_copy(&values) }
}

/// The array of `f(values[0])`, `f(values[1])`, ..., as the method `map` of arrays.
#[inline(always)]
pub fn map<T: Copy, U, const N: usize>(values: &[T; N], mut f: impl FnMut(T) -> U) -> [U; N] {
    from_fn(|i| f(values[i]))
}

/// The first `length` numbers of each of `N` fields.
///
/// # Panics
///
/// If a field is shorter.
#[inline(always)]
pub fn parts_mut<const N: usize>(fields: &mut [Vec<f64>; N], length: usize) -> [&mut [f64]; N] {
    let mut fields = fields.iter_mut();
    from_fn(|_| &mut fields.next().expect("N fields")[..length])
}

/// `N` numbers of `column` from `first` on.
///
/// # Panics
///
/// If `column` has fewer numbers.
#[inline(always)]
pub fn part<const N: usize>(column: &[f64], first: usize) -> &[f64; N] {
    column[first..].first_chunk().expect("N numbers")
}

/// The same to write to.
///
/// # Panics
///
/// If `column` has fewer numbers.
#[inline(always)]
pub fn part_mut<const N: usize>(column: &mut [f64], first: usize) -> &mut [f64; N] {
    column[first..].first_chunk_mut().expect("N numbers")
}

/// The sum of `f(0)`, `f(1)`, ..., `f(N - 1)` in that order; -0 without terms.
#[inline(always)]
pub fn sum<const N: usize>(mut f: impl FnMut(usize) -> f64) -> f64 {
    let mut total = -0.0;
    let mut i = 0;
    while i < N {
        total += f(i);
        i += 1;
    }
    total
}

#[cfg(test)]
mod tests {
    #[test]
    fn arrays_are_those_of_the_standard_library() {
        let square = |i: usize| (i * i) as f64;
        assert_eq!(super::from_fn::<_, 5, _>(square), std::array::from_fn(square));
        assert_eq!(super::from_fn::<f64, 0, _>(|_| unreachable!()), []);
        assert_eq!(super::map(&[3, 1, 2], square), [9.0, 1.0, 4.0]);
        let tenth = |i: usize| 0.1 * i as f64;
        assert_eq!(super::sum::<7>(tenth), (0..7).map(tenth).sum());
    }
}
