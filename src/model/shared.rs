//! Places that several bodies have in common, on the rank that reads the meshes.
//!
//! Every body has nodes of its own. Two that stand on the same place part there without a force, unless a contact or a tie
//! is between them, or they are the same node of a mesh file: then the bodies are one solid there, and the second has the
//! displacements of the first. Elements at one place in two bodies may be specimens to be compared; of a mesh file with several
//! groups of elements they are a `group` that was forgotten.

use crate::Vec3;
use crate::error::{Error, Result};
use crate::mesh::{Solid, SolidShape, message};
use crate::partition::GlobalMesh;
use crate::scene::{Located, MeshSource, Scene, body_of};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Nodes are at one place when they are closer than this times the size of both bodies.
const COINCIDENT: f64 = 1e-7;

/// What is left to be known when nodes of several bodies have been made one.
#[derive(Default)]
pub struct United {
    /// A line about each two bodies that are one solid.
    pub lines: Vec<String>,
    /// Two bodies each of which a warning tells that they lie on each other.
    pub told: Vec<[usize; 2]>,
}

/// What bodies have in common.
#[derive(Default)]
pub struct Common {
    warnings: Vec<String>,
    united: United,
    /// Nodes of two bodies that are one solid, of the first and of the second.
    one: Vec<[u32; 2]>,
}

/// Finds faces of two bodies at one place that neither contact nor tie is between: where they share the nodes of their mesh file,
/// the bodies are one solid.
///
/// # Errors
/// Elements that two bodies take of one mesh file with several groups; nodes of one mesh file that two bodies take, at faces that
/// neither contact nor tie is between, where these are between other faces of both.
pub fn find(scene: &Scene, names: &[Located<String>], global: &GlobalMesh) -> Result<Common> {
    let mut common = Common::default();
    for ((a, b), pairs) in partners(global) {
        let (one, other) = (&scene.bodies[a as usize], &scene.bodies[b as usize]);
        let [own, theirs] = [a, b].map(|k| solids_of(global, k));
        let twin = |solid: &&Solid| twins(solid, &pairs);
        let known: BTreeSet<Vec<u32>> = theirs.iter().map(|s| sorted(s.nodes())).collect();
        let mut doubled: Vec<u64> =
            own.iter().filter(|s| twin(s).is_some_and(|twin| known.contains(&twin))).map(|s| s.id).collect();
        doubled.dedup();
        if !doubled.is_empty() {
            let what = format!(
                "{} in body `{}` and in body `{}`, at one place",
                message::several("element", &doubled),
                one.name.value,
                other.name.value
            );
            let undivided = [a, b].iter().any(|k| global.files[*k as usize].parts > 1);
            if is_one_file(&one.mesh, &other.mesh) && undivided {
                let help = "the mesh file has several groups of elements: give each body its own `group`";
                return Err(Error::input(&other.name.at, what, help));
            }
            common.united.told.push([a as usize, b as usize]);
            common.warnings.push(what + ": they do not know of each other");
            continue;
        }
        let covered = covered(scene, names, global, (a, b));
        let (ours, others) = (faces(&own), faces(&theirs));
        let meets = |face: &&Vec<u32>| {
            let twin: Option<Vec<u32>> = face.iter().map(|n| pairs.get(n).copied()).collect();
            twin.is_some_and(|twin| others.contains_key(&sorted(&twin)))
        };
        let is_bare = |face: &&Vec<u32>| !face.iter().all(|n| covered.contains(n));
        // Nodes of refined meshes that are new have the numbers of their own body.
        let of_file = |n: u32| global.id[n as usize] <= global.files[global.body[n as usize] as usize].last_id;
        let is_shared = |n: u32| match [n, pairs[&n]] {
            both if both.map(of_file) == [true; 2] => global.id[both[0] as usize] == global.id[both[1] as usize],
            both => both.map(of_file) == [false; 2],
        };
        if is_one_file(&one.mesh, &other.mesh) {
            let is_whole = |face: &&Vec<u32>| face.iter().all(|n| pairs.contains_key(n) && is_shared(*n));
            let outer = ours.iter().filter(|(_, count)| **count == 1).map(|(face, _)| face);
            let unlike = outer.filter(is_whole).filter(is_bare).filter(|face| !meets(face)).count();
            if unlike > 0 {
                common.united.told.push([a as usize, b as usize]);
                common.warnings.push(format!(
                    "bodies `{}` and `{}` share the nodes of {unlike} faces of `{}` that are no faces of `{}`: they come apart there; \
                     mesh both with elements whose faces match, or `tie` them",
                    one.name.value, other.name.value, one.name.value, other.name.value
                ));
            }
        }
        let bare: Vec<&Vec<u32>> = ours.keys().filter(meets).filter(is_bare).collect();
        if bare.is_empty() {
            continue;
        }
        let shared = is_one_file(&one.mesh, &other.mesh)
            && bare.iter().all(|face| face.iter().all(|&n| is_shared(n)))
            && bare.iter().any(|face| face.iter().any(|&n| of_file(n)));
        let quadratic = |solids: &[Solid]| {
            let any = |shapes: &[SolidShape]| solids.iter().any(|solid| shapes.contains(&solid.shape));
            [any(&[SolidShape::Tet10]), any(&[SolidShape::Hex27, SolidShape::Wedge18])]
        };
        let alike = one.is_layer() == other.is_layer() && quadratic(&own) == quadratic(&theirs);
        if shared && covered.is_empty() && alike {
            let both = pairs.iter().filter(|(n, _)| is_shared(**n)).map(|(n, m)| [*n, *m]);
            common.one.extend(both);
            common.united.lines.push(format!(
                "bodies `{}` and `{}` are one solid at {} faces, whose nodes they share",
                one.name.value,
                other.name.value,
                bare.len()
            ));
            continue;
        }
        let x = global.points[bare[0][0] as usize];
        let what = format!(
            "bodies `{}` and `{}` lie on each other with {} faces, such as near ({:.6}, {:.6}, {:.6}), where neither contact \
             nor tie is between them: they {} there",
            one.name.value,
            other.name.value,
            bare.len(),
            x.x,
            x.y,
            x.z,
            if shared { "share nodes of their mesh, and come apart" } else { "part, or pass through each other," }
        );
        if shared {
            let help = match alike {
                true => {
                    "name these faces in the contact or tie, too, or take what belongs together as one body, with `materials` for \
                     its parts"
                }
                false => "mesh both with elements of one order, in space or both as layers, or add a `tie`",
            };
            return Err(Error::input(&other.name.at, what, help));
        }
        common.united.told.push([a as usize, b as usize]);
        common.warnings.push(what + "; add a contact or a `tie`, or mesh them as one body");
    }
    Ok(common)
}

impl Common {
    /// Gives nodes that are one the equations of the first of them, with those that had the equations of the others. Warnings go to
    /// the mesh.
    pub fn unite(self, global: &mut GlobalMesh) -> United {
        let first = |ties: &[u32], n: u32| {
            let mut n = ties[n as usize];
            while ties[n as usize] != n {
                n = ties[n as usize];
            }
            n
        };
        for [a, b] in &self.one {
            let [a, b] = [*a, *b].map(|n| first(&global.tie, n));
            global.tie[a.max(b) as usize] = a.min(b);
        }
        if !self.one.is_empty() {
            global.tie = (0..global.tie.len() as u32).map(|n| first(&global.tie, n)).collect();
        }
        global.warnings.extend(self.warnings);
        self.united
    }
}

/// For two bodies the nodes of the first that stand on nodes of the second, with these.
type Partners = BTreeMap<(u32, u32), BTreeMap<u32, u32>>;

fn partners(global: &GlobalMesh) -> Partners {
    let mut partners = Partners::new();
    if global.body.last().is_none_or(|last| *last == 0) {
        return partners;
    }
    let count = global.body.iter().max().map_or(0, |b| *b as usize + 1);
    let mut boxes = vec![(Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)); count];
    for (x, &b) in global.points.iter().zip(&global.body) {
        let (low, high) = &mut boxes[b as usize];
        (*low, *high) = (low.inf(x), high.sup(x));
    }
    let smallest = boxes.iter().map(|(low, high)| (high - low).norm()).fold(f64::INFINITY, f64::min);
    let rounding = global.points.iter().map(|x| x.amax()).fold(0.0, f64::max) * 8.0 * f64::EPSILON;
    let near = COINCIDENT * smallest + rounding;
    // Cells a thousand times as large: most points meet one, and none more than eight.
    let cell = 1e3 * near;
    let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    for (n, x) in (0u32..).zip(&global.points) {
        let mut keys: Vec<[i64; 3]> = (0..8u32)
            .map(|corner| {
                std::array::from_fn(|d| {
                    let side = if corner >> d & 1 == 1 { near } else { -near };
                    ((x[d] + side) / cell).floor() as i64
                })
            })
            .collect();
        keys.sort_unstable();
        keys.dedup();
        for key in keys {
            let beside = cells.entry(key).or_default();
            for &m in beside.iter() {
                let (a, b) = (global.body[m as usize], global.body[n as usize]);
                if a != b && (global.points[m as usize] - x).norm() <= near {
                    partners.entry((a, b)).or_default().insert(m, n);
                }
            }
            beside.push(n);
        }
    }
    partners
}

fn solids_of(global: &GlobalMesh, body: u32) -> Vec<Solid> {
    global.solids.iter().zip(&global.solid_body).filter(|(_, b)| **b == body).map(|(s, _)| *s).collect()
}

fn sorted(nodes: &[u32]) -> Vec<u32> {
    let mut nodes = nodes.to_vec();
    nodes.sort_unstable();
    nodes
}

/// The nodes of another body that a solid stands on with all of its own.
fn twins(solid: &Solid, pairs: &BTreeMap<u32, u32>) -> Option<Vec<u32>> {
    let twin: Option<Vec<u32>> = solid.nodes().iter().map(|n| pairs.get(n).copied()).collect();
    twin.map(|twin| sorted(&twin))
}

/// The faces of solids, with how many have each.
fn faces(solids: &[Solid]) -> BTreeMap<Vec<u32>, usize> {
    let mut count = BTreeMap::new();
    solids.iter().flat_map(faces_of).for_each(|face| *count.entry(face).or_default() += 1);
    count
}

fn faces_of(solid: &Solid) -> Vec<Vec<u32>> {
    (0..solid.shape.face_count()).map(|k| sorted(solid.face(k).nodes())).collect()
}

/// Nodes of the first body in contacts and ties with the second, on either side.
fn covered(scene: &Scene, names: &[Located<String>], global: &GlobalMesh, (a, b): (u32, u32)) -> BTreeSet<u32> {
    let [a, b] = [a, b].map(|k| scene.bodies[k as usize].name.value.as_str());
    let mut covered = BTreeSet::new();
    let of_contacts = scene.contacts.iter().filter(|c| c.surface.is_some()).map(|c| (&c.slave, &c.master));
    for (slave, master) in of_contacts.chain(scene.ties.iter().map(|tie| (&tie.slave, &tie.master))) {
        let (slave, master) = (&slave.value, &master.value);
        let own = match (body_of(slave), body_of(master)) {
            (s, m) if s == a && m == b => slave,
            (s, m) if s == b && m == a => master,
            _ => continue,
        };
        let set = names.iter().position(|n| n.value == *own).map(|k| &global.sets[k]);
        covered.extend(set.into_iter().flat_map(|set| &set.nodes).copied());
    }
    covered
}

fn is_one_file(one: &MeshSource, other: &MeshSource) -> bool {
    let path = |source: &MeshSource| match source {
        MeshSource::File { path, .. } => path.value.canonicalize().ok(),
        MeshSource::Block(_) => None,
    };
    path(one).is_some() && path(one) == path(other)
}
