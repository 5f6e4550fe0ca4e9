//! Node orderings that keep a factor sparse.

use super::matrix::structure;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::amd;
use nalgebra::Vector3;

/// Larger sheets use nested dissection: at 101×101 nodes a factor then costs about two thirds as much; for fewer nodes,
/// about the same.
const DISSECTED: usize = 2000;

/// Parts up to this size are not cut further.
const LEAF: usize = 100;

/// Orders a sheet's nodes so that the factor stays sparse.
///
/// * `neighbours` — neighbours of every node, ascending, without the node itself
/// * `places` — rest positions of the nodes, m
/// * returns — the node at each place
pub(crate) fn order(neighbours: &[Vec<usize>], places: &[Vector3<f64>]) -> Vec<usize> {
    let all = (0..places.len()).collect();
    if places.len() <= DISSECTED { minimum_degree(neighbours, all) } else { dissect(neighbours, places, all) }
}

/// Nested dissection: a separator across the longer side is ordered after the two parts, which are cut recursively.
///
/// Source: George 1973.
fn dissect(neighbours: &[Vec<usize>], places: &[Vector3<f64>], mut part: Vec<usize>) -> Vec<usize> {
    if part.len() <= LEAF {
        return minimum_degree(neighbours, part);
    }
    let extent = |axis: usize| {
        let along = part.iter().map(|&node| places[node][axis]);
        along.clone().fold(f64::MIN, f64::max) - along.fold(f64::MAX, f64::min)
    };
    let axis = if extent(0) >= extent(1).max(extent(2)) { 0 } else { 1 + usize::from(extent(2) > extent(1)) };
    part.sort_by(|&a, &b| places[a][axis].total_cmp(&places[b][axis]));
    let mut is_far = vec![false; places.len()];
    let far = part.split_off(part.len() / 2);
    far.iter().for_each(|&node| is_far[node] = true);
    let (cut, near): (Vec<usize>, Vec<usize>) =
        part.into_iter().partition(|&node| neighbours[node].iter().any(|&other| is_far[other]));
    let mut order = dissect(neighbours, places, near);
    order.extend(dissect(neighbours, places, far));
    order.extend(cut);
    order
}

/// Orders a part of a graph by approximate minimum degree.
fn minimum_degree(neighbours: &[Vec<usize>], mut part: Vec<usize>) -> Vec<usize> {
    part.sort_unstable();
    let size = part.len();
    let within = |&other: &usize| part.binary_search(&other).ok();
    let graph: Vec<Vec<usize>> =
        part.iter().map(|&node| neighbours[node].iter().filter_map(within).collect()).collect();
    let pattern = structure(&graph);
    let mut memory = MemBuffer::new(amd::order_scratch::<usize>(size, pattern.compute_nnz()));
    let (mut order, mut place) = (vec![0; size], vec![0; size]);
    match amd::order(
        &mut order,
        &mut place,
        pattern.as_ref(),
        amd::Control::default(),
        MemStack::new(&mut memory),
    ) {
        Ok(_) => order.into_iter().map(|index| part[index]).collect(),
        // Any order is correct, only slower.
        Err(_) => part,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_order_is_a_permutation() {
        for side in [3, 60] {
            let sheet = (0..side * side).map(|node| (node % side, node / side));
            let around = |(column, row): (usize, usize)| {
                let left = column.checked_sub(1).map(|_| row * side + column - 1);
                let below = row.checked_sub(1).map(|_| row * side + column - side);
                let right = (column + 1 < side).then_some(row * side + column + 1);
                let above = (row + 1 < side).then_some(row * side + column + side);
                [below, left, right, above].into_iter().flatten().collect()
            };
            let neighbours: Vec<Vec<usize>> = sheet.clone().map(around).collect();
            let places: Vec<Vector3<f64>> =
                sheet.map(|(x, y)| Vector3::new(x as f64, y as f64, 0.0)).collect();
            let mut sorted = order(&neighbours, &places);
            sorted.sort_unstable();
            assert_eq!(sorted, (0..side * side).collect::<Vec<_>>());
        }
    }
}
