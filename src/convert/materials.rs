//! *MATERIAL with its *ELASTIC, *PLASTIC, *HYPERELASTIC and *DENSITY.

use super::names::Namer;
use super::rubber;
use crate::error::{Error, Location, Result};
use crate::mesh::abaqus::Card;
use std::fmt::Write;

/// Poisson's ratio above which full integration locks, as the scene has it for its elements.
const LOCKING: f64 = 0.45;

/// A material of the deck.
pub(super) struct Material {
    /// In the scene.
    pub name: String,
    /// In the deck.
    pub deck: String,
    pub at: Location,
    law: Option<Law>,
    /// Equivalent plastic strain and yield stress.
    plastic: Vec<[f64; 2]>,
    pub density: Option<f64>,
}

/// The elastic law.
enum Law {
    /// Young's modulus and Poisson's ratio.
    Hooke(f64, f64),
    /// The keys of rubber, and Poisson's ratio at small strain.
    Rubber(String, f64),
}

/// Reads all materials.
pub(super) fn read(cards: &[Card], namer: &mut Namer) -> Result<Vec<Material>> {
    let mut materials: Vec<Material> = Vec::new();
    for card in cards {
        let name = card.keyword.name.as_str();
        if name == "MATERIAL" {
            let deck = card.keyword.get("NAME").unwrap_or_default().to_string();
            if materials.iter().any(|other| other.deck.eq_ignore_ascii_case(&deck)) {
                return Err(card.error(format!("two materials are named '{deck}'"), "rename one"));
            }
            let name = namer.name(&deck, "material");
            let at = card.at.clone();
            materials.push(Material { name, deck, at, law: None, plastic: Vec::new(), density: None });
        }
        if !matches!(name, "ELASTIC" | "PLASTIC" | "HYPERELASTIC" | "DENSITY") {
            continue;
        }
        let material = materials.last_mut().ok_or_else(|| card.error("stands before the first *MATERIAL", ""))?;
        match name {
            "ELASTIC" => material.law = Some(elastic(card)?),
            "PLASTIC" => material.plastic = plastic(card)?,
            "HYPERELASTIC" => {
                let (keys, poisson) = rubber::keys(card)?;
                material.law = Some(Law::Rubber(keys, poisson));
            }
            _ => {
                let [density] = constants(card)?;
                if density < 0.0 {
                    return Err(card.error(format!("the density {density:?} is below 0"), ""));
                }
                material.density = Some(density);
            }
        }
    }
    Ok(materials)
}

/// The material of a section, as named in the deck.
pub(super) fn find(materials: &[Material], card: &Card) -> Result<usize> {
    let name = card.keyword.get("MATERIAL").unwrap_or_default();
    let found = materials.iter().position(|material| material.deck.eq_ignore_ascii_case(name));
    found.ok_or_else(|| {
        let known: Vec<&str> = materials.iter().map(|material| material.deck.as_str()).collect();
        card.error(format!("there is no material '{name}'"), &crate::scene::did_you_mean(name, known))
    })
}

impl Material {
    /// Whether elements lock, for it all but keeps its volume, where it flows at least.
    pub fn locks(&self) -> bool {
        let poisson = match self.law {
            Some(Law::Hooke(_, poisson) | Law::Rubber(_, poisson)) => poisson,
            None => 0.0,
        };
        poisson > LOCKING || !self.plastic.is_empty()
    }

    /// Its table in the scene.
    pub fn write(&self) -> Result<String> {
        let mut text = format!("[material.{}]\n", self.name);
        match (&self.law, self.plastic.is_empty()) {
            (None, _) => {
                let what = format!("the material '{}' has neither *ELASTIC nor *HYPERELASTIC", self.deck);
                return Err(Error::input(&self.at, what, ""));
            }
            (Some(Law::Hooke(young, poisson)), is_elastic) => {
                let model = if is_elastic { "hooke" } else { "j2" };
                let _ = write!(text, "model = \"{model}\"\nyoung = {young:?}\npoisson = {poisson:?}\n");
            }
            (Some(Law::Rubber(keys, _)), true) => text += keys,
            (Some(Law::Rubber(..)), false) => {
                let what = format!("the material '{}' has *PLASTIC beside *HYPERELASTIC", self.deck);
                return Err(Error::input(&self.at, what, "plasticity goes with *ELASTIC"));
            }
        }
        if let Some(density) = self.density {
            let _ = writeln!(text, "density = {density:?}");
        }
        match &self.plastic[..] {
            [] => {}
            [[_, stress]] => {
                let _ = writeln!(text, "yield_stress = {stress:?}");
            }
            table => {
                let points: Vec<String> = table.iter().map(|[e, stress]| format!("[{e:?}, {stress:?}]")).collect();
                let _ = writeln!(text, "hardening = {{ table = [{}] }}", points.join(", "));
            }
        }
        Ok(text)
    }
}

/// The numbers of a card with one line of data, behind which a temperature may stand.
fn constants<const N: usize>(card: &Card) -> Result<[f64; N]> {
    let [row] = &card.rows[..] else {
        let what = format!("*{} has {} lines of data, not one", card.keyword.name, card.rows.len());
        return Err(card.error(what, "nagata has no temperatures: keep one line"));
    };
    let mut numbers = [0.0; N];
    for (number, (row, field)) in numbers.iter_mut().zip(card.fields()) {
        *number = row.number(field, 0.0)?;
    }
    match card.fields().count() {
        found if found < N => Err(row.error(format!("expected {N} numbers, found {found}"), "")),
        found if found > N + 1 => Err(row.error(format!("expected {N} numbers and a temperature, found {found}"), "")),
        _ => Ok(numbers),
    }
}

fn elastic(card: &Card) -> Result<Law> {
    let kind = card.keyword.get("TYPE").unwrap_or("ISO").to_uppercase();
    if !matches!(kind.as_str(), "ISO" | "ISOTROPIC") {
        return Err(card.error(format!("*ELASTIC, TYPE={kind} cannot be converted"), "TYPE=ISO can"));
    }
    let [young, poisson] = constants(card)?;
    check(card, young, poisson)?;
    Ok(Law::Hooke(young, poisson))
}

fn check(card: &Card, young: f64, poisson: f64) -> Result<()> {
    let help = match poisson >= 0.5 {
        true => "write 0.4999 for an incompressible material",
        false => "Young's modulus is above 0, Poisson's ratio above -1 and below 0.5",
    };
    match young > 0.0 && poisson > -1.0 && poisson < 0.5 {
        true => Ok(()),
        false => {
            Err(card.error(format!("Young's modulus {young:?} and Poisson's ratio {poisson:?} are no solid's"), help))
        }
    }
}

/// Yield stress and equivalent plastic strain by line.
fn plastic(card: &Card) -> Result<Vec<[f64; 2]>> {
    let kind = card.keyword.get("HARDENING").unwrap_or("ISOTROPIC").to_uppercase();
    if kind != "ISOTROPIC" {
        return Err(card.error(format!("*PLASTIC, HARDENING={kind} cannot be converted"), "HARDENING=ISOTROPIC can"));
    }
    let mut table: Vec<[f64; 2]> = Vec::new();
    let mut temperature = None;
    for row in &card.rows {
        let [stress, strain, at, more] = row.fields();
        if *temperature.get_or_insert(at) != at || !more.is_empty() {
            return Err(row.error("the yield stress varies with temperature", "keep those of one temperature"));
        }
        let point = [row.number(strain, 0.0)?, row.number(stress, 0.0)?];
        let before = table.last().copied();
        if before.is_none() && point[0] != 0.0 {
            return Err(row.error("the first plastic strain is not 0", "the first line is where flow begins"));
        }
        if point[1] <= 0.0 || before.is_some_and(|[e, stress]| point[0] <= e || point[1] < stress) {
            return Err(row.error(
                "the yield stress falls, or the plastic strain does not rise",
                "nagata takes tables with rising strains and stresses that do not fall",
            ));
        }
        table.push(point);
    }
    match table.is_empty() {
        true => Err(card.error("*PLASTIC has no data", "")),
        false => Ok(table),
    }
}
