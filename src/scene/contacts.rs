//! Contact pairs: `[contact.NAME]`.

use super::reader::{Item, Table};
use super::references::Names;
use super::{
    Contact, Discretization, Enforcement, Interference, Located, MasterSurface, Scene, Smoothing, Tangent, Transfer,
};
use crate::error::{Error, Faults, Result};

/// Keys of every pair.
const KEYS: [&str; 12] = [
    "slave",
    "master",
    "discretization",
    "slave_curvature",
    "friction",
    "method",
    "penalty",
    "tolerance",
    "reach",
    "interference",
    "thickness",
    "tangent",
];

/// Keys that say how the faces of a body act as a master.
const OF_SURFACE: [&str; 3] = ["smoothing", "feature_angle", "transfer"];

/// Degrees from which on an edge between facets is sharp, where the scene does not say.
pub const FEATURE_ANGLE: f64 = 40.0;

/// Reads all pairs; none may occur twice, and one that has forces in the history shares no name with another that has.
pub(super) fn read(items: Vec<(Located<String>, Item)>, names: &Names) -> Result<Vec<Contact>> {
    let contacts = Faults::all(items.into_iter().map(|(name, item)| contact(name, &item, names)))?;
    Faults::all(contacts.iter().enumerate().map(|(k, next)| check(next, &contacts[..k], names)))?;
    Ok(contacts)
}

/// Refuses a pair that one of the `others` is, too, or that has the name of something else.
fn check(next: &Contact, others: &[Contact], names: &Names) -> Result<()> {
    let same = |other: &&Contact| other.slave.value == next.slave.value && other.master.value == next.master.value;
    if let Some(first) = others.iter().find(same) {
        let what = format!("contact.{} repeats the pair of contact.{}", next.name.value, first.name.value);
        return Err(Error::input(&next.slave.at, what, "remove one of them"));
    }
    if !names.is_tool(&next.master.value) && names.is_target(&next.name.value) {
        let what = format!("`{}` names a contact between bodies and a tool or body", next.name.value);
        let help = "rename one of them: the forces of both would have the same names in history.csv";
        return Err(Error::input(&next.name.at, what, help));
    }
    Ok(())
}

fn contact(name: Located<String>, item: &Item, names: &Names) -> Result<Contact> {
    let table = item.table(&[KEYS.as_slice(), OF_SURFACE.as_slice()].concat())?;
    let friction = |item: &Item| {
        item.number_that_is("0 or more", |value| value >= 0.0, "it is the Coulomb coefficient; 0 is frictionless")
    };
    let automatic = Item::positive_or_auto;
    let tangents = [("exact", Tangent::Exact), ("fixed-frame", Tangent::FixedFrame)];
    let slave = table.require("slave", "\"BODY.GROUP\"").and_then(|item| names.faces(&item));
    let master = table.require("master", "\"TOOL\"").and_then(|item| names.master(&item));
    let friction = table.optional("friction", friction);
    let (penalty, tolerance) = (table.optional("penalty", automatic), table.optional("tolerance", automatic));
    let (reach, thickness) = (table.optional("reach", Item::positive), table.optional("thickness", automatic));
    let mut faults = Faults::default();
    faults.note(&slave);
    faults.note(&master);
    faults.note(&friction);
    faults.note(&penalty);
    faults.note(&tolerance);
    faults.note(&reach);
    faults.note(&thickness);
    faults.finish()?;
    let (slave, master) = (slave?, master?);
    let is_self = master.value == slave.value;
    if let Some(item) = table.get("thickness").filter(|_| !is_self) {
        let what = "means nothing between two surfaces";
        return Err(item.error(what, "it is for self-contact, with `master` the same as `slave`; remove it"));
    }
    let method = table.optional("method", |item| item.choice(&Enforcement::KEYS))?.unwrap_or_default();
    if let Some(item) = table.get("tolerance").filter(|_| method != Enforcement::Uzawa) {
        let what = format!("means nothing with the method \"{}\"", method.key());
        return Err(item.error(what, "it ends the outer iterations of \"uzawa\"; remove it"));
    }
    let is_tool = names.is_tool(&master.value);
    let discretization = discretization(&table, is_tool)?;
    let segments = discretization == Discretization::Segment;
    let of_two = matches!(discretization, Discretization::TwoPass | Discretization::NodeToNode);
    if let Some(item) = table.get("discretization").filter(|_| is_self && of_two) {
        let help = "all of its nodes are slaves in one pass; write \"one-pass\" or \"segment\"";
        return Err(item.error("means nothing in self-contact", help));
    }
    let interferences =
        [("auto", Interference::Auto), ("at-once", Interference::AtOnce), ("ramped", Interference::Ramped)];
    let interference = table.optional("interference", |item| item.choice(&interferences))?.unwrap_or_default();
    if let Some(item) = table.get("interference").filter(|_| is_self) {
        return Err(item.error("means nothing in self-contact", "a surface cannot overlap itself; remove it"));
    }
    if let Some(item) = table.get("method").filter(|_| segments && is_self && method == Enforcement::Uzawa) {
        return Err(item.error("does not settle with \"segment\" in self-contact", "use \"augmented-lagrangian\""));
    }
    if let Some(item) = table.get("tangent").filter(|_| segments) {
        return Err(item.error("means nothing with \"segment\"", "its tangent is always exact; remove it"));
    }
    Ok(Contact {
        name,
        surface: surface(&table, is_tool, discretization)?,
        discretization,
        slave,
        master,
        friction: friction?.unwrap_or(0.0),
        method,
        penalty: penalty?.flatten(),
        tolerance: tolerance?.flatten(),
        reach: reach?,
        interference,
        tangent: table.optional("tangent", |item| item.choice(&tangents))?.unwrap_or_default(),
        thickness: thickness?.flatten(),
        slave_follows: slave_follows(&table, discretization)?,
        second_of: None,
    })
}

/// Whether the slave's smooth faces are curved as they are deformed.
fn slave_follows(table: &Table, discretization: Discretization) -> Result<bool> {
    let Some(item) = table.get("slave_curvature") else { return Ok(false) };
    let follows = item.choice(&[("meshed", false), ("deformed", true)])?;
    if discretization != Discretization::Segment {
        let help = "it is for faces, with `discretization = \"segment\"`; remove it";
        return Err(item.error("means nothing for nodes", help));
    }
    Ok(follows)
}

fn discretization(table: &Table, is_tool: bool) -> Result<Discretization> {
    let Some(item) = table.get("discretization") else { return Ok(Discretization::OnePass) };
    let known = [
        ("one-pass", Discretization::OnePass),
        ("two-pass", Discretization::TwoPass),
        ("node-to-node", Discretization::NodeToNode),
        ("segment", Discretization::Segment),
    ];
    match item.choice(&known)? {
        whole @ (Discretization::OnePass | Discretization::Segment) => Ok(whole),
        _ if is_tool => {
            Err(item.error("needs a master with nodes", "a tool has none; use \"one-pass\" or \"segment\""))
        }
        other => Ok(other),
    }
}

impl Scene {
    /// The contacts, each with two passes followed by its second one: the same with exchanged roles, called `NAME.master`.
    pub fn passes(&self) -> Vec<Contact> {
        let mut passes = Vec::new();
        for contact in &self.contacts {
            let first = passes.len();
            passes.push(contact.clone());
            if contact.discretization == Discretization::TwoPass {
                let mut second = contact.clone();
                second.name.value += ".master";
                second.second_of = Some(first);
                std::mem::swap(&mut second.slave, &mut second.master);
                passes.push(second);
            }
        }
        passes
    }
}

/// What is said about a deformable master; `None` for a tool, which has it in its own table or needs none.
fn surface(table: &Table, is_tool: bool, discretization: Discretization) -> Result<Option<MasterSurface>> {
    if is_tool {
        return match OF_SURFACE.iter().find_map(|key| table.get(key)) {
            Some(item) => Err(item.error("means nothing for a tool", "it is for a master on a body; remove it")),
            None => Ok(None),
        };
    }
    let by_node = discretization == Discretization::NodeToNode;
    if let Some(item) = ["transfer", "tangent", "reach"].iter().find_map(|key| table.get(key)).filter(|_| by_node) {
        return Err(item.error("means nothing from node to node", "remove it"));
    }
    let smoothings = [("facet", Smoothing::Facet), ("nagata", Smoothing::Nagata)];
    let transfers =
        [("patch", Transfer::Patch), ("variational", Transfer::Variational), ("bilinear", Transfer::Bilinear)];
    // From node to node all of the force goes to one node.
    let transfer = if by_node { Transfer::Bilinear } else { Transfer::default() };
    Ok(Some(MasterSurface {
        smoothing: table.optional("smoothing", |item| item.choice(&smoothings))?.unwrap_or(Smoothing::Nagata),
        feature_angle: table.optional("feature_angle", Item::feature_angle)?.unwrap_or(FEATURE_ANGLE),
        transfer: table.optional("transfer", |item| item.choice(&transfers))?.unwrap_or(transfer),
    }))
}
