//! The coefficient of an edge whose nodes move, with two derivatives.
//!
//! With s = n0 + n1 and t = n0 - n1, Nagata's coefficient is (t.d)/|s|^2 s + (s.d)/|t|^2 t, see [`super::super::nagata`].
//! The first term is the bulge: exact on arcs, smooth everywhere, and enough for edges to meet with a kink of the third
//! order in their length. The second term moves points along the edge, so that each end gets the slope that its normal
//! asks for; on moving nodes it does harm. Where the surface is flat or nearly so it is of the size of the edge whatever
//! little the normals lean, and with 1/|t|^2 damped to 1/(|t|^2 + e^2) it still moves points by |d|/(2e) times the change
//! of the lean: points that should stand still on the surface slide, and a force along the surface makes forces on the
//! nodes that add up to many times its size (ten times on a smooth dome with e = 0.05). So on moving nodes
//!
//! ```text
//!     c = f(|s|^2) (t.d) s,     f(S) = 1/S,
//! ```
//!
//! where f goes smoothly to zero for normals that are more than 120 degrees apart. For less than that |c.d| < |d|^2: the
//! curve never turns back.

use crate::{Mat3, Vec3};

/// c(d, n0, n1) and its derivatives.
#[derive(Clone, Copy, Debug, Default)]
pub struct Coefficient {
    pub value: Vec3,
    pub by_chord: Mat3,
    pub by_normals: [Mat3; 2],
}

/// Second derivatives of v.c by (d, n0, n1); those by d twice are zero.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bending {
    /// By d and either normal.
    pub chord_normals: [Mat3; 2],
    /// By n0 twice and n1 twice.
    pub normals: [Mat3; 2],
    /// By n0 and n1.
    pub mixed: Mat3,
}

/// c at unit normals `n0`, `n1` of the ends of `d`; c(-d, n1, n0) = c(d, n0, n1).
pub fn coefficient(d: &Vec3, n0: &Vec3, n1: &Vec3) -> Vec3 {
    let (s, t) = (n0 + n1, n0 - n1);
    s * (inverse(s.norm_squared())[0] * t.dot(d))
}

/// c with its first derivatives.
pub fn derivatives(d: &Vec3, n0: &Vec3, n1: &Vec3) -> Coefficient {
    let (s, t) = (n0 + n1, n0 - n1);
    let ([f, slope, _], p) = (inverse(s.norm_squared()), t.dot(d));
    let by_s = s * s.transpose() * (2.0 * slope * p) + Mat3::from_diagonal_element(f * p);
    let by_t = s * (d * f).transpose();
    Coefficient { value: s * (f * p), by_chord: s * (t * f).transpose(), by_normals: [by_s + by_t, by_s - by_t] }
}

/// Second derivatives of v.c.
pub fn bending(d: &Vec3, n0: &Vec3, n1: &Vec3, v: &Vec3) -> Bending {
    let (s, t) = (n0 + n1, n0 - n1);
    let ([f, slope, bend], p, a) = (inverse(s.norm_squared()), t.dot(d), v.dot(&s));
    // Of f(|s|^2) a by s.
    let turn = s * (2.0 * slope * a) + v * f;
    let (by_ds, by_dt) = (t * turn.transpose(), Mat3::from_diagonal_element(f * a));
    let mixed = s * (v * (2.0 * slope * p)).transpose();
    let by_ss = mixed
        + mixed.transpose()
        + s * s.transpose() * (4.0 * bend * p * a)
        + Mat3::from_diagonal_element(2.0 * slope * p * a);
    let by_st = turn * d.transpose();
    let both = by_st + by_st.transpose();
    Bending {
        chord_normals: [by_ds + by_dt, by_ds - by_dt],
        normals: [by_ss + both, by_ss - both],
        mixed: by_ss - by_st + by_st.transpose(),
    }
}

/// f with two derivatives.
fn inverse(ss: f64) -> [f64; 3] {
    if ss < 1.0 {
        [ss * (3.0 - 2.0 * ss), 3.0 - 4.0 * ss, -4.0]
    } else {
        [1.0 / ss, -1.0 / (ss * ss), 2.0 / (ss * ss * ss)]
    }
}
