//! Meshes split by the midpoints of their edges, once or several times, with the curved boundaries that their nodal normals
//! tell of.
//!
//! An element or facet with nodes x_i is taken to have the quadratic edges of its boundary's Nagata patches, with the
//! coefficients c of [`surface::nagata`](crate::surface::nagata), and straight ones elsewhere. What is inside its edges
//! blends them,
//!
//! ```text
//!     x = sum_i w_i x_i - sum_ab c_ab w_a w_b / (w_a + w_b)     hexahedron, quadrilateral; w trilinear, bilinear      (1)
//!     x = sum_i b_i x_i - sum_ab c_ab b_a b_b                   tetrahedron, triangle; b barycentric                  (2)
//!     x = sum_i w_i x_i - sum_ab c_ab w_a w_b / s_ab            wedge; w = b times linear                             (3)
//!     x = sum_i w_i x_i - sum_ab c_ab w_a w_b / s_ab            pyramid                                               (4)
//! ```
//!
//! over the edges ab; s_ab is w_a + w_b where ab joins the triangles of a wedge, and on one of them the sum of the weights
//! of its nodes; 1 where ab goes to the apex of a pyramid, and on its base w_a + w_b over the weight of the base. On a face this is the Nagata patch of [`surface::patch`](crate::surface::patch) (along an edge of
//! a hexahedron with the parameter t, w_a w_b / (w_a + w_b) is t (1 - t) times the share of the edge), inside it is the
//! transfinite interpolation of the edges. New nodes are those at parameters k / 2^n, so that splitting n times converges
//! to the patches of the mesh as it was read, and nodes that elements share are the same from all sides.
//!
//! - [`curves`](mod@curves): the coefficients of the edges of bodies and tools
//! - [`split`](mod@split): nodes and elements; groups go over to the parts

pub mod curves;
mod groups;
pub mod split;

pub use curves::{Curves, of_body, of_quadratic, of_surface};
pub use split::split;

#[cfg(test)]
mod tests;
