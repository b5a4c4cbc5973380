//! Transformation matrices (124): x becomes R x + T.

use super::entry::Entry;
use super::file::File;
use super::parameters::Parameters;
use crate::error::Result;
use crate::{Mat3, Vec3};

/// R and T.
pub(super) type Transform = (Mat3, Vec3);

/// How many matrices may act one after the other.
const MOST: usize = 32;

/// What the directory applies to an entity, and then to that matrix, and so on; `None` where it applies nothing.
pub(super) fn of(file: &File, entry: &Entry) -> Result<Option<Transform>> {
    let mut total: Option<Transform> = None;
    let mut pointer = entry.matrix;
    for _ in 0..MOST {
        if pointer == 0 {
            return Ok(total);
        }
        let Some(matrix) = file.entry_at(pointer).filter(|matrix| matrix.kind == 124) else {
            let what = format!("D{pointer}, which is to transform it, is no transformation matrix (124)");
            return Err(file.entry_error(entry, what, "0 is for none"));
        };
        let mut parameters = Parameters::new(file, matrix)?;
        let rows: [f64; 12] = parameters.reals("a coefficient of a matrix")?;
        let rotation = Mat3::from_fn(|i, j| rows[4 * i + j]);
        let shift = Vec3::from_fn(|i, _| rows[4 * i + 3]);
        if rotation.determinant().abs() < 1e-6 * rotation.norm().powi(3) {
            return Err(parameters.error("the matrix maps space on a plane", "a rotation has the determinant 1"));
        }
        total = Some(total.map_or((rotation, shift), |(r, t)| (rotation * r, rotation * t + shift)));
        pointer = matrix.matrix;
    }
    Err(file.entry_error(entry, format!("more than {MOST} matrices transform it"), "they may form a circle"))
}
