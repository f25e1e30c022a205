//! Sets of whole numbers as sorted, disjoint intervals: the rows of tiles in a column.

/// An interval of whole numbers: the first one, and the first one beyond it.
pub(super) type Interval = [i64; 2];

/// The union of `intervals`, sorted and disjoint.
pub(super) fn union(mut intervals: Vec<Interval>) -> Vec<Interval> {
    intervals.retain(|[from, to]| from < to);
    intervals.sort_unstable();
    let mut all: Vec<Interval> = Vec::with_capacity(intervals.len());
    for [from, to] in intervals {
        match all.last_mut().filter(|last| from <= last[1]) {
            Some(last) => last[1] = last[1].max(to),
            None => all.push([from, to]),
        }
    }
    all
}

/// The numbers that are in `a` and in `b`.
pub(super) fn intersection(a: &[Interval], b: &[Interval]) -> Vec<Interval> {
    let (mut i, mut j) = (0, 0);
    let mut both = Vec::new();
    while let (Some(p), Some(q)) = (a.get(i), b.get(j)) {
        let common = [p[0].max(q[0]), p[1].min(q[1])];
        if common[0] < common[1] {
            both.push(common);
        }
        if p[1] <= q[1] { i += 1 } else { j += 1 }
    }
    both
}

/// The numbers that are in `a` but not in `b`.
pub(super) fn difference(a: &[Interval], b: &[Interval]) -> Vec<Interval> {
    let mut left = Vec::new();
    let mut j = 0;
    for &[mut from, to] in a {
        while b.get(j).is_some_and(|q| q[1] <= from) {
            j += 1;
        }
        let mut k = j;
        while let Some(q) = b.get(k).filter(|q| q[0] < to) {
            if from < q[0] {
                left.push([from, q[0]]);
            }
            from = from.max(q[1]);
            k += 1;
        }
        if from < to {
            left.push([from, to]);
        }
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn numbers(intervals: &[Interval]) -> Vec<i64> {
        intervals.iter().flat_map(|&[from, to]| from..to).collect()
    }

    fn some() -> impl Strategy<Value = Vec<Interval>> {
        let interval = (0i64..30, 0i64..6).prop_map(|(from, length)| [from, from + length]);
        prop::collection::vec(interval, 0..6)
    }

    proptest! {
        #[test]
        fn intervals_combine_like_sets(a in some(), b in some()) {
            let is_in = |list: &[Interval], n: i64| list.iter().any(|&[from, to]| from <= n && n < to);
            let of = |keep: &dyn Fn(i64) -> bool| -> Vec<i64> { (0..40).filter(|&n| keep(n)).collect() };
            let (p, q) = (union(a.clone()), union(b.clone()));
            prop_assert_eq!(numbers(&p), of(&|n| is_in(&a, n)));
            prop_assert_eq!(numbers(&intersection(&p, &q)), of(&|n| is_in(&a, n) && is_in(&b, n)));
            prop_assert_eq!(numbers(&difference(&p, &q)), of(&|n| is_in(&a, n) && !is_in(&b, n)));
            prop_assert!(p.windows(2).all(|pair| pair[0][1] < pair[1][0]), "disjoint");
        }
    }
}
