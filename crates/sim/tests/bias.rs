//! Locking: nearly inextensible yarns in a mesh without an edge along each of them.
//!
//! ```text
//!   ▐╲╱╲╱╲╱╲▌ →   a strip 1:2 cut at 45°, pulled by 10 %      goal    the shear of the cloth resists, not the mesh
//!   ▐╱╲╱╲╱╲╱▌     k = 1e5 N/m along the yarns, 30 in shear    passes  crossed ≤ a tenth of '/', 1 % mesh error
//! ```

use cloth_sim::equilibrium::{Settings, Solver};
use cloth_sim::error::Error;
use cloth_sim::material::{Component, Model};
use cloth_sim::mesh::{Diagonals, Grid};
use cloth_sim::samples::{self, SIDE, Sample};
use nalgebra::Vector3;

fn bias_strip(cells: usize, diagonals: Diagonals, model: Model) -> Sample {
    let grid = Grid { columns: 2 * cells + 1, rows: cells + 1, width: 2.0 * SIDE, height: SIDE, diagonals };
    let mesh = grid.mesh().expect("a grid");
    let mesh = samples::cut_on_the_bias(mesh, std::f64::consts::FRAC_PI_4);
    let stiffnesses =
        [(Component::StretchWeft, 1e5), (Component::StretchWarp, 1e5), (Component::Shear, 30.0)];
    let curves = samples::linear_curves(model, &stiffnesses).expect("finite");
    let mut sample = Sample { planar: true, ..Sample::at_rest(mesh, model, curves) };
    sample.hold(|p| if p.x == 0.0 { Some(0) } else { (p.x > 1.999 * SIDE).then_some(1) });
    sample.place(|p| Vector3::new(1.1 * p.x, p.y, p.z));
    sample
}

/// Force of the pulling bar, N.
fn force(cells: usize, diagonals: Diagonals) -> f64 {
    let sample = bias_strip(cells, diagonals, Model::STVK);
    let cloth = sample.cloth().expect("the sample is valid");
    let mut solver = Solver::new(&cloth);
    let mut x = sample.start.clone();
    let found = solver.solve(&sample.curves, &mut x, &Settings::default());
    assert!(found.converged(), "{diagonals:?}, {cells}: {found:?}");
    solver.clip_forces()[1].x
}

/// Measured, N, by the number of cells across the strip. Alternating cells lock if the number is odd:
///
/// ```text
/// cells          3      4      5      8      9     15     16     32
/// '/'        116.5   86.0   66.9   37.7   32.3   16.4   15.1    6.5
/// in turn     4.17   2.45   3.16   2.44   2.77   2.61   2.43   2.41
/// crossed     2.45   2.45   2.45   2.44   2.44   2.42   2.42   2.40
/// ```
#[test]
fn crossed_cells_do_not_lock() {
    let [coarse, fine] = [8, 16].map(|cells| force(cells, Diagonals::Crossed));
    let locked = force(8, Diagonals::Forward);
    println!("'/' {locked} N, crossed {coarse} N, finer {fine} N");
    assert!(locked > 10.0 * coarse);
    assert!((fine / coarse - 1.0).abs() < 0.01);
}

#[test]
fn springs_refuse_crossed_cells() {
    let error = bias_strip(4, Diagonals::Crossed, Model::SPRINGS).cloth().unwrap_err();
    assert_eq!(error, Error::NeedsGrid { what: "a membrane of springs" });
}
