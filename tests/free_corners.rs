//! Picture frames whose clips end before the corners, which are free.
//!
//! ```text
//!      ▀▀▀▀▀▀▀      four clips, each from 2, 3.3 or 5 % of its side to as far from its other end
//!    ▌ cloth  ▐     truth: 97×97 nodes, another grid than the fit's, with a shear law that is no spline
//!      ▄▄▄▄▄▄▄
//! ```
//!
//! The default grid of 25×25 nodes has lines where the clips end and is corrected for its error: the stress errs by at
//! most 0.4 % (relative L2 over the visited range), without noise.

use cloth_data::frame::MeasurementSet;
use cloth_data::rig::with_noise;
use cloth_fit::incremental::{FitReport, Stage, fit};
use cloth_fit::optimise::uncertainty::Source;
use cloth_fit::stage::knowledge::Knowledge;
use cloth_fit::stage::{Settings, Watch};
use cloth_sim::curve::{NegativeStrain, StiffnessCurve, equidistant};
use cloth_sim::material::{Component, Curves};
use fit_cloth_tests::picture_frame::{PictureFrame, SIDE};
use fit_cloth_tests::{coverage, own_mesh, stress_error};
use rayon::prelude::*;

const NODES: usize = 97;

fn law(strain: f64) -> f64 {
    6.0 * (strain / 0.2).tanh() + 40.0 * strain + 60.0 * strain.powi(3)
}

/// The law as a curve of 65 points, and constant stretch.
fn truth() -> Curves {
    let strains = equidistant(65, 0.64);
    let stiffness = |e: &f64| if *e > 0.0 { law(*e) / e } else { 6.0 / 0.2 + 40.0 };
    let stiffnesses = strains.iter().map(stiffness).collect();
    let stretch = StiffnessCurve::constant(2000.0, NegativeStrain::Green).unwrap();
    let shear = StiffnessCurve::new(strains, stiffnesses, NegativeStrain::Odd).unwrap();
    let mut curves = Curves::default();
    curves.set(Component::StretchWeft, stretch.clone());
    curves.set(Component::StretchWarp, stretch);
    curves.set(Component::Shear, shear);
    curves
}

/// Frames of a picture frame whose clips end at a share of the side.
fn measured(share: f64, frames: usize) -> MeasurementSet {
    let angles: Vec<f64> = (1..=frames).map(|i| 0.45f64.asin() * i as f64 / frames as f64).collect();
    let frame = PictureFrame { measured: [NODES; 2], shapes: true, ..PictureFrame::of_law(&law, &angles) };
    let mut set = frame.measure();
    for sequence in &mut set.sequences {
        let mesh = &sequence.mesh;
        let inside = |at: f64| at >= share * SIDE - 1e-9 && at <= (1.0 - share) * SIDE + 1e-9;
        for (bar, clip) in sequence.clips.iter_mut().enumerate() {
            // Bars along x, then along y.
            clip.vertices.retain(|&vertex| inside(mesh.positions[vertex][bar / 2]));
        }
    }
    let settings = Settings { nodes: Some([NODES; 2]), ..Settings::default() };
    let mut set = own_mesh::simulated(&set, &truth(), &settings);
    // Constant heights count as not measured, and a sheet that nobody saw may have buckled.
    let frames = set.sequences.iter_mut().flat_map(|sequence| &mut sequence.frames);
    frames.flat_map(|frame| &mut frame.positions).for_each(|places| places[0].z += 1e-6);
    set
}

/// The fit of shear with known stretch.
fn report(set: &MeasurementSet, settings: &Settings) -> FitReport {
    let known = Knowledge::exact(truth()).without(&[Component::Shear]);
    fit(set, &[Stage::Shear], &known, settings, &mut Watch::default()).unwrap()
}

/// Relative error of the stress, and share of its rows within the band.
fn fitted(set: &MeasurementSet, settings: &Settings) -> [f64; 2] {
    let report = report(set, settings);
    let stage = report.stage(Component::Shear).unwrap();
    assert!(stage.converged, "{:?}", stage.levels.iter().map(|l| (l.points, &l.status)).collect::<Vec<_>>());
    // The sources of the widest band make it up.
    let halves = stage.curve.samples.iter().filter_map(|row| row.band.map(|[low, high]| 0.5 * (high - low)));
    let widest = halves.fold(0.0, f64::max);
    let together = stage.curve.band.values().map(|half| half * half).sum::<f64>().sqrt();
    assert!((together / widest - 1.0).abs() < 1e-9, "{together} {widest} {:?}", stage.curve.band);
    assert_eq!(stage.curve.band.contains_key(&Source::Grid), settings.corrected);
    [stress_error(&stage.curve.samples, &law), coverage(&stage.curve.samples, &law)]
}

/// Error allowed with five points and with nine.
const ALLOWED: [f64; 2] = [0.004, 0.0015];

#[test]
fn free_corners_are_fitted_within_their_bands() {
    for share in [0.02, 0.033, 0.05] {
        let set = measured(share, 24);
        for (points, allowed) in [5, 9].into_iter().zip(ALLOWED) {
            let [error, inside] = fitted(&set, &Settings { points, ..Settings::default() });
            println!(
                "clips from {:.1} %, {points} points: {:.3} %, inside {inside:.2}",
                100.0 * share,
                100.0 * error
            );
            assert!(error < allowed && inside > 0.6, "{share} {points}: {error} {inside}");
        }
    }
}

/// Coverage over many seeds, of noise of vertices, forces and, in half of the fits, clip poses.
#[test]
#[ignore = "release: 120 fits"]
fn bands_of_free_corners_hold_the_truth_in_full() {
    let mut sound = true;
    let mut all = Vec::new();
    for share in [0.02, 0.033, 0.05] {
        let exact = measured(share, 24);
        for clip_noise in [false, true] {
            let of_seed = |seed: u64| {
                let set = with_noise(&exact, 1.0, 1.0, clip_noise, seed);
                let report = report(&set, &Settings::default());
                let samples = &report.stage(Component::Shear).unwrap().curve.samples;
                [stress_error(samples, &law), coverage(samples, &law)]
            };
            let found: Vec<[f64; 2]> = (1..=20).into_par_iter().map(of_seed).collect();
            let mean = |part: usize| found.iter().map(|pair| pair[part]).sum::<f64>() / found.len() as f64;
            let [error, inside] = [mean(0), mean(1)];
            println!(
                "clips from {share}, clip noise {clip_noise:5}: error {:.3} %, inside {inside:.3}",
                100.0 * error
            );
            sound &= inside >= 0.88;
            all.push(inside);
        }
    }
    let pooled = all.iter().sum::<f64>() / all.len() as f64;
    println!("pooled: {pooled:.3} inside");
    assert!(sound && (0.92..=1.0).contains(&pooled));
}

#[test]
fn without_a_correction_the_grid_is_seen_and_no_part_of_the_band() {
    let set = measured(0.05, 12);
    let [error, inside] = fitted(&set, &Settings { corrected: false, ..Settings::default() });
    assert!(error > 0.006 && inside < 0.2, "{error} {inside}");
}

/// On a simulator's mesh its own curve gives the measured forces; the continuum's errs by the mesh.
#[test]
fn a_curve_for_a_mesh_gives_the_measured_forces_on_it() {
    let set = measured(0.05, 12);
    let mesh = Settings { for_mesh: Some(SIDE / 10.0), ..Settings::default() };
    let misses = [&mesh, &Settings::default()].map(|settings| {
        let curve = report(&set, settings).stage(Component::Shear).unwrap().curve.curve.clone();
        let mut curves = truth();
        curves.set(Component::Shear, curve);
        let forces = own_mesh::equilibria(&set, &set.sequences[0], &curves, &mesh, |settled, forces| {
            let measured = settled.frame.forces.iter().map(|component| component.force);
            measured
                .zip(forces)
                .map(|(measured, force)| [(measured - force).powi(2), measured.powi(2)])
                .collect()
        });
        let squares: Vec<[f64; 2]> = forces.into_iter().flat_map(|frame: Vec<[f64; 2]>| frame).collect();
        let [miss, all] = [0, 1].map(|part| squares.iter().map(|square| square[part]).sum::<f64>());
        (miss / all).sqrt()
    });
    println!("forces on cells of {:.0} mm: {:.2e} and {:.2e} off", 100.0 * SIDE, misses[0], misses[1]);
    assert!(misses[0] < 0.003 && misses[1] > 4.0 * misses[0], "{misses:?}");
}
