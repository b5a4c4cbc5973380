//! From the scene and its meshes to what is modelled: parts, bodies, tools, contact pairs, each only as far as the scene
//! asks for it.

pub mod axisymmetric;
mod bodies;
pub mod elements;
pub mod locate;
mod sections;
mod shared;
pub mod states;
mod symmetry;
pub mod ties;
pub mod tractions;

use crate::Vec3;
use crate::contact::stiffness::{Backing, contact_stiffness};
use crate::contact::{
    Avoided, BodySurface, Faces, Master, Masters, Meets, Pair, Slave, Tool, guidance, mates, self_contact,
};
use crate::controls::Controls;
use crate::error::{Error, Faults, Result};
use crate::mesh::{Facet, Mesh, SolidShape, join};
use crate::output::phases::{Phase, Phases};
use crate::parallel::{agree, first_word, max, number, sum};
use crate::partition::{Gather, GlobalFacet, GlobalMesh, GlobalSet, Part, PartSet, PartSolid, distribute};
use crate::scene::{self, Discretization, Enforcement, Formulation, Located, Reduction, Scene, body_of, did_you_mean};
use crate::solid::element::{hex8, hex8_shell, plane4, tet4, tet10, wedge6};
use crate::solid::history::History;
use crate::solid::material::Material;
use crate::surface::{MovingPatch, Smoothing};
use bodies::Meshed;
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use sections::Sections;
use std::collections::{BTreeMap, BTreeSet};
pub use symmetry::SymmetryPlane;
use ties::Joint;

/// A deformable body on this rank.
#[derive(Clone, Debug)]
pub struct Body {
    pub name: String,
    pub reduction: Option<Reduction>,
    /// Largest diagonal entry of its initial stiffness, force per length; over all ranks.
    pub stiffness: f64,
}

/// Elements of a body that are of one material.
#[derive(Clone, Debug)]
pub struct Section {
    pub body: usize,
    pub material: Material,
    /// Of the first of the shapes that it has; others have what goes with it, [`Formulation::beside`].
    pub element: Formulation,
    /// Wedges fill in between hexahedra.
    pub is_filled: bool,
    /// Points through the thickness of solid-shell elements.
    pub layers: usize,
    /// As of bodies, at the nodes that count as the section's.
    pub stiffness: f64,
}

impl Body {
    /// Whether it is one layer of elements, whose two z-planes move as one.
    pub fn is_layer(&self) -> bool {
        self.reduction.is_some()
    }
}

impl Section {
    /// Integration points of an element of the section that have states.
    fn points_with_memory(&self, shape: SolidShape, is_layer: bool) -> usize {
        match shape {
            _ if !self.material.remembers() => 0,
            _ if is_layer => plane4::POINTS,
            SolidShape::Hex8 if self.element == Formulation::Hex8Shell => hex8_shell::POINTS * self.layers,
            SolidShape::Hex8 => hex8::POINTS,
            SolidShape::Wedge6 => wedge6::POINTS,
            SolidShape::Tet4 => tet4::POINTS,
            SolidShape::Tet10 => tet10::POINTS,
        }
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
    /// Index of each set of the scene in [`Part::sets`].
    set_index: BTreeMap<String, usize>,
    /// Largest diagonal entry of the initial stiffness, force per length; over all ranks.
    pub stiffness: f64,
    /// Typical size of an element, the cube root of the mean element volume.
    pub size: f64,
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
            let tied = ties::tie(scene, &names, &mut global)?;
            Ok(Some((global, tied)))
        };
        let read = || agree(comm, if root { assemble() } else { Ok(None) });
        let (global, tied) = phases.time(Phase::Read, read)?.unzip();
        let found = global.as_ref().map_or(Ok(Vec::new()), |global| {
            let mut found = global.warnings.clone();
            found.extend(tied.iter().flat_map(|tied: &ties::Tied| tied.warnings.clone()));
            found.extend(shared::check(scene, &names, global)?);
            Ok(found)
        });
        let found = agree(comm, found)?;
        let found = first_word(comm, (!found.is_empty()).then(|| found.join("\n"))).unwrap_or_default();
        let (part, numbers) = phases.time(Phase::Partition, || distribute(comm, global.as_ref()))?;
        let symmetry = symmetry::planes(comm, scene, &names, &part)?;
        axisymmetric::check_planes(scene, &symmetry)?;
        let joints = ties::deal(comm, scene, &part, (&numbers, &tied));
        let joined = first_word(comm, tied.map(|tied| tied.lines.join("\n"))).unwrap_or_default();
        let patches = agree(comm, master_patches(scene, &names, &symmetry, global.as_ref(), &numbers))?;
        drop(global);
        let elements = element_kinds(comm, scene, &part)?;
        let mut sections = Vec::new();
        for ((body, name), (element, is_filled)) in scene.sections().zip(elements) {
            let card = scene.material(&name.value);
            let card = card.ok_or_else(|| Error::input(&name.at, "no such material", ""))?;
            let material = Material::new(card);
            let layers = scene.bodies[body].shell.points.unwrap_or_else(|| hex8_shell::usual_layers(&material));
            sections.push(Section { body, material, element, is_filled, layers, stiffness: 0.0 });
        }
        let body = |body: &scene::Body| Body {
            name: body.name.value.clone(),
            reduction: body.reduction.as_ref().map(|asked| asked.value),
            stiffness: 0.0,
        };
        let bodies: Vec<Body> = scene.bodies.iter().map(body).collect();
        let tools = Faults::all(scene.tools.iter().map(|tool| Tool::new(comm, tool, &scene.controls)))?;
        let set_index: BTreeMap<String, usize> = names.iter().enumerate().map(|(k, n)| (n.value.clone(), k)).collect();
        let pairs = Vec::new();
        let warnings = Vec::new();
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
            pairs,
            joints,
            joined: joined.lines().map(str::to_string).collect(),
            set_index,
            stiffness: 0.0,
            size: 0.0,
            warnings,
            controls: scene.controls,
        };
        axisymmetric::check_tools(comm, scene, &model)?;
        let passes = scene.passes();
        let masters = passes.iter().filter_map(|c| c.surface.map(|given| (c.master.value.as_str(), given)));
        let mut avoided = Vec::new();
        for ((name, given), (patches, found)) in masters.zip(&patches) {
            avoided.push(self_contact::deal(comm, found, &model.part.starts));
            let size = model.longest_edge(comm, name);
            model.masters.surfaces.push(BodySurface::new(comm, name, given, patches, &model.part.starts, size));
        }
        let of_surfaces = passes.iter().filter(|contact| contact.surface.is_some());
        for (surface, contact) in model.masters.surfaces.iter_mut().zip(of_surfaces) {
            surface.keeps_past = contact.discretization == Discretization::Segment && contact.friction > 0.0;
        }
        let stiffness = agree(comm, elements::nodal_stiffness(&model))?;
        let volume = model.volume(comm);
        model.size = (volume / model.part.total_solids as f64).cbrt();
        let mut largest = vec![0.0f64; model.sections.len()];
        for (k, section) in stiffness.iter().zip(&model.part.section) {
            largest[*section as usize] = largest[*section as usize].max(*k);
        }
        max(comm, &mut largest);
        for (section, k) in model.sections.iter_mut().zip(&largest) {
            section.stiffness = *k;
            model.bodies[section.body].stiffness = model.bodies[section.body].stiffness.max(*k);
        }
        model.stiffness = largest.into_iter().fold(0.0, f64::max);
        model.stiffen_joints(scene);
        for contact in &passes {
            let pair = model.pair(comm, scene, contact, &avoided);
            model.pairs.push(pair);
        }
        model.join_passes(&passes);
        model.check_joints(comm, scene)?;
        model.tell_repeats();
        model.find_mates(comm, scene)?;
        model.turn_slaves(&vec![Vec3::zeros(); model.part.points.len()]);
        model.warnings = found.lines().map(str::to_string).collect();
        model.warnings.extend(model.wrong_way_round(comm, scene)?.iter().map(ToString::to_string));
        Ok(model)
    }

    /// Contacts whose slave should rather be the master. Collective.
    ///
    /// # Errors
    /// A slave that is far too coarse, on all ranks.
    pub fn wrong_way_round(&self, comm: &SimpleCommunicator, scene: &Scene) -> Result<Vec<guidance::WrongWayRound>> {
        guidance::wrong_way_round(comm, scene, &self.part, &self.set_index)
    }

    /// The set that the scene calls so.
    pub fn set(&self, name: &str) -> &PartSet {
        &self.part.sets[self.set_index[name]]
    }

    /// The set that the scene calls so, if it refers to it.
    pub fn find_set(&self, name: &str) -> Option<&PartSet> {
        self.set_index.get(name).map(|k| &self.part.sets[*k])
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
            };
        }
        sum(comm, &mut volume);
        volume[0]
    }

    /// The slave nodes of a contact on this rank.
    fn pair(
        &self,
        comm: &SimpleCommunicator,
        scene: &Scene,
        contact: &scene::Contact,
        avoided: &[BTreeMap<u32, Avoided>],
    ) -> Pair {
        let set = self.set(&contact.slave.value);
        let (mut master, mut planar, mut softest) = (Master::Tool(0), false, f64::INFINITY);
        let within_body = body_of(&contact.slave.value) == body_of(&contact.master.value);
        if contact.surface.is_some() {
            let surface = self.pairs.iter().filter(|p| p.master.surface().is_some()).count();
            let meets = match contact.discretization {
                Discretization::NodeToNode => Meets::Nodes,
                _ if contact.is_self() => Meets::Own,
                _ => Meets::Faces,
            };
            master = Master::Surface(surface, meets);
            planar = [&contact.slave, &contact.master].iter().all(|set| self.is_planar(&set.value));
            softest = self.mean_stiffness(comm, &contact.master.value);
        } else if let Some(tool) = scene.tools.iter().position(|t| t.name.value == contact.master.value) {
            master = Master::Tool(tool);
        }
        let mut nodes: Vec<u32> = set.nodes.iter().map(|&n| self.part.tie[n as usize]).collect();
        nodes.sort_unstable();
        nodes.dedup();
        if within_body && !contact.is_self() {
            // A node on both sides would meet itself.
            nodes.retain(|n| self.set(&contact.master.value).nodes.binary_search(n).is_err());
        }
        // What is tied to the master neither opens nor slides.
        let index = |set: &str| self.bodies.iter().position(|b| b.name == body_of(set));
        if let (Some(own), Some(other)) = (index(&contact.slave.value), index(&contact.master.value)) {
            for joint in &self.joints {
                let tied = joint.nodes_between(own, other);
                nodes.retain(|n| tied.binary_search(n).is_err());
            }
        }
        let mut shunned = Vec::new();
        if let Master::Surface(k, Meets::Own) = master {
            let of_node = |n: &u32| avoided[k].get(n).cloned().unwrap_or_default();
            let depth = |avoided: Avoided| match contact.thickness {
                Some(thickness) => avoided.with_thickness(thickness, self.controls.self_depth),
                None => avoided,
            };
            shunned = nodes.iter().map(of_node).map(depth).collect();
        }
        let stiffness = self.contact_stiffness(set);
        let slaves = nodes
            .into_iter()
            .map(|n| {
                let stiffness = stiffness[n as usize].min(softest);
                Slave::new(n, contact.friction, self.controls.augmentation * stiffness)
            })
            .collect();
        let slaves: Vec<Slave> = slaves;
        let by_faces = contact.discretization == Discretization::Segment;
        let faces = by_faces.then(|| Faces::new(&self.part, &set.facets, &slaves, self.is_axisymmetric()));
        let facet_size = self.longest_edge(comm, &contact.slave.value);
        // Multipliers that are the force know no penalty; it would only scale their equations out of sight.
        let penalty = contact.penalty.filter(|_| contact.method != Enforcement::Lagrange);
        let mut pair = Pair {
            name: contact.name.value.clone(),
            master,
            body: index(&contact.slave.value).unwrap_or_default(),
            master_body: index(&contact.master.value).filter(|_| contact.surface.is_some()),
            sections: self.sections_of(comm, set),
            master_sections: match contact.surface {
                Some(_) => self.sections_of(comm, self.set(&contact.master.value)),
                None => Vec::new(),
            },
            planar,
            friction: contact.friction,
            tangent: contact.tangent,
            method: contact.method,
            asked: (contact.method, penalty),
            tolerance: contact.tolerance,
            set: self.set_index[&contact.slave.value],
            slaves,
            faces,
            reach: contact.reach.unwrap_or(self.controls.reach_facets * facet_size),
            facet_size,
            within_body,
            facing: -self.controls.self_facing.to_radians().cos(),
            controls: self.controls,
            outward: Vec::new(),
            other: None,
            is_second: false,
            sheet: Gather::new(comm, &self.part.starts, shunned.iter().flat_map(Avoided::depends_on)),
            avoided: shunned,
        };
        pair.enforce(contact.method);
        pair
    }

    /// Tells the slave nodes of ties how stiff their bodies are there.
    fn stiffen_joints(&mut self, scene: &Scene) {
        for (k, tie) in scene.ties.iter().enumerate() {
            let stiffness = self.contact_stiffness(self.set(&tie.slave.value));
            self.joints[k].slaves.iter_mut().for_each(|slave| slave.stiffness = stiffness[slave.node as usize]);
        }
    }

    /// Refuses slave nodes of ties that contacts with multipliers hold, too. Collective.
    fn check_joints(&self, comm: &SimpleCommunicator, scene: &Scene) -> Result<()> {
        for (joint, tie) in self.joints.iter().zip(&scene.ties) {
            for pair in self.pairs.iter().filter(|pair| pair.width() > 0) {
                let is_slave = |n: &u32| pair.slaves.binary_search_by_key(n, |s| s.node).is_ok();
                let both = joint.slaves.iter().map(|slave| slave.node).find(is_slave);
                let told = both.map(|node| {
                    let (x, id) = (self.part.points[node as usize], self.part.id[node as usize]);
                    let what = format!(
                        "tie `{}`: its slave node {id} at ({:.6}, {:.6}, {:.6}) is one of contact `{}`, too, which would hold \
                         it twice",
                        joint.name, x.x, x.y, x.z, pair.name
                    );
                    let help = "exchange `slave` and `master` of the tie, or leave the node out of the contact";
                    Error::input(&tie.slave.at, what, help)
                });
                agree(comm, told.map_or(Ok(()), Err))?;
            }
        }
        Ok(())
    }

    /// Tells slave nodes that others of their surface may make the same constraint.
    fn tell_repeats(&mut self) {
        let own = self.pairs.iter_mut().filter(|pair| pair.is_self() && pair.width() > 0);
        own.flat_map(|pair| &mut pair.slaves).for_each(|slave| slave.repeats = true);
    }

    /// Lets the two passes of a contact know of each other.
    fn join_passes(&mut self, passes: &[scene::Contact]) {
        for (second, pass) in passes.iter().enumerate() {
            if let Some(first) = pass.second_of {
                self.pairs[second].is_second = true;
                self.pairs[second].other = Some(first);
                self.pairs[first].other = Some(second);
            }
        }
    }

    /// Pairs the nodes of contacts from node to node where they stand. Collective.
    fn find_mates(&mut self, comm: &SimpleCommunicator, scene: &Scene) -> Result<()> {
        let Self { part, masters, pairs, .. } = self;
        let place = |n: u32| part.points[n as usize];
        masters.follow(comm, pairs, place);
        for pair in pairs.iter_mut() {
            let (Master::Surface(k, Meets::Nodes), Some(contact)) =
                (pair.master, scene.contacts.iter().find(|c| c.name.value == pair.name))
            else {
                continue;
            };
            let lonely = mates::find(&mut pair.slaves, &masters.surfaces[k], place).err();
            let told = lonely.map(|(node, distance)| {
                let (x, id) = (place(node), part.id[node as usize]);
                let what = format!(
                    "node {id} of `{}` at ({:.6}, {:.6}, {:.6}) has no node of `{}` at its place: {distance}",
                    contact.slave.value, x.x, x.y, x.z, contact.master.value
                );
                Error::input(&contact.slave.at, what, "mesh both sides alike, or use another `discretization`")
            });
            agree(comm, told.map_or(Ok(()), Err))?;
        }
        Ok(())
    }

    /// Turns the slave nodes of pairs within a body to where their faces look with nodes displaced by `u`.
    pub fn turn_slaves(&mut self, u: &[Vec3]) {
        for pair in self.pairs.iter_mut().filter(|p| p.within_body) {
            let mut outward = vec![Vec3::zeros(); self.part.points.len()];
            for facet in self.part.pieces(&self.part.sets[pair.set].facets).iter() {
                let nodes = &facet.nodes[..facet.count as usize];
                let at = |k: usize| {
                    let n = nodes[k % nodes.len()] as usize;
                    self.part.points[n] + u[n]
                };
                let area = (at(2) - at(0)).cross(&(at(3) - at(1)));
                nodes.iter().for_each(|&n| outward[self.part.tie[n as usize] as usize] += area);
            }
            let unit = |s: &Slave| outward[s.node as usize].try_normalize(f64::MIN_POSITIVE).unwrap_or_default();
            pair.outward = pair.slaves.iter().map(unit).collect();
        }
    }

    /// Takes the thickness of sheets that meet themselves as they are with nodes displaced by `u`. Collective.
    pub fn follow_sheets(&mut self, comm: &SimpleCommunicator, u: &[Vec3]) {
        let part = &self.part;
        for pair in self.pairs.iter_mut().filter(|p| p.within_body) {
            let flat = pair.sheet.fetch(comm, 3, |n, d| part.points[n as usize][d] + u[n as usize][d]);
            let places = flat.as_chunks::<3>().0;
            let place = |n: u64| pair.sheet.index(n).map_or(Vec3::zeros(), |k| Vec3::from(places[k as usize]));
            pair.avoided.iter_mut().for_each(|avoided| avoided.follow(self.controls.self_depth, place));
        }
    }

    /// Longest edge of the facets of a set. Collective.
    fn longest_edge(&self, comm: &SimpleCommunicator, set: &str) -> f64 {
        let mut longest = [0.0f64];
        for facet in self.part.pieces(&self.set(set).facets).iter() {
            let corners = &facet.nodes[..facet.count as usize];
            let at = |k: usize| self.part.points[corners[k % corners.len()] as usize];
            for k in 0..corners.len() {
                longest[0] = longest[0].max((at(k + 1) - at(k)).norm());
            }
        }
        max(comm, &mut longest);
        longest[0]
    }

    /// Whether all bodies are layers.
    pub fn is_plane(&self) -> bool {
        self.bodies.iter().all(Body::is_layer)
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

    /// Whether a set is on a layer.
    fn is_planar(&self, set: &str) -> bool {
        self.bodies.iter().any(|b| b.name == body_of(set) && b.is_layer())
    }

    /// Stiffness against contact forces of the owned nodes of a set.
    fn contact_stiffness(&self, set: &PartSet) -> Vec<f64> {
        let of = |section: &Section| Backing {
            modulus: section.material.indentation_modulus(),
            reduction: self.bodies[section.body].reduction,
        };
        let backing: Vec<Backing> = self.sections.iter().map(of).collect();
        contact_stiffness(&self.part, &self.part.pieces(&set.facets), &backing)
    }

    /// Its mean over the nodes of a set that have any. Collective.
    fn mean_stiffness(&self, comm: &SimpleCommunicator, set: &str) -> f64 {
        let mut sums = [0.0; 2];
        for k in self.contact_stiffness(self.set(set)) {
            sums[0] += k;
            sums[1] += f64::from(k > 0.0);
        }
        sum(comm, &mut sums);
        sums[0] / sums[1]
    }

    /// Whether there is nothing to meet, neither contact nor tool; the same on all ranks.
    pub fn is_alone(&self) -> bool {
        self.pairs.is_empty() && self.masters.tools.is_empty()
    }

    /// For each body the first of those that ties make one with it.
    pub fn united(&self) -> Vec<usize> {
        let mut first: Vec<usize> = (0..self.bodies.len()).collect();
        for joint in &self.joints {
            let [a, b] = joint.bodies.map(|body| first[body]);
            first.iter_mut().filter(|body| **body == a.max(b)).for_each(|body| *body = a.min(b));
        }
        first
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

    /// The sections that owned nodes of a set count as, on all ranks. Collective.
    fn sections_of(&self, comm: &SimpleCommunicator, set: &PartSet) -> Vec<usize> {
        let mut has = vec![0.0; self.sections.len()];
        set.nodes.iter().for_each(|&n| has[self.part.section[n as usize] as usize] = 1.0);
        max(comm, &mut has);
        (0..has.len()).filter(|&section| has[section] > 0.0).collect()
    }

    /// Slave nodes of all ranks, for each pair. Collective.
    pub fn slave_counts(&self, comm: &SimpleCommunicator) -> Vec<u64> {
        self.pairs.iter().map(|p| number(comm, p.slaves.len() as u64).1).collect()
    }
}

/// Every set that the scene names, in the order in which they are first named.
pub fn set_names(scene: &Scene) -> Vec<Located<String>> {
    let tools: Vec<&str> = scene.tools.iter().map(|t| t.name.value.as_str()).collect();
    let mut names: Vec<Located<String>> = Vec::new();
    let mut add = |name: &Located<String>| {
        if !tools.contains(&name.value.as_str()) && !names.iter().any(|n| n.value == name.value) {
            names.push(name.clone());
        }
    };
    scene.bodies.iter().flat_map(|b| &b.symmetry).for_each(&mut add);
    scene.contacts.iter().for_each(|c| add(&c.slave));
    scene.contacts.iter().for_each(|c| add(&c.master));
    scene.ties.iter().flat_map(|tie| [&tie.slave, &tie.master]).for_each(&mut add);
    for step in &scene.steps {
        step.fix.iter().for_each(|c| add(&c.set));
        step.moves.iter().for_each(|c| add(&c.target));
        step.forces.iter().for_each(|c| add(&c.target));
        step.pressures.iter().for_each(|c| add(&c.set));
        step.springs.iter().for_each(|c| add(&c.set));
        step.dashpots.iter().for_each(|c| add(&c.set));
    }
    scene.output.history.iter().for_each(&mut add);
    let probed = scene.output.probes.iter().filter_map(|probe| match &probe.place {
        scene::ProbePlace::Set(set) => Some(set),
        _ => None,
    });
    probed.for_each(add);
    names
}

/// Reads all bodies into one numbering and resolves the sets.
///
/// # Errors
/// Meshes that cannot be read, or have not what the scene names.
pub fn assemble_bodies(scene: &Scene, names: &[Located<String>]) -> Result<GlobalMesh> {
    let mut global = GlobalMesh { sets: vec![GlobalSet::default(); names.len()], ..GlobalMesh::default() };
    let (mut first_section, mut faults) = (0, Faults::default());
    for (index, (body, Meshed { mut mesh, mut ties, last })) in
        scene.bodies.iter().zip(bodies::load(scene)?).enumerate()
    {
        let (offset, sections) = (global.points.len() as u32, Sections::new(scene, body, &mesh)?);
        global.last_id.push(last);
        for (set, name) in global.sets.iter_mut().zip(names) {
            let found = resolve(&body.name.value, &mesh, name);
            faults.note(&found);
            if let Ok(Some(found)) = found {
                *set = shifted(found, offset);
            }
        }
        global.middles.join(mesh.middles.renumbered(|n| Some(n + offset)));
        global.parts.push(mesh.groups.values().filter(|group| !group.solids.is_empty()).count());
        global.warnings.extend(mesh.warnings.iter().map(|told| format!("body `{}`: {told}", body.name.value)));
        ties.iter_mut().for_each(|tie| *tie += offset);
        mesh.solids.iter_mut().flat_map(|solid| &mut solid.nodes).for_each(|n| *n += offset);
        global.section.extend(sections.nodes.iter().map(|section| first_section + section));
        global.solid_section.extend(sections.solids.iter().map(|section| first_section + section));
        first_section += body.sections().count() as u32;
        global.body.extend(std::iter::repeat_n(index as u32, mesh.points.len()));
        global.solid_body.extend(std::iter::repeat_n(index as u32, mesh.solids.len()));
        join(&mut global.tie, ties);
        join(&mut global.points, mesh.points.into_iter().map(Vec3::from).collect());
        join(&mut global.id, mesh.point_ids);
        join(&mut global.solids, mesh.solids);
    }
    faults.finish()?;
    refuse_quadratic_sides(scene, &global)?;
    global.node_work = vec![0; global.points.len()];
    for contact in &scene.passes() {
        let slave = names.iter().position(|n| n.value == contact.slave.value).unwrap_or_default();
        for &n in &global.sets[slave].nodes {
            global.node_work[n as usize] = 1;
        }
    }
    let of_faces = sides(scene).chain(scene.steps.iter().flat_map(|s| s.pressures.iter().map(|p| &p.set)));
    Faults::all(of_faces.map(|name| {
        let is_bare = names.iter().zip(&global.sets).any(|(n, set)| n.value == name.value && set.facets.is_empty());
        let what = format!("`{}` has no faces", name.value);
        let help = "name a group of faces on the surface of the body";
        if is_bare { Err(Error::input(&name.at, what, help)) } else { Ok(()) }
    }))?;
    Ok(global)
}

/// The sets of faces that meet or are tied.
fn sides(scene: &Scene) -> impl Iterator<Item = &Located<String>> {
    let of_contacts = scene.contacts.iter().flat_map(|c| std::iter::once(&c.slave).chain(c.surface.map(|_| &c.master)));
    of_contacts.chain(scene.ties.iter().flat_map(|tie| [&tie.slave, &tie.master]))
}

/// Refuses what does not know of the nodes in the middles of the edges of quadratic faces.
fn refuse_quadratic_sides(scene: &Scene, global: &GlobalMesh) -> Result<()> {
    let quadratic: BTreeSet<&str> = (global.solids.iter().zip(&global.solid_body))
        .filter(|(solid, _)| solid.shape == SolidShape::Tet10)
        .map(|(_, body)| scene.bodies[*body as usize].name.value.as_str())
        .collect();
    let wrong = |set: &Located<String>, kind: &str, help: &str| {
        let is_quadratic = quadratic.contains(body_of(&set.value));
        let error = || Error::input(&set.at, format!("`{}` has quadratic faces, which {kind}", set.value), help);
        if is_quadratic { Err(error()) } else { Ok(()) }
    };
    for tie in &scene.ties {
        for side in [&tie.slave, &tie.master] {
            wrong(side, "ties do not take", "mesh such bodies with hexahedra, or with tetrahedra of first order")?;
        }
    }
    for contact in scene.contacts.iter().filter(|c| c.discretization == Discretization::Segment) {
        for side in std::iter::once(&contact.slave).chain(contact.surface.map(|_| &contact.master)) {
            let kind = "are not for contact from segment to segment";
            wrong(side, kind, "use \"one-pass\", or mesh the body with hexahedra or linear tetrahedra")?;
        }
    }
    for contact in scene.contacts.iter().filter(|c| c.surface.is_some()) {
        let kind = match contact.discretization {
            _ if contact.is_self() => "do not meet themselves",
            Discretization::OnePass => continue,
            Discretization::TwoPass => "are not for two passes",
            Discretization::NodeToNode => "are not for contact from node to node",
            Discretization::Segment => continue,
        };
        for side in [&contact.slave, &contact.master] {
            wrong(side, kind, "let two surfaces meet in one pass, or mesh the body with hexahedra")?;
        }
    }
    Ok(())
}

/// Patches, and what nodes avoid by their numbers.
pub type MasterPatches = (Vec<MovingPatch>, BTreeMap<u64, Avoided>);

/// The patches of each deformable master, and in self-contact what its nodes avoid, on rank 0, which has the mesh and the
/// numbers of its nodes over all ranks.
///
/// # Errors
/// Faces that make no surface.
pub fn master_patches(
    scene: &Scene,
    names: &[Located<String>],
    planes: &[SymmetryPlane],
    mesh: Option<&GlobalMesh>,
    numbers: &[u64],
) -> Result<Vec<MasterPatches>> {
    let passes = scene.passes();
    let masters = passes.iter().filter_map(|c| c.surface.map(|given| (c, given)));
    let of_master = |(contact, given): (&scene::Contact, scene::MasterSurface)| {
        let master = &contact.master;
        let (Some(mesh), Some(set)) = (mesh, names.iter().position(|n| n.value == master.value)) else {
            return Ok(Default::default());
        };
        let facets = &mesh.sets[set].facets;
        let mut nodes: Vec<u32> = facets.iter().flat_map(|f| &f.nodes[..f.count as usize]).copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let place = |n: u32| nodes.binary_search(&n).map_or(0, |k| k as u32);
        let surface = Mesh {
            source: master.value.clone(),
            points: nodes.iter().map(|&n| mesh.points[n as usize].into()).collect(),
            point_ids: nodes.iter().map(|&n| mesh.id[n as usize]).collect(),
            facets: facets.iter().map(|f| Facet { count: f.count, nodes: f.nodes.map(place), id: f.id }).collect(),
            ..Mesh::default()
        };
        let of_corners: Vec<u64> = nodes.iter().map(|&n| numbers[n as usize]).collect();
        let is_quadratic = facets.iter().any(|facet| mesh.middles.of(facet.nodes()).is_some());
        let smoothing = if is_quadratic { Smoothing::Facet } else { given.smoothing };
        let mut planes = symmetry::planes_of(planes, &master.value, &surface.points);
        let is_axis = (Vec3::zeros(), Vec3::x());
        if scene.is_axisymmetric()
            && surface.points.iter().any(|x| x[0] == 0.0)
            && planes.iter().all(|(_, normal)| normal.x == 0.0)
        {
            planes.push(is_axis);
        }
        let mut patches =
            MovingPatch::all(&surface, &of_corners, smoothing, given.feature_angle, &planes, &scene.controls)?;
        for (patch, facet) in patches.iter_mut().zip(facets) {
            if let Some(middles) = mesh.middles.of(facet.nodes()) {
                patch.bend_through(middles.map(|n| numbers[n as usize]));
            }
        }
        if contact.discretization == Discretization::TwoPass {
            patches.iter_mut().for_each(|patch| patch.bulge = scene.controls.two_pass_bulge);
        }
        let points: BTreeMap<u64, Vec3> =
            of_corners.into_iter().zip(surface.points.iter().map(|x| Vec3::from(*x))).collect();
        let avoided = if contact.is_self() {
            self_contact::avoided(&patches, &scene.controls, |n| points[&n])
        } else {
            BTreeMap::new()
        };
        Ok((patches, avoided))
    };
    masters.map(of_master).collect()
}

/// The set that `name` (`body` or `body.group`) means in this body; `None` if it is another body's.
fn resolve(body: &str, mesh: &Mesh, name: &Located<String>) -> Result<Option<GlobalSet>> {
    let (of, group) = match name.value.split_once('.') {
        Some((of, group)) => (of, Some(group)),
        None => (name.value.as_str(), None),
    };
    if of != body {
        return Ok(None);
    }
    let Some(group) = group else {
        let nodes = (0..mesh.points.len() as u32).collect();
        return Ok(Some(GlobalSet { nodes, facets: Vec::new() }));
    };
    let Some(found) = mesh.groups.get(group) else {
        let what = format!("body `{body}` has no group `{group}`");
        return Err(Error::input(&name.at, what, did_you_mean(group, mesh.groups.keys().map(String::as_str))));
    };
    if found.nodes.is_empty() {
        return Err(Error::input(
            &name.at,
            format!("group `{group}` of body `{body}` is empty"),
            "name a group that has nodes",
        ));
    }
    let facets = found.facets.iter().map(|&k| &mesh.facets[k as usize]);
    let facets = facets.map(|f| GlobalFacet { count: f.count, nodes: f.nodes, id: f.id }).collect();
    Ok(Some(GlobalSet { nodes: found.nodes.clone(), facets }))
}

fn shifted(mut set: GlobalSet, offset: u32) -> GlobalSet {
    set.nodes.iter_mut().for_each(|n| *n += offset);
    set.facets.iter_mut().for_each(|f| f.nodes.iter_mut().for_each(|n| *n += offset));
    set
}

/// Whether a body for which a formulation is asked may have elements of a shape: its own, and wedges between hexahedra.
fn goes_with(asked: Formulation, shape: SolidShape) -> bool {
    let fills = shape == SolidShape::Wedge6 && asked.shape() == SolidShape::Hex8 && asked != Formulation::Hex8Shell;
    shape == asked.shape() || fills
}

/// The element formulation of each section: the user's, checked against the mesh, or the mesh's own; and
/// whether wedges fill in between hexahedra. Collective.
fn element_kinds(comm: &SimpleCommunicator, scene: &Scene, part: &Part) -> Result<Vec<(Formulation, bool)>> {
    const SHAPES: [(SolidShape, &str); 4] = [
        (SolidShape::Hex8, "hexahedra"),
        (SolidShape::Wedge6, "wedges"),
        (SolidShape::Tet4, "linear tetrahedra"),
        (SolidShape::Tet10, "quadratic tetrahedra"),
    ];
    let mut present = vec![0.0; SHAPES.len() * scene.sections().count()];
    for solid in &part.solids {
        let shape = SHAPES.iter().position(|(shape, _)| *shape == solid.shape).unwrap_or_default();
        present[SHAPES.len() * solid.section as usize + shape] = 1.0;
    }
    max(comm, &mut present);
    let mut kinds = Vec::new();
    for ((body, material), has) in scene.sections().zip(present.chunks_exact(SHAPES.len())) {
        let body = &scene.bodies[body];
        let has = || SHAPES.iter().zip(has).filter(|(_, has)| **has > 0.0).map(|(shape, _)| shape);
        let asked = body.element.as_ref();
        if let Some(asked) = asked.filter(|asked| has().any(|(shape, _)| !goes_with(asked.value, *shape))) {
            let words: Vec<&str> = has().map(|(_, word)| *word).collect();
            let what = format!("the mesh of body `{}` has {}", body.name.value, words.join(" and "));
            let help = match asked.value {
                Formulation::Hex8Shell if words == ["hexahedra", "wedges"] => {
                    "solid-shell elements are hexahedra alone: mesh the sheet with these, or take \"hex8-eas\""
                }
                _ => "leave `element` out to take each element by its shape",
            };
            return Err(Error::input(&asked.at, what, help));
        }
        let default =
            has().next().map_or(Formulation::Hex8, |(shape, _)| scene.default_element(&material.value, *shape));
        let is_filled = [SolidShape::Hex8, SolidShape::Wedge6].iter().all(|shape| has().any(|(own, _)| own == shape));
        let first = has().next().map_or(SolidShape::Hex8, |(shape, _)| *shape);
        kinds.push((asked.map_or(default, |e| e.value.beside(first)), is_filled));
    }
    Ok(kinds)
}
