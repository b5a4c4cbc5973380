//! *ORIENTATION: the axes of materials.

use crate::Vec3;
use crate::error::Result;
use crate::mesh::abaqus::Card;
use nalgebra::{Rotation3, Unit};

/// The *ORIENTATION that a section names, in its own part or instance before those outside of all; `None` where it names none.
pub(super) fn of<'a>(cards: &'a [Card], section: &Card) -> Result<Option<&'a Card>> {
    let Some(name) = section.keyword.get("ORIENTATION") else { return Ok(None) };
    let found = |place: &Option<String>| {
        let is_it = |card: &&Card| {
            let own = card.keyword.get("NAME").unwrap_or_default();
            card.keyword.name == "ORIENTATION" && own.eq_ignore_ascii_case(name) && card.place == *place
        };
        let mut all = cards.iter().filter(is_it);
        let first = all.next();
        match all.next() {
            Some(second) => Err(second.error(format!("two orientations are named '{name}'"), "rename one")),
            None => Ok(first),
        }
    };
    let card = match found(&section.place)? {
        None => found(&None)?,
        own => own,
    };
    card.map(Some).ok_or_else(|| section.error(format!("there is no orientation '{name}'"), ""))
}

/// The first and the second axis of an *ORIENTATION.
pub(super) fn axes(card: &Card) -> Result<[Vec3; 2]> {
    let word = |key: &str, default: &str| card.keyword.get(key).unwrap_or(default).to_uppercase();
    let system = word("SYSTEM", "RECTANGULAR");
    if !matches!(system.as_str(), "RECTANGULAR" | "R") || word("DEFINITION", "COORDINATES") != "COORDINATES" {
        let help = "the axes of a material of the scene are the same everywhere: give SYSTEM=RECTANGULAR by two points";
        return Err(card.error("this *ORIENTATION cannot be converted", help));
    }
    let Some(row) = card.rows.first() else { return Err(card.error("*ORIENTATION has no data", "")) };
    let fields: [&str; 9] = row.fields();
    let mut numbers = [0.0; 9];
    for (number, field) in numbers.iter_mut().zip(fields) {
        *number = row.number(field, 0.0)?;
    }
    let [a, b, origin] = [0, 3, 6].map(|k| Vec3::from_column_slice(&numbers[k..k + 3]));
    let (x, z) = (a - origin, (a - origin).cross(&(b - origin)));
    if z.norm() <= 1e-9 * x.norm() * (b - origin).norm() {
        return Err(row.error("the points of the orientation are in one line with its origin", ""));
    }
    let mut axes = [x.normalize(), z.cross(&x).normalize(), z.normalize()];
    if let Some(row) = card.rows.get(1) {
        let [about, angle] = row.fields();
        let about = match about {
            "1" | "2" | "3" => about.as_bytes()[0] - b'1',
            _ => return Err(row.error(format!("expected an axis 1 to 3, found '{about}'"), "")),
        };
        let angle = row.number(angle, 0.0)?.to_radians();
        let turn = Rotation3::from_axis_angle(&Unit::new_unchecked(axes[usize::from(about)]), angle);
        axes = axes.map(|axis| turn * axis);
    }
    Ok([axes[0], axes[1]])
}
