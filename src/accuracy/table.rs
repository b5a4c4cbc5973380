//! The outcome as text, as rows for each piece, and as JSON.

use super::errors::{Errors, Extreme, Sampling};
use super::{Outcome, Subject};
use serde_json::{Value, json};
use std::fmt::Write as _;

/// An outcome to be shown.
pub struct Table<'a> {
    pub subject: &'a Subject<'a>,
    pub outcome: &'a Outcome,
    pub sampling: &'a Sampling,
}

impl Table<'_> {
    /// The length that relative errors refer to, and what it is.
    fn length(&self) -> (f64, &'static str) {
        let diagonal = (self.outcome.size.diagonal(), "diagonal");
        self.subject.against.as_ref().and_then(|against| against.length).unwrap_or(diagonal)
    }

    /// What is printed.
    pub fn text(&self) -> String {
        let mut text = self.size();
        if let (Some(against), Some((_, errors))) = (&self.subject.against, &self.outcome.errors) {
            let _ = writeln!(text, "\nagainst {}", against.name);
            text += &self.errors(errors);
            text += &self.dead_zones(errors);
        }
        if let Some(counts) = self.outcome.projections {
            let extension = self.sampling.extension;
            let total: usize = counts.iter().sum();
            let part = |count: usize| format!("{count:>9}  {:>7.3} %\n", 100.0 * count as f64 / total as f64);
            let [normal, extended, edge, none] = counts;
            let _ = writeln!(text, "\n{total} points projected, extension {extension}");
            text += &format!("  normal projection         {}", part(normal));
            if extension > 0.0 {
                text += &format!("  on an extended piece only {}", part(extended));
            }
            text += &format!("  dead zone, at an edge     {}", part(edge));
            text += &format!("  beyond the end            {}", part(none));
        }
        text
    }

    fn size(&self) -> String {
        let size = &self.outcome.size;
        let mut text = format!("{}\n", self.subject.name);
        let mut row = |name: &str, value: String| {
            let _ = writeln!(text, "  {name:<18}{value}");
        };
        let counts = [(size.quadrilaterals, "quadrilateral"), (size.triangles, "triangle")];
        let counts = counts.iter().filter(|(count, _)| *count > 0).map(|(count, name)| counted(*count, name));
        row("made of", self.subject.summary.clone());
        row("pieces", counts.collect::<Vec<_>>().join(", "));
        row("area", format!("{:.8}", size.area));
        let [smooth, sharp, boundary] = size.edges();
        if !self.subject.edges {
            return text;
        }
        let inflected = self.subject.inflected.map_or(String::new(), |count| format!(", {count} inflected"));
        row("edges", format!("{smooth} smooth, {sharp} sharp, {boundary} boundary{inflected}"));
        if smooth > 0 {
            row("smooth edges", format!("normals jump by {:.6} degrees at most", size.jumps[0]));
        }
        if sharp > 0 {
            row("sharp edges", format!("normals jump by {:.6} degrees at most", size.jumps[1]));
        }
        text
    }

    fn errors(&self, errors: &Errors) -> String {
        let (length, name) = self.length();
        let over = format!("over {name}");
        let mut text =
            format!("  {:<18}{:>14}{over:>16}{:>8}   {:<22}point\n", "error", "value", "piece", "parameters");
        let mut row = |name: &str, value: f64, relative: bool, at: Option<(u32, &Extreme)>| {
            let relative = if relative { format!("{:.6e}", value / length) } else { String::new() };
            let place = at.map_or(String::new(), |(piece, Extreme { xi: [a, b], point: [x, y, z], .. })| {
                format!("{piece:>8}   {:<22}({x:.6}, {y:.6}, {z:.6})", format!("({a:.6}, {b:.6})"))
            });
            let line = format!("  {name:<18}{value:>14.6e}{relative:>16}{place}");
            let _ = writeln!(text, "{}", line.trim_end());
        };
        let [highest, lowest, turned] = errors.pieces;
        row("highest", errors.highest.value, true, Some((highest, &errors.highest)));
        row("lowest", errors.lowest.value, true, Some((lowest, &errors.lowest)));
        row("RMS", errors.distance_rms(), true, None);
        row("normal, degrees", errors.turned.value, false, Some((turned, &errors.turned)));
        row("normal, RMS", errors.angle_rms(), false, None);
        text
    }

    fn dead_zones(&self, errors: &Errors) -> String {
        let (Some(distance), dead) = (self.sampling.distance, errors.dead()) else { return String::new() };
        let extension = format!("extension {}", self.sampling.extension);
        let mut text = format!("\ndead zones at the distance {distance}{:>14}{extension:>18}\n", "as it is");
        for (name, [strict, extended]) in ["outside", "inside"].into_iter().zip(dead) {
            let _ = writeln!(text, "  {name:<18}{:>20.3} %{:>16.3} %", 100.0 * strict, 100.0 * extended);
        }
        text
    }

    /// `errors.csv`: one row a piece.
    pub fn rows(&self) -> String {
        let place = |name: &str| ["xi1", "xi2", "x", "y", "z"].map(|part| format!("{name}_{part}")).join(",");
        let [highest, lowest, turned] = ["distance_max", "distance_min", "normal_max"].map(place);
        let mut text = format!(
            "patch,area,distance_max,{highest},distance_min,{lowest},distance_rms,normal_max,{turned},normal_rms,\
             distance_max_relative,distance_min_relative,distance_rms_relative"
        );
        let dead_zones = self.sampling.distance.is_some();
        if dead_zones {
            text += ",dead_outside,dead_outside_extended,dead_inside,dead_inside_extended";
        }
        text.push('\n');
        let (length, _) = self.length();
        let pieces = self.outcome.errors.iter().flat_map(|(pieces, _)| pieces);
        for (id, errors) in pieces.filter(|(_, errors)| errors.area > 0.0) {
            let (highest, lowest) = (errors.highest.value, errors.lowest.value);
            let mut values = vec![errors.area];
            values.extend(flat(&errors.highest));
            values.extend(flat(&errors.lowest));
            values.push(errors.distance_rms());
            values.extend(flat(&errors.turned));
            values.push(errors.angle_rms());
            values.extend([highest, lowest, errors.distance_rms()].map(|value| value / length));
            if dead_zones {
                values.extend(errors.dead().as_flattened());
            }
            let values: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
            let _ = writeln!(text, "{id},{}", values.join(","));
        }
        text
    }

    /// `summary.json`.
    pub fn summary(&self) -> String {
        let size = &self.outcome.size;
        let mut value = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "surface": self.subject.name,
            "made_of": self.subject.summary,
            "quadrilaterals": size.quadrilaterals,
            "triangles": size.triangles,
            "area": size.area,
            "samples": self.sampling.grid.side(),
        });
        if self.subject.edges {
            let ([smooth, sharp, boundary], [at_smooth, at_sharp]) = (size.edges(), size.jumps);
            let inflected = self.subject.inflected;
            value["edges"] = json!({ "smooth": smooth, "sharp": sharp, "boundary": boundary, "inflected": inflected });
            value["normal_jump_deg"] = json!({ "smooth": at_smooth, "sharp": at_sharp });
        }
        if let (Some(against), Some((_, errors))) = (&self.subject.against, &self.outcome.errors) {
            let [highest, lowest, turned] = errors.pieces;
            let (length, name) = self.length();
            value["against"] = json!(against.name);
            value["length"] = json!({ name: length });
            value["refined"] = json!(self.sampling.refine);
            value["distance_max"] = at(highest, &errors.highest);
            value["distance_min"] = at(lowest, &errors.lowest);
            value["distance_rms"] = json!(errors.distance_rms());
            value["normal_max_deg"] = at(turned, &errors.turned);
            value["normal_rms_deg"] = json!(errors.angle_rms());
            if let Some(distance) = self.sampling.distance {
                let [outside, inside] =
                    errors.dead().map(|[strict, soft]| json!({ "strict": strict, "extended": soft }));
                let extension = self.sampling.extension;
                value["dead_zones"] =
                    json!({ "distance": distance, "extension": extension, "outside": outside, "inside": inside });
            }
        }
        if let Some([normal, extended, edge, none]) = self.outcome.projections {
            let extension = self.sampling.extension;
            value["projections"] =
                json!({ "extension": extension, "normal": normal, "extended": extended, "edge": edge, "none": none });
        }
        format!("{value:#}\n")
    }
}

fn counted(count: usize, name: &str) -> String {
    if count == 1 { format!("1 {name}") } else { format!("{count} {name}s") }
}

fn flat(extreme: &Extreme) -> [f64; 6] {
    let Extreme { value, xi: [a, b], point: [x, y, z] } = *extreme;
    [value, a, b, x, y, z]
}

fn at(piece: u32, extreme: &Extreme) -> Value {
    json!({ "value": extreme.value, "patch": piece, "xi": extreme.xi, "point": extreme.point })
}
