//! Rank 0 has the whole mesh; afterwards every rank has its part. The parts are made one after the other, each in time and
//! memory of its own size.

use super::components::{Component, lowest_joined};
use super::graph::{element_parts, node_owners};
use super::halo::Halo;
use super::lists::Lists;
use super::{FaceNodes, Part, PartFacet, PartSet, PartSolid, Quadratic};
use crate::Vec3;
use crate::error::Result;
use crate::mesh::{MOST_NODES, Middles, Quarters, Solid, SolidShape};
use crate::parallel::{Parcels, agree, beginnings, serve, starts};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;

/// All bodies of a scene in one numbering; on rank 0.
#[derive(Clone, Debug, Default)]
pub struct GlobalMesh {
    pub points: Vec<Vec3>,
    /// Body of each node.
    pub body: Vec<u32>,
    /// Section of each node: of those around it the stiffest.
    pub section: Vec<u32>,
    /// Number of each node in its file.
    pub id: Vec<u64>,
    /// Index of the component of each node, see [`Self::connect`].
    pub component: Vec<u32>,
    pub components: Vec<Component>,
    /// Node whose displacement a node shares; mostly itself.
    pub tie: Vec<u32>,
    pub solids: Vec<Solid>,
    /// Body of each element.
    pub solid_body: Vec<u32>,
    /// Section of each element.
    pub solid_section: Vec<u32>,
    pub sets: Vec<GlobalSet>,
    /// Of the edges of the facets of all sets.
    pub middles: Middles,
    /// Extra work that a node brings to its elements, for the balance: slave nodes have some.
    pub node_work: Vec<i32>,
    /// By body.
    pub files: Vec<OfFile>,
    /// What the user should know of the meshes.
    pub warnings: Vec<String>,
}

/// What is to be known of the file that a body's mesh comes from.
#[derive(Clone, Copy, Debug)]
pub struct OfFile {
    /// The highest number that it gives to a node; new nodes of refined meshes follow.
    pub last_id: u64,
    /// Whether the mesh [has halves](crate::mesh::Mesh::has_halves).
    pub has_halves: bool,
    /// Groups of elements in it.
    pub parts: usize,
}

impl GlobalMesh {
    /// Finds what hangs together.
    pub fn connect(&mut self) {
        let lowest = lowest_joined(self.points.len(), self.solids.iter().map(Solid::nodes));
        (self.component, self.components) = (Vec::with_capacity(lowest.len()), Vec::new());
        for (n, first) in lowest.into_iter().enumerate() {
            let x = self.points[n];
            if first as usize == n {
                self.component.push(self.components.len() as u32);
                let (body, node) = (self.body[n], self.id[n]);
                self.components.push(Component { body, is_whole: true, node, place: x, bounds: (x, x) });
            } else {
                let own = self.component[first as usize];
                self.component.push(own);
                let (low, high) = &mut self.components[own as usize].bounds;
                (*low, *high) = (low.inf(&x), high.sup(&x));
            }
        }
        // Those of a body stand one after the other.
        let bodies: Vec<u32> = self.components.iter().map(|component| component.body).collect();
        for (k, component) in self.components.iter_mut().enumerate() {
            let beside = [k.checked_sub(1), Some(k + 1)].into_iter().flatten().filter_map(|other| bodies.get(other));
            component.is_whole = beside.into_iter().all(|body| *body != component.body);
        }
    }

    /// Between which z the nodes of a body lie.
    pub fn z_range(&self, body: usize) -> [f64; 2] {
        let own = self.points.iter().zip(&self.body).filter(|(_, of)| **of as usize == body).map(|(x, _)| x.z);
        own.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], z| [low.min(z), high.max(z)])
    }
}

/// A set of the scene in the global numbering.
#[derive(Clone, Debug, Default)]
pub struct GlobalSet {
    pub nodes: Vec<u32>,
    pub facets: Vec<GlobalFacet>,
}

/// A facet in the global numbering.
#[derive(Clone, Copy, Debug)]
pub struct GlobalFacet {
    pub count: u8,
    pub nodes: [u32; 4],
    /// Its number in the mesh file, for messages.
    pub id: u64,
}

impl GlobalFacet {
    /// The nodes that count.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes[..self.count as usize]
    }
}

/// Partitions the mesh that rank 0 holds (the others pass `None`) and gives every rank its part. Rank 0 also gets the
/// number over all ranks, as in [`Part::starts`], of each node of its mesh. Collective.
///
/// # Errors
/// METIS's own, on all ranks.
pub fn distribute(comm: &SimpleCommunicator, mesh: Option<&GlobalMesh>) -> Result<(Part, Vec<u64>)> {
    let cut = mesh.map(|mesh| Cut::new(mesh, comm.size() as usize)).transpose();
    let mut cut = agree(comm, cut)?;
    let numbers = serve(comm, |rank| cut.as_mut().map_or(Vec::new(), |cut| cut.parcel(rank)));
    let (mut part, wanted) = unpack(&numbers);
    drop(numbers);
    part.halo = Halo::new(comm, &wanted);
    part.starts = starts(comm, part.owned as u64);
    let numbering = cut.map_or(Vec::new(), |cut| cut.numbers(&part.starts));
    Ok((part, numbering))
}

/// A part without its ways to the others.
pub struct Piece {
    pub part: Part,
    /// Its halo nodes by the rank that owns them, as (local node, index among the owned nodes there).
    pub wanted: Parcels<(u32, u32)>,
}

/// What so many ranks would get of a mesh, all on this one: to count what they would do and say. Also returns the numbers
/// of [`distribute`].
///
/// # Errors
/// METIS's own.
pub fn pieces(mesh: &GlobalMesh, ranks: usize) -> Result<(Vec<Piece>, Vec<u64>)> {
    let mut cut = Cut::new(mesh, ranks)?;
    let unpacked = (0..ranks).map(|rank| unpack(&cut.parcel(rank)));
    let mut pieces: Vec<Piece> = unpacked.map(|(part, wanted)| Piece { part, wanted }).collect();
    let starts = beginnings(&pieces.iter().map(|piece| piece.part.owned as u64).collect::<Vec<_>>());
    pieces.iter_mut().for_each(|piece| piece.part.starts.clone_from(&starts));
    Ok((pieces, cut.numbers(&starts)))
}

/// Calls `each` with every owner of the nodes, once.
fn owners(owner: &[i32], nodes: &[u32], each: &mut dyn FnMut(usize)) {
    let of = |n: &u32| owner[*n as usize];
    for (k, n) in nodes.iter().enumerate() {
        if !nodes[..k].iter().any(|m| of(m) == of(n)) {
            each(of(n) as usize);
        }
    }
}

const UNSEEN: u32 = u32::MAX;

/// A mesh that is partitioned, on rank 0.
struct Cut<'a> {
    mesh: &'a GlobalMesh,
    /// Rank of each node.
    owner: Vec<i32>,
    /// Index of each node among those of its rank.
    place: Vec<u32>,
    /// Nodes by their owners, solids by those of their nodes.
    nodes: Lists,
    solids: Lists,
    /// The same of the nodes and facets of each set, as indices in it.
    sets: Vec<[Lists; 2]>,
    /// Index of each node in the part that is being made.
    local: Vec<u32>,
}

impl<'a> Cut<'a> {
    fn new(mesh: &'a GlobalMesh, size: usize) -> Result<Self> {
        let work = |s: &Solid| 4 + s.nodes().iter().map(|&n| mesh.node_work[n as usize]).sum::<i32>();
        let weights: Vec<i32> = mesh.solids.iter().map(work).collect();
        let elements = mesh.solids.iter().map(Solid::nodes);
        let part = element_parts(elements.clone(), &weights, size)?;
        let owner = node_owners(elements, &part, &mesh.tie);
        let nodes = Lists::new(size, owner.len(), |n, each| each(owner[n] as usize));
        let mut place = vec![0; owner.len()];
        for rank in 0..size {
            (0..).zip(nodes.of(rank)).for_each(|(k, &n)| place[n as usize] = k);
        }
        let solids = Lists::new(size, mesh.solids.len(), |e, each| owners(&owner, mesh.solids[e].nodes(), each));
        let facets = mesh.sets.iter().flat_map(|set| &set.facets);
        let quarters = Quarters::in_solids(mesh.solids.iter(), facets.map(GlobalFacet::nodes));
        let of_set = |set: &GlobalSet| {
            let nodes = Lists::new(size, set.nodes.len(), |k, each| each(owner[set.nodes[k] as usize] as usize));
            let facets = Lists::new(size, set.facets.len(), |k, each| {
                owners(&owner, &FaceNodes::of(set.facets[k].nodes(), &mesh.middles, &quarters), each)
            });
            [nodes, facets]
        };
        let sets = mesh.sets.iter().map(of_set).collect();
        let local = vec![UNSEEN; owner.len()];
        Ok(Self { mesh, owner, place, nodes, solids, sets, local })
    }

    /// The number of each node over all ranks.
    fn numbers(&self, starts: &[u64]) -> Vec<u64> {
        self.owner.iter().zip(&self.place).map(|(&rank, &k)| starts[rank as usize] + u64::from(k)).collect()
    }

    /// What `rank` gets, flat, because it travels by MPI; [`unpack`] reads it in the same order.
    fn parcel(&mut self, rank: usize) -> Vec<u64> {
        let Self { mesh, owner, place, local, .. } = self;
        let is_own = |n: u32| owner[n as usize] as usize == rank;
        let mut held = self.nodes.of(rank).to_vec();
        let owned = held.len();
        for (k, &n) in (0..).zip(&held) {
            local[n as usize] = k;
        }
        let mut see = |held: &mut Vec<u32>, nodes: &[u32]| {
            for &n in nodes {
                if local[n as usize] == UNSEEN {
                    local[n as usize] = held.len() as u32;
                    held.push(n);
                }
            }
        };
        let solids = self.solids.of(rank).iter().map(|&e| e as usize);
        solids.clone().for_each(|e| see(&mut held, mesh.solids[e].nodes()));
        // A halo node's tie is held too, so that every tie is a local node.
        for k in owned..held.len() {
            let tie = mesh.tie[held[k] as usize];
            see(&mut held, &[tie]);
        }

        let at = |n: u32| u64::from(local[n as usize]);
        let mut p = Vec::with_capacity(8 * held.len() + 12 * solids.len());
        p.extend([owned, held.len(), mesh.points.len(), mesh.solids.len(), solids.len()].map(|n| n as u64));
        p.push(mesh.components.len() as u64);
        p.extend(mesh.components.iter().flat_map(Component::to_words));
        for n in held.iter().map(|&n| n as usize) {
            p.extend([owner[n] as u64, u64::from(place[n]), u64::from(mesh.body[n]), u64::from(mesh.section[n])]);
            p.extend([u64::from(mesh.component[n]), mesh.id[n], n as u64, at(mesh.tie[n])]);
            p.extend(mesh.points[n].iter().map(|x| x.to_bits()));
        }
        for e in solids {
            let solid = &mesh.solids[e];
            let mine = u64::from(is_own(solid.nodes[0]));
            p.extend([solid.nodes().len() as u64, u64::from(mesh.solid_body[e]), u64::from(mesh.solid_section[e])]);
            p.extend([solid.id, e as u64, mine]);
            p.extend(solid.nodes().iter().map(|&n| at(n)));
        }
        p.push(mesh.sets.len() as u64);
        for (set, [nodes, facets]) in mesh.sets.iter().zip(&self.sets) {
            let (nodes, facets) = (nodes.of(rank), facets.of(rank));
            p.extend([nodes.len() as u64, facets.len() as u64]);
            p.extend(nodes.iter().map(|&k| at(set.nodes[k as usize])));
            for &k in facets {
                let facet = &set.facets[k as usize];
                p.extend([u64::from(facet.count), u64::from(k), u64::from(is_own(facet.nodes[0]))]);
                p.extend(facet.nodes().iter().map(|&n| at(n)));
            }
        }
        held.iter().for_each(|&n| local[n as usize] = UNSEEN);
        p
    }
}

/// Reads a parcel; also returns for each rank the halo nodes that it owns, as (local node, index among its own).
fn unpack(numbers: &[u64]) -> (Part, Parcels<(u32, u32)>) {
    let mut rest = numbers.iter().copied();
    let mut next = || rest.next().unwrap_or_default();
    let mut part = Part { owned: next() as usize, ..Part::default() };
    let held = next() as usize;
    part.whole.nodes = next();
    part.whole.solids = next();
    let solids = next() as usize;
    for _ in 0..next() {
        part.components.push(Component::from_words(&std::array::from_fn(|_| next())));
    }
    let mut wanted = Parcels::new();
    for local in 0..held {
        let (of, place) = (next() as usize, next() as u32);
        if local >= part.owned {
            wanted.entry(of).or_insert_with(Vec::new).push((local as u32, place));
        }
        part.body.push(next() as u32);
        part.section.push(next() as u32);
        part.component.push(next() as u32);
        part.id.push(next());
        part.number.push(next());
        part.tie.push(next() as u32);
        part.points.push(Vec3::from_fn(|_, _| f64::from_bits(next())));
    }
    for _ in 0..solids {
        let count = next() as usize;
        let shape = match count {
            4 => SolidShape::Tet4,
            5 => SolidShape::Pyramid5,
            6 => SolidShape::Wedge6,
            10 => SolidShape::Tet10,
            18 => SolidShape::Wedge18,
            27 => SolidShape::Hex27,
            _ => SolidShape::Hex8,
        };
        let [body, section] = [next() as u32, next() as u32];
        let (id, number, mine) = (next(), next(), next() == 1);
        let mut nodes = [0; MOST_NODES];
        nodes[..count].fill_with(|| next() as u32);
        part.solids.push(PartSolid { shape, nodes, body, section, id, number, mine });
    }
    for _ in 0..next() {
        let (node_count, facet_count) = (next(), next());
        let mut set = PartSet { nodes: (0..node_count).map(|_| next() as u32).collect(), facets: Vec::new() };
        for _ in 0..facet_count {
            let (count, number, mine) = (next() as u8, next(), next() == 1);
            let mut nodes = [0; 4];
            nodes[..count as usize].fill_with(|| next() as u32);
            set.facets.push(PartFacet { count, nodes, number, mine });
        }
        part.sets.push(set);
    }
    part.quadratic = quadratic(&part);
    (part, wanted)
}

/// What carries the facets of the sets of a part where they are quadratic.
fn quadratic(part: &Part) -> Quadratic {
    let is_quadratic = |shape: SolidShape| matches!(shape, SolidShape::Tet10 | SolidShape::Hex27 | SolidShape::Wedge18);
    let quadratic = part.solids.iter().filter(|solid| is_quadratic(solid.shape));
    let solids: Vec<Solid> = quadratic.map(|s| Solid { shape: s.shape, nodes: s.nodes, id: s.id }).collect();
    let facets = part.sets.iter().flat_map(|set| &set.facets);
    let corners = facets.map(|facet| &facet.nodes[..facet.count as usize]);
    let middles = Middles::in_solids(solids.iter(), corners.clone(), [].into_iter());
    Quadratic { middles, quarters: Quarters::in_solids(solids.iter(), corners) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_hold_the_mesh_and_know_the_owners_of_their_halos() {
        const N: u32 = 6;
        let at = |i: u32, j: u32, k: u32| i + (N + 1) * (j + (N + 1) * k);
        let all = |n: u32| (0..n).flat_map(move |k| (0..n).flat_map(move |j| (0..n).map(move |i| (i, j, k))));
        let hex = |(i, j, k)| {
            let low = [at(i, j, k), at(i + 1, j, k), at(i + 1, j + 1, k), at(i, j + 1, k)];
            let nodes: [u32; 8] = std::array::from_fn(|a| if a < 4 { low[a] } else { low[a - 4] + (N + 1) * (N + 1) });
            Solid::new(SolidShape::Hex8, &nodes, u64::from(at(i, j, k)))
        };
        let points: Vec<Vec3> = all(N + 1).map(|(i, j, k)| Vec3::new(i.into(), j.into(), k.into())).collect();
        let count = points.len();
        let mut mesh = GlobalMesh {
            body: vec![0; count],
            section: vec![0; count],
            id: (0..count as u64).collect(),
            tie: (0..count as u32).collect(),
            node_work: vec![0; count],
            solids: all(N).map(hex).collect(),
            solid_body: vec![0; (N * N * N) as usize],
            solid_section: vec![0; (N * N * N) as usize],
            points,
            ..GlobalMesh::default()
        };
        mesh.connect();
        for ranks in [1, 2, 5, 300] {
            let (pieces, numbers) = pieces(&mesh, ranks).unwrap();
            assert_eq!(pieces.len(), ranks);
            let mine = pieces.iter().flat_map(|piece| &piece.part.solids).filter(|solid| solid.mine).count();
            assert_eq!(mine, mesh.solids.len());
            let mut owned: Vec<u64> = pieces.iter().flat_map(|p| p.part.id[..p.part.owned].iter().copied()).collect();
            assert!((0..count).all(|n| owned[numbers[n] as usize] == mesh.id[n]));
            owned.sort_unstable();
            assert_eq!(owned, mesh.id);
            for piece in &pieces {
                let part = &piece.part;
                assert_eq!(part.starts[ranks], count as u64);
                let halo = piece.wanted.iter().flat_map(|(owner, nodes)| nodes.iter().map(move |node| (*owner, node)));
                assert!(halo.clone().all(|(owner, &(local, place))| {
                    part.id[local as usize] == pieces[owner].part.id[place as usize]
                }));
                assert_eq!(halo.count(), part.points.len() - part.owned);
            }
        }
    }

    #[test]
    fn what_concerns_a_rank_is_listed_once() {
        let owner = [2, 2, 0, 0, 2];
        let elements: [&[u32]; 4] = [&[0, 1, 4], &[1, 2, 3], &[2, 3], &[3, 0, 2, 4]];
        let listed = Lists::new(3, elements.len(), |e, each| owners(&owner, elements[e], each));
        assert_eq!([0, 1, 2].map(|rank| listed.of(rank)), [&[1, 2, 3][..], &[], &[0, 1, 3]]);
    }
}
