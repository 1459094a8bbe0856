//! Principal axes: a symmetric tensor made diagonal by Jacobi rotations.
//!
//! Only + - * / and square roots, a fixed order and a fixed number of sweeps: the same bits everywhere.

use glam::{DMat3, DQuat, DVec3};

/// Off-diagonal parts below this part of the trace are rounding (of `f32` vertices) and left alone.
const NEGLIGIBLE: f64 = 1e-6;
/// Sweeps over the three off-diagonal entries; convergence is quadratic, 4 to 6 are usual.
const SWEEPS: usize = 12;

/// Principal moments and the rotation from the principal axes to the frame of the tensor.
///
/// The rotation is the identity when the tensor is diagonal to rounding, and otherwise, of all orders and signs of the axes, the
/// right-handed one closest to it.
pub(super) fn diagonalise(tensor: DMat3) -> (DVec3, DQuat) {
    let diagonal = |m: &DMat3| DVec3::new(m.x_axis.x, m.y_axis.y, m.z_axis.z);
    let trace = diagonal(&tensor).element_sum();
    let largest_off = tensor.x_axis.y.abs().max(tensor.x_axis.z.abs()).max(tensor.y_axis.z.abs());
    if largest_off <= NEGLIGIBLE * trace {
        return (diagonal(&tensor), DQuat::IDENTITY);
    }
    let (mut a, mut axes) = (tensor, DMat3::IDENTITY);
    for _ in 0..SWEEPS {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate_away(&mut a, &mut axes, p, q);
        }
    }
    let (order, axes) = closest_to_identity(&axes);
    let moments = diagonal(&a);
    let rotation = DQuat::from_mat3(&axes).normalize();
    (DVec3::new(moments[order[0]], moments[order[1]], moments[order[2]]), rotation)
}

/// One Jacobi rotation in the plane of axes p and q that makes a[p][q] zero (Golub and Van Loan, section 8.5).
fn rotate_away(a: &mut DMat3, axes: &mut DMat3, p: usize, q: usize) {
    let off = a.col(q)[p];
    if off == 0.0 {
        return;
    }
    let tau = (a.col(q)[q] - a.col(p)[p]) / (2.0 * off);
    let t = if tau >= 0.0 {
        1.0 / (tau + (1.0 + tau * tau).sqrt())
    } else {
        1.0 / (tau - (1.0 + tau * tau).sqrt())
    };
    let c = 1.0 / (1.0 + t * t).sqrt();
    let s = t * c;
    let mut j = DMat3::IDENTITY;
    j.col_mut(p)[p] = c;
    j.col_mut(q)[q] = c;
    j.col_mut(q)[p] = s;
    j.col_mut(p)[q] = -s;
    *a = j.transpose() * *a * j;
    *axes *= j;
}

/// Orders and turns the columns so that the matrix is a rotation as close as can be to the identity; also says which column went where.
fn closest_to_identity(axes: &DMat3) -> ([usize; 3], DMat3) {
    const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    let mut best = (f64::NEG_INFINITY, ORDERS[0], DMat3::IDENTITY);
    for order in ORDERS {
        for signs in 0..8_u32 {
            let column = |i: usize| {
                let axis = axes.col(order[i]);
                if signs & (1 << i) == 0 { axis } else { -axis }
            };
            let m = DMat3::from_cols(column(0), column(1), column(2));
            // The trace of a rotation is 1 + 2 cos(angle). A mirrored one has -1 + 2 cos(angle), at most 1, and never wins: some rotation is
            // within 63 degrees of the identity.
            let trace = m.x_axis.x + m.y_axis.y + m.z_axis.z;
            if trace > best.0 {
                best = (trace, order, m);
            }
        }
    }
    (best.1, best.2)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit(x: f64, y: f64, z: f64, w: f64) -> DQuat {
        DQuat::from_xyzw(x, y, z, w).normalize()
    }

    #[test]
    fn finds_the_rotation_that_made_the_tensor() {
        let moments = DVec3::new(1.0, 2.0, 4.0);
        for q in [unit(0.1, 0.2, -0.1, 1.0), unit(0.0, 0.3, 0.0, 1.0), unit(-0.2, 0.1, 0.25, 1.0)] {
            let r = DMat3::from_quat(q);
            let tensor = r * DMat3::from_diagonal(moments) * r.transpose();
            let (found, rotation) = diagonalise(tensor);
            assert!((found - moments).length() < 1e-12, "{found}");
            assert!(rotation.dot(q).abs() > 1.0 - 1e-12, "{rotation} for {q}");
        }
    }

    #[test]
    fn whatever_the_rotation_the_axes_are_right_handed_and_near() {
        for i in 0..2000_u32 {
            let at = |k: u32| f64::from((i * 7919 + k * 104_729) % 1999) - 999.0;
            let r = DMat3::from_quat(unit(at(1), at(2), at(3), at(4)));
            let tensor = r * DMat3::from_diagonal(DVec3::new(3.0, 2.0, 4.0)) * r.transpose();
            let (moments, rotation) = diagonalise(tensor);
            let m = DMat3::from_quat(rotation);
            assert!((m * DMat3::from_diagonal(moments) * m.transpose()).abs_diff_eq(tensor, 1e-12));
            assert!(rotation.w.abs() > 0.85, "{rotation} turns by more than 63 degrees");
        }
    }

    #[test]
    fn leaves_nearly_diagonal_tensors_alone() {
        let mut tensor = DMat3::from_diagonal(DVec3::new(3.0, 3.0, 3.0));
        tensor.x_axis.y = 1e-7;
        tensor.y_axis.x = 1e-7;
        assert_eq!(diagonalise(tensor), (DVec3::splat(3.0), DQuat::IDENTITY));
    }

    #[test]
    fn equal_moments_still_give_a_rotation() {
        let q = unit(0.5, 0.1, 0.3, 1.0);
        let r = DMat3::from_quat(q);
        let tensor = r * DMat3::from_diagonal(DVec3::new(1.0, 5.0, 1.0)) * r.transpose();
        let (moments, rotation) = diagonalise(tensor);
        let m = DMat3::from_quat(rotation);
        let again = m * DMat3::from_diagonal(moments) * m.transpose();
        assert!((again - tensor).abs_diff_eq(DMat3::ZERO, 1e-12));
        assert!((m.determinant() - 1.0).abs() < 1e-12);
    }
}
