//! Entities in the directory, and what their types are (IGES 5.3, chapter 4).

/// An entity in the directory.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    /// Number in the directory, odd: others point to it by that.
    pub number: usize,
    pub kind: i64,
    pub form: i64,
    /// Pointer to the transformation matrix; 0 for none.
    pub matrix: i64,
    /// Physically dependent: something else in the file is made of this.
    pub dependent: bool,
    /// First line of its parameters, from 1, and their count.
    pub data: [i64; 2],
    /// Line in the file.
    pub line: usize,
}

/// What an entity means for a reader of surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// A surface that is read.
    Surface,
    /// A surface, or something that holds surfaces, that is not read.
    Unread,
    /// Curves, points, and all that is no geometry.
    Other,
}

impl Entry {
    /// "trimmed surface (144) at D17".
    pub fn name(&self) -> String {
        let known = KINDS.iter().find(|kind| kind.0 == self.kind);
        format!("{} ({}) at D{}", known.map_or("entity", |kind| kind.1), self.kind, self.number)
    }

    /// What this means for a reader of surfaces.
    pub fn role(&self) -> Role {
        match self.kind {
            108 | 118 | 120 | 122 | 128 | 143 | 144 => Role::Surface,
            114 | 140 | 150..=198 | 408..=414 | 430 | 510 | 514 if self.kind != 182 && self.kind != 410 => Role::Unread,
            _ => Role::Other,
        }
    }
}

/// The types that messages may name.
const KINDS: [(i64, &str); 48] = [
    (100, "circular arc"),
    (102, "composite curve"),
    (104, "conic arc"),
    (106, "copious data"),
    (108, "plane"),
    (110, "line"),
    (112, "parametric spline curve"),
    (114, "parametric spline surface"),
    (116, "point"),
    (118, "ruled surface"),
    (120, "surface of revolution"),
    (122, "tabulated cylinder"),
    (123, "direction"),
    (124, "transformation matrix"),
    (126, "rational B-spline curve"),
    (128, "rational B-spline surface"),
    (130, "offset curve"),
    (140, "offset surface"),
    (141, "boundary"),
    (142, "curve on a surface"),
    (143, "bounded surface"),
    (144, "trimmed surface"),
    (150, "block"),
    (152, "wedge"),
    (154, "cylinder"),
    (156, "frustum of a cone"),
    (158, "sphere"),
    (160, "torus"),
    (162, "solid of revolution"),
    (164, "solid of linear extrusion"),
    (168, "ellipsoid"),
    (180, "Boolean tree"),
    (184, "solid assembly"),
    (186, "manifold solid"),
    (190, "plane surface"),
    (192, "cylindrical surface"),
    (194, "conical surface"),
    (196, "spherical surface"),
    (198, "toroidal surface"),
    (308, "subfigure"),
    (402, "group"),
    (408, "instance of a subfigure"),
    (412, "rectangular array"),
    (414, "circular array"),
    (430, "instance of a solid"),
    (508, "loop"),
    (510, "face"),
    (514, "shell"),
];
