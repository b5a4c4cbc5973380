//! From the source of a mesh in the scene to the mesh of a body or tool.

use super::raw::FileMesh;
use super::select::{self, Selected, Wish};
use super::{Mesh, Purpose, abaqus, block, check, gmsh, message, middles, orient, stl};
use crate::encoding;
use crate::error::{Error, Result};
use crate::scene::{Located, MeshSource, did_you_mean};
use std::path::{Path, PathBuf};

/// Reads or generates a mesh, takes what `purpose` needs of it, orients its facets outward and checks it.
///
/// A body has solids, and facets that are boundary faces of them; a tool has facets alone, where quadratic ones have become four
/// linear ones each. Errors are wrong input at the path, the group, or a place in the mesh file.
pub fn load(source: &MeshSource, purpose: Purpose) -> Result<Mesh> {
    let mut is_closed = false;
    let Selected { mut mesh, mut outward } = match source {
        // All of a block is a body.
        MeshSource::Block(shape) if purpose == Purpose::Body => {
            Selected { mesh: block::generate(shape)?, outward: Vec::new() }
        }
        MeshSource::Block(shape) => {
            let wish = Wish { purpose, group: None, at: &shape.at };
            select::select(FileMesh::from(block::generate(shape)?), &wish)?
        }
        MeshSource::File { path, group } => {
            let file = read(path, purpose)?;
            let at = group.as_ref().map_or(&path.at, |group| &group.at);
            let group = group.as_ref().map(|group| group.value.as_str());
            is_closed = file.is_closed && group.is_none();
            select::select(file, &Wish { purpose, group, at })?
        }
    };
    if purpose == Purpose::Tool && !mesh.middles.is_empty() {
        let origins = middles::split_facets(&mut mesh);
        outward = origins.into_iter().map(|facet| outward[facet as usize]).collect();
    }
    check::check(&mesh)?;
    if purpose == Purpose::Tool {
        let turned = orient::align(&mut mesh, &outward, is_closed)?;
        if is_closed {
            tell_of_borders(&mut mesh, &turned);
        }
    }
    Ok(mesh)
}

/// Warns of what a surface that should be closed has: borders, and facets that looked inward.
fn tell_of_borders(mesh: &mut Mesh, turned: &[u64]) {
    let open = orient::open(mesh);
    let source = &mesh.source;
    if !open.is_empty() {
        let what = format!("'{source}': {} at a border: the surface is not closed", message::several("facet", &open));
        mesh.warnings.push(what);
    }
    if !turned.is_empty() {
        let what = format!("'{source}': {} turned over, to agree with the others", message::several("facet", turned));
        mesh.warnings.push(what);
    }
}

/// All of a mesh file. What stands first in it tells its format; its extension does when that is unclear.
fn read(path: &Located<PathBuf>, purpose: Purpose) -> Result<FileMesh> {
    let name = path.value.display().to_string();
    let data = std::fs::read(&path.value).map_err(|error| {
        Error::input(&path.at, format!("cannot read the mesh '{name}': {error}"), neighbours(&path.value))
    })?;
    let data = match stl::is_binary(&data) {
        true => data,
        false => encoding::unmarked(&path.value, data)
            .map_err(|(what, help)| Error::input(&path.at, format!("the mesh '{name}' {what}"), help))?,
    };
    let extension = path.value.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let mut file = match (data.trim_ascii_start().first(), extension.as_str()) {
        (_, "stl") => stl::read(&name, data)?,
        (Some(b'$'), _) | (_, "msh") => gmsh::read(&name, data)?,
        (Some(b'*'), _) | (_, "inp") => abaqus::read(&path.value, &name, data, purpose == Purpose::Body)?,
        _ if stl::is_text(&data) || stl::is_binary(&data) => stl::read(&name, data)?,
        _ => {
            let what = format!("'{name}' is neither a Gmsh, nor an Abaqus, nor an STL file");
            return Err(Error::input(
                &path.at,
                what,
                "meshes are read from Gmsh 2.2 and 4.1 (.msh) and Abaqus (.inp) files, surfaces of tools from STL (.stl), too",
            ));
        }
    };
    // They may be reference points, or middles of circles.
    let alone = (0..file.attached.len()).filter(|&node| !file.attached[node]).map(|node| file.mesh.point_ids[node]);
    let alone: Vec<u64> = alone.collect();
    if !alone.is_empty() {
        file.mesh.warnings.push(format!("'{name}': {} {}", message::several("node", &alone), check::ALONE));
    }
    Ok(file)
}

/// The mesh files beside one that is missing.
fn neighbours(path: &Path) -> String {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let is_mesh = |name: &String| [".msh", ".inp", ".stl"].iter().any(|end| name.to_lowercase().ends_with(end));
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> =
        entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).filter(is_mesh).collect();
    names.sort();
    let wanted = path.file_name().unwrap_or_default().to_string_lossy();
    match names.is_empty() {
        true => format!("there is no mesh file in '{}'", folder.display()),
        false => did_you_mean(&wanted, names.iter().map(String::as_str)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;
    use crate::error::Location;
    use crate::scene::{Block, BlockShape};

    /// Two unit cubes along x that share the face "middle", and apart from them a plate of two triangles that disagree.
    /// Bottom facets 3 and 4: one inward, one outward; facet 5 is between the cubes; node 13 to 16 are the plate's.
    const GMSH: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n6\n3 1 \"left\"\n3 2 \"right\"\n2 3 \"bottom\"\n\
        2 4 \"middle\"\n2 5 \"plate\"\n1 6 \"edge\"\n$EndPhysicalNames\n$Nodes\n16\n\
        1 0 0 0\n2 1 0 0\n3 2 0 0\n4 0 1 0\n5 1 1 0\n6 2 1 0\n7 0 0 1\n8 1 0 1\n9 2 0 1\n10 0 1 1\n11 1 1 1\n12 2 1 1\n\
        13 0 0 9\n14 1 0 9\n15 1 1 9\n16 0 1 9\n$EndNodes\n$Elements\n8\n1 1 2 6 6 3 6\n\
        2 5 2 1 1 1 2 5 4 7 8 11 10\n3 3 2 3 1 1 2 5 4\n4 3 2 3 1 2 5 6 3\n5 3 2 4 1 2 5 11 8\n\
        6 5 2 2 2 2 3 6 5 8 9 12 11\n7 2 2 5 5 13 14 15\n8 2 2 5 5 13 15 16\n$EndElements\n";

    fn at(line: usize) -> Location {
        Location { file: "scene.toml".into(), line, column: 1, text: "".into() }
    }

    /// Loads `text` as a file of the given name.
    fn load_as(name: &str, text: &str, group: Option<&str>, purpose: Purpose) -> Result<Mesh> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        let group = group.map(|group| Located { value: group.to_string(), at: at(8) });
        load(&MeshSource::File { path: Located { value: path, at: at(7) }, group }, purpose)
    }

    fn body(text: &str, group: Option<&str>) -> Result<Mesh> {
        load_as("mesh.msh", text, group, Purpose::Body)
    }

    fn tool(text: &str, group: Option<&str>) -> Result<Mesh> {
        load_as("mesh.msh", text, group, Purpose::Tool)
    }

    fn ids(mesh: &Mesh, nodes: &[u32]) -> Vec<u64> {
        nodes.iter().map(|&node| mesh.point_ids[node as usize]).collect()
    }

    fn message(result: Result<Mesh>) -> String {
        result.unwrap_err().to_string()
    }

    #[test]
    fn a_body_takes_all_solids_and_their_boundary() {
        let mesh = body(GMSH, None).unwrap();
        assert_eq!((mesh.points.len(), mesh.solids.len()), (12, 2));
        let facets: Vec<_> = mesh.facets.iter().map(|facet| (facet.id, ids(&mesh, facet.nodes()))).collect();
        assert_eq!(facets, [(3, vec![1, 4, 5, 2]), (4, vec![2, 5, 6, 3])]);
        assert_eq!(mesh.groups.keys().collect::<Vec<_>>(), ["bottom", "edge", "left", "middle", "right"]);
        assert_eq!(ids(&mesh, &mesh.groups["bottom"].nodes), [1, 2, 3, 4, 5, 6]);
        assert_eq!(ids(&mesh, &mesh.groups["edge"].nodes), [3, 6]);
        assert_eq!(ids(&mesh, &mesh.groups["edge"].lines.concat()), [3, 6]);
        // A face between solids keeps its nodes alone.
        assert_eq!(ids(&mesh, &mesh.groups["middle"].nodes), [2, 5, 8, 11]);
        assert!(mesh.groups["middle"].facets.is_empty());
        assert_eq!(mesh.groups["right"].solids, [1]);
        assert_eq!(ids(&mesh, &mesh.groups["right"].nodes), [2, 3, 5, 6, 8, 9, 11, 12]);
    }

    #[test]
    fn a_body_takes_a_group() {
        assert!(!body(GMSH, Some("left")).unwrap().groups.contains_key("edge"));
        let mesh = body(GMSH, Some("right")).unwrap();
        assert_eq!(mesh.point_ids, [2, 3, 5, 6, 8, 9, 11, 12]);
        assert_eq!((mesh.solids.len(), mesh.facets.len()), (1, 2));
        assert_eq!(ids(&mesh, mesh.solids[0].nodes()), [2, 3, 6, 5, 8, 9, 12, 11]);
        assert_eq!(ids(&mesh, &mesh.groups["bottom"].nodes), [2, 3, 5, 6]);
        assert_eq!(ids(&mesh, &mesh.groups["edge"].lines.concat()), [3, 6]);
        // Seen from the right cube alone, the face between the cubes is a side, outward to the left.
        let middle = mesh.facets[mesh.groups["middle"].facets[0] as usize];
        assert_eq!(ids(&mesh, middle.nodes()), [5, 2, 8, 11]);
        assert!(!mesh.groups.contains_key("left") && !mesh.groups.contains_key("plate"));
    }

    #[test]
    fn parts_of_one_file_may_touch_without_sharing_nodes() {
        // The right cube gets its own nodes 22, 25, 28, 31 in the plane x = 1.
        let twins = "\n22 1 0 0\n25 1 1 0\n28 1 0 1\n31 1 1 1\n$EndNodes";
        let apart = GMSH.replace("$Nodes\n16", "$Nodes\n20").replace("\n$EndNodes", twins);
        let apart = apart.replace("2 3 6 5 8 9 12 11", "22 3 6 25 28 9 12 31").replace("1 2 5 6 3\n", "1 22 25 6 3\n");
        assert_eq!(body(&apart, Some("right")).unwrap().points.len(), 8);
        assert_eq!(body(&apart, Some("left")).unwrap().points.len(), 8);
        let text = message(body(&apart, None));
        assert!(text.contains("nodes 2 and 22 are both at (1, 0, 0), and 3 more pairs"), "{text}");
    }

    #[test]
    fn a_tool_takes_facets_alone() {
        let plate = tool(GMSH, Some("plate")).unwrap();
        assert_eq!((plate.points.len(), plate.solids.len(), plate.facets.len()), (4, 0, 2));
        assert_eq!(plate.groups.keys().collect::<Vec<_>>(), ["plate"]);
        assert_eq!(ids(&plate, plate.facets[1].nodes()), [13, 15, 16]);
        let turned = tool(&GMSH.replace("13 15 16", "13 16 15"), Some("plate")).unwrap();
        assert_eq!(turned.facets, plate.facets);

        // Facets of a volume mesh point out of it, whichever way round the file has them.
        let bottom = tool(GMSH, Some("bottom")).unwrap();
        let facets: Vec<_> = bottom.facets.iter().map(|facet| ids(&bottom, facet.nodes())).collect();
        assert_eq!(facets, [[1, 4, 5, 2], [2, 5, 6, 3]]);
        // All facets meet in the edge from 2 to 5.
        let text = message(tool(GMSH, None));
        assert!(text.contains("the edge between nodes 2 and 5 has 3 facets ([3, 4, 5])"), "{text}");
    }

    #[test]
    fn blocks_are_bodies_and_tools() {
        let shape = BlockShape::Box { origin: Vec3::zeros(), size: Vec3::new(1.0, 1.0, 1.0) };
        let block = Block { shape, elements: [3, 3, 3], grading: [1.0; 3], faces: Vec::new() };
        let source = MeshSource::Block(Located { value: block, at: at(9) });
        let body = load(&source, Purpose::Body).unwrap();
        let direct = match &source {
            MeshSource::Block(block) => block::generate(block).unwrap(),
            MeshSource::File { .. } => Mesh::default(),
        };
        assert_eq!(body, direct);
        let tool = load(&source, Purpose::Tool).unwrap();
        assert_eq!((tool.points.len(), tool.solids.len(), tool.facets.len()), (64 - 8, 0, 54));
        assert_eq!(tool.groups["zmax"].nodes.len(), 16);
        let outward = |nodes: &[u32]| {
            let x: Vec<Vec3> = nodes.iter().map(|&node| tool.points[node as usize].into()).collect();
            (x[1] - x[0]).cross(&(x[2] - x[0])).dot(&(x[0] - Vec3::repeat(0.5))) > 0.0
        };
        assert!(tool.facets.iter().all(|facet| outward(facet.nodes())));
    }

    #[test]
    fn abaqus_surfaces_choose_the_side_of_a_tool() {
        let deck = "*NODE\n1,0,0\n2,1,0\n3,1,1\n4,0,1\n*NODE, NSET=reference\n9, 5, 5\n*ELEMENT, TYPE=R3D4, ELSET=plate\n\
                    1,1,2,3,4\n*SURFACE, NAME=under\nplate, SNEG\n*SURFACE, NAME=over\nplate, SPOS\n";
        let nodes = |group| {
            let mesh = load_as("tool.inp", deck, group, Purpose::Tool).unwrap();
            assert_eq!((mesh.points.len(), mesh.facets.len()), (4, 1));
            mesh.facets[0].nodes.map(|node| mesh.point_ids[node as usize])
        };
        assert_eq!(nodes(None), [1, 2, 3, 4]);
        assert_eq!(nodes(Some("plate")), [1, 2, 3, 4]);
        assert_eq!(nodes(Some("over")), [1, 2, 3, 4]);
        assert_eq!(nodes(Some("under")), [1, 4, 3, 2]);
    }

    #[test]
    fn a_skin_and_a_surface_on_one_face_are_one_facet() {
        let deck = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT, TYPE=C3D4, ELSET=solid\n1,1,2,3,4\n\
                    *ELEMENT, TYPE=S3, ELSET=skin\n2,1,2,3\n*SURFACE, NAME=base\n1, S1\n*SURFACE, NAME=side\n1, S3\n";
        let mesh = load_as("body.inp", deck, Some("solid"), Purpose::Body).unwrap();
        assert_eq!(mesh.facets.len(), 2);
        assert_eq!(mesh.groups["skin"].facets, mesh.groups["base"].facets);
        assert_eq!(mesh.facets[0].nodes(), [0, 2, 1]);
    }

    #[test]
    fn the_contents_tell_the_format() {
        assert_eq!(load_as("mesh.inp", GMSH, None, Purpose::Body).unwrap().solids.len(), 2);
        let text = message(load_as("mesh.obj", "v 0 0 0", None, Purpose::Body));
        assert!(
            text.starts_with("scene.toml:7:1: ") && text.contains("is neither a Gmsh, nor an Abaqus, nor an STL"),
            "{text}"
        );
    }

    #[test]
    fn missing_files_are_located_in_the_scene() {
        let folder = tempfile::tempdir().unwrap();
        let open = |name: &str| {
            let path = Located { value: folder.path().join(name), at: at(7) };
            message(load(&MeshSource::File { path, group: None }, Purpose::Body))
        };
        assert!(open("slab.msh").contains("help: there is no mesh file in"));
        std::fs::write(folder.path().join("slab.msh"), GMSH).unwrap();
        let text = open("slap.msh");
        assert!(text.starts_with("scene.toml:7:1: cannot read the mesh '"), "{text}");
        assert!(text.contains("help: did you mean `slab.msh`? (known: slab.msh)"), "{text}");
    }

    #[test]
    fn wrong_groups_are_located_in_the_scene() {
        let text = message(body(GMSH, Some("rigt")));
        assert!(text.starts_with("scene.toml:8:1: '") && text.contains("' has no group 'rigt'"), "{text}");
        assert!(text.ends_with("help: did you mean `right`? (known: left, right)"), "{text}");
        let text = message(body(GMSH, Some("bottom")));
        assert!(text.contains("group 'bottom' of '") && text.contains("has no volume elements"), "{text}");
        let text = message(tool(GMSH, Some("left")));
        assert!(text.contains("has no surface elements") && text.contains("known: bottom, middle, plate"), "{text}");
        let none = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n0\n$EndNodes\n$Elements\n0\n$EndElements\n";
        let text = message(body(none, None));
        assert!(text.starts_with("scene.toml:7:1: ") && text.contains("has no volume elements"), "{text}");
    }

    #[test]
    fn nodes_that_nothing_uses_are_passed_over_with_a_word() {
        let more = GMSH.replace("$Nodes\n16", "$Nodes\n17").replace("$EndNodes", "40 7 7 7\n$EndNodes");
        let mesh = body(&more, None).unwrap();
        assert_eq!(mesh.points, body(GMSH, None).unwrap().points);
        assert!(matches!(&mesh.warnings[..], [told] if told.ends_with("': node 40 is not part of any element")));
    }

    #[test]
    fn elements_that_are_not_read_matter_to_who_takes_them() {
        let deck = "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n9,5,5,5\n*ELEMENT, TYPE=C3D4, ELSET=solid\n1,1,2,3,4\n\
                    *ELEMENT, TYPE=DCOUP3D, ELSET=hub\n7,9,1\n*ELSET, ELSET=both\nsolid, hub\n*ELSET, ELSET=few, GENERATE\n1,7,2\n";
        let load = |group| load_as("body.inp", deck, group, Purpose::Body);
        for group in [None, Some("both"), Some("hub"), Some("few")] {
            let text = message(load(group));
            assert!(text.contains(":10:1: element 7 has type DCOUP3D, which is not read"), "{group:?}: {text}");
        }
        let mesh = load(Some("solid")).unwrap();
        assert_eq!(mesh.points.len(), 4);
        assert!(
            mesh.warnings[0].ends_with("element 7 of type DCOUP3D left out, which is not read"),
            "{:?}",
            mesh.warnings
        );
    }
}
