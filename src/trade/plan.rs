//! Which runs are made, and in which order: the scene as it is, the reference with what tells its own error, then the
//! settings one at a time.

use super::errors::check_exact;
use super::fields;
use super::settings::{self, Setting};
use crate::error::{Error, Location, Result};
use crate::scene::{self, Located, Scene, Varied, Vary};
use std::path::Path;

/// A run: the scene with some of its entries changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    pub label: String,
    /// What is varied; variants of one setting exclude each other. Empty for the scene as it is and the references.
    pub setting: String,
    /// As of `--set`, beside those of all runs.
    pub overrides: Vec<String>,
    /// Wall time over that of the scene as it is, roughly; `None` when nobody knows.
    pub cost: Option<f64>,
}

impl Variant {
    pub fn new(label: &str, overrides: Vec<String>, cost: Option<f64>) -> Self {
        Self { label: label.to_string(), setting: String::new(), overrides, cost }
    }

    /// The name of its folder.
    pub fn folder(&self) -> String {
        let plain = |c: char| if c.is_ascii_alphanumeric() || "._=-".contains(c) { c } else { '_' };
        let name: String = self.label.chars().map(plain).take(120).collect();
        name.trim_start_matches('.').to_string()
    }
}

/// The run that others are compared with, and those that tell how far it is off itself.
#[derive(Clone, Debug, Default)]
pub struct Reference {
    /// Numbers of runs, each a little less accurate than the one before, with the part of the difference to the one before
    /// that counts as the error of this; of the first, the reference, nothing.
    pub chain: Vec<(usize, f64)>,
    /// Whether nobody asked for it, so that the next of the chain may take its place when it fails.
    pub is_suggested: bool,
}

/// All runs but those that combine others.
#[derive(Clone, Debug)]
pub struct Plan {
    pub runs: Vec<Variant>,
    pub reference: Reference,
    /// Labels of what would take too long.
    pub left_out: Vec<String>,
    /// Overrides of all runs.
    pub common: Vec<String>,
    pub steps: Option<usize>,
}

/// What the command line says about it.
#[derive(Clone, Debug, Default)]
pub struct Wishes<'a> {
    pub overrides: &'a [String],
    /// `KEY=VALUE,VALUE`, or `KEY,KEY=VALUE,VALUE` for keys that share their values.
    pub vary: &'a [String],
    pub reference: &'a [String],
    pub next: &'a [String],
    pub steps: Option<usize>,
    /// What all runs may take together, times the scene as it is.
    pub budget: f64,
}

/// Fields are written at the ends of steps only.
const RARELY: &str = "output.every=1000000";

/// Share of the budget that the reference may take.
const SHARE_OF_REFERENCE: f64 = 0.7;

/// What is kept for combined runs, times the scene.
const FOR_COMBINED: f64 = 1.5;

impl Plan {
    /// Reads the scene, and all that the user asks for, before anything runs.
    ///
    /// # Errors
    /// Wrong input: the scene, or what it or the command line says about variants, with the place.
    pub fn new(path: &Path, wishes: &Wishes) -> Result<(Self, Scene)> {
        let written = scene::load(path, wishes.overrides)?;
        let trade = &written.trade;
        let mut common = texts(&trade.set);
        common.extend_from_slice(wishes.overrides);
        common.push(RARELY.into());
        if !fields::READ.iter().all(|field| written.output.fields.contains(field)) {
            let keys: Vec<String> = fields::READ.iter().map(|field| format!("{:?}", field.key())).collect();
            common.push(format!("output.fields=[{}]", keys.join(", ")));
        }
        let scene = check(path, &common, &[], trade.set.first().map(|set| &set.at))?;
        for exact in &trade.exact {
            check_exact(exact, &scene)?;
        }
        let mut plan = Self {
            runs: vec![Variant::new("as it is", Vec::new(), Some(1.0))],
            reference: Reference::default(),
            left_out: Vec::new(),
            steps: wishes.steps.or(trade.steps),
            common,
        };
        plan.add_reference(path, wishes, &scene)?;
        let asked = asked(path, &plan.common, wishes, &trade.vary)?;
        if asked.is_empty() {
            plan.add_suggested(settings::of(&scene, written.output.every), wishes.budget);
        } else {
            asked.into_iter().for_each(|variant| {
                plan.add(variant);
            });
        }
        Ok((plan, scene))
    }

    /// Adds a run unless there is one of the same settings; its number.
    pub fn add(&mut self, variant: Variant) -> usize {
        let same = |other: &Variant| sorted(&other.overrides) == sorted(&variant.overrides);
        let found = self.runs.iter().position(same);
        found.unwrap_or_else(|| {
            let mut variant = variant;
            while self.runs.iter().any(|other| other.folder() == variant.folder()) {
                variant.label.push('\'');
            }
            self.runs.push(variant);
            self.runs.len() - 1
        })
    }

    /// The runs by number as they are made: the scene as it is, the references, with which all others are compared, the rest.
    pub fn order(&self) -> Vec<usize> {
        let chain = self.reference.chain.iter().map(|(number, _)| *number);
        let mut order: Vec<usize> = Vec::new();
        for number in std::iter::once(0).chain(chain).chain(0..self.runs.len()) {
            if !order.contains(&number) {
                order.push(number);
            }
        }
        order
    }

    /// The reference that the user has named, or that the scene suggests.
    fn add_reference(&mut self, path: &Path, wishes: &Wishes, scene: &Scene) -> Result<()> {
        let trade = &scene.trade;
        let given = |words: &[String], located: &Option<Vec<Located<String>>>| match (words, located) {
            ([], None) => None,
            ([], Some(located)) => Some((texts(located), located.first().map(|first| first.at.clone()))),
            (words, _) => Some((words.to_vec(), None)),
        };
        let mut chain = match given(wishes.reference, &trade.reference) {
            Some((overrides, at)) => {
                check(path, &self.common, &overrides, at.as_ref())?;
                vec![(Variant::new("reference", overrides, None), 0.0)]
            }
            None => {
                self.reference.is_suggested = true;
                settings::references(scene, SHARE_OF_REFERENCE * wishes.budget)
            }
        };
        if let Some((overrides, at)) = given(wishes.next, &trade.next) {
            check(path, &self.common, &overrides, at.as_ref())?;
            chain.truncate(1);
            chain.push((Variant::new("next to the reference", overrides, None), 1.0));
        }
        for (variant, share) in chain {
            let number = self.add(variant);
            self.reference.chain.push((number, share));
        }
        Ok(())
    }

    /// Adds settings in their order, while they fit into the budget.
    fn add_suggested(&mut self, settings: Vec<Setting>, budget: f64) {
        let mut spent: f64 = FOR_COMBINED + self.runs.iter().filter_map(|run| run.cost).sum::<f64>();
        for variant in settings.into_iter().flat_map(Setting::variants) {
            let cost = variant.cost.unwrap_or(1.0);
            if spent + cost > budget {
                self.left_out.push(variant.label);
            } else {
                spent += cost;
                self.add(variant);
            }
        }
    }
}

/// The variants that the user asks for: of the command line, else of the scene.
fn asked(path: &Path, common: &[String], wishes: &Wishes, vary: &[Vary]) -> Result<Vec<Variant>> {
    let settings = if wishes.vary.is_empty() {
        vary.iter().map(|vary| (setting(&vary.kind), Some(&vary.at))).collect()
    } else {
        wishes.vary.iter().map(|text| Ok((of_words(text)?, None))).collect::<Result<Vec<_>>>()?
    };
    let mut variants = Vec::new();
    for (setting, at) in settings {
        for variant in setting.variants() {
            check(path, common, &variant.overrides, at)?;
            variants.push(variant);
        }
    }
    Ok(variants)
}

fn setting(varied: &Varied) -> Setting {
    match varied {
        Varied::Keys { keys, values } => Setting::of_keys(keys, values),
        Varied::Together { name, set } => Setting { name: name.clone(), ways: vec![(name.clone(), texts(set), None)] },
    }
}

/// The setting of `--vary KEY=VALUE,VALUE`.
fn of_words(text: &str) -> Result<Setting> {
    let wrong = |what: &str| {
        let help = "write `--vary KEY=VALUE,VALUE`, as in `--vary solver.pace=2,0.5`; values that are lists in a list, as in \
                    `--vary 'body.block.block.elements=[[10,10,5],[20,20,10]]'`";
        Error::input_anywhere(format!("--vary {text}: {what}"), help)
    };
    let (keys, values) = text.split_once('=').ok_or_else(|| wrong("has no `=`"))?;
    let keys: Vec<String> = keys.split(',').map(|key| key.trim().to_string()).collect();
    let list = |text: &str| -> Option<Vec<String>> {
        let table: toml::Table = format!("values = {text}").parse().ok()?;
        Some(table["values"].as_array()?.iter().map(ToString::to_string).collect())
    };
    let plain = || values.split(',').map(|value| value.trim().to_string()).collect();
    let values: Vec<String> = match values.trim().starts_with('[') {
        true => list(values).ok_or_else(|| wrong("is no list"))?,
        // A comma in quotes is none between values.
        false if values.contains('"') => list(&format!("[{values}]")).unwrap_or_else(plain),
        false => plain(),
    };
    if values.is_empty() || values.iter().chain(&keys).any(String::is_empty) {
        return Err(wrong("has an empty key or value"));
    }
    Ok(Setting::of_keys(&keys, &values))
}

/// The scene with overrides, as it would run; an error tells where the user wants them.
fn check(path: &Path, common: &[String], overrides: &[String], at: Option<&Location>) -> Result<Scene> {
    let all: Vec<String> = common.iter().chain(overrides).cloned().collect();
    scene::load(path, &all).map_err(|error| at.map_or(error.clone(), |at| told_at(error, at)))
}

fn told_at(error: Error, at: &Location) -> Error {
    match error {
        Error::Input { at: Some(inner), what, help } => Error::input(at, format!("{inner}: {what}"), help),
        Error::Inputs(errors) => Error::Inputs(errors.into_iter().map(|error| told_at(error, at)).collect()),
        other => other,
    }
}

fn texts(located: &[Located<String>]) -> Vec<String> {
    located.iter().map(|text| text.value.clone()).collect()
}

fn sorted(overrides: &[String]) -> Vec<&String> {
    let mut sorted: Vec<&String> = overrides.iter().collect();
    sorted.sort();
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_the_command_line_are_settings() {
        let labels = |text: &str| of_words(text).unwrap().variants().into_iter().map(|v| v.label).collect::<Vec<_>>();
        assert_eq!(labels("solver.pace=2, 0.5"), ["solver.pace=2", "solver.pace=0.5"]);
        assert_eq!(labels("contact.a.method,contact.b.method=penalty"), ["method=penalty"]);
        let setting = of_words("contact.a.method,contact.b.method=penalty").unwrap();
        let both = ["contact.a.method=penalty", "contact.b.method=penalty"];
        assert_eq!(setting.clone().variants()[0].overrides, both);
        assert_eq!(labels("b.elements=[[2, 2, 1], [4, 4, 2]]"), ["b.elements=[2, 2, 1]", "b.elements=[4, 4, 2]"]);
        assert_eq!(labels(r#"a.title="x, y", "z""#), [r#"a.title="x, y""#, r#"a.title="z""#]);
        for wrong in ["solver.pace", "solver.pace=", "=1", "a=1,,2", "a=[1", "a=[]"] {
            assert_eq!(of_words(wrong).unwrap_err().exit_code(), 2, "{wrong}");
        }
    }

    #[test]
    fn folders_have_plain_names() {
        let folder = |label: &str| Variant::new(label, Vec::new(), None).folder();
        assert_eq!(folder("b.elements=[2, 2]"), "b.elements=_2__2_");
        assert_eq!(folder("../up"), "_up");
    }

    #[test]
    fn runs_of_the_same_settings_are_one() {
        let mut plan = Plan {
            runs: vec![Variant::new("as it is", Vec::new(), None)],
            reference: Reference::default(),
            left_out: Vec::new(),
            common: Vec::new(),
            steps: None,
        };
        let mut add = |label, overrides: &[&str]| {
            plan.add(Variant::new(label, overrides.iter().map(ToString::to_string).collect(), None))
        };
        assert_eq!(add("a b", &["x=1", "y=2"]), 1);
        assert_eq!(add("c", &["y=2", "x=1"]), 1);
        assert_eq!(add("a_b", &["x=2"]), 2);
        assert_eq!(add("d", &[]), 0);
        assert_eq!(plan.runs.iter().map(Variant::folder).collect::<Vec<_>>(), ["as_it_is", "a_b", "a_b_"]);
    }
}
