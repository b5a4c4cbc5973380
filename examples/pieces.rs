//! What each of many ranks would hold, do and send: `pieces SCENE RANKS,RANKS... [KEY=VALUE]...` cuts the meshes of a scene as
//! for so many ranks and counts, on one rank and without running it. Prints CSV, a row a rank; `scripts/studies/scaling.py`
//! makes tables and a plot of it.

use mpi::topology::SimpleCommunicator;
use nagata::Vec3;
use nagata::contact::body_surface::MARGIN;
use nagata::error::{Error, Result};
use nagata::model::{assemble_bodies, master_patches, set_names};
use nagata::partition::directory::recipients;
use nagata::partition::{Bounds, GlobalMesh, Piece, owner, pieces};
use nagata::scene::{self, Located, Scene};
use nagata::surface::MovingPatch;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

const HEAD: &str =
    "ranks,rank,elements,nodes,unknowns,entries,slaves,halo,sent,neighbours,patches,contact_sent,contact_neighbours";

fn main() -> Result<()> {
    let _universe = mpi::initialize().ok_or_else(|| Error::System("MPI cannot be initialized".into()))?;
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, counts, overrides @ ..] = &arguments[..] else {
        return Err(Error::input_anywhere(
            "no scene, or no numbers of ranks",
            "pieces SCENE RANKS,RANKS... [KEY=VALUE]...",
        ));
    };
    let scene = scene::load(Path::new(file), overrides)?;
    let names = set_names(&scene);
    let mesh = assemble_bodies(&scene, &names)?;
    println!("{HEAD}");
    for ranks in counts.split(',').filter_map(|count| count.parse().ok()) {
        let (pieces, numbers) = pieces(&mesh, ranks)?;
        let mut counted: Vec<Counts> = pieces.iter().map(Counts::of_piece).collect();
        halo(&pieces, &mut counted);
        displacements(&scene, &names, &pieces, &mut counted);
        contacts(&scene, &names, &mesh, &numbers, &pieces, &mut counted)?;
        for (rank, counts) in counted.iter().enumerate() {
            println!("{ranks},{rank},{}", counts.row());
        }
    }
    Ok(())
}

/// Of one rank.
#[derive(Default)]
struct Counts {
    /// Elements that it assembles: all that touch a node of its own.
    elements: usize,
    /// Nodes of its own.
    nodes: usize,
    /// Unknowns of the first step: displacements of these that are free, and multipliers.
    unknowns: usize,
    /// Entries of the matrix in the rows of these, without those of contact.
    entries: usize,
    /// Slave nodes among them.
    slaves: usize,
    /// Nodes of others that it sees.
    halo: usize,
    /// Nodes that it sends in an exchange of the halo, and to how many ranks.
    sent: usize,
    neighbours: usize,
    /// Patches of masters on bodies that it fetches.
    patches: usize,
    /// Nodes that it sends for the patches of others in an iterate, and to how many ranks.
    contact_sent: usize,
    contact_neighbours: usize,
}

impl Counts {
    fn of_piece(piece: &Piece) -> Self {
        let part = &piece.part;
        let owned = |n: &u32| (*n as usize) < part.owned && part.tie[*n as usize] == *n;
        let pairs = part.solids.iter().flat_map(|solid| {
            let nodes = solid.nodes();
            nodes.iter().filter(|n| owned(n)).flat_map(move |&a| nodes.iter().map(move |&b| (a, b)))
        });
        let mut pairs: Vec<(u32, u32)> = pairs.map(|(a, b)| (a, part.tie[b as usize])).collect();
        pairs.sort_unstable();
        pairs.dedup();
        Self {
            elements: part.solids.len(),
            nodes: (0..part.owned as u32).filter(|n| owned(n)).count(),
            entries: 9 * pairs.len(),
            halo: part.points.len() - part.owned,
            ..Self::default()
        }
    }

    fn row(&self) -> String {
        let Self { elements, nodes, unknowns, entries, slaves, halo, .. } = self;
        let Self { sent, neighbours, patches, contact_sent, contact_neighbours, .. } = self;
        format!(
            "{elements},{nodes},{unknowns},{entries},{slaves},{halo},{sent},{neighbours},{patches},{contact_sent},{contact_neighbours}"
        )
    }
}

/// Counts what owners send for the halos of others.
fn halo(pieces: &[Piece], counted: &mut [Counts]) {
    for (owner, nodes) in pieces.iter().flat_map(|piece| &piece.wanted) {
        counted[*owner].sent += nodes.len();
        counted[*owner].neighbours += 1;
    }
}

/// Counts the displacements that no condition of the first step prescribes.
fn displacements(scene: &Scene, names: &[Located<String>], pieces: &[Piece], counted: &mut [Counts]) {
    let step = &scene.steps[0];
    let fixed = step.fix.iter().map(|fix| (&fix.set, fix.directions));
    let prescribed: Vec<_> = fixed.chain(step.moves.iter().map(|m| (&m.target, m.directions))).collect();
    for (piece, counts) in pieces.iter().zip(counted) {
        let part = &piece.part;
        let mut held = BTreeSet::new();
        for (set, directions) in &prescribed {
            // Tools are no sets.
            let nodes = index(names, set).map_or(&[][..], |k| &part.sets[k].nodes);
            let components = nodes.iter().flat_map(|&n| (0..3).map(move |d| (part.tie[n as usize], d)));
            held.extend(components.filter(|(_, d)| directions[*d]));
        }
        counts.unknowns += 3 * counts.nodes - held.len();
    }
}

fn index(names: &[Located<String>], set: &Located<String>) -> Option<usize> {
    names.iter().position(|name| name.value == set.value)
}

/// Counts slave nodes with their multipliers, the patches near them, and what owners send for these.
fn contacts(
    scene: &Scene,
    names: &[Located<String>],
    mesh: &GlobalMesh,
    numbers: &[u64],
    pieces: &[Piece],
    counted: &mut [Counts],
) -> Result<()> {
    let alone = SimpleCommunicator::self_comm();
    let passes = scene.passes();
    // Planes of symmetry add mirror images, which are not sent.
    let mut surfaces = master_patches(scene, names, &[], Some(mesh), numbers)?.into_iter();
    let places: BTreeMap<u64, Vec3> = numbers.iter().copied().zip(mesh.points.iter().copied()).collect();
    for contact in &passes {
        let slave = index(names, &contact.slave).unwrap_or_default();
        let multipliers = if contact.friction > 0.0 { 3 } else { 1 };
        let patches = if contact.surface.is_some() { surfaces.next().unwrap_or_default().0 } else { Vec::new() };
        let boxes: Vec<Bounds> = patches.iter().map(|patch| bounds(patch, &places)).collect();
        let reach = contact.reach.unwrap_or_else(|| scene.controls.reach_facets * longest_edge(mesh, slave));
        for (rank, piece) in pieces.iter().enumerate() {
            let part = &piece.part;
            let nodes: BTreeSet<u32> = part.sets[slave].nodes.iter().map(|&n| part.tie[n as usize]).collect();
            counted[rank].slaves += nodes.len();
            counted[rank].unknowns += multipliers * nodes.len();
            let points: Vec<Vec3> = nodes.iter().map(|&n| part.points[n as usize]).collect();
            let near = recipients(&alone, &boxes, &points, (1.0 + MARGIN) * reach).remove(&0).unwrap_or_default();
            counted[rank].patches += near.len();
            let seen: BTreeSet<u64> = near.iter().flat_map(|&k| patches[k as usize].nodes.iter().copied()).collect();
            let mut of_owners: BTreeMap<usize, usize> = BTreeMap::new();
            seen.iter().for_each(|number| *of_owners.entry(owner(&part.starts, number)).or_default() += 1);
            of_owners.remove(&rank);
            for (owner, nodes) in of_owners {
                counted[owner].contact_sent += nodes;
                counted[owner].contact_neighbours += 1;
            }
        }
    }
    Ok(())
}

fn bounds(patch: &MovingPatch, places: &BTreeMap<u64, Vec3>) -> Bounds {
    patch.shape(&patch.nodes.iter().map(|n| places[n]).collect::<Vec<_>>()).bounds()
}

/// Of the facets of a set.
fn longest_edge(mesh: &GlobalMesh, set: usize) -> f64 {
    let edges = mesh.sets[set].facets.iter().flat_map(|facet| {
        let nodes = &facet.nodes[..facet.count as usize];
        nodes.iter().zip(nodes.iter().cycle().skip(1)).map(|(&a, &b)| mesh.points[a as usize] - mesh.points[b as usize])
    });
    edges.map(|edge| edge.norm()).fold(0.0, f64::max)
}
