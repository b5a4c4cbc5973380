//! *HYPERELASTIC: the models of Abaqus and CalculiX that a scene has, with their constants.
//!
//! W = sum of C_ij (I1 - 3)^i (I2 - 3)^j, or of 2 mu_i/alpha_i^2 (l1^alpha_i + l2^alpha_i + l3^alpha_i - 3), with I1, I2 and l of
//! the isochoric deformation, and sum of (J - 1)^2i / D_i beside it (Abaqus Theory Manual 4.6.1; CalculiX, *HYPERELASTIC).
//! A scene has the first term of this, with the bulk modulus K = 2/D_1.

use crate::error::Result;
use crate::mesh::abaqus::Card;

/// Most numbers in a line of data.
const IN_LINE: usize = 8;

/// A model with as many constants C or mu, alpha and D as it has.
#[derive(Clone, Copy)]
enum Model {
    /// C_10, and so on.
    Reduced(usize),
    MooneyRivlin,
    Ogden(usize),
}

impl Model {
    fn of(card: &Card) -> Result<Self> {
        let order = card.keyword.get("N").unwrap_or("1");
        let order = order.parse::<usize>().ok().filter(|order| (1..=3).contains(order));
        let order = order.ok_or_else(|| card.error("N is not 1, 2 or 3", ""))?;
        let has = |key: &str| card.keyword.has(key);
        match () {
            _ if has("NEO HOOKE") => Ok(Self::Reduced(1)),
            _ if has("YEOH") => Ok(Self::Reduced(3)),
            _ if has("REDUCED POLYNOMIAL") => Ok(Self::Reduced(order)),
            _ if has("OGDEN") => Ok(Self::Ogden(order)),
            _ if has("MOONEY-RIVLIN") || order == 1 => Ok(Self::MooneyRivlin),
            _ => {
                Err(card.error("*HYPERELASTIC, POLYNOMIAL, N=2 or 3 cannot be converted", "fit MOONEY-RIVLIN or YEOH"))
            }
        }
    }

    /// How many constants of a change of shape, and of volume.
    fn counts(self) -> (usize, usize) {
        match self {
            Self::Reduced(order) => (order, order),
            Self::MooneyRivlin => (2, 1),
            Self::Ogden(order) => (2 * order, order),
        }
    }
}

/// The keys of the material in the scene, and Poisson's ratio at small strain.
pub(super) fn keys(card: &Card) -> Result<(String, f64)> {
    let model = Model::of(card)?;
    let (of_shape, of_volume) = model.counts();
    let constants = constants(card, of_shape, of_volume)?;
    let (shape, volume) = constants.split_at(of_shape);
    let shear = match model {
        Model::Reduced(_) => 2.0 * shape[0],
        Model::MooneyRivlin => 2.0 * (shape[0] + shape[1]),
        Model::Ogden(_) => shape.iter().step_by(2).sum(),
    };
    if shear <= 0.0 {
        return Err(card.error(format!("the shear modulus of these constants is {shear:?}"), "it must be above 0"));
    }
    let d = volume[0];
    if d <= 0.0 {
        // D = 2/K, and K = 2 mu (1 + nu) / (3 (1 - 2 nu)).
        let usual = 3.0 * (1.0 - 2.0 * 0.475) / (shear * (1.0 + 0.475));
        let help = format!(
            "for 0 Abaqus takes none, CalculiX what gives Poisson's ratio 0.475, which is D1 = {usual:.4e}: write that"
        );
        return Err(card.error(format!("D1 = {d:?} is not above 0"), &help));
    }
    if let Some(more) = volume[1..].iter().find(|more| **more != 0.0) {
        let what = format!("D2 or D3 = {more:?} cannot be converted");
        return Err(card.error(what, "a scene has D1 alone: leave out the others"));
    }
    let first = shape[0];
    let text = match model {
        Model::MooneyRivlin => format!("model = \"mooney-rivlin\"\nc10 = {first:?}\nc01 = {:?}\n", shape[1]),
        Model::Reduced(1) => format!("model = \"mooney-rivlin\"\nc10 = {first:?}\nc01 = 0.0\n"),
        Model::Reduced(_) => {
            let third = shape.get(2).map_or(String::new(), |c30| format!("c30 = {c30:?}\n"));
            format!("model = \"yeoh\"\nc10 = {first:?}\nc20 = {:?}\n{third}", shape[1])
        }
        Model::Ogden(_) => {
            let terms = shape.as_chunks::<2>().0;
            if terms.iter().any(|[_, alpha]| *alpha == 0.0) {
                return Err(card.error("an exponent alpha is 0", ""));
            }
            format!("model = \"ogden\"\nterms = {terms:?}\n")
        }
    };
    let bulk = 2.0 / d;
    Ok((format!("{text}d = {d:?}\n"), (3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear)))
}

/// The constants, of which those of volume behind the first may be left out; a temperature may stand behind all.
fn constants(card: &Card, of_shape: usize, of_volume: usize) -> Result<Vec<f64>> {
    let all = of_shape + of_volume;
    let lines = all.div_ceil(IN_LINE);
    if card.rows.len() > lines {
        let what = format!("*HYPERELASTIC has {} lines of data, not {lines}", card.rows.len());
        return Err(card.error(what, "nagata has no temperatures: keep the constants of one"));
    }
    let mut numbers = Vec::new();
    for row in &card.rows {
        let mut fields: Vec<&str> = crate::mesh::abaqus::fields(&row.text).collect();
        let used = fields.iter().rposition(|field| !field.is_empty()).map_or(0, |last| last + 1);
        fields.truncate(used);
        for field in fields {
            numbers.push(row.number(field, 0.0)?);
        }
    }
    let found = numbers.len();
    if found <= of_shape || found > all + 1 {
        let what = format!("expected {all} constants, and a temperature at most, found {found}");
        return Err(card.error(what, "C or mu and alpha of each term, then D of each"));
    }
    numbers.resize(all, 0.0);
    Ok(numbers)
}
