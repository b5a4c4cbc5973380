//! Faces to an IGES file, in millimetres: surfaces (128), trimmed (144) by loops (142) of splines (126, 102).

use crate::error::{Error, Result};
use crate::surface::{Curve, Face, Nurbs};
use nalgebra::{Matrix2, Vector2};
use std::fmt::Write;
use std::path::Path;

/// Writes faces so that [`read`](crate::cad::read) gives them back to the last digit, but for names and for the order
/// of loops. IGES knows no outside: the surface of a face that is `reversed` is written with its parameters swapped.
pub fn write(path: &Path, faces: &[Face]) -> Result<()> {
    let mut draft = Draft::default();
    for face in faces {
        draft.face(face);
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    std::fs::write(path, draft.finish(&name))
        .map_err(|error| Error::System(format!("cannot write '{}': {error}", path.display())))
}

/// A file in the making.
#[derive(Default)]
pub(super) struct Draft {
    directory: String,
    data: String,
    lines: usize,
    entities: usize,
}

/// Status of an entity that stands for itself, of a part of another, and of a part in the plane of parameters.
pub(super) const INDEPENDENT: u32 = 0;
const PART: u32 = 10_000;
const PART_IN_PARAMETERS: u32 = 10_500;

/// A spline on its own rather than one of the shapes that forms of 126 and 128 name.
const FREE: u32 = 0;

impl Draft {
    /// Adds an entity with its parameters behind the type; gives its number.
    pub fn add(&mut self, [kind, form, status]: [u32; 3], matrix: usize, parameters: &[String]) -> usize {
        let number = 2 * self.entities + 1;
        let first = self.lines + 1;
        let mut line = format!("{kind}");
        for parameter in parameters {
            line.push(',');
            if line.len() + parameter.len() >= 64 {
                self.data_line(&line, number);
                line.clear();
            }
            line.push_str(parameter);
        }
        self.data_line(&(line + ";"), number);
        let count = self.lines + 1 - first;
        let unused = |count: usize| format!("{:8}", 0).repeat(count);
        let fields =
            [format!("{kind:8}{first:8}"), unused(4), format!("{matrix:8}"), unused(1), format!("{status:08}")];
        let more = [format!("{kind:8}"), unused(2), format!("{count:8}{form:8}{:24}", ""), unused(1)];
        for (place, text) in [(number, fields.concat()), (number + 1, more.concat())] {
            let _ = writeln!(self.directory, "{text}D{place:7}");
        }
        self.entities += 1;
        number
    }

    /// The text of the file.
    pub fn finish(self, name: &str) -> String {
        let mut text = String::new();
        let _ = writeln!(text, "{:72}S{:7}", "Surfaces written by nagata", 1);
        let strings = ["nagata", name, "nagata", concat!("nagata ", env!("CARGO_PKG_VERSION"))];
        let strings = strings.map(|string| format!("{}H{string},", string.len())).concat();
        let global = format!("1H,,1H;,{strings}32,308,15,308,15,,1.,2,2HMM,1,,,1D-9,,,,11,0;");
        let mut globals = 0;
        for line in global.as_bytes().chunks(72) {
            globals += 1;
            let _ = writeln!(text, "{:72}G{globals:7}", String::from_utf8_lossy(line));
        }
        text.push_str(&self.directory);
        text.push_str(&self.data);
        let counts = format!("S{:7}G{globals:7}D{:7}P{:7}", 1, 2 * self.entities, self.lines);
        let _ = writeln!(text, "{counts:72}T{:7}", 1);
        text
    }

    fn data_line(&mut self, text: &str, owner: usize) {
        self.lines += 1;
        let _ = writeln!(self.data, "{text:64}{owner:8}P{:7}", self.lines);
    }

    fn face(&mut self, face: &Face) {
        let swap = Matrix2::new(0.0, 1.0, 1.0, 0.0);
        let turned = |curve: &Curve<2>| curve.transformed(&swap, &Vector2::zeros());
        let surface = if face.reversed { face.surface.swapped() } else { face.surface.clone() };
        let status = if face.loops.is_empty() { INDEPENDENT } else { PART };
        let surface = self.surface(&surface, status);
        let mut loops = Vec::new();
        for chain in &face.loops {
            let curves: Vec<Curve<2>> =
                chain.iter().map(|curve| if face.reversed { turned(curve) } else { curve.clone() }).collect();
            loops.push((extent(&curves), self.boundary(&curves, surface)));
        }
        // The outer loop first.
        loops.sort_by(|a, b| b.0.total_cmp(&a.0));
        if !loops.is_empty() {
            let counts = [surface, 1, loops.len() - 1];
            let parameters = counts.into_iter().chain(loops.into_iter().map(|part| part.1));
            self.add([144, 0, INDEPENDENT], 0, &texts(parameters));
        }
    }

    fn surface(&mut self, surface: &Nurbs, status: u32) -> usize {
        let [u, v] = surface.knots();
        let is_polynomial = surface.weights().iter().all(|weight| *weight == surface.weights()[0]);
        let counts = [u.count() - 1, v.count() - 1, u.degree(), v.degree(), 0, 0, usize::from(is_polynomial), 0, 0];
        let mut parameters = texts(counts);
        parameters.extend(reals(u.knots().iter().chain(v.knots()).chain(surface.weights()).copied()));
        parameters.extend(reals(surface.points().iter().flat_map(|point| [point.x, point.y, point.z])));
        parameters.extend(reals(surface.domain().concat()));
        self.add([128, FREE, status], 0, &parameters)
    }

    /// A loop on a surface.
    fn boundary(&mut self, curves: &[Curve<2>], surface: usize) -> usize {
        let curves: Vec<usize> = curves.iter().map(|curve| self.curve(curve)).collect();
        let chain = match curves[..] {
            [one] => one,
            _ => self.add([102, 0, PART_IN_PARAMETERS], 0, &texts([&[curves.len()], &curves[..]].concat())),
        };
        self.add([142, 0, PART], 0, &texts([0, surface, chain, 0, 1]))
    }

    fn curve(&mut self, curve: &Curve<2>) -> usize {
        let knots = curve.knots();
        let is_polynomial = curve.weights().iter().all(|weight| *weight == curve.weights()[0]);
        let mut parameters = texts([knots.count() - 1, knots.degree(), 1, 0, usize::from(is_polynomial), 0]);
        parameters.extend(reals(knots.knots().iter().chain(curve.weights()).copied()));
        parameters.extend(reals(curve.points().iter().flat_map(|point| [point.x, point.y, 0.0])));
        parameters.extend(reals(curve.domain().into_iter().chain([0.0, 0.0, 1.0])));
        self.add([126, FREE, PART_IN_PARAMETERS], 0, &parameters)
    }
}

/// Whole numbers as parameters.
pub(super) fn texts(values: impl IntoIterator<Item = usize>) -> Vec<String> {
    values.into_iter().map(|value| value.to_string()).collect()
}

/// Numbers as parameters, exactly: the shortest decimal that reads back as the same number.
pub(super) fn reals(values: impl IntoIterator<Item = f64>) -> Vec<String> {
    values.into_iter().map(|value| format!("{value:?}").replace('e', "D")).collect()
}

/// The area of the box around a loop.
fn extent(curves: &[Curve<2>]) -> f64 {
    let boxes = curves.iter().map(Curve::bounds);
    let both = boxes.reduce(|(low, high), (other_low, other_high)| (low.inf(&other_low), high.sup(&other_high)));
    both.map_or(0.0, |(low, high)| (high - low).product())
}
