//! Checks sizes against each other and against plausible ranges: the specimen and its sample, the extension, gravity,
//! and areal density.

use crate::frame::{Fabric, Sequence};
use crate::measure::{affine_map, clip_centres, mean};
use crate::notice::{Notice, Severity};
use crate::rectangle::rest_size;
use cloth_sim::mesh::Mesh;
use nalgebra::{Vector2, Vector3};
use std::ops::RangeInclusive;

/// Other units per metre.
const UNITS: [(f64, &str); 3] = [(1000.0, "millimetres"), (100.0, "centimetres"), (39.37, "inches")];
/// Allowed relative deviation of two sides from a unit ratio: meshes with and without the clipped parts describe one
/// specimen.
const SAME: f64 = 0.05;
/// Size ratio that indicates another unit. A smaller ratio is legitimate: the sample of a set may be its first strip,
/// and another strip may be longer.
const LARGER: f64 = 5.0;
/// Size beyond any laboratory specimen, m.
const LARGE: f64 = 2.0;
/// Stretch ratio beyond almost all cloth, except elastic tapes.
const STRETCHED: f64 = 4.0;
/// Gravity on earth from the equator to the poles, m/s²; bending stiffness is proportional to it.
const GRAVITY: RangeInclusive<f64> = 9.76..=9.84;
/// Range of rounded values in another unit.
const ROUNDED: RangeInclusive<f64> = 9.5..=10.2;
/// Gravity in other units, relative to m/s².
const GRAVITY_UNITS: [(f64, &str); 4] = [
    (100.0, "cm/s²: divide by 100"),
    (1000.0, "mm/s²: divide by 1000"),
    (1.0 / 9.81, "multiples of g: multiply by 9.81"),
    (3.2808, "ft/s²: multiply by 0.3048"),
];
/// Areal density of fabrics, kg/m²: from chiffon to the heaviest canvas.
const AREAL_DENSITY: RangeInclusive<f64> = 0.01..=3.0;

/// Allowed relative difference between rest lengths and material coordinates, in addition to a multiple of its error;
/// below the strains at which a stiff cloth is measured.
const SAME_REST: f64 = 5e-4;
const SURE: f64 = 4.0;

/// Compares the specimen with its sample, material coordinates with the rest shape, and clip distances with those at
/// rest; checks gravity and areal density for plausibility.
pub(super) fn check(fabric: &Fabric, sequence: &mut Sequence, notices: &mut Vec<Notice>) {
    let found = [
        specimen(fabric, sequence),
        separation(sequence),
        gravity(&sequence.gravity),
        areal_density(fabric, sequence),
        material(sequence),
    ];
    notices.extend(found.into_iter().flatten().map(|(severity, place, found, expected)| {
        Notice::new(severity, &sequence.name, place, found, expected)
    }));
}

/// Severity, place, found and expected of a notice.
type Finding = (Severity, &'static str, String, String);

fn specimen(fabric: &Fabric, sequence: &Sequence) -> Option<Finding> {
    // A specimen that is not a rectangle is refused when its grid is made.
    let size = ascending(rest_size(sequence).ok()?);
    let sample = ascending([fabric.width_m, fabric.height_m]);
    let sizes = |[short, long]: [f64; 2]| format!("{long:.3} × {short:.3} m");
    let found = format!("a specimen of {}, and in fabric.toml a sample of {}", sizes(size), sizes(sample));
    let times = [size[0] / sample[0], size[1] / sample[1]];
    let unit_of = |times: [f64; 2]| {
        UNITS.into_iter().find(|(unit, _)| times.iter().all(|times| (times / unit - 1.0).abs() < SAME))
    };
    if let Some((by, unit)) = unit_of(times) {
        let expected =
            format!("metres in both ({unit}? divide v and vt, and everything else in {unit}, by {by})");
        return Some((Severity::Refusal, "mesh.obj v", found, expected));
    }
    if let Some((by, unit)) = unit_of(times.map(f64::recip)) {
        let expected = format!("metres in both ({unit}? divide width_m and height_m in fabric.toml by {by})");
        return Some((Severity::Refusal, "mesh.obj v", found, expected));
    }
    if size[1] > LARGER * sample[1] {
        let expected = "a specimen that can be cut from the sample, both in metres".into();
        return Some((Severity::Doubt, "mesh.obj v", found, expected));
    }
    (size[1] > LARGE).then(|| {
        let found = format!("a specimen of {}", sizes(size));
        (Severity::Doubt, "mesh.obj v", found, format!("at most {LARGE} m (centimetres? divide by 100)"))
    })
}

fn separation(sequence: &Sequence) -> Option<Finding> {
    let apart = |centres: &[Vector3<f64>]| {
        centres.iter().map(|centre| (centre - centres[0]).norm()).fold(0.0, f64::max)
    };
    let centre = |vertices: &[usize]| {
        let sum: Vector3<f64> = vertices.iter().map(|&vertex| sequence.mesh.positions[vertex]).sum();
        sum / vertices.len() as f64
    };
    let rest = apart(&sequence.clips.iter().map(|clip| centre(&clip.vertices)).collect::<Vec<_>>());
    let frames = sequence.frames.iter().map(|frame| apart(&clip_centres(sequence, frame)));
    let (frame, most) = frames.enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b))?;
    (most > STRETCHED * rest && rest > 0.0).then(|| {
        let found =
            format!("clips {most:.3} m apart in frame {frame}, {:.1} times as far as at rest", most / rest);
        let expected =
            "metres (centimetres? divide tx_m, ty_m and tz_m by 100), or a fabric that stretches this far";
        (Severity::Doubt, "clips.csv tx_m", found, expected.into())
    })
}

fn gravity(gravity: &Vector3<f64>) -> Option<Finding> {
    let size = gravity.norm();
    if size == 0.0 || GRAVITY.contains(&size) {
        return None;
    }
    let found = format!("{size:.4} m/s²");
    let unit = GRAVITY_UNITS.into_iter().find(|(unit, _)| ROUNDED.contains(&(size / unit)));
    let (severity, remedy) = unit
        .map_or((Severity::Doubt, "or zero, which leaves weight out"), |(_, remedy)| {
            (Severity::Refusal, remedy)
        });
    Some((severity, "test.toml gravity_m_s2", found, format!("9.81 m/s² in all ({remedy})")))
}

fn areal_density(fabric: &Fabric, sequence: &Sequence) -> Option<Finding> {
    let density = fabric.areal_density_kg_m2;
    let counts = sequence.gravity != Vector3::zeros();
    (counts && !AREAL_DENSITY.contains(&density)).then(|| {
        let remedy = if density > 3.0 { " (g/m²? divide by 1000)" } else { "" };
        let [low, high] = [AREAL_DENSITY.start(), AREAL_DENSITY.end()];
        let expected = format!("{low} to {high} kg/m², the range of cloth{remedy}");
        (Severity::Doubt, "fabric.toml areal_density_kg_m2", format!("{density} kg/m²"), expected)
    })
}

/// Rest positions as an affine map of material coordinates, x = A m + b; A must not stretch.
fn material(sequence: &Sequence) -> Option<Finding> {
    let Mesh { material, positions, .. } = &sequence.mesh;
    let map = affine_map(material, positions)?;
    let apart = |(m, x): (&Vector2<f64>, &Vector3<f64>)| x - map * m;
    let middle = mean(material.iter().zip(positions).map(apart));
    let residual: f64 =
        material.iter().zip(positions).map(|pair| (apart(pair) - middle).norm_squared()).sum();
    // The slope of a line through points spread evenly over the shorter side.
    let [side, _] = ascending(rest_size(sequence).ok()?);
    let error = (12.0 * residual).sqrt() / (material.len() as f64 * side);
    let stretches = map.singular_values().map(|stretch| stretch - 1.0);
    let off = if stretches[0].abs() > stretches[1].abs() { stretches[0] } else { stretches[1] };
    (sequence.table.is_none() && off.abs() > f64::max(SAME_REST, SURE * error)).then(|| {
        let found = format!(
            "a specimen at rest {:.2} % {} than its material coordinates vt",
            100.0 * off.abs(),
            if off > 0.0 { "longer" } else { "shorter" }
        );
        let expected = "the same lengths: v flat and free, and vt along weft and warp in metres; a difference counts as strain";
        (Severity::Doubt, "mesh.obj v", found, expected.into())
    })
}

fn ascending([a, b]: [f64; 2]) -> [f64; 2] {
    [a.min(b), a.max(b)]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::frame::{Clip, Frame, Kind};
    use cloth_sim::mesh::{Diagonals, Grid};
    use nalgebra::Isometry3;

    /// A strip of the given length, pulled to a multiple of it.
    fn strip(length: f64, width: f64, times: f64, gravity: f64) -> Sequence {
        let grid = Grid { columns: 2, rows: 2, width: length, height: width, diagonals: Diagonals::Forward };
        let clip = |name: &str, vertices: [usize; 2]| Clip {
            name: name.into(),
            mass_kg: 0.0,
            vertices: vertices.into(),
        };
        let shift = |by: f64| Isometry3::translation(by, 0.0, 0.0);
        let frame = |by| Frame { poses: vec![shift(0.0), shift(by)], ..Frame::default() };
        Sequence {
            name: "strip".into(),
            kind: Kind::StretchWeft,
            gravity: Vector3::new(0.0, 0.6, -0.8) * gravity,
            noise: None,
            force_direction: None,
            table: None,
            mesh: grid.mesh().unwrap(),
            clips: vec![clip("fixed", [0, 2]), clip("moving", [1, 3])],
            frames: vec![frame(0.0), frame((times - 1.0) * length)],
        }
    }

    /// Notices for a sample of 80 × 40 mm.
    fn noticed_of(mut sequence: Sequence, density: f64) -> Vec<String> {
        let fabric = Fabric {
            name: "knit".into(),
            width_m: 0.08,
            height_m: 0.04,
            areal_density_kg_m2: density,
            thickness_m: None,
            source: None,
            notes: None,
        };
        let mut notices = Vec::new();
        check(&fabric, &mut sequence, &mut notices);
        notices.iter().map(|notice| format!("{:?}: {notice}", notice.severity)).collect()
    }

    fn noticed(length: f64, width: f64, times: f64, gravity: f64, density: f64) -> Vec<String> {
        noticed_of(strip(length, width, times, gravity), density)
    }

    #[test]
    fn what_can_be_is_no_notice() {
        for gravity in [0.0, 9.81, 9.78, 9.83] {
            assert_eq!(noticed(0.08, 0.04, 1.1, gravity, 0.3), [""; 0]);
        }
        // A part of the sample, cut either way; a strip other than the first; a tape.
        for (length, width, times) in
            [(0.02, 0.01, 1.0), (0.04, 0.08, 1.3), (0.2, 0.04, 1.0), (0.08, 0.04, 3.9)]
        {
            assert_eq!(noticed(length, width, times, 9.81, 0.02), [""; 0], "{length}");
        }
        // Areal density does not matter without gravity.
        assert_eq!(noticed(0.08, 0.04, 1.0, 0.0, 8.0), [""; 0]);
    }

    #[test]
    fn a_specimen_in_another_unit_than_its_sample_is_refused_with_both_sizes() {
        let both =
            "mesh.obj v: found a specimen of 8.000 × 4.000 m, and in fabric.toml a sample of 0.080 × 0.040 m";
        let expected =
            "metres in both (centimetres? divide v and vt, and everything else in centimetres, by 100)";
        let found = noticed(8.0, 4.0, 1.1, 0.0, 0.3);
        assert_eq!(found, [format!("Refusal: sequence strip, {both}, expected {expected}")]);
        for (factor, unit) in [(1000.0, "millimetres"), (39.37, "inches")] {
            let found = noticed(0.0786 * factor, 0.0403 * factor, 1.0, 0.0, 0.3);
            assert!(found[0].starts_with("Refusal") && found[0].contains(unit), "{found:?}");
            let found = noticed(0.08 / factor, 0.04 / factor, 1.0, 0.0, 0.3);
            let remedy = format!("({unit}? divide width_m and height_m in fabric.toml by {factor})");
            assert!(found[0].starts_with("Refusal") && found[0].contains(&remedy), "{found:?}");
        }
        // No unit matches this ratio: a doubt, not a refusal.
        let found = noticed(1.0, 0.03, 1.0, 0.0, 0.3);
        assert!(found[0].starts_with("Doubt") && found[0].contains("cut from the sample"), "{found:?}");
    }

    #[test]
    fn clips_several_times_as_far_apart_as_at_rest_are_doubted() {
        let found = noticed(0.08, 0.04, 6.0, 0.0, 0.3);
        let expected = "Doubt: sequence strip, clips.csv tx_m: found clips 0.480 m apart in frame 1, 6.0 times as far as at rest";
        assert!(found[0].starts_with(expected) && found[0].contains("centimetres?"), "{found:?}");
    }

    #[test]
    fn gravity_is_that_of_earth_in_metres_or_none() {
        for (gravity, unit) in
            [(981.0, "cm/s²"), (9810.0, "mm/s²"), (1.0, "multiples of g"), (32.17, "ft/s²")]
        {
            let found = noticed(0.08, 0.04, 1.0, gravity, 0.3);
            let expected =
                format!("gravity_m_s2: found {gravity:.4} m/s², expected 9.81 m/s² in all ({unit}");
            assert!(found[0].starts_with("Refusal") && found[0].contains(&expected), "{found:?}");
        }
        for gravity in [5.0, 10.0] {
            assert!(noticed(0.08, 0.04, 1.0, gravity, 0.3)[0].starts_with("Doubt"));
        }
    }

    #[test]
    fn a_rest_shape_that_is_not_as_long_as_its_material_coordinates_is_doubted() {
        for (factor, said) in [(0.99, "1.01 % longer"), (1.002, "0.20 % shorter")] {
            let mut sequence = strip(0.08, 0.04, 1.1, 0.0);
            sequence.mesh.material.iter_mut().for_each(|m| m.x *= factor);
            let found = noticed_of(sequence, 0.3);
            assert!(found[0].starts_with("Doubt") && found[0].contains(said), "{found:?}");
        }
        let mut sequence = strip(0.08, 0.04, 1.1, 0.0);
        sequence.mesh.material.iter_mut().for_each(|m| *m *= 1.0003);
        assert_eq!(noticed_of(sequence, 0.3), [""; 0]);
    }

    #[test]
    fn an_areal_density_that_no_cloth_has_is_doubted_where_it_has_weight() {
        let found = noticed(0.08, 0.04, 1.0, 9.81, 5.0);
        assert!(found[0].starts_with("Doubt") && found[0].contains("g/m²? divide by 1000"), "{found:?}");
        assert!(noticed(0.08, 0.04, 1.0, 9.81, 3e-3)[0].contains("0.01 to 3 kg/m²"));
    }
}
