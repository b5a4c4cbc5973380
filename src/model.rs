//! From the scene and its meshes to what is modelled: parts, bodies, tools, contact pairs, each only as far as the scene
//! asks for it.

mod assemble;
pub mod axisymmetric;
mod bodies;
pub mod elements;
mod layers;
pub mod locate;
mod masters;
mod pairs;
pub mod plane_strain;
mod sections;
mod shared;
mod slaves;
pub mod states;
mod symmetry;
pub mod ties;
pub mod tractions;

use crate::Vec3;
use crate::contact::{Avoided, BodySurface, Masters, Pair, Tool, Within, guidance, self_contact};
use crate::controls::Controls;
use crate::error::{Faults, Result};
use crate::mesh::SolidShape;
use crate::output::phases::{Phase, Phases};
use crate::parallel::{agree, first_word, max, number, serve, sum};
use crate::partition::parcels::{bounds, hull};
use crate::partition::{Component, GlobalMesh, Part, PartSet, PartSolid, distribute};
use crate::scene::{self, Discretization, Reduction, Scene};
use crate::solid::element::{hex8, hex27, pyramid5, tet4, tet10, wedge6, wedge18};
use crate::solid::history::History;
use crate::surface::MovingPatch;
pub use assemble::{assemble_bodies, set_names};
pub use masters::{MasterPatches, master_patches, slave_patches};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
pub use sections::Section;
use std::collections::BTreeMap;
pub use symmetry::SymmetryPlane;
use ties::Joint;

/// A deformable body on this rank.
#[derive(Clone, Debug)]
pub struct Body {
    pub name: String,
    pub reduction: Option<Reduction>,
    /// Some of its elements are parts of ones of second order.
    pub has_halves: bool,
    /// Largest diagonal entry of its initial stiffness, force per length; over all ranks.
    pub stiffness: f64,
}

impl Body {
    /// Whether it is one layer of elements, whose two z-planes move as one.
    pub fn is_layer(&self) -> bool {
        self.reduction.is_some()
    }
}

/// What is modelled, on this rank.
pub struct Model {
    pub part: Part,
    /// How the solids of the part have flowed until the last accepted increment.
    pub history: History,
    pub bodies: Vec<Body>,
    /// In the order of [`Scene::sections`].
    pub sections: Vec<Section>,
    pub symmetry: Vec<SymmetryPlane>,
    pub masters: Masters,
    pub pairs: Vec<Pair>,
    /// In the order of the scene's ties.
    pub joints: Vec<Joint>,
    /// A line about each.
    pub joined: Vec<String>,
    /// Two bodies each that lie on each other with nothing between them, of which a warning tells.
    pub told: Vec<[usize; 2]>,
    /// Index of each set of the scene in [`Part::sets`].
    set_index: BTreeMap<String, usize>,
    /// Largest diagonal entry of the initial stiffness, force per length; over all ranks.
    pub stiffness: f64,
    /// Typical size of an element, the cube root of the mean element volume.
    pub size: f64,
    /// Whether bodies in space have few elements across.
    pub is_thin: bool,
    /// What the user should know of the contacts.
    pub warnings: Vec<String>,
    pub controls: Controls,
}

impl Model {
    /// Reads the meshes on rank 0, resolves every name, partitions, and sets up tools and pairs. Collective.
    ///
    /// # Errors
    /// Wrong input, on all ranks alike.
    pub fn new(comm: &SimpleCommunicator, scene: &Scene, phases: &Phases) -> Result<Self> {
        let names = set_names(scene);
        let root = comm.rank() == 0;
        let assemble = || {
            let mut global = assemble_bodies(scene, &names)?;
            axisymmetric::check(scene, &names, &global)?;
            plane_strain::check(scene)?;
            layers::check(scene, &names, &global)?;
            slaves::check(scene, &names, &global)?;
            let united = shared::find(scene, &names, &global)?.unite(&mut global);
            let tied = ties::tie(scene, &names, &mut global)?;
            Ok(Some((global, (united, tied))))
        };
        let read = || agree(comm, if root { assemble() } else { Ok(None) });
        let (global, joined) = phases.time(Phase::Read, read)?.unzip();
        let (united, tied): (Option<shared::United>, _) = joined.unzip();
        let told = serve(comm, |_| united.iter().flat_map(|united| united.told.concat()).collect());
        let said = global.iter().flat_map(|global: &GlobalMesh| &global.warnings);
        let said = said.chain(tied.iter().flat_map(|tied: &ties::Tied| &tied.warnings));
        let found: Vec<String> = said.cloned().collect();
        let found = first_word(comm, (!found.is_empty()).then(|| found.join("\n"))).unwrap_or_default();
        let (part, numbers) = phases.time(Phase::Partition, || distribute(comm, global.as_ref()))?;
        let symmetry = symmetry::planes(comm, scene, &names, &part)?;
        axisymmetric::check_planes(scene, &symmetry)?;
        let joints = ties::deal(comm, scene, &part, (&numbers, &tied));
        let lines = united.zip(tied).map(|(united, tied)| [united.lines, tied.lines].concat().join("\n"));
        let joined = first_word(comm, lines).unwrap_or_default();
        let patches = agree(comm, master_patches(scene, &names, &symmetry, global.as_ref(), &numbers))?;
        let smooth = agree(comm, slave_patches(scene, &names, &symmetry, global.as_ref(), &numbers))?;
        let flat = |patches: Vec<MovingPatch>| patches.iter().flat_map(MovingPatch::to_numbers).collect::<Vec<f64>>();
        let smooth = smooth.into_iter().map(flat).map(|of_pass| serve(comm, |_| of_pass.clone()));
        let smooth: Vec<Vec<MovingPatch>> = smooth.map(|of_pass| MovingPatch::from_numbers(&of_pass)).collect();
        let files = || global.iter().flat_map(|global| &global.files);
        let halves: Vec<bool> = serve(comm, |_| files().map(|file| file.has_halves).collect());
        drop(global);
        let sections = sections::read(comm, scene, &part, &halves)?;
        let body = |(body, &has_halves): (&scene::Body, &bool)| Body {
            name: body.name.value.clone(),
            has_halves,
            reduction: body.reduction.as_ref().map(|asked| asked.value),
            stiffness: 0.0,
        };
        let bodies: Vec<Body> = scene.bodies.iter().zip(&halves).map(body).collect();
        let mut tools = Faults::all(scene.tools.iter().map(|tool| Tool::new(comm, tool, &scene.controls)))?;
        if let Some(all) = hull(comm, bounds(part.points[..part.owned].iter().copied())) {
            tools.iter_mut().for_each(|tool| tool.surface.settle(&all));
        }
        let set_index: BTreeMap<String, usize> = names.iter().enumerate().map(|(k, n)| (n.value.clone(), k)).collect();
        let remembers = |solid: &PartSolid| {
            let section: &Section = &sections[solid.section as usize];
            let is_layer = bodies[solid.body as usize].is_layer();
            (section.points_with_memory(solid.shape, is_layer), section.element.beside(solid.shape).is_enhanced())
        };
        let history = History::new(part.solids.iter().map(remembers));
        let mut model = Self {
            part,
            history,
            bodies,
            sections,
            symmetry,
            masters: Masters { tools, surfaces: Vec::new() },
            pairs: Vec::new(),
            joints,
            joined: joined.lines().map(str::to_string).collect(),
            told: told.as_chunks().0.to_vec(),
            set_index,
            stiffness: 0.0,
            size: 0.0,
            is_thin: false,
            warnings: found.lines().map(str::to_string).collect(),
            controls: scene.controls,
        };
        layers::check_tools(comm, scene, &mut model)?;
        let avoided = model.deal_surfaces(comm, scene, &patches);
        model.measure(comm)?;
        model.stiffen_joints(scene);
        model.pair_up(comm, scene, &avoided, &smooth)?;
        model.turn_slaves(&vec![Vec3::zeros(); model.part.points.len()]);
        let guidance::Guidance { wrong, uneven } = model.guidance(comm, scene)?;
        model.warnings.extend(wrong.iter().map(ToString::to_string).chain(uneven));
        Ok(model)
    }

    /// Deals out the surfaces of bodies that are masters. Gives what slave nodes of each shun. Collective.
    fn deal_surfaces(
        &mut self,
        comm: &SimpleCommunicator,
        scene: &Scene,
        patches: &[MasterPatches],
    ) -> Vec<BTreeMap<u32, Avoided>> {
        let passes = scene.passes();
        let masters = passes.iter().filter_map(|contact| Some((contact, contact.surface?)));
        let mut avoided = Vec::new();
        for ((contact, given), (patches, found)) in masters.zip(patches) {
            let name = contact.master.value.as_str();
            avoided.push(if contact.is_self() { self.shunned(comm, name, found) } else { BTreeMap::new() });
            let size = self.longest_edge(comm, name);
            let mut surface = BodySurface::new(comm, name, given, patches, &self.part.starts, size);
            surface.keeps_past = contact.discretization == Discretization::Segment && contact.friction > 0.0;
            self.masters.surfaces.push(surface);
        }
        avoided
    }

    /// What the corners of this rank's facets of a set shun, of what rank 0 has found. Collective.
    fn shunned(&self, comm: &SimpleCommunicator, set: &str, found: &BTreeMap<u64, Avoided>) -> BTreeMap<u32, Avoided> {
        let numbers = self.part.global_numbers(comm);
        let corners = self.set(set).facets.iter().flat_map(|facet| &facet.nodes[..facet.count as usize]);
        let movers = corners.map(|&n| self.part.tie[n as usize]);
        let mut node_of: BTreeMap<u64, u32> = movers.map(|n| (numbers[n as usize], n)).collect();
        let dealt = self_contact::deal(comm, found, node_of.keys().copied().collect());
        dealt.into_iter().filter_map(|(number, avoided)| Some((node_of.remove(&number)?, avoided))).collect()
    }

    /// Measures how stiff bodies and sections are, and how large elements. Collective.
    ///
    /// # Errors
    /// An element that is inverted.
    fn measure(&mut self, comm: &SimpleCommunicator) -> Result<()> {
        let stiffness = agree(comm, elements::nodal_stiffness(self))?;
        self.size = (self.volume(comm) / self.part.whole.solids as f64).cbrt();
        let mut nodes =
            [self.part.solids.iter().filter(|s| s.mine).map(|s| 1.0 / elements_a_node(s.shape)).sum::<f64>()];
        sum(comm, &mut nodes);
        self.is_thin = !self.is_plane() && nodes[0] < self.part.whole.nodes as f64;
        let mut largest = vec![0.0f64; self.sections.len()];
        for (k, section) in stiffness.iter().zip(&self.part.section) {
            largest[*section as usize] = largest[*section as usize].max(*k);
        }
        max(comm, &mut largest);
        for (section, k) in self.sections.iter_mut().zip(&largest) {
            section.stiffness = *k;
            self.bodies[section.body].stiffness = self.bodies[section.body].stiffness.max(*k);
        }
        self.stiffness = largest.into_iter().fold(0.0, f64::max);
        Ok(())
    }

    /// What there is to say of the meshes of contacts. Collective.
    ///
    /// # Errors
    /// A slave that is far too coarse, on all ranks.
    pub fn guidance(&self, comm: &SimpleCommunicator, scene: &Scene) -> Result<guidance::Guidance> {
        guidance::guidance(comm, scene, &self.part, (&self.set_index, |set| self.is_planar(set)))
    }

    /// The set that the scene calls so.
    pub fn set(&self, name: &str) -> &PartSet {
        &self.part.sets[self.set_index[name]]
    }

    /// The set that the scene calls so, if it refers to it.
    pub fn find_set(&self, name: &str) -> Option<&PartSet> {
        self.set_index.get(name).map(|k| &self.part.sets[*k])
    }

    /// The tool of a name, by its place among the tools.
    pub fn tool_named(&self, name: &str) -> Option<usize> {
        self.masters.tools.iter().position(|tool| tool.name == name)
    }

    /// The master of a pair in words.
    pub fn master_name(&self, pair: &Pair) -> String {
        self.masters.of(pair.master).name()
    }

    /// Volume of all bodies. Collective.
    fn volume(&self, comm: &SimpleCommunicator) -> f64 {
        let mut volume = [0.0];
        for solid in self.part.solids.iter().filter(|s| s.mine) {
            let at = |a: usize| -> [f64; 3] { self.part.points[solid.nodes[a] as usize].into() };
            volume[0] += match solid.shape {
                SolidShape::Tet4 => tet4::volume(&std::array::from_fn(at)),
                SolidShape::Tet10 => tet10::volume(&std::array::from_fn(at)),
                SolidShape::Hex8 => hex8::volume(&std::array::from_fn(at)),
                SolidShape::Wedge6 => wedge6::volume(&std::array::from_fn(at)),
                SolidShape::Pyramid5 => pyramid5::volume(&std::array::from_fn(at)),
                SolidShape::Wedge18 => wedge18::volume(&std::array::from_fn(at)),
                SolidShape::Hex27 => hex27::volume(&std::array::from_fn(at)),
            };
        }
        sum(comm, &mut volume);
        volume[0]
    }

    /// Turns the slave nodes of pairs to where their faces look with nodes displaced by `u`.
    pub fn turn_slaves(&mut self, u: &[Vec3]) {
        let part = &self.part;
        for pair in &mut self.pairs {
            let outward = outward_of(part, pair, |n| part.points[n as usize] + u[n as usize]);
            pair.outward = pair.slaves.iter().map(|slave| outward[slave.node as usize]).collect();
        }
    }

    /// Takes the thickness of sheets that meet themselves as they are with nodes displaced by `u`. Collective.
    pub fn follow_sheets(&mut self, comm: &SimpleCommunicator, u: &[Vec3]) {
        let part = &self.part;
        for Within { sheet, avoided, of_faces, .. } in self.pairs.iter_mut().filter_map(|pair| pair.within.as_mut()) {
            let flat = sheet.fetch(comm, 3, |n, d| part.points[n as usize][d] + u[n as usize][d]);
            let places = flat.as_chunks::<3>().0;
            let place = |n: u64| sheet.index(n).map_or(Vec3::zeros(), |k| Vec3::from(places[k as usize]));
            let all = avoided.iter_mut().chain(of_faces);
            all.for_each(|avoided| avoided.follow(self.controls.self_depth, place));
        }
    }

    /// Longest edge of the facets of a set; on a layer in its plane, for how thick it is says nothing. Collective.
    fn longest_edge(&self, comm: &SimpleCommunicator, set: &str) -> f64 {
        let facets = self.part.pieces(&self.set(set).facets);
        let is_planar = self.is_planar(set);
        let longest = facets.iter().map(|facet| self.part.longest_edge(facet, is_planar));
        let mut longest = [longest.fold(0.0, f64::max)];
        max(comm, &mut longest);
        longest[0]
    }

    /// Whether all bodies are layers.
    pub fn is_plane(&self) -> bool {
        self.bodies.iter().all(Body::is_layer)
    }

    /// Whether meshes are those of planes, sheets or bars, of which factors are cheap.
    pub fn is_flat(&self) -> bool {
        self.is_plane() || self.is_thin
    }

    /// Whether the bodies are axisymmetric: all are, or none.
    pub fn is_axisymmetric(&self) -> bool {
        self.bodies.iter().any(|body| body.reduction == Some(Reduction::Axisymmetric))
    }

    /// Whether a node of this rank is on the axis of its axisymmetric body.
    pub fn is_on_axis(&self, node: usize) -> bool {
        self.is_axisymmetric() && self.part.points[node].x == 0.0
    }

    /// Whether an element is of a layer.
    pub fn is_of_layer(&self, solid: &PartSolid) -> bool {
        self.bodies[solid.body as usize].is_layer()
    }

    /// Whether there is nothing to meet, neither contact nor tool; the same on all ranks.
    pub fn is_alone(&self) -> bool {
        self.pairs.is_empty() && self.masters.tools.is_empty()
    }

    /// A component of a body in words: the body, if it is all of it.
    pub fn component_name(&self, component: usize) -> String {
        let Component { body, is_whole, node, place: x, .. } = &self.part.components[component];
        let name = &self.bodies[*body as usize].name;
        match is_whole {
            true => format!("body `{name}`"),
            false => format!(
                "the part of body `{name}` with node {node} at ({:.6}, {:.6}, {:.6}), which shares no nodes with the rest,",
                x.x, x.y, x.z
            ),
        }
    }

    /// The components of the meshes that ties and shared nodes join, of their slave nodes on this rank. Collective.
    pub fn tied_components(&self, comm: &SimpleCommunicator) -> Vec<(u32, [usize; 2])> {
        let component = |n: u32| self.part.component[n as usize] as usize;
        let mut tied = Vec::new();
        for joint in &self.joints {
            let masters = joint.masters.fetch(comm, 1, |n, _| component(n) as f64);
            for slave in &joint.slaves {
                let most = slave.weights.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
                tied.extend(most.map(|(k, _)| (slave.node, [component(slave.node), masters[*k as usize] as usize])));
            }
        }
        // So are bodies that share nodes.
        let own = (0..self.part.owned as u32).map(|n| (n, [component(n), component(self.part.tie[n as usize])]));
        tied.extend(own.filter(|(_, [own, first])| own != first));
        tied
    }

    /// For each component of the meshes the first of those that ties make one with it. Collective.
    pub fn united(&self, comm: &SimpleCommunicator) -> Vec<usize> {
        let tied = self.tied_components(comm);
        // As negative numbers, of which the largest counts.
        let mut first: Vec<f64> = (0..self.part.components.len()).map(|k| -(k as f64)).collect();
        loop {
            let before = first.clone();
            for (_, [a, b]) in &tied {
                let lowest = first[*a].max(first[*b]);
                (first[*a], first[*b]) = (lowest, lowest);
            }
            max(comm, &mut first);
            if first == before {
                return first.into_iter().map(|k| -k as usize).collect();
            }
        }
    }

    /// Whether some body is elastic-plastic; the same on all ranks.
    pub fn can_flow(&self) -> bool {
        self.sections.iter().any(|section| section.material.remembers())
    }

    /// Whether some of a body is elastic-plastic; the same on all ranks.
    pub fn body_can_flow(&self, body: usize) -> bool {
        self.sections.iter().any(|section| section.body == body && section.material.remembers())
    }

    /// The section of an element.
    pub fn section(&self, solid: &PartSolid) -> &Section {
        &self.sections[solid.section as usize]
    }

    /// Slave nodes of all ranks, for each pair. Collective.
    pub fn slave_counts(&self, comm: &SimpleCommunicator) -> Vec<u64> {
        self.pairs.iter().map(|p| number(comm, p.slaves.len() as u64).1).collect()
    }
}

/// Elements a node below which bodies are thin: sheets of two elements have 2/3 hexahedra a node, ones of three 3/4, of wedges
/// twice as many, of pyramids three times. Of quadratic tetrahedra there are 0.75 a node in large bodies, of quadratic hexahedra
/// an eighth as many as of linear ones, of such wedges twice as many.
fn elements_a_node(shape: SolidShape) -> f64 {
    match shape {
        SolidShape::Hex8 => 0.75,
        SolidShape::Wedge6 => 1.5,
        SolidShape::Pyramid5 => 2.25,
        SolidShape::Tet4 => 3.5,
        SolidShape::Tet10 => 0.5,
        SolidShape::Hex27 => 0.09,
        SolidShape::Wedge18 => 0.18,
    }
}

/// Unit normals of the slave of a pair at its owned nodes, by the areas of the facets around, their mirror images included, with
/// nodes at `place`; zero elsewhere.
pub fn outward_of(part: &Part, pair: &Pair, place: impl Fn(u32) -> Vec3) -> Vec<Vec3> {
    let mut outward = vec![Vec3::zeros(); part.points.len()];
    for facet in part.pieces(&part.sets[pair.side.set].facets).iter() {
        let nodes = &facet.nodes[..facet.count as usize];
        let at = |k: usize| place(nodes[k % nodes.len()]);
        let area = (at(2) - at(0)).cross(&(at(3) - at(1)));
        nodes.iter().for_each(|&n| outward[part.tie[n as usize] as usize] += area);
    }
    for (n, normal) in &pair.mirrored {
        let sum = &mut outward[*n as usize];
        let rest = *sum - normal * normal.dot(sum);
        // What looks across the plane has nothing in it but rounding.
        *sum = if rest.norm() > 1e-6 * sum.norm() { rest } else { Vec3::zeros() };
    }
    outward.iter_mut().for_each(|sum| *sum = sum.try_normalize(f64::MIN_POSITIVE).unwrap_or_default());
    outward
}
