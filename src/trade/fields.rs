//! `fields.h5` read back at the ends of steps: stresses and plastic strains of bodies, pressures of contacts.

use super::history::History;
use crate::Vec3;
use crate::error::{Error, Result};
use crate::output::quantity::Quantity;
use crate::solid::element::{hex8, pyramid5, tet4, tet10, wedge6};
use crate::solid::measure::Measure;
use hdf5::{File, Group};
use rstar::RTree;
use rstar::primitives::GeomWithData;
use std::collections::BTreeMap;
use std::path::Path;

/// What is read.
pub const READ: [Quantity; 6] = [
    Quantity::Mean(Measure::Stress),
    Quantity::Mean(Measure::VonMises),
    Quantity::EquivalentPlasticStrain,
    Quantity::Pressure,
    Quantity::Force,
    Quantity::Normal,
];

/// The end of a step.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    pub bodies: BTreeMap<String, BodyState>,
    /// Of each contact, the mean of the pressure by the force that it bears: sum of f p over sum of f, with the normal
    /// forces f and the pressures p of the slave nodes; 0 without force.
    pub pressures: BTreeMap<String, f64>,
}

/// What a body bears, by elements.
#[derive(Clone, Debug, Default)]
pub struct BodyState {
    centroids: Vec<[f64; 3]>,
    /// At rest.
    volumes: Vec<f64>,
    /// Cauchy: xx, yy, zz, xy, yz, xz.
    stress: Vec<[f64; 6]>,
    von_mises: Vec<f64>,
    /// Equivalent plastic strain, where the body can flow.
    strain: Option<Vec<f64>>,
}

/// Codes of XDMF.
const TETRAHEDRON: i64 = 6;
const PYRAMID: i64 = 7;
const WEDGE: i64 = 8;

/// Reads the ends of all steps of a run.
///
/// # Errors
/// [`Error::System`] when the file is not there, or not as `nagata` writes it.
pub fn read(path: &Path, history: &History, bodies: &[&str], contacts: &[&str]) -> Result<Vec<Snapshot>> {
    let failed = |error: hdf5::Error| Error::System(format!("cannot read {}: {error}", path.display()));
    let file = File::open(path).map_err(failed)?;
    let rest: Vec<BodyState> = bodies.iter().map(|b| at_rest(&file, b)).collect::<hdf5::Result<_>>().map_err(failed)?;
    let times: Vec<f64> = history.ends().iter().map(|&(_, row)| history.times()[row]).collect();
    let mut names = file.group("increments").and_then(|group| group.member_names()).map_err(failed)?;
    names.sort();
    let mut snapshots = Vec::new();
    for name in names {
        let group = file.group(&format!("increments/{name}")).map_err(failed)?;
        let time = numbers(&group, "time").map_err(failed)?;
        if times.iter().any(|end| time.first() == Some(end)) {
            snapshots.push(snapshot(&group, &rest, bodies, contacts).map_err(failed)?);
        }
    }
    if snapshots.len() == times.len() {
        Ok(snapshots)
    } else {
        Err(Error::System(format!("{} lacks the end of a step", path.display())))
    }
}

fn snapshot(group: &Group, rest: &[BodyState], bodies: &[&str], contacts: &[&str]) -> hdf5::Result<Snapshot> {
    let mut snapshot = Snapshot::default();
    for (body, rest) in bodies.iter().zip(rest) {
        let cell = group.group(&format!("body_{body}/cell"))?;
        let strain = cell.link_exists("equivalent_plastic_strain");
        let state = BodyState {
            stress: numbers(&cell, "stress")?.as_chunks::<6>().0.to_vec(),
            von_mises: numbers(&cell, "von_mises")?,
            strain: if strain { Some(numbers(&cell, "equivalent_plastic_strain")?) } else { None },
            ..rest.clone()
        };
        snapshot.bodies.insert(body.to_string(), state);
    }
    for contact in contacts {
        let node = group.group(&format!("contact_{contact}/node"))?;
        let (force, normal) = (numbers(&node, "force")?, numbers(&node, "normal")?);
        let forces: Vec<f64> = force.chunks(3).zip(normal.chunks(3)).map(|(f, n)| dot(f, n).max(0.0)).collect();
        snapshot.pressures.insert(contact.to_string(), mean(&numbers(&node, "pressure")?, &forces));
    }
    Ok(snapshot)
}

/// Centroids and volumes of a body's elements.
fn at_rest(file: &File, body: &str) -> hdf5::Result<BodyState> {
    let grid = file.group(&format!("grids/body_{body}"))?;
    let points: Vec<Vec3> = numbers(&grid, "points")?.chunks(3).map(Vec3::from_row_slice).collect();
    let cells = grid.dataset("cells")?;
    let (shape, nodes) = (cells.shape(), cells.read_raw::<i64>()?);
    let mut state = BodyState::default();
    let mut add = |nodes: &[i64]| {
        let x: Vec<[f64; 3]> = nodes.iter().map(|&node| points[node as usize].into()).collect();
        state.volumes.push(match x.len() {
            4 => x.as_array().map_or(0.0, tet4::volume),
            5 => x.as_array().map_or(0.0, pyramid5::volume),
            // Triangles of VTK's wedges run the other way round.
            6 => x.as_array().map_or(0.0, |x| -wedge6::volume(x)),
            10 => x.as_array().map_or(0.0, tet10::volume),
            _ => x.as_array().map_or(0.0, hex8::volume),
        });
        state.centroids.push([0, 1, 2].map(|c| x.iter().map(|x| x[c]).sum::<f64>() / x.len() as f64));
    };
    match shape.get(1) {
        Some(&width) => nodes.chunks(width).for_each(&mut add),
        None => {
            // Mixed, of linear elements: each behind the code of its shape.
            let mut rest = nodes.as_slice();
            while let [code, nodes @ ..] = rest {
                let (cell, others) = nodes.split_at(match *code {
                    TETRAHEDRON => 4,
                    PYRAMID => 5,
                    WEDGE => 6,
                    _ => 8,
                });
                add(cell);
                rest = others;
            }
        }
    }
    Ok(state)
}

fn numbers(group: &Group, name: &str) -> hdf5::Result<Vec<f64>> {
    group.dataset(name)?.read_raw::<f64>()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Mean by weights; 0 without any.
fn mean(values: &[f64], weights: &[f64]) -> f64 {
    let all: f64 = weights.iter().sum();
    if all > 0.0 { dot(values, weights) / all } else { 0.0 }
}

impl BodyState {
    /// The von Mises stress that one hundredth of the volume exceeds.
    pub fn high_stress(&self) -> f64 {
        exceeded(&self.von_mises, &self.volumes, HIGH)
    }

    /// The equivalent plastic strain that one hundredth of the volume exceeds.
    pub fn high_strain(&self) -> Option<f64> {
        self.strain.as_ref().map(|strain| exceeded(strain, &self.volumes, HIGH))
    }

    /// Root of the mean square of the stress over the volume.
    pub fn stress_scale(&self) -> f64 {
        mean(&self.stress.iter().map(square).collect::<Vec<_>>(), &self.volumes).sqrt()
    }

    /// Of the equivalent plastic strain.
    pub fn strain_scale(&self) -> Option<f64> {
        let strain = self.strain.as_ref()?;
        Some(mean(&strain.iter().map(|e| e * e).collect::<Vec<_>>(), &self.volumes).sqrt())
    }

    /// Root of the mean square difference of stress, and of plastic strain, to the same body on another mesh, over the volume:
    /// on the coarser mesh, onto whose elements the finer one is averaged.
    pub fn apart(&self, other: &Self) -> (f64, Option<f64>) {
        let (coarse, fine) = if self.volumes.len() <= other.volumes.len() { (self, other) } else { (other, self) };
        let nearest = coarse.nearest_of(fine);
        let stress = coarse.averaged(&fine.stress, fine, &nearest);
        let off = coarse.stress.iter().zip(&stress).map(|(a, b)| {
            let off: [f64; 6] = std::array::from_fn(|k| a[k] - b.map_or(a[k], |b| b[k]));
            square(&off)
        });
        let stress = mean(&off.collect::<Vec<_>>(), &coarse.volumes).sqrt();
        let strain = coarse.strain.as_ref().zip(fine.strain.as_ref()).map(|(own, others)| {
            let others: Vec<[f64; 1]> = others.iter().map(|&e| [e]).collect();
            let others = coarse.averaged(&others, fine, &nearest);
            let off = own.iter().zip(&others).map(|(a, b)| b.map_or(0.0, |[b]| (a - b) * (a - b)));
            mean(&off.collect::<Vec<_>>(), &coarse.volumes).sqrt()
        });
        (stress, strain)
    }

    /// The element whose centroid is nearest to that of each element of a finer mesh; of a uniform splitting it is the
    /// element that was split.
    fn nearest_of(&self, fine: &Self) -> Vec<usize> {
        let points = self.centroids.iter().enumerate().map(|(k, x)| GeomWithData::new(*x, k)).collect();
        let tree = RTree::bulk_load(points);
        fine.centroids.iter().filter_map(|x| tree.nearest_neighbor(*x)).map(|found| found.data).collect()
    }

    /// Means by volume over the elements of a finer mesh that are nearest; `None` where there are none.
    fn averaged<const N: usize>(&self, values: &[[f64; N]], fine: &Self, nearest: &[usize]) -> Vec<Option<[f64; N]>> {
        let mut sums = vec![([0.0; N], 0.0); self.volumes.len()];
        for ((value, volume), &k) in values.iter().zip(&fine.volumes).zip(nearest) {
            (0..N).for_each(|c| sums[k].0[c] += volume * value[c]);
            sums[k].1 += volume;
        }
        sums.into_iter().map(|(sum, volume)| (volume > 0.0).then(|| sum.map(|s| s / volume))).collect()
    }
}

/// The part of the volume that bears more than the high stress.
const HIGH: f64 = 0.01;

/// Square of a symmetric tensor, s : s.
fn square(s: &[f64; 6]) -> f64 {
    dot(&s[..3], &s[..3]) + 2.0 * dot(&s[3..], &s[3..])
}

/// The value that is exceeded in a part of the whole volume.
fn exceeded(values: &[f64], volumes: &[f64], part: f64) -> f64 {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
    let mut rest = part * volumes.iter().sum::<f64>();
    for &k in &order {
        rest -= volumes[k];
        if rest < 0.0 {
            return values[k];
        }
    }
    order.last().map_or(0.0, |&k| values[k])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bar along x in so many elements of growing lengths, with a stress xx and a strain by x.
    fn bar(count: usize, stress: impl Fn(f64) -> f64) -> BodyState {
        let end = |k: usize| (k as f64 / count as f64).powi(2);
        let middle = |k: usize| 0.5 * (end(k) + end(k + 1));
        let all = || 0..count;
        BodyState {
            centroids: all().map(|k| [middle(k), 0.5, 0.5]).collect(),
            volumes: all().map(|k| end(k + 1) - end(k)).collect(),
            stress: all().map(|k| [stress(middle(k)), 0.0, 0.0, 0.0, 0.0, 0.0]).collect(),
            von_mises: all().map(|k| stress(middle(k)).abs()).collect(),
            strain: Some(all().map(|k| stress(middle(k))).collect()),
        }
    }

    #[test]
    fn the_same_mesh_is_compared_element_by_element() {
        let (a, b) = (bar(7, |x| x), bar(7, |x| x + 0.25));
        let (stress, strain) = a.apart(&b);
        assert!((stress - 0.25).abs() < 1e-15 && (strain.unwrap() - 0.25).abs() < 1e-15);
        let (stress, strain) = a.apart(&a);
        assert!(stress < 1e-15 && strain.unwrap() < 1e-15, "means by volume are rounded");
    }

    /// What is linear has the same mean over an element as over its parts.
    #[test]
    fn a_split_mesh_is_averaged() {
        let coarse = bar(4, |x| 3.0 * x - 1.0);
        let mut fine = BodyState { strain: Some(Vec::new()), ..BodyState::default() };
        for (x, &volume) in coarse.centroids.iter().zip(&coarse.volumes) {
            for at in [x[0] - 0.25 * volume, x[0] + 0.25 * volume] {
                fine.centroids.push([at, 0.5, 0.5]);
                fine.volumes.push(0.5 * volume);
                fine.stress.push([3.0 * at - 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
                fine.strain.as_mut().unwrap().push(3.0 * at - 1.0);
            }
        }
        for (stress, strain) in [coarse.apart(&fine), fine.apart(&coarse)] {
            assert!(stress < 1e-15 && strain.unwrap() < 1e-15, "{stress} {strain:?}");
        }
    }

    #[test]
    fn shear_counts_twice_in_a_square() {
        assert_eq!(square(&[1.0, 2.0, 3.0, 1.0, 1.0, 1.0]), 20.0);
    }

    #[test]
    fn high_values_are_by_volume() {
        let (values, volumes) = ([5.0, 9.0, 7.0, 1.0], [0.5, 0.004, 0.01, 0.486]);
        assert_eq!(exceeded(&values, &volumes, 0.01), 7.0);
        assert_eq!(exceeded(&values, &volumes, 0.001), 9.0);
        assert_eq!(exceeded(&values, &volumes, 0.02), 5.0);
        assert_eq!(exceeded(&values, &volumes, 1.0), 1.0);
        // Half of a line from 0 to 1 is above 1/2.
        let line = bar(4000, |x| x);
        assert!((exceeded(&line.von_mises, &line.volumes, 0.5) - 0.5).abs() < 1e-3);
    }

    #[test]
    fn means_are_by_weight() {
        assert_eq!(mean(&[1.0, 4.0], &[3.0, 1.0]), 1.75);
        assert_eq!(mean(&[1.0, 4.0], &[0.0, 0.0]), 0.0);
    }
}
