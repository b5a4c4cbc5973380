//! Reads material cards: elastic constants, yield criteria and hardening.

use super::reader::{Item, Table};
use super::{Body, Formulation, Hardening, Hill, Isochoric, Located, Material, MaterialModel, Orthotropy, Scene};
use crate::error::{Faults, Result};
use crate::mesh::SolidShape;
use crate::{Mat3, Vec3};

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    NeoHookean,
    Hooke,
    Orthotropic,
    J2,
    Hill,
    MooneyRivlin,
    Yeoh,
    Ogden,
}

const KINDS: [(&str, Kind); 8] = [
    ("neo-hookean", Kind::NeoHookean),
    ("hooke", Kind::Hooke),
    ("orthotropic", Kind::Orthotropic),
    ("j2", Kind::J2),
    ("hill", Kind::Hill),
    ("mooney-rivlin", Kind::MooneyRivlin),
    ("yeoh", Kind::Yeoh),
    ("ogden", Kind::Ogden),
];

const ELASTIC: [Kind; 4] = [Kind::NeoHookean, Kind::Hooke, Kind::J2, Kind::Hill];
const ISOTROPIC: [Kind; 7] =
    [Kind::NeoHookean, Kind::Hooke, Kind::J2, Kind::Hill, Kind::MooneyRivlin, Kind::Yeoh, Kind::Ogden];
const PLASTIC: [Kind; 2] = [Kind::J2, Kind::Hill];
const HYPERELASTIC: [Kind; 3] = [Kind::MooneyRivlin, Kind::Yeoh, Kind::Ogden];

/// The keys that some models have and others not, and what helps those who give them to others.
const OF_MODELS: [(&str, &[Kind], &str); 13] = [
    ("young", &ELASTIC, "the moduli follow from the constants of the model"),
    ("poisson", &ISOTROPIC, "the constants of the model have their own ratios"),
    ("orthotropic", &[Kind::Orthotropic], "write model = \"orthotropic\""),
    ("yield_stress", &PLASTIC, "write model = \"j2\" or \"hill\""),
    ("hardening", &PLASTIC, "write model = \"j2\" or \"hill\""),
    ("hill", &[Kind::Hill], "write model = \"hill\""),
    ("c10", &[Kind::MooneyRivlin, Kind::Yeoh], "write model = \"mooney-rivlin\" or \"yeoh\""),
    ("c01", &[Kind::MooneyRivlin], "write model = \"mooney-rivlin\""),
    ("c20", &[Kind::Yeoh], "write model = \"yeoh\""),
    ("c30", &[Kind::Yeoh], "write model = \"yeoh\""),
    ("terms", &[Kind::Ogden], "write model = \"ogden\""),
    ("bulk", &HYPERELASTIC, "it follows from `young` and `poisson`"),
    ("d", &HYPERELASTIC, "it follows from `young` and `poisson`"),
];

/// Constants of spruce, N/mm².
const ENGINEERING: &str = "{ e1 = 11000.0, e2 = 890.0, e3 = 430.0, nu12 = 0.38, nu13 = 0.48, nu23 = 0.51, \
                           g12 = 690.0, g13 = 620.0, g23 = 40.0 }";

/// The material of a card.
///
/// # Errors
/// What is not a material, with its place.
pub(super) fn read(name: Located<String>, item: &Item) -> Result<Material> {
    let keys: Vec<&str> = ["model", "density"].into_iter().chain(OF_MODELS.map(|(key, ..)| key)).collect();
    let table = item.table(&keys)?;
    let kind = table.require("model", "\"neo-hookean\"")?.choice(&KINDS)?;
    for (key, _, help) in OF_MODELS.iter().filter(|(_, kinds, _)| !kinds.contains(&kind)) {
        if let Some(extra) = table.get(key) {
            return Err(extra.error("does not belong to this model", *help));
        }
    }
    let no_less = |item: &Item| item.number_that_is("0 or more", |value| value >= 0.0, "");
    let density = table.optional("density", no_less);
    let model = match kind {
        Kind::MooneyRivlin | Kind::Yeoh | Kind::Ogden => hyperelastic(kind, &table),
        Kind::Orthotropic => table.require("orthotropic", ENGINEERING).and_then(|item| orthotropic(&item)),
        Kind::NeoHookean | Kind::Hooke | Kind::J2 | Kind::Hill => elastic(kind, &table),
    };
    let mut faults = Faults::default();
    faults.note(&density);
    faults.note(&model);
    faults.finish()?;
    Ok(Material { name, model: model?, density: density? })
}

/// Those that begin with Young's modulus and Poisson's ratio.
fn elastic(kind: Kind, table: &Table) -> Result<MaterialModel> {
    let young = table.require("young", "210000.0").and_then(|item| item.positive());
    let poisson = table.require("poisson", "0.3").and_then(|item| poisson(&item));
    let mut faults = Faults::default();
    faults.note(&young);
    faults.note(&poisson);
    faults.finish()?;
    let (young, poisson) = (young?, poisson?);
    Ok(match kind {
        Kind::J2 => MaterialModel::Plastic { young, poisson, hill: None, hardening: hardening(table)? },
        Kind::Hill => {
            let criterion = hill(&table.require("hill", "{ f = 0.5, g = 0.5, h = 0.5, n = 1.5 }")?)?;
            MaterialModel::Plastic { young, poisson, hill: Some(criterion), hardening: hardening(table)? }
        }
        Kind::NeoHookean => MaterialModel::NeoHookean { young, poisson },
        _ => MaterialModel::Hooke { young, poisson },
    })
}

fn poisson(item: &Item) -> Result<f64> {
    let incompressible = item.number()? >= 0.5;
    let help =
        if incompressible { "use 0.4999 with element = \"hex8-fbar\" for an incompressible material" } else { "" };
    item.number_that_is("above -1 and below 0.5", |value| value > -1.0 && value < 0.5, help)
}

/// An isochoric law and its bulk modulus.
fn hyperelastic(kind: Kind, table: &Table) -> Result<MaterialModel> {
    let first = || table.require("c10", "0.4")?.number();
    let more = |key: &str| table.optional(key, Item::number).map(|given| given.unwrap_or(0.0));
    let law = match kind {
        Kind::MooneyRivlin => Isochoric::MooneyRivlin { c10: first()?, c01: table.require("c01", "0.1")?.number()? },
        Kind::Yeoh => Isochoric::Yeoh { c10: first()?, c20: more("c20")?, c30: more("c30")? },
        _ => Isochoric::Ogden(terms(&table.require("terms", "[[0.6, 1.3], [0.01, 5.0]]")?)?),
    };
    let shear = law.shear();
    if shear <= 0.0 {
        let of = match kind {
            Kind::MooneyRivlin => "2 (c10 + c01)",
            Kind::Yeoh => "2 c10",
            _ => "the sum of the mu",
        };
        return Err(table.error(format!("has the shear modulus {shear:?}"), format!("{of} must be above 0")));
    }
    Ok(MaterialModel::Hyperelastic { law, bulk: bulk(table, shear)? })
}

/// The bulk modulus, or what it follows from.
fn bulk(table: &Table, shear: f64) -> Result<f64> {
    let of_poisson = |item: &Item| poisson(item).map(|nu| 2.0 / 3.0 * shear * (1.0 + nu) / (1.0 - 2.0 * nu));
    let of_d = |item: &Item| item.positive().map(|d| 2.0 / d);
    let given =
        [table.optional("bulk", Item::positive)?, table.optional("poisson", of_poisson)?, table.optional("d", of_d)?];
    let mut given = given.into_iter().flatten();
    match (given.next(), given.next()) {
        (Some(bulk), None) => Ok(bulk),
        _ => Err(table.error("must have one of `bulk`, `poisson` and `d`", "for example `poisson = 0.499`")),
    }
}

/// Moduli and exponents of Ogden's law.
fn terms(item: &Item) -> Result<Vec<[f64; 2]>> {
    let term = |row: &Item| {
        let [mu, alpha] = row.array::<f64, 2>(Item::number, "[0.6, 1.3]")?;
        if alpha == 0.0 { Err(row.error("must have an exponent other than 0", "")) } else { Ok([mu, alpha]) }
    };
    item.filled_list()?.iter().map(term).collect()
}

impl Body {
    /// Its materials: the one that it names, then those of groups of its elements.
    pub fn sections(&self) -> impl Iterator<Item = &Located<String>> {
        std::iter::once(&self.material).chain(self.materials.iter().map(|(_, material)| material))
    }
}

/// Poisson's ratio below which the enhanced strain of compressed elements buckles. Under a sphere that presses a block by a
/// twentieth the methods of contact find one solution to -0.9, different ones from -0.95 on.
pub const AUXETIC: f64 = -0.9;

impl Scene {
    /// The materials that bodies are made of, with the numbers of these; see [`Body::sections`].
    pub fn sections(&self) -> impl Iterator<Item = (usize, &Located<String>)> {
        self.bodies.iter().enumerate().flat_map(|(b, body)| body.sections().map(move |material| (b, material)))
    }

    /// The material of this name.
    pub fn material(&self, name: &str) -> Option<&MaterialModel> {
        self.materials.iter().find(|card| card.name.value == name).map(|card| &card.model)
    }

    /// The element of a material that is asked for none: one that does not lock, if there is one of the shape. Flow keeps the
    /// volume, too, and wants the balance of energy that `hex8-sri` has; its tangent is symmetric besides. Hexahedra that are parts
    /// of ones of second order are to bend as these do, where the material lets enhanced strain be.
    pub fn default_element(&self, material: &str, shape: SolidShape, bends: bool) -> Formulation {
        let model = self.material(material);
        let enhances =
            |model: &MaterialModel| !matches!(model, MaterialModel::Orthotropic(_)) && model.poisson() >= AUXETIC;
        let keeps_volume = model.is_some_and(|model| model.keeps_volume().is_some());
        match (shape, model) {
            (SolidShape::Tet4, _) => Formulation::Tet4,
            (SolidShape::Tet10, _) if keeps_volume => Formulation::Tet10Sri,
            (SolidShape::Tet10, _) => Formulation::Tet10,
            (SolidShape::Wedge18, _) if keeps_volume => Formulation::Wedge18Sri,
            (SolidShape::Wedge18, _) => Formulation::Wedge18,
            (SolidShape::Wedge6, _) if keeps_volume => Formulation::Wedge6Sri,
            (SolidShape::Wedge6, _) => Formulation::Wedge6,
            (SolidShape::Pyramid5, _) if keeps_volume => Formulation::Pyramid5Sri,
            (SolidShape::Pyramid5, _) => Formulation::Pyramid5,
            (SolidShape::Hex8, Some(MaterialModel::Plastic { .. })) => Formulation::Hex8Sri,
            (SolidShape::Hex8, _) if keeps_volume => Formulation::Hex8Fbar,
            (SolidShape::Hex8, Some(model)) if bends && enhances(model) => Formulation::Hex8Eas,
            (SolidShape::Hex8, _) => Formulation::Hex8,
            (SolidShape::Hex27, _) => Formulation::Hex27,
        }
    }
}

/// Engineering constants and axes, of which the moduli are positive definite.
fn orthotropic(item: &Item) -> Result<MaterialModel> {
    let (moduli, ratios, shears) = (["e1", "e2", "e3"], ["nu12", "nu13", "nu23"], ["g12", "g13", "g23"]);
    let table = item.table(&[&moduli[..], &ratios, &shears, &["x", "y"]].concat())?;
    let above = |keys: [&str; 3]| Faults::all(keys.map(|key| table.require(key, "1000.0")?.positive()));
    let ratios = Faults::all(ratios.map(|key| table.require(key, "0.3")?.number()));
    let (young, shear, axes) = (above(moduli), above(shears), axes(item, &table));
    let mut faults = Faults::default();
    faults.note(&young);
    faults.note(&ratios);
    faults.note(&shear);
    faults.note(&axes);
    faults.finish()?;
    let three = |values: Vec<f64>| std::array::from_fn(|k| values[k]);
    let constants = Orthotropy { young: three(young?), poisson: three(ratios?), shear: three(shear?), axes: axes? };
    let pairs = [(0, 1, "nu12", "e1", "e2"), (0, 2, "nu13", "e1", "e3"), (1, 2, "nu23", "e2", "e3")];
    for ((i, j, ratio, first, second), value) in pairs.into_iter().zip(constants.poisson) {
        let limit = (constants.young[i] / constants.young[j]).sqrt();
        if value.abs() >= limit {
            let what =
                format!("has {ratio} = {value:?}, where its size must be below sqrt({first}/{second}) = {limit:.4}");
            let help = format!(
                "{ratio} is the contraction along the second axis under tension along the first: \
                                {ratio}/{first} = nu{}{}/{second}",
                j + 1,
                i + 1
            );
            return Err(item.error(what, help));
        }
    }
    match constants.moduli() {
        Some(_) => Ok(MaterialModel::Orthotropic(constants)),
        None => {
            let what = "has constants with which some strain would store no energy, or less";
            let help = "1 - nu12 nu21 - nu23 nu32 - nu31 nu13 - 2 nu21 nu32 nu13 must be above 0: lower the ratios";
            Err(item.error(what, help))
        }
    }
}

/// The axes of a material in the undeformed body: x, and y as far as it is normal to that.
fn axes(item: &Item, table: &Table) -> Result<Mat3> {
    let axis = |key: &str, default: Vec3| table.optional(key, Item::unit_vector).map(|given| given.unwrap_or(default));
    let x = axis("x", Vec3::x())?;
    let y = axis("y", Vec3::y())?;
    let z = x.cross(&y);
    if z.norm() < 1e-6 {
        return Err(item.error("has x and y along one line", "give both, normal to each other"));
    }
    let z = z.normalize();
    Ok(Mat3::from_columns(&[x, z.cross(&x), z]))
}

/// Hill's coefficients and axes.
fn hill(item: &Item) -> Result<Hill> {
    let table = item.table(&["f", "g", "h", "l", "m", "n", "x", "y"])?;
    let number = |key: &str| table.require(key, "0.5")?.number();
    let [f, g, h] = [number("f")?, number("g")?, number("h")?];
    if f + g <= 0.0 || f * g + g * h + h * f <= 0.0 {
        let help = "f + g, g + h, h + f and f g + g h + h f must be above 0";
        return Err(item.error("is not a convex criterion", help));
    }
    let shear = |key: &str| table.optional(key, Item::positive).map(|given| given.unwrap_or(1.5));
    let n = table.require("n", "1.5")?.positive()?;
    Ok(Hill { coefficients: [f, g, h, shear("l")?, shear("m")?, n], axes: axes(item, &table)? })
}

/// The yield stress and how it rises.
fn hardening(material: &Table) -> Result<Hardening> {
    let given = || material.require("yield_stress", "250.0")?.positive();
    let Some(item) = material.get("hardening") else {
        return Ok(Hardening::Linear { yield_stress: given()?, modulus: 0.0 });
    };
    let table = item.table(&["linear", "swift", "voce", "table"])?;
    let laws: Vec<Item> = ["linear", "swift", "voce", "table"].iter().filter_map(|key| table.get(key)).collect();
    let [law] = &laws[..] else {
        return Err(item.error("must have one of `linear`, `swift`, `voce` and `table`", ""));
    };
    let not_falling =
        |item: &Item| item.number_that_is("0 or more", |value| value >= 0.0, "the yield stress must not fall");
    if table.get("linear").is_some() {
        return Ok(Hardening::Linear { yield_stress: given()?, modulus: not_falling(law)? });
    }
    if table.get("swift").is_some() {
        return swift(material, &law.table(&["k", "n", "e0"])?);
    }
    if table.get("voce").is_some() {
        let yield_stress = given()?;
        let law = law.table(&["saturation", "rate", "linear"])?;
        let above = |value| value >= yield_stress;
        let saturation = law.require("saturation", "400.0")?;
        return Ok(Hardening::Voce {
            yield_stress,
            saturation: saturation.number_that_is(&format!("at least yield_stress ({yield_stress:?})"), above, "")?,
            rate: law.require("rate", "10.0")?.positive()?,
            modulus: law.optional("linear", not_falling)?.unwrap_or(0.0),
        });
    }
    if let Some(extra) = material.get("yield_stress") {
        return Err(extra.error("stands beside a table", "the first point of the table has the yield stress"));
    }
    points(law)
}

/// k (e0 + e)^n with e0, or with the yield stress that it gives.
fn swift(material: &Table, law: &Table) -> Result<Hardening> {
    let k_item = law.require("k", "500.0")?;
    let k = k_item.positive()?;
    let n =
        law.require("n", "0.2")?.number_that_is("above 0 and at most 1", |value| value > 0.0 && value <= 1.0, "")?;
    let e0 = match (material.get("yield_stress"), law.get("e0")) {
        (Some(_), Some(e0)) => return Err(e0.error("stands beside `yield_stress`", "keep one of them")),
        (None, Some(e0)) => e0.positive()?,
        _ => {
            let yield_stress = material.require("yield_stress", "250.0")?.positive()?;
            let above = |k| k >= yield_stress;
            k_item.number_that_is(&format!("at least yield_stress ({yield_stress:?})"), above, "")?;
            (yield_stress / k).powf(1.0 / n)
        }
    };
    Ok(Hardening::Swift { k, e0, n })
}

/// A table of strains from 0 and stresses.
fn points(item: &Item) -> Result<Hardening> {
    let rows = item.filled_list()?;
    let mut points: Vec<[f64; 2]> = Vec::with_capacity(rows.len());
    for row in &rows {
        let point = row.array::<f64, 2>(Item::number, "[0.0, 250.0]")?;
        match points.last() {
            None if point[0] != 0.0 => return Err(row.error("must have the strain 0, as the first point", "")),
            Some(last) if point[0] <= last[0] => return Err(row.error("must have a larger strain than the last", "")),
            Some(last) if point[1] < last[1] => {
                return Err(row.error("must not have a smaller stress than the last", ""));
            }
            _ if point[1] <= 0.0 => return Err(row.error("must have a stress above 0", "")),
            _ => points.push(point),
        }
    }
    Ok(Hardening::Table(points))
}
