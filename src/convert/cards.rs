//! What becomes of each kind of card, and what is told about those that are passed over.

use crate::Vec3;
use crate::error::{Error, Location, Result};
use crate::mesh::abaqus::Card;
use std::collections::BTreeMap;

/// What becomes of a kind of card.
enum Fate {
    /// It is read, with these parameters.
    Read(&'static [&'static str]),
    /// It is the mesh, which the scene refers to.
    Mesh,
    /// It asks for output.
    Output,
    /// It is passed over, and this is why that may be.
    Passed(&'static str),
    /// It changes the result in a way that a scene cannot say, or not yet.
    Refused(&'static str),
    Unknown,
}

const NUMERICS: &str = "it is for the solver of the deck";
const HEAT: &str = "nagata has no temperatures";
const STATICS: &str = "it does nothing in statics";
const ONLY_STATIC: &str = "nagata computes static steps";
const NO_JOINT: &str = "nagata joins faces alone, by *TIE; else mesh what is bonded as one part, with common nodes";
const NO_MEAN: &str = "nodes cannot follow a reference node in the mean: load them themselves, by *DSLOAD or *CLOAD, or move them by *KINEMATIC";
const NO_ELEMENT: &str = "nagata has solids alone, and springs to the ground";
const NO_MODEL: &str =
    "write the body's material by hand from those in docs/scene.md, and take this card out of the deck";
const NO_CONDITION: &str = "no condition of a scene does this";

fn fate(name: &str) -> Fate {
    match name {
        "NODE" | "ELEMENT" | "NSET" | "ELSET" | "SURFACE" | "INCLUDE" | "PART" | "END PART" | "ASSEMBLY"
        | "END ASSEMBLY" | "INSTANCE" | "END INSTANCE" | "SYSTEM" | "HEADING" => Fate::Mesh,
        "MATERIAL" => Fate::Read(&["NAME", "SRATE FACTOR"]),
        "ELASTIC" => Fate::Read(&["TYPE"]),
        "PLASTIC" => Fate::Read(&["HARDENING"]),
        "HYPERELASTIC" => {
            Fate::Read(&["NEO HOOKE", "MOONEY-RIVLIN", "YEOH", "OGDEN", "POLYNOMIAL", "REDUCED POLYNOMIAL", "N"])
        }
        "SPRING" => Fate::Read(&["ELSET"]),
        "DENSITY" | "END STEP" => Fate::Read(&[]),
        "FRICTION" => Fate::Read(&["SLIP TOLERANCE", "ELASTIC SLIP", "LAGRANGE"]),
        "SOLID SECTION" => Fate::Read(&["ELSET", "MATERIAL", "ORIENTATION", "CONTROLS"]),
        "SHELL SECTION" | "MEMBRANE SECTION" => Fate::Read(&["ELSET", "MATERIAL", "SECTION INTEGRATION"]),
        "RIGID BODY" => Fate::Read(&["ELSET", "NSET", "TIE NSET", "PIN NSET", "REF NODE", "ROT NODE"]),
        "SURFACE INTERACTION" => Fate::Read(&["NAME"]),
        "SURFACE BEHAVIOR" => Fate::Read(&["PRESSURE-OVERCLOSURE", "DIRECT", "PENALTY", "AUGMENTED LAGRANGE"]),
        "CONTACT PAIR" => Fate::Read(&[
            "INTERACTION",
            "TYPE",
            "ADJUST",
            "SMALL SLIDING",
            "MECHANICAL CONSTRAINT",
            "NO THICKNESS",
            "SUPPLEMENTARY CONSTRAINTS",
            "TRACKING",
        ]),
        "CONTACT INTERFERENCE" => Fate::Read(&["SHRINK", "TYPE"]),
        "AMPLITUDE" => Fate::Read(&["NAME", "TIME", "DEFINITION", "VALUE"]),
        "BOUNDARY" => Fate::Read(&["OP", "AMPLITUDE", "FIXED", "TYPE"]),
        "CLOAD" | "DLOAD" | "DSLOAD" => Fate::Read(&["OP", "AMPLITUDE"]),
        "STEP" => {
            Fate::Read(&["NAME", "NLGEOM", "INC", "AMPLITUDE", "EXTRAPOLATION", "UNSYMM", "SOLVER", "CONVERT SDI"])
        }
        "STATIC" => Fate::Read(&["DIRECT", "SOLVER", "STABILIZE", "FACTOR", "ALLSDTOL", "CONTINUE"]),
        "NODE PRINT"
        | "EL PRINT"
        | "NODE FILE"
        | "EL FILE"
        | "NODE OUTPUT"
        | "ELEMENT OUTPUT"
        | "OUTPUT"
        | "CONTACT OUTPUT"
        | "CONTACT PRINT"
        | "CONTACT FILE"
        | "SECTION PRINT"
        | "SECTION FILE"
        | "ENERGY OUTPUT"
        | "ENERGY PRINT"
        | "ENERGY FILE"
        | "INTEGRATED OUTPUT"
        | "INTEGRATED OUTPUT SECTION"
        | "SURFACE OUTPUT"
        | "INCREMENTATION OUTPUT"
        | "PREPRINT"
        | "PRINT"
        | "MONITOR"
        | "FILE FORMAT"
        | "FILE OUTPUT"
        | "FILTER"
        | "POST OUTPUT"
        | "TIME POINTS"
        | "RESTART"
        | "REFERENCE"
        | "DIAGNOSTICS" => Fate::Output,
        "CONTROLS"
        | "CONTACT CONTROLS"
        | "CONTACT CONTROLS ASSIGNMENT"
        | "CONSTRAINT CONTROLS"
        | "SECTION CONTROLS"
        | "HOURGLASS STIFFNESS"
        | "SOLUTION TECHNIQUE"
        | "CONTACT STABILIZATION" => Fate::Passed(NUMERICS),
        "EXPANSION"
        | "CONDUCTIVITY"
        | "SPECIFIC HEAT"
        | "GAP CONDUCTANCE"
        | "GAP HEAT GENERATION"
        | "INELASTIC HEAT FRACTION"
        | "PHYSICAL CONSTANTS" => Fate::Passed(HEAT),
        "DAMPING" | "CONTACT DAMPING" | "MASS" | "ROTARY INERTIA" | "NONSTRUCTURAL MASS" => Fate::Passed(STATICS),
        "ORIENTATION" => Fate::Read(&["NAME", "SYSTEM", "DEFINITION", "LOCAL DIRECTIONS"]),
        "DYNAMIC"
        | "FREQUENCY"
        | "BUCKLE"
        | "HEAT TRANSFER"
        | "COUPLED TEMPERATURE-DISPLACEMENT"
        | "VISCO"
        | "UNCOUPLED TEMPERATURE-DISPLACEMENT"
        | "STEADY STATE DYNAMICS"
        | "MODAL DYNAMIC"
        | "COMPLEX FREQUENCY"
        | "GREEN"
        | "ELECTROMAGNETICS"
        | "CFD"
        | "SENSITIVITY"
        | "GEOSTATIC" => Fate::Refused(ONLY_STATIC),
        "TIE" => Fate::Read(&["NAME", "POSITION TOLERANCE", "ADJUST", "TYPE", "NO ROTATION", "NO THICKNESS"]),
        "COUPLING" => Fate::Read(&["CONSTRAINT NAME", "REF NODE", "SURFACE"]),
        "KINEMATIC" => Fate::Read(&[]),
        "DISTRIBUTING" | "DISTRIBUTING COUPLING" => Fate::Refused(NO_MEAN),
        "EQUATION"
        | "MPC"
        | "KINEMATIC COUPLING"
        | "EMBEDDED ELEMENT"
        | "CYCLIC SYMMETRY MODEL"
        | "PRE-TENSION SECTION"
        | "SHELL TO SOLID COUPLING"
        | "CONNECTOR SECTION"
        | "FASTENER" => Fate::Refused(NO_JOINT),
        "BEAM SECTION"
        | "BEAM GENERAL SECTION"
        | "FLUID SECTION"
        | "DASHPOT"
        | "GAP"
        | "COHESIVE SECTION"
        | "SHELL GENERAL SECTION"
        | "REBAR"
        | "REBAR LAYER"
        | "FRAME SECTION" => Fate::Refused(NO_ELEMENT),
        "CREEP"
        | "HYPERFOAM"
        | "USER MATERIAL"
        | "DEFORMATION PLASTICITY"
        | "CYCLIC HARDENING"
        | "POTENTIAL"
        | "RATE DEPENDENT"
        | "VISCOELASTIC"
        | "MULLINS EFFECT"
        | "NO COMPRESSION"
        | "NO TENSION"
        | "DEPVAR"
        | "DAMAGE INITIATION"
        | "MOHR COULOMB"
        | "DRUCKER PRAGER"
        | "CAP PLASTICITY"
        | "CRUSHABLE FOAM"
        | "CONCRETE"
        | "DAMAGE EVOLUTION"
        | "DAMAGE STABILIZATION"
        | "HYSTERESIS"
        | "POROUS ELASTIC"
        | "POROUS METAL PLASTICITY"
        | "SHEAR FAILURE"
        | "SWELLING"
        | "TENSILE FAILURE"
        | "CAST IRON PLASTICITY"
        | "ANISOTROPIC HYPERELASTIC"
        | "HYPOELASTIC"
        | "VISCOUS" => Fate::Refused(NO_MODEL),
        "CONTACT" | "CONTACT INCLUSIONS" => {
            Fate::Refused("general contact: name the surfaces that meet by *CONTACT PAIR")
        }
        "COHESIVE BEHAVIOR" | "CONTACT INITIALIZATION DATA" | "CONTACT INITIALIZATION ASSIGNMENT" => {
            Fate::Refused("contacts of nagata are hard, and open without a force")
        }
        "CLEARANCE" => Fate::Refused("surfaces meet where the mesh has them: move the nodes, or take it out"),
        "TRANSFORM" => Fate::Read(&["NSET", "TYPE"]),
        "TEMPERATURE" | "CFLUX" | "DFLUX" | "FILM" | "RADIATE" => Fate::Refused(HEAT),
        "MODEL CHANGE"
        | "CHANGE FRICTION"
        | "CHANGE SURFACE BEHAVIOR"
        | "CHANGE CONTACT TYPE"
        | "CHANGE MATERIAL"
        | "CHANGE PLASTIC"
        | "CHANGE SOLID SECTION"
        | "INITIAL CONDITIONS"
        | "SUBMODEL"
        | "INERTIA RELIEF"
        | "IMPORT"
        | "FOUNDATION"
        | "IMPERFECTION"
        | "ADJUST"
        | "BOUNDARYF"
        | "RIGID SURFACE"
        | "MASS FLOW"
        | "ANNEAL" => Fate::Refused(NO_CONDITION),
        "PARAMETER" => Fate::Refused("write the numbers themselves"),
        _ => Fate::Unknown,
    }
}

/// What is told about the conversion, on the terminal and at the top of the scene: places and words.
#[derive(Default)]
pub(super) struct Notes(pub Vec<(Option<Location>, String)>);

impl Notes {
    /// A note about a place of the deck.
    pub fn at(&mut self, at: &Location, what: impl Into<String>) {
        self.0.push((Some(at.clone()), what.into()));
    }

    /// A note about the whole.
    pub fn whole(&mut self, what: impl Into<String>) {
        self.0.push((None, what.into()));
    }
}

/// Refuses what cannot be converted, all of it at once, and notes what is passed over.
pub(super) fn sort(cards: &[Card], notes: &mut Notes) -> Result<()> {
    let mut refused: Vec<(&Card, String)> = Vec::new();
    let mut output: Vec<usize> = Vec::new();
    // Words about cards of a kind: the first of them, and the lines of the others.
    let mut passed: Vec<(String, &Card, Vec<String>)> = Vec::new();
    let mut pass = |card, what: String| match passed.iter_mut().find(|(other, ..)| *other == what) {
        Some((_, _, lines)) => lines.push(card_line(card)),
        None => passed.push((what, card, Vec::new())),
    };
    let has_gravity = cards.iter().any(|card| gravities(card).next().is_some() || spins(card));
    refused.extend(turned(cards));
    for card in cards {
        let name = &card.keyword.name;
        match fate(name) {
            Fate::Read(known) => {
                let strange = card.keyword.keys().find(|key| !key.is_empty() && !known.contains(key));
                if let Some(key) = strange {
                    refused.push((card, format!("the parameter {key} of *{name} cannot be converted")));
                }
            }
            Fate::Mesh if name == "INCLUDE" && !card.rows.is_empty() => {
                refused.push((card, "an included file begins with data of the keyword before it".into()));
            }
            Fate::Mesh => {}
            Fate::Output if name == "RESTART" && card.keyword.has("READ") => {
                refused
                    .push((card, "*RESTART, READ begins from the state of another analysis: convert that one".into()));
            }
            Fate::Output => output.push(card.at.line),
            Fate::Passed(STATICS) if name != "DAMPING" && name != "CONTACT DAMPING" && has_gravity => {
                refused.push((card, format!("*{name} weighs under GRAV and CENTRIF: give its weight by *CLOAD")));
            }
            Fate::Passed(why) => pass(card, format!("*{name} is passed over: {why}")),
            // So PrePoMax begins each step.
            Fate::Refused(HEAT) if card.rows.is_empty() && card.keyword.has("OP") => {}
            Fate::Refused(why) => refused.push((card, format!("*{name} cannot be converted: {why}"))),
            Fate::Unknown => {
                refused.push((card, format!("*{name} is not known, and what it does would be missing in the scene")));
            }
        }
    }
    for (what, card, lines) in passed {
        let several = if lines.len() > 1 { "s" } else { "" };
        let also = if lines.is_empty() { String::new() } else { format!(" (also line{several} {})", lines.join(", ")) };
        notes.at(&card.at, format!("{what}{also}"));
    }
    if !output.is_empty() {
        let lines: Vec<String> = output.iter().map(usize::to_string).collect();
        let several = if lines.len() > 1 { "s" } else { "" };
        notes.whole(format!("requests for output are passed over (line{several} {})", lines.join(", ")));
    }
    match refused.split_first() {
        None => Ok(()),
        Some(((card, what), rest)) => Err(Error::input(&card.at, what, all_others(rest))),
    }
}

/// Whether a card takes off all of its kind that act.
pub(super) fn is_new(card: &Card) -> bool {
    card.keyword.get("OP").is_some_and(|op| op.eq_ignore_ascii_case("NEW"))
}

/// Lines of a card that give gravity: on what, and along which unit vector.
fn gravities(card: &Card) -> impl Iterator<Item = (&str, Vec3)> {
    let rows = card.rows.iter().filter(|_| card.keyword.name == "DLOAD");
    rows.filter_map(|row| {
        let [set, kind, value, x, y, z] = row.fields();
        let [value, x, y, z] = [value, x, y, z].map(|word| row.number(word, 0.0).unwrap_or_default());
        let along = (Vec3::new(x, y, z) * value.signum()).try_normalize(0.0)?;
        kind.eq_ignore_ascii_case("GRAV").then_some((set, along))
    })
}

fn spins(card: &Card) -> bool {
    let is_spin = |kind: &str| kind.eq_ignore_ascii_case("CENTRIF");
    card.keyword.name == "DLOAD" && card.rows.iter().any(|row| is_spin(row.fields::<2>()[1]))
}

/// Gravity that goes on from an earlier step and is given in another direction.
fn turned(cards: &[Card]) -> Vec<(&Card, String)> {
    const SAME: f64 = 1e-9;
    let mut live: BTreeMap<&str, Vec3> = BTreeMap::new();
    let mut given: BTreeMap<&str, Vec3> = BTreeMap::new();
    let mut refused = Vec::new();
    for card in cards {
        match card.keyword.name.as_str() {
            "STEP" => live.append(&mut given),
            "DLOAD" | "DSLOAD" if is_new(card) => live.clear(),
            _ => {}
        }
        for (set, along) in gravities(card) {
            if live.get(set).is_some_and(|before| (before - along).norm() > SAME) {
                let what = "GRAV goes on from an earlier step in another direction: programs disagree whether this one is \
                            added or takes its place; give all distributed loads anew by OP=NEW";
                refused.push((card, what.to_string()));
            }
            given.insert(set, along);
        }
    }
    refused
}

fn card_line(card: &Card) -> String {
    card.at.line.to_string()
}

/// The further cards that are refused, each once with its lines.
fn all_others(rest: &[(&Card, String)]) -> String {
    let mut lines: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for (card, what) in rest {
        lines.entry(what).or_default().push(card.at.line.to_string());
    }
    let others: Vec<String> = lines.iter().map(|(what, lines)| format!("{what} (line {})", lines.join(", "))).collect();
    match others.is_empty() {
        true => "take it out of the deck if the result can do without it".into(),
        false => format!("besides, {}", others.join("; ")),
    }
}
