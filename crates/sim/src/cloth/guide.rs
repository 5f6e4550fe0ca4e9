//! Guided nodes: filters the matrix rows and columns to the free directions.
//!
//! ```text
//! S K S + c (I − S)      S the projection onto the free directions of every node
//! ```
//!
//! The blocked directions get a diagonal on which no force acts, so the same matrix suits both factorisation and
//! conjugate gradients. Conjugate gradients take the same steps on it as when vectors are filtered in every step.
//!
//! Source: Baraff and Witkin 1998, §5.

use super::numbering::HELD;
use crate::error::Result;
use crate::linear::matrix::Pattern;
use crate::load::Guided;
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeSet;

/// Positions of a block's entries among the matrix values, by row and column.
type Block = [[usize; 3]; 3];

/// A guided node.
#[derive(Debug, Clone)]
pub(super) struct Guide {
    /// First of the node's three unknowns.
    unknown: usize,
    /// S.
    projection: Matrix3<f64>,
    /// Lower entries of the node's own block; an entry above the diagonal refers to its mirror image.
    own: Block,
    /// Entries between the node's unknowns and each neighbouring unknown.
    others: Vec<[usize; 3]>,
}

/// The guided nodes of a problem.
///
/// * `unknown_of` — unknown of every coordinate
/// * `neighbours` — neighbours of every node
///
/// # Errors
/// A direction that is zero or not finite.
pub(super) fn guides(
    guided: &[Guided],
    unknown_of: &[usize],
    neighbours: &[BTreeSet<usize>],
    pattern: &Pattern,
) -> Result<Vec<Guide>> {
    let guide = |guided: &Guided| {
        let unknown = unknown_of[3 * guided.node];
        let beside = |other: usize| -> Option<[usize; 3]> {
            let place = |i: usize| pattern.position((unknown + i).max(other), (unknown + i).min(other));
            Some([place(0)?, place(1)?, place(2)?])
        };
        let own = || Some([beside(unknown)?, beside(unknown + 1)?, beside(unknown + 2)?]);
        let others = neighbours[guided.node].iter().flat_map(|node| 3 * node..3 * node + 3);
        let others = others.map(|coordinate| unknown_of[coordinate]).filter(|&other| other != HELD);
        Ok(Guide {
            unknown,
            projection: guided.free.projection()?,
            own: own().unwrap_or_default(),
            others: others.filter_map(beside).collect(),
        })
    };
    guided.iter().map(guide).collect()
}

impl Guide {
    /// Projects the node's three entries of a vector over the unknowns.
    pub(super) fn project(&self, unknowns: &mut [f64]) {
        let node = &mut unknowns[self.unknown..self.unknown + 3];
        node.copy_from_slice((self.projection * Vector3::from_column_slice(node)).as_slice());
    }

    /// Filters the node's rows and columns in a matrix with these lower entries.
    pub(super) fn filter(&self, values: &mut [f64]) {
        let read = |values: &[f64], block: &Block| Matrix3::from_fn(|i, j| values[block[i][j]]);
        let write = |values: &mut [f64], block: &Block, filtered: Matrix3<f64>| {
            (0..3).for_each(|i| (0..3).for_each(|j| values[block[i][j]] = filtered[(i, j)]));
        };
        let s = self.projection;
        for places in &self.others {
            let filtered = s * Vector3::from_fn(|i, _| values[places[i]]);
            (0..3).for_each(|i| values[places[i]] = filtered[i]);
        }
        let own = read(values, &self.own);
        let size = (own.trace().abs() / 3.0).max(f64::MIN_POSITIVE.sqrt());
        write(values, &self.own, s * own * s + (Matrix3::identity() - s) * size);
    }
}
