//! Least-squares rigid motion between point pairs.

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};

/// Regularisation for points on a line or at one spot, as a share of their size.
const DEGENERATE: f64 = 1e-6;

/// Rotation that best maps the first of each pair to the second; the smallest one if it is not unique. The identity
/// without pairs, if all are zero, or if one is not finite.
///
/// Source: Kabsch 1976, by singular value decomposition.
pub fn nearest_rotation(pairs: impl Iterator<Item = [Vector3<f64>; 2]>) -> UnitQuaternion<f64> {
    let (mut moment, mut size) = (Matrix3::zeros(), 0.0);
    for [before, after] in pairs {
        moment += after * before.transpose();
        size += before.norm_squared() + after.norm_squared();
    }
    let mut rotation = Matrix3::identity();
    // Negated so that a NaN gives the identity, too.
    if !(size > 0.0 && size.is_finite()) {
        return UnitQuaternion::identity();
    }
    // Points on a line do not determine the angle about it: the current rotation does, starting from the identity. If
    // the points do determine it, each round reduces the effect of the regularisation to a millionth.
    for _ in 0..3 {
        let svd = (moment + rotation * (DEGENERATE * size)).svd(true, true);
        let (Some(u), Some(v)) = (svd.u, svd.v_t) else { return UnitQuaternion::identity() };
        let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, (u * v).determinant().signum()));
        rotation = u * mirror * v;
    }
    // A quaternion also represents the axis of a half turn.
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation))
}

/// Rigid motion that best maps the first of each pair to the second: the [`nearest_rotation`] about the centroid. The
/// identity without pairs, or if one is not finite.
pub fn nearest_motion(pairs: &[[Vector3<f64>; 2]]) -> Isometry3<f64> {
    let middle = |side: usize| pairs.iter().map(|pair| pair[side]).sum::<Vector3<f64>>() / pairs.len() as f64;
    let [before, after] = [middle(0), middle(1)];
    if !(before + after).iter().all(|c| c.is_finite()) {
        return Isometry3::identity();
    }
    let rotation = nearest_rotation(pairs.iter().map(|[from, to]| [from - before, to - after]));
    Isometry3::from_parts(Translation3::from(after - rotation * before), rotation)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    #[test]
    fn a_rigid_motion_of_flat_points_is_found_to_the_last_digits() {
        let points = [[0.0, 0.0], [0.1, 0.0], [0.0, 0.04], [0.1, 0.04]].map(|[x, y]| Vector3::new(x, y, 0.0));
        for angle in [0.0, 0.3, 1.5, 3.1, std::f64::consts::PI] {
            for axis in [Vector3::x(), Vector3::y(), Vector3::z(), Vector3::new(0.6, -0.5, 0.3).normalize()] {
                let motion = Isometry3::new(Vector3::new(3.0, -2.0, 1.0), axis * angle);
                let pairs = points.map(|p| [p, (motion * Point3::from(p)).coords]);
                let found = nearest_motion(&pairs);
                for [from, to] in pairs {
                    let apart = ((found * Point3::from(from)).coords - to).norm();
                    assert!(apart < 1e-14, "{angle}, {axis:?}: {apart:e}");
                }
            }
        }
    }

    #[test]
    fn points_on_a_line_turn_no_more_than_the_line() {
        let points = [0.0, 0.1, 0.2].map(|x| Vector3::x() * x);
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 1.0);
        let found = nearest_rotation(points.into_iter().map(|p| [p, turn * p]));
        assert!(found.angle_to(&turn) < 1e-9, "{found:?}");
        assert_eq!(nearest_motion(&[]), Isometry3::identity());
        assert_eq!(nearest_motion(&[[Vector3::x(), Vector3::repeat(f64::NAN)]]), Isometry3::identity());
    }
}
