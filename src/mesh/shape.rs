//! The shapes of volume elements.

/// Shape of a volume element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SolidShape {
    /// 4 nodes.
    Tet4,
    /// 10 nodes: those of [`Self::Tet4`], then the middles of the edges [`super::faces::TET_EDGES`]; the order of Abaqus and VTK. Gmsh
    /// has the last two the other way round.
    Tet10,
    /// 8 nodes; Gmsh and Abaqus order: bottom face counter-clockwise seen from inside the element, then the top face.
    Hex8,
    /// 5 nodes; Gmsh and Abaqus order: a quadrilateral counter-clockwise seen from inside the element, then its apex.
    Pyramid5,
    /// 6 nodes; Gmsh and Abaqus order: a triangle counter-clockwise seen from inside the element, then the one above it.
    Wedge6,
    /// 18 nodes: those of [`Self::Wedge6`], then the middles of the edges [`super::faces::WEDGE_EDGES`] and of the sides
    /// [`super::faces::WEDGE_SIDES`].
    Wedge18,
    /// 27 nodes: those of [`Self::Hex8`], then the middles of the edges [`super::faces::HEX_EDGES`], of the faces
    /// [`super::faces::HEX_FACES`], and of all.
    Hex27,
}

impl SolidShape {
    /// The number of nodes.
    pub fn node_count(self) -> usize {
        match self {
            SolidShape::Tet4 => 4,
            SolidShape::Pyramid5 => 5,
            SolidShape::Wedge6 => 6,
            SolidShape::Hex8 => 8,
            SolidShape::Tet10 => 10,
            SolidShape::Wedge18 => 18,
            SolidShape::Hex27 => 27,
        }
    }
}
