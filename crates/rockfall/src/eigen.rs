//! Eigenvalues of symmetric matrices.

/// Number of sweeps of the eigenvalue iteration. It converges quadratically: six sweeps reach the rounding error.
const SWEEPS: usize = 12;

/// Eigenvalues and eigenvectors (columns) of a symmetric matrix, by cyclic Jacobi rotations.
pub(crate) fn eigen(mut a: [[f64; 3]; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
    let mut vectors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..SWEEPS {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            // The rotation that makes the element 0: tan t of the angle of at most 45 degrees.
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
            let c = 1.0 / t.hypot(1.0);
            let s = t * c;
            let turn = |x: &mut [f64; 3]| (x[p], x[q]) = (c * x[p] - s * x[q], s * x[p] + c * x[q]);
            a.iter_mut().for_each(turn);
            let (ap, aq) = (a[p], a[q]);
            a[p] = std::array::from_fn(|column| c * ap[column] - s * aq[column]);
            a[q] = std::array::from_fn(|column| s * ap[column] + c * aq[column]);
            vectors.iter_mut().for_each(turn);
            (a[p][q], a[q][p]) = (0.0, 0.0);
        }
    }
    ([a[0][0], a[1][1], a[2][2]], vectors)
}
