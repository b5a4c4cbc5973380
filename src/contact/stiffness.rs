//! How stiffly a body resists a contact force at a node of its surface: the unit of penalties.
//!
//! A force on a node pushes material aside; that is resisted by shear. On the half-space a pressed patch of size L has the
//! stiffness E* L with E* = E / (1 - ν²) = 2 G / (1 - ν) (Johnson, Contact Mechanics, 1985, section 3.2), which stays finite
//! as ν approaches 1/2. The diagonal of the stiffness matrix has the bulk modulus, and on flat elements the length over the
//! thickness; multiples of those make nodes overshoot the friction cone. A sheet that is thinner than its facets are long
//! gives way in its plane, and is as much softer as it is thinner:
//!
//!   k = E* L min(1, t / h),   L = A / h,
//!
//! with the area A that belongs to the node, the longest edge h of the facets around it, and the height t of the elements
//! under them. In a layer edges are those in the plane, and L is its thickness; of an axisymmetric body A is the area of the ring,
//! and L its circumference.

use crate::mesh::SolidShape;
use crate::partition::{Part, PartFacet, PartSolid};
use crate::scene::Reduction;
use crate::solid::element::{hex8, hex27, pyramid5, tet4, tet10, wedge6, wedge18};
use crate::solid::load;

/// What a body is made of, as far as contact feels it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Backing {
    /// E*, force per area.
    pub modulus: f64,
    /// In a layer nothing happens along z.
    pub reduction: Option<Reduction>,
}

/// The surface around a node.
#[derive(Clone, Copy, Debug)]
struct Around {
    longest: f64,
    height: f64,
    /// Sum of modulus times area, force.
    borne: f64,
}

/// Stiffness of each owned node of the facets of a surface, force per length; `backing` is by section. 0 for other nodes;
/// tied nodes count for the node that they follow.
pub fn contact_stiffness(part: &Part, facets: &[PartFacet], backing: &[Backing]) -> Vec<f64> {
    let nothing = Around { longest: 0.0, height: f64::INFINITY, borne: 0.0 };
    let mut around = vec![nothing; part.points.len()];
    let solids = solids_by_node(part, facets);
    for facet in facets {
        let nodes = &facet.nodes[..facet.count as usize];
        let areas = nodal_areas(part, facet, false);
        let under = nodes.iter().find_map(|&n| {
            let has_all = |e: &&u32| nodes.iter().all(|n| part.solids[**e as usize].nodes().contains(n));
            solids[n as usize].iter().find(has_all)
        });
        let under = under.map(|&e| &part.solids[e as usize]);
        let section = under.map_or(part.section[nodes[0] as usize], |solid| solid.section);
        let Backing { modulus, reduction } = backing[section as usize];
        let longest = part.longest_edge(facet, reduction.is_some());
        let height = under.map_or(f64::INFINITY, |solid| height(part, solid, facet, areas.iter().sum()));
        let is_ring = reduction == Some(Reduction::Axisymmetric);
        for (&n, area) in nodes.iter().zip(nodal_areas(part, facet, is_ring)) {
            let at = &mut around[part.tie[n as usize] as usize];
            (at.longest, at.height) = (at.longest.max(longest), at.height.min(height));
            at.borne += modulus * area;
        }
    }
    around.truncate(part.owned);
    let of = |a: &Around| match a.longest {
        0.0 => 0.0,
        longest => a.borne / longest * (a.height / longest).min(1.0),
    };
    around.iter().map(of).collect()
}

/// The elements at each node of some facets.
fn solids_by_node(part: &Part, facets: &[PartFacet]) -> Vec<Vec<u32>> {
    let mut of_facets = vec![false; part.points.len()];
    facets.iter().flat_map(|f| &f.nodes[..f.count as usize]).for_each(|&n| of_facets[n as usize] = true);
    let mut solids = vec![Vec::new(); part.points.len()];
    for (e, solid) in part.solids.iter().enumerate() {
        solid.nodes().iter().filter(|n| of_facets[**n as usize]).for_each(|&n| solids[n as usize].push(e as u32));
    }
    solids
}

fn nodal_areas(part: &Part, facet: &PartFacet, is_ring: bool) -> Vec<f64> {
    let at = |a: usize| -> [f64; 3] { part.points[facet.nodes[a] as usize].into() };
    match facet.count {
        3 => load::tri3_nodal_areas(&std::array::from_fn(at)).to_vec(),
        _ if is_ring => load::ring_nodal_areas(&std::array::from_fn(at)).to_vec(),
        _ => load::quad4_nodal_areas(&std::array::from_fn(at)).to_vec(),
    }
}

/// Height of an element over a face of this area.
fn height(part: &Part, solid: &PartSolid, facet: &PartFacet, face: f64) -> f64 {
    let at = |a: usize| -> [f64; 3] { part.points[solid.nodes[a] as usize].into() };
    match solid.shape {
        SolidShape::Tet4 => 3.0 * tet4::volume(&std::array::from_fn(at)) / face,
        // Its facets are quarters of its faces, as those of quadratic hexahedra.
        SolidShape::Tet10 => 3.0 * tet10::volume(&std::array::from_fn(at)) / (4.0 * face),
        SolidShape::Hex8 => hex8::volume(&std::array::from_fn(at)) / face,
        SolidShape::Hex27 => hex27::volume(&std::array::from_fn(at)) / (4.0 * face),
        // To the apex over its base, to the edge across over a triangle.
        SolidShape::Pyramid5 => 1.5 * f64::from(facet.count - 2) * pyramid5::volume(&std::array::from_fn(at)) / face,
        SolidShape::Wedge18 => f64::from(facet.count - 2) * wedge18::volume(&std::array::from_fn(at)) / (4.0 * face),
        // Over a triangle it is a prism, over a quadrilateral a roof.
        SolidShape::Wedge6 => f64::from(facet.count - 2) * wedge6::volume(&std::array::from_fn(at)) / face,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;

    /// One brick a x b x c with its upper face.
    fn brick([a, b, c]: [f64; 3]) -> (Part, Vec<PartFacet>) {
        let corner =
            |k: usize| Vec3::new(a * [0.0, 1.0, 1.0, 0.0][k % 4], b * [0.0, 0.0, 1.0, 1.0][k % 4], c * (k / 4) as f64);
        let solid = PartSolid {
            shape: SolidShape::Hex8,
            nodes: std::array::from_fn(|a| if a < 8 { a as u32 } else { 0 }),
            body: 0,
            section: 0,
            id: 1,
            number: 0,
            mine: true,
        };
        let part = Part {
            owned: 8,
            points: (0..8).map(corner).collect(),
            body: vec![0; 8],
            section: vec![0; 8],
            tie: (0..8).collect(),
            solids: vec![solid],
            ..Part::default()
        };
        (part, vec![PartFacet { count: 4, nodes: [4, 5, 6, 7], number: 0, mine: true }])
    }

    #[test]
    fn a_quarter_of_a_facet_belongs_to_a_corner() {
        let backing = |reduction| [Backing { modulus: 10.0, reduction }];
        let of = |size, reduction| {
            let (part, facets) = brick(size);
            contact_stiffness(&part, &facets, &backing(reduction))
        };
        // A cube; a long facet presses like a line; a sheet is softer as it is thinner.
        let is = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found} is not {expected}");
        is(of([2.0, 2.0, 2.0], None)[4], 10.0 * 0.5);
        is(of([2.0, 8.0, 9.0], None)[6], 10.0 * 0.5);
        is(of([2.0, 2.0, 0.02], None)[4], 10.0 * 0.5 * 0.01);
        assert_eq!(of([2.0, 2.0, 2.0], None)[0], 0.0);
        // Along x there is 2; along z, in the thickness of a layer, 0.25.
        let (mut part, _) = brick([2.0, 2.0, 0.25]);
        part.tie = vec![0, 1, 2, 3, 0, 1, 2, 3];
        let front = [PartFacet { count: 4, nodes: [0, 1, 5, 4], number: 0, mine: true }];
        is(contact_stiffness(&part, &front, &backing(Some(Reduction::PlaneStrain)))[0], 10.0 * 0.125);
        // Of the disc with the radius 2 a third belongs to the middle.
        let disc = 2.0 * std::f64::consts::PI / 3.0 * 2.0;
        is(contact_stiffness(&part, &front, &backing(Some(Reduction::Axisymmetric)))[0], 10.0 * disc / 2.0 * 0.5 * 2.0);
    }
}
