//! Integration over the overlap of two surfaces of faces whose meshes do not fit, the slave's and the master's, and what it
//! makes of them: the interpolation of the slave's nodes from those of the master.
//!
//! Each slave face is looked at in its mean plane, into which the master faces before it are projected along its normal. The
//! polygons that both have in common are the segments (Puso and Laursen, A mortar segment-to-segment contact method for large
//! deformation solid mechanics, Comput. Methods Appl. Mech. Engrg. 193, 2004): [`mod@overlap`] cuts them into triangles and these
//! into points of a Gauss rule, with the shape functions N of the slave and Φ of the master there.
//!
//! The weighted gap of slave node i is that of its multiplier's shape function ψ_i,
//!
//! ```text
//!     D_ii x_i - Σ_k M_ik x_k = 0,      D_ii = ∫ N_i dA,   M_ik = ∫ ψ_i Φ_k dA                         (1)
//!     ψ = A N,   A = diag(∫ N_i dA) [∫ N_i N_j dA]⁻¹   face by face, so that ∫ ψ_i N_j dA = δ_ij D_ii    (2)
//! ```
//!
//! with the dual functions ψ of Wohlmuth (SIAM J. Numer. Anal. 38, 2000), made on the part of the face that the master covers
//! (Cichosz and Bischoff, Comput. Methods Appl. Mech. Engrg. 200, 2011). They make D diagonal: each slave node has an
//! equation of its own, x_i = Σ_k P_ik x_k with P = D⁻¹ M, and no two of them are dependent whatever the meshes. With standard
//! functions, ψ = N, each would couple all slave nodes, and all master nodes behind them.
//!
//! As A is made with the points of (1), whatever their rule, Σ_k P_ik = 1 and Σ_i ψ_i = 1 to rounding. So a force F_i at
//! the slave's nodes, with -P_ik F_i at the master's, adds up to nothing, and so do its moments where (1) holds in the
//! positions. On flat faces P is exact for linear fields; and an even traction, which the slave's nodes have as ∫ N_i dA, comes
//! to the master's as ∫ Φ_k dA, as far as the rule is exact.
//!
//! A quadratic face is four linear pieces on its nodes where surfaces are looked at and cut; in all integrals
//! it has its own shape functions, areas and normals (Puso, Laursen and Solberg, Comput. Methods Appl. Mech. Engrg. 197, 2008). As ∫ N dA is nothing at the
//! corners of six nodes, D would be, too: the slave's functions are shifted to
//!
//! ```text
//!     Ñ_c = N_c + α Σ N_m,   Ñ_m = (1 - 2 α) N_m          at corners c and middles m of edges,
//!     x_c = x̃_c,             x_m = (1 - 2 α) x̃_m + α Σ x̃_c                                              (3)
//! ```
//!
//! which span the same, with the duals of these in (1) and (2), x̃ for x and Σ over the edges that end in c, and the ends of the
//! edge (Popp, Wohlmuth, Gee and Wall, SIAM J. Sci. Comput. 34, 2012). As the duals span what N does, 1 too, an even traction passes.
//!
//! - `polygon`: convex polygons in a plane: what two have in common
//! - [`rule`]: Gauss points of a triangle
//! - [`face`]: shape functions of a face, and where a point is in it; pieces of quadratic ones
//! - [`mod@overlap`]: the points of a slave face that a master face covers
//! - [`interpolation`]: (1) to (3) for two whole surfaces

pub mod face;
pub mod interpolation;
pub mod overlap;
mod polygon;
pub mod rule;

pub use face::{Corners, Face};
pub use interpolation::{Interpolation, Row, interpolate};
pub use overlap::{MeanPlane, Point, overlap};
