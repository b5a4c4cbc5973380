//! Ties of unlike faces: `[tie.NAME]`.

use super::reader::{Item, Table};
use super::references::Names;
use super::{Located, Tie};
use crate::error::{Error, Result};

const KEYS: [&str; 3] = ["slave", "master", "tolerance"];

/// Reads all ties; none may occur twice, in either direction.
pub(super) fn read(root: &Table, names: &Names) -> Result<Vec<Tie>> {
    let mut ties: Vec<Tie> = Vec::new();
    for (name, item) in root.named("tie")? {
        let next = tie(name, &item, names)?;
        let faces = |tie: &Tie| {
            let mut faces = [&tie.slave, &tie.master].map(|set| set.value.clone());
            faces.sort_unstable();
            faces
        };
        if let Some(first) = ties.iter().find(|other| faces(other) == faces(&next)) {
            let what = format!("tie.{} repeats the faces of tie.{}", next.name.value, first.name.value);
            return Err(Error::input(&next.slave.at, what, "remove one of them"));
        }
        let of_contact = root.named("contact")?.iter().any(|(name, _)| name.value == next.name.value);
        if of_contact || names.is_target(&next.name.value) {
            let what = format!("`{}` names a tie and a contact, tool or body", next.name.value);
            let help = "rename one of them: the forces of both would have the same names in history.csv";
            return Err(Error::input(&next.name.at, what, help));
        }
        ties.push(next);
    }
    Ok(ties)
}

fn tie(name: Located<String>, item: &Item, names: &Names) -> Result<Tie> {
    let table = item.table(&KEYS)?;
    let [slave, master] = ["slave", "master"].map(|key| names.faces(&table.require(key, "\"BODY.GROUP\"")?));
    let (slave, master) = (slave?, master?);
    if slave.value == master.value {
        let what = format!("ties `{}` to itself", slave.value);
        return Err(Error::input(&master.at, what, "name the faces that it is to be tied to"));
    }
    let tolerance = table.optional("tolerance", Item::positive_or_auto)?.flatten();
    Ok(Tie { name, slave, master, tolerance })
}
