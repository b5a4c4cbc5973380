//! The contact pairs of a rank, from the contacts of the scene.

use super::{Model, Section};
use crate::Vec3;
use crate::contact::mates::{self, Lonely};
use crate::contact::stiffness::{Backing, contact_stiffness};
use crate::contact::{Avoided, Faces, Master, Meets, Pair, Pass, Rules, Side, Slave, Within};
use crate::error::{Error, Result};
use crate::mortar::Corners;
use crate::parallel::{agree, max, sum};
use crate::partition::{Gather, PartSet};
use crate::scene::{self, Discretization, Enforcement, Scene, body_of};
use crate::surface::MovingPatch;
use mpi::topology::SimpleCommunicator;
use std::collections::{BTreeMap, BTreeSet};

impl Model {
    /// Makes the pairs of the contacts, of which those within a body have nodes that they shun, and some `smooth` faces.
    /// Collective.
    ///
    /// # Errors
    /// Nodes that ties hold, too, or that have no mate where they need one.
    pub(super) fn pair_up(
        &mut self,
        comm: &SimpleCommunicator,
        scene: &Scene,
        avoided: &[BTreeMap<u32, Avoided>],
        smooth: &[Vec<MovingPatch>],
    ) -> Result<()> {
        let passes = scene.passes();
        for (contact, smooth) in passes.iter().zip(smooth) {
            let pair = self.pair(comm, scene, contact, (avoided, smooth));
            self.pairs.push(pair);
        }
        self.join_passes(&passes);
        self.check_joints(comm, scene)?;
        self.tell_repeats();
        self.find_mates(comm, scene)
    }

    /// A contact on this rank.
    fn pair(
        &self,
        comm: &SimpleCommunicator,
        scene: &Scene,
        contact: &scene::Contact,
        (avoided, smooth): (&[BTreeMap<u32, Avoided>], &[MovingPatch]),
    ) -> Pair {
        let set = self.set(&contact.slave.value);
        let index = |set: &str| self.bodies.iter().position(|b| b.name == body_of(set));
        let nodes = self.slave_nodes(contact, [index(&contact.slave.value), index(&contact.master.value)]);
        let master = self.master(scene, contact);
        let is_surface = contact.surface.is_some();
        let softest = if is_surface { self.mean_stiffness(comm, &contact.master.value) } else { f64::INFINITY };
        let stiffness = self.contact_stiffness(set);
        let slave = |n: u32| {
            let stiffness = stiffness[n as usize].min(softest);
            Slave::new(n, contact.friction, self.controls.augmentation * stiffness)
        };
        let slaves: Vec<Slave> = nodes.into_iter().map(slave).collect();
        let by_faces = contact.discretization == Discretization::Segment;
        let faces = by_faces.then(|| {
            let how = (self.is_axisymmetric(), contact.slave_feature_angle());
            let mut faces = Faces::new(&self.part, &set.facets, &slaves, how);
            if !smooth.is_empty() {
                faces.bulge_as(comm, &self.part, smooth, contact.slave_follows);
            }
            faces
        });
        let sides = (&slaves[..], faces.as_ref());
        let within = is_within_body(contact).then(|| self.within(comm, contact, master, sides, avoided));
        let facet_size = self.longest_edge(comm, &contact.slave.value);
        // Multipliers that are the force know no penalty; it would only scale their equations out of sight.
        let penalty = contact.penalty.filter(|_| contact.method != Enforcement::Lagrange);
        let side = |name: &str| Side {
            body: index(name).unwrap_or_default(),
            set: self.set_index[name],
            sections: self.sections_of(comm, self.set(name)),
        };
        let mut pair = Pair {
            name: contact.name.value.clone(),
            master,
            side: side(&contact.slave.value),
            master_side: is_surface.then(|| side(&contact.master.value)),
            planar: is_surface && [&contact.slave, &contact.master].iter().all(|set| self.is_planar(&set.value)),
            rules: Rules {
                friction: contact.friction,
                tangent: contact.tangent,
                method: contact.method,
                asked: (contact.method, penalty),
                eased: 1.0,
                interference: contact.interference,
                tolerance: contact.tolerance,
            },
            pass: Pass::Only,
            within,
            mirrored: self.mirrored(&contact.slave.value),
            outward: vec![Vec3::zeros(); slaves.len()],
            slaves,
            faces,
            reach: contact.reach.unwrap_or(self.controls.reach_facets * facet_size),
            facet_size,
            controls: self.controls,
        };
        pair.enforce(contact.method);
        pair
    }

    /// Of a contact within a body, what its slave nodes may meet. Collective.
    fn within(
        &self,
        comm: &SimpleCommunicator,
        contact: &scene::Contact,
        master: Master,
        (slaves, faces): (&[Slave], Option<&Faces>),
        avoided: &[BTreeMap<u32, Avoided>],
    ) -> Within {
        let (mut shunned, mut of_faces) = (Vec::new(), Vec::new());
        if let Master::Surface(k, Meets::Own) = master {
            let depth = |avoided: Avoided| match contact.thickness {
                Some(thickness) => avoided.with_thickness(thickness, self.controls.self_depth),
                None => avoided,
            };
            let of_node = |n: u32| avoided[k].get(&n);
            shunned = slaves.iter().map(|s| depth(of_node(s.node).cloned().unwrap_or_default())).collect();
            let corners = faces.into_iter().flat_map(Faces::corners);
            of_faces = corners.map(|at| depth(Avoided::of_all(at.iter().filter_map(|&n| of_node(n))))).collect();
        }
        let all = shunned.iter().chain(&of_faces);
        Within {
            facing: -self.controls.self_facing.to_radians().cos(),
            sheet: Gather::new(comm, &self.part.starts, all.flat_map(Avoided::depends_on)),
            avoided: shunned,
            of_faces,
        }
    }

    /// The master of a contact, the surfaces of bodies in the order of the contacts.
    fn master(&self, scene: &Scene, contact: &scene::Contact) -> Master {
        if contact.surface.is_none() {
            let tool = scene.tools.iter().position(|t| t.name.value == contact.master.value);
            return Master::Tool(tool.unwrap_or_default());
        }
        let surface = self.pairs.iter().filter(|p| p.master.surface().is_some()).count();
        let meets = match contact.discretization {
            Discretization::NodeToNode => Meets::Nodes,
            _ if contact.is_self() => Meets::Own,
            _ => Meets::Faces,
        };
        Master::Surface(surface, meets)
    }

    /// The slave nodes of a contact on this rank, between the bodies of its sides.
    fn slave_nodes(&self, contact: &scene::Contact, bodies: [Option<usize>; 2]) -> Vec<u32> {
        let of_set = &self.set(&contact.slave.value).nodes;
        let mut nodes: Vec<u32> = of_set.iter().map(|&n| self.part.tie[n as usize]).collect();
        nodes.sort_unstable();
        nodes.dedup();
        if contact.surface.is_some() && !contact.is_self() {
            // A node on both sides, as at the tip of a crack, would meet itself.
            let masters = self.set(&contact.master.value).nodes.iter();
            let masters: BTreeSet<u32> = masters.map(|&n| self.part.tie[n as usize]).collect();
            nodes.retain(|n| !masters.contains(n));
        }
        // What is tied to the master neither opens nor slides.
        if let [Some(own), Some(other)] = bodies {
            for joint in &self.joints {
                let tied = joint.nodes_between(own, other);
                nodes.retain(|n| tied.binary_search(n).is_err());
            }
        }
        nodes
    }

    /// Tells the slave nodes of ties how stiff their bodies are there.
    pub(super) fn stiffen_joints(&mut self, scene: &Scene) {
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
                    let help = "exchange `slave` and `master` of the tie, leave the node out of the contact, or give that \
                                `method = \"penalty\"` or `\"uzawa\"`";
                    Error::input(&tie.slave.at, what, help)
                });
                agree(comm, told.map_or(Ok(()), Err))?;
            }
        }
        Ok(())
    }

    /// Tells slave nodes that others of their surface may make the same constraint.
    fn tell_repeats(&mut self) {
        for pair in self.pairs.iter_mut().filter(|pair| pair.is_self() && pair.width() > 0) {
            let slack = if pair.faces.is_some() { pair.controls.slack_segments } else { pair.controls.slack };
            pair.slaves.iter_mut().for_each(|slave| slave.repeats = Some(slack));
        }
    }

    /// Lets the two passes of a contact know of each other.
    fn join_passes(&mut self, passes: &[scene::Contact]) {
        for (second, pass) in passes.iter().enumerate() {
            if let Some(first) = pass.second_of {
                self.pairs[second].pass = Pass::Second { first };
                self.pairs[first].pass = Pass::First { second };
            }
        }
    }

    /// The unit normals of the faces of a set around each of its nodes of this rank.
    fn faces_around(&self, set: &str) -> BTreeMap<u32, Vec<Vec3>> {
        let mut faces: BTreeMap<u32, Vec<Vec3>> = BTreeMap::new();
        for facet in &self.set(set).facets {
            let nodes = &facet.nodes[..facet.count as usize];
            let normal = Corners::new(nodes).map(|n| self.part.points[n as usize]).area_vector().normalize();
            nodes.iter().for_each(|&n| faces.entry(self.part.tie[n as usize]).or_default().push(normal));
        }
        faces
    }

    /// Pairs the nodes of contacts from node to node where they stand. Collective.
    fn find_mates(&mut self, comm: &SimpleCommunicator, scene: &Scene) -> Result<()> {
        const ALIKE: &str = "mesh both sides alike, or use another `discretization`";
        let contact_of = |pair: &Pair| match pair.master {
            Master::Surface(k, Meets::Nodes) => Some((k, scene.contacts.iter().find(|c| c.name.value == pair.name)?)),
            _ => None,
        };
        let faces_of = |pair: &Pair| contact_of(pair).map(|(_, contact)| self.faces_around(&contact.slave.value));
        let faces: Vec<_> = self.pairs.iter().map(faces_of).collect();
        let Self { part, masters, pairs, .. } = self;
        let place = |n: u32| part.points[n as usize];
        masters.follow(comm, pairs, place);
        for (pair, faces) in pairs.iter_mut().zip(&faces) {
            let (Some((k, contact)), Some(faces)) = (contact_of(pair), faces) else { continue };
            let around = |n: u32| faces.get(&n).map_or(&[][..], Vec::as_slice);
            let lonely = mates::find(&mut pair.slaves, (&masters.surfaces[k], pair.planar), place, around).err();
            let told = lonely.map(|(node, why)| {
                let (x, id, master) = (place(node), part.id[node as usize], &contact.master.value);
                let (lacks, help) = match why {
                    Lonely::Far(distance) if distance.is_finite() => {
                        (format!("has no node of `{master}` at its place: the nearest is {distance:.3e} away"), ALIKE)
                    }
                    Lonely::Far(_) => (format!("has no node of `{master}` at its place: there is none near"), ALIKE),
                    Lonely::Averted => (
                        format!("is at a node of `{master}` where no face of that looks at it"),
                        "name the faces that meet as slave and master, or use another `discretization`",
                    ),
                    Lonely::OnEdge => (
                        format!(
                            "is at a sharp edge of `{master}`, of which both sides look at it: a node has one normal"
                        ),
                        "raise `feature_angle`, if the edge is but a coarse mesh, or use another `discretization`",
                    ),
                };
                let what =
                    format!("node {id} of `{}` at ({:.6}, {:.6}, {:.6}) {lacks}", contact.slave.value, x.x, x.y, x.z);
                Error::input(&contact.slave.at, what, help)
            });
            agree(comm, told.map_or(Ok(()), Err))?;
        }
        Ok(())
    }

    /// The sections that owned nodes of a set count as, on all ranks. Collective.
    fn sections_of(&self, comm: &SimpleCommunicator, set: &PartSet) -> Vec<usize> {
        let mut has = vec![0.0; self.sections.len()];
        let of_node = |n: u32| self.part.section[n as usize] as usize;
        // What bodies share counts as the first one's.
        set.nodes.iter().flat_map(|&n| [n, self.part.tie[n as usize]]).for_each(|n| has[of_node(n)] = 1.0);
        max(comm, &mut has);
        (0..has.len()).filter(|&section| has[section] > 0.0).collect()
    }

    /// Whether a set is on a layer.
    pub(super) fn is_planar(&self, set: &str) -> bool {
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
}

/// Whether both sides of a contact are on one body.
fn is_within_body(contact: &scene::Contact) -> bool {
    body_of(&contact.slave.value) == body_of(&contact.master.value)
}
