//! *MATERIAL with its *ELASTIC, *PLASTIC, *HYPERELASTIC and *DENSITY; one that is orthotropic for each orientation of its sections.

use super::names::Namer;
use super::{orientations, orthotropic, rubber};
use crate::Vec3;
use crate::error::{Error, Location, Result};
use crate::mesh::abaqus::{Card, Whole};
use crate::solid::material::Orthotropy;
use std::fmt::Write;

/// Poisson's ratio above which full integration locks, as the scene has it for its elements.
const LOCKING: f64 = 0.45;

/// A material of the deck.
#[derive(Clone)]
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
#[derive(Clone)]
enum Law {
    /// Young's modulus and Poisson's ratio.
    Hooke(f64, f64),
    /// The keys of rubber, and Poisson's ratio at small strain.
    Rubber(String, f64),
    /// The constants, and of the first section with it the orientation, where it has one.
    Orthotropic(Orthotropy, Option<Option<Box<Axes>>>),
}

/// An orientation.
#[derive(Clone)]
struct Axes {
    /// Where it stands.
    at: Location,
    /// Its first and second axis.
    axes: [Vec3; 2],
}

/// Reads all materials.
pub(super) fn read(whole: &Whole, namer: &mut Namer) -> Result<Vec<Material>> {
    let mut materials: Vec<Material> = Vec::new();
    for card in &whole.cards {
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
        let is_second = match name {
            "PLASTIC" => !material.plastic.is_empty(),
            "DENSITY" => material.density.is_some(),
            _ => material.law.is_some(),
        };
        if is_second {
            return Err(card.error(format!("the material '{}' already has its *{name}", material.deck), "keep one"));
        }
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
    for section in whole.cards.iter().filter(|card| card.keyword.name == "SOLID SECTION") {
        orient(&whole.cards, section, &mut materials, namer)?;
    }
    Ok(materials)
}

/// Gives an orthotropic material the orientation of a section, or makes one more for it.
fn orient(cards: &[Card], section: &Card, materials: &mut Vec<Material>, namer: &mut Namer) -> Result<()> {
    let Ok(index) = find(materials, cards, section) else { return Ok(()) };
    let mut material = materials[index].clone();
    let Some(Law::Orthotropic(_, of)) = &mut material.law else { return Ok(()) };
    let card = orientations::of(cards, section)?;
    if materials[index].is_along(card) {
        return Ok(());
    }
    if let Some(card) = cards.iter().find(|card| card.keyword.name == "INSTANCE" && card.rows.len() > 1) {
        let help = "write the deck without instances that are turned, or the material by hand";
        return Err(card.error("an instance is turned, in a deck with an orthotropic material", help));
    }
    let axes = |card: &Card| orientations::axes(card).map(|axes| Box::new(Axes { at: card.at.clone(), axes }));
    match of.replace(card.map(axes).transpose()?) {
        None => materials[index] = material,
        Some(_) => {
            let name = section.keyword.get("ORIENTATION").unwrap_or_default().to_uppercase();
            let another = namer.name(&format!("{}-{name}", material.deck), "material");
            materials.push(Material { name: another, ..material });
        }
    }
    Ok(())
}

/// The material of a section, as named in the deck, where it is orthotropic with its orientation, if there is one already.
pub(super) fn find(materials: &[Material], cards: &[Card], section: &Card) -> Result<usize> {
    let name = section.keyword.get("MATERIAL").unwrap_or_default();
    let of_deck = |material: &Material| material.deck.eq_ignore_ascii_case(name);
    let first = materials.iter().position(of_deck).ok_or_else(|| {
        let known: Vec<&str> = materials.iter().map(|material| material.deck.as_str()).collect();
        section.error(format!("there is no material '{name}'"), &crate::scene::did_you_mean(name, known))
    })?;
    if !materials[first].is_orthotropic() {
        return Ok(first);
    }
    let card = orientations::of(cards, section)?;
    Ok(materials.iter().position(|material| of_deck(material) && material.is_along(card)).unwrap_or(first))
}

impl Material {
    /// Whether elements lock, for it all but keeps its volume, where it flows at least.
    pub fn locks(&self) -> bool {
        let poisson = match self.law {
            Some(Law::Hooke(_, poisson) | Law::Rubber(_, poisson)) => poisson,
            Some(Law::Orthotropic(..)) | None => 0.0,
        };
        poisson > LOCKING || !self.plastic.is_empty()
    }

    /// Whether it is orthotropic along this orientation, or this lack of one.
    fn is_along(&self, orientation: Option<&Card>) -> bool {
        match &self.law {
            Some(Law::Orthotropic(_, Some(own))) => own.as_ref().map(|own| &own.at) == orientation.map(|card| &card.at),
            _ => false,
        }
    }

    pub fn is_orthotropic(&self) -> bool {
        matches!(self.law, Some(Law::Orthotropic(..)))
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
            (Some(Law::Orthotropic(constants, of)), true) => {
                text += &orthotropic::write(constants, of.as_ref().and_then(|of| of.as_ref()).map(|of| of.axes));
            }
            (Some(Law::Rubber(..)), false) => {
                let what = format!("the material '{}' has *PLASTIC beside *HYPERELASTIC", self.deck);
                return Err(Error::input(&self.at, what, "plasticity goes with *ELASTIC"));
            }
            (Some(Law::Orthotropic(..)), false) => {
                let what = format!("the material '{}' has *PLASTIC beside orthotropic constants", self.deck);
                return Err(Error::input(&self.at, what, "plasticity goes with *ELASTIC, TYPE=ISO"));
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
    match kind.as_str() {
        "ISO" | "ISOTROPIC" => {
            let [young, poisson] = constants(card)?;
            check(card, young, poisson)?;
            Ok(Law::Hooke(young, poisson))
        }
        "ENGINEERING CONSTANTS" | "ENGINEERINGCONSTANTS" => Ok(Law::Orthotropic(orthotropic::read(card, true)?, None)),
        "ORTHO" | "ORTHOTROPIC" => Ok(Law::Orthotropic(orthotropic::read(card, false)?, None)),
        _ => Err(card.error(
            format!("*ELASTIC, TYPE={kind} cannot be converted"),
            "TYPE=ISO, ENGINEERING CONSTANTS and ORTHO can",
        )),
    }
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
