//! The rigid motion that takes points nearest to others.

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};

/// What stands for the size of points that lie on a line, or on one spot, as a share of theirs.
const DEGENERATE: f64 = 1e-6;

/// The rotation that takes the first of each pair nearest to the second; where several do, the one that turns least.
/// The identity where there is no pair, or none but zeros, or one that is not finite.
///
/// Source: Kabsch 1976, by the singular value decomposition.
pub fn nearest_rotation(pairs: impl Iterator<Item = [Vector3<f64>; 2]>) -> UnitQuaternion<f64> {
    let (mut moment, mut size) = (Matrix3::zeros(), 0.0);
    for [before, after] in pairs {
        moment += after * before.transpose();
        size += before.norm_squared() + after.norm_squared();
    }
    let mut rotation = Matrix3::identity();
    // Written so that a NaN does not turn either.
    if !(size > 0.0 && size.is_finite()) {
        return UnitQuaternion::identity();
    }
    // Points on a line have no angle about it: the rotation so far decides, at first none. Where they have one, each round
    // takes away all but a millionth of what that does to it.
    for _ in 0..3 {
        let svd = (moment + rotation * (DEGENERATE * size)).svd(true, true);
        let (Some(u), Some(v)) = (svd.u, svd.v_t) else { return UnitQuaternion::identity() };
        let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, (u * v).determinant().signum()));
        rotation = u * mirror * v;
    }
    // A quaternion knows the axis of half a turn, too.
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation))
}

/// The rigid motion that takes the first of each pair nearest to the second, with the [`nearest_rotation`] about their
/// middle. The identity where there is no pair, or one that is not finite.
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
