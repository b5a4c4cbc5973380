//! New nodes and elements.

use super::{Curves, groups};
use crate::Vec3;
use crate::error::{Error, Result};
use crate::mesh::faces::{HEX_EDGES, PYRAMID_EDGES, TET_EDGES, WEDGE_EDGES};
use crate::mesh::{Facet, MOST_NODES, Mesh, Middles, Solid, SolidShape, check};
use crate::scene::Located;
use std::collections::HashMap;

/// Elements and facets of a mesh, which one rank holds and checks, are no more than this.
const MOST: u64 = 1 << 27;
/// No node.
pub(super) const NONE: u32 = u32::MAX;

/// `mesh` with every edge split into 2^times parts, but those that are `whole`: hexahedra into as many layers along each
/// of their directions, wedges into layers over the parts of their triangles, pyramids into layers of pyramids, upright and upside
/// down, and of tetrahedra between them, tetrahedra each time into four at the corners and four around the shortest diagonal of the octahedron between them, quadrilaterals and triangles into four.
///
/// Nodes of the mesh keep their place and number; new ones follow, numbered on from the highest number, element by element.
/// Parts have the number of what they are parts of, and are in its groups; a group of nodes alone gets the new nodes of the
/// edges, faces and elements that have all of their nodes in it.
///
/// # Errors
/// More elements than can be held, and parts that the check of meshes refuses, at the place where splitting is asked for.
pub fn split(mesh: Mesh, times: &Located<u32>, curves: &Curves, whole: impl Fn(u32, u32) -> bool) -> Result<Mesh> {
    let cells = 1 << times.value;
    let parts = u64::from(cells).pow(if mesh.solids.is_empty() { 2 } else { 3 });
    let count = mesh.solids.len().max(mesh.facets.len()) as u64;
    if count.saturating_mul(parts) > MOST {
        let what = format!("{count} elements would become {} of {} parts each", count.saturating_mul(parts), parts);
        let help = format!("split them fewer times: one process reads the mesh, and holds {MOST} elements at most");
        return Err(Error::input(&times.at, what, help));
    }
    let Mesh { source, points, point_ids, solids, facets, groups, warnings, .. } = mesh;
    let last = point_ids.iter().copied().max().unwrap_or(0);
    let mut split = Split { cells, curves, whole, points, known: HashMap::new(), origins: Vec::new(), old: 0 };
    split.old = split.points.len();
    split.know_middles(&solids);
    let (solids, of_solid) = parts_of(&solids, |solid, parts| split.solid(solid, parts));
    let (facets, of_facet) = parts_of(&facets, |facet, parts| split.facet(facet, parts));
    let Split { points, known, origins, old, .. } = split;
    let mut mesh = Mesh { source, points, point_ids, solids, facets, warnings, ..Mesh::default() };
    let added = (mesh.points.len() - old) as u64;
    let numbers = last.checked_add(added).map(|end| last + 1..=end).ok_or_else(|| {
        let what = format!("there are no numbers for {added} new nodes after {last}");
        Error::input(&times.at, what, "number the nodes of the mesh from 1")
    })?;
    mesh.point_ids.extend(numbers);
    let middles = Middles::in_all(&mesh.solids);
    let inherit = groups::Heirs { middles: &middles, known: &known, origins: &origins, old, cells, of_solid, of_facet };
    mesh.groups = groups.into_iter().map(|(name, group)| (name, inherit.group(group, &mesh))).collect();
    let lines = mesh.groups.values().flat_map(|group| &group.lines).copied();
    mesh.middles = Middles::in_solids(mesh.solids.iter(), mesh.facets.iter().map(Facet::nodes), lines);
    check::check(&mesh).map_err(|error| match error {
        Error::Input { what, .. } => Error::input(
            &times.at,
            format!("'{}', split: {what}", mesh.source),
            "elements at a curved boundary must be thicker than the arc of their faces is high: mesh it finer there",
        ),
        other => other,
    })?;
    Ok(mesh)
}

/// All parts, and where those of each begin.
fn parts_of<T>(all: &[T], mut parts: impl FnMut(&T, &mut Vec<T>)) -> (Vec<T>, Vec<u32>) {
    let (mut made, mut starts) = (Vec::new(), Vec::with_capacity(all.len() + 1));
    for one in all {
        starts.push(made.len() as u32);
        parts(one, &mut made);
    }
    starts.push(made.len() as u32);
    (made, starts)
}

/// A point on an edge or face: its nodes in ascending order and their weights without a common divisor.
pub(super) type Key = [(u32, u32); 4];

struct Split<'a, W> {
    cells: u32,
    curves: &'a Curves,
    whole: W,
    points: Vec<[f64; 3]>,
    known: HashMap<Key, u32>,
    /// For each new node those of the edge, face or element that it lies in.
    origins: Vec<[u32; 8]>,
    old: usize,
}

/// What new nodes are made in.
struct Cell<'a> {
    nodes: &'a [u32],
    edges: &'a [[usize; 2]],
    kind: Kind,
    /// What is inside belongs to no other.
    solid: bool,
}

/// How the weights of a cell depend on its parameters.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// Linear along each.
    Product,
    /// Barycentric.
    Simplex,
    /// Barycentric in the triangle of the first three nodes and in that of the last, linear between them.
    Wedge,
    /// Those of [`crate::solid::element::pyramid5`].
    Pyramid,
}

impl<W: Fn(u32, u32) -> bool> Split<'_, W> {
    /// The node at these weights, whole numbers whose sum stands for 1.
    fn node(&mut self, cell: &Cell, weights: &[u32]) -> u32 {
        let mut held: Vec<(u32, u32)> =
            cell.nodes.iter().copied().zip(weights.iter().copied()).filter(|(_, w)| *w > 0).collect();
        held.sort_unstable();
        let shared = match held[..] {
            [(node, _)] => return node,
            _ => held.len() < cell.nodes.len() || !cell.solid,
        };
        let key = key(&held);
        if let Some(&node) = key.as_ref().filter(|_| shared).and_then(|key| self.known.get(key)) {
            return node;
        }
        let node = self.points.len() as u32;
        self.points.push(self.place(cell, weights, &held).into());
        self.origins.push(std::array::from_fn(|k| held.get(k).map_or(NONE, |(node, _)| *node)));
        if let Some(key) = key.filter(|_| shared) {
            self.known.insert(key, node);
        }
        node
    }

    /// Eq. (1) to (4).
    fn place(&self, cell: &Cell, weights: &[u32], held: &[(u32, u32)]) -> Vec3 {
        let total = f64::from(weights.iter().sum::<u32>());
        let at = |node: u32| Vec3::from(self.points[node as usize]);
        // Differences from one node keep what all have in common exactly.
        let first = at(held[0].0);
        let mut x = first;
        for (node, weight) in &held[1..] {
            x += (at(*node) - first) * (f64::from(*weight) / total);
        }
        for [a, b] in cell.edges {
            let [wa, wb] = [weights[*a], weights[*b]].map(|w| f64::from(w) / total);
            if let Some(c) = self.curves.at(cell.nodes[*a], cell.nodes[*b]).filter(|_| wa * wb > 0.0) {
                let triangle = |k: usize| f64::from(weights[k..k + 3].iter().sum::<u32>()) / total;
                let of = match cell.kind {
                    Kind::Simplex => 1.0,
                    Kind::Wedge if a / 3 == b / 3 => triangle(3 * (a / 3)),
                    Kind::Pyramid if *b == 4 => 1.0,
                    Kind::Pyramid => (wa + wb) / (1.0 - f64::from(weights[4]) / total),
                    Kind::Wedge | Kind::Product => wa + wb,
                };
                x -= c * (wa * wb / of);
            }
        }
        x
    }

    fn solid(&mut self, solid: &Solid, parts: &mut Vec<Solid>) {
        match solid.shape {
            SolidShape::Hex8 => self.hexahedron(solid, parts),
            SolidShape::Wedge6 => self.wedge(solid, parts),
            SolidShape::Pyramid5 => self.pyramid(solid, parts),
            SolidShape::Tet4 | SolidShape::Tet10 => self.tetrahedron(solid, parts),
            // They are made of linear ones after splitting.
            SolidShape::Wedge18 | SolidShape::Hex27 => parts.push(*solid),
        }
    }

    fn facet(&mut self, facet: &Facet, parts: &mut Vec<Facet>) {
        match facet.count {
            3 => self.triangle(facet, parts),
            _ => self.quadrilateral(facet, parts),
        }
    }

    /// The middles of edges that quadratic elements have already.
    fn know_middles(&mut self, solids: &[Solid]) {
        let middles = solids.iter().flat_map(Solid::middles);
        self.known.extend(middles.filter_map(|([a, b], middle)| Some((key(&[(a, 1), (b, 1)])?, middle))));
    }

    /// The places along an edge, from 0 to `cells`.
    fn places(&self, a: u32, b: u32) -> Vec<u32> {
        if (self.whole)(a, b) { vec![0, self.cells] } else { (0..=self.cells).collect() }
    }

    fn hexahedron(&mut self, solid: &Solid, parts: &mut Vec<Solid>) {
        let n = solid.nodes();
        let along = [self.places(n[0], n[1]), self.places(n[1], n[2]), self.places(n[0], n[4])];
        let cell = Cell { nodes: n, edges: &HEX_EDGES, kind: Kind::Product, solid: true };
        let mut nodes = Vec::with_capacity(along.iter().map(Vec::len).product());
        for &z in &along[2] {
            for &y in &along[1] {
                for &x in &along[0] {
                    let [u, v, w] = [x, y, z].map(|at| [self.cells - at, at]);
                    let corner = |i: usize, j: usize, k: usize| u[i] * v[j] * w[k];
                    let lower = [[0, 0], [1, 0], [1, 1], [0, 1]];
                    let weights: [u32; 8] = std::array::from_fn(|k| corner(lower[k % 4][0], lower[k % 4][1], k / 4));
                    nodes.push(self.node(&cell, &weights));
                }
            }
        }
        let [nx, ny, nz] = along.map(|along| along.len());
        let at = |i: usize, j: usize, k: usize| nodes[i + nx * (j + ny * k)];
        for k in 0..nz - 1 {
            for j in 0..ny - 1 {
                for i in 0..nx - 1 {
                    let layer = |k| [at(i, j, k), at(i + 1, j, k), at(i + 1, j + 1, k), at(i, j + 1, k)];
                    let ([a, b, c, d], [e, f, g, h]) = (layer(k), layer(k + 1));
                    parts.push(Solid::new(solid.shape, &[a, b, c, d, e, f, g, h], solid.id));
                }
            }
        }
    }

    fn quadrilateral(&mut self, facet: &Facet, parts: &mut Vec<Facet>) {
        let n = &facet.nodes;
        let along = [self.places(n[0], n[1]), self.places(n[1], n[2])];
        let cell = Cell { nodes: n, edges: &HEX_EDGES[..4], kind: Kind::Product, solid: false };
        let mut nodes = Vec::with_capacity(along.iter().map(Vec::len).product());
        for &y in &along[1] {
            for &x in &along[0] {
                let ([u0, u1], [v0, v1]) = ([self.cells - x, x], [self.cells - y, y]);
                nodes.push(self.node(&cell, &[u0 * v0, u1 * v0, u1 * v1, u0 * v1]));
            }
        }
        let [nx, ny] = along.map(|along| along.len());
        let at = |i: usize, j: usize| nodes[i + nx * j];
        for j in 0..ny - 1 {
            for i in 0..nx - 1 {
                parts.push(Facet { nodes: [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)], ..*facet });
            }
        }
    }

    fn triangle(&mut self, facet: &Facet, parts: &mut Vec<Facet>) {
        let cell = Cell { nodes: &facet.nodes[..3], edges: &TET_EDGES[..3], kind: Kind::Simplex, solid: false };
        for corners in triangles(self.cells) {
            let [a, b, c] = corners.map(|b| self.node(&cell, &b));
            parts.push(Facet { nodes: [a, b, c, 0], ..*facet });
        }
    }

    fn wedge(&mut self, solid: &Solid, parts: &mut Vec<Solid>) {
        let cells = self.cells;
        let cell = Cell { nodes: solid.nodes(), edges: &WEDGE_EDGES, kind: Kind::Wedge, solid: true };
        let mut inside: HashMap<[u32; 6], u32> = HashMap::new();
        for z in 0..cells {
            for corners in triangles(cells) {
                let nodes: [u32; 6] = std::array::from_fn(|k| {
                    let up = z + k as u32 / 3;
                    let weights = std::array::from_fn(|j| corners[k % 3][j % 3] * if j < 3 { cells - up } else { up });
                    *inside.entry(weights).or_insert_with(|| self.node(&cell, &weights))
                });
                parts.push(Solid::new(solid.shape, &nodes, solid.id));
            }
        }
    }

    /// Layer m below the apex has (m + 1)^2 nodes. Each of its quadrilaterals is the base of a pyramid to one of the layer above and,
    /// upside down, to one of the layer below; between these, over each edge, is a tetrahedron.
    fn pyramid(&mut self, solid: &Solid, parts: &mut Vec<Solid>) {
        let cells = self.cells;
        let cell = Cell { nodes: solid.nodes(), edges: &PYRAMID_EDGES, kind: Kind::Pyramid, solid: true };
        let mut layers: Vec<Vec<u32>> = Vec::with_capacity(cells as usize + 1);
        for m in 0..=cells {
            let mut layer = Vec::with_capacity(((m + 1) * (m + 1)) as usize);
            for b in 0..=m {
                for a in 0..=m {
                    let ([p0, p1], [r0, r1]) = ([m - a, a], [m - b, b]);
                    let weights = match m {
                        0 => [0, 0, 0, 0, 1],
                        _ => [p0 * r0, p1 * r0, p1 * r1, p0 * r1, (cells - m) * m],
                    };
                    layer.push(self.node(&cell, &weights));
                }
            }
            layers.push(layer);
        }
        let at = |m: u32, a: u32, b: u32| layers[m as usize][(a + (m + 1) * b) as usize];
        let pyramid = |nodes: &[u32; 5]| Solid::new(SolidShape::Pyramid5, nodes, solid.id);
        let tetrahedron = |nodes: &[u32; 4]| Solid::new(SolidShape::Tet4, nodes, solid.id);
        for m in 0..cells {
            for b in 0..=m {
                for a in 0..=m {
                    let base = |m| [at(m, a, b), at(m, a + 1, b), at(m, a + 1, b + 1), at(m, a, b + 1)];
                    let [i, j, k, l] = base(m + 1);
                    parts.push(pyramid(&[i, j, k, l, at(m, a, b)]));
                    if a < m && b < m {
                        let [i, j, k, l] = base(m);
                        parts.push(pyramid(&[i, l, k, j, at(m + 1, a + 1, b + 1)]));
                    }
                    if a < m {
                        let across = [at(m + 1, a + 1, b), at(m + 1, a + 1, b + 1)];
                        parts.push(tetrahedron(&[at(m, a, b), at(m, a + 1, b), across[0], across[1]]));
                    }
                    if b < m {
                        let across = [at(m + 1, a, b + 1), at(m + 1, a + 1, b + 1)];
                        parts.push(tetrahedron(&[at(m, a, b), at(m, a, b + 1), across[1], across[0]]));
                    }
                }
            }
        }
    }

    fn tetrahedron(&mut self, solid: &Solid, parts: &mut Vec<Solid>) {
        let cell = Cell { nodes: &solid.nodes[..4], edges: &TET_EDGES, kind: Kind::Simplex, solid: true };
        let mut inside: HashMap<[u32; 4], u32> = HashMap::new();
        // Of a quadratic element the weights are even at corners of parts, odd at some in the middles of their edges.
        let unit = if solid.shape == SolidShape::Tet10 { 2 } else { 1 };
        let corner = |k: usize| std::array::from_fn(|j| if j == k { unit * self.cells } else { 0 });
        let mut tets: Vec<[[u32; 4]; 4]> = vec![std::array::from_fn(corner)];
        let mut cells = self.cells;
        while cells > 1 {
            let mut place = |at: [u32; 4]| {
                let node = *inside.entry(at).or_insert_with(|| self.node(&cell, &at));
                Vec3::from(self.points[node as usize])
            };
            tets = tets.into_iter().flat_map(|tet| eight(tet, &mut place)).collect();
            cells /= 2;
        }
        for tet in tets {
            let mut nodes = [0; MOST_NODES];
            let middles = TET_EDGES.map(|[a, b]| middle(tet[a], tet[b]));
            for (node, at) in nodes.iter_mut().zip(tet.into_iter().chain(middles)).take(solid.nodes().len()) {
                *node = *inside.entry(at).or_insert_with(|| self.node(&cell, &at));
            }
            parts.push(Solid { nodes, ..*solid });
        }
    }
}

/// The parts of a triangle split into so many along each edge: the weights of their corners.
fn triangles(cells: u32) -> Vec<[[u32; 3]; 3]> {
    let at = |i: u32, j: u32| [cells - i - j, i, j];
    let mut all = Vec::with_capacity((cells * cells) as usize);
    for j in 0..cells {
        for i in 0..cells - j {
            all.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
            if i + j + 1 < cells {
                all.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    all
}

/// The eight parts of a tetrahedron by its corners' weights: four at the corners, and four around the shortest of the three
/// diagonals of the octahedron between them, which makes the best shapes.
fn eight([a, b, c, d]: [[u32; 4]; 4], place: &mut impl FnMut([u32; 4]) -> Vec3) -> [[[u32; 4]; 4]; 8] {
    let mid = middle;
    // Turns of b, c and d keep the orientation and take one diagonal, from ab to cd, to the next.
    let turns = [[b, c, d], [c, d, b], [d, b, c]];
    let length = |[b, c, d]: &[[u32; 4]; 3], place: &mut dyn FnMut([u32; 4]) -> Vec3| {
        (place(mid(a, *b)) - place(mid(*c, *d))).norm()
    };
    let lengths: Vec<f64> = turns.iter().map(|turn| length(turn, place)).collect();
    // Among equal ones the first, whatever rounding says.
    let least = lengths.iter().copied().fold(f64::INFINITY, f64::min) * (1.0 + 1e-9);
    let [b, c, d] = turns[lengths.iter().position(|length| *length <= least).unwrap_or(0)];
    let [ab, ac, ad, bc, bd, cd] = [mid(a, b), mid(a, c), mid(a, d), mid(b, c), mid(b, d), mid(c, d)];
    [
        [a, ab, ac, ad],
        [ab, b, bc, bd],
        [ac, bc, c, cd],
        [ad, bd, cd, d],
        [ab, cd, bc, ac],
        [ab, cd, bd, bc],
        [ab, cd, ad, bd],
        [ab, cd, ac, ad],
    ]
}

fn middle(p: [u32; 4], q: [u32; 4]) -> [u32; 4] {
    std::array::from_fn(|k| (p[k] + q[k]) / 2)
}

/// The key of a point by the nodes that hold it; none inside a hexahedron, a wedge or a pyramid.
pub(super) fn key(held: &[(u32, u32)]) -> Option<Key> {
    let divisor = held.iter().fold(0, |d, (_, w)| common_divisor(d, *w)).max(1);
    let entry = |k: usize| held.get(k).map_or((NONE, 0), |(node, w)| (*node, w / divisor));
    (held.len() <= 4).then(|| std::array::from_fn(entry))
}

fn common_divisor(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { common_divisor(b, a % b) }
}
