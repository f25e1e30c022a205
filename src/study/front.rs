//! The Pareto front of cost and error.

/// Indices of the Pareto-optimal points (cost, error), by cost: no other point is at most as large
/// in both and smaller in one. Points that are not finite are omitted.
pub fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> =
        (0..points.len()).filter(|&k| points[k].0.is_finite() && points[k].1.is_finite()).collect();
    order.sort_by(|&a, &b| {
        points[a].0.total_cmp(&points[b].0).then(points[a].1.total_cmp(&points[b].1))
    });
    let mut best = f64::INFINITY;
    order.retain(|&k| {
        let better = points[k].1 < best;
        best = best.min(points[k].1);
        better
    });
    order
}

#[cfg(test)]
mod tests {
    use super::front;

    #[test]
    fn what_another_beats_is_left_out() {
        let points = [(3.0, 1.0), (1.0, 5.0), (2.0, 5.0), (2.0, 3.0), (4.0, 1.0), (1.0, 6.0)];
        assert_eq!(front(&points), [1, 3, 0]);
        assert_eq!(front(&[(1.0, f64::NAN), (2.0, 2.0)]), [1]);
        assert!(front(&[]).is_empty());
    }
}
