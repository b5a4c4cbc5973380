//! What is decided on the initial mesh: the edges, and the rules of the nodal normals.

use super::{MovingPatch, Neighbour, NormalRule};
use crate::controls::Controls;
use crate::error::{Error, Result};
use crate::mesh::Mesh;
use crate::surface::Smoothing;
use crate::surface::facets::Facets;
use crate::surface::from_mesh::{boundary_nodes, facet_edges};
use crate::surface::normals::ends;
use crate::surface::normals::{Means, Weight, Whole};
use crate::surface::piece::Edge;
use crate::{Mat3, Vec3};

/// Most facets around a node.
const MOST: usize = 64;

/// The patches of a surface mesh, see [`MovingPatch::all`].
pub fn patches(
    mesh: &Mesh,
    numbers: &[u64],
    smoothing: Smoothing,
    feature_angle_deg: f64,
    planes: &[(Vec3, Vec3)],
    controls: &Controls,
) -> Result<Vec<MovingPatch>> {
    let facets = Facets::new(mesh, false)?;
    let on_boundary = boundary_nodes(&facets);
    let whole = Whole::new(mesh, &facets, planes)?;
    let feature_angle = feature_angle_deg.to_radians();
    let means = || Means::new(&whole.facets, Weight::Sine, feature_angle, controls, |_, _| false);
    let means = (smoothing == Smoothing::Nagata).then(means);
    let edges = means.as_ref().map_or_else(|| facet_edges(&facets), |means| means.normals.edges.clone());
    let fans = means.as_ref().map(|means| Fans::new(mesh, &facets, &whole, means)).transpose()?;
    let patch = |f: usize| {
        let mut stencil =
            Stencil { nodes: (0..facets.count(f)).map(|k| facets.node(f, k)).collect(), ..Stencil::default() };
        let corners = std::array::from_fn(|k| match &fans {
            Some(fans) if k < facets.count(f) => stencil.normal(fans, fans.means.fans.of(f, k)),
            _ => 0,
        });
        MovingPatch {
            id: f as u32,
            count: facets.counts[f],
            nodes: stencil.nodes.iter().map(|n| numbers[*n]).collect(),
            edges: std::array::from_fn(|k| facets.across[f][k].map_or(Edge::Boundary, |_| edges[f][k])),
            straight: edges[f].map(|edge| edge == Edge::Sharp),
            on_boundary: std::array::from_fn(|k| on_boundary[facets.node(f, k)]),
            component: 0,
            normals: stencil.rules,
            corners,
            bulge: 1.0,
            quadratic: None,
        }
    };
    Ok((0..facets.nodes.len()).map(patch).collect())
}

/// The fans of a surface with the corners that count in their means, each as its node, the next and the last one.
struct Fans<'a> {
    whole: &'a Whole,
    means: &'a Means,
    corners: Vec<Vec<[usize; 3]>>,
    /// Of each fan the normals of the symmetry planes of its node across which it goes on: not those in which a crease ends it.
    mirrored: Vec<Vec<Vec3>>,
}

impl<'a> Fans<'a> {
    fn new(mesh: &Mesh, facets: &Facets, whole: &'a Whole, means: &'a Means) -> Result<Self> {
        let mut corners = vec![Vec::new(); means.fans.count];
        let mut mirrored: Vec<Vec<Vec3>> = vec![Vec::new(); means.fans.count];
        for (f, k) in whole.facets.corners().filter(|(f, _)| *f >= facets.nodes.len()) {
            let (_, linear) = whole.images[f - facets.nodes.len()];
            let across = whole.across.get(whole.facets.node(f, k)).into_iter().flatten();
            let planes = &mut mirrored[means.fans.of(f, k)];
            for normal in across.filter(|normal| is_reflection(&linear, normal)) {
                if !planes.contains(normal) {
                    planes.push(*normal);
                }
            }
        }
        for (f, k) in facets.corners().filter(|(f, k)| means.counts[*f][*k]) {
            let [next, last] = facets.beside(f, k);
            let fan: &mut Vec<_> = &mut corners[means.fans.of(f, k)];
            fan.push([k, next, last].map(|k| facets.node(f, k)));
            if fan.len() > MOST {
                let (file, facet) = (&mesh.source, mesh.facets[f].id);
                let what = format!("{file}: more than {MOST} facets meet at a node of facet {facet}");
                return Err(Error::input_anywhere(what, "mesh the surface with fewer facets around it"));
            }
        }
        Ok(Self { whole, means, corners, mirrored })
    }
}

impl Fans<'_> {
    /// The projector onto the symmetry planes across which the fan goes on.
    fn within(&self, fan: usize) -> Option<Mat3> {
        let mut within = Mat3::identity();
        for plane in &self.mirrored[fan] {
            // Nothing is left of a plane that the others hold.
            if let Some(across) = (within * plane).try_normalize(1e-6) {
                within -= across * across.transpose();
            }
        }
        (!self.mirrored[fan].is_empty()).then_some(within)
    }

    /// What the normal of a fan at an end of the surface follows, and in how many directions. In a symmetry plane these are
    /// the neighbours in the plane, if there are any: their normals and edges lie in it, and so does what follows.
    fn end(&self, fan: usize) -> Option<(Vec<ends::Neighbour>, u8)> {
        let end = self.means.ends[fan].as_ref()?;
        let Some(within) = self.within(fan) else { return Some((end.neighbours.clone(), end.directions as u8)) };
        let x = self.whole.facets.points[self.corners[fan][0][0]];
        let lies_within = |u: &&ends::Neighbour| {
            let edge = self.whole.facets.points[u.node] - x;
            (edge - within * edge).norm() < 1e-4 * edge.norm()
        };
        let mut neighbours: Vec<_> = end.neighbours.iter().filter(lies_within).copied().collect();
        neighbours.truncate(1);
        for u in &mut neighbours {
            let edge = self.whole.facets.points[u.node] - x;
            u.weights = [1.0 / edge.norm(), 0.0];
        }
        (!neighbours.is_empty()).then_some((neighbours, 1))
    }
}

/// Nodes and normals of a patch, numbered as they come up.
#[derive(Default)]
struct Stencil {
    nodes: Vec<usize>,
    /// Fans of the rules.
    fans: Vec<usize>,
    rules: Vec<NormalRule>,
}

impl Stencil {
    fn node(&mut self, node: usize) -> u32 {
        place(&mut self.nodes, node)
    }

    /// The number of the normal of a fan, after those that it depends on.
    fn normal(&mut self, fans: &Fans, fan: usize) -> u32 {
        if let Some(known) = self.fans.iter().position(|f| *f == fan) {
            return known as u32;
        }
        let node = self.node(fans.corners[fan][0][0]);
        let within = fans.within(fan);
        let rule = match fans.end(fan) {
            None => {
                let (mut spokes, mut corners) = (Vec::new(), Vec::new());
                for [_, next, last] in &fans.corners[fan] {
                    corners.push([next, last].map(|n| place(&mut spokes, self.node(*n))));
                }
                NormalRule::Mean { node, spokes, corners, within }
            }
            Some((end, directions)) => {
                let mut neighbours = Vec::with_capacity(end.len());
                for u in &end {
                    let (node, normal) = (self.node(u.node), self.normal(fans, u.fan));
                    neighbours.push(Neighbour { node, normal, weights: u.weights });
                }
                NormalRule::End { node, neighbours, directions }
            }
        };
        self.fans.push(fan);
        self.rules.push(rule);
        self.rules.len() as u32 - 1
    }
}

/// Whether a map is the reflection in a plane with this unit normal.
fn is_reflection(linear: &Mat3, normal: &Vec3) -> bool {
    (linear - (Mat3::identity() - 2.0 * normal * normal.transpose())).amax() < 1e-6
}

/// The place of `value` in `list`, at its end if it is new.
fn place<T: PartialEq>(list: &mut Vec<T>, value: T) -> u32 {
    let place = list.iter().position(|v| *v == value).unwrap_or_else(|| {
        list.push(value);
        list.len() - 1
    });
    place as u32
}
