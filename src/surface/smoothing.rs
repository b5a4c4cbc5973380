//! How a surface is described between its nodes, and how forces go back to them, by name.

/// How a surface mesh is smoothed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Smoothing {
    Facet,
    Nagata,
}

/// How a force on a point of a deformable master is spread over the nodes: node j gets W_j^T F.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Transfer {
    /// By the areas opposite to the patch's own nodes, eqs. (60)-(61) of the node-to-Nagata paper: W_j = w_j I.
    Bilinear,
    /// By the derivative of the patch by its own nodes at fixed nodal normals.
    #[default]
    Patch,
    /// By the derivative of the patch by all nodes: keeps force and moment, and makes frictionless tangents symmetric.
    Variational,
}
