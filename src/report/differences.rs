//! Where the scenes of runs differ.

use super::run::Run;
use std::collections::BTreeMap;
use toml::Value;

/// An entry by its dotted key, with what each run has there.
pub type Difference = (String, Vec<Option<String>>);

/// The entries that are not the same in all runs, but for their titles.
pub fn differences(runs: &[Run]) -> Vec<Difference> {
    let scenes: Vec<BTreeMap<String, String>> = runs.iter().map(|run| entries(&run.scene)).collect();
    let mut keys: Vec<&String> = scenes.iter().flat_map(BTreeMap::keys).collect();
    keys.sort();
    keys.dedup();
    let of = |key: &String| scenes.iter().map(|scene| scene.get(key).cloned()).collect::<Vec<_>>();
    let all = keys.into_iter().filter(|key| *key != "title").map(|key| (key.clone(), of(key)));
    all.filter(|(_, values)| values.iter().any(|value| *value != values[0])).collect()
}

/// The entries of a scene by their dotted keys; steps by their names.
fn entries(scene: &str) -> BTreeMap<String, String> {
    let mut all = BTreeMap::new();
    add(&mut all, "", &Value::Table(scene.parse().unwrap_or_default()));
    all
}

fn add(all: &mut BTreeMap<String, String>, key: &str, value: &Value) {
    let join = |name: &str| if key.is_empty() { name.to_string() } else { format!("{key}.{name}") };
    match value {
        Value::Table(table) => table.iter().for_each(|(name, value)| add(all, &join(name), value)),
        Value::Array(items) if items.iter().all(Value::is_table) => {
            for (number, item) in items.iter().enumerate() {
                let name = item.get("name").and_then(Value::as_str).map_or_else(|| number.to_string(), str::to_string);
                add(all, &join(&name), item);
            }
        }
        _ => {
            all.insert(key.to_string(), value.to_string());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_have_the_keys_of_overrides() {
        let scene = "title = \"a\"\n[body.pad]\nsize = [1, 2]\n[[step]]\nname = \"press\"\nfix = [{ set = \"x\" }]\n";
        let all: Vec<(String, String)> = entries(scene).into_iter().collect();
        let all: Vec<(&str, &str)> = all.iter().map(|(key, value)| (key.as_str(), value.as_str())).collect();
        let step = [("step.press.fix.0.set", "\"x\""), ("step.press.name", "\"press\"")];
        assert_eq!(all, [("body.pad.size", "[1, 2]"), step[0], step[1], ("title", "\"a\"")]);
    }
}
