//! Which runs no other beats in both error and time.

/// The points that no other is at least as good as in both coordinates, by the first coordinate; of equal ones the first.
pub fn front(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut lowest = f64::INFINITY;
    sorted.retain(|point| {
        let better = point[1] < lowest;
        lowest = lowest.min(point[1]);
        better
    });
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_slower_and_no_better_is_left_out() {
        let points = [[3.0, 1.0], [1.0, 4.0], [2.0, 4.0], [2.0, 2.0], [4.0, 1.0], [1.0, 5.0]];
        assert_eq!(front(&points), [[1.0, 4.0], [2.0, 2.0], [3.0, 1.0]]);
        assert!(front(&[]).is_empty());
    }
}
