//! A case: what to run, and what must come out.

use crate::common::{self, History};
use crate::oracle::Oracle;
use std::collections::HashMap;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::{Arc, LazyLock, Mutex, OnceLock};
use std::time::{Duration, Instant};

/// What a row may be.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Expected {
    /// The right value, or a reason why there is none.
    RightOrRefused,
    /// The right value: an ordinary model, in which nothing is to be refused.
    Right,
    /// There is no right value, only a reason.
    Refused,
}

/// How a row ended.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// All oracles agree; with the error of the worst.
    Right(String),
    /// Exit code 0, and what is not right is said: with the warning.
    Warned(String),
    /// Exit code 1 or 2, with a reason.
    Refused(String),
    /// Exit code 0, and off by more than the tolerance of an oracle.
    Wrong(String),
    /// Refused without need.
    Failed(String),
    /// Another exit code, or none.
    Crash(String),
    /// Stopped at the time limit.
    Hang(String),
}

#[derive(Clone)]
pub enum Scene {
    /// The text of a scene file.
    Text(String),
    /// One of `inputs/`.
    Input(&'static str),
}

/// What is done in a scratch folder.
type Act = fn(&Path) -> Outcome;

/// A run that is made once.
type Once = Arc<OnceLock<Arc<Done>>>;

#[derive(Clone)]
pub struct Case {
    /// `family/test: variant`.
    pub name: String,
    scene: Scene,
    /// Files beside the scene: name and text.
    files: Vec<(String, String)>,
    /// Further arguments of `nagata run`.
    arguments: Vec<String>,
    ranks: usize,
    oracles: Vec<Oracle>,
    expected: Expected,
    /// Words of which one in the warnings of a run makes up for what its oracles find.
    warning: Option<&'static [&'static str]>,
    /// Words of which one must stand in the reason of a refusal.
    reason: &'static [&'static str],
    /// Ends after its first step, and goes on from its checkpoint.
    goes_on: bool,
    /// Instead of a run: what to do in a scratch folder.
    act: Option<(&'static str, Act)>,
    /// Seconds until it counts as hung.
    limit: u64,
    /// Whether it runs in the default tests.
    pub quick: bool,
}

/// How a run ended.
pub struct Done {
    /// None: stopped at the time limit, or by a signal.
    pub code: Option<i32>,
    pub hung: bool,
    pub stdout: String,
    pub stderr: String,
    /// If it ended with exit code 0.
    pub history: Option<History>,
    pub summary: serde_json::Value,
}

impl Case {
    pub fn new(variant: impl Into<String>, scene: Scene) -> Self {
        Self {
            name: variant.into(),
            scene,
            files: Vec::new(),
            arguments: Vec::new(),
            ranks: 1,
            oracles: Vec::new(),
            expected: Expected::RightOrRefused,
            warning: None,
            reason: &[],
            goes_on: false,
            act: None,
            limit: 120,
            quick: true,
        }
    }

    pub fn text(variant: impl Into<String>, scene: impl Into<String>) -> Self {
        Self::new(variant, Scene::Text(scene.into()))
    }

    /// Anything else than one run: `oracle` says what must come out.
    pub fn act(variant: impl Into<String>, oracle: &'static str, act: fn(&Path) -> Outcome) -> Self {
        Self { act: Some((oracle, act)), ..Self::text(variant, "") }
    }

    pub fn named(self, variant: &str) -> Self {
        Self { name: variant.into(), ..self }
    }

    pub fn set(mut self, entry: impl Into<String>) -> Self {
        self.arguments.extend(["--set".into(), entry.into()]);
        self
    }

    pub fn sets<'a>(mut self, entries: impl IntoIterator<Item = &'a str>) -> Self {
        for entry in entries {
            self = self.set(entry);
        }
        self
    }

    pub fn file(mut self, name: &str, text: impl Into<String>) -> Self {
        self.files.push((name.into(), text.into()));
        self
    }

    pub fn ranks(mut self, ranks: usize) -> Self {
        self.ranks = ranks;
        self
    }

    pub fn oracle(mut self, oracle: Oracle) -> Self {
        self.oracles.push(oracle);
        self
    }

    /// Ends after its first step, and goes on from its checkpoint.
    pub fn goes_on(mut self) -> Self {
        self.goes_on = true;
        self
    }

    /// See [`Expected::Right`].
    pub fn must_run(mut self) -> Self {
        self.expected = Expected::Right;
        self
    }

    /// See [`Expected::Refused`]. One of the words must stand in the reason; without words any will do.
    pub fn must_be_refused(mut self, words: &'static [&'static str]) -> Self {
        (self.expected, self.reason) = (Expected::Refused, words);
        self
    }

    /// A warning with one of these words makes up for what its oracles find.
    pub fn or_warns(mut self, words: &'static [&'static str]) -> Self {
        self.warning = Some(words);
        self
    }

    pub fn limit(mut self, seconds: u64) -> Self {
        self.limit = seconds;
        self
    }

    /// The same with other oracles to come.
    pub fn without_oracles(self) -> Self {
        Self { oracles: Vec::new(), ..self }
    }

    /// Only in the table: takes long.
    pub fn slow(mut self) -> Self {
        self.quick = false;
        self
    }

    /// Only in the table unless `quick`: one of many that are alike.
    pub fn quick_if(mut self, quick: bool) -> Self {
        self.quick &= quick;
        self
    }

    /// What the oracles hold it against.
    pub fn oracle_text(&self) -> String {
        if let Some((oracle, _)) = self.act {
            return oracle.into();
        }
        match self.expected {
            Expected::Refused => "nothing right: to be refused".into(),
            _ => self.oracles.iter().map(Oracle::text).collect::<Vec<_>>().join("; "),
        }
    }

    /// Runs it and judges.
    pub fn outcome(&self) -> Outcome {
        if let Some((_, act)) = self.act {
            return act(tempfile::tempdir().unwrap().path());
        }
        let done = self.run();
        match done.code {
            _ if done.hung => Outcome::Hang(format!("stopped after {} s", self.limit)),
            Some(0) => self.judge(&done),
            Some(1 | 2) => {
                let reason = done.reason();
                if reason.is_empty() {
                    Outcome::Crash(format!("exit code {} without a word", done.code.unwrap()))
                } else if self.expected == Expected::Right {
                    Outcome::Failed(reason)
                } else if !self.reason.is_empty() && !self.reason.iter().any(|word| done.stderr.contains(word)) {
                    Outcome::Failed(format!("for another reason: {reason}"))
                } else {
                    Outcome::Refused(reason)
                }
            }
            code => Outcome::Crash(format!("exit code {code:?}: {}", shown(&done.stderr))),
        }
    }

    /// A run with exit code 0.
    fn judge(&self, done: &Done) -> Outcome {
        let warned = self.warning.and_then(|words| done.warning(words));
        if self.expected == Expected::Refused {
            return match warned {
                Some(line) => Outcome::Warned(line),
                None => Outcome::Wrong(format!("accepted: {}", done.forces())),
            };
        }
        let verdicts: Vec<_> = self.oracles.iter().map(|oracle| oracle.judge(done)).collect();
        let text = verdicts.iter().map(|v| v.text.as_str()).collect::<Vec<_>>().join("; ");
        if verdicts.iter().all(|v| v.holds == Some(true)) {
            return Outcome::Right(text);
        }
        if verdicts.iter().all(|v| v.holds != Some(false)) {
            return Outcome::Failed(text);
        }
        match warned {
            Some(line) => Outcome::Warned(format!("{text}; {line}")),
            None => Outcome::Wrong(format!("{text}{}", done.cost())),
        }
    }

    /// Runs it, or takes what the same run gave before.
    pub fn run(&self) -> Arc<Done> {
        static DONE: LazyLock<Mutex<HashMap<String, Once>>> = LazyLock::new(Default::default);
        let scene = match &self.scene {
            Scene::Text(text) => text,
            Scene::Input(name) => *name,
        };
        let key = format!("{scene}\n{:?}\n{:?}\n{}{}", self.arguments, self.files, self.ranks, self.goes_on);
        let slot = DONE.lock().unwrap().entry(key).or_default().clone();
        slot.get_or_init(|| Arc::new(self.run_anew())).clone()
    }

    fn run_anew(&self) -> Done {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in &self.files {
            fs::write(folder.path().join(name), text).unwrap();
        }
        let scene = match &self.scene {
            Scene::Text(text) => {
                fs::write(folder.path().join("scene.toml"), text).unwrap();
                folder.path().join("scene.toml")
            }
            Scene::Input(name) => Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs").join(name),
        };
        let mut arguments = vec!["run".to_string(), scene.to_str().unwrap().into(), "--out".into()];
        arguments.push(folder.path().join("out").to_str().unwrap().into());
        arguments.extend(self.arguments.iter().cloned());
        for entry in std::env::var("NAGATA_CONTROLS").unwrap_or_default().split_whitespace() {
            arguments.extend(["--set".into(), entry.into()]);
        }
        let run = |more: &[&str]| {
            let arguments: Vec<String> =
                arguments.iter().cloned().chain(more.iter().map(ToString::to_string)).collect();
            nagata(folder.path(), self.ranks, &arguments, self.limit)
        };
        let (code, hung, stdout, stderr) = match self.goes_on {
            true => {
                Some(run(&["--steps", "1"])).filter(|first| first.0 != Some(0)).unwrap_or_else(|| run(&["--restart"]))
            }
            false => run(&[]),
        };
        let out = folder.path().join("out");
        let summary = fs::read_to_string(out.join("summary.json")).ok();
        Done {
            history: (code == Some(0)).then(|| History::read(&out.join("history.csv"))),
            summary: summary.and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default(),
            code,
            hung,
            stdout,
            stderr,
        }
    }
}

/// Runs the program; its exit code, whether it was stopped at the time limit, and what it said.
pub fn nagata(folder: &Path, ranks: usize, arguments: &[String], limit: u64) -> (Option<i32>, bool, String, String) {
    // To files: a pipe that nobody reads would fill up.
    let [said, failed]: [PathBuf; 2] = ["stdout", "stderr"].map(|name| folder.join(name));
    let program = Path::new(env!("CARGO_BIN_EXE_nagata"));
    let started = Instant::now();
    let mut child = common::mpirun_within(limit, ranks, program)
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(fs::File::create(&said).unwrap())
        .stderr(fs::File::create(&failed).unwrap())
        .spawn()
        .unwrap();
    let code = child.wait().unwrap().code();
    let text = |path| String::from_utf8_lossy(&fs::read(path).unwrap()).into_owned();
    (code, started.elapsed() >= Duration::from_secs(limit), text(&said), text(&failed))
}

impl Done {
    /// The reason of a refusal, in one line.
    pub fn reason(&self) -> String {
        let error = self.stderr.split("error: ").nth(1).unwrap_or_default();
        error.split("help:").next().unwrap_or_default().split_whitespace().collect::<Vec<_>>().join(" ")
    }

    /// The first warning with one of the words.
    pub fn warning(&self, words: &[&str]) -> Option<String> {
        let mut lines = self.stderr.lines().chain(self.stdout.lines());
        lines.find(|line| line.contains("warning") && words.iter().any(|word| line.contains(word))).map(shown)
    }

    /// The last forces of everything in the history.
    fn forces(&self) -> String {
        let Some(history) = self.history.as_ref().filter(|history| history.len() > 0) else { return "no rows".into() };
        let mut text = String::new();
        for name in history.names().iter().filter_map(|name| name.strip_suffix(".fx")) {
            let [x, y, z] = ["fx", "fy", "fz"].map(|c| history.last(&format!("{name}.{c}")));
            let _ = write!(text, "{name} ({x:.3e}, {y:.3e}, {z:.3e}) ");
        }
        text.trim_end().into()
    }

    /// Cutbacks and jumps of a run that has any.
    fn cost(&self) -> String {
        let mut text = String::new();
        for what in ["cutbacks", "jumps"] {
            if let Some(n) = self.summary[what].as_u64().filter(|n| *n > 0) {
                let _ = write!(text, ", {n} {what}");
            }
        }
        text
    }
}

/// One line of a text, not too long.
pub fn shown(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let short: String = line.chars().take(150).collect();
    if short.len() < line.len() { short + " ..." } else { short }
}

/// The tests of a family, and its part of the table. A test runs its quick cases.
macro_rules! family {
    ($($(#[$attribute:meta])* $test:ident),+ $(,)?) => {
        /// The part of the table.
        pub fn cases() -> Vec<crate::case::Case> {
            let family = module_path!().rsplit("::").next().unwrap();
            [$((stringify!($test), $test())),+]
                .into_iter()
                .flat_map(|(test, cases)| cases.into_iter().map(move |case| case.within(family, test)))
                .collect()
        }

        mod quick {
            $(#[test] $(#[$attribute])* fn $test() {
                let family = module_path!().rsplit("::").nth(1).unwrap();
                let cases = super::$test().into_iter().map(|case| case.within(family, stringify!($test)));
                crate::table::hold(cases.collect());
            })+
        }
    };
}

impl Case {
    /// Names its place.
    pub fn within(self, family: &str, test: &str) -> Self {
        Self { name: format!("{family}/{test}: {}", self.name), ..self }
    }
}
