//! The element formulations by name.

/// How an element is formulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Formulation {
    /// 8-node hexahedron, full 2x2x2 integration.
    Hex8,
    /// 8-node hexahedron, F-bar.
    Hex8Fbar,
    /// 8-node hexahedron, selective reduced integration with the mean change of volume.
    Hex8Sri,
    /// 8-node hexahedron, enhanced assumed strain.
    Hex8Eas,
    /// 4-node tetrahedron.
    Tet4,
}

impl Formulation {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Hex8, Self::Hex8Fbar, Self::Hex8Sri, Self::Hex8Eas, Self::Tet4];

    /// What the user calls it.
    pub fn key(self) -> &'static str {
        match self {
            Self::Hex8 => "hex8",
            Self::Hex8Fbar => "hex8-fbar",
            Self::Hex8Sri => "hex8-sri",
            Self::Hex8Eas => "hex8-eas",
            Self::Tet4 => "tet4",
        }
    }
}
