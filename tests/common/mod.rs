//! Runs the program as a user does, under mpirun, and reads what it writes.

#![allow(dead_code)] // each test file uses its part

pub mod fillers;
pub mod hertz;
pub mod jobs;
pub mod keys;
pub mod msh;
pub mod stl;

use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::rc::Rc;

/// Scratch folder of a test with its scene and results; removed with it and its runs.
pub struct Bench {
    folder: Rc<tempfile::TempDir>,
    /// Runs so far: each has its own folder.
    runs: Cell<usize>,
}

/// How a run ended.
pub struct Run {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
    pub out: PathBuf,
    /// Keeps the results.
    folder: Option<Rc<tempfile::TempDir>>,
}

/// `history.csv`: columns by name.
pub struct History {
    columns: BTreeMap<String, Vec<f64>>,
    pub steps: Vec<String>,
}

impl Bench {
    /// A folder with `scene.toml` in it.
    pub fn new(scene: &str) -> Self {
        let bench = Self { folder: Rc::new(tempfile::tempdir().unwrap()), runs: Cell::new(0) };
        bench.write("scene.toml", scene);
        bench
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    /// Runs `nagata run scene.toml` on so many ranks, with further arguments.
    pub fn run(&self, ranks: usize, arguments: &[&str]) -> Run {
        self.runs.set(self.runs.get() + 1);
        let out = self.path(&format!("out-{}", self.runs.get()));
        let scene = self.path("scene.toml");
        let mut all = vec!["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap()];
        all.extend(arguments);
        Run { folder: Some(self.folder.clone()), ..nagata(self.folder.path(), ranks, &all, out.clone()) }
    }

    /// Runs, and fails the test when that fails.
    pub fn solve(&self, ranks: usize, arguments: &[&str]) -> Run {
        let run = self.run(ranks, arguments);
        assert_eq!(run.code, 0, "{}\n{}", run.stdout, run.stderr);
        run
    }
}

/// 30 degrees of a ring of the material `m` in plane strain, with so many elements across and around.
pub fn sector(name: &str, [inner, outer]: [f64; 2], [across, around]: [usize; 2]) -> String {
    format!(
        "body.{name}.material = \"m\"\nbody.{name}.symmetry = [\"amin\", \"amax\", \"zmin\", \"zmax\"]\n\
         body.{name}.block = {{ sector = {{ radii = [{inner:?}, {outer:?}], angles = [0.0, 30.0], length = 0.5 }}, \
         elements = [{across}, {around}, 1] }}\n"
    )
}

/// Runs the program with any arguments in a folder.
pub fn nagata(folder: &Path, ranks: usize, arguments: &[&str], out: PathBuf) -> Run {
    let done = mpirun(ranks).args(arguments).current_dir(folder).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let Output { status, stdout, stderr } = &done;
    // Under load mpirun's own libevent at times says that a pipe of a rank that has ended is closed.
    let stderr = text(stderr).split_inclusive('\n').filter(|line| !line.starts_with("[warn] Epoll ")).collect();
    Run { code: status.code().unwrap_or(-1), stdout: text(stdout), stderr, out, folder: None }
}

/// `mpirun -n ranks nagata`, to which arguments are added. Ends by itself if it hangs.
pub fn mpirun(ranks: usize) -> Command {
    mpirun_of(ranks, Path::new(env!("CARGO_BIN_EXE_nagata")))
}

/// The same for any program.
pub fn mpirun_of(ranks: usize, program: &Path) -> Command {
    mpirun_within(900, ranks, program)
}

/// The same with another time limit, in seconds.
pub fn mpirun_within(limit: u64, ranks: usize, program: &Path) -> Command {
    let mut command = Command::new("mpirun");
    command
        .args(["--quiet", "--bind-to", "none", "--oversubscribe", "--timeout", &limit.to_string()])
        .args(["-n", &ranks.to_string()])
        .arg(program)
        .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
        .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
        .env("OMPI_MCA_pml", "ob1")
        .env("OMPI_MCA_btl", "self,vader")
        .env("OMPI_MCA_mpi_yield_when_idle", "1")
        .env("OMPI_MCA_orte_tmpdir_base", SESSIONS.with(|folder| folder.path().to_owned()))
        .env("OPENBLAS_NUM_THREADS", "1")
        .env("SCOTCH_PTHREAD_NUMBER", "1");
    command
}

thread_local! {
    /// Where the runs of a test keep their sessions: those that end at one place take it from those that start.
    static SESSIONS: tempfile::TempDir = tempfile::tempdir().unwrap();
}

/// Runs `body` on each of these numbers of ranks, by starting the test that calls it, alone, in this program again under
/// `mpirun`. A rank that fails ends all.
pub fn on_ranks(test: &str, ranks: &[usize], body: impl FnOnce(&SimpleCommunicator)) {
    if is_worker() {
        let universe = mpi::initialize().unwrap();
        let report = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            report(info);
            // The others would wait.
            SimpleCommunicator::world().abort(101);
        }));
        return body(&universe.world());
    }
    for &count in ranks {
        let mut command = mpirun_of(count, &std::env::current_exe().unwrap());
        let done =
            command.args(["--exact", test, "--test-threads", "1", "--nocapture"]).env(WORKER, "1").output().unwrap();
        let [said, failed] = [&done.stdout, &done.stderr].map(|bytes| String::from_utf8_lossy(bytes));
        assert!(done.status.success() && said.contains("1 passed"), "`{test}` on {count} ranks\n{said}\n{failed}");
    }
}

const WORKER: &str = "NAGATA_TEST_WORKER";

/// Whether this process was started by [`on_ranks`].
pub fn is_worker() -> bool {
    std::env::var_os(WORKER).is_some()
}

impl Run {
    /// The results in a folder, of a run that was started otherwise.
    pub fn of(out: PathBuf) -> Self {
        Self { code: -1, stdout: String::new(), stderr: String::new(), out, folder: None }
    }

    pub fn history(&self) -> History {
        History::read(&self.out.join("history.csv"))
    }

    pub fn summary(&self) -> serde_json::Value {
        serde_json::from_str(&fs::read_to_string(self.out.join("summary.json")).unwrap()).unwrap()
    }

    pub fn log(&self) -> String {
        fs::read_to_string(self.out.join("log.txt")).unwrap()
    }

    /// A dataset of `fields.h5`, flat. See the XDMF file for the names.
    pub fn field(&self, name: &str) -> Vec<f64> {
        let file = hdf5::File::open(self.out.join("fields.h5")).unwrap();
        file.dataset(name).unwrap_or_else(|e| panic!("{name}: {e}")).read_raw::<f64>().unwrap()
    }

    /// Increments in `fields.h5`; they count from 1, after the state at time 0.
    pub fn written(&self) -> usize {
        let file = hdf5::File::open(self.out.join("fields.h5")).unwrap();
        let names = file.group("increments").unwrap().member_names().unwrap();
        names.iter().filter(|name| *name != "000000").count()
    }

    /// Reference positions of the points of a grid, as in `body.slab` or `contact.top`.
    pub fn points(&self, grid: &str) -> Vec<[f64; 3]> {
        vectors(&self.field(&format!("grids/{}/points", grid.replace('.', "_"))))
    }

    /// A scalar at the points of a grid in an increment of `fields.h5`.
    pub fn scalars(&self, increment: usize, grid: &str, name: &str) -> Vec<f64> {
        self.field(&format!("increments/{increment:06}/{}/node/{name}", grid.replace('.', "_")))
    }

    /// A vector at the points of a grid in an increment of `fields.h5`.
    pub fn vectors(&self, increment: usize, grid: &str, name: &str) -> Vec<[f64; 3]> {
        vectors(&self.scalars(increment, grid, name))
    }
}

fn vectors(flat: &[f64]) -> Vec<[f64; 3]> {
    flat.as_chunks::<3>().0.to_vec()
}

/// Fails unless `found` is `expected` within a relative error, and says so with the name of the quantity.
#[track_caller]
pub fn assert_close(what: &str, found: f64, expected: f64, tolerance: f64) {
    let error = (found / expected - 1.0).abs();
    println!("{what}: {found:.12e}, expected {expected:.12e}, error {error:.1e}, tolerance {tolerance:.0e}");
    assert!(error < tolerance, "{what}: {found} is not {expected}: {error:e}");
}

/// Fails unless `error` is below a tolerance, and says so with the name of the quantity.
#[track_caller]
pub fn assert_small(what: &str, error: f64, tolerance: f64) {
    println!("{what}: error {error:.1e}, tolerance {tolerance:.0e}");
    assert!(error.abs() < tolerance, "{what}: {error:e}");
}

/// Root of an increasing or decreasing function between two points.
pub fn root(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let rising = f(high) > f(low);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if (f(middle) > 0.0) == rising { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

impl History {
    pub fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).unwrap();
        let mut lines = text.lines();
        let names: Vec<&str> = lines.next().unwrap().split(',').collect();
        let mut columns: BTreeMap<String, Vec<f64>> = names[1..].iter().map(|n| (n.to_string(), Vec::new())).collect();
        let mut steps = Vec::new();
        for line in lines {
            let mut fields = line.split(',');
            steps.push(fields.next().unwrap().to_string());
            for (name, field) in names[1..].iter().zip(fields) {
                columns.get_mut(*name).unwrap().push(field.parse().unwrap());
            }
        }
        Self { columns, steps }
    }

    pub fn column(&self, name: &str) -> &[f64] {
        self.columns.get(name).unwrap_or_else(|| panic!("no column {name} in {:?}", self.columns.keys()))
    }

    /// Names of the columns.
    pub fn names(&self) -> Vec<String> {
        self.columns.keys().cloned().collect()
    }

    /// Whether it has a tool or set.
    pub fn has(&self, name: &str) -> bool {
        self.columns.contains_key(&format!("{name}.fx"))
    }

    pub fn last(&self, name: &str) -> f64 {
        *self.column(name).last().unwrap()
    }

    pub fn len(&self) -> usize {
        self.steps.len()
    }

    /// Largest component of the force of a tool or set.
    pub fn largest_force(&self, name: &str) -> f64 {
        let of = |c: &str| self.column(&format!("{name}.{c}")).iter().fold(0.0f64, |m, f| m.max(f.abs()));
        of("fx").max(of("fy")).max(of("fz"))
    }

    /// Largest difference between row `i` and row `j` of another history, over the tools and sets named: of displacements,
    /// and of forces over the other's largest force of the first named.
    pub fn row_difference(&self, i: usize, other: &History, j: usize, names: &[&str]) -> f64 {
        let force = other.largest_force(names[0]);
        let mut worst = 0.0f64;
        for name in names {
            for (component, scale) in
                [("fx", force), ("fy", force), ("fz", force), ("ux", 1.0), ("uy", 1.0), ("uz", 1.0)]
            {
                let column = format!("{name}.{component}");
                worst = worst.max((self.column(&column)[i] - other.column(&column)[j]).abs() / scale);
            }
        }
        worst
    }

    /// All columns but one.
    pub fn without(mut self, column: &str) -> Self {
        assert!(self.columns.remove(column).is_some(), "no column `{column}`");
        self
    }

    /// Largest difference to another history over the largest value of the quantity (force, displacement, count) of a
    /// column: columns of one quantity share a scale, so that a zero component is compared with its neighbours.
    pub fn difference(&self, other: &History) -> f64 {
        assert_eq!(self.len(), other.len(), "different increments");
        let kind = |name: &str| {
            let last = name.rsplit('.').next().unwrap().to_string();
            if ["ux", "uy", "uz", "max_penetration"].contains(&last.as_str()) {
                "length".to_string()
            } else if ["fx", "fy", "fz"].contains(&last.as_str()) {
                "force".to_string()
            } else {
                last
            }
        };
        let mut scale: BTreeMap<String, f64> = BTreeMap::new();
        for (name, values) in &self.columns {
            let largest = scale.entry(kind(name)).or_default();
            *largest = values.iter().fold(*largest, |m, v| m.max(v.abs()));
        }
        let mut worst = 0.0f64;
        // What is left of a residual is rounding.
        let counts = |name: &str| !matches!(name, "residual" | "limit");
        for (name, values) in self.columns.iter().filter(|(name, _)| counts(name)) {
            for (a, b) in values.iter().zip(other.column(name)) {
                let error = if a == b { 0.0 } else { (a - b).abs() / scale[&kind(name)] };
                if error > 1e-8 {
                    println!("{name}: {a} and {b}");
                }
                worst = worst.max(error);
            }
        }
        worst
    }
}

/// An Abaqus deck of unit cubes, so many along x, y and z: elements from 101, the node set `edge` along x, the surfaces
/// `bottom` and `top`.
pub fn deck(cubes: [usize; 3]) -> String {
    let node = |i: usize, j: usize, k: usize| 1 + i + (cubes[0] + 1) * (j + (cubes[1] + 1) * k);
    let element = |i: usize, j: usize, k: usize| 101 + i + cubes[0] * (j + cubes[1] * k);
    let all =
        |n: [usize; 3]| (0..n[2]).flat_map(move |k| (0..n[1]).flat_map(move |j| (0..n[0]).map(move |i| (i, j, k))));
    let lines = |name: &str, lines: Vec<String>| format!("*{name}\n{}\n", lines.join("\n"));
    let layer = |k: usize, face: &str| {
        all([cubes[0], cubes[1], 1]).map(|(i, j, _)| format!("{}, {face}", element(i, j, k))).collect::<Vec<_>>()
    };
    let corners = |(i, j, k): (usize, usize, usize)| {
        let around = [(0, 0), (1, 0), (1, 1), (0, 1)];
        let ids = [0, 1].iter().flat_map(|&up| around.map(|(a, b)| node(i + a, j + b, k + up).to_string()));
        format!("{}, {}", element(i, j, k), ids.collect::<Vec<_>>().join(", "))
    };
    let points = all(cubes.map(|n| n + 1)).map(|(i, j, k)| format!("{}, {i}.0, {j}.0, {k}.0", node(i, j, k)));
    lines("NODE", points.collect())
        + &lines("ELEMENT, TYPE=C3D8", all(cubes).map(corners).collect())
        + &lines("NSET, NSET=edge", (0..=cubes[0]).map(|i| node(i, 0, 0).to_string()).collect())
        + &lines("SURFACE, NAME=bottom", layer(0, "S1"))
        + &lines("SURFACE, NAME=top", layer(cubes[2] - 1, "S2"))
}
