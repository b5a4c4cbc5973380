//! Whether slave and master are the right way round, where only the slave's nodes are kept out of the master, and what else
//! their meshes make of a contact.
//!
//! Nodes of the master may sink into the slave between the slave's nodes. So the slave should have the finer mesh, the
//! stiffer body should be the master, and a flat or hollow surface should be the master of one that bulges (section 4.2.2
//! of Neto, Oliveira and Menezes). These may contradict each other: a clearly stiffer master is right whatever its mesh, and
//! bulges count where stiffness and meshes are alike. From segment to segment no node sinks in; but a facet of the slave that is
//! pressed in a part of it alone, by a finer master that bulges, has the mean of all that it sees of that, and its forces lean.
//!
//! Two passes pass an even pressure on by forces at the nodes of both sides. Where the facets of one are the longer ones along
//! one direction, and the shorter ones along another, as rectangles across each other or triangles whose diagonals cross, some of
//! these forces would have to pull, and nodes let go in the middle of the contact.
//!
//! Forces of an even pressure at the nodes of a face of nine are 1/36, 1/9 and 4/9 of all, those of its four quarters 1/16, 1/8 and
//! 1/4: where one side has these and the other those, nodes that meet nodes cannot pass them on evenly.

use super::Discretization;
use crate::error::{Error, Result};
use crate::parallel::{any, sum};
use crate::partition::parcels::{bounds, grown, hull};
use crate::partition::{Part, PartFacet};
use crate::scene::{self, Scene};
use crate::{Mat3, Vec3};
use mpi::topology::SimpleCommunicator;
use nalgebra::{DMatrix, SymmetricEigen};
use std::collections::BTreeMap;
use std::fmt;

/// Ratio from which stiffness or facet sizes are clearly unlike.
const CLEARLY: f64 = 1.2;
/// Ratio of facet sizes from which a coarse slave keeps out next to nothing of its master, unless that is so much stiffer:
/// forces of two blocks on each other are then 5 to 30 % off.
const HOPELESS: f64 = 5.0;
const RIGID: f64 = 10.0;
/// Bulges from which a surface is round, and up to which it is flat; that of half a sphere is about 1.
const ROUND: f64 = 0.05;
const FLAT: f64 = 0.01;

/// A side of a contact.
#[derive(Clone, Debug, PartialEq)]
struct Side {
    name: String,
    /// Young's modulus.
    young: f64,
    /// Root of the mean area of the facets where the two sides can meet; on a layer their mean length.
    facet_size: f64,
    /// Mean of (x - mean x)·n over that of |x - mean x|: positive for a surface that bulges, negative for a hollow one. The mean x is
    /// that of the component of the mesh that a facet is on: balls side by side bulge.
    bulge: f64,
    /// The mean of e eᵀ over the edges e of those facets.
    edges: Mat3,
}

/// A contact whose slave should rather be the master.
#[derive(Clone, Debug, PartialEq)]
pub struct WrongWayRound {
    pub contact: String,
    slave: String,
    master: String,
    by_segments: bool,
    /// It may be in two passes.
    may_be_twice: bool,
    pub reason: String,
}

impl fmt::Display for WrongWayRound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { contact, slave, master, by_segments, may_be_twice, reason } = self;
        let why = match by_segments {
            true => ", whose facets take the mean of what presses them",
            false => ", whose nodes alone are kept out of the other",
        };
        let or = if *may_be_twice { "use discretization = \"two-pass\"" } else { "refine the slave" };
        write!(
            f,
            "contact `{contact}`: `{slave}` should rather be the master, and `{master}` the slave{why}: {reason}; exchange them, or \
             {or}"
        )
    }
}

/// Why a slave should rather be the master, if it should.
fn reason(slave: &Side, master: &Side) -> Option<String> {
    let (s, m) = (&slave.name, &master.name);
    if slave.young > CLEARLY * master.young {
        let (stiff, soft) = (slave.young, master.young);
        Some(format!("`{s}` is the stiffer (Young's modulus {stiff:.4e} against {soft:.4e} of the master)"))
    } else if master.young > CLEARLY * slave.young {
        None
    } else if slave.facet_size > CLEARLY * master.facet_size {
        let (coarse, fine) = (slave.facet_size, master.facet_size);
        Some(format!("`{s}` has the coarser mesh (facets of {coarse:.4e} against {fine:.4e} of the master)"))
    } else if master.facet_size > CLEARLY * slave.facet_size {
        None
    } else if slave.bulge < FLAT && master.bulge > ROUND {
        let shape = if slave.bulge > -FLAT { "flat" } else { "hollow" };
        Some(format!("`{s}` is {shape} and `{m}` bulges, with like meshes and stiffness"))
    } else {
        None
    }
}

/// The same from segment to segment.
fn reason_of_segments(slave: &Side, master: &Side) -> Option<String> {
    let is_part = slave.facet_size > CLEARLY * master.facet_size && slave.bulge < FLAT && master.bulge > ROUND;
    is_part.then(|| {
        format!(
            "`{}`, which does not bulge, has the coarser mesh (facets of {:.4e} against {:.4e} of `{}`, which does)",
            slave.name, slave.facet_size, master.facet_size, master.name
        )
    })
}

/// How many times the facets of one side are longer than those of the other along a direction, and shorter along another, the
/// lesser of both; at most 1 where they are longer or shorter throughout.
fn crossing(one: &Mat3, other: &Mat3) -> f64 {
    /// Of the longest: along the normal of a flat side there is nothing.
    const THIN: f64 = 0.05;
    let all = SymmetricEigen::new(one + other);
    let most = all.eigenvalues.max();
    let along: Vec<Vec3> =
        (0..3).filter(|&k| all.eigenvalues[k] > THIN * most).map(|k| all.eigenvectors.column(k).into()).collect();
    let within = |of: &Mat3| DMatrix::from_fn(along.len(), along.len(), |i, j| along[i].dot(&(of * along[j])));
    let Some(inverse) = within(other).cholesky().and_then(|lower| lower.l().try_inverse()) else { return 1.0 };
    let ratios = SymmetricEigen::new(&inverse * within(one) * inverse.transpose()).eigenvalues;
    ratios.max().min(1.0 / ratios.min()).max(0.0).sqrt()
}

/// The side of a contact between bodies whose materials are all far softer than those of the other, if one is.
pub fn far_softer<'a>(scene: &Scene, contact: &'a scene::Contact) -> Option<&'a str> {
    let sides = [&contact.slave.value, &contact.master.value];
    let [slave, master] = sides.map(|set| young(scene, set));
    match (slave.0 > RIGID * master.1, master.0 > RIGID * slave.1) {
        (true, _) => Some(sides[1]),
        (_, true) => Some(sides[0]),
        _ => None,
    }
}

/// Whether so few nodes of the slave are on the master that nodes of the master go through between them.
fn is_hopeless(slave: &Side, master: &Side) -> bool {
    slave.facet_size > HOPELESS * master.facet_size && master.young < RIGID * slave.young
}

/// What there is to say of the meshes of contacts.
#[derive(Clone, Debug, Default)]
pub struct Guidance {
    pub wrong: Vec<WrongWayRound>,
    /// Of two passes whose facets cross, and of quadratic faces that meet others, in words.
    pub uneven: Vec<String>,
}

/// What there is to say of the meshes of the contacts of a scene between bodies. `sets` has the place of each set in the part's.
/// Collective.
///
/// # Errors
/// A slave that is far too coarse, on all ranks.
pub fn guidance(
    comm: &SimpleCommunicator,
    scene: &Scene,
    part: &Part,
    (sets, is_planar): (&BTreeMap<String, usize>, impl Fn(&str) -> bool),
) -> Result<Guidance> {
    let mut found = Guidance::default();
    let of_section = |(_, material): (usize, &scene::Located<String>)| scene.material(&material.value);
    let moduli: Vec<f64> = scene.sections().map(|s| of_section(s).map_or(0.0, scene::MaterialModel::young)).collect();
    for contact in scene.contacts.iter().filter(|c| c.surface.is_some() && !c.is_self()) {
        let names = [&contact.slave.value, &contact.master.value];
        let facets = names.map(|name| part.pieces(&part.sets[sets[name]].facets));
        let boxes = facets.each_ref().map(|facets| hull(comm, bounds(facets.iter().flat_map(|f| corners(part, f)))));
        let side = |k: usize| {
            let near = boxes[1 - k].map(|(low, high)| grown((low, high), 0.1 * (high - low).norm()));
            let meets = |x: &Vec3| near.is_none_or(|(low, high)| (0..3).all(|d| low[d] <= x[d] && x[d] <= high[d]));
            let (facet_size, bulge, edges) = measure(comm, part, (&facets[k], is_planar(names[k])), meets);
            Side { name: names[k].clone(), young: mean(comm, part, &facets[k], &moduli), facet_size, bulge, edges }
        };
        let (slave, master) = (side(0), side(1));
        let name = &contact.name.value;
        let by_segments = contact.discretization == Discretization::Segment;
        let reason = match contact.discretization {
            Discretization::OnePass if is_hopeless(&slave, &master) => {
                let what = format!(
                    "contact `{name}`: the facets of `{}`, {:.4e} long, are too coarse for those of its master `{}`, {:.4e} long: \
                     nodes of the master would go through between the slave's, which alone are kept out",
                    slave.name, slave.facet_size, master.name, master.facet_size
                );
                let help = "exchange slave and master, use discretization = \"two-pass\", or refine the slave";
                return Err(Error::input(&contact.slave.at, what, help));
            }
            Discretization::OnePass => reason(&slave, &master),
            Discretization::Segment => reason_of_segments(&slave, &master),
            _ => None,
        };
        let is_layer = is_planar(names[0]);
        if contact.discretization == Discretization::TwoPass
            && !is_layer
            && crossing(&slave.edges, &master.edges) > CLEARLY
        {
            found.uneven.push(format!(
                "contact `{name}`: the facets of `{}` are longer than those of `{}` along one direction and shorter along another; \
                 two passes let nodes go there that should press, and force and pressures are off: use discretization = \
                 \"segment\", or meshes that are finer on the same side throughout",
                slave.name, master.name
            ));
        }
        let quadratic = |k: usize| {
            any(comm, facets[k].iter().any(|f| part.quadratic.quarters.of(&f.nodes[..f.count as usize]).is_some()))
        };
        let of_both = [quadratic(0), quadratic(1)];
        if !by_segments && of_both[0] != of_both[1] {
            found.uneven.push(format!(
                "contact `{name}`: quadratic faces meet others between `{}` and `{}`: an even pressure comes out as uneven ones at \
                 the nodes, half as high to half as high again where nodes meet nodes; forces and moments balance: use \
                 discretization = \"segment\", one kind of element on both sides, or a slave of `hex27` twice as fine",
                slave.name, master.name
            ));
        }
        let is_tet10 = |f: &PartFacet| part.quadratic.middles.of(&f.nodes[..f.count as usize]).is_some();
        let mut whole = names.iter().flat_map(|name| part.sets[sets[*name]].facets.iter());
        let may_be_twice = !by_segments && !any(comm, whole.any(is_tet10));
        found.wrong.extend(reason.map(|reason| WrongWayRound {
            contact: name.clone(),
            slave: slave.name,
            master: master.name,
            by_segments,
            may_be_twice,
            reason,
        }));
    }
    Ok(found)
}

/// Facet size, bulge and edges, as of a [`Side`], of the facets, on a layer or not, whose centres meet the other side; of all,
/// where none does. Collective.
fn measure(
    comm: &SimpleCommunicator,
    part: &Part,
    (facets, is_planar): (&[PartFacet], bool),
    meets: impl Fn(&Vec3) -> bool,
) -> (f64, f64, Mat3) {
    let mine = || facets.iter().filter(|f| f.mine).map(|f| (f, center_and_area(part, f)));
    let mut some = [mine().filter(|(_, (x, _))| meets(x)).count() as f64];
    sum(comm, &mut some);
    let all = || mine().filter(|(_, (x, _))| some[0] == 0.0 || meets(x));
    let component = |facet: &PartFacet| part.component[facet.nodes[0] as usize] as usize;
    let mut middles = vec![0.0; 4 * part.components.len()];
    let mut sums = [0.0; 12];
    for (facet, (x, area)) in all() {
        sums[0] += 1.0;
        sums[1] += area.norm();
        sums[2] += part.longest_edge(facet, is_planar);
        let middle = &mut middles[4 * component(facet)..];
        middle[0] += area.norm();
        (0..3).for_each(|d| middle[1 + d] += x[d] * area.norm());
        let corners: Vec<Vec3> = corners(part, facet).collect();
        let count = corners.len();
        for edge in (0..count).map(|k| corners[(k + 1) % count] - corners[k]) {
            (0..9).for_each(|k| sums[3 + k] += edge[k / 3] * edge[k % 3] / count as f64);
        }
    }
    sum(comm, &mut sums);
    sum(comm, &mut middles);
    let mut bulge = [0.0; 2];
    for (facet, (x, area)) in all() {
        let middle = &middles[4 * component(facet)..];
        let middle = Vec3::from_column_slice(&middle[1..4]) / middle[0];
        bulge[0] += (x - middle).dot(&area);
        bulge[1] += (x - middle).norm() * area.norm();
    }
    sum(comm, &mut bulge);
    let size = if is_planar { sums[2] / sums[0] } else { (sums[1] / sums[0]).sqrt() };
    (size, if bulge[1] > 0.0 { bulge[0] / bulge[1] } else { 0.0 }, Mat3::from_row_slice(&sums[3..]) / sums[0])
}

fn corners<'a>(part: &'a Part, facet: &'a PartFacet) -> impl Iterator<Item = Vec3> + 'a {
    facet.nodes[..facet.count as usize].iter().map(|&n| part.points[n as usize])
}

fn center_and_area(part: &Part, facet: &PartFacet) -> (Vec3, Vec3) {
    let at = |k: usize| part.points[facet.nodes[k % facet.count as usize] as usize];
    let center = corners(part, facet).sum::<Vec3>() / f64::from(facet.count);
    (center, 0.5 * (at(2) - at(0)).cross(&(at(3) - at(1))))
}

/// The mean over facets of what belongs to the sections of their nodes. Collective.
fn mean(comm: &SimpleCommunicator, part: &Part, facets: &[PartFacet], of_section: &[f64]) -> f64 {
    let mut sums = [0.0; 2];
    for facet in facets.iter().filter(|facet| facet.mine) {
        let of_node = |&n: &u32| of_section[part.section[n as usize] as usize];
        sums[0] += facet.nodes[..facet.count as usize].iter().map(of_node).fold(f64::INFINITY, f64::min);
        sums[1] += 1.0;
    }
    sum(comm, &mut sums);
    sums[0] / sums[1]
}

/// Least and largest Young's modulus of the materials of the body that a set is on.
fn young(scene: &Scene, set: &str) -> (f64, f64) {
    let sections =
        scene.sections().filter(|(b, _)| set.split('.').next() == Some(scene.bodies[*b].name.value.as_str()));
    let moduli = sections.filter_map(|(_, material)| scene.material(&material.value)).map(scene::MaterialModel::young);
    moduli.fold((f64::INFINITY, 0.0), |(least, most), young| (least.min(young), f64::max(most, young)))
}

#[cfg(test)]
mod tests {
    use super::{CLEARLY, Side, crossing, is_hopeless, reason, reason_of_segments};
    use crate::{Mat3, Vec3};

    #[test]
    fn stiffness_counts_before_meshes_and_meshes_before_bulges() {
        let even = Side { name: "a.top".into(), young: 100.0, facet_size: 1.0, bulge: 0.0, edges: Mat3::identity() };
        let (stiff, coarse) = (Side { young: 121.0, ..even.clone() }, Side { facet_size: 1.21, ..even.clone() });
        let (round, hollow) = (Side { bulge: 0.3, ..even.clone() }, Side { bulge: -0.3, ..even.clone() });
        let stiff_and_fine = Side { facet_size: 0.5, ..stiff.clone() };
        let told = |slave: &Side, master: &Side| reason(slave, master).unwrap_or_default();
        assert_eq!(reason(&even, &Side { young: 119.0, facet_size: 0.9, ..even.clone() }), None);
        assert!(told(&stiff, &even).contains("stiffer (Young's modulus 1.2100e2 against 1.0000e2"));
        assert!(told(&coarse, &even).contains("coarser mesh (facets of 1.2100e0 against 1.0000e0"));
        assert!(told(&even, &round).contains("`a.top` is flat") && told(&hollow, &round).contains("is hollow"));
        for (slave, master) in [(&even, &stiff), (&even, &coarse), (&round, &even), (&round, &hollow), (&even, &even)] {
            assert_eq!(reason(slave, master), None);
        }
        assert!(reason(&even, &stiff_and_fine).is_none() && told(&stiff_and_fine, &coarse).contains("stiffer"));
    }

    #[test]
    fn a_slave_far_coarser_than_its_master_is_refused_unless_that_is_rigid_beside_it() {
        let even = Side { name: "a.top".into(), young: 100.0, facet_size: 1.0, bulge: 0.0, edges: Mat3::identity() };
        let coarse = Side { facet_size: 6.0, ..even.clone() };
        let rigid = Side { young: 2000.0, ..even.clone() };
        assert!(is_hopeless(&coarse, &even) && !is_hopeless(&even, &coarse) && !is_hopeless(&coarse, &rigid));
        assert!(!is_hopeless(&Side { facet_size: 4.0, ..even.clone() }, &even));
    }

    #[test]
    fn segments_mind_a_coarse_flat_slave_under_a_finer_bulge() {
        let even = Side { name: "a.top".into(), young: 100.0, facet_size: 1.0, bulge: 0.0, edges: Mat3::identity() };
        let (coarse, round) = (Side { facet_size: 1.21, ..even.clone() }, Side { bulge: 0.3, ..even.clone() });
        assert!(reason_of_segments(&coarse, &round).is_some_and(|told| told.contains("has the coarser mesh")));
        for (slave, master) in [(&coarse, &even), (&even, &round), (&round, &coarse)] {
            assert_eq!(reason_of_segments(slave, master), None);
        }
    }

    #[test]
    fn facets_cross_where_they_are_longer_one_way_and_shorter_another() {
        let turn = nalgebra::Rotation3::from_scaled_axis(Vec3::new(0.3, -0.7, 0.2)).into_inner();
        let rectangle = |a: f64, b: f64| turn * Mat3::from_diagonal(&Vec3::new(a * a, b * b, 0.0)) * turn.transpose();
        assert!((crossing(&rectangle(1.0, 2.0), &rectangle(1.5, 1.5)) - 4.0 / 3.0).abs() < 1e-12);
        assert!(crossing(&rectangle(1.0, 2.0), &rectangle(2.0, 3.0)) < 1.0);
        assert!((crossing(&rectangle(1.0, 2.0), &rectangle(1.0, 2.0)) - 1.0).abs() < 1e-12);
        let triangle = |diagonal: f64| {
            let edges = [Vec3::x(), Vec3::y(), Vec3::new(1.0, diagonal, 0.0)];
            edges.iter().map(|edge| edge * edge.transpose()).sum::<Mat3>()
        };
        assert!(crossing(&triangle(1.0), &triangle(-1.0)) > CLEARLY && crossing(&triangle(1.0), &triangle(1.0)) < 1.1);
    }
}
