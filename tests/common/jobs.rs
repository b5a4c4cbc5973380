//! Runs that something happens to: their processes, and what they leave.

use super::{Bench, mpirun};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A block under a plate that touches it, to which steps are added.
pub const BLOCK_UNDER_PLATE: &str = r#"[body.block]
material = "rubber"
block = { box = { size = [2.0, 2.0, 2.0] }, elements = [2, 2, 2], faces = { top = "zmax", bottom = "zmin" } }

[material.rubber]
model = "neo-hookean"
young = 100.0
poisson = 0.3

[tool.plate]
plane = { point = [0.0, 0.0, 2.0], normal = [0.0, 0.0, -1.0] }

[contact.top]
slave = "block.top"
master = "plate"
friction = 0.2

"#;

/// A run under way.
pub struct Job {
    pub child: Child,
    pub ranks: Vec<u32>,
}

impl Job {
    /// Starts a run into `out`, and waits until so many increments have converged.
    pub fn start(bench: &Bench, ranks: usize, rows: usize, arguments: &[&str]) -> Self {
        // That of the run before would count.
        let _ = std::fs::remove_file(bench.path("out/history.csv"));
        Self::go_on(bench, ranks, rows, arguments)
    }

    /// The same of one that may go on where another was.
    pub fn go_on(bench: &Bench, ranks: usize, rows: usize, arguments: &[&str]) -> Self {
        let mut command = mpirun(ranks);
        command.args(["run", "scene.toml", "--out", "out"]).args(arguments).current_dir(bench.path(""));
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let out = bench.path("out");
        wait_for(&mut child, "rows", |_| (rows_in(&out) >= rows).then_some(()));
        let started = |child: &mut Child| Some(children(child.id())).filter(|found| found.len() == ranks);
        let ranks = wait_for(&mut child, "the ranks", started);
        Self { child, ranks }
    }

    /// Waits for the end of the job and of its ranks; its exit code, and what it said of errors.
    pub fn end(mut self) -> (i32, String) {
        let status = wait_for(&mut self.child, "the end of the job", |job| job.try_wait().unwrap());
        let gone = || self.ranks.iter().all(|pid| !Path::new(&format!("/proc/{pid}")).exists());
        wait_for(&mut self.child, "the end of the ranks", |_| gone().then_some(()));
        let mut said = String::new();
        std::io::Read::read_to_string(self.child.stderr.as_mut().unwrap(), &mut said).unwrap();
        (status.code().unwrap_or(-1), said)
    }
}

/// Whole rows of the history so far.
pub fn rows_in(out: &Path) -> usize {
    let text = std::fs::read_to_string(out.join("history.csv")).unwrap_or_default();
    text.matches('\n').count().saturating_sub(1)
}

pub fn send(signal: &str, pid: u32) {
    assert!(Command::new("kill").args(["-s", signal, &pid.to_string()]).status().unwrap().success());
}

/// The times in `fields.xdmf` after 0, with which it begins. Its tags must close, and its data must stand in `fields.h5` in the
/// size it promises.
pub fn shown_times(folder: &Path) -> Vec<f64> {
    let text = std::fs::read_to_string(folder.join("fields.xdmf")).unwrap();
    let file = hdf5::File::open(folder.join("fields.h5")).unwrap();
    let (mut open, mut times): (Vec<&str>, Vec<f64>) = (Vec::new(), Vec::new());
    let (prologue, tags) = text.split_at(text.find("<Xdmf").unwrap());
    assert!(prologue.starts_with("<?xml ") && prologue.trim_end().ends_with("?>"));
    for piece in tags.split('<').skip(1) {
        let (tag, content) = piece.split_once('>').unwrap();
        let name = tag.split([' ', '/']).next().unwrap();
        let value = |key: &str| tag.split(&format!("{key}=\"")).nth(1).unwrap().split('"').next().unwrap();
        match tag.strip_prefix('/') {
            Some(end) => assert_eq!(open.pop(), Some(end)),
            None if tag.ends_with('/') => {}
            None => open.push(name),
        }
        match name {
            "Time" => times.push(value("Value").parse().unwrap()),
            "DataItem" => {
                let path = content.strip_prefix("fields.h5:").unwrap();
                let shape: Vec<usize> = value("Dimensions").split(' ').map(|n| n.parse().unwrap()).collect();
                assert_eq!(file.dataset(path).unwrap_or_else(|e| panic!("{path}: {e}")).shape(), shape, "{path}");
            }
            _ => {}
        }
    }
    assert!(open.is_empty() && times.first() == Some(&0.0), "{open:?} {times:?}");
    times.split_off(1)
}

/// The processes that `parent` has started, lowest first.
pub fn children(parent: u32) -> Vec<u32> {
    let parent_of = |pid: u32| {
        let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
        stat.rsplit(')').next()?.split_whitespace().nth(1)?.parse::<u32>().ok()
    };
    let all = std::fs::read_dir("/proc").unwrap().filter_map(|entry| entry.ok()?.file_name().to_str()?.parse().ok());
    let mut found: Vec<u32> = all.filter(|&pid| parent_of(pid) == Some(parent)).collect();
    found.sort_unstable();
    found
}

/// Polls until `done` gives something; the job is ended when it does not in time, which a busy machine needs.
pub fn wait_for<T>(job: &mut Child, what: &str, mut done: impl FnMut(&mut Child) -> Option<T>) -> T {
    const PATIENCE: Duration = Duration::from_secs(600);
    let begun = Instant::now();
    loop {
        if let Some(value) = done(job) {
            return value;
        }
        if begun.elapsed() > PATIENCE {
            job.kill().unwrap();
            panic!("{what} not within {PATIENCE:?}");
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}
