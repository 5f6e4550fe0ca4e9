//! Guided nodes: rows and columns of the matrix filtered to the directions that are free.
//!
//! ```text
//! S K S + c (I − S)      S the projection onto the free directions of every node
//! ```
//!
//! Across the free directions stands a diagonal that no force acts on, so that the same matrix serves a factorisation and
//! conjugate gradients. On it these take the same steps as with vectors filtered at every step.
//!
//! Source: Baraff and Witkin 1998, §5.

use super::numbering::HELD;
use crate::error::Result;
use crate::linear::matrix::Pattern;
use crate::load::Guided;
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeSet;

/// Where the entries of a block stand among the matrix's values, by row and column.
type Block = [[usize; 3]; 3];

/// A guided node.
#[derive(Debug, Clone)]
pub(super) struct Guide {
    /// The first of its three unknowns.
    unknown: usize,
    /// S.
    projection: Matrix3<f64>,
    /// The lower entries of its own block; what is above the diagonal names the mirrored entry.
    own: Block,
    /// The blocks in its rows.
    rows: Vec<Block>,
    /// The blocks in its columns.
    columns: Vec<Block>,
}

/// The guided nodes of a problem.
///
/// * `unknown_of` — every coordinate's unknown
/// * `neighbours` — of every node
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
        let block = |row: usize, column: usize| -> Option<Block> {
            let mut block = Block::default();
            for (i, entries) in block.iter_mut().enumerate() {
                for (j, entry) in entries.iter_mut().enumerate() {
                    let [a, b] = [row + i, column + j];
                    *entry = pattern.position(a.max(b), a.min(b))?;
                }
            }
            Some(block)
        };
        let others = || neighbours[guided.node].iter().map(|&node| unknown_of[3 * node]);
        let others = || others().filter(|&other| other != HELD);
        Ok(Guide {
            unknown,
            projection: guided.free.projection()?,
            own: block(unknown, unknown).unwrap_or_default(),
            rows: others().filter(|&other| other < unknown).filter_map(|o| block(unknown, o)).collect(),
            columns: others().filter(|&other| other > unknown).filter_map(|o| block(o, unknown)).collect(),
        })
    };
    guided.iter().map(guide).collect()
}

impl Guide {
    /// Projects the node's three of a vector over the unknowns.
    pub(super) fn project(&self, unknowns: &mut [f64]) {
        let node = &mut unknowns[self.unknown..self.unknown + 3];
        node.copy_from_slice((self.projection * Vector3::from_column_slice(node)).as_slice());
    }

    /// Filters the node's rows and columns of a matrix with these lower entries.
    pub(super) fn filter(&self, values: &mut [f64]) {
        let read = |values: &[f64], block: &Block| Matrix3::from_fn(|i, j| values[block[i][j]]);
        let write = |values: &mut [f64], block: &Block, filtered: Matrix3<f64>| {
            (0..3).for_each(|i| (0..3).for_each(|j| values[block[i][j]] = filtered[(i, j)]));
        };
        let s = self.projection;
        for block in &self.rows {
            let filtered = s * read(values, block);
            write(values, block, filtered);
        }
        for block in &self.columns {
            let filtered = read(values, block) * s;
            write(values, block, filtered);
        }
        let own = read(values, &self.own);
        let size = (own.trace().abs() / 3.0).max(f64::MIN_POSITIVE.sqrt());
        write(values, &self.own, s * own * s + (Matrix3::identity() - s) * size);
    }
}
