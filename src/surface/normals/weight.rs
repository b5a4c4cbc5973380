//! Weights of the facets around a node in the mean of their normals.
//!
//! The nodal normal is the direction of sum w_i n_i over the facets at the node, (52), where n_i is orthogonal to the
//! two edges `a` and `b` of the facet that meet there, with the angle alpha between them. Jin, Lewis and West (2005, Visual
//! Computer 21, 71-82) compare the weights.

use super::super::facets::Facets;
use crate::Vec3;

/// Weight of a facet in the mean normal of its node, where its edges `a` and `b` meet at the angle alpha.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Weight {
    /// 1 (Gouraud 1971).
    Equal,
    /// |a x b|, twice the area of the triangle that the two edges span.
    Area,
    /// alpha (Thürmer and Wüthrich 1998).
    Angle,
    /// sin(alpha)/(|a||b|) (Max 1999): exact on spheres, and on circles drawn out.
    #[default]
    Sine,
    /// 1/(|a||b|) (Max 1999).
    Edge,
    /// 1/sqrt(|a||b|) (Max 1999).
    RootEdge,
    /// 1/|g|^2, where g runs from the node to the centroid of the facet (Chen and Wu 2004).
    Centroid,
}

impl Weight {
    /// All weights, by what the user calls them.
    pub const ALL: [(&str, Self); 7] = [
        ("equal", Self::Equal),
        ("area", Self::Area),
        ("angle", Self::Angle),
        ("sine", Self::Sine),
        ("edge", Self::Edge),
        ("root-edge", Self::RootEdge),
        ("centroid", Self::Centroid),
    ];

    /// What the user calls it.
    pub fn key(self) -> &'static str {
        Self::ALL.iter().find(|(_, weight)| *weight == self).map_or("", |(key, _)| key)
    }

    /// Normal and weight of facet `f` at its corner `k`.
    pub fn at(self, facets: &Facets, f: usize, k: usize) -> (Vec3, f64) {
        let (cross, alpha) = facets.corner(f, k);
        let area = cross.norm();
        let lengths = facets.edge(f, k).norm() * facets.edge(f, k + facets.count(f) - 1).norm();
        let weight = match self {
            Self::Equal => 1.0,
            Self::Area => area,
            Self::Angle => alpha,
            Self::Sine => area / (lengths * lengths),
            Self::Edge => 1.0 / lengths,
            Self::RootEdge => 1.0 / lengths.sqrt(),
            Self::Centroid => 1.0 / (facets.centroid(f) - facets.point(f, k)).norm_squared(),
        };
        (cross / area, weight)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::test_meshes::mesh_of;

    /// A corner with edges of lengths 2 and 3 at 30 degrees, of a triangle and of a quadrilateral.
    #[test]
    fn weights_are_those_of_their_authors() {
        let (x, y) = (3.0 * f64::sqrt(0.75), 1.5);
        let points = vec![[0.0; 3], [2.0, 0.0, 0.0], [2.0 + x, y, 0.3], [x, y, 0.0]];
        let triangle = Facets::new(&mesh_of(points.clone(), &[&[0, 1, 3]]), false).unwrap();
        let quad = Facets::new(&mesh_of(points, &[&[0, 1, 2, 3]]), false).unwrap();
        let centroids = [((2.0 + x) / 3.0).powi(2) + 0.25, ((2.0 + x) / 2.0).powi(2) + 0.75 * 0.75 + 0.075 * 0.075];
        for (facets, centroid) in [triangle, quad].iter().zip(centroids) {
            let expected =
                [1.0, 3.0, std::f64::consts::FRAC_PI_6, 1.0 / 12.0, 1.0 / 6.0, 1.0 / 6f64.sqrt(), 1.0 / centroid];
            for ((name, weight), expected) in Weight::ALL.iter().zip(expected) {
                let (normal, found) = weight.at(facets, 0, 0);
                assert!((found - expected).abs() < 1e-14 && normal == Vec3::z(), "{name}: {found}, not {expected}");
            }
        }
    }
}
