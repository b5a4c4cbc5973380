use super::*;
use proptest::prelude::*;

/// Two unit cubes in a row along x as CAE or a user would write them, with all that a deck has around a mesh.
const DECK: &str = r#"*HEADING
a deck, with 1 heading
** a comment
*Node, NSET=all
 1, 0, 0, 0
 2, 1., 0., 0.
 3, 2., 0, 0
 4, 0, 1, 0
 5, 1, 1.0D0, 0
 6, 2, 1, 0
 7, 0, 0, 1
 8, 1, 0, 1
 9, 2, 0, 1e0
10, 0, 1, 1
11, 1, 1, 1
12, 2, 1, 1
*NODE
99, 5, 5, 5
*nset, nset=reference
99
*Element, type=C3D8R, ELSET=Left
101, 1, 2, 5, 4,
 7, 8, 11, 10
*ELEMENT, TYPE=C3D8,
 ELSET=right
102, 2,3,6,5,8,9,12,11
*ELEMENT, TYPE=S4, ELSET=skin
201, 1, 2, 8, 7
*ELEMENT, TYPE=MASS, ELSET=lump
301, 99
*NSET, NSET=front, GENERATE
 1, 3, 1
*NSET, NSET=both
front, 12
*ELSET, ELSET=cubes
left, RIGHT,
*ELSET, ELSET=front, GENERATE
101, 999
*SURFACE, NAME=top, TYPE=ELEMENT
cubes, S2
*SURFACE, NAME=Ends, TYPE=ELEMENT
101, S6
102, S4
*SURFACE, NAME=free
cubes
*SURFACE, NAME=inner, TYPE=ELEMENT
skin, SNEG
*SURFACE, NAME=outer
skin, SPOS
*SURFACE, NAME=dots, TYPE=NODE
both, 1.
7
*MATERIAL, NAME=steel
*ELASTIC
210000., 0.3
*STEP
*STATIC
0.1, 1.
*NODE OUTPUT
U, RF
*ELEMENT OUTPUT, DIRECTIONS=YES
S,
*BOUNDARY
front, 1, 3
*END STEP
"#;

fn parse(text: &str) -> Result<FileMesh> {
    read(Path::new("deck.inp"), "deck.inp", text.as_bytes().to_vec(), true)
}

fn message_of(text: &str) -> String {
    parse(text).map(|file| file.mesh).unwrap_err().to_string()
}

#[test]
fn a_deck_gives_its_mesh_and_groups() {
    let file = parse(DECK).unwrap();
    assert_eq!(file.mesh.points.len(), 13);
    assert_eq!(file.mesh.points[4], [1.0, 1.0, 0.0]);
    assert_eq!(file.mesh.solids.iter().map(|solid| solid.id).collect::<Vec<_>>(), [101, 102]);
    assert_eq!(file.mesh.solids[0].nodes(), [0, 1, 4, 3, 6, 7, 10, 9]);
    assert!(file.attached.iter().all(|&attached| attached));

    let names = [
        "Ends",
        "Left",
        "all",
        "both",
        "cubes",
        "dots",
        "free",
        "front",
        "inner",
        "lump",
        "outer",
        "reference",
        "right",
        "skin",
        "top",
    ];
    assert_eq!(file.groups.keys().collect::<Vec<_>>(), names);
    assert_eq!(file.groups["all"].group.nodes, (0..12).collect::<Vec<_>>());
    assert_eq!(file.groups["cubes"].group.solids, [0, 1]);
    assert_eq!(file.groups["both"].group.nodes, [0, 1, 2, 11]);
    let mut dots = file.groups["dots"].group.nodes.clone();
    dots.sort();
    assert_eq!(dots, [0, 1, 2, 6, 11]);
    // The node set gives the nodes, the element set the solids.
    assert_eq!((&file.groups["front"].group.nodes, file.groups["front"].closed), (&vec![0, 1, 2], true));
    assert_eq!(file.groups["front"].group.solids, [0, 1]);

    let nodes = |name: &str| -> Vec<&[u32]> {
        file.groups[name].group.facets.iter().map(|&facet| file.mesh.facets[facet as usize].nodes()).collect()
    };
    assert_eq!(nodes("skin"), [[0, 1, 7, 6]]);
    assert_eq!(nodes("outer"), nodes("skin"));
    assert_eq!(nodes("inner"), [[0, 6, 7, 1]]);
    assert_eq!(nodes("top"), [[6, 7, 10, 9], [7, 8, 11, 10]]);
    assert_eq!(nodes("Ends"), [[3, 0, 6, 9], [2, 5, 11, 8]]);
    assert_eq!(nodes("free").len(), 10);
    // Faces that several surfaces have are one facet.
    let top = &file.groups["top"].group.facets;
    assert!(top.iter().all(|facet| file.groups["free"].group.facets.contains(facet)));
}

/// As Gmsh exports a tetrahedron: entities as sets of their own, physical groups as sets of element numbers, surfaces as
/// plane stress elements.
#[test]
fn exports_of_gmsh_are_read() {
    let deck = "*Heading\n deck.inp\n*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n\
                ******* E L E M E N T S *************\n*ELEMENT, type=T3D2, ELSET=Line1\n1, 1, 2\n\
                *ELEMENT, type=CPS3, ELSET=Surface1\n2, 1, 2, 3\n*ELEMENT, type=CPS3, ELSET=Surface2\n3, 1, 2, 4\n\
                *ELEMENT, type=C3D4, ELSET=Volume1\n4, 1, 2, 3, 4\n\
                *ELSET,ELSET=edge\n1, \n*ELSET,ELSET=base\n2, \n*ELSET,ELSET=all\n4, \n";
    let file = parse(deck).unwrap();
    assert_eq!((file.mesh.solids.len(), file.mesh.facets.len()), (1, 2));
    assert_eq!(file.groups["base"].group.facets, [0]);
    assert_eq!(file.groups["all"].group.solids, [0]);
    assert_eq!(
        (&file.groups["edge"].group.nodes[..], &file.groups["edge"].group.lines[..]),
        (&[0, 1][..], &[[0, 1]][..])
    );
}

#[test]
fn a_surface_and_an_element_set_of_one_name_have_the_nodes_of_the_surface() {
    let file = parse(&DECK.replace("NAME=top", "NAME=LEFT")).unwrap();
    let group = &file.groups["Left"];
    assert_eq!((group.group.facets.len(), &group.group.solids[..], group.closed), (2, &[0][..], true));
    assert!(group.group.nodes.iter().all(|&node| file.mesh.points[node as usize][2] == 1.0));
}

const PARTS: &str = "*PART, NAME=cube\n*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n\
    *ELEMENT, TYPE=C3D8, ELSET=body\n1,1,2,3,4,5,6,7,8\n*NSET, NSET=Set-1\n1\n*END PART\n\
    *PART, NAME=plate\n*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n*ELEMENT, TYPE=R3D3\n1,1,2,3\n\
    *ELSET, ELSET=all\n1\n*END PART\n\
    *ASSEMBLY, NAME=a\n*INSTANCE, NAME=A, PART=CUBE\n*END INSTANCE\n\
    *INSTANCE, NAME=B, PART=cube\n10., 0., 0.\n10.,0.,0., 10.,0.,1., 90.\n*END INSTANCE\n\
    *INSTANCE, NAME=P, PART=plate\n0,0,-1\n*END INSTANCE\n\
    *NSET, NSET=corner, INSTANCE=B\n2\n*ELSET, ELSET=_s1, INTERNAL, INSTANCE=A\n1\n*SURFACE, NAME=top\n_s1, S2\nB.body, S2\n\
    *NSET, NSET=pair\nA.1, B.1\n*NODE\n1, 9, 9, 9\n*NSET, NSET=rp\n1\n*END ASSEMBLY\n";

#[test]
fn instances_stand_where_they_are_put() {
    let file = parse(PARTS).unwrap();
    assert_eq!((file.mesh.solids.len(), file.mesh.facets.len(), file.mesh.points.len()), (2, 3, 20));
    let group = |name: &str| &file.groups[name].group;
    // The assembly's reference point comes first, then cube A, cube B, the plate.
    assert_eq!(group("pair").nodes, [1, 9]);
    assert_eq!(group("corner").nodes, [10]);
    let place = file.mesh.points[10];
    let wanted = [10.0, 1.0, 0.0];
    assert!((0..3).all(|i| (place[i] - wanted[i]).abs() < 1e-14), "{place:?}");
    assert_eq!(file.mesh.points[17], [0.0, 0.0, -1.0]);
    assert_eq!(group("top").facets.len(), 2);
    assert_eq!(group("B").solids, [1]);
    assert_eq!(group("P").facets, [0]);
    assert_eq!((group("A.body").solids.len(), group("B.body").solids.len()), (1, 1));
    assert!(!file.groups.contains_key("body"), "two instances have this name");
    assert_eq!(group("all").facets, group("P.all").facets);
    assert!(!file.groups.contains_key("_s1"));
    assert!(file.attached[0], "a reference point");

    // A name with a space in quotation marks, around the instance's alone.
    let quoted = [("=B,", "=\"a B\","), ("=B\n", "=\"a B\"\n"), ("B.body", "\"a B\".body"), ("B.1", "\"a B\".1")];
    let quoted = parse(&quoted.iter().fold(PARTS.to_string(), |deck, (from, to)| deck.replace(from, to))).unwrap();
    assert_eq!((&quoted.groups["pair"].group.nodes[..], quoted.groups["top"].group.facets.len()), (&[1, 9][..], 2));

    let alone = PARTS.split("*ASSEMBLY").next().unwrap();
    let file = parse(alone).unwrap();
    assert_eq!((file.mesh.solids.len(), file.mesh.facets.len()), (1, 1));
    assert_eq!(file.groups["body"].group.solids, [0]);
}

#[test]
fn included_files_are_read_in_place() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("main.inp");
    let split = DECK.find("*Element, type=C3D8R").unwrap();
    std::fs::write(folder.path().join("nodes.inc"), &DECK[..split]).unwrap();
    std::fs::write(folder.path().join("loop.inc"), "*INCLUDE, INPUT=loop.inc\n").unwrap();
    let open = |text: String| read(&path, "main.inp", text.into_bytes(), true);
    let file = open(format!("*INCLUDE, INPUT=nodes.inc\n{}", &DECK[split..])).unwrap();
    assert_eq!(file.mesh.points, parse(DECK).unwrap().mesh.points);

    let text = open("**\n*INCLUDE, INPUT=none.inc\n".into()).map(|file| file.mesh).unwrap_err().to_string();
    assert!(text.starts_with("main.inp:2:1: cannot read the included file"), "{text}");
    let text = open("*INCLUDE, INPUT=loop.inc\n".into()).map(|file| file.mesh).unwrap_err().to_string();
    assert!(text.contains("loop.inc:1:1: 'loop.inc' includes itself"), "{text}");
}

#[test]
fn errors_name_the_line() {
    let cases = [
        ("\n 3, 2., 0, 0", "\n 3, 2., x, 0", "deck.inp:7:1: expected a coordinate, found 'x'\n  | 3, 2., x, 0"),
        ("\n 3, 2.", "\n c, 2.", "deck.inp:7:1: expected a node number, found 'c'"),
        ("102, 2,3,6,5,8,9,12,11", "102, 2,3,6,5,8,9,12", "element 102 has 7 nodes, not 8"),
        ("102, 2,3,6,5,8,9,12,11", "102, 2,3,6,5,8,9,12,", "element 102 is not complete before this line"),
        (
            "102, 2,3,6,5,8,9,12,11",
            "102, 2,3,6,5,8,9,12,77",
            "deck.inp: element 102 names node 77, which does not exist",
        ),
        ("102, 2,3", "101, 2,3", "deck.inp: element 101 is defined twice"),
        ("12, 2, 1, 1", "11, 2, 1, 1", "deck.inp: node 11 is defined twice"),
        ("type=C3D8R,", "", "*ELEMENT needs TYPE="),
        ("NSET=all", "SYSTEM=S", "only rectangular and cylindrical coordinates are read"),
        ("NSET=all", "INPUT=file", "*NODE, INPUT= is not read\n  | *Node, INPUT=file\n  help: use *INCLUDE"),
        ("front, 12", "frond, 12", "there is no node set 'frond'\n  | frond, 12\n  help: did you mean `front`?"),
        ("front, 12", "front, 13", "deck.inp: set 'both' names node 13, which does not exist"),
        (" 1, 3, 1", " 3, 1, 1", "expected first, last and increment"),
        ("cubes, S2", "cubes, S7", "expected a face S1 to S6, SPOS or SNEG, found 'S7'"),
        ("cubes, S2", "cubes, SPOS", "a solid has no positive or negative side"),
        ("skin, SNEG", "skin, S6", "a surface element has no such face"),
        ("skin, SNEG", "lump, S1", "a point or a line has no faces"),
        ("skin, SNEG", ", S1", "expected a set or a number before the face"),
        ("*NODE OUTPUT", "*NGEN", "*NGEN is not read"),
        ("*NODE OUTPUT", "*SYSTEM", "coordinate systems of nodes are not read"),
        ("*NODE OUTPUT", "*INSTANCE, NAME=i, PART=p", "there is no part 'p' above"),
        ("*NODE OUTPUT", "*NSET, NSET=n, INSTANCE=i", "there is no instance 'i' above"),
        (
            "*NODE OUTPUT",
            "*NSET, NSET=n, ELSET=cub\n*NODE OUTPUT",
            "there is no element set 'cub'\n  | *NSET, NSET=n, ELSET=cub\n  help: did you mean `cubes`?",
        ),
        ("*NODE OUTPUT", "*SURFACE, NAME=s, COMBINE=UNION", "combined surfaces are not read"),
        ("*NODE OUTPUT", "*PART, NAME=a\n*PART, NAME=b", "is still open"),
    ];
    for (from, to, wanted) in cases {
        assert!(DECK.contains(from), "{from}");
        let text = message_of(&DECK.replacen(from, to, 1));
        assert!(text.contains(wanted), "{text}\nshould have: {wanted}");
    }
    assert!(message_of("a mesh\n*NODE\n").contains("deck.inp:1:1: expected a keyword such as *NODE, found 'a mesh'"));
    let tetrahedron = "*NODE\n1\n2,1\n3,0,1\n4,0,0,1\n*ELEMENT, TYPE=C3D4\n5,1,2,3,4\n*SURFACE, NAME=s\n5, S5\n";
    assert!(message_of(tetrahedron).contains("deck.inp:9:1: element 5 has 4 faces, no S5"));
}

#[test]
fn elements_of_other_types_are_left_to_who_takes_them() {
    let file = parse(&DECK.replacen("type=C3D8R", "type=C3D13", 1)).unwrap();
    let wanted = "deck.inp:22:1: element 101 has type C3D13, which is not read";
    let told = |error: &Option<crate::error::Error>| error.as_ref().is_some_and(|e| e.to_string().starts_with(wanted));
    assert!(told(&file.unread));
    for (group, takes) in [("Left", true), ("cubes", true), ("front", true), ("right", false)] {
        assert_eq!(told(&file.groups[group].unread), takes, "{group}");
    }
}

#[test]
fn sets_of_the_nodes_of_elements() {
    let sets = "*NSET, NSET=n, ELSET=left\n*NSET, NSET=m, ELSET=right\n1, 4\n*NODE OUTPUT";
    let file = parse(&DECK.replacen("*NODE OUTPUT", sets, 1)).unwrap();
    let ids = |file: &FileMesh, group: &str| -> Vec<u64> {
        file.groups[group].group.nodes.iter().map(|&n| file.mesh.point_ids[n as usize]).collect()
    };
    assert_eq!(ids(&file, "n"), [1, 2, 4, 5, 7, 8, 10, 11]);
    assert_eq!(ids(&file, "m"), [1, 2, 3, 4, 5, 6, 8, 9, 11, 12]);
    let of_instances = "*NSET, NSET=n, ELSET=A.body\n*NSET, NSET=m, INSTANCE=B, ELSET=body\n*END ASSEMBLY";
    let file = parse(&PARTS.replacen("*END ASSEMBLY", of_instances, 1)).unwrap();
    assert_eq!(file.groups["n"].group.nodes, (1..=8).collect::<Vec<u32>>());
    assert_eq!(file.groups["m"].group.nodes, (9..=16).collect::<Vec<u32>>());
    // Of what is drawn out, those of the deck.
    let ring = "*NODE\n1,1\n2,2\n3,2,1\n4,1,1\n*ELEMENT, TYPE=CAX4, ELSET=ring\n9,1,2,3,4\n*NSET, NSET=n, ELSET=ring\n";
    assert_eq!(ids(&parse(ring).unwrap(), "n"), [1, 2, 3, 4]);
    // An element of a type that is not read has nodes that are not known.
    let text = message_of(&DECK.replacen("type=C3D8R", "type=C3D13", 1).replacen("*NODE OUTPUT", sets, 1));
    assert!(text.contains("element 101 has type C3D13, which is not read"), "{text}");
}

#[test]
fn cylindrical_coordinates() {
    let file = parse("*NODE, SYSTEM=C\n1, 2, 30, 5\n2, 2, 90\n*NODE\n3, 2, 30, 5\n").unwrap();
    let wanted = [[3.0f64.sqrt(), 1.0, 5.0], [0.0, 2.0, 0.0], [2.0, 30.0, 5.0]];
    for (found, wanted) in file.mesh.points.iter().flatten().zip(wanted.as_flattened()) {
        assert!((found - wanted).abs() < 1e-15 * 8.0, "{found} {wanted}");
    }
}

#[test]
fn sets_that_hold_each_other_end() {
    let file = parse("*NODE\n1\n*NSET, NSET=a\nb\n*NSET, NSET=b\na, a, 1\n").unwrap();
    assert_eq!(file.groups["a"].group.nodes, [0]);
}

#[test]
fn long_ranges_take_no_longer_than_there_are_nodes() {
    let file = parse("*NODE\n1\n7\n*NSET, NSET=a, GENERATE\n1, 18446744073709551615, 3\n").unwrap();
    assert_eq!(file.groups["a"].group.nodes, [0, 1]);
}

#[test]
fn truncated_decks_never_panic() {
    for deck in [DECK, PARTS] {
        for length in 0..deck.len() {
            let _ = parse(&deck[..length]);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    #[test]
    fn mutated_decks_never_panic(parts: bool, edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
        let mut data = if parts { PARTS } else { DECK }.as_bytes().to_vec();
        for (at, byte) in edits {
            let at = at.index(data.len());
            data[at] = byte;
        }
        let _ = read(Path::new("deck.inp"), "deck.inp", data, true);
    }
}

/// The faces of C3D6 in the order of the manual: Abaqus, "Three-dimensional solid element library", "Element faces".
#[test]
fn faces_of_wedges() {
    const FACES: [&[u64]; 5] = [&[1, 2, 3], &[4, 5, 6], &[1, 2, 4, 5], &[2, 3, 5, 6], &[1, 3, 4, 6]];
    let mut deck = String::from(
        "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,1,0,1\n6,0,1,1\n*ELEMENT, TYPE=C3D6, ELSET=ALL\n7,1,2,3,4,5,6\n",
    );
    (1..=5).for_each(|k| deck += &format!("*SURFACE, NAME=FACE{k}\nALL, S{k}\n"));
    let mesh = parse(&deck).unwrap();
    for (k, nodes) in FACES.iter().enumerate() {
        let group = &mesh.groups[&format!("FACE{}", k + 1)].group;
        let facet = mesh.mesh.facets[group.facets[0] as usize];
        let mut found: Vec<u64> = facet.nodes().iter().map(|&n| mesh.mesh.point_ids[n as usize]).collect();
        found.sort_unstable();
        assert_eq!(found, *nodes);
    }
    let text = message_of(&deck.replace("S5", "S6"));
    assert!(text.contains("element 7 has 5 faces, no S6"), "{text}");
}
