//! The text of an XDMF file: a collection in time of collections in space of grids, all data by reference to an HDF5 file.
//!
//! See <https://www.xdmf.org/index.php/XDMF_Model_and_Format>. Only what ParaView's Xdmf3 readers take is used.

use super::fields::CellShape;
use std::fmt::Write as _;
use std::fs::{File, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write as _};
use std::path::Path;

/// What stands around the increments.
const HEAD: &str = r#"<?xml version="1.0" encoding="utf-8"?>
<Xdmf Version="3.0">
<Domain>
<Grid Name="fields" GridType="Collection" CollectionType="Temporal">
"#;
const TAIL: &str = "</Grid>\n</Domain>\n</Xdmf>\n";

/// A grid whose geometry stands in the file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct XdmfGrid {
    pub name: String,
    pub points: Reference,
    pub cells: Reference,
    pub cell_count: u64,
    /// `None` when the cells differ: then each stands behind the code of its shape.
    pub shape: Option<CellShape>,
}

/// A field on the nodes or cells of a grid.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct XdmfField {
    pub name: String,
    /// "Node" or "Cell".
    pub center: &'static str,
    pub data: Reference,
}

/// A dataset: `rows` x `width` numbers, or a plain vector when `width` is 1.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Reference {
    /// As in `fields.h5:/grids/slab/points`.
    pub path: String,
    pub rows: u64,
    pub width: usize,
    pub integer: bool,
}

impl CellShape {
    fn xdmf_name(self) -> &'static str {
        match self {
            Self::Triangle => "Triangle",
            Self::Quadrilateral => "Quadrilateral",
            Self::Tetrahedron => "Tetrahedron",
            Self::Hexahedron => "Hexahedron",
            Self::Wedge => "Wedge",
            Self::Pyramid => "Pyramid",
            Self::QuadraticTetrahedron => "Tetrahedron_10",
            Self::QuadraticWedge => "Wedge_18",
            Self::QuadraticHexahedron => "Hexahedron_27",
        }
    }

    /// The type of the cell in VTK.
    pub(super) fn vtk_type(self) -> u8 {
        match self {
            Self::Triangle => 5,
            Self::Quadrilateral => 9,
            Self::Tetrahedron => 10,
            Self::Hexahedron => 12,
            Self::Wedge => 13,
            Self::Pyramid => 14,
            Self::QuadraticTetrahedron => 24,
            Self::QuadraticWedge => 32,
            Self::QuadraticHexahedron => 29,
        }
    }

    /// The shape of a code in a mixed topology.
    pub(super) fn of_code(code: i64) -> Option<Self> {
        Self::ALL.into_iter().find(|shape| shape.xdmf_code() == code)
    }

    /// The code of the shape in a mixed topology.
    pub(super) fn xdmf_code(self) -> i64 {
        match self {
            Self::Triangle => 4,
            Self::Quadrilateral => 5,
            Self::Tetrahedron => 6,
            Self::Hexahedron => 9,
            Self::Wedge => 8,
            Self::Pyramid => 7,
            Self::QuadraticTetrahedron => 38,
            Self::QuadraticWedge => 41,
            Self::QuadraticHexahedron => 50,
        }
    }
}

/// One written increment: its grids, each with its fields.
pub(super) fn increment(time: f64, grids: &[(&XdmfGrid, Vec<XdmfField>)]) -> String {
    let mut text = String::new();
    let _ = writeln!(text, r#"<Grid Name="increment" GridType="Collection" CollectionType="Spatial">"#);
    let _ = writeln!(text, r#"<Time Value="{time:?}"/>"#);
    for (grid, fields) in grids {
        let shape = grid.shape.map_or("Mixed", CellShape::xdmf_name);
        let _ = writeln!(text, "{}", grid_begin(&grid.name));
        let _ = writeln!(text, r#"<Topology TopologyType="{shape}" NumberOfElements="{}">"#, grid.cell_count);
        let _ = writeln!(text, "{}</Topology>", item(&grid.cells));
        let _ = writeln!(text, r#"<Geometry GeometryType="XYZ">{}</Geometry>"#, item(&grid.points));
        for field in fields {
            let kind = attribute_type(field.data.width);
            let (name, center) = (escaped(&field.name), field.center);
            let _ = write!(text, r#"<Attribute Name="{name}" AttributeType="{kind}" Center="{center}">"#);
            let _ = writeln!(text, "{}</Attribute>", item(&field.data));
        }
        text.push_str("</Grid>\n");
    }
    text.push_str("</Grid>\n");
    text
}

/// The text of the first increments of a whole file, so many of them; `None` when it has fewer.
pub(super) fn first(document: &str, count: usize) -> Option<&str> {
    const BEGIN: &str = r#"<Grid Name="increment" "#;
    if count == 0 {
        return Some("");
    }
    let start = document.find(BEGIN)?;
    let later = document.match_indices(BEGIN).map(|(at, _)| at).nth(count);
    // Behind the last increment the collection in time ends.
    let end = later.or_else(|| document.find("</Grid>\n</Domain>"))?;
    (document.matches(BEGIN).count() >= count).then(|| &document[start..end])
}

/// Of increments one grid alone: as meshio's reader of series wants them, each a grid with its own time.
pub(super) fn of_grid(increments: &str, name: &str) -> String {
    let begin = grid_begin(name);
    let (mut text, mut time, mut inside) = (String::new(), "", false);
    for line in increments.lines() {
        if line.starts_with("<Time ") {
            time = line;
        }
        inside |= line == begin;
        if inside {
            let _ = writeln!(text, "{line}");
        }
        if line == begin {
            let _ = writeln!(text, "{time}");
        }
        inside &= line != "</Grid>";
    }
    text
}

/// The whole file around its increments.
pub(super) fn document(increments: &str) -> String {
    format!("{HEAD}{increments}{TAIL}")
}

/// Puts another increment at the end of a file with `increments`, so that what a run writes grows with what there is, not with its
/// square. A file that cannot hold it stays as it was.
///
/// # Errors
/// Those of the file; [`io::ErrorKind::InvalidData`] when it is another one.
pub(super) fn lengthen(path: &Path, increments: &str, another: &str) -> io::Result<()> {
    let mut file = OpenOptions::new().write(true).open(path)?;
    let end = (HEAD.len() + increments.len()) as u64;
    if file.metadata()?.len() != end + TAIL.len() as u64 {
        return Err(io::ErrorKind::InvalidData.into());
    }
    let put =
        |file: &mut File, text: &str| file.seek(SeekFrom::Start(end)).and_then(|_| file.write_all(text.as_bytes()));
    put(&mut file, &format!("{another}{TAIL}")).or_else(|error| {
        put(&mut file, TAIL)?;
        file.set_len(end + TAIL.len() as u64)?;
        Err(error)
    })
}

/// Symmetric tensors go as a "Vector" of 6 components: "Tensor6" has the order xx xy xz yy yz zz, but ParaView labels six
/// components xx yy zz xy yz xz whatever their type, so its order is used under a type that promises none. A "Matrix"
/// would be one row to VTK's older reader, that of PyVista.
fn attribute_type(width: usize) -> &'static str {
    match width {
        1 => "Scalar",
        _ => "Vector",
    }
}

fn grid_begin(name: &str) -> String {
    format!(r#"<Grid Name="{}" GridType="Uniform">"#, escaped(name))
}

fn item(data: &Reference) -> String {
    let kind = if data.integer { "Int" } else { "Float" };
    let columns = if data.width == 1 { String::new() } else { format!(" {}", data.width) };
    format!(
        r#"<DataItem Format="HDF" NumberType="{kind}" Precision="8" Dimensions="{}{columns}">{}</DataItem>"#,
        data.rows, data.path
    )
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file that is lengthened is as one that is written whole; another one is left alone.
    #[test]
    fn a_file_grows_by_its_increments() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fields.xdmf");
        let kind = |increments: &str| lengthen(&path, increments, "<b/>\n").map_err(|error| error.kind());
        assert_eq!(kind("<a/>\n"), Err(io::ErrorKind::NotFound));
        std::fs::write(&path, document("<a/>\n")).unwrap();
        assert_eq!(kind("<a/>\n"), Ok(()));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), document("<a/>\n<b/>\n"));
        assert_eq!(kind("<a/>\n"), Err(io::ErrorKind::InvalidData));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), document("<a/>\n<b/>\n"));
    }

    #[test]
    fn an_increment_refers_to_its_data() {
        let reference =
            |path: &str, rows, width, integer| Reference { path: format!("fields.h5:/{path}"), rows, width, integer };
        let grid = XdmfGrid {
            name: "a<b>".into(),
            points: reference("grids/a_b_/points", 4, 3, false),
            cells: reference("grids/a_b_/cells", 2, 3, true),
            cell_count: 2,
            shape: Some(CellShape::Triangle),
        };
        let mixed =
            XdmfGrid { name: "m".into(), shape: None, cells: reference("grids/m/cells", 9, 1, true), ..grid.clone() };
        let field = |name: &str, center, width| XdmfField {
            name: name.into(),
            center,
            data: reference(&format!("increments/1/{name}"), 4, width, false),
        };
        let fields = vec![field("gap", "Node", 1), field("displacement", "Node", 3), field("stress", "Cell", 6)];
        let text = document(&increment(0.1, &[(&grid, fields), (&mixed, vec![])]));
        for part in [
            r#"<Time Value="0.1"/>"#,
            r#"<Grid Name="a&lt;b&gt;" GridType="Uniform">"#,
            r#"<Topology TopologyType="Triangle" NumberOfElements="2">"#,
            r#"NumberType="Int" Precision="8" Dimensions="2 3">fields.h5:/grids/a_b_/cells</DataItem>"#,
            r#"<Topology TopologyType="Mixed" NumberOfElements="2">"#,
            r#"Dimensions="9">fields.h5:/grids/m/cells<"#,
            r#"<Attribute Name="gap" AttributeType="Scalar" Center="Node">"#,
            r#"<Attribute Name="displacement" AttributeType="Vector" Center="Node">"#,
            r#"<Attribute Name="stress" AttributeType="Vector" Center="Cell">"#,
            r#"NumberType="Float" Precision="8" Dimensions="4 6">fields.h5:/increments/1/stress<"#,
        ] {
            assert!(text.contains(part), "{part} is not in\n{text}");
        }
        assert_eq!(text.matches("<Grid ").count(), text.matches("</Grid>").count());
        let (one, two) = (increment(0.1, &[(&grid, vec![])]), increment(0.2, &[(&mixed, vec![])]));
        let both = document(&format!("{one}{two}"));
        assert_eq!(
            [0, 1, 2].map(|count| first(&both, count)),
            [Some(""), Some(&one[..]), Some(&format!("{one}{two}"))]
        );
        assert_eq!(first(&both, 3), None);
        let own = of_grid(&format!("{two}{one}{two}"), "a<b>");
        let begin = r#"<Grid Name="a&lt;b&gt;" GridType="Uniform">"#;
        assert!(own.starts_with(&format!("{begin}\n<Time Value=\"0.1\"/>\n<Topology ")), "{own}");
        assert!(own.ends_with("</Grid>\n") && own.matches("Grid").count() == 3 && !own.contains("/m/"), "{own}");
        assert_eq!(of_grid(&both, "other"), "");
    }
}
