//! Springs: ring 1 in the plane, ring 2 for bending.

use crate::element::{Block, Element, Point, stacked};
use crate::error::{Error, Result};
use crate::material::Component;
use crate::mesh::{Diagonals, Grid, Mesh};
use nalgebra::Vector2;

/// A spring between two nodes.
///
/// ```text
/// ε = l/l₀ − 1      ∂ε/∂x_b = n/l₀ = −∂ε/∂x_a      ∂²ε/∂x_b∂x_b = (I − n nᵀ)/(l l₀)      n = (x_b − x_a)/l
/// ```
///
/// Source: Miguel et al. 2012, eq. 1. The energy density is integrated over the cloth area that the spring represents,
/// so the stress of a stretch curve is the nominal force per width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring {
    /// Node indices.
    pub nodes: [usize; 2],
    /// Rest length, m.
    pub rest_length: f64,
    /// Cloth area that the spring represents, m².
    pub area: f64,
    /// Component, from the spring's direction in material coordinates.
    pub component: Component,
}

impl Spring {
    /// Direction and length; the length is never zero.
    #[inline(always)]
    fn length<const N: usize>(&self, x: &[Point<N>; 2]) -> (Point<N>, f64) {
        let along = x[1] - x[0];
        let smallest = 1e-8 * self.rest_length;
        let length = (along.norm_squared() + smallest * smallest).sqrt();
        (along / length, length)
    }
}

impl<const N: usize> Element<2, N, 1> for Spring {
    fn coordinates(&self) -> [[usize; 3]; 2] {
        stacked(self.nodes)
    }

    fn components(&self) -> [Component; 1] {
        [self.component]
    }

    fn area(&self) -> f64 {
        self.area
    }

    fn extent(&mut self) -> &mut f64 {
        &mut self.area
    }

    #[inline(always)]
    fn strains(&self, x: &[Point<N>; 2]) -> [f64; 1] {
        [self.length(x).1 / self.rest_length - 1.0]
    }

    #[inline(always)]
    fn gradients(&self, x: &[Point<N>; 2]) -> [[Point<N>; 2]; 1] {
        let normal = self.length(x).0 / self.rest_length;
        [[-normal, normal]]
    }

    #[inline(always)]
    fn add_geometric(&self, x: &[Point<N>; 2], &[stress]: &[f64; 1], blocks: &mut [[Block<N>; 2]; 2]) {
        let (normal, length) = self.length(x);
        let across =
            (Block::identity() - normal * normal.transpose()) * (stress / (length * self.rest_length));
        blocks[1][1] += across;
    }

    fn add_clamped(&self, x: &[Point<N>; 2], &[stress]: &[f64; 1], blocks: &mut [[Block<N>; 2]; 2]) {
        self.add_geometric(x, &[stress.max(0.0)], blocks);
    }
}

/// Class of a material direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Direction {
    Weft,
    Warp,
    Diagonal,
}

/// Classifies a material direction: along a yarn within 22.5°, or diagonal. Grid indices do not suffice: on a strip cut
/// on the bias, the yarns run along the cells' diagonals.
pub(crate) fn direction_of(along: Vector2<f64>) -> Direction {
    let angle = along.y.abs().atan2(along.x.abs());
    let eighth = std::f64::consts::FRAC_PI_8;
    if angle < eighth {
        Direction::Weft
    } else if angle > 3.0 * eighth {
        Direction::Warp
    } else {
        Direction::Diagonal
    }
}

/// Parallel springs of one kind over the whole grid.
struct Family {
    springs: Vec<Spring>,
}

/// Ring-1 springs of a grid: along both sides of the cells and along both diagonals.
///
/// * `components` — the requested membrane components; others get no springs
///
/// # Errors
/// The mesh is not a regular grid, or its cells are crossed.
pub fn ring_one(mesh: &Mesh, components: &[Component]) -> Result<Vec<Spring>> {
    let of = |direction| match direction {
        Direction::Weft => Component::StretchWeft,
        Direction::Warp => Component::StretchWarp,
        Direction::Diagonal => Component::Shear,
    };
    springs(mesh, "a membrane of springs", [[1, 0], [0, 1], [1, 1], [-1, 1]], of, components)
}

/// Ring-2 springs of a grid: over two cells, along the same four directions. Bending shortens them.
///
/// * `components` — the requested bending components; others get no springs
///
/// # Errors
/// The mesh is not a regular grid, or its cells are crossed.
pub fn ring_two(mesh: &Mesh, components: &[Component]) -> Result<Vec<Spring>> {
    let of = |direction| match direction {
        Direction::Weft => Component::BendWeft,
        Direction::Warp => Component::BendWarp,
        Direction::Diagonal => Component::BendDiagonal,
    };
    springs(mesh, "bending by springs", [[2, 0], [0, 2], [2, 2], [-2, 2]], of, components)
}

fn springs(
    mesh: &Mesh,
    what: &'static str,
    steps: [[isize; 2]; 4],
    component_of: impl Fn(Direction) -> Component,
    components: &[Component],
) -> Result<Vec<Spring>> {
    let plain = mesh.grid.filter(|grid| grid.diagonals != Diagonals::Crossed);
    let grid = plain.ok_or(Error::NeedsGrid { what })?;
    let families: Vec<Family> =
        steps.into_iter().map(|step| family(mesh, &grid, step, &component_of)).collect();
    // Families of one component share the cloth, so that each component covers it once: both diagonals resist shear
    // with half of the cells' area each.
    let sharing = |family: &Family| {
        let component = |family: &Family| family.springs.first().map(|spring| spring.component);
        families.iter().filter(|other| component(other) == component(family)).count() as f64
    };
    Ok(families
        .iter()
        .flat_map(|family| {
            let share = 1.0 / sharing(family);
            family.springs.iter().map(move |spring| Spring { area: spring.area * share, ..*spring })
        })
        .filter(|spring| components.contains(&spring.component))
        .collect())
}

fn family(
    mesh: &Mesh,
    grid: &Grid,
    step: [isize; 2],
    component_of: &impl Fn(Direction) -> Component,
) -> Family {
    let [dx, dy] = grid.cell();
    let mut springs = Vec::new();
    let mut direction = Vector2::zeros();
    for row in 0..grid.rows {
        for column in 0..grid.columns {
            let (Some(to_column), Some(to_row)) =
                (column.checked_add_signed(step[0]), row.checked_add_signed(step[1]))
            else {
                continue;
            };
            if to_column >= grid.columns || to_row >= grid.rows {
                continue;
            }
            let nodes = [grid.node(column, row), grid.node(to_column, to_row)];
            let along = mesh.material[nodes[1]] - mesh.material[nodes[0]];
            direction += along;
            // A spring along a cell side represents a strip one cell wide, half at the border.
            let at_border = step[1] == 0 && (row == 0 || row == grid.rows - 1)
                || step[0] == 0 && (column == 0 || column == grid.columns - 1);
            springs.push(Spring {
                nodes,
                rest_length: along.norm(),
                area: dx * dy * if at_border { 0.5 } else { 1.0 },
                component: Component::Shear,
            });
        }
    }
    let component = component_of(direction_of(direction));
    springs.iter_mut().for_each(|spring| spring.component = component);
    Family { springs }
}
