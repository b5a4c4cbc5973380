//! What a solve costs, before it is made.

/// Bytes of a factor entry with its share of indices and workspace.
const BYTES_PER_ENTRY: f64 = 16.0;

/// Memory of a factorization by MUMPS, MB, of a matrix with so many entries: factors of meshes in space grow with n^(4/3); the
/// constant is measured on hexahedra with SCOTCH.
pub fn megabytes(unknowns: u64, entries: f64, symmetric: bool) -> f64 {
    let factor = 18.0 * (unknowns as f64).powf(4.0 / 3.0) * if symmetric { 1.0 } else { 2.0 };
    (BYTES_PER_ENTRY * (factor + 2.0 * entries) / 1e6).ceil()
}
