//! Typed access to the tree of a scene: every error carries the place, what was found and what would be right.

use super::Located;
use super::names::{LONGEST, did_you_mean, is_name, nearest};
use super::schema;
use super::tree::{self, Node, Value};
use crate::Vec3;
use crate::error::{Error, Faults, Location, Result};
use std::path::{Path, PathBuf};

/// A value of the scene and its dotted key, as `--set` takes it: `step.press.fix.0`.
#[derive(Clone, Debug)]
pub(super) struct Item<'a> {
    node: &'a Node,
    path: String,
}

/// A table whose keys are known to be of the schema.
#[derive(Clone, Debug)]
pub(super) struct Table<'a>(Item<'a>);

impl<'a> Item<'a> {
    pub fn root(node: &'a Node) -> Self {
        Self { node, path: String::new() }
    }

    pub fn at(&self) -> &'a Location {
        &self.node.at
    }

    /// Whether this is a string.
    pub fn is_string(&self) -> bool {
        matches!(self.node.value, Value::Leaf(toml::Value::String(_)))
    }

    /// Whether this is a list.
    pub fn is_list(&self) -> bool {
        matches!(self.node.value, Value::List(_))
    }

    /// Whether this is a table.
    pub fn is_table(&self) -> bool {
        matches!(self.node.value, Value::Table(_))
    }

    /// An error about this value: "`path` `what`".
    pub fn error(&self, what: impl AsRef<str>, help: impl Into<String>) -> Error {
        Error::input(self.at(), format!("{} {}", self.path, what.as_ref()), help)
    }

    /// The value is of another type; `example` is a right one, in TOML.
    fn wrong_type(&self, expected: &str, example: &str) -> Error {
        let key = self.path.rsplit('.').next().unwrap_or_default();
        let index = key.starts_with(|c: char| c.is_ascii_digit());
        let example = if index { example.to_string() } else { format!("{key} = {example}") };
        self.error(format!("must be {expected}, not {}", self.node.kind()), format!("for example `{example}`"))
    }

    fn child(&self, key: &str, node: &'a Node) -> Self {
        let path = if self.path.is_empty() { key.to_string() } else { format!("{}.{key}", self.path) };
        Self { node, path }
    }

    /// A finite number.
    pub fn number(&self) -> Result<f64> {
        let value = match &self.node.value {
            Value::Leaf(toml::Value::Integer(value)) => *value as f64,
            Value::Leaf(toml::Value::Float(value)) => *value,
            _ => return Err(self.wrong_type("a number", "1.0")),
        };
        if value.is_finite() { Ok(value) } else { Err(self.error("must be finite", "")) }
    }

    /// A number that is `expected`: "above 0".
    pub fn number_that_is(&self, expected: &str, holds: impl Fn(f64) -> bool, help: &str) -> Result<f64> {
        let value = self.number()?;
        if holds(value) { Ok(value) } else { Err(self.error(format!("must be {expected}, not {value:?}"), help)) }
    }

    /// A number above 0.
    pub fn positive(&self) -> Result<f64> {
        self.number_that_is("above 0", |value| value > 0.0, "")
    }

    /// A number above 0, or "auto": none.
    pub fn positive_or_auto(&self) -> Result<Option<f64>> {
        if self.is_string() { self.choice(&[("auto", None)]) } else { self.positive().map(Some) }
    }

    /// The angle between normals up to which an edge is smooth, degrees.
    pub fn feature_angle(&self) -> Result<f64> {
        self.number_that_is("above 0 and at most 180", |value| value > 0.0 && value <= 180.0, "it is in degrees")
    }

    /// An integer from 1.
    pub fn count(&self) -> Result<usize> {
        let Value::Leaf(toml::Value::Integer(value)) = self.node.value else {
            return Err(match self.number() {
                Ok(value) => self.error(format!("must be an integer, not {value:?}"), ""),
                Err(_) => self.wrong_type("an integer", "1"),
            });
        };
        let count = usize::try_from(value).ok().filter(|&count| count >= 1);
        count.ok_or_else(|| self.error(format!("must be 1 or more, not {value}"), ""))
    }

    /// How many times each element of a mesh is split; `None` for 0.
    pub fn splits(&self) -> Result<Option<Located<u32>>> {
        const MOST: f64 = 6.0;
        let whole = |value: f64| value.fract() == 0.0 && (0.0..=MOST).contains(&value);
        let times = self.number_that_is("a whole number from 0 to 6", whole, "each time splits every edge in two")?;
        Ok((times > 0.0).then(|| self.located(times as u32)))
    }

    pub fn boolean(&self) -> Result<bool> {
        match &self.node.value {
            Value::Leaf(toml::Value::Boolean(value)) => Ok(*value),
            _ => Err(self.wrong_type("true or false", "true")),
        }
    }

    pub fn string(&self) -> Result<&'a str> {
        match &self.node.value {
            Value::Leaf(toml::Value::String(text)) => Ok(text),
            _ => Err(self.wrong_type("a string", "\"...\"")),
        }
    }

    pub fn located_string(&self) -> Result<Located<String>> {
        Ok(self.located(self.string()?.to_string()))
    }

    /// A value read from here, with this place.
    pub fn located<T>(&self, value: T) -> Located<T> {
        Located { value, at: self.at().clone() }
    }

    /// A number, string or boolean, or a list of them, as an override gives it: TOML, but a string that is none is bare.
    pub fn plain_toml(&self) -> Result<String> {
        let is_plain = |node: &Node| matches!(node.value, Value::Leaf(_));
        match &self.node.value {
            Value::Leaf(toml::Value::String(text)) if tree::is_bare(text) => Ok(text.clone()),
            Value::Leaf(_) => Ok(tree::inline(self.node)),
            Value::List(items) if items.iter().all(is_plain) => Ok(tree::inline(self.node)),
            _ => Err(self.wrong_type("a number, a string, a boolean, or a list of them", "1.0")),
        }
    }

    /// One of some words.
    pub fn choice<T: Copy>(&self, choices: &[(&str, T)]) -> Result<T> {
        let word = self.string()?;
        let found = choices.iter().find(|choice| choice.0 == word);
        found.map(|choice| choice.1).ok_or_else(|| {
            let help = did_you_mean(word, choices.iter().map(|choice| choice.0));
            self.error(format!("cannot be {word:?}"), help)
        })
    }

    /// Some of three letters, as of "xyz".
    pub fn directions(&self, letters: &str) -> Result<[bool; 3]> {
        let word = self.string()?;
        let mut directions = [false; 3];
        for letter in word.chars() {
            match letters.find(letter) {
                Some(axis) if !directions[axis] => directions[axis] = true,
                _ => return Err(self.bad_directions(word, letters)),
            }
        }
        if word.is_empty() { Err(self.bad_directions(word, letters)) } else { Ok(directions) }
    }

    fn bad_directions(&self, word: &str, letters: &str) -> Error {
        let ([a, b, c], [first, others]) = ([0, 1, 2].map(|d| &letters[d..=d]), [&letters[..1], &letters[1..]]);
        let help = format!("for example \"{first}\", \"{others}\" or \"{letters}\"");
        self.error(format!("must be some of the letters {a}, {b} and {c}, each once, not {word:?}"), help)
    }

    /// The elements of a list.
    pub fn list(&self) -> Result<Vec<Item<'a>>> {
        let Value::List(nodes) = &self.node.value else { return Err(self.wrong_type("a list", "[ ... ]")) };
        let item = |(index, node): (usize, &'a Node)| match node.name().filter(|name| is_name(name)) {
            Some(name) => self.child(name, node),
            None => self.child(&index.to_string(), node),
        };
        Ok(nodes.iter().enumerate().map(item).collect())
    }

    /// The elements of a list that has some.
    pub fn filled_list(&self) -> Result<Vec<Item<'a>>> {
        let list = self.list()?;
        if list.is_empty() { Err(self.error("is an empty list", "remove it, or list something")) } else { Ok(list) }
    }

    /// A list of `N` values, each read by `read`; `example` is a right list.
    pub fn array<T, const N: usize>(&self, read: impl Fn(&Item<'a>) -> Result<T>, example: &str) -> Result<[T; N]> {
        let expected = format!("a list of {N} numbers");
        let Value::List(_) = &self.node.value else { return Err(self.wrong_type(&expected, example)) };
        let values = self.list()?.iter().map(read).collect::<Result<Vec<T>>>()?;
        let length = |values: Vec<T>| self.error(format!("must be {expected}, not of {}", values.len()), "");
        values.try_into().map_err(length)
    }

    /// The path of a file whose name is relative to `directory`.
    pub fn file(&self, directory: &Path) -> Result<Located<PathBuf>> {
        match self.string()? {
            "" => Err(self.error("names no file", "")),
            name => Ok(self.located(directory.join(name))),
        }
    }

    pub fn vector(&self) -> Result<Vec3> {
        Ok(Vec3::from(self.array::<f64, 3>(Item::number, "[0.0, 0.0, 1.0]")?))
    }

    /// A vector that is not zero, scaled to length 1.
    pub fn unit_vector(&self) -> Result<Vec3> {
        let vector = self.vector()?;
        // Squares of very large and very small numbers are none.
        let largest = vector.amax();
        let vector = if largest > 0.0 { vector / largest } else { vector };
        vector.try_normalize(f64::MIN_POSITIVE).ok_or_else(|| self.error("must not be the zero vector", ""))
    }

    /// A table that has no keys but `known` ones.
    pub fn table(&self, known: &[&str]) -> Result<Table<'a>> {
        let (table, strange) = self.table_and_strange(known)?;
        strange.map(|()| table)
    }

    /// A table, and what is wrong with the names of its keys.
    pub fn table_and_strange(&self, known: &[&str]) -> Result<(Table<'a>, Result<()>)> {
        let Value::Table(entries) = &self.node.value else { return Err(self.wrong_type("a table", "{ ... }")) };
        let unknown = |entry: &&tree::Entry| !known.contains(&entry.key.as_str());
        let strange = Faults::all(entries.iter().filter(unknown).map(|entry| {
            let inside = if self.path.is_empty() { "the scene" } else { &self.path };
            let what = format!("unknown key `{}` in {inside}", entry.key);
            let (key, known) = (&entry.key, || known.iter().copied());
            let mut help = did_you_mean(key, known());
            let elsewhere = schema::tables_with(key);
            if nearest(key, known()).is_none() && !elsewhere.is_empty() {
                help += &format!("; it is a key of {}", elsewhere.join(", "));
            }
            Err::<(), _>(Error::input(&entry.key_at, what, help))
        }));
        Ok((Table(self.clone()), strange.map(|_| ())))
    }

    /// The entries of a table whose keys the user chose.
    pub fn named(&self) -> Result<Vec<(Located<String>, Item<'a>)>> {
        let Value::Table(entries) = &self.node.value else { return Err(self.wrong_type("a table", "{ NAME = ... }")) };
        let named = |entry: &'a super::tree::Entry| {
            check_name(&entry.key, &entry.key_at)?;
            let name = Located { value: entry.key.clone(), at: entry.key_at.clone() };
            Ok((name, self.child(&entry.key, &entry.node)))
        };
        Faults::all(entries.iter().map(named))
    }
}

impl<'a> Table<'a> {
    pub fn at(&self) -> &'a Location {
        self.0.at()
    }

    pub fn error(&self, what: impl AsRef<str>, help: impl Into<String>) -> Error {
        self.0.error(what, help)
    }

    pub fn get(&self, key: &str) -> Option<Item<'a>> {
        self.0.node.get(key).map(|node| self.0.child(key, node))
    }

    /// The value of a key that must be there; `example` is a right value, in TOML.
    pub fn require(&self, key: &str, example: &str) -> Result<Item<'a>> {
        self.get(key).ok_or_else(|| self.error(format!("has no `{key}`"), format!("add `{key} = {example}`")))
    }

    /// Reads the value of a key if it is there.
    pub fn optional<T>(&self, key: &str, read: impl FnOnce(&Item<'a>) -> Result<T>) -> Result<Option<T>> {
        self.get(key).as_ref().map(read).transpose()
    }

    /// Reads every element of a list if it is there.
    pub fn each<T>(&self, key: &str, read: impl Fn(&Item<'a>) -> Result<T>) -> Result<Vec<T>> {
        let list = self.optional(key, Item::list)?.unwrap_or_default();
        Faults::all(list.iter().map(read))
    }

    /// The named tables under a key, none if it is missing.
    pub fn named(&self, key: &str) -> Result<Vec<(Located<String>, Item<'a>)>> {
        Ok(self.optional(key, Item::named)?.unwrap_or_default())
    }
}

/// Refuses a name that dotted keys and history columns could not hold.
pub(super) fn check_name(name: &str, at: &Location) -> Result<()> {
    let help = format!("a name is a letter followed by letters, digits, `_` and `-`, {LONGEST} characters at most");
    if is_name(name) { Ok(()) } else { Err(Error::input(at, format!("{name:?} cannot be a name"), help)) }
}
