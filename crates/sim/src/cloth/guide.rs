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
    /// Blocks in the node's rows.
    rows: Vec<Block>,
    /// Blocks in the node's columns.
    columns: Vec<Block>,
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
