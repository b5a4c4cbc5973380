//! The element formulations by name.

use crate::mesh::SolidShape;
use std::ops::RangeInclusive;

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
    /// 8-node hexahedron for thin sheets, one layer of which bends: assumed transverse strains, enhanced strain.
    Hex8Shell,
    /// 27-node hexahedron, 3x3x3 points, with linear changes of volume.
    Hex27,
    /// 6-node wedge, full 3x2 integration.
    Wedge6,
    /// 6-node wedge with the mean change of volume.
    Wedge6Sri,
    /// 18-node wedge, 6x3 points.
    Wedge18,
    /// 18-node wedge with the mean change of volume.
    Wedge18Sri,
    /// 5-node pyramid, 2x2x2 integration.
    Pyramid5,
    /// 5-node pyramid with the mean change of volume.
    Pyramid5Sri,
    /// 4-node tetrahedron.
    Tet4,
    /// 10-node tetrahedron, four integration points.
    Tet10,
    /// 10-node tetrahedron with the mean change of volume.
    Tet10Sri,
}

impl Formulation {
    /// The fewest and the most integration points through the thickness of a solid-shell element.
    pub const LAYERS: RangeInclusive<usize> = 2..=9;

    /// All of them.
    pub const ALL: [Self; 15] = [
        Self::Hex8,
        Self::Hex8Fbar,
        Self::Hex8Sri,
        Self::Hex8Eas,
        Self::Hex8Shell,
        Self::Hex27,
        Self::Wedge6,
        Self::Wedge6Sri,
        Self::Wedge18,
        Self::Wedge18Sri,
        Self::Pyramid5,
        Self::Pyramid5Sri,
        Self::Tet4,
        Self::Tet10,
        Self::Tet10Sri,
    ];

    /// The elements that it is for.
    pub fn shape(self) -> SolidShape {
        match self {
            Self::Hex8 | Self::Hex8Fbar | Self::Hex8Sri | Self::Hex8Eas | Self::Hex8Shell => SolidShape::Hex8,
            Self::Hex27 => SolidShape::Hex27,
            Self::Wedge6 | Self::Wedge6Sri => SolidShape::Wedge6,
            Self::Wedge18 | Self::Wedge18Sri => SolidShape::Wedge18,
            Self::Pyramid5 | Self::Pyramid5Sri => SolidShape::Pyramid5,
            Self::Tet4 => SolidShape::Tet4,
            Self::Tet10 | Self::Tet10Sri => SolidShape::Tet10,
        }
    }

    /// That of the elements of a shape where others of their body have this one. What locks in volume stands beside what does,
    /// what does not beside what does not.
    pub fn beside(self, shape: SolidShape) -> Self {
        let locks = matches!(self, Self::Hex8 | Self::Wedge6 | Self::Pyramid5);
        match shape {
            _ if shape == self.shape() => self,
            SolidShape::Hex8 => Self::Hex8,
            SolidShape::Hex27 => Self::Hex27,
            SolidShape::Wedge6 if locks => Self::Wedge6,
            SolidShape::Wedge6 => Self::Wedge6Sri,
            SolidShape::Wedge18 => Self::Wedge18Sri,
            SolidShape::Pyramid5 if locks => Self::Pyramid5,
            SolidShape::Pyramid5 => Self::Pyramid5Sri,
            SolidShape::Tet4 => Self::Tet4,
            SolidShape::Tet10 => Self::Tet10,
        }
    }

    /// What the user calls it.
    pub fn key(self) -> &'static str {
        match self {
            Self::Hex8 => "hex8",
            Self::Hex8Fbar => "hex8-fbar",
            Self::Hex8Sri => "hex8-sri",
            Self::Hex8Eas => "hex8-eas",
            Self::Hex8Shell => "hex8-shell",
            Self::Hex27 => "hex27",
            Self::Wedge6 => "wedge6",
            Self::Wedge6Sri => "wedge6-sri",
            Self::Wedge18 => "wedge18",
            Self::Wedge18Sri => "wedge18-sri",
            Self::Pyramid5 => "pyramid5",
            Self::Pyramid5Sri => "pyramid5-sri",
            Self::Tet4 => "tet4",
            Self::Tet10 => "tet10",
            Self::Tet10Sri => "tet10-sri",
        }
    }

    /// Whether it has enhanced strain, whose amplitudes go on from the last tangent.
    pub fn is_enhanced(self) -> bool {
        matches!(self, Self::Hex8Eas | Self::Hex8Shell)
    }
}
