//! 8-node hexahedron with enhanced assumed strain: bends with one layer of elements, and does not lock when nearly
//! incompressible.
//!
//! Twelve modes in the form of `enhanced.rs`: component (i, j) of E times xi_i, and the unit tensor times
//! xi eta, eta zeta, zeta xi. The first nine are the transposed modes of Wilson (Glaser and Armero, Eng. Comput. 14, 1997;
//! Pfefferkorn and Betsch, IJNME 120, 2019): in small strains those of incompatible displacements 1 - xi_j^2, which have xi_j
//! in place of xi_i, but stable in compression, where these hourglass. The last three (Simo, Armero and Taylor, CMAME 110,
//! 1993) free the volume from its products of two parameters. For a law with an energy the
//! forces derive from it and the tangent is symmetric. Walls that lean against each other stiffen the element in bending, as
//! any with 24 degrees of freedom that passes the patch test (MacNeal, Finite Elem. Anal. Des. 3, 1987).
//!
//! An element for which no amplitudes are found is reported as inverted.

use super::enhanced::{self, Rule};
pub use super::enhanced::{Modes, VOLUME};
use super::{ElementMatrices, Inverted, Medium, Sample, hex8};

/// Integration points.
pub const POINTS: usize = hex8::POINTS;

const RULE: Rule<8, POINTS> = Rule { gradients: &hex8::GRADIENTS, centre: &hex8::CENTRE, depth: 0.0 };

/// The modes of the element; parameters are those of the nodes, as the size of amplitudes is free.
const MODES: Modes<12, POINTS> = {
    let mut modes = Modes { components: [VOLUME; 12], amplitudes: [[0.0; 12]; POINTS] };
    let mut m = 0;
    while m < 12 {
        if m < 9 {
            modes.components[m] = m;
        }
        let mut q = 0;
        while q < POINTS {
            let at = hex8::NODES[q];
            modes.amplitudes[q][m] = if m < 9 { at[m / 3] } else { at[m % 3] * at[(m + 1) % 3] };
            q += 1;
        }
        m += 1;
    }
    modes
};

/// Internal forces and, if `want_tangent`, the symmetric tangent of the element with reference nodes `x0` displaced by
/// `u`. `out.tangent` keeps its old entries otherwise; after an error `out` is undefined.
pub fn evaluate(
    x0: &[[f64; 3]; 8],
    u: &[[f64; 3]; 8],
    medium: Medium,
    want_tangent: bool,
    out: &mut ElementMatrices<24>,
) -> Result<(), Inverted> {
    evaluate_with(&MODES, x0, u, medium, want_tangent, out)
}

/// [`evaluate`] with other modes.
pub fn evaluate_with<const M: usize>(
    modes: &Modes<M, POINTS>,
    x0: &[[f64; 3]; 8],
    u: &[[f64; 3]; 8],
    medium: Medium,
    want_tangent: bool,
    out: &mut ElementMatrices<24>,
) -> Result<(), Inverted> {
    enhanced::evaluate(x0, u, &RULE, modes, (medium, want_tangent), out)
}

/// The integration points.
pub fn samples(x0: &[[f64; 3]; 8], u: &[[f64; 3]; 8], medium: Medium) -> Result<[Sample; POINTS], Inverted> {
    enhanced::samples(x0, u, &RULE, &MODES, medium)
}
