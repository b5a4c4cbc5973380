//! Probes: what the fields of bodies are at points, along lines, and on sets, in tables.

use super::State;
use super::body_fields::Known;
use crate::Vec3;
use crate::error::{Error, Result};
use crate::model::Model;
use crate::model::locate::{Spot, locate, nearest};
use crate::output::OutputFolder;
use crate::output::history::ProbeFile;
use crate::output::quantity::Quantity;
use crate::parallel::{max, sum};
use crate::scene::{self, ProbePlace, Scene};
use mpi::topology::SimpleCommunicator;
use std::collections::BTreeMap;
use std::path::Path;

/// The probes of a scene with their tables.
pub(super) struct Probes(Vec<(Probe, [String; 2], ProbeFile)>);

/// What each probe looks at, and how long its table is, by the probes' names.
pub(super) type Lengths = BTreeMap<String, (String, u64)>;

/// A probe with its places found.
struct Probe {
    place: Spots,
    fields: Vec<Quantity>,
}

enum Spots {
    /// One row an increment.
    Point(Option<Box<Spot>>),
    /// One row an increment; the owned nodes.
    Nodes(Vec<u32>),
    /// With the fields, a row a point: what leads it, and the point if it is on this rank.
    Path(Vec<([f64; 4], Option<Spot>)>),
}

/// Refuses probes that are not in a body. Collective.
///
/// # Errors
/// A point in no body, with what is nearest, on all ranks.
pub(super) fn check(comm: &SimpleCommunicator, scene: &Scene, model: &Model) -> Result<()> {
    scene.output.probes.iter().try_for_each(|probe| Probe::new(comm, probe, model).map(|_| ()))
}

/// Refuses probes that are not what those of the same name were when their tables were so long.
///
/// # Errors
/// A probe with another place, or other fields.
pub(super) fn check_same(scene: &Scene, lengths: &Lengths) -> Result<()> {
    let differs = |probe: &&scene::Probe| lengths.get(&probe.name.value).is_some_and(|(was, _)| *was != probe.words());
    let Some(probe) = scene.output.probes.iter().find(differs) else { return Ok(()) };
    let what = format!("probe `{}` has another place, or other fields, than at the checkpoint", probe.name.value);
    Err(Error::input(&probe.name.at, what, "give another probe another name"))
}

impl Probes {
    /// Finds the places and begins the tables. Collective.
    ///
    /// # Errors
    /// A point in no body; a file that cannot be written; on all ranks.
    pub fn create(comm: &SimpleCommunicator, folder: &OutputFolder, scene: &Scene, model: &Model) -> Result<Self> {
        Self::go_on(comm, folder, scene, model, &Lengths::new())
    }

    /// Goes on with the tables of an earlier run, as long as they were. Collective.
    ///
    /// # Errors
    /// As [`Self::create`]; a table of something else.
    pub fn go_on(
        comm: &SimpleCommunicator,
        folder: &OutputFolder,
        scene: &Scene,
        model: &Model,
        lengths: &Lengths,
    ) -> Result<Self> {
        let begin = |given: &scene::Probe| {
            let (probe, name, words) = (Probe::new(comm, given, model)?, &given.name.value, given.words());
            let length = lengths.get(name).map(|(_, length)| *length);
            let file = ProbeFile::go_on(folder, comm, name, &probe.columns(), length)?;
            Ok((probe, [name.clone(), words], file))
        };
        Ok(Self(scene.output.probes.iter().map(begin).collect::<Result<_>>()?))
    }

    /// Bytes so far, which count on rank 0.
    pub fn lengths(&self) -> Lengths {
        self.0.iter().map(|(_, [name, words], file)| (name.clone(), (words.clone(), file.length()))).collect()
    }

    /// The tables.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        self.0.iter().map(|(.., file)| file.file())
    }

    /// Whether a probe needs what is recovered of each increment, or only of those whose fields are written.
    pub fn need_recovery(&self, written: bool) -> bool {
        let needs = |probe: &Probe| probe.fields.iter().any(|field| field.is_recovered());
        self.0.iter().any(|(probe, ..)| (written || !probe.is_path()) && needs(probe))
    }

    /// Adds a row for each point and set. Collective.
    ///
    /// # Errors
    /// A file that cannot be written, on all ranks.
    pub fn add_increment(&mut self, comm: &SimpleCommunicator, model: &Model, of: (&State, Known)) -> Result<()> {
        self.add(comm, model, of, false)
    }

    /// Adds the rows of each path. Collective.
    ///
    /// # Errors
    /// A file that cannot be written, on all ranks.
    pub fn add_paths(&mut self, comm: &SimpleCommunicator, model: &Model, of: (&State, Known)) -> Result<()> {
        self.add(comm, model, of, true)
    }

    fn add(&mut self, comm: &SimpleCommunicator, model: &Model, of: (&State, Known), paths: bool) -> Result<()> {
        let (state, _) = of;
        for (probe, _, file) in self.0.iter_mut().filter(|(probe, ..)| probe.is_path() == paths) {
            let values = probe.values(comm, model, of);
            file.rows(comm, (state.increments, state.time), probe.columns().len(), &values)?;
        }
        Ok(())
    }
}

impl Probe {
    /// Collective.
    fn new(comm: &SimpleCommunicator, given: &scene::Probe, model: &Model) -> Result<Self> {
        let body = given.body.as_ref().and_then(|body| model.bodies.iter().position(|b| b.name == body.value));
        let find = |points: &[Vec3], at| {
            locate(comm, model, points, body).map_err(|lost| {
                let x = points[lost];
                let whose = given.body.as_ref().map_or("in no body".into(), |body| format!("not in `{}`", body.value));
                let what = format!("probe `{}`: [{:?}, {:?}, {:?}] is {whose}", given.name.value, x.x, x.y, x.z);
                let near = nearest(comm, model, &x, body);
                Error::input(at, what, format!("{near}; positions are those before anything deforms"))
            })
        };
        let place = match &given.place {
            ProbePlace::Point(x) => Spots::Point(find(&[x.value], &x.at)?[0].map(Box::new)),
            ProbePlace::Set(set) => Spots::Nodes(model.set(&set.value).nodes.clone()),
            ProbePlace::Path(ends, count) => {
                let [from, to] = ends.value;
                let part = |k: usize| k as f64 / (count - 1) as f64;
                let points: Vec<Vec3> = (0..*count).map(|k| from.lerp(&to, part(k))).collect();
                let spots = find(&points, &ends.at)?;
                let leads = points.iter().map(|x| [(x - from).norm(), x.x, x.y, x.z]);
                Spots::Path(leads.zip(spots).collect())
            }
        };
        Ok(Self { place, fields: given.fields.clone() })
    }

    fn is_path(&self) -> bool {
        matches!(self.place, Spots::Path(_))
    }

    /// Columns of the table behind increment and time.
    fn columns(&self) -> Vec<String> {
        let of_fields = self.fields.iter().flat_map(|field| field.columns());
        match self.place {
            Spots::Point(_) => of_fields.collect(),
            Spots::Nodes(_) => {
                of_fields.flat_map(|c| ["mean", "min", "max"].map(|kind| format!("{c}.{kind}"))).collect()
            }
            Spots::Path(_) => ["distance", "x", "y", "z"].map(String::from).into_iter().chain(of_fields).collect(),
        }
    }

    /// The numbers of these columns, row by row, on all ranks. Collective.
    fn values(&self, comm: &SimpleCommunicator, model: &Model, of: (&State, Known)) -> Vec<f64> {
        let width = self.fields.iter().map(|field| field.width()).sum();
        let at = |spot: Option<&Spot>| match spot {
            Some(spot) => self.interpolated(model, of, spot),
            None => vec![0.0; width],
        };
        match &self.place {
            Spots::Nodes(nodes) => {
                let rows: Vec<_> = nodes.iter().map(|&n| self.interpolated(model, of, &Spot::node(n))).collect();
                spread(comm, &rows, width)
            }
            Spots::Point(spot) => {
                let mut values = at(spot.as_deref());
                sum(comm, &mut values);
                values
            }
            Spots::Path(points) => {
                let mut values: Vec<f64> = points.iter().flat_map(|(_, spot)| at(spot.as_ref())).collect();
                sum(comm, &mut values);
                points.iter().zip(values.chunks(width)).flat_map(|((lead, _), own)| [&lead[..], own].concat()).collect()
            }
        }
    }

    /// Displacements, stresses and strains are those of the nodes, weighted by shape functions; other measures are those of
    /// the stress and strain at the point.
    fn interpolated(&self, model: &Model, (state, known): (&State, Known), spot: &Spot) -> Vec<f64> {
        let mut values = Vec::new();
        for field in &self.fields {
            match (field, known.recovered) {
                (Quantity::Nodal(measure), Some(recovered)) => {
                    let mut tensor = [0.0; 6];
                    for (n, share) in spot.shares() {
                        let strain = measure.is_of_strain();
                        let of_element = |e| recovered.of_element(strain, model, e, n);
                        let own = spot.element.map_or_else(|| recovered.of(strain, model, n), of_element);
                        (0..6).for_each(|k| tensor[k] += share * own[k]);
                    }
                    measure.add(&tensor, &mut values);
                }
                _ => {
                    let moved: Vec3 = spot.shares().map(|(n, share)| share * state.u[n]).sum();
                    values.extend(moved.iter());
                }
            }
        }
        values
    }
}

/// Mean, least and largest of each column over the rows of all ranks. Collective.
fn spread(comm: &SimpleCommunicator, rows: &[Vec<f64>], width: usize) -> Vec<f64> {
    let (mut sums, mut ends) = (vec![0.0; width + 1], vec![f64::NEG_INFINITY; 2 * width]);
    for row in rows {
        sums[width] += 1.0;
        for (k, value) in row.iter().enumerate() {
            sums[k] += value;
            ends[2 * k] = ends[2 * k].max(-value);
            ends[2 * k + 1] = ends[2 * k + 1].max(*value);
        }
    }
    sum(comm, &mut sums);
    max(comm, &mut ends);
    (0..width).flat_map(|k| [sums[k] / sums[width], -ends[2 * k], ends[2 * k + 1]]).collect()
}
