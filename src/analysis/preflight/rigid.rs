//! Which rigid motions of the bodies and tools nothing holds.
//!
//! A body, or each of its components that share no nodes, moves with the velocity v + ω x (x - c), c the middle of its
//! box; a tool that a force drives translates along its free directions, and one that a torque drives turns about its
//! axis. Every support is a row: no velocity along a direction at a point. Every contact is one, too: no velocity of the
//! two sides relative to each other along the normal, with friction that sticks along no direction.
//!
//! A motion is free when it moves no support and opens or closes no contact. Normals of meshed surfaces are not exact, so
//! that a motion along a smooth surface is not quite without an opening: what counts is the share of the velocity at the
//! contacts that goes along the normals. With the Gram matrix K of the rows, and M of all relative velocities at the same
//! points, motions are free where x·K x < TILT² x·M x. M has a little of the unit matrix besides, for what moves no point;
//! rotations are scaled by the half diagonal of the body.
//!
//! What is held by supports, or by contacts with what is held, moves nothing else: it is found one by one first, and taken
//! out of the problem of what hangs together.

use crate::contact::{Axle, Pair};
use crate::model::Model;
use crate::parallel::{Parcels, exchange};
use crate::partition::{Component, lowest_joined};
use crate::{AXIS_NAMES, Vec3};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use nalgebra::{DMatrix, DVector, Matrix6, SymmetricEigen, Vector6};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::AddAssign;

/// Share of a velocity that may be normal to a contact and count as none: 1e-3 radians, the accuracy of the normals of
/// coarse smoothed meshes.
const TILT: f64 = 1e-3;

/// Weight of a support over that of a contact.
const FIRM: f64 = 1e3;

/// Of the unit matrix in M: far below what one point of a mesh of millions weighs in it, well above rounding.
const UNIT: f64 = 1e-6;

/// Parts of motions below this are none.
const SLIGHT: f64 = 1e-4;

/// Velocities of a component of a body: three translations, then three rotations.
const OF_COMPONENT: usize = 6;

/// Velocities of a tool: three translations, and a rotation.
const OF_TOOL: usize = 4;

/// The free directions of a tool, and the axis about which it turns freely.
type Driven = ([bool; 3], Option<Axle>);

/// A component of a body.
#[derive(Clone, Debug)]
struct Rigid {
    who: String,
    body: usize,
    is_whole: bool,
    center: Vec3,
    size: f64,
}

/// What of a row is of a component, or of a tool, which come behind all components.
type Entry = (usize, Vector6<f64>);

/// Of the Gram matrices of the rows what is of two components or tools.
#[derive(Clone, Copy, Debug, Default)]
struct Grams {
    /// Of supports, which are in both of the others, too.
    firm: Matrix6<f64>,
    held: Matrix6<f64>,
    moved: Matrix6<f64>,
}

impl AddAssign<&Grams> for Grams {
    fn add_assign(&mut self, other: &Self) {
        self.firm += other.firm;
        self.held += other.held;
        self.moved += other.moved;
    }
}

impl Grams {
    /// Of rows whose entries are those of these by matrices.
    fn of_entries(&self, left: &Matrix6<f64>, right: &Matrix6<f64>) -> Self {
        let of = |gram: &Matrix6<f64>| left * gram * right.transpose();
        Self { firm: of(&self.firm), held: of(&self.held), moved: of(&self.moved) }
    }
}

/// Gram matrices of two components or tools, and which of their rows: those that the first has with the third. Rows of one
/// alone have it three times.
type AllGrams = BTreeMap<[usize; 3], Grams>;

/// The rigid motions of a model, and what holds them on this rank.
#[derive(Clone, Debug)]
pub struct RigidMotions {
    components: Vec<Rigid>,
    /// Tools with the free directions of each, and the axis about which it turns freely.
    tools: Vec<(String, Driven)>,
    grams: AllGrams,
    /// The components of masters in their order, each of which may come to touch any slave node; the same on all ranks.
    masters: Vec<Vec<usize>>,
    /// Of the slave nodes that may come to touch these masters: the index of the masters, and twice the component.
    coming: AllGrams,
}

/// What one component of a body or tool does in the motions that nothing holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Free {
    /// "body `a`", "tool `b`".
    pub who: String,
    pub is_tool: bool,
    /// It is not all of its body.
    pub is_piece: bool,
    /// Of the body or the tool.
    pub index: usize,
    /// Directions of free translations, unit vectors.
    pub along: Vec<Vec3>,
    /// Free rotations besides: axis, a unit vector, and a point on it.
    pub about: Vec<(Vec3, Vec3)>,
}

/// Where a slave node touches.
pub struct Touch {
    pub at: Vec3,
    pub normal: Vec3,
    pub sticks: bool,
    pub side: Side,
}

impl RigidMotions {
    /// All components of bodies, and the tools as they are `driven`; nothing holds them yet.
    pub fn new(model: &Model, driven: Vec<Driven>) -> Self {
        let named = |(k, component): (usize, &Component)| {
            let (low, high) = component.bounds;
            let size = 0.5 * (high - low).norm();
            Rigid {
                who: model.component_name(k),
                body: component.body as usize,
                is_whole: component.is_whole,
                center: 0.5 * (low + high),
                size: if size > 0.0 { size } else { 1.0 },
            }
        };
        let components = model.part.components.iter().enumerate().map(named).collect();
        Self::of(components, model.masters.tools.iter().map(|t| t.name.clone()).zip(driven).collect())
    }

    fn of(components: Vec<Rigid>, tools: Vec<(String, Driven)>) -> Self {
        Self { components, tools, grams: AllGrams::new(), masters: Vec::new(), coming: AllGrams::new() }
    }

    /// Slave nodes, each of a component, that may come to touch any of some components of a master: where, along which normal, and
    /// whether friction sticks then. On all ranks with the same masters.
    pub fn expect(&mut self, masters: Vec<usize>, slaves: impl Iterator<Item = (usize, Vec3, Vec3, bool)>) {
        let index = self.masters.len();
        self.masters.push(masters);
        for (component, x, normal, sticks) in slaves {
            let square = |along: &Vec3| {
                let (_, row) = self.velocity(component, &x, along);
                row * row.transpose()
            };
            let moved = (0..3).map(|d| square(&Vec3::ith(d, 1.0))).sum::<Matrix6<f64>>();
            let held = if sticks { moved } else { square(&normal) };
            *self.coming.entry([index, component, component]).or_default() +=
                &Grams { held, moved, ..Grams::default() };
        }
    }

    /// The point `x` of a component has no velocity along a unit vector.
    pub fn hold(&mut self, component: usize, x: &Vec3, along: &Vec3) {
        let row = [self.velocity(component, x, along)];
        self.add_square(&row, |grams| [Some(&mut grams.firm), Some(&mut grams.held), Some(&mut grams.moved)]);
    }

    /// A point of a component at `x` touches a tool or a component along a unit vector; with friction that sticks they move as
    /// one.
    pub fn touch(&mut self, component: usize, master: Side, x: &Vec3, normal: &Vec3, sticks: bool) {
        if master == Side::Component(component) {
            return;
        }
        let relative = |motions: &Self, along: &Vec3| {
            let mut row = vec![motions.velocity(component, x, along)];
            match master {
                Side::Component(other) => {
                    let (unit, entries) = motions.velocity(other, x, along);
                    row.push((unit, -entries));
                }
                Side::Tool(t) => {
                    let (free, axle) = motions.tools[t].1;
                    let mut entries = Vector6::zeros();
                    (0..3).filter(|&d| free[d]).for_each(|d| entries[d] = -along[d]);
                    entries[3] = axle.map_or(0.0, |axle| -axle.velocity(x).dot(along));
                    if free.contains(&true) || axle.is_some() {
                        row.push((motions.components.len() + t, entries));
                    }
                }
            }
            row
        };
        for d in 0..3 {
            let row = relative(self, &Vec3::ith(d, 1.0));
            self.add_square(&row, |grams| [None, sticks.then_some(&mut grams.held), Some(&mut grams.moved)]);
        }
        if !sticks {
            let row = relative(self, normal);
            self.add_square(&row, |grams| [None, Some(&mut grams.held), None]);
        }
    }

    /// Adds what touches of a pair, as `state` says of a slave node; `component` has those of all local nodes.
    pub fn touch_pair(&mut self, pair: &Pair, component: &[u32], state: impl Fn(usize) -> Option<Touch>) {
        for (s, slave) in pair.slaves.iter().enumerate() {
            if let Some(Touch { at, normal, sticks, side }) = state(s) {
                self.touch(component[slave.node as usize] as usize, side, &at, &normal, sticks);
            }
        }
    }

    fn add_square(&mut self, row: &[Entry], choose: impl Fn(&mut Grams) -> [Option<&mut Matrix6<f64>>; 3]) {
        for (i, a) in row {
            let with = row.iter().map(|(j, _)| *j).find(|j| j != i).unwrap_or(*i);
            for (j, b) in row {
                let square = a * b.transpose();
                let grams = self.grams.entry([*i, *j, with]).or_default();
                choose(grams).into_iter().flatten().for_each(|gram| *gram += square);
            }
        }
    }

    /// The velocity of the point `x` of a component along a direction: its entries of a row.
    fn velocity(&self, component: usize, x: &Vec3, along: &Vec3) -> Entry {
        let Rigid { center, size, .. } = &self.components[component];
        let turn = (x - center).cross(along) / *size;
        (component, Vector6::from_fn(|k, _| if k < 3 { along[k] } else { turn[k - 3] }))
    }

    /// What can move: by component, then by tool; empty when everything is held. The same on all ranks. Collective.
    pub fn free(&self, comm: &SimpleCommunicator) -> Vec<Free> {
        self.free_along(comm, TILT)
    }

    /// The same, where a velocity at the contacts of which no more than the share `tilt` is normal to them counts as free,
    /// and what moves a support does not, however many contacts there are. Collective.
    pub fn free_along(&self, comm: &SimpleCommunicator, tilt: f64) -> Vec<Free> {
        let whole = |parcels: Parcels<f64>| {
            let mut all = Self { grams: AllGrams::new(), coming: AllGrams::new(), ..self.clone() };
            parcels.values().for_each(|parcel| all.add(parcel));
            all
        };
        let mine = Parcels::from([(0, self.to_numbers())]);
        let all = whole(exchange(comm, &mine)).to_numbers();
        let ranks = if comm.rank() == 0 { 0..comm.size() as usize } else { 0..0 };
        let to_all: Parcels<f64> = ranks.map(|rank| (rank, all.clone())).collect();
        whole(exchange(comm, &to_all)).loose(tilt)
    }

    /// The Gram matrices as numbers, to be sent to another rank.
    fn to_numbers(&self) -> Vec<f64> {
        let of_one = |is_coming: bool, (key, grams): (&[usize; 3], &Grams)| {
            let Grams { firm, held, moved } = grams;
            let entries = [firm, held, moved].into_iter().flatten().copied();
            let key = key.map(|k| k as f64).into_iter();
            [f64::from(u8::from(is_coming))].into_iter().chain(key).chain(entries).collect::<Vec<_>>()
        };
        let coming = self.coming.iter().flat_map(|one| of_one(true, one));
        self.grams.iter().flat_map(|one| of_one(false, one)).chain(coming).collect()
    }

    /// Adds those of [`Self::to_numbers`].
    fn add(&mut self, numbers: &[f64]) {
        const ENTRIES: usize = 36;
        for one in numbers.chunks_exact(4 + 3 * ENTRIES) {
            let all = if one[0] == 0.0 { &mut self.grams } else { &mut self.coming };
            let gram = |k: usize| Matrix6::from_column_slice(&one[4 + k * ENTRIES..4 + (k + 1) * ENTRIES]);
            let grams = Grams { firm: gram(0), held: gram(1), moved: gram(2) };
            *all.entry([1, 2, 3].map(|k| one[k] as usize)).or_default() += &grams;
        }
    }

    fn loose(&self, tilt: f64) -> Vec<Free> {
        let units = self.components.len() + self.tools.len();
        let (is_held, grounds) = self.held_one_by_one(tilt);
        let rest: Vec<usize> = (0..units).filter(|&unit| !is_held[unit]).collect();
        let mut grams: BTreeMap<[usize; 2], Grams> =
            rest.iter().map(|&unit| ([unit; 2], self.on_held(unit, &is_held, &grounds))).collect();
        for ([i, j, with], square) in self.grams.iter().filter(|([i, _, with], _)| !is_held[*i] && !is_held[*with]) {
            if i != with {
                *grams.entry([*i, *j]).or_default() += square;
            }
        }
        self.add_coming(&is_held, &mut grams);
        // What no row joins moves by itself.
        let rows: Vec<[u32; 2]> = grams.keys().map(|units| units.map(|unit| unit as u32)).collect();
        let lowest = lowest_joined(units, rows.iter().map(|row| &row[..]));
        let mut groups: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        rest.iter().for_each(|&unit| groups.entry(lowest[unit]).or_default().push(unit));
        let mut free: Vec<(usize, Free)> =
            groups.values().flat_map(|units| self.loose_of(units, &grams, tilt)).collect();
        free.sort_by_key(|(unit, _)| *unit);
        free.into_iter().map(|(_, free)| free).collect()
    }

    /// What supports hold, then what is held by that, and so on; and what of the coming contacts is held then. Whatever becomes
    /// held has those looked at again that may be held by it.
    fn held_one_by_one(&self, tilt: f64) -> (Vec<bool>, Vec<Ground>) {
        let units = self.components.len() + self.tools.len();
        let mut is_held = vec![false; units];
        let mut grounds = vec![Ground::default(); self.masters.len()];
        let mut open: BTreeSet<usize> = (0..units).collect();
        while !open.is_empty() {
            let mut next = BTreeSet::new();
            for unit in open {
                let own = BTreeMap::from([([unit; 2], self.on_held(unit, &is_held, &grounds))]);
                if is_held[unit] || !self.loose_of(&[unit], &own, tilt).is_empty() {
                    continue;
                }
                is_held[unit] = true;
                next.extend(self.grams.range([unit, unit, 0]..[unit, unit + 1, 0]).map(|([_, _, with], _)| *with));
                for (p, ground) in grounds.iter_mut().enumerate() {
                    let masters = &self.masters[p];
                    if let (Some(&first), Some(square)) = (masters.first(), self.coming.get(&[p, unit, unit])) {
                        let shift = self.shift(unit, first);
                        ground.slaves += &square.of_entries(&shift, &shift);
                        next.extend(masters);
                    }
                    if !ground.has_master && masters.binary_search(&unit).is_ok() {
                        ground.has_master = true;
                        next.extend(self.coming.range([p, 0, 0]..[p + 1, 0, 0]).map(|([_, slave, _], _)| *slave));
                    }
                }
            }
            open = next.into_iter().filter(|&unit| !is_held[unit]).collect();
        }
        (is_held, grounds)
    }

    /// Of the rows of a component or tool that is not held those that it has alone, or with what is held.
    fn on_held(&self, unit: usize, is_held: &[bool], grounds: &[Ground]) -> Grams {
        let mut sum = Grams::default();
        for ([_, _, with], square) in self.grams.range([unit, unit, 0]..[unit, unit + 1, 0]) {
            if *with == unit || is_held[*with] {
                sum += square;
            }
        }
        for (p, ground) in grounds.iter().enumerate() {
            if let (true, Some(square)) = (ground.has_master, self.coming.get(&[p, unit, unit])) {
                sum += square;
            }
            if let (Some(&first), true) = (self.masters[p].first(), self.masters[p].binary_search(&unit).is_ok()) {
                let shift = self.shift(first, unit);
                sum += &ground.slaves.of_entries(&shift, &shift);
            }
        }
        sum
    }

    /// Adds the coming contacts between components that are not held.
    fn add_coming(&self, is_held: &[bool], grams: &mut BTreeMap<[usize; 2], Grams>) {
        for ([p, slave, _], square) in self.coming.iter().filter(|([_, slave, _], _)| !is_held[*slave]) {
            for &master in self.masters[*p].iter().filter(|&master| master != slave && !is_held[*master]) {
                let sides = [(*slave, Matrix6::identity()), (master, -self.shift(*slave, master))];
                for (i, a) in &sides {
                    for (j, b) in &sides {
                        *grams.entry([*i, *j]).or_default() += &square.of_entries(a, b);
                    }
                }
            }
        }
    }

    /// What makes of the entries of a component those of another for the same point.
    fn shift(&self, from: usize, to: usize) -> Matrix6<f64> {
        let [from, to] = [from, to].map(|component| &self.components[component]);
        let mut shift = Matrix6::identity();
        shift.fixed_view_mut::<3, 3>(3, 0).copy_from(&((from.center - to.center).cross_matrix() / to.size));
        shift.fixed_view_mut::<3, 3>(3, 3).fill_diagonal(from.size / to.size);
        shift
    }

    /// What is free of components and tools that none of these rows joins to others, with their numbers.
    fn loose_of(&self, units: &[usize], grams: &BTreeMap<[usize; 2], Grams>, tilt: f64) -> Vec<(usize, Free)> {
        let exists = |unit: usize, k: usize| match unit.checked_sub(self.components.len()) {
            None => true,
            Some(t) => {
                let (free, axle) = self.tools[t].1;
                k < OF_TOOL && free.get(k).copied().unwrap_or(axle.is_some())
            }
        };
        let all = (0..units.len()).flat_map(|at| (0..OF_COMPONENT).map(move |k| (at, k)));
        let columns: Vec<(usize, usize)> = all.filter(|(at, k)| exists(units[*at], *k)).collect();
        if columns.is_empty() {
            return Vec::new();
        }
        let gram = |choose: fn(&Grams) -> &Matrix6<f64>| {
            DMatrix::from_fn(columns.len(), columns.len(), |i, j| {
                let [(a, k), (b, l)] = [columns[i], columns[j]];
                let grams = grams.get(&[units[a], units[b]]);
                grams.map_or(0.0, |grams| choose(grams)[(k, l)] + FIRM * grams.firm[(k, l)])
            })
        };
        let (held, moved) = (gram(|grams| &grams.held), gram(|grams| &grams.moved));
        let scale: Vec<f64> = moved.diagonal().iter().map(|d| if *d > 0.0 { d.sqrt().recip() } else { 1.0 }).collect();
        let scaled = |m: &DMatrix<f64>| DMatrix::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)] * scale[i] * scale[j]);
        let mut mass = scaled(&moved);
        (0..mass.nrows()).for_each(|i| mass[(i, i)] += UNIT);
        let Some(factor) = mass.cholesky().map(|c| c.l()) else { return Vec::new() };
        let inverse = factor.clone().try_inverse().unwrap_or(factor);
        let pencil = &inverse * scaled(&held) * inverse.transpose();
        let eigen = SymmetricEigen::new(0.5 * (&pencil + pencil.transpose()));
        let mut motions: Vec<DVector<f64>> = Vec::new();
        for (k, value) in eigen.eigenvalues.iter().enumerate() {
            if *value < tilt * tilt {
                let motion = inverse.tr_mul(&eigen.eigenvectors.column(k));
                let mut all = DVector::zeros(OF_COMPONENT * units.len());
                columns.iter().enumerate().for_each(|(i, (at, k))| all[OF_COMPONENT * at + k] = motion[i] * scale[i]);
                motions.push(all.normalize());
            }
        }
        units.iter().enumerate().filter_map(|(at, &unit)| Some((unit, self.named(unit, at, &motions)?))).collect()
    }

    /// The motions of a component or a tool, whose velocities stand at a place in them.
    fn named(&self, unit: usize, at: usize, motions: &[DVector<f64>]) -> Option<Free> {
        let own = basis(motions, OF_COMPONENT * at, OF_COMPONENT);
        let Some(index) = unit.checked_sub(self.components.len()) else {
            let Rigid { who, body, is_whole, center, size } = &self.components[unit];
            let (along, about) = translations_and_rotations(&own, center, *size);
            let free = Free { who: who.clone(), is_tool: false, is_piece: !is_whole, index: *body, along, about };
            return (!own.is_empty()).then_some(free);
        };
        let (name, (_, axle)) = &self.tools[index];
        let along = axes_of(&own.iter().map(|m| Vec3::new(m[0], m[1], m[2])).collect::<Vec<_>>());
        let turns = own.iter().any(|m| m[3].abs() > SLIGHT);
        let about: Vec<_> = axle.iter().filter(|_| turns).map(|axle| (axle.axis, axle.point)).collect();
        let free = Free { who: format!("tool `{name}`"), is_tool: true, is_piece: false, index, along, about };
        (!free.along.is_empty() || !free.about.is_empty()).then_some(free)
    }
}

/// What is held of the contacts that may come with a master.
#[derive(Clone, Copy, Debug, Default)]
struct Ground {
    /// Some component of the master is.
    has_master: bool,
    /// The slaves that are, with the entries of the first component of the master.
    slaves: Grams,
}

/// The other side of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    Component(usize),
    Tool(usize),
}

impl Side {
    /// That of a pair, which meets this component if it meets a body.
    pub fn of(pair: &Pair, component: Option<usize>) -> Option<Self> {
        pair.master.tool().map(Self::Tool).or(component.map(Self::Component))
    }
}

/// An orthonormal basis of what the motions do in some of their components.
fn basis(motions: &[DVector<f64>], first: usize, count: usize) -> Vec<DVector<f64>> {
    if motions.is_empty() {
        return Vec::new();
    }
    let part = DMatrix::from_fn(count, motions.len(), |i, j| motions[j][first + i]);
    let (gram, largest) = (&part * part.transpose(), part.norm());
    let eigen = SymmetricEigen::new(gram);
    let is_some = |k: &usize| largest > SLIGHT && eigen.eigenvalues[*k] > SLIGHT * SLIGHT;
    (0..count).filter(is_some).map(|k| eigen.eigenvectors.column(k).into_owned()).collect()
}

/// Directions in which a body translates, and axes about which it turns besides.
fn translations_and_rotations(own: &[DVector<f64>], center: &Vec3, size: f64) -> (Vec<Vec3>, Vec<(Vec3, Vec3)>) {
    if own.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let part = |m: &DVector<f64>, from: usize| Vec3::new(m[from], m[from + 1], m[from + 2]);
    // Combinations without rotation, and those with each of the rotations that there are.
    let turns = DMatrix::from_fn(3, own.len(), |i, j| own[j][3 + i]);
    let eigen = SymmetricEigen::new(turns.tr_mul(&turns));
    let combined =
        |weights: &[f64], from: usize| own.iter().zip(weights).map(|(m, w)| part(m, from) * *w).sum::<Vec3>();
    let (mut along, mut spins) = (Vec::new(), Vec::new());
    for k in 0..own.len() {
        let weights: Vec<f64> = eigen.eigenvectors.column(k).iter().copied().collect();
        if eigen.eigenvalues[k] > SLIGHT * SLIGHT {
            spins.push((combined(&weights, 3), combined(&weights, 0)));
        } else {
            along.push(combined(&weights, 0));
        }
    }
    let along = axes_of(&along);
    let axes = axes_of(&spins.iter().map(|(turn, _)| *turn).collect::<Vec<_>>());
    let turning = |axis: &Vec3| {
        // The combination of the rotations that is this one, without what translates anyway.
        let matrix = DMatrix::from_fn(3, spins.len(), |i, j| spins[j].0[i]);
        let weights = matrix.svd(true, true).solve(&DVector::from_column_slice(axis.as_slice()), SLIGHT).ok()?;
        let mut velocity: Vec3 = spins.iter().zip(weights.iter()).map(|((_, v), w)| v * *w).sum();
        along.iter().for_each(|a| velocity -= a * a.dot(&velocity));
        Some((*axis, center + axis.cross(&velocity) * size))
    };
    let about = axes.iter().filter_map(turning).collect();
    (along, about)
}

/// An orthonormal basis of the span of vectors, of coordinate axes as far as these lie in it.
fn axes_of(vectors: &[Vec3]) -> Vec<Vec3> {
    let span = vectors.iter().map(|v| v * v.transpose()).sum::<crate::Mat3>();
    let eigen = SymmetricEigen::new(span);
    let is_some = |k: &usize| eigen.eigenvalues[*k] > SLIGHT * SLIGHT;
    let directions: Vec<Vec3> = (0..3).filter(is_some).map(|k| eigen.eigenvectors.column(k).into_owned()).collect();
    let within = |v: &Vec3| directions.iter().map(|d| d * d.dot(v)).sum::<Vec3>();
    let mut axes: Vec<Vec3> =
        (0..3).map(|d| Vec3::ith(d, 1.0)).filter(|axis| (within(axis) - axis).norm() < TILT).collect();
    for direction in &directions {
        let rest = direction - axes.iter().map(|a| a * a.dot(direction)).sum::<Vec3>();
        if axes.len() < directions.len() && rest.norm() > TILT.sqrt() {
            let rest = rest.normalize();
            axes.push(if rest[rest.iamax()] < 0.0 { -rest } else { rest });
        }
    }
    axes
}

impl Free {
    /// "along x and y, and turn about z".
    pub fn motion(&self) -> String {
        let along: Vec<String> = self.along.iter().map(name).collect();
        let about: Vec<String> = self.about.iter().map(|(axis, point)| turn(axis, point)).collect();
        match (along.is_empty(), about.is_empty()) {
            (false, true) => format!("move along {}", listed(&along)),
            (true, _) => format!("turn about {}", listed(&about)),
            (false, false) => format!("move along {}, and turn about {}", listed(&along), listed(&about)),
        }
    }
}

fn turn(axis: &Vec3, point: &Vec3) -> String {
    let on = (point - axis * axis.dot(point)).map(|x| if x.abs() < 5e-5 { 0.0 } else { x });
    format!("{} through ({:.4}, {:.4}, {:.4})", name(axis), on.x, on.y, on.z)
}

/// x, y or z, or the vector.
fn name(v: &Vec3) -> String {
    match (0..3).find(|&d| v[d].abs() > 1.0 - TILT) {
        Some(d) => AXIS_NAMES[d].into(),
        None => format!("({:.3}, {:.3}, {:.3})", v.x, v.y, v.z),
    }
}

/// "a, b and c".
fn listed(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motions(tools: &[[bool; 3]]) -> RigidMotions {
        let tools = tools.iter().map(|free| ("t".to_string(), (*free, None))).collect();
        let cube = Rigid {
            who: "body `a`".into(),
            body: 0,
            is_whole: true,
            center: Vec3::new(1.0, 1.0, 1.0),
            size: 3f64.sqrt(),
        };
        RigidMotions::of(vec![cube], tools)
    }

    /// The corners of a face of the cube from 0 to 2.
    fn face(axis: usize, at: f64) -> [Vec3; 4] {
        [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]].map(|[u, v]| {
            let mut x = Vec3::ith(axis, at);
            (x[(axis + 1) % 3], x[(axis + 2) % 3]) = (u, v);
            x
        })
    }

    fn told(motions: &RigidMotions) -> Vec<String> {
        motions.loose(TILT).iter().map(|free| format!("{} {}", free.who, free.motion())).collect()
    }

    #[test]
    fn a_free_body_has_six_motions_and_three_points_hold_it() {
        let mut one = motions(&[]);
        assert_eq!(told(&one).len(), 1);
        let free = &one.loose(TILT)[0];
        assert_eq!((free.along.len(), free.about.len()), (3, 3));
        let [a, b, c, _] = face(2, 0.0);
        for d in 0..3 {
            one.hold(0, &a, &Vec3::ith(d, 1.0));
        }
        let free = &one.loose(TILT)[0];
        assert_eq!((free.along.len(), free.about.len()), (0, 3));
        assert!(free.about.iter().all(|(axis, x)| axis.cross(x).norm() < 1e-6), "{free:?}");
        one.hold(0, &b, &Vec3::y());
        one.hold(0, &b, &Vec3::z());
        assert_eq!(told(&one), ["body `a` turn about x through (0.0000, 0.0000, 0.0000)"]);
        one.hold(0, &c, &Vec3::z());
        assert!(one.loose(TILT).is_empty());
    }

    #[test]
    fn a_smooth_plane_holds_three_motions_and_a_rough_one_all() {
        let plane = |sticks: bool| {
            let mut one = motions(&[[false; 3]]);
            face(2, 0.0).iter().for_each(|x| one.touch(0, Side::Tool(0), x, &Vec3::z(), sticks));
            one
        };
        assert_eq!(
            told(&plane(false)),
            ["body `a` move along x and y, and turn about z through (1.0000, 1.0000, 0.0000)"]
        );
        assert!(plane(true).loose(TILT).is_empty());
    }

    #[test]
    fn a_tool_that_is_free_takes_the_body_along() {
        let mut both = motions(&[[false, false, true]]);
        face(2, 2.0).iter().for_each(|x| both.touch(0, Side::Tool(0), x, &-Vec3::z(), true));
        assert_eq!(told(&both), ["body `a` move along z", "tool `t` move along z"]);
        face(2, 0.0).iter().for_each(|x| both.hold(0, x, &Vec3::z()));
        assert!(both.loose(TILT).is_empty());
    }

    /// A clamp that is a thousandth of the body holds it; a slope that is not seen to be one does not.
    #[test]
    fn what_is_small_holds_and_what_is_inexact_does_not() {
        let mut clamp = motions(&[]);
        for x in [Vec3::zeros(), Vec3::new(2e-3, 0.0, 0.0), Vec3::new(0.0, 2e-3, 0.0)] {
            (0..3).for_each(|d| clamp.hold(0, &x, &Vec3::ith(d, 1.0)));
        }
        assert!(clamp.loose(TILT).is_empty());
        let mut ball = motions(&[[false; 3]]);
        for k in 0..60 {
            let (a, b) = (0.4 * f64::from(k), 0.1 * f64::from(k % 30));
            let out = Vec3::new(a.cos() * b.sin(), a.sin() * b.sin(), b.cos());
            let tilted = (out + 1e-4 * Vec3::new(b.sin(), a.cos(), a.sin())).normalize();
            ball.touch(0, Side::Tool(0), &(Vec3::repeat(1.0) + out), &-tilted, false);
        }
        let free = ball.loose(TILT);
        assert_eq!((free.len(), free[0].along.len(), free[0].about.len()), (1, 0, 3));
    }
}
