//! Files are written here in each version and encoding and read back.

use super::*;
use proptest::prelude::*;

/// One encoding of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Style {
    Text,
    Little,
    Big,
}

struct Writer {
    style: Style,
    bytes: Vec<u8>,
}

fn read(source: &str, data: &[u8]) -> Result<FileMesh> {
    super::read(source, data.to_vec())
}

impl Writer {
    fn text(&mut self, text: &str) {
        self.bytes.extend_from_slice(text.as_bytes());
    }

    fn put(&mut self, text: String, little: &[u8], big: &[u8]) {
        match self.style {
            Style::Text => self.text(&(text + " ")),
            Style::Little => self.bytes.extend_from_slice(little),
            Style::Big => self.bytes.extend_from_slice(big),
        }
    }

    fn int(&mut self, value: i32) {
        self.put(value.to_string(), &value.to_le_bytes(), &value.to_be_bytes());
    }

    fn size(&mut self, value: u64) {
        self.put(value.to_string(), &value.to_le_bytes(), &value.to_be_bytes());
    }

    fn real(&mut self, value: f64) {
        self.put(value.to_string(), &value.to_le_bytes(), &value.to_be_bytes());
    }

    fn line(&mut self) {
        if self.style == Style::Text {
            self.text("\n");
        }
    }
}

/// (type, number, physical group, nodes); the entity is the physical group.
type Element = (i32, u64, i32, &'static [u64]);

/// Two unit cubes in a row along x, with sparse node numbers; a bottom with one facet turned inward, the face between
/// the cubes, an edge, a corner, and an unnamed surface 4 with the number of the right cube.
const ELEMENTS: &[Element] = &[
    (15, 1, 1, &[10]),
    (1, 2, 2, &[10, 20]),
    (3, 3, 3, &[10, 40, 50, 20]),
    (3, 4, 3, &[20, 30, 60, 50]),
    (3, 5, 5, &[20, 50, 110, 80]),
    (2, 6, 4, &[70, 80, 110]),
    (5, 7, 3, &[10, 20, 50, 40, 70, 80, 110, 100]),
    (5, 8, 4, &[20, 30, 60, 50, 80, 90, 120, 110]),
];
const NAMES: &[(i64, i32, &str)] =
    &[(0, 1, "corner"), (1, 2, "edge"), (2, 3, "bottom"), (2, 5, "middle"), (3, 3, "left cube")];

fn nodes() -> Vec<(u64, [f64; 3])> {
    (0..12).map(|i| (10 * (i + 1), [(i % 3) as f64, (i / 3 % 2) as f64, (i / 6) as f64])).collect()
}

fn dimension_of(kind: i32) -> i32 {
    let shape = match kind {
        15 => CellShape::Point,
        1 => CellShape::Line,
        2 | 3 => CellShape::Quad,
        _ => CellShape::Hex,
    };
    shape.dimension().into()
}

fn start(style: Style, version: &str) -> Writer {
    let mut out = Writer { style, bytes: Vec::new() };
    out.text(&format!("$MeshFormat\n{version} {} 8\n", (style != Style::Text) as u8));
    if style != Style::Text {
        out.int(1);
        out.text("\n");
    }
    out.text("$EndMeshFormat\n$Comments\nanything $ at all\n$EndComments\n");
    out.text(&format!("$PhysicalNames\n{}\n", NAMES.len()));
    NAMES.iter().for_each(|(dimension, number, name)| out.text(&format!("{dimension} {number} \"{name}\"\n")));
    out.text("$EndPhysicalNames\n");
    out
}

fn version_2(style: Style, elements: &[Element]) -> Vec<u8> {
    let mut out = start(style, "2.2");
    out.text(&format!("$Nodes\n{}\n", nodes().len()));
    for (id, point) in nodes() {
        out.int(id as i32);
        point.iter().for_each(|&x| out.real(x));
        out.line();
    }
    out.text(&format!("\n$EndNodes\n$Elements\n{}\n", elements.len()));
    for (kind, id, physical, nodes) in elements {
        let header = if style == Style::Text { [*id as i32, *kind, 2] } else { [*kind, 1, 2] };
        header.iter().for_each(|&value| out.int(value));
        if style != Style::Text {
            out.int(*id as i32);
        }
        out.int(*physical);
        out.int(*physical);
        nodes.iter().for_each(|&node| out.int(node as i32));
        out.line();
    }
    out.text("\n$EndElements\n$NodeData\n1 2 3\n$EndNodeData\n");
    out.bytes
}

fn version_4(style: Style, elements: &[Element], partitioned: bool) -> Vec<u8> {
    let mut out = start(style, "4.1");
    let mut entities: Vec<(i32, i32)> = elements.iter().map(|e| (dimension_of(e.0), e.2)).collect();
    entities.sort_unstable();
    entities.dedup();
    out.text(if partitioned { "$PartitionedEntities\n" } else { "$Entities\n" });
    if partitioned {
        out.size(2);
        out.size(1);
        [9, 1].iter().for_each(|&value| out.int(value));
    }
    (0..4).for_each(|d| out.size(entities.iter().filter(|entity| entity.0 == d).count() as u64));
    for &(dimension, number) in &entities {
        out.int(number);
        if partitioned {
            [dimension, 77].iter().for_each(|&value| out.int(value));
            out.size(1);
            out.int(1);
        }
        (0..if dimension == 0 { 3 } else { 6 }).for_each(|_| out.real(0.5));
        // The cubes are all of the volume, besides being the left and the right one.
        out.size(if dimension == 3 { 2 } else { 1 });
        out.int(number);
        if dimension == 3 {
            out.int(9);
        }
        if dimension > 0 {
            out.size(1);
            out.int(-1);
        }
        out.line();
    }
    out.text(if partitioned { "\n$EndPartitionedEntities\n" } else { "\n$EndEntities\n" });
    out.text("$Nodes\n");
    [2, 12, 10, 120].iter().for_each(|&value| out.size(value));
    // Half of the nodes lie on a surface and have two parameters each.
    for (range, parametric) in [(0..6, 1), (6..12, 0)] {
        [2, 1, parametric].iter().for_each(|&value| out.int(value));
        out.size(6);
        nodes()[range.clone()].iter().for_each(|node| out.size(node.0));
        out.line();
        for (_, point) in &nodes()[range] {
            point.iter().for_each(|&x| out.real(x));
            (0..2 * parametric).for_each(|_| out.real(0.25));
            out.line();
        }
    }
    out.text("\n$EndNodes\n$Elements\n");
    [elements.len() as u64, elements.len() as u64, 1, 8].iter().for_each(|&value| out.size(value));
    for (kind, id, physical, nodes) in elements {
        [dimension_of(*kind), *physical, *kind].iter().for_each(|&value| out.int(value));
        out.size(1);
        out.size(*id);
        nodes.iter().for_each(|&node| out.size(node));
        out.line();
    }
    out.text("\n$EndElements\n");
    out.bytes
}

const STYLES: [Style; 3] = [Style::Text, Style::Little, Style::Big];

fn all_versions() -> Vec<Vec<u8>> {
    let both =
        |style| [version_2(style, ELEMENTS), version_4(style, ELEMENTS, false), version_4(style, ELEMENTS, true)];
    STYLES.into_iter().flat_map(both).collect()
}

fn message_of(data: &[u8]) -> String {
    read("a.msh", data).unwrap_err().to_string()
}

#[test]
fn all_versions_and_encodings_read_alike() {
    for (index, data) in all_versions().iter().enumerate() {
        let file = read("a.msh", data).unwrap();
        let ids: Vec<u64> = nodes().iter().map(|node| node.0).collect();
        let points: Vec<[f64; 3]> = nodes().iter().map(|node| node.1).collect();
        assert_eq!((&file.mesh.point_ids, &file.mesh.points), (&ids, &points));
        assert!(file.attached.iter().all(|&attached| attached));
        assert_eq!(file.mesh.solids.len(), 2);
        assert_eq!(file.mesh.solids[1].nodes(), [1, 2, 5, 4, 7, 8, 11, 10]);
        assert_eq!(file.mesh.facets.iter().map(|facet| facet.id).collect::<Vec<_>>(), [3, 4, 5, 6]);
        assert_eq!(file.mesh.facets[3].nodes(), [6, 7, 10]);

        let mut names = vec!["bottom", "corner", "edge", "left cube", "middle", "surface 4", "volume 4"];
        if index % 3 > 0 {
            names.insert(0, "9");
            assert_eq!(file.groups["9"].group.solids, [0, 1]);
        }
        assert_eq!(file.groups.keys().collect::<Vec<_>>(), names);
        assert_eq!(file.groups["corner"].group.nodes, [0, 0]);
        assert_eq!(file.groups["edge"].group.nodes, [0, 1]);
        assert_eq!(file.groups["bottom"].group.facets, [0, 1]);
        assert_eq!(file.groups["left cube"].group.solids, [0]);
        assert_eq!(file.groups["volume 4"].group.solids, [1]);
        assert_eq!(file.groups["surface 4"].group.facets, [3]);
    }
}

#[test]
fn version_2_writes_an_element_once_for_each_group() {
    let twice: &[Element] = &[ELEMENTS[6], (5, 9, 2, ELEMENTS[6].3), (5, 10, 0, ELEMENTS[7].3)];
    let file = read("a.msh", &version_2(Style::Text, twice)).unwrap();
    assert_eq!(file.mesh.solids.len(), 2);
    assert_eq!(file.groups["2"].group.solids, file.groups["left cube"].group.solids);
    // The same element twice in one group, or in none, is left for the check.
    let twice: &[Element] =
        &[ELEMENTS[6], (5, 9, 3, ELEMENTS[6].3), (5, 10, 0, ELEMENTS[7].3), (5, 11, 0, ELEMENTS[7].3)];
    assert_eq!(read("a.msh", &version_2(Style::Text, twice)).unwrap().mesh.solids.len(), 4);
}

#[test]
fn elements_without_entities_are_read() {
    let text = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n\
                $EndNodes\n$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n";
    let file = read("a.msh", text.as_bytes()).unwrap();
    assert_eq!((file.mesh.solids.len(), file.groups.len()), (1, 0));
    // Line ends of Windows.
    assert_eq!(read("a.msh", text.replace('\n', "\r\n").as_bytes()).unwrap().mesh, file.mesh);
}

#[test]
fn a_negative_group_turns_facets_over() {
    let text = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 1 0\n7 0 0 0 1 1 0 1 -2 0\n$EndEntities\n$Nodes\n1 3 1 3\n\
                2 7 0 3\n1\n2\n3\n0 0 0\n1 0 0\n0 1 0\n$EndNodes\n$Elements\n1 1 1 1\n2 7 2 1\n1 1 2 3\n$EndElements\n";
    let file = read("a.msh", text.as_bytes()).unwrap();
    assert_eq!(file.mesh.facets[0].nodes(), [0, 2, 1]);
    assert_eq!(file.groups["2"].group.facets, [0]);
}

#[test]
fn errors_name_line_and_column() {
    let good = String::from_utf8(version_2(Style::Text, ELEMENTS)).unwrap();
    let broken = |from: &str, to: &str| message_of(good.replacen(from, to, 1).as_bytes());

    assert_eq!(broken("20 1 0 0 ", "20 1 O 0 "), "a.msh:18:6: expected a coordinate, found 'O'\n  | 20 1 O 0");
    let text = broken("$Nodes\n12", "$Nodes\n11");
    assert!(text.starts_with("a.msh:28:1: expected $EndNodes, found '120'"), "{text}");
    assert!(text.contains("more or less than its counts say"), "{text}");
    let text = broken("$Nodes\n12", "$Nodes\n13");
    assert!(text.starts_with("a.msh:30:1: expected a node number, found '$EndNodes'"), "{text}");
    let text = broken("$Nodes\n12", "$Nodes\n99999999");
    assert!(text.contains("the number of nodes is 99999999, but only"), "{text}");
    let text = broken("$Nodes\n12", "$Nodes\n-3");
    assert!(text.contains("expected the number of nodes, found '-3'"), "{text}");
    let text = broken("7 5 2 3 3 10", "7 5 2 3 3 15");
    assert_eq!(text, "a.msh: element 7 names node 15, which does not exist\n  help: write the mesh with all its nodes");
    let text = broken("\n20 ", "\n10 ");
    assert!(text.starts_with("a.msh: node 10 is defined twice"), "{text}");
    let text = broken("\"corner\"", "corner");
    assert!(text.contains("expected the name of a physical group in quotation marks"), "{text}");
    assert_eq!(broken("$Elements", "$Anything").lines().next(), Some("a.msh:31:10: section $Anything has no end"));
    assert!(broken("2.2 0 8", "4.0 0 8").contains("Gmsh version 4 is not read"));
    assert!(broken("2.2 0 8", "4.0 0 8").contains("help: save it as version 4.1 or 2.2"));
    assert!(broken("$MeshFormat", "$NOD").contains("Gmsh version 1 is not read"));
    assert!(broken("2.2 0 8", "2.2 0 4").contains("data size 4 is not read"));
    assert!(message_of(b"").contains("the file ends where the version of the format is expected"));
    assert!(message_of(b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n").contains("the file has no $Nodes"));
}

#[test]
fn types_that_are_not_read_are_named_with_their_element() {
    for (kind, name, help) in [
        (19, "second-order pyramids", "mesh with order 1, or with tetrahedra alone"),
        (92, "such elements", "with order 1 or 2"),
        (0, "such elements", "use hexahedra, wedges, pyramids or tetrahedra"),
    ] {
        for style in STYLES {
            let strange: &[Element] = &[(kind, 57, 3, &[10; 8])];
            for data in [version_2(style, strange), version_4(style, strange, false)] {
                let text = message_of(&data);
                assert!(text.contains(&format!("element 57 has Gmsh type {kind}; {name} are not read")), "{text}");
                assert!(text.contains(help), "{text}");
                assert_eq!(text.contains("a.msh: byte "), style != Style::Text, "{text}");
            }
        }
    }
}

#[test]
fn truncated_files_never_read_past_their_end() {
    for data in all_versions() {
        for length in 0..data.len() {
            let result = read("a.msh", &data[..length]);
            assert!(result.is_err() || is_whole(&data, length), "{length} of {}", data.len());
        }
    }
}

/// Whether a cut leaves all the sections that matter.
fn is_whole(data: &[u8], length: usize) -> bool {
    let end = b"$EndElements";
    data.windows(end.len()).position(|text| text == end).is_some_and(|at| length >= at + end.len())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    #[test]
    fn mutated_files_never_panic(which in 0..9usize, edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
        let mut data = all_versions().swap_remove(which);
        for (at, byte) in edits {
            let at = at.index(data.len());
            data[at] = byte;
        }
        let _ = read("a.msh", &data);
    }
}
