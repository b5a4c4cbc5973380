//! Moving patches as numbers, to be sent to other ranks.

use super::{MovingPatch, Neighbour, NormalRule, QuadraticFace};
use crate::Mat3;
use crate::surface::numbers::{Numbers, flags, from_flags};

impl MovingPatch {
    /// The patch as numbers.
    pub fn to_numbers(&self) -> Vec<f64> {
        let mut to = vec![
            self.id as f64,
            self.count as f64,
            f64::from(self.component),
            flags(&self.edges, &self.on_boundary),
            self.bulge,
        ];
        to.extend(self.straight.map(f64::from));
        to.push(self.quadratic.map_or(0.0, QuadraticFace::number));
        to.extend(self.corners.map(f64::from));
        to.push(self.nodes.len() as f64);
        to.extend(self.nodes.iter().map(|n| *n as f64));
        to.push(self.normals.len() as f64);
        for rule in &self.normals {
            match rule {
                NormalRule::Mean { node, spokes, corners, within } => {
                    to.extend([0, *node, spokes.len() as u32, corners.len() as u32].map(f64::from));
                    to.extend(spokes.iter().chain(corners.iter().flatten()).map(|i| f64::from(*i)));
                    to.push(within.iter().len() as f64);
                    to.extend(within.iter().flatten());
                }
                NormalRule::End { node, neighbours, directions } => {
                    to.extend([*directions as u32, *node, neighbours.len() as u32].map(f64::from));
                    for u in neighbours {
                        to.extend([f64::from(u.node), f64::from(u.normal), u.weights[0], u.weights[1]]);
                    }
                }
            }
        }
        to
    }

    /// The patches whose [`Self::to_numbers`] stand one after the other. Ends at numbers that are no patch.
    pub fn from_numbers(numbers: &[f64]) -> Vec<Self> {
        let mut numbers = Numbers(numbers);
        std::iter::from_fn(|| numbers.patch()).collect()
    }
}

impl QuadraticFace {
    const ALL: [Self; 4] = [Self::Triangle, Self::CornerOfSix, Self::MiddleOfSix, Self::QuarterOfNine];

    /// From 1.
    fn number(self) -> f64 {
        f64::from(self as u8 + 1)
    }

    fn of_number(number: f64) -> Option<Self> {
        Self::ALL.into_iter().find(|face| face.number() == number)
    }
}

impl Numbers<'_> {
    fn patch(&mut self) -> Option<MovingPatch> {
        let (id, count) = (self.number()? as u32, self.number()? as u8);
        let component = self.number()? as u32;
        let (edges, on_boundary) = from_flags(self.number()?);
        let bulge = self.number()?;
        let straight = [self.number()?, self.number()?, self.number()?, self.number()?].map(|x| x != 0.0);
        let quadratic = QuadraticFace::of_number(self.number()?);
        let corners = [self.number()?, self.number()?, self.number()?, self.number()?].map(|x| x as u32);
        let nodes = self.count()?;
        let nodes = self.take(nodes)?.iter().map(|n| *n as u64).collect();
        let normals = self.count()?;
        let normals = (0..normals).map(|_| self.rule()).collect::<Option<_>>()?;
        Some(MovingPatch {
            id,
            count,
            nodes,
            edges,
            straight,
            on_boundary,
            component,
            normals,
            corners,
            bulge,
            quadratic,
        })
    }

    fn rule(&mut self) -> Option<NormalRule> {
        let indices = |numbers: &[f64]| numbers.iter().map(|x| *x as u32).collect();
        let (kind, node, count) = (self.number()?, self.number()? as u32, self.count()?);
        if kind == 0.0 {
            let corners = self.count()?;
            let spokes = indices(self.take(count)?);
            let corners = self.take(2 * corners)?.chunks_exact(2).map(|c| [c[0] as u32, c[1] as u32]).collect();
            let within = self.count()?;
            let within = (within > 0).then(|| self.take(9).map(Mat3::from_column_slice)).flatten();
            return Some(NormalRule::Mean { node, spokes, corners, within });
        }
        let neighbour = |u: &[f64]| Neighbour { node: u[0] as u32, normal: u[1] as u32, weights: [u[2], u[3]] };
        let neighbours = self.take(4 * count)?.chunks_exact(4).map(neighbour).collect();
        Some(NormalRule::End { node, neighbours, directions: kind as u8 })
    }
}
