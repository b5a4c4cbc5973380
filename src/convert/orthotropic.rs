//! *ELASTIC, TYPE=ENGINEERING CONSTANTS and TYPE=ORTHO.

use crate::error::Result;
use crate::mesh::abaqus::Card;
use crate::solid::material::Orthotropy;
use crate::{Mat3, Vec3};
use std::fmt::Write;

/// The constants of a card, without axes.
pub(super) fn read(card: &Card, are_engineering: bool) -> Result<Orthotropy> {
    let [first, second] = &card.rows[..] else {
        let what = format!("*ELASTIC has {} lines of data, not two", card.rows.len());
        return Err(card.error(what, "8 constants and one more; nagata has no temperatures: keep those of one"));
    };
    let (mut numbers, fields) = ([0.0; 9], (first.fields::<8>(), second.fields::<1>()));
    for (k, field) in fields.0.into_iter().enumerate() {
        numbers[k] = first.number(field, 0.0)?;
    }
    numbers[8] = second.number(fields.1[0], 0.0)?;
    let [a, b, c, d, e, f, g, h, i] = numbers;
    let (young, poisson) = match are_engineering {
        true => ([a, b, c], [d, e, f]),
        false => {
            // D1111, D1122, D2222, D1133, D2233, D3333.
            let moduli = Mat3::new(a, b, d, b, c, e, d, e, f);
            let s = moduli.try_inverse().unwrap_or_default();
            let young = [0, 1, 2].map(|k| 1.0 / s[(k, k)]);
            (young, [(0, 1), (0, 2), (1, 2)].map(|(i, j)| -s[(i, j)] * young[i]))
        }
    };
    let constants = Orthotropy { young, poisson, shear: [g, h, i], axes: Mat3::identity() };
    match young.iter().all(|young| *young > 0.0 && young.is_finite()) && constants.moduli().is_some() {
        true => Ok(constants),
        false => Err(card.error("some strain would store no energy, or less, with these constants", "")),
    }
}

/// The lines of the scene, with the first two axes where these are not x and y.
pub(super) fn write(constants: &Orthotropy, axes: Option<[Vec3; 2]>) -> String {
    let Orthotropy { young: [e1, e2, e3], poisson: [nu12, nu13, nu23], shear: [g12, g13, g23], .. } = constants;
    let mut text = format!(
        "model = \"orthotropic\"\n\
         orthotropic = {{ e1 = {e1:?}, e2 = {e2:?}, e3 = {e3:?}, nu12 = {nu12:?}, nu13 = {nu13:?}, nu23 = {nu23:?}, \
         g12 = {g12:?}, g13 = {g13:?}, g23 = {g23:?}"
    );
    if let Some(axes) = axes {
        let [x, y] = axes.map(|axis| [axis.x, axis.y, axis.z]);
        let _ = write!(text, ", x = {x:?}, y = {y:?}");
    }
    text + " }\n"
}
