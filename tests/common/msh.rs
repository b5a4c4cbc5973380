//! Meshes for scenes, as the text of a Gmsh 2.2 file.

use std::fmt::Write;

/// Ways in which a cube is cut into tetrahedra along its diagonal: the order in which a path takes the axes (Kuhn).
const PATHS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];

/// A block of `n` hexahedra along each direction, or of six tetrahedra in each of them, with its sides as the groups
/// `xmin` ... `zmax`; `place` takes the unit cube to space and keeps its handedness.
pub fn block(n: [usize; 3], tetrahedra: bool, place: impl Fn([f64; 3]) -> [f64; 3]) -> String {
    let node = |i: [usize; 3]| 1 + i[0] + (n[0] + 1) * (i[1] + (n[1] + 1) * i[2]);
    let mut points = Vec::new();
    let mut elements: Vec<(usize, usize, Vec<usize>)> = Vec::new();
    for k in 0..=n[2] {
        for j in 0..=n[1] {
            for i in 0..=n[0] {
                points.push(place([i as f64 / n[0] as f64, j as f64 / n[1] as f64, k as f64 / n[2] as f64]));
            }
        }
    }
    for axis in 0..3 {
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        for (side, at) in [0, n[axis]].into_iter().enumerate() {
            for (i, j) in (0..n[a]).flat_map(|i| (0..n[b]).map(move |j| (i, j))) {
                let corner = |di: usize, dj: usize| {
                    let mut index = [at; 3];
                    (index[a], index[b]) = (i + di, j + dj);
                    node(index)
                };
                let mut faces = vec![vec![corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)]];
                if tetrahedra {
                    let [p, q, r, s] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                    faces = vec![vec![p, q, r], vec![p, r, s]];
                }
                for mut face in faces {
                    if side == 0 {
                        face.reverse();
                    }
                    elements.push((if tetrahedra { 2 } else { 3 }, 1 + 2 * axis + side, face));
                }
            }
        }
    }
    for (k, j, i) in (0..n[2]).flat_map(|k| (0..n[1]).flat_map(move |j| (0..n[0]).map(move |i| (k, j, i)))) {
        let corner = |d: [usize; 3]| node([i + d[0], j + d[1], k + d[2]]);
        if tetrahedra {
            for (p, path) in PATHS.iter().enumerate() {
                let mut d = [0; 3];
                let mut nodes = vec![corner(d)];
                for &axis in path {
                    d[axis] = 1;
                    nodes.push(corner(d));
                }
                if p >= 3 {
                    nodes.swap(1, 2);
                }
                elements.push((4, 7, nodes));
            }
        } else {
            let bottom = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]];
            let nodes = bottom.iter().chain(&bottom.map(|[x, y, _]| [x, y, 1])).map(|d| corner(*d)).collect();
            elements.push((5, 7, nodes));
        }
    }
    let mut names: Vec<(usize, &str)> = ["xmin", "xmax", "ymin", "ymax", "zmin", "zmax"].map(|name| (2, name)).into();
    names.push((3, "solid"));
    render(&names, &points, &elements)
}

/// A mesh of hexahedra that is extruded along the third of their directions, with `some` of them, by their order, as two wedges.
pub fn wedges(mesh: &str, some: impl Fn(usize) -> bool) -> String {
    let (head, rows) = elements_of(mesh);
    let is_cut = |e: usize, row: &[usize]| row[1] == 5 && some(e);
    let hexahedra = || rows.iter().filter(|row| row[1] == 5).enumerate();
    let ends = |row: &[usize]| [row[5..9].to_vec(), row[9..13].to_vec()];
    // The diagonal of each end that is cut, by its sorted nodes.
    let cut = hexahedra().filter(|(e, row)| is_cut(*e, row)).flat_map(|(_, row)| ends(row));
    let diagonals: std::collections::HashMap<_, _> = cut.map(|end| (sorted(&end), [end[0], end[2]])).collect();
    let mut parts: Vec<(usize, Vec<usize>, Vec<usize>)> = Vec::new();
    for row in rows.iter().filter(|row| row[1] != 5) {
        let (tags, nodes) = (row[2..5].to_vec(), &row[5..]);
        match diagonals.get(&sorted(nodes)) {
            Some([a, _]) => {
                let at = |k: usize| nodes[(nodes.iter().position(|n| n == a).unwrap() + k) % 4];
                parts.push((2, tags.clone(), vec![at(0), at(1), at(2)]));
                parts.push((2, tags, vec![at(0), at(2), at(3)]));
            }
            None => parts.push((row[1], tags, nodes.to_vec())),
        }
    }
    for (e, row) in hexahedra() {
        let tags = row[2..5].to_vec();
        if is_cut(e, row) {
            for half in [[0, 1, 2, 4, 5, 6], [0, 2, 3, 4, 6, 7]] {
                parts.push((6, tags.clone(), half.map(|k| row[5 + k]).to_vec()));
            }
        } else {
            parts.push((5, tags, row[5..].to_vec()));
        }
    }
    with_elements(head, &parts)
}

/// All before the elements of a mesh, and these: number, kind, three tags, nodes.
fn elements_of(mesh: &str) -> (&str, Vec<Vec<usize>>) {
    let (head, elements) = mesh.split_once("$Elements\n").unwrap();
    let read = |line: &str| line.split(' ').map(|word| word.parse().unwrap()).collect();
    (head, elements.lines().skip(1).take_while(|line| !line.starts_with('$')).map(read).collect())
}

/// A mesh of elements by kind, tags and nodes.
fn with_elements(head: &str, elements: &[(usize, Vec<usize>, Vec<usize>)]) -> String {
    let mut text = format!("{head}$Elements\n{}\n", elements.len());
    for (k, (kind, tags, nodes)) in elements.iter().enumerate() {
        let words: Vec<String> = [&[k + 1, *kind], &tags[..], nodes].concat().iter().map(usize::to_string).collect();
        let _ = writeln!(text, "{}", words.join(" "));
    }
    text + "$EndElements\n"
}

fn sorted(nodes: &[usize]) -> Vec<usize> {
    let mut nodes = nodes.to_vec();
    nodes.sort_unstable();
    nodes
}

/// What a hexahedron becomes in [`filled`].
#[derive(Clone, Copy, PartialEq)]
pub enum Cut {
    Whole,
    /// Six pyramids around a node in its middle.
    Pyramids,
    /// Around a node in its middle two tetrahedra on each side where such a one or nothing is, and a pyramid on others.
    Tetrahedra,
}

/// A mesh of hexahedra, the first of which is `cut(0)`.
pub fn filled(mesh: &str, cut: impl Fn(usize) -> Cut) -> String {
    use std::collections::HashMap;
    const FACES: [[usize; 4]; 6] = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
    let (head, rows) = elements_of(mesh);
    let (head, nodes) = head.split_once("$Nodes\n").unwrap();
    let mut nodes: Vec<String> =
        nodes.lines().skip(1).filter(|line| !line.starts_with('$')).map(String::from).collect();
    let place = |line: &String| -> Vec<f64> { line.split(' ').skip(1).map(|word| word.parse().unwrap()).collect() };
    let points: Vec<Vec<f64>> = nodes.iter().map(place).collect();
    let hexahedra = || rows.iter().filter(|row| row[1] == 5).enumerate();
    // Of each face whether it stays whole.
    let mut whole: HashMap<Vec<usize>, bool> = HashMap::new();
    for (e, row) in hexahedra() {
        for face in FACES {
            *whole.entry(sorted(&face.map(|k| row[5 + k]))).or_default() |= cut(e) != Cut::Tetrahedra;
        }
    }
    // From the lowest number, so that both sides have the same diagonal.
    let halves = |corners: &[usize]| {
        let first = (0..4).min_by_key(|k| corners[*k]).unwrap();
        let [a, b, c, d] = std::array::from_fn(|k| corners[(first + k) % 4]);
        [vec![a, b, c], vec![a, c, d]]
    };
    let mut parts: Vec<(usize, Vec<usize>, Vec<usize>)> = Vec::new();
    for row in rows.iter().filter(|row| row[1] != 5) {
        match whole[&sorted(&row[5..])] {
            true => parts.push((row[1], row[2..5].to_vec(), row[5..].to_vec())),
            false => parts.extend(halves(&row[5..]).map(|half| (2, row[2..5].to_vec(), half))),
        }
    }
    for (e, row) in hexahedra() {
        let (tags, corners) = (row[2..5].to_vec(), &row[5..]);
        if cut(e) == Cut::Whole {
            parts.push((5, tags, corners.to_vec()));
            continue;
        }
        let middle = |d: usize| corners.iter().map(|n| points[n - 1][d]).sum::<f64>() / 8.0;
        let apex = nodes.len() + 1;
        nodes.push(format!("{apex} {:?} {:?} {:?}", middle(0), middle(1), middle(2)));
        for face in FACES {
            let outward = face.map(|k| corners[k]);
            match whole[&sorted(&outward)] {
                true => parts.push((7, tags.clone(), vec![outward[0], outward[3], outward[2], outward[1], apex])),
                false => {
                    let tetrahedra =
                        halves(&outward).map(|half| (4, tags.clone(), vec![half[0], half[2], half[1], apex]));
                    parts.extend(tetrahedra);
                }
            }
        }
    }
    with_elements(&format!("{head}$Nodes\n{}\n{}\n$EndNodes\n", nodes.len(), nodes.join("\n")), &parts)
}

/// A surface of `n` by `n` quadrilaterals whose normals are the cross product of the two directions of the unit square
/// that `place` takes to space.
pub fn surface(n: usize, place: impl Fn(f64, f64) -> [f64; 3]) -> String {
    let at = |k: usize| k as f64 / n as f64;
    let points: Vec<_> = (0..=n).flat_map(|j| (0..=n).map(move |i| (i, j))).map(|(i, j)| place(at(i), at(j))).collect();
    let node = |i: usize, j: usize| 1 + i + (n + 1) * j;
    let facet = |(i, j)| (3, 1, vec![node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)]);
    let elements: Vec<_> = (0..n).flat_map(|j| (0..n).map(move |i| (i, j))).map(facet).collect();
    render(&[(2, "surface")], &points, &elements)
}

/// Meshes of [`block`] as one, with their sides as the groups `xmin0` ... `zmax0`, `xmin1` ..., and all of them as `all`.
pub fn together(blocks: &[&str]) -> String {
    let (mut names, mut points, mut elements) =
        (vec![(3, "solid".to_string()), (2, "all".to_string())], vec![], vec![]);
    for (b, mesh) in blocks.iter().enumerate() {
        let (first, groups) = (points.len(), names.len());
        names.extend(["xmin", "xmax", "ymin", "ymax", "zmin", "zmax"].map(|name| (2, format!("{name}{b}"))));
        let (nodes, rest) = mesh.split_once("$Nodes\n").unwrap().1.split_once("$EndNodes\n$Elements\n").unwrap();
        for line in nodes.lines().skip(1) {
            let place: Vec<f64> = line.split(' ').skip(1).map(|x| x.parse().unwrap()).collect();
            points.push([place[0], place[1], place[2]]);
        }
        for line in rest.lines().filter(|line| line.contains(' ')) {
            let words: Vec<usize> = line.split(' ').map(|word| word.parse().unwrap()).collect();
            let nodes: Vec<usize> = words[5..].iter().map(|n| n + first).collect();
            match words[3] {
                7 => elements.push((words[1], 1, nodes)),
                side => elements.extend([(words[1], 2, nodes.clone()), (words[1], groups + side, nodes)]),
            }
        }
    }
    let names: Vec<(usize, &str)> = names.iter().map(|(dimension, name)| (*dimension, &name[..])).collect();
    render(&names, &points, &elements)
}

/// The same mesh with its nodes numbered and listed otherwise.
pub fn renumbered(mesh: &str) -> String {
    let (head, rest) = mesh.split_once("$Nodes\n").unwrap();
    let (nodes, elements) = rest.split_once("$EndNodes\n$Elements\n").unwrap();
    let mut nodes: Vec<&str> = nodes.lines().skip(1).collect();
    nodes.reverse();
    // Numbers with gaps, far from the old order.
    let number = |old: &str| 3 + 7 * (old.parse::<usize>().unwrap() * 7919 % 10_007);
    let mut text = format!("{head}$Nodes\n{}\n", nodes.len());
    for (old, place) in nodes.iter().map(|line| line.split_once(' ').unwrap()) {
        let _ = writeln!(text, "{} {place}", number(old));
    }
    text += "$EndNodes\n$Elements\n";
    for line in elements.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        let new = words.iter().enumerate().map(|(k, w)| if k < 5 { w.to_string() } else { number(w).to_string() });
        let _ = writeln!(text, "{}", new.collect::<Vec<_>>().join(" "));
    }
    text
}

/// A [`block`] of tetrahedra that begins at z = 0, with its mirror image in that plane as one mesh, which begins with the block's nodes;
/// without `zmin`.
pub fn with_mirror_image(mesh: &str) -> String {
    let (head, rest) = mesh.split_once("$Nodes\n").unwrap();
    let (nodes, elements) = rest.split_once("$EndNodes\n$Elements\n").unwrap();
    let mut nodes: Vec<String> = nodes.lines().skip(1).map(String::from).collect();
    let mut image = vec![0];
    for k in 0..nodes.len() {
        let words: Vec<f64> = nodes[k].split(' ').map(|word| word.parse().unwrap()).collect();
        let [_, x, y, z] = words[..] else { panic!() };
        image.push(if z == 0.0 { k + 1 } else { nodes.len() + 1 });
        if z != 0.0 {
            nodes.push(format!("{} {x:?} {y:?} {:?}", nodes.len() + 1, -z));
        }
    }
    let all: Vec<Vec<usize>> = (elements.lines().filter(|line| line.contains(' ')))
        .map(|line| line.split(' ').map(|word| word.parse().unwrap()).collect())
        .filter(|words: &Vec<usize>| words[3] != 5)
        .collect();
    let mirrored = all.iter().map(|words| {
        let mut words: Vec<usize> = words[..5].iter().copied().chain(words[5..].iter().map(|n| image[*n])).collect();
        words.swap(5, 6);
        words
    });
    let mut text =
        format!("{head}$Nodes\n{}\n{}\n$EndNodes\n$Elements\n{}\n", nodes.len(), nodes.join("\n"), 2 * all.len());
    for (k, words) in all.iter().cloned().chain(mirrored).enumerate() {
        let words: Vec<String> = words[1..].iter().map(usize::to_string).collect();
        let _ = writeln!(text, "{} {}", k + 1, words.join(" "));
    }
    text + "$EndElements\n"
}

/// The same mesh of triangles and tetrahedra with a node in the middle of each edge.
pub fn second_order(mesh: &str) -> String {
    let (head, rest) = mesh.split_once("$Nodes\n").unwrap();
    let (nodes, elements) = rest.split_once("$EndNodes\n$Elements\n").unwrap();
    let place = |line: &str| -> Vec<f64> { line.split(' ').skip(1).map(|x| x.parse().unwrap()).collect() };
    let mut points: Vec<Vec<f64>> = nodes.lines().skip(1).map(place).collect();
    let mut middles = std::collections::HashMap::new();
    let mut text = String::new();
    for line in elements.lines() {
        let mut words: Vec<String> = line.split(' ').map(String::from).collect();
        if words.len() > 5 {
            let corners: Vec<usize> = words[5..].iter().map(|node| node.parse().unwrap()).collect();
            let edges: &[[usize; 2]] = match corners.len() {
                3 => &[[0, 1], [1, 2], [2, 0]],
                _ => &[[0, 1], [1, 2], [2, 0], [0, 3], [2, 3], [1, 3]],
            };
            words[1] = if corners.len() == 3 { "9" } else { "11" }.into();
            for ends in edges.iter().map(|ends| ends.map(|k| corners[k])) {
                let middle = middles.entry([ends[0].min(ends[1]), ends[0].max(ends[1])]).or_insert_with(|| {
                    let [a, b] = ends.map(|n| points[n - 1].clone());
                    points.push(a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect());
                    points.len()
                });
                words.push(middle.to_string());
            }
        }
        let _ = writeln!(text, "{}", words.join(" "));
    }
    let nodes = points.iter().enumerate().map(|(k, x)| format!("{} {:?} {:?} {:?}\n", k + 1, x[0], x[1], x[2]));
    format!("{head}$Nodes\n{}\n{}$EndNodes\n$Elements\n{text}", points.len(), nodes.collect::<String>())
}

/// The same mesh with its nodes elsewhere.
pub fn moved(mesh: &str, place: impl Fn([f64; 3]) -> [f64; 3]) -> String {
    let (head, rest) = mesh.split_once("$Nodes\n").unwrap();
    let (nodes, elements) = rest.split_once("$EndNodes\n").unwrap();
    let (count, nodes) = nodes.split_once('\n').unwrap();
    let mut text = format!("{head}$Nodes\n{count}\n");
    for line in nodes.lines() {
        let words: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
        let [x, y, z] = place([words[1], words[2], words[3]]);
        let _ = writeln!(text, "{} {x:?} {y:?} {z:?}", words[0]);
    }
    text + "$EndNodes\n" + elements
}

/// Elements are (Gmsh type, number of the group, nodes from 1).
fn render(names: &[(usize, &str)], points: &[[f64; 3]], elements: &[(usize, usize, Vec<usize>)]) -> String {
    let mut text = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{}\n", names.len());
    for (k, (dimension, name)) in names.iter().enumerate() {
        let _ = writeln!(text, "{dimension} {} \"{name}\"", k + 1);
    }
    let _ = writeln!(text, "$EndPhysicalNames\n$Nodes\n{}", points.len());
    for (k, [x, y, z]) in points.iter().enumerate() {
        let _ = writeln!(text, "{} {x:?} {y:?} {z:?}", k + 1);
    }
    let _ = writeln!(text, "$EndNodes\n$Elements\n{}", elements.len());
    for (k, (kind, group, nodes)) in elements.iter().enumerate() {
        let nodes: Vec<String> = nodes.iter().map(usize::to_string).collect();
        let _ = writeln!(text, "{} {kind} 2 {group} {group} {}", k + 1, nodes.join(" "));
    }
    text + "$EndElements\n"
}
