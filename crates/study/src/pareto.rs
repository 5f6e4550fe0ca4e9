//! Pareto front of runs in error and time.

/// Errors within one per cent of each other count as equal, since such differences are random.
const NOTABLE: f64 = 0.99;

/// Points (time, error) that no other point matches or beats in both, sorted by time; the first of equal ones.
pub fn front(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut lowest = f64::INFINITY;
    sorted.retain(|point| {
        let better = point[1] < NOTABLE * lowest;
        if better {
            lowest = point[1];
        }
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
        assert_eq!(front(&[[1.0, 1.0], [2.0, 0.999]]), [[1.0, 1.0]]);
    }
}
