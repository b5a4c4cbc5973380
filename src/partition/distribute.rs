//! Rank 0 has the whole mesh; afterwards every rank has its part.

use super::graph::{element_parts, node_owners};
use super::halo::Halo;
use super::{Part, PartFacet, PartSet, PartSolid};
use crate::Vec3;
use crate::error::Result;
use crate::mesh::{Solid, SolidShape};
use crate::parallel::{Parcels, agree, beginnings, scatter, starts};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;

/// All bodies of a scene in one numbering; on rank 0.
#[derive(Clone, Debug, Default)]
pub struct GlobalMesh {
    pub points: Vec<Vec3>,
    /// Body of each node.
    pub body: Vec<u32>,
    /// Number of each node in its file.
    pub id: Vec<u64>,
    /// Node whose displacement a node shares; mostly itself.
    pub tie: Vec<u32>,
    pub solids: Vec<Solid>,
    /// Body of each element.
    pub solid_body: Vec<u32>,
    pub sets: Vec<GlobalSet>,
    /// Extra work that a node brings to its elements, for the balance: slave nodes have some.
    pub node_work: Vec<i32>,
    /// Groups of elements that each body has in its mesh file.
    pub parts: Vec<usize>,
    /// What the user should know of the meshes.
    pub warnings: Vec<String>,
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

/// Partitions the mesh that rank 0 holds (the others pass `None`) and gives every rank its part. Rank 0 also gets the
/// number over all ranks, as in [`Part::starts`], of each node of its mesh. Collective.
///
/// # Errors
/// METIS's own, on all ranks.
pub fn distribute(comm: &SimpleCommunicator, mesh: Option<&GlobalMesh>) -> Result<(Part, Vec<u64>)> {
    let size = comm.size() as usize;
    let nothing = || (Vec::new(), Vec::new());
    let (parcels, numbering) = agree(comm, mesh.map_or_else(|| Ok(nothing()), |m| cut(m, size)))?;
    let (numbers, points): (Vec<_>, Vec<_>) = parcels.into_iter().map(|p| (p.numbers, p.points)).unzip();
    let numbers = scatter(comm, &numbers.into_iter().enumerate().collect());
    let points = scatter(comm, &points.into_iter().enumerate().collect());
    let (mut part, wanted) = unpack(&numbers, &points);
    part.halo = Halo::new(comm, &wanted);
    part.starts = starts(comm, part.owned as u64);
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
    let (parcels, numbering) = cut(mesh, ranks)?;
    let unpacked = parcels.iter().map(|parcel| unpack(&parcel.numbers, &parcel.points));
    let mut pieces: Vec<Piece> = unpacked.map(|(part, wanted)| Piece { part, wanted }).collect();
    let starts = beginnings(&pieces.iter().map(|piece| piece.part.owned as u64).collect::<Vec<_>>());
    pieces.iter_mut().for_each(|piece| piece.part.starts.clone_from(&starts));
    Ok((pieces, numbering))
}

/// A part on its way: flat, because it travels by MPI. [`cut`] writes it and [`unpack`] reads it in the same order.
#[derive(Clone, Debug, Default)]
struct Parcel {
    numbers: Vec<u64>,
    points: Vec<f64>,
}

/// Makes the parcel of every rank, and numbers the nodes over all ranks.
fn cut(mesh: &GlobalMesh, size: usize) -> Result<(Vec<Parcel>, Vec<u64>)> {
    let mut first = vec![0i32];
    let mut nodes = Vec::new();
    for solid in &mesh.solids {
        nodes.extend(solid.nodes().iter().map(|&n| n as i32));
        first.push(nodes.len() as i32);
    }
    let work = |s: &Solid| 4 + s.nodes().iter().map(|&n| mesh.node_work[n as usize]).sum::<i32>();
    let weights: Vec<i32> = mesh.solids.iter().map(work).collect();
    let part = element_parts(&first, &nodes, &weights, size)?;
    let owner = node_owners(&first, &nodes, &part, &mesh.tie);
    let mut place = vec![0u32; owner.len()];
    let mut count = vec![0u32; size];
    for (node, &rank) in owner.iter().enumerate() {
        place[node] = count[rank as usize];
        count[rank as usize] += 1;
    }
    let first: Vec<u64> = count.iter().scan(0, |end, &n| Some(std::mem::replace(end, *end + u64::from(n)))).collect();
    let numbers = owner.iter().zip(&place).map(|(&rank, &k)| first[rank as usize] + u64::from(k)).collect();
    let numbering = Numbering { owner, place };
    Ok(((0..size).map(|rank| parcel(mesh, &numbering, rank as i32)).collect(), numbers))
}

/// The numbering of nodes over all ranks.
struct Numbering {
    /// Rank of each node.
    owner: Vec<i32>,
    /// Index of each node among those of its rank.
    place: Vec<u32>,
}

/// What `rank` gets.
fn parcel(mesh: &GlobalMesh, numbering: &Numbering, rank: i32) -> Parcel {
    const UNSEEN: u32 = u32::MAX;
    let owner = &numbering.owner;
    let touches = |nodes: &[u32]| nodes.iter().any(|&n| owner[n as usize] == rank);
    let mut local = vec![UNSEEN; mesh.points.len()];
    let mut held: Vec<u32> = (0..mesh.points.len() as u32).filter(|&n| owner[n as usize] == rank).collect();
    let owned = held.len();
    for (k, &n) in held.iter().enumerate() {
        local[n as usize] = k as u32;
    }
    let mut see = |held: &mut Vec<u32>, nodes: &[u32]| {
        for &n in nodes {
            if local[n as usize] == UNSEEN {
                local[n as usize] = held.len() as u32;
                held.push(n);
            }
        }
    };
    let solids: Vec<usize> = (0..mesh.solids.len()).filter(|&e| touches(mesh.solids[e].nodes())).collect();
    solids.iter().for_each(|&e| see(&mut held, mesh.solids[e].nodes()));
    // A halo node's tie is held too, so that every tie is a local node.
    for k in owned..held.len() {
        let tie = mesh.tie[held[k] as usize];
        see(&mut held, &[tie]);
    }

    let mut p = Parcel::default();
    p.numbers.extend([owned, held.len(), mesh.points.len(), mesh.solids.len(), solids.len()].map(|n| n as u64));
    for &n in &held {
        let at = n as usize;
        p.numbers.extend([owner[at] as u64, u64::from(numbering.place[at])]);
        p.numbers.extend([u64::from(mesh.body[at]), mesh.id[at], u64::from(local[mesh.tie[at] as usize])]);
        p.points.extend(mesh.points[at].iter());
    }
    for &e in &solids {
        let solid = &mesh.solids[e];
        let mine = owner[solid.nodes[0] as usize] == rank;
        p.numbers.extend([solid.nodes().len() as u64, u64::from(mesh.solid_body[e]), solid.id, u64::from(mine)]);
        p.numbers.extend(solid.nodes().iter().map(|&n| u64::from(local[n as usize])));
    }
    p.numbers.push(mesh.sets.len() as u64);
    for set in &mesh.sets {
        let mine: Vec<u64> =
            set.nodes.iter().filter(|&&n| owner[n as usize] == rank).map(|&n| u64::from(local[n as usize])).collect();
        let facets: Vec<&GlobalFacet> = set.facets.iter().filter(|f| touches(&f.nodes[..f.count as usize])).collect();
        p.numbers.extend([mine.len() as u64, facets.len() as u64]);
        p.numbers.extend(mine);
        for f in facets {
            p.numbers.extend([u64::from(f.count), u64::from(owner[f.nodes[0] as usize] == rank)]);
            p.numbers.extend(f.nodes[..f.count as usize].iter().map(|&n| u64::from(local[n as usize])));
        }
    }
    p
}

/// Reads a parcel; also returns for each rank the halo nodes that it owns, as (local node, index among its own).
fn unpack(numbers: &[u64], points: &[f64]) -> (Part, Parcels<(u32, u32)>) {
    let mut rest = numbers.iter().copied();
    let mut next = || rest.next().unwrap_or_default();
    let mut part = Part { owned: next() as usize, ..Part::default() };
    let held = next() as usize;
    part.total_nodes = next();
    part.total_solids = next();
    let solids = next() as usize;
    let mut wanted = Parcels::new();
    for (local, x) in (0..held).zip(points.chunks_exact(3)) {
        let (of, place) = (next() as usize, next() as u32);
        if local >= part.owned {
            wanted.entry(of).or_insert_with(Vec::new).push((local as u32, place));
        }
        part.body.push(next() as u32);
        part.id.push(next());
        part.tie.push(next() as u32);
        part.points.push(Vec3::new(x[0], x[1], x[2]));
    }
    for _ in 0..solids {
        let count = next() as usize;
        let shape = if count == 4 { SolidShape::Tet4 } else { SolidShape::Hex8 };
        let (body, id, mine) = (next() as u32, next(), next() == 1);
        let mut nodes = [0; 8];
        nodes[..count].fill_with(|| next() as u32);
        part.solids.push(PartSolid { shape, nodes, body, id, mine });
    }
    for _ in 0..next() {
        let (node_count, facet_count) = (next(), next());
        let mut set = PartSet { nodes: (0..node_count).map(|_| next() as u32).collect(), facets: Vec::new() };
        for _ in 0..facet_count {
            let (count, mine) = (next() as u8, next() == 1);
            let mut nodes = [0; 4];
            nodes[..count as usize].fill_with(|| next() as u32);
            set.facets.push(PartFacet { count, nodes, mine });
        }
        part.sets.push(set);
    }
    (part, wanted)
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
            let nodes = std::array::from_fn(|a| if a < 4 { low[a] } else { low[a - 4] + (N + 1) * (N + 1) });
            Solid { shape: SolidShape::Hex8, nodes, id: u64::from(at(i, j, k)) }
        };
        let points: Vec<Vec3> = all(N + 1).map(|(i, j, k)| Vec3::new(i.into(), j.into(), k.into())).collect();
        let count = points.len();
        let mesh = GlobalMesh {
            body: vec![0; count],
            id: (0..count as u64).collect(),
            tie: (0..count as u32).collect(),
            node_work: vec![0; count],
            solids: all(N).map(hex).collect(),
            solid_body: vec![0; (N * N * N) as usize],
            points,
            ..GlobalMesh::default()
        };
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
}
