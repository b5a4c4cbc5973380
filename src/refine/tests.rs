use super::*;
use crate::Vec3;
use crate::controls::Controls;
use crate::error::Location;
use crate::mesh::{Facet, Group, Mesh, Middles, Solid, SolidShape, block, check, faces};
use crate::scene::{Block, BlockShape, Located};
use crate::solid::element::{hex8, hex27, pyramid5, tet4, tet10, wedge6, wedge18};
use crate::surface::NormalOptions;
use crate::surface::test_meshes::{cubed_sphere, mesh_of};

fn times(value: u32) -> Located<u32> {
    Located { value, at: Location { file: "scene.toml".into(), line: 4, column: 10, text: "refine".into() } }
}

/// A block of the unit cube with its sides as groups, carried to where `place` says.
fn bricks(elements: [usize; 3], place: impl Fn(Vec3) -> Vec3) -> Mesh {
    let shape = BlockShape::Box { origin: Vec3::zeros(), size: Vec3::repeat(1.0) };
    let block = Block { shape, elements, grading: [1.0; 3], faces: Vec::new() };
    let mut mesh = block::generate(&Located { value: block, at: times(1).at }).unwrap();
    mesh.points.iter_mut().for_each(|x| *x = place(Vec3::from(*x)).into());
    mesh
}

/// The same with each hexahedron as six tetrahedra around its diagonal, and the triangles of the sides.
fn tetrahedra(mut mesh: Mesh) -> Mesh {
    let ways = [[1, 2], [2, 3], [3, 7], [7, 4], [4, 5], [5, 1]];
    let tet = |solid: &Solid, [a, b]: [usize; 2]| {
        let n = solid.nodes;
        Solid::new(SolidShape::Tet4, &[n[0], n[a], n[b], n[6]], solid.id)
    };
    mesh.solids = mesh.solids.iter().flat_map(|solid| ways.map(|way| tet(solid, way))).collect();
    with_sides(mesh)
}

/// With the facets of its boundary, in groups by their nodes.
fn with_sides(mut mesh: Mesh) -> Mesh {
    let boundary = faces::boundary(&mesh.solids);
    mesh.facets = boundary.iter().map(|(s, f)| mesh.solids[*s as usize].face(*f as usize)).collect();
    for group in mesh.groups.values_mut() {
        let holds = |facet: &Facet| facet.nodes().iter().all(|n| group.nodes.binary_search(n).is_ok());
        group.facets = (0..).zip(&mesh.facets).filter(|(_, facet)| holds(facet)).map(|(k, _)| k).collect();
    }
    mesh
}

/// The same with some hexahedra as two wedges each, and the triangles of the sides.
fn wedges(mut mesh: Mesh, some: impl Fn(usize) -> bool) -> Mesh {
    let halves = |(e, solid): (usize, &Solid)| {
        let wedge = |k: [usize; 6]| Solid::new(SolidShape::Wedge6, &k.map(|k| solid.nodes[k]), solid.id);
        if some(e) { vec![wedge([0, 1, 2, 4, 5, 6]), wedge([0, 2, 3, 4, 6, 7])] } else { vec![*solid] }
    };
    mesh.solids = mesh.solids.iter().enumerate().flat_map(halves).collect();
    with_sides(mesh)
}

/// The same with some hexahedra as six pyramids each around a node in their middle.
fn pyramids(mut mesh: Mesh, some: impl Fn(usize) -> bool) -> Mesh {
    let all = std::mem::take(&mut mesh.solids);
    for (e, solid) in all.iter().enumerate() {
        if !some(e) {
            mesh.solids.push(*solid);
            continue;
        }
        let apex = mesh.points.len() as u32;
        let sum: Vec3 = solid.nodes().iter().map(|n| Vec3::from(mesh.points[*n as usize])).sum();
        mesh.points.push((sum / 8.0).into());
        mesh.point_ids.push(u64::from(apex) + 1);
        for face in 0..6 {
            let [a, b, c, d] = solid.face(face).nodes;
            mesh.solids.push(Solid::new(SolidShape::Pyramid5, &[a, d, c, b, apex], solid.id));
        }
    }
    with_sides(mesh)
}

fn volumes(mesh: &Mesh) -> Vec<f64> {
    let at = |solid: &Solid, k: usize| mesh.points[solid.nodes[k] as usize];
    let volume = |solid: &Solid| match solid.shape {
        SolidShape::Hex8 => hex8::volume(&std::array::from_fn(|k| at(solid, k))),
        SolidShape::Wedge6 => wedge6::volume(&std::array::from_fn(|k| at(solid, k))),
        SolidShape::Pyramid5 => pyramid5::volume(&std::array::from_fn(|k| at(solid, k))),
        SolidShape::Tet4 => tet4::volume(&std::array::from_fn(|k| at(solid, k))),
        SolidShape::Tet10 => tet10::volume(&std::array::from_fn(|k| at(solid, k))),
        SolidShape::Wedge18 => wedge18::volume(&std::array::from_fn(|k| at(solid, k))),
        SolidShape::Hex27 => hex27::volume(&std::array::from_fn(|k| at(solid, k))),
    };
    mesh.solids.iter().map(volume).collect()
}

fn straight(mesh: Mesh, count: u32) -> Mesh {
    split(mesh, &times(count), &Curves::default(), |_, _| false).unwrap()
}

/// The points and elements of a mesh whatever their order: all nodes, and the middle of each element.
fn places(mesh: &Mesh) -> Vec<[i64; 3]> {
    let round = |x: Vec3| <[f64; 3]>::from(x).map(|x| (x * 1e12).round() as i64);
    let point = |n: u32| Vec3::from(mesh.points[n as usize]);
    let middle = |nodes: &[u32]| round(nodes.iter().map(|n| point(*n)).sum::<Vec3>() / nodes.len() as f64);
    let mut all: Vec<[i64; 3]> = (0..mesh.points.len() as u32).map(|n| round(point(n))).collect();
    all.extend(mesh.solids.iter().map(|solid| middle(solid.nodes())));
    all.extend(mesh.facets.iter().map(|facet| middle(facet.nodes())));
    all.sort_unstable();
    all
}

#[test]
fn a_block_becomes_the_block_of_twice_the_numbers() {
    let place = |x: Vec3| Vec3::new(3.0 * x.x + 0.2 * x.y, 2.0 * x.y, 0.7 * x.z - 0.1 * x.x);
    for (count, factor) in [(1, 2), (2, 4)] {
        let coarse = bricks([3, 2, 1], place);
        let fine = bricks([3, 2, 1].map(|n| n * factor), place);
        let split = straight(coarse, count);
        assert_eq!(places(&split), places(&fine));
        for (name, group) in &split.groups {
            let of = |mesh: &Mesh, group: &Group| (group.nodes.len(), group.facets.len(), mesh.facets.len());
            assert_eq!(of(&split, group), of(&fine, &fine.groups[name]), "{name}");
            let nodes: Vec<u32> = group.facets.iter().flat_map(|f| split.facets[*f as usize].nodes).collect();
            assert!(nodes.iter().all(|n| group.nodes.binary_search(n).is_ok()), "{name}");
        }
        assert_eq!(faces::boundary(&split.solids).len(), split.facets.len());
    }
}

/// Nodes of the mesh stay; the others are numbered on, and parts have the number of their element.
#[test]
fn numbers_go_on() {
    let mut mesh = bricks([2, 1, 1], |x| x);
    mesh.point_ids.iter_mut().for_each(|id| *id *= 7);
    let split = straight(mesh.clone(), 1);
    let old = mesh.points.len();
    assert_eq!((&split.points[..old], &split.point_ids[..old]), (&mesh.points[..], &mesh.point_ids[..]));
    let last = 7 * old as u64;
    assert_eq!(split.point_ids[old..].to_vec(), (last + 1..last + 1 + 45 - 12).collect::<Vec<u64>>());
    let ids: Vec<u64> = split.solids.iter().map(|solid| solid.id).collect();
    assert_eq!(ids, [vec![1; 8], vec![2; 8]].concat());
    mesh.point_ids[0] = u64::MAX - 3;
    let text = super::split(mesh, &times(1), &Curves::default(), |_, _| false).unwrap_err().to_string();
    assert!(text.starts_with("scene.toml:4:10: there are no numbers for 33 new nodes"), "{text}");
}

/// Parts fill their element, all with the same volume, and keep their shapes however often they are split.
#[test]
fn tetrahedra_keep_their_volume_and_shape() {
    let shear = |x: Vec3| Vec3::new(x.x + 0.3 * x.y, x.y + 0.2 * x.z, 0.8 * x.z);
    let mesh = tetrahedra(bricks([1, 1, 1], shear));
    let whole = volumes(&mesh);
    // Volume over that of a cube on the longest edge.
    let worst = |mesh: &Mesh| {
        let point = |n: u32| Vec3::from(mesh.points[n as usize]);
        let longest = |solid: &Solid| {
            let n = solid.nodes();
            let edges = n.iter().flat_map(|a| n.iter().map(|b| (point(*a) - point(*b)).norm()));
            edges.fold(0.0, f64::max)
        };
        let shapes = mesh.solids.iter().zip(volumes(mesh)).map(|(solid, volume)| volume / longest(solid).powi(3));
        shapes.fold(f64::INFINITY, f64::min)
    };
    let shape = worst(&mesh);
    for count in 1..=4 {
        let split = straight(mesh.clone(), count);
        let parts = 1 << (3 * count);
        assert_eq!(split.solids.len(), 6 * parts);
        for (solid, volume) in split.solids.iter().zip(volumes(&split)) {
            let own = mesh.solids.iter().position(|s| s.nodes == mesh.solids[0].nodes).unwrap();
            assert!((volume * parts as f64 / whole[own] - 1.0).abs() < 1e-12, "{} {volume}", solid.id);
        }
        assert!(worst(&split) > 0.5 * shape, "{} {shape}", worst(&split));
        assert_eq!(faces::boundary(&split.solids).len(), split.facets.len());
    }
}

/// Wedges between hexahedra fit together however often they are split, and fill the same volume in equal parts.
#[test]
fn wedges_are_split_with_the_hexahedra_beside_them() {
    let shear = |x: Vec3| Vec3::new(x.x + 0.3 * x.y, x.y + 0.2 * x.z, 0.8 * x.z);
    let mesh = wedges(bricks([3, 2, 2], shear), |e| e % 6 != 2 && e % 6 != 4);
    let whole = volumes(&mesh);
    for count in 1..=2 {
        let (split, parts) = (straight(mesh.clone(), count), 1 << (3 * count));
        check::check(&split).unwrap();
        assert_eq!(split.solids.len(), mesh.solids.len() * parts);
        for (volume, own) in volumes(&split).iter().zip(whole.iter().flat_map(|own| std::iter::repeat_n(own, parts))) {
            assert!((volume * parts as f64 / own - 1.0).abs() < 1e-12);
        }
        assert_eq!(faces::boundary(&split.solids).len(), split.facets.len());
        assert_eq!(split.points.len(), straight(bricks([3, 2, 2], shear), count).points.len());
    }
}

/// Pyramids become pyramids and tetrahedra that fit together and to hexahedra beside them, and fill the same volume.
#[test]
fn pyramids_are_split_with_the_hexahedra_beside_them() {
    let shear = |x: Vec3| Vec3::new(x.x + 0.3 * x.y, x.y + 0.2 * x.z, 0.8 * x.z);
    let mesh = pyramids(bricks([3, 2, 2], shear), |e| e % 3 != 1);
    let whole: f64 = volumes(&mesh).iter().sum();
    let count_of = |mesh: &Mesh, shape| mesh.solids.iter().filter(|solid| solid.shape == shape).count();
    let (hexahedra, apart) = (count_of(&mesh, SolidShape::Hex8), count_of(&mesh, SolidShape::Pyramid5));
    for (count, parts) in [(1, [8, 6, 4]), (2, [64, 44, 40])] {
        let split = straight(mesh.clone(), count);
        check::check(&split).unwrap();
        let found = [SolidShape::Hex8, SolidShape::Pyramid5, SolidShape::Tet4].map(|shape| count_of(&split, shape));
        assert_eq!(found, [hexahedra * parts[0], apart * parts[1], apart * parts[2]]);
        let all = volumes(&split);
        assert!(all.iter().all(|volume| *volume > 0.0) && (all.iter().sum::<f64>() / whole - 1.0).abs() < 1e-12);
        assert_eq!(faces::boundary(&split.solids).len(), split.facets.len());
        // Split twice in one go it has the nodes of twice split, if not the same tetrahedra.
        let nodes = |mesh: Mesh| places(&Mesh { solids: Vec::new(), ..mesh });
        assert!(nodes(split) == nodes((0..count).fold(mesh.clone(), |mesh, _| straight(mesh, 1))));
    }
}

/// The patch of a shell of radii 0.5 and 1 over the angles 0 to 45 degrees about y and x, which ends in the planes x = 0
/// and y = 0.
fn shell(n: usize, of: &str) -> Mesh {
    let angle = std::f64::consts::FRAC_PI_4;
    let place = |x: Vec3| {
        let way = Vec3::new((angle * x.x).tan(), (angle * x.y).tan(), 1.0);
        way.normalize() * (0.5 + 0.5 * x.z)
    };
    let mut mesh = bricks([n, n, n.div_ceil(2)], place);
    mesh.points.iter_mut().flatten().for_each(|x| *x = if x.abs() < 1e-15 { 0.0 } else { *x });
    match of {
        "tetrahedra" => tetrahedra(mesh),
        // Every other one of each layer, those of all layers above one another.
        "wedges" => wedges(mesh, |e| (e % (n * n)).is_multiple_of(2)),
        "pyramids" => pyramids(mesh, |e| e.is_multiple_of(2)),
        _ => mesh,
    }
}

const SHAPES: [&str; 4] = ["hexahedra", "tetrahedra", "wedges", "pyramids"];

fn curved(mesh: Mesh, count: u32) -> Mesh {
    let curves = of_body(&mesh, &["xmin", "ymin"], &Controls::default()).unwrap();
    split(mesh, &times(count), &curves, |_, _| false).unwrap()
}

/// The volume converges with the square of the parts' size to that inside the patches, which is much closer to that of the
/// shell, asin(sin^2 45) (1 - 1/8) / 3, than the mesh is. What is left is of the normals at sharp edges, which are estimates.
#[test]
fn the_volume_of_a_shell_converges_as_its_patches_promise() {
    let exact = (0.5_f64).asin() * 7.0 / 24.0;
    for of in SHAPES {
        for n in [3, 6] {
            let volume = |count: u32| volumes(&curved(shell(n, of), count)).iter().sum::<f64>();
            let errors: Vec<f64> = (0..4).map(|count| volume(count) / exact - 1.0).collect();
            let (first, second) = (errors[1] - errors[2], errors[2] - errors[3]);
            let (order, limit) = ((first / second).log2(), errors[3] - second / 3.0);
            println!("n = {n}, {of}: {errors:?}, order {order:.3}, limit {limit:.2e}");
            assert!((order - 2.0).abs() < 0.02, "{order}");
            assert!(limit.abs() < 5e-3 * errors[0].abs(), "{errors:?} {limit}");
        }
    }
}

/// New nodes of the round sides lie on the Nagata patches, those of planes in them to the last digit.
#[test]
fn round_sides_stay_round_and_planes_plane() {
    for of in SHAPES {
        for count in 1..=3 {
            let split = curved(shell(2, of), count);
            check::check(&split).unwrap();
            for (side, radius) in [("zmin", 0.5), ("zmax", 1.0)] {
                let off = |n: &u32| (Vec3::from(split.points[*n as usize]).norm() / radius - 1.0).abs();
                let worst = split.groups[side].nodes.iter().map(off).fold(0.0, f64::max);
                // Facets would be off by 1.9e-2 along edges. Normals at the sharp ends are estimates.
                assert!(worst < 4e-3 && worst > 1e-5, "{side} {worst:e}");
            }
            for (side, axis) in [("xmin", 0), ("ymin", 1)] {
                assert!(split.groups[side].nodes.iter().all(|n| split.points[*n as usize][axis] == 0.0), "{side}");
            }
            // The planes x = z and y = z are slanted.
            for (side, axis) in [("xmax", 0), ("ymax", 1)] {
                let off = |n: &u32| (split.points[*n as usize][axis] - split.points[*n as usize][2]).abs();
                assert!(split.groups[side].nodes.iter().map(off).fold(0.0, f64::max) < 1e-14, "{side}");
            }
        }
    }
}

/// On closed surfaces of facets new nodes stand on the patches; splitting twice puts nodes where splitting once does.
#[test]
fn facets_are_split_on_their_patches() {
    for triangles in [false, true] {
        let ball = cubed_sphere(3, triangles, 6);
        let curves = of_surface(&ball, &NormalOptions::default(), false).unwrap();
        let [once, twice] = [1, 2].map(|count| split(ball.clone(), &times(count), &curves, |_, _| false).unwrap());
        assert_eq!([&once, &twice].map(|mesh| mesh.facets.len() / ball.facets.len()), [4, 16]);
        let off = |mesh: &Mesh| mesh.points.iter().map(|x| (Vec3::from(*x).norm() - 1.0).abs()).fold(0.0, f64::max);
        assert!(off(&once) > 1e-4 && off(&once) < 5e-3 && off(&twice) < 5e-3, "{} {}", off(&once), off(&twice));
        let fine = places(&Mesh { facets: Vec::new(), ..twice });
        let coarse = places(&Mesh { facets: Vec::new(), ..once });
        assert!(coarse.iter().all(|place| fine.binary_search(place).is_ok()));
        // Turned over it is the same surface.
        let turned = of_surface(&ball, &NormalOptions::default(), true).unwrap();
        assert_eq!(turned.edges, curves.edges);
        assert!(curves.of.iter().all(|(edge, c)| (turned.of[edge] - c).norm() < 1e-15));
    }
}

/// The same with a node in the middle of each edge, which `place` carries with the others.
fn quadratic(mut mesh: Mesh, place: impl Fn(Vec3) -> Vec3) -> Mesh {
    let mut known = std::collections::HashMap::new();
    for solid in &mut mesh.solids {
        let mut nodes = solid.nodes;
        for ([i, j], middle) in faces::TET_EDGES.iter().zip(4..) {
            let ends = [nodes[*i].min(nodes[*j]), nodes[*i].max(nodes[*j])];
            nodes[middle] = *known.entry(ends).or_insert_with(|| {
                let [a, b] = ends.map(|n| Vec3::from(mesh.points[n as usize]));
                mesh.points.push((0.5 * (a + b)).into());
                mesh.point_ids.push(mesh.points.len() as u64);
                mesh.points.len() as u32 - 1
            });
        }
        *solid = Solid::new(SolidShape::Tet10, &nodes, solid.id);
    }
    mesh.points.iter_mut().for_each(|x| *x = place(Vec3::from(*x)).into());
    mesh.middles = Middles::in_solids(mesh.solids.iter(), mesh.facets.iter().map(Facet::nodes), [].into_iter());
    for group in mesh.groups.values_mut() {
        group.nodes.extend(group.facets.iter().flat_map(|&k| mesh.middles.around(mesh.facets[k as usize].nodes())));
        group.nodes.sort_unstable();
        group.nodes.dedup();
    }
    mesh
}

/// A block with curved edges, all of them parabolas: its parts are the same in all ways of splitting, and their nodes are where
/// the map that bends the block puts them.
#[test]
fn quadratic_tetrahedra_are_split_on_their_own_edges() {
    let bend = |x: Vec3| Vec3::new(x.x, x.y, x.z + 0.2 * x.x * x.x - 0.1 * x.x * x.y);
    let back = |x: Vec3| Vec3::new(x.x, x.y, x.z - 0.2 * x.x * x.x + 0.1 * x.x * x.y);
    let mesh = quadratic(tetrahedra(bricks([1, 2, 1], |x| x)), bend);
    check::check(&mesh).unwrap();
    let split = |count| split(mesh.clone(), &times(count), &of_quadratic(&mesh), |_, _| false).unwrap();
    let [once, twice] = [split(1), split(2)];
    assert_eq!([&once, &twice].map(|m| m.solids.len() / mesh.solids.len()), [8, 64]);
    for (fine, cells) in [(&once, 4.0), (&twice, 8.0)] {
        assert!(fine.solids.iter().all(|solid| solid.shape == SolidShape::Tet10));
        assert_eq!(fine.points.len() as f64, (cells + 1.0) * (2.0 * cells + 1.0) * (cells + 1.0));
        for solid in &fine.solids {
            for ([a, b], middle) in solid.middles() {
                let [a, b, middle] = [a, b, middle].map(|n| back(Vec3::from(fine.points[n as usize])));
                assert!((middle - 0.5 * (a + b)).norm() < 1e-14, "{middle} {a} {b}");
            }
        }
        let top = &fine.groups["zmax"];
        assert_eq!(top.nodes.len() as f64, (cells + 1.0) * (2.0 * cells + 1.0));
        let corners = top.facets.iter().map(|&k| fine.facets[k as usize].nodes());
        assert!(corners.clone().all(|corners| fine.middles.of(corners).is_some()));
        assert!(top.nodes.iter().all(|&n| (back(Vec3::from(fine.points[n as usize])).z - 1.0).abs() < 1e-14));
        let volume: f64 = volumes(fine).iter().sum();
        assert!((volume - 1.0).abs() < 1e-13, "{volume}");
    }
}

/// Of a plate of 2 by 1 bricks: what becomes of lines, of bare nodes along an edge, on a face and throughout an element, of a
/// group of nodes and faces, and of lone nodes.
#[test]
fn groups_go_over_to_the_parts() {
    let mut mesh = bricks([2, 1, 1], |x| x);
    let solid = mesh.solids[0];
    let face = solid.face(0);
    let sorted = |nodes: &[u32]| {
        let mut nodes = nodes.to_vec();
        nodes.sort_unstable();
        nodes
    };
    let bare = |nodes: &[u32]| Group { nodes: sorted(nodes), ..Group::default() };
    let facet = mesh.facets.iter().position(|f| f.key() == face.key()).unwrap() as u32;
    let far = mesh.solids[1].nodes[6];
    let groups = [
        ("edge", bare(&[0, 1])),
        ("line", Group { lines: vec![[0, 1]], ..bare(&[0, 1]) }),
        ("chord", Group { lines: vec![[0, far]], ..bare(&[0, far]) }),
        ("face", bare(face.nodes())),
        ("element", bare(solid.nodes())),
        ("facet", Group { facets: vec![facet], ..bare(face.nodes()) }),
        ("facet and node", Group { facets: vec![facet], ..bare(&[face.nodes(), &[far]].concat()) }),
        ("both ends", Group { facets: vec![facet], ..bare(solid.nodes()) }),
        ("solid", Group { solids: vec![0], ..bare(solid.nodes()) }),
        ("point", bare(&[far])),
    ];
    mesh.groups = groups.iter().map(|(name, group)| (name.to_string(), group.clone())).collect();
    let split = straight(mesh, 2);
    let count = |name: &str| {
        let group = &split.groups[name];
        (group.nodes.len(), group.lines.len(), group.facets.len(), group.solids.len())
    };
    assert_eq!(count("edge"), (5, 0, 0, 0));
    assert_eq!(count("line"), (5, 4, 0, 0));
    assert_eq!(count("chord"), (2, 1, 0, 0));
    assert_eq!(count("face"), (25, 0, 0, 0));
    assert_eq!(count("element"), (125, 0, 0, 0));
    assert_eq!(count("facet"), (25, 0, 16, 0));
    assert_eq!(count("facet and node"), (26, 0, 16, 0));
    assert_eq!(count("both ends"), (125, 0, 16, 0));
    assert_eq!(count("solid"), (125, 0, 0, 64));
    assert_eq!(count("point"), (1, 0, 0, 0));
}

/// A ring of one layer stays one layer, of the same thickness everywhere.
#[test]
fn edges_that_are_whole_stay() {
    let ring = |x: Vec3| {
        let (angle, radius) = (1.2 * x.y, 1.0 + x.x);
        Vec3::new(radius * angle.cos(), radius * angle.sin(), 0.3 * x.z)
    };
    let mesh = bricks([2, 4, 1], ring);
    let upright = |a: u32, b: u32| {
        let [a, b] = [a, b].map(|n| mesh.points[n as usize]);
        a[..2] == b[..2]
    };
    let curves = of_body(&mesh, &[], &Controls::default()).unwrap();
    let split = super::split(mesh.clone(), &times(2), &curves, upright).unwrap();
    assert_eq!(split.solids.len(), mesh.solids.len() * 16);
    assert!(split.points.iter().all(|x| x[2] == 0.0 || x[2] == 0.3));
    let mut split = split;
    let ties = crate::mesh::tie_layer(&mut split, "plane_strain", &times(1).at).unwrap();
    assert_eq!(ties.len(), 2 * 9 * 17);
    assert_eq!(split.groups["xmin"].facets.len(), 16);
    assert_eq!(split.groups["zmin"].facets.len(), 8 * 16);
    // The arcs are round to the error of their patches, 17 degrees each.
    let off = |n: &u32| {
        let x = split.points[*n as usize];
        (x[0].hypot(x[1]) - 2.0).abs()
    };
    let worst = split.groups["xmax"].nodes.iter().map(off).fold(0.0, f64::max);
    assert!(worst < 1.5e-4 && worst > 1e-6, "{worst:e}");
}

/// A thin element under a bulging face would be turned inside out.
#[test]
fn elements_thinner_than_their_arc_are_named() {
    let dome = |x: Vec3| {
        let (angle, radius) = (0.6 * (2.0 * x.x - 1.0), 1.0 + 0.002 * x.z);
        let height = if x.z > 0.5 { radius * angle.cos() } else { 0.99 * angle.cos() };
        Vec3::new(radius * angle.sin(), x.y, height)
    };
    // The lower side is cut off flat, with its ends just under the upper one.
    let mut mesh = bricks([2, 1, 1], dome);
    mesh.solids.iter_mut().zip([70, 71]).for_each(|(solid, id)| solid.id = id);
    let sharp = of_body(&mesh, &[], &Controls::default()).unwrap();
    let mut bulging = Curves::default();
    let top: Vec<_> =
        sharp.edges.iter().filter(|edge| edge.iter().all(|n| mesh.points[*n as usize][1] == 0.0)).collect();
    bulging.of.extend(top.iter().map(|edge| (**edge, Vec3::new(0.0, 0.0, 1.0))));
    let text = split(mesh, &times(1), &bulging, |_, _| false).unwrap_err().to_string();
    assert!(text.starts_with("scene.toml:4:10: 'block', split: element"), "{text}");
    assert!(text.contains("elements 70, 71 are") && text.contains("thicker than the arc"), "{text}");
}

#[test]
fn more_than_can_be_held_is_refused() {
    let mesh = bricks([10, 10, 6], |x| x);
    let text = split(mesh, &times(6), &Curves::default(), |_, _| false).unwrap_err().to_string();
    assert!(text.contains("600 elements would become 157286400 of 262144 parts each"), "{text}");
    assert!(text.contains("help: split them fewer times"), "{text}");
}

/// Two bricks that touch along an edge alone have no surface there.
#[test]
fn a_boundary_that_touches_itself_is_refused() {
    let mut mesh = bricks([2, 2, 1], |x| x);
    mesh.solids = vec![mesh.solids[0], mesh.solids[3]];
    let text = of_body(&mesh, &[], &Controls::default()).unwrap_err().to_string();
    assert!(text.contains("share an edge with a third"), "{text}");
    let triangles = mesh_of(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[&[0, 1, 2]]);
    assert_eq!(straight(triangles, 3).facets.len(), 64);
}
