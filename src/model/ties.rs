//! Faces that are tied: their interpolation, on the rank that has the mesh; then the equations of each rank's slave nodes.
//!
//! Slave nodes are the mean of master nodes by [`mortar`](crate::mortar): x_i = Σ_k P_ik x_k. Where the surfaces are apart, the
//! slave's nodes are moved to where that holds in the initial mesh (Puso, A 3D mortar method for solid mechanics, Int. J. Numer.
//! Meth. Engng 59, 2004), again and again while this changes P. From then on P stands still, and as the equation holds of
//! positions, it holds of any that are rotated and displaced: rigid motions, finite ones too, strain nothing.
//!
//! Where nodes lie in a plane of symmetry along an axis, or some step prescribes them along one, they are not moved along it: the
//! mean of a coarse slave's nodes would draw them out of the plane, and no step ties them along it.
//!
//! In a layer both nodes of an upright edge are one, with the sum of what the interpolation has for both; so are those that bodies
//! share.

use super::assemble::set_of;
use super::layers::alike;
use crate::Vec3;
use crate::error::{Error, Result};
use crate::mesh::Quarters;
use crate::mesh::check::spoiled;
use crate::mesh::message;
use crate::mesh::middles::four;
use crate::mortar::{Face, Interpolation, Row, interpolate};
use crate::parallel::serve;
use crate::partition::{FaceNodes, Gather, GlobalFacet, GlobalMesh, Part, owner};
use crate::scene::{Located, Reduction, Scene, Tie, body_of};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use std::collections::{BTreeMap, BTreeSet};

/// Share of the edges that gaps may have where the scene does not say.
const GAP: f64 = 0.1;
/// How far the other side is looked for, over the longest edge.
const SIGHT: f64 = 1.0;
/// Share of the slave that may lie beyond the master, of all and of what is around a node: as round edges of unlike meshes
/// have it.
const BEYOND: [f64; 2] = [0.05, 0.5];
/// Share beyond the master that is told.
const TOLD: f64 = 1e-6;
/// Weights below this are rounding.
const NO_WEIGHT: f64 = 1e-13;
/// How often nodes are moved at most, and the way over the size of the faces that ends it.
const MOVES: usize = 20;
const STILL: f64 = 1e-13;
/// What rounding leaves of a mean, over the coordinates.
const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// A slave node and its means, by their numbers in the whole mesh.
type Mean = (u32, Vec<(u32, f64)>);

/// The ties of a scene in the global numbering, on rank 0.
#[derive(Default)]
pub struct Tied {
    of: Vec<Vec<Mean>>,
    /// A line about each.
    pub lines: Vec<String>,
    pub warnings: Vec<String>,
}

/// Finds the equations of all ties, and moves the nodes of their slaves onto their masters.
///
/// # Errors
/// Faces that do not lie on each other, and nodes that two ties would hold.
pub fn tie(scene: &Scene, names: &[Located<String>], global: &mut GlobalMesh) -> Result<Tied> {
    let mut tied = Tied { of: vec![Vec::new(); scene.ties.len()], ..Tied::default() };
    for k in order(scene, names, global)? {
        one_layer(&scene.ties[k], scene, names, global)?;
        tied.of[k] = one((&scene.ties[k], scene), names, global, &mut tied)?;
    }
    Ok(tied)
}

/// The faces of a set, quadratic ones whole.
fn faces(names: &[Located<String>], global: &GlobalMesh, set: &str) -> Vec<Face> {
    let Some(set) = set_of(names, global, set) else { return Vec::new() };
    let quarters = Quarters::in_solids(global.solids.iter(), set.facets.iter().map(GlobalFacet::nodes));
    let (mut faces, mut wholes): (Vec<Face>, BTreeMap<Vec<u32>, usize>) = Default::default();
    for corners in set.facets.iter().map(GlobalFacet::nodes) {
        let whole = FaceNodes::of(corners, &global.middles, &quarters);
        let mut key = whole.to_vec();
        key.sort_unstable();
        let index = *wholes.entry(key).or_insert_with(|| {
            faces.push(Face { nodes: whole.to_vec(), pieces: Vec::new() });
            faces.len() - 1
        });
        let face = &mut faces[index];
        let mut add = |corners: &[u32]| face.pieces.push(face.piece(corners));
        match (global.middles.of(corners), corners) {
            (Some(middles), &[a, b, c]) => four([a, b, c], middles).iter().for_each(|piece| add(piece)),
            _ => add(corners),
        }
    }
    faces
}

fn nodes(faces: &[Face]) -> BTreeSet<u32> {
    faces.iter().flat_map(|face| &face.nodes).copied().collect()
}

/// "7 of body `a` at (x, y, z)".
fn name_of(scene: &Scene, global: &GlobalMesh, node: u32) -> String {
    let (n, x) = (node as usize, global.points[node as usize]);
    let body = &scene.bodies[global.body[n] as usize].name.value;
    format!("{} of body `{body}` at ({:.6}, {:.6}, {:.6})", global.id[n], x.x, x.y, x.z)
}

/// The ties, each after those whose slaves are in its master.
fn order(scene: &Scene, names: &[Located<String>], global: &GlobalMesh) -> Result<Vec<usize>> {
    let of_side = |set: &Located<String>| -> BTreeSet<u32> {
        nodes(&faces(names, global, &set.value)).into_iter().map(|n| global.tie[n as usize]).collect()
    };
    let sides: Vec<_> = scene.ties.iter().map(|tie| (of_side(&tie.slave), of_side(&tie.master))).collect();
    for (k, (tie, (slave, master))) in scene.ties.iter().zip(&sides).enumerate() {
        let twice = |what: String, help: &str| Err(Error::input(&tie.slave.at, what, help));
        if let Some(&node) = slave.intersection(master).next() {
            let what = format!("tie `{}`: node {} is on both sides", tie.name.value, name_of(scene, global, node));
            return twice(what, "name faces that have no nodes in common");
        }
        for (other, (others, _)) in scene.ties.iter().zip(&sides).take(k) {
            if let Some(&node) = slave.intersection(others).next() {
                let [own, first] = [tie, other].map(|tie| &tie.name.value);
                let what = format!(
                    "tie `{own}`: node {} is a slave of tie `{first}`, too, which holds it already",
                    name_of(scene, global, node)
                );
                return twice(what, "exchange `slave` and `master` of one of them");
            }
        }
    }
    let mut done: Vec<usize> = Vec::new();
    while done.len() < sides.len() {
        let left: Vec<usize> = (0..sides.len()).filter(|k| !done.contains(k)).collect();
        let waits = |k: usize| left.iter().any(|&other| other != k && !sides[other].0.is_disjoint(&sides[k].1));
        let Some(&next) = left.iter().find(|k| !waits(**k)) else {
            let tie = &scene.ties[left[0]];
            let what =
                format!("tie `{}` holds nodes that hold it by other ties: they go round in a circle", tie.name.value);
            return Err(Error::input(&tie.name.at, what, "exchange `slave` and `master` of one of them"));
        };
        done.push(next);
    }
    Ok(done)
}

/// Refuses ties of a layer to anything but another layer of the same thickness.
fn one_layer(tie: &Tie, scene: &Scene, names: &[Located<String>], global: &GlobalMesh) -> Result<()> {
    let ends = [&tie.slave, &tie.master].map(|set| {
        let own = nodes(&faces(names, global, &set.value));
        let heights = || own.iter().map(|n| global.points[*n as usize].z);
        let body = own.first().map(|n| &scene.bodies[global.body[*n as usize] as usize]);
        (
            body.and_then(|body| body.reduction.as_ref()).map(|asked| asked.value),
            [heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max)],
        )
    });
    let [(reduction, slave), (other, master)] = ends;
    if reduction == other && (reduction.is_none() || alike(slave, master)) {
        return Ok(());
    }
    let layer = reduction.or(other).unwrap_or(Reduction::PlaneStrain);
    let what = format!(
        "tie `{}`: a layer {} is tied to what is no layer with the same planes",
        tie.name.value,
        match layer {
            Reduction::PlaneStrain => "in plane strain",
            Reduction::Axisymmetric => "that is axisymmetric",
        }
    );
    let help = format!("mesh both sides between the same two z-planes, with `{} = true`", layer.key());
    Err(Error::input(&tie.name.at, what, help))
}

fn one(
    (tie, scene): (&Tie, &Scene),
    names: &[Located<String>],
    global: &mut GlobalMesh,
    tied: &mut Tied,
) -> Result<Vec<Mean>> {
    let [slaves, masters] = [&tie.slave, &tie.master].map(|set| faces(names, global, &set.value));
    let longest = |faces: &[Face]| {
        faces.iter().map(|face| face.corners().map(|n| global.points[n as usize]).longest()).fold(0.0, f64::max)
    };
    let size = longest(&slaves).max(longest(&masters));
    let tolerance = tie.tolerance.unwrap_or(GAP * size);
    let reach = (SIGHT * size).max(tolerance);
    // All bodies are axisymmetric, or none.
    let is_ring = scene.is_axisymmetric();
    let measure = |x: &Vec3| if is_ring { x.x } else { 1.0 };
    let look = |global: &GlobalMesh| {
        let (place, one) = (|n: u32| global.points[n as usize], |n: u32| global.tie[n as usize]);
        interpolate(&slaves, &masters, place, one, reach, measure)
    };
    let mut found = look(global);
    check(tie, &found, tolerance)?;
    let apart = found.apart.0;
    if found.covered < (1.0 - TOLD) * found.area {
        let share = 100.0 * (1.0 - found.covered / found.area);
        let [name, slave, master] = [&tie.name.value, &tie.slave.value, &tie.master.value];
        tied.warnings
            .push(format!("tie `{name}`: {share:.2} % of the area of `{slave}` lies beyond `{master}`, and is free"));
    }
    let kept = kept(scene, names, global);
    // With what is one with them.
    let own: BTreeSet<u32> = nodes(&slaves).into_iter().map(|n| global.tie[n as usize]).collect();
    let all = (0..).zip(&global.points).filter(|(n, _)| own.contains(&global.tie[*n as usize]));
    let before: BTreeMap<u32, Vec3> = all.map(|(n, x)| (n, *x)).collect();
    let mut means = means_of(&found);
    let far = before.values().map(|x| x.amax()).fold(0.0, f64::max);
    for _ in 0..MOVES {
        if go(&means, (&before, &kept), scene, global) <= STILL * size + ROUNDING * far {
            break;
        }
        found = look(global);
        means = means_of(&found);
    }
    go(&means, (&before, &kept), scene, global);
    let touched = global.solids.iter().filter(|solid| solid.nodes().iter().any(|n| before.contains_key(n)));
    let spoiled = spoiled(touched, |n| global.points[n as usize]);
    if !spoiled.is_empty() {
        let [name, slave] = [&tie.name.value, &tie.slave.value];
        let elements = message::several("element", &spoiled);
        let what = format!("tie `{name}`: with the gap of {apart:.3e} under `{slave}` closed, {elements} inside out");
        return Err(Error::input(&tie.slave.at, what, "mesh both sides nearer to each other"));
    }
    let moved = before.iter().map(|(n, x)| (global.points[*n as usize] - x).norm()).fold(0.0, f64::max);
    tied.lines.push(format!(
        "tie `{}`: {} nodes, apart by up to {apart:.3e}, moved by up to {moved:.3e}",
        tie.name.value,
        means.len()
    ));
    Ok(means)
}

/// Refuses surfaces that do not lie on each other.
fn check(tie: &Tie, found: &Interpolation, tolerance: f64) -> Result<()> {
    let [name, slave, master] = [&tie.name.value, &tie.slave.value, &tie.master.value];
    let refused = |what: String, help: &str| Err(Error::input(&tie.slave.at, format!("tie `{name}`: {what}"), help));
    let beyond = 1.0 - found.covered / found.area;
    if found.same_way > found.covered {
        let what = format!("`{slave}` and `{master}` look the same way where they are near");
        return refused(what, "name faces that look at each other");
    }
    if found.rows.is_empty() {
        return refused(format!("nothing of `{slave}` lies on `{master}`"), "move the bodies together");
    }
    let (apart, x) = found.apart;
    if apart > tolerance {
        let what = format!(
            "`{slave}` and `{master}` are up to {apart:.3e} apart, near ({:.6}, {:.6}, {:.6}), and {tolerance:.3e} is closed",
            x.x, x.y, x.z
        );
        return refused(what, "move the bodies together, or give a larger `tolerance`");
    }
    if let Some(x) = found.twice {
        let what = format!("several faces of `{master}` lie on `{slave}` near ({:.6}, {:.6}, {:.6})", x.x, x.y, x.z);
        return refused(what, "name those that it is to be tied to");
    }
    if beyond > BEYOND[0] || found.bare > BEYOND[1] {
        let what = format!("{:.2} % of the area of `{slave}` lies beyond `{master}`", 100.0 * beyond);
        return refused(what, "name only faces that lie on the master, or exchange `slave` and `master`");
    }
    Ok(())
}

/// The means of all slave nodes.
fn means_of(found: &Interpolation) -> Vec<Mean> {
    let mean = |(node, row): (&u32, &Row)| {
        let weights = row.weights.iter().filter(|(_, weight)| weight.abs() > NO_WEIGHT);
        (*node, weights.map(|(n, weight)| (*n, *weight)).collect())
    };
    found.rows.iter().map(mean).collect()
}

/// The axes along which nodes must stay: those of planes of symmetry that they lie in, x on the axis of revolution, and those
/// along which some step prescribes them; by the first of nodes that are one.
fn kept(scene: &Scene, names: &[Located<String>], global: &GlobalMesh) -> BTreeMap<u32, [bool; 3]> {
    /// Over the extent of a group, what is flat.
    const FLAT: f64 = 1e-6;
    let nodes = |set: &str| names.iter().position(|name| name.value == set).map_or(&[][..], |k| &global.sets[k].nodes);
    let mut kept: BTreeMap<u32, [bool; 3]> = BTreeMap::new();
    let mut keep = |set: &str, axes: [bool; 3]| {
        for &n in nodes(set) {
            let of_node = kept.entry(global.tie[n as usize]).or_default();
            (0..3).for_each(|d| of_node[d] |= axes[d]);
        }
    };
    for set in scene.bodies.iter().flat_map(|body| &body.symmetry) {
        let at = |d: usize| nodes(&set.value).iter().map(move |&n| global.points[n as usize][d]);
        let extents = [0, 1, 2].map(|d| at(d).fold(f64::NEG_INFINITY, f64::max) - at(d).fold(f64::INFINITY, f64::min));
        let longest = extents.into_iter().fold(0.0, f64::max);
        keep(&set.value, extents.map(|extent| extent <= FLAT * longest));
    }
    for step in &scene.steps {
        step.fix.iter().for_each(|fix| keep(&fix.set.value, fix.directions));
        step.moves.iter().for_each(|motion| keep(&motion.target.value, motion.directions));
    }
    let on_axis = |n: &u32| {
        let n = *n as usize;
        scene.bodies[global.body[n] as usize].is_axisymmetric() && global.points[n].x == 0.0
    };
    let all = (0..global.points.len() as u32).filter(on_axis);
    all.for_each(|n| kept.entry(global.tie[n as usize]).or_default()[0] = true);
    kept
}

/// Moves all nodes `before` to their means, in layers within the plane, and but for the axes `kept`. Returns the longest
/// way.
fn go(
    means: &[Mean],
    (before, kept): (&BTreeMap<u32, Vec3>, &BTreeMap<u32, [bool; 3]>),
    scene: &Scene,
    global: &mut GlobalMesh,
) -> f64 {
    let to: BTreeMap<u32, Vec3> = (means.iter())
        .map(|(node, weights)| (*node, weights.iter().map(|(n, weight)| global.points[*n as usize] * *weight).sum()))
        .collect();
    let mut farthest = 0.0f64;
    for &n in before.keys() {
        let n = n as usize;
        let stays = kept.get(&global.tie[n]).copied().unwrap_or_default();
        let Some(mut x) = to.get(&global.tie[n]).copied() else { continue };
        (0..3).filter(|&d| stays[d]).for_each(|d| x[d] = global.points[n][d]);
        if scene.bodies[global.body[n] as usize].is_layer() {
            x.z = global.points[n].z;
        }
        farthest = farthest.max((x - global.points[n]).norm());
        global.points[n] = x;
    }
    farthest
}

/// A tie on this rank.
#[derive(Clone, Debug)]
pub struct Joint {
    pub name: String,
    /// Indices of the bodies of slave and master.
    pub bodies: [usize; 2],
    pub slaves: Vec<TiedNode>,
    /// The master nodes that these are means of.
    pub masters: Gather,
}

/// An owned slave node of a tie.
#[derive(Clone, Debug)]
pub struct TiedNode {
    pub node: u32,
    /// P_ik by the places of master nodes among those of the tie.
    pub weights: Vec<(u32, f64)>,
    /// How stiffly the body resists forces there, force per length.
    pub stiffness: f64,
    /// Force on the node of the last converged increment, against which the master's nodes bear.
    pub force: Vec3,
}

impl Joint {
    /// What the slave node's means have of values of the master's nodes.
    pub fn mean(&self, slave: &TiedNode, values: &[f64]) -> Vec3 {
        slave.weights.iter().map(|(k, weight)| Vec3::from_column_slice(&values[3 * *k as usize..][..3]) * *weight).sum()
    }

    /// The owned nodes of one body that are tied to another, ascending; of the master those that some slave is a mean of.
    pub fn nodes_between(&self, body: usize, other: usize) -> Vec<u32> {
        let slaves = self.slaves.iter().map(|slave| slave.node).filter(|_| self.bodies == [body, other]);
        let masters = self.masters.asked().filter(|_| self.bodies == [other, body]);
        let mut nodes: Vec<u32> = slaves.chain(masters).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }
}

impl TiedNode {
    /// The entries ε and -ε P_ik of its equations, by row and column: those along the axes, and those of `own` displacements
    /// and of the master's nodes. Negative ones do not exist.
    pub fn couplings(
        &self,
        equations: &[i64; 3],
        own: [i64; 3],
        of_masters: &[[i64; 3]],
        mut each: impl FnMut([i64; 2], f64),
    ) {
        for (d, &row) in equations.iter().enumerate().filter(|(_, row)| **row >= 0) {
            let means = self.weights.iter().map(|(k, weight)| (of_masters[*k as usize][d], -weight));
            for (column, weight) in std::iter::once((own[d], 1.0)).chain(means).filter(|(column, _)| *column >= 0) {
                each([row, column], weight * self.stiffness);
                each([column, row], weight * self.stiffness);
            }
        }
    }
}

/// Gives each rank the equations of its slave nodes; `numbers` and `tied` are rank 0's. Their stiffness is still to be told.
/// Collective.
pub fn deal(
    comm: &SimpleCommunicator,
    scene: &Scene,
    part: &Part,
    (numbers, tied): (&[u64], &Option<Tied>),
) -> Vec<Joint> {
    if scene.ties.is_empty() {
        return Vec::new();
    }
    let parcel = |rank: usize| {
        let mut words = Vec::new();
        for means in tied.iter().flat_map(|tied| &tied.of) {
            let number = |n: u32| numbers[n as usize];
            let own: Vec<&Mean> = means.iter().filter(|(n, _)| owner(&part.starts, &number(*n)) == rank).collect();
            words.push(own.len() as u64);
            for (node, weights) in own {
                words.extend([number(*node), weights.len() as u64]);
                words.extend(weights.iter().flat_map(|(n, weight)| [number(*n), weight.to_bits()]));
            }
        }
        words
    };
    let words = serve(comm, parcel);
    let mut words = words.iter().copied();
    let mut next = || words.next().unwrap_or_default();
    let first = part.starts[comm.rank() as usize];
    let body = |set: &str| scene.bodies.iter().position(|body| body.name.value == body_of(set)).unwrap_or_default();
    let mut joints = Vec::new();
    for tie in &scene.ties {
        let mut means = Vec::new();
        for _ in 0..next() {
            let (node, count) = ((next() - first) as u32, next());
            let weights: Vec<(u64, f64)> = (0..count).map(|_| (next(), f64::from_bits(next()))).collect();
            means.push((node, weights));
        }
        let all = means.iter().flat_map(|(_, weights)| weights).map(|(number, _)| *number);
        let masters = Gather::new(comm, &part.starts, all);
        let slave = |(node, weights): (u32, Vec<(u64, f64)>)| TiedNode {
            node,
            weights: weights.into_iter().filter_map(|(number, w)| Some((masters.index(number)?, w))).collect(),
            stiffness: 0.0,
            force: Vec3::zeros(),
        };
        let slaves = means.into_iter().map(slave).collect();
        let bodies = [&tie.slave, &tie.master].map(|set| body(&set.value));
        joints.push(Joint { name: tie.name.value.clone(), bodies, slaves, masters });
    }
    joints
}
