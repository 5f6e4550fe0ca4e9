//! The virtual rig: its fabrics have their documented properties, and its measurements their declared accuracy.

use cloth_data::frame::{Frame, Kind, MeasurementSet, Noise, Phase, Sequence};
use cloth_data::rig::{KINDS, KnownFabric, Rig};
use cloth_sim::curve::stability_rows;
use cloth_sim::mesh::Diagonals;
use nalgebra::{DVector, Isometry3, Point3, Vector3};
use std::path::Path;

const GRAVITY: f64 = 9.81;

/// Satin, knit, denim, wool.
fn fabrics() -> [KnownFabric; 4] {
    ["cotton-satin", "rayon-spandex-knit", "cotton-denim", "wool-cotton"]
        .map(|name| KnownFabric::named(name).unwrap())
}

#[test]
fn built_in_fabrics_are_those_of_the_fixtures() {
    for name in KnownFabric::names() {
        let file = format!("{}/../fixtures/fabrics/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(file).unwrap();
        let copy = format!("{}/../crates/data/fabrics/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        assert_eq!(text, std::fs::read_to_string(copy).unwrap(), "{name}");
    }
    let error = KnownFabric::named("felt").unwrap_err().to_string();
    assert!(error.contains("felt") && error.contains("one of cotton-denim, cotton-satin"), "{error}");
}

fn denim() -> KnownFabric {
    let [_, _, denim, _] = fabrics();
    denim
}

/// A coarse rig without noise.
fn rig(sequences: &[Kind]) -> Rig {
    let sequences = sequences.to_vec();
    Rig { sequences, nodes: [13, 13], measured: [7, 7], frames: 2, noise: false, ..Rig::default() }
}

fn measure(rig: &Rig) -> MeasurementSet {
    rig.measure(&denim()).unwrap()
}

fn forces(sequence: &Sequence) -> Vec<Vector3<f64>> {
    sequence.frames.iter().flat_map(|frame| &frame.cords).map(|cord| cord.force).collect()
}

fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

#[test]
fn the_fabrics_are_what_is_known_of_them() {
    let [satin, knit, denim, wool] = fabrics();
    let densities = [&satin, &knit, &denim, &wool].map(|fabric| fabric.areal_density_kg_m2);
    assert_eq!(densities, [0.12, 0.31, 0.46, 0.24]);
    let stretch = |fabric: &KnownFabric| {
        [&fabric.curves.stretch_weft, &fabric.curves.stretch_warp].map(|c| largest(&c.stiffness_n_per_m))
    };
    let bend = |fabric: &KnownFabric| {
        [&fabric.curves.bend_weft, &fabric.curves.bend_warp].map(|c| largest(&c.rigidity_n_m))
    };
    let shear = |fabric: &KnownFabric| largest(&fabric.curves.shear.stiffness_n_per_m);
    let is = |value: f64, expected: f64| assert!((value / expected - 1.0).abs() < 1e-9, "{value} {expected}");
    for isotropic in [&satin, &knit] {
        assert_eq!(isotropic.curves.stretch_weft, isotropic.curves.stretch_warp);
        assert_eq!(isotropic.curves.bend_weft, isotropic.curves.bend_warp);
    }
    is(stretch(&satin)[0] / stretch(&knit)[0], 250.0);
    is(bend(&denim)[0] / bend(&denim)[1], 33.0);
    is(stretch(&wool)[1] / stretch(&wool)[0], 10.0);
    is(bend(&wool)[1] / bend(&wool)[0], 13.0);
    let compliant = |fabric: &KnownFabric| largest(&bend(fabric)) < 0.1 * largest(&bend(&wool));
    assert!(compliant(&satin) && compliant(&knit));
    let others = [&satin, &knit, &wool].map(shear);
    assert!(denim.curves.shear.stiffness_n_per_m.iter().all(|&k| k >= 10.0 * largest(&others)));
    // Nearly linear: the stiffness of the knit varies by a tenth.
    assert!(stretch(&knit)[0] < 1.15 * knit.curves.stretch_weft.stiffness_n_per_m[0]);
}

#[test]
fn every_fabric_can_be_measured_and_fitted() {
    for fabric in fabrics() {
        assert!((1.4..=1.8).contains(&fabric.loading_ratio));
        for (component, points) in fabric.curves.membrane() {
            assert_eq!(points.strain.len(), 9, "{component}");
        }
        // Stress grows with strain everywhere.
        let curves = fabric.curves().unwrap();
        for component in curves.components() {
            let curve = curves.get(component).unwrap();
            let rows = stability_rows(curve.strains()).unwrap();
            let tangents = rows * DVector::from_row_slice(curve.stiffnesses());
            assert!(tangents.min() > 0.05 * curve.stiffnesses()[0], "{} {component}", fabric.name);
        }
        // Ratio of weight to rigidity, Γ = ρgL³/D: below 1 the sheet hardly bends, beyond 100 it hangs straight down.
        for (component, points) in fabric.curves.bending() {
            for overhang in fabric.overhang_m {
                let weight = fabric.areal_density_kg_m2 * GRAVITY * overhang.powi(3) / points.rigidity_n_m[0];
                assert!((0.9..=100.0).contains(&weight), "{} {component}: Γ = {weight}", fabric.name);
            }
        }
    }
}

/// A gap in the checks would admit a value that no test can reach.
#[test]
fn a_figure_that_cannot_be_is_named_with_its_line() {
    let text = include_str!("../fixtures/fabrics/cotton-denim.toml");
    for (from, to, expected) in [
        ("loading_ratio = 1.6", "loading_ratio = 0", "d.toml:16 loading_ratio: found 0, expected"),
        ("[0.055, 0.08]", "[0.08, 0.055]", "d.toml:13 overhang_m: found [0.08, 0.055], expected"),
        ("[0.055, 0.08]", "[0.055, 0.08, 0.1]", "d.toml:13 overhang_m: found"),
        ("[0.055, 0.08]", "[0.055, 0.2]", "d.toml:13 overhang_m[1]: found 0.2, expected"),
        ("\"stvk\"", "\"springs\"", "d.toml:10 model: found springs, expected stvk or soft-constraint"),
        ("stretch-warp = 0.04", "stretch-warp = -1.0", "d.toml:21 largest_extension.stretch-warp: found -1"),
        ("sample_scatter = 0.1\n", "", "d.toml sample_scatter: found nothing"),
        ("rigidity_n_m", "rigidity", "an unknown key"),
        (
            "strain = [0.0, 0.025, 0.05,",
            "strain = [0.0, 0.05, 0.025,",
            "d.toml:32 curves.shear.strain[2]: found 0.025: its strain is not above the one before",
        ),
    ] {
        assert!(text.contains(from), "{from}");
        let error = KnownFabric::parse(Path::new("d.toml"), &text.replace(from, to)).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn clips_cloth_and_cords_are_in_balance() {
    let set = measure(&rig(&[Kind::Shear, Kind::ComplexShear, Kind::CornerPull]));
    let sheet = set.fabric.areal_density_kg_m2 * set.fabric.width_m * set.fabric.height_m;
    for sequence in &set.sequences {
        let mass = if sequence.kind == Kind::CornerPull { 0.0019 } else { 0.0133 };
        assert!(sequence.clips.iter().all(|clip| clip.mass_kg == mass), "{}", sequence.name);
        let clips: f64 = sequence.clips.iter().map(|clip| clip.mass_kg).sum();
        let weight = sequence.gravity * (clips + sheet);
        assert!(weight.z < 0.0);
        for (index, frame) in sequence.frames.iter().enumerate() {
            let cords: Vector3<f64> = frame.cords.iter().map(|cord| cord.force).sum();
            let imbalance = (cords + weight).norm();
            assert!(imbalance < 1e-5, "{} {index}: {imbalance:.2e} N", sequence.name);
        }
        assert!(frame_depth(&sequence.frames[0]) < -5e-4, "{} sags", sequence.name);
    }
}

fn frame_depth(frame: &Frame) -> f64 {
    frame.positions.iter().flatten().fold(0.0, |lowest, p| p.z.min(lowest))
}

#[test]
fn a_picture_frame_stays_one() {
    let set = measure(&rig(&[Kind::Shear]));
    let sequence = &set.sequences[0];
    let place = |frame: &Frame, clip: usize, vertex: usize| {
        frame.poses[clip] * nalgebra::Point3::from(sequence.mesh.positions[vertex])
    };
    for frame in &sequence.frames {
        for (first, second) in [(0, 2), (0, 3), (1, 2), (1, 3)] {
            let [a, b] = [first, second].map(|clip| &sequence.clips[clip].vertices);
            let corners: Vec<_> = a.iter().filter(|vertex| b.contains(vertex)).collect();
            assert_eq!(corners.len(), 1);
            let apart = place(frame, first, *corners[0]) - place(frame, second, *corners[0]);
            assert!(apart.norm() < 1e-15);
        }
    }
    // Sheared to positive w_u·w_v, the bar on the right moves up along itself.
    let frame = &sequence.frames[2];
    let [weft, warp] = [2, 0]
        .map(|clip: usize| frame.poses[clip].rotation)
        .map(|turn| (turn * Vector3::x(), turn * Vector3::y()));
    assert!((weft.0.dot(&warp.1) - denim().largest_shear_rad.sin()).abs() < 1e-12);
    let axial = frame.clip_force(1).unwrap().dot(&warp.1);
    // Buckling reduces it; the tension of the other yarns adds to it.
    let curves = denim().curves().unwrap();
    let flat = curves.get(cloth_sim::material::Component::Shear).unwrap().stress(weft.0.dot(&warp.1)) * 0.1;
    println!("axial {axial:.3} N, {flat:.3} N in the flat");
    assert!(axial > 0.5 * flat && axial < 1.5 * flat);
}

/// A stiff sheet droops by ρgL⁴/8D, level across, regardless of its diagonals.
#[test]
fn a_stiff_sheet_droops_like_a_beam() {
    for kind in [Kind::BendWeft, Kind::BendWarp, Kind::BendBias] {
        for diagonals in [Diagonals::Backward, Diagonals::Alternating] {
            let sequence = stiff(kind, diagonals);
            for (frame, overhang) in sequence.frames.iter().zip(STIFF_OVERHANG) {
                let beam = 0.46 * GRAVITY * overhang.powi(4) / (8.0 * STIFF_RIGIDITY);
                let droop = -frame_depth(frame);
                println!("{kind} {overhang}: {droop:.4e} m, {beam:.4e} m as a beam");
                assert!((droop / beam - 1.0).abs() < 0.01 && frame.phase == Some(Phase::Loading));
                assert!(frame.cords.is_empty() && frame.poses.is_empty());
            }
        }
    }
}

const STIFF_OVERHANG: [f64; 2] = [0.0625, 0.0725];
const STIFF_RIGIDITY: f64 = 0.05;

/// Bending test of a sheet so stiff that it hardly bends.
fn stiff(kind: Kind, diagonals: Diagonals) -> Sequence {
    let mut fabric = denim();
    let curves = &mut fabric.curves;
    for points in [&mut curves.bend_weft, &mut curves.bend_warp, &mut curves.bend_diagonal] {
        (points.curvature_per_m, points.rigidity_n_m) = (vec![0.0], vec![STIFF_RIGIDITY]);
    }
    fabric.overhang_m = STIFF_OVERHANG;
    let mut set = Rig { nodes: [21, 21], diagonals, ..rig(&[kind]) }.measure(&fabric).unwrap();
    set.sequences.remove(0)
}

#[test]
fn a_sequence_depends_on_the_seed_alone() {
    let noisy =
        |sequences: &[Kind], seed| measure(&Rig { noise: true, clip_noise: true, seed, ..rig(sequences) });
    let alone = noisy(&[Kind::StretchWarp], 3);
    let among = noisy(&[Kind::StretchWarp, Kind::Shear, Kind::StretchWeft], 3);
    assert_eq!(among.sequences[1], alone.sequences[0]);
    assert_ne!(noisy(&[Kind::StretchWarp], 4).sequences[0], alone.sequences[0]);
    // Bars hinged together meet, whatever the noise.
    let shear = &among.sequences[0];
    let corner = nalgebra::Point3::from(shear.mesh.positions[0]);
    assert!(
        shear.frames.iter().all(|frame| (frame.poses[0] * corner - frame.poses[2] * corner).norm() < 1e-12)
    );
}

/// 0.075 mm in every coordinate of a vertex and of a bar's centre, 0.075 mm by its length in its turn, 3 mN in every
/// component of a force (Miguel et al. 2012, §3).
#[test]
fn noise_is_normal_and_of_the_published_size() {
    let of = |noise, clip_noise| {
        let mut set = measure(&Rig { noise, clip_noise, frames: 60, ..rig(&[Kind::StretchWeft]) });
        set.sequences.remove(0)
    };
    let [exact, noisy, shaken] = [of(false, false), of(true, false), of(true, true)];
    let declared =
        |clip_m| Some(Noise { position_m: Some(7.5e-5), force_n: Some(3e-3), clip_m: Some(clip_m) });
    assert_eq!([exact.noise, noisy.noise, shaken.noise], [None, declared(0.0), declared(7.5e-5)]);
    let places = |seen: &Sequence| -> Vec<Vector3<f64>> {
        seen.frames.iter().flat_map(|frame| frame.positions.clone().unwrap()).collect()
    };
    let poses = |seen: &Sequence| -> Vec<Isometry3<f64>> {
        seen.frames.iter().flat_map(|frame| frame.poses.clone()).collect()
    };
    // Bars of 100 mm at x = 0 and x = 100 mm.
    let centres = |seen: &Sequence| -> Vec<Vector3<f64>> {
        let centre = |bar: usize| Point3::new(0.1 * bar as f64, 0.05, 0.0);
        poses(seen).iter().enumerate().map(|(index, pose)| (pose * centre(index % 2)).coords).collect()
    };
    let turns = |seen: &Sequence| -> Vec<Vector3<f64>> {
        poses(seen).iter().map(|pose| 0.1 * pose.rotation.scaled_axis()).collect()
    };
    assert_eq!(poses(&noisy), poses(&exact));
    assert_normal("vertices", &places(&noisy), &places(&exact), 7.5e-5);
    assert_normal("forces", &forces(&noisy), &forces(&exact), 3e-3);
    assert_normal("centres of bars", &centres(&shaken), &centres(&exact), 7.5e-5);
    assert_normal("turns of bars", &turns(&shaken), &turns(&exact), 7.5e-5);
}

/// Errors of zero mean and this deviation, normal and independent, within four standard errors.
fn assert_normal(of: &str, seen: &[Vector3<f64>], exact: &[Vector3<f64>], deviation: f64) {
    assert_eq!(seen.len(), exact.len());
    let count = seen.len() as f64;
    let along = |axis: usize| -> Vec<f64> {
        seen.iter().zip(exact).map(|(seen, exact)| (seen[axis] - exact[axis]) / deviation).collect()
    };
    for axis in 0..3 {
        let [errors, others] = [axis, (axis + 1) % 3].map(along);
        let mean = |of: &dyn Fn(usize) -> f64| (0..errors.len()).map(of).sum::<f64>() / count;
        let within = |most: f64| mean(&|i| f64::from(errors[i].abs() < most));
        for (what, found, expected, scatter) in [
            ("mean", mean(&|i| errors[i]), 0.0, 1.0),
            ("variance", mean(&|i| errors[i].powi(2)), 1.0, 2f64.sqrt()),
            ("within σ", within(1.0), 0.6827, 0.4654),
            ("within 2σ", within(2.0), 0.9545, 0.2084),
            ("times that on the next axis", mean(&|i| errors[i] * others[i]), 0.0, 1.0),
            ("times the next", mean(&|i| errors[i] * errors[(i + 1) % errors.len()]), 0.0, 1.0),
        ] {
            let off = (found - expected) / (scatter / count.sqrt());
            println!("{count} {of}, axis {axis}: {what} {found:.4}, {off:.1} standard errors off");
            assert!(off.abs() < 4.0, "{of}, axis {axis}: {what} {found}");
        }
    }
}

#[test]
fn every_sequence_is_made_and_named() {
    let set = measure(&Rig { frames: 1, ..rig(&KINDS) });
    let names: Vec<String> = set.sequences.iter().map(|sequence| sequence.name.clone()).collect();
    assert_eq!(names, KINDS.map(|kind| kind.to_string()));
    for twice in [vec![], vec![Kind::Shear, Kind::Shear], vec![Kind::StretchBias]] {
        assert!(rig(&twice).measure(&denim()).is_err());
    }
}

#[test]
fn hysteresis_is_seen_and_leaves_the_mean() {
    let plain = rig(&[Kind::StretchWeft]);
    let exact = forces(&measure(&plain).sequences[0]);
    // Frames 1 and 3 have the same position, once loading and once unloading; two clips each.
    let middle = |rig: &Rig| {
        let forces = forces(&measure(rig).sequences[0]);
        [forces[0], forces[4]].map(|force| force.norm())
    };
    let force = exact[0].norm();
    assert!((exact[4].norm() - force).abs() < 1e-6 * force);
    let [loading, unloading] = middle(&Rig { cord_hysteresis: true, ..plain.clone() });
    assert!((loading - force - 0.05).abs() < 1e-5 && (force - unloading - 0.05).abs() < 1e-5);
    let [loading, unloading] = middle(&Rig { fabric_hysteresis: true, ..plain });
    assert!((loading / unloading - denim().loading_ratio).abs() < 1e-5);
    assert!((0.5 * (loading + unloading) / force - 1.0).abs() < 1e-5);
}

#[test]
fn another_sample_is_another_specimen_of_the_same_fabric() {
    let fabric = denim();
    assert_eq!(fabric.sample(1), fabric);
    let second = fabric.sample(2);
    assert_eq!((second.name.as_str(), &second), ("cotton-denim.2", &fabric.sample(2)));
    let factors: Vec<f64> = (2..402)
        .map(|number| fabric.sample(number).curves.shear.stiffness_n_per_m[3])
        .map(|k| (k / fabric.curves.shear.stiffness_n_per_m[3]).ln())
        .collect();
    let scatter = (factors.iter().map(|f| f * f).sum::<f64>() / 400.0).sqrt();
    assert!((scatter / fabric.sample_scatter - 1.0).abs() < 0.15, "{scatter}");
    let set = measure(&Rig { sample: 2, ..rig(&[Kind::StretchWeft]) });
    assert_eq!(set.fabric.name, "cotton-denim.2");
    let first = forces(&measure(&rig(&[Kind::StretchWeft])).sequences[0]);
    let ratio = forces(&set.sequences[0])[1].x / first[1].x;
    let factor = second.curves.stretch_weft.stiffness_n_per_m[0] / 420.0;
    println!("force × {ratio:.3}, stretch curve × {factor:.3}");
    assert!((ratio / factor - 1.0).abs() < 0.02);
}
