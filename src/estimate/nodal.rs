//! Stress and strain at nodes, and how much the elements around a node differ from them.

use super::recovery::{Recovered, Values, nodes_of};
use crate::Vec3;
use crate::error::Result;
use crate::mesh::{MOST_NODES, SolidShape};
use crate::model::Model;
use crate::model::elements::{lost, medium, samples};
use crate::solid::element::{Formulation, Inverted, hex8, hex8_shell, hex27, pyramid5, tet10, wedge6, wedge18};
use crate::solid::voigt::{Voigt, double_contraction};

impl Recovered {
    /// Cauchy stress at a local node: tau / J, where ln J is the trace of the logarithmic strain.
    pub fn stress(&self, model: &Model, n: usize) -> Voigt {
        cauchy(&self.at_node(model, n))
    }

    /// Spatial logarithmic strain 1/2 ln b at a local node.
    pub fn strain(&self, model: &Model, n: usize) -> Voigt {
        let values = self.at_node(model, n);
        std::array::from_fn(|k| values[6 + k])
    }

    /// The one or the other.
    pub fn of(&self, strain: bool, model: &Model, n: usize) -> Voigt {
        if strain { self.strain(model, n) } else { self.stress(model, n) }
    }

    /// The same in the material of element `e`.
    pub fn of_element(&self, strain: bool, model: &Model, e: usize, n: usize) -> Voigt {
        let values = self.beside(model, e, model.part.tie[n] as usize);
        if strain { std::array::from_fn(|k| values[6 + k]) } else { cauchy(&values) }
    }
}

fn cauchy(values: &Values) -> Voigt {
    let volume_ratio = (values[6] + values[7] + values[8]).exp();
    std::array::from_fn(|k| values[k] / volume_ratio)
}

/// How far the Cauchy stress of the elements around each owned node is from that recovered there, at most: sqrt(d : d) of the
/// difference d. The stress of an element at its nodes is that of its integration points, extrapolated.
///
/// # Errors
/// An element that is inverted, by its number.
pub fn jumps(model: &Model, recovered: &Recovered, u: &[Vec3]) -> Result<Vec<f64>> {
    let mut most = vec![0.0f64; model.part.owned];
    for e in 0..model.part.solids.len() {
        let own = at_nodes(model, e, u).map_err(|_| lost(model, e))?;
        for (n, own) in nodes_of(model, e).zip(own).filter(|(n, _)| *n < model.part.owned) {
            let recovered = cauchy(&recovered.beside(model, e, n));
            let d: Voigt = std::array::from_fn(|k| own[k] - recovered[k]);
            most[n] = most[n].max(double_contraction(&d, &d).sqrt());
        }
    }
    Ok((0..model.part.owned).map(|n| most[model.part.tie[n] as usize]).collect())
}

/// Cauchy stress of an element at its nodes; as many as carry it count.
fn at_nodes(model: &Model, e: usize, u: &[Vec3]) -> std::result::Result<[Voigt; MOST_NODES], Inverted> {
    let (samples, medium) = (samples(model, e, u)?, medium(model, e));
    let mut points = vec![[0.0; 6]; samples.len()];
    for (q, sample) in samples.iter().enumerate() {
        let lost = Inverted { det_f: sample.det_f };
        let kirchhoff = medium.material.kirchhoff(&sample.f, medium.state(q)).ok_or(lost)?;
        points[q] = kirchhoff.map(|s| s / sample.det_f);
    }
    let sum = |weights: &[f64]| std::array::from_fn(|k| weights.iter().zip(&points).map(|(w, s)| w * s[k]).sum());
    let first = |values: &mut dyn Iterator<Item = Voigt>| std::array::from_fn(|_| values.next().unwrap_or_default());
    Ok(match (model.part.solids[e].shape, samples.len()) {
        (SolidShape::Tet4, _) => [points[0]; MOST_NODES],
        (SolidShape::Tet10, _) => first(&mut tet10::AT_NODES.iter().map(|weights| sum(weights))),
        (SolidShape::Wedge18, _) => first(&mut wedge18::AT_NODES.iter().map(|weights| sum(weights))),
        (SolidShape::Hex27, _) => first(&mut hex27::AT_NODES.iter().map(|weights| sum(weights))),
        (SolidShape::Wedge6, _) => first(&mut wedge6::AT_NODES.iter().map(|weights| sum(weights))),
        (SolidShape::Pyramid5, _) => first(&mut pyramid5::AT_NODES.iter().map(|weights| sum(weights))),
        (SolidShape::Hex8, count) if model.section(&model.part.solids[e]).element == Formulation::Hex8Shell => {
            first(&mut (0..8).map(|a| sum(&hex8_shell::at_node(a, count / hex8_shell::POINTS))))
        }
        (SolidShape::Hex8, count) => {
            // Points of a plane element stand for two above one another.
            let weights = |a: usize| -> [f64; 8] {
                std::array::from_fn(|q| match count {
                    8 => hex8::AT_NODES[a][q],
                    _ if q < count => hex8::AT_NODES[a][q] + hex8::AT_NODES[a][q + count],
                    _ => 0.0,
                })
            };
            first(&mut (0..8).map(|a| sum(&weights(a))))
        }
    })
}
