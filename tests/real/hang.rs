//! A sheet hung from two corners, at rest.
//!
//! ```text
//!   o────────o    source  Strohkorb 2019: wool of 15 kg, 10 m × 10 m, 100 vertices, weft and warp bear tension only
//!   │        │    goal    agreement with the shapes of an independent program and method
//!   │        │    data    gnatv_hang/
//!   └──╲__╱──┘    passes  in its plane: every vertex 2 mm, support 0.1 %; in space: see below
//! ```

use cloth_sim::cloth::ForceScale;
use cloth_sim::descent::{Descent, Settings, descend};
use cloth_sim::dynamics::{self, Damping, Motion, Status};
use cloth_sim::samples::Sample;
use fit_cloth_tests::hang::gnatv_hang;
use fit_cloth_tests::rows;

/// The weight of 15 kg, N.
const WEIGHT: f64 = 147.0;

/// The shape at rest, 3 stacked coordinates per node; the vertical support force, N; the descent.
fn at_rest(sample: &Sample) -> (Vec<f64>, f64, Descent) {
    let cloth = sample.cloth().unwrap();
    let mut x = sample.start.clone();
    let descent = descend(&cloth, &sample.curves, &mut x, &Settings::default(), &mut |_, _| {}).unwrap();
    let (mut gradient, mut scale) = (vec![0.0; x.len()], ForceScale::new(cloth.points()));
    cloth.gradient(&sample.curves, &x, &mut gradient, &mut scale);
    let force = cloth.clip_forces(&gradient)[0].y;
    (x, force, descent)
}

#[test]
fn in_its_plane_every_vertex_is_where_it_should_be() {
    let (x, force, descent) = at_rest(&gnatv_hang(true));
    println!("{descent:?}");
    let reference = rows("gnatv_hang/planar_equilibrium_reference.csv");
    assert_eq!(reference.len(), 100);
    let error = |row: &Vec<String>| {
        let [vertex, rx, ry] = [0, 1, 2].map(|i| row[i].parse::<f64>().unwrap());
        let place = &x[3 * vertex as usize..];
        (place[0] - rx).hypot(place[1] - ry)
    };
    let worst = reference.iter().map(error).fold(0.0, f64::max);
    println!("largest distance {worst:.2e} m, support {force:.4} N");
    assert!(descent.equilibrium.converged(), "{descent:?}");
    assert!(worst < 2e-3, "{worst}");
    assert!((force / WEIGHT - 1.0).abs() < 1e-3, "{force}");
}

#[test]
fn in_space_it_hangs_as_low() {
    let mut sample = gnatv_hang(false);
    sample.perturb(1e-2);
    let (x, force, descent) = at_rest(&sample);
    println!("{descent:?}");
    let rest = &sample.mesh.positions;
    let lowest = rest.iter().map(|p| p.y).fold(f64::MAX, f64::min);
    let bottom: Vec<f64> =
        (0..rest.len()).filter(|&node| rest[node].y < lowest + 1e-6).map(|node| x[3 * node + 1]).collect();
    let mean = bottom.iter().sum::<f64>() / bottom.len() as f64;
    let vertex = x[3 * 8 + 1];
    println!("vertex 8 {vertex:.4}, bottom {mean:.4} over {} vertices, support {force:.4} N", bottom.len());
    assert!((vertex + 5.117).abs() < 0.010, "{vertex}");
    assert!((-5.075..=-5.045).contains(&mean), "{mean}");
    assert!((force / WEIGHT - 1.0).abs() < 1e-3, "{force}");
}

/// Final rest shape of a damped motion from the flat sheet; 3 stacked coordinates per node.
fn after_motion(sample: &Sample) -> Vec<f64> {
    let cloth = sample.cloth().unwrap();
    // The slowest swing of 10 m takes seconds: α = 1/s damps it by a quarter.
    let damping = Damping { mass: 1.0, stiffness: 1e-3 };
    let settings = dynamics::Settings { step: 0.02, damping, ..Default::default() };
    let mut motion = Motion::new(&cloth, &sample.curves, sample.start.clone(), &settings).unwrap();
    let mut quiet = 0;
    while quiet < 50 && motion.time() < 120.0 {
        assert_eq!(motion.step().status, Status::Done, "{} s", motion.time());
        quiet = if motion.greatest_speed() < 1e-5 { quiet + 1 } else { 0 };
    }
    println!("at rest after {:.1} s; {:?}", motion.time(), motion.energies());
    assert!(quiet == 50, "still {:e} m/s", motion.greatest_speed());
    motion.positions().to_vec()
}

#[test]
fn damped_motion_comes_to_the_same_shape() {
    let sample = gnatv_hang(true);
    let (still, ..) = at_rest(&sample);
    let moved = after_motion(&sample);
    let apart = still.iter().zip(&moved).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!("in its plane: {apart:.1e} m from the shape at rest");
    assert!(apart < 1e-4, "{apart}");

    let mut sample = gnatv_hang(false);
    sample.perturb(1e-2);
    let moved = after_motion(&sample);
    let vertex = moved[3 * 8 + 1];
    println!("in space: vertex 8 {vertex:.4}");
    assert!((vertex + 5.117).abs() < 0.010, "{vertex}");
}
