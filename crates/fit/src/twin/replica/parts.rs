//! Components and discretisation of a replica.

use crate::twin::specimen::GridSize;
use cloth_sim::material::{Component, Model};
use cloth_sim::mesh::Diagonals;

/// Components and discretisation of a replica.
#[derive(Debug, Clone, PartialEq)]
pub struct Parts {
    /// Model of membrane and bending.
    pub model: Model,
    /// The components that store energy.
    pub components: Vec<Component>,
    /// kg/m².
    pub areal_density: f64,
    /// Size of the grid.
    pub grid: GridSize,
    /// Split of the cells.
    pub diagonals: Diagonals,
    /// Multiple of the cells; above 1, of a grid that corrects another.
    pub refinement: usize,
    /// Constraint at a table.
    pub table: TableHold,
    /// All motion stays in the plane, and weight normal to it is left out: for parts without bending, which would
    /// crumple in space under compression.
    pub flat: bool,
}

/// Constraint of a sheet on a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TableHold {
    /// The overhang alone, as a cylinder whose place and slope at the edge are found with the curve.
    #[default]
    FoundEdge,
    /// Nodes on the table are held as seen, all others are free. Source: Miguel et al. 2012, §5.1.
    AsSeen,
}
