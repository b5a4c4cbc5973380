//! What is written of single places: `[[output.probe]]`, and fields by their names.

use super::Located;
use super::reader::{Item, Table, check_name};
use super::references::Names;
use crate::Vec3;
use crate::error::Result;
use crate::output::quantity::Quantity;

/// Values at some places, in a table of their own.
#[derive(Clone, Debug)]
pub struct Probe {
    pub name: Located<String>,
    pub place: ProbePlace,
    /// Of bodies that touch at a point, the one that is meant; `None` is the first.
    pub body: Option<Located<String>>,
    pub fields: Vec<Quantity>,
}

impl Probe {
    /// Where it looks and at what, as a text that is the same if these are.
    pub fn words(&self) -> String {
        let place = match &self.place {
            ProbePlace::Point(x) => format!("point {:?}", x.value.as_slice()),
            ProbePlace::Set(set) => format!("set {}", set.value),
            ProbePlace::Path(ends, count) => format!("path {:?} {count}", ends.value.map(|x| [x.x, x.y, x.z])),
        };
        let body = self.body.as_ref().map_or("", |body| &body.value);
        format!("{place} {body} {:?}", self.fields)
    }
}

/// Where a probe looks.
#[derive(Clone, Debug)]
pub enum ProbePlace {
    /// Reference position in a body.
    Point(Located<Vec3>),
    /// `body.group` or `body`: mean, least and largest value of its nodes.
    Set(Located<String>),
    /// So many points along a line from the first to the last, reference positions in bodies.
    Path(Located<[Vec3; 2]>, usize),
}

/// Points of a path that does not say.
const POINTS: usize = 101;

/// Points that a path may have.
const MOST_POINTS: usize = 100_000;

/// Reads the probes of `[output]`.
pub(super) fn read(output: &Table, names: &Names) -> Result<Vec<Probe>> {
    let mut probes: Vec<Probe> = Vec::new();
    for item in output.optional("probe", Item::list)?.unwrap_or_default() {
        let probe = probe(&item, names)?;
        if probes.iter().any(|other| other.name.value == probe.name.value) {
            return Err(item.error("has the name of another probe", "each writes a file of its name"));
        }
        probes.push(probe);
    }
    Ok(probes)
}

/// A list of fields, each once.
pub(super) fn fields(item: &Item, known: &[Quantity]) -> Result<Vec<Quantity>> {
    let choices: Vec<(&str, Quantity)> = known.iter().map(|quantity| (quantity.key(), *quantity)).collect();
    let mut found = Vec::new();
    for item in item.list()? {
        let quantity = item.choice(&choices)?;
        if found.contains(&quantity) {
            return Err(item.error(format!("repeats `{}`", quantity.key()), "list it once"));
        }
        found.push(quantity);
    }
    Ok(found)
}

fn probe(item: &Item, names: &Names) -> Result<Probe> {
    let table = item.table(&["name", "point", "set", "path", "body", "fields"])?;
    let name = table.require("name", "\"tip\"")?.located_string()?;
    check_name(&name.value, &name.at)?;
    let point = table.optional("point", |item| Ok(ProbePlace::Point(item.located(item.vector()?))))?;
    let set = |item: &Item| names.set(item, "the history has where tools are and what they bear");
    let set = table.optional("set", set)?.map(ProbePlace::Set);
    let places: Vec<ProbePlace> = [point, set, table.optional("path", path)?].into_iter().flatten().collect();
    let [place] = <[ProbePlace; 1]>::try_from(places).map_err(|_| {
        table.error("must look at one place", "give `point`, `set` or `path`, as in `point = [0.0, 0.0, 0.0]`")
    })?;
    let body = table.optional("body", |item| names.body(item))?;
    if let (ProbePlace::Set(_), Some(body)) = (&place, table.get("body")) {
        return Err(body.error("stands beside a set", "a set is of one body: leave `body` out"));
    }
    let asked = table.optional("fields", |item| match fields(item, &Quantity::OF_PROBES)? {
        none if none.is_empty() => Err(item.error("names no fields", "name some, or leave it out")),
        fields => Ok(fields),
    })?;
    Ok(Probe { name, place, body, fields: asked.unwrap_or(Quantity::USUAL_OF_PROBES.to_vec()) })
}

fn path(item: &Item) -> Result<ProbePlace> {
    let table = item.table(&["from", "to", "points"])?;
    let [from, to] = [table.require("from", "[0.0, 0.0, 0.0]")?, table.require("to", "[1.0, 0.0, 0.0]")?];
    let ends = [from.vector()?, to.vector()?];
    if ends[0] == ends[1] {
        return Err(to.error("is where the path begins", "for a single place use `point`"));
    }
    let points = |item: &Item| match item.count()? {
        count @ 2..=MOST_POINTS => Ok(count),
        count => Err(item.error(format!("must be from 2 to {MOST_POINTS}, not {count}"), "the ends are points, too")),
    };
    Ok(ProbePlace::Path(item.located(ends), table.optional("points", points)?.unwrap_or(POINTS)))
}
