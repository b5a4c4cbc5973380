//! The command line: `new`, `schema`, `convert`, `run`, `report`, `check`, `calibrate`, `surface` and `trade`.

use crate::accuracy;
use crate::accuracy::errors::Sampling;
use crate::accuracy::sampling::Grid;
use crate::accuracy::subject::{Loaded, Names};
use crate::analysis::cost::calibrate::calibrate;
use crate::analysis::cost::machine;
use crate::analysis::{self, Options, describe};
use crate::convert;
use crate::error::{Error, Result};
use crate::interrupt;
use crate::model::Model;
use crate::output::FACTORS;
use crate::output::phases::Phases;
use crate::parallel::agree;
use crate::report;
use crate::scene::{self, Scene};
use crate::stdout::{print, print_from_root};
use crate::surface::EXTENSION;
use crate::trade;
use crate::trade::plan::Wishes;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Args, ColorChoice, Parser, Subcommand, value_parser};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use petsc::Petsc;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Implicit, parallel finite elements for frictional contact on Nagata-smoothed surfaces.
///
/// Start it on several ranks with `mpirun -n RANKS nagata ...`. Exit codes: 0 converged, 1 did not converge, 2 the input
/// is wrong, 3 a library or the system failed, 4 a signal ended the run.
#[derive(Debug, Parser)]
// No colours: Open MPI gives every rank a terminal, also when its output goes to a file.
#[command(name = "nagata", version = version(), color = ColorChoice::Never)]
#[command(after_help = examples(&[
    "nagata new first.toml",
    "nagata check first.toml",
    "mpirun -n 2 nagata run first.toml --report",
]))]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a scene and write its results into a folder.
    #[command(override_usage = "nagata run [OPTIONS] <SCENE> [-- PETSC OPTIONS]")]
    #[command(after_help = examples(&[
        "mpirun -n 2 nagata run first.toml --out out/slippery --set contact.tread.friction=0.2",
        "nagata run first.toml --steps 1 --report -- -snes_monitor",
        "nagata run out/first --restart",
    ]))]
    Run {
        #[command(flatten)]
        scene: SceneArguments,
        /// Folder for the results; those of an earlier run in it are replaced [default: out/<name of the scene file>]
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Run only the first N steps of the scene.
        #[arg(long, value_name = "N")]
        steps: Option<NonZeroUsize>,
        /// Go on from the checkpoint in the folder for the results, on any number of ranks; the scene must be the same, but for
        /// steps that are added and its `output`. The folder in place of the scene file stands for the scene that was run.
        #[arg(long, conflicts_with = "estimate")]
        restart: bool,
        /// Estimate the error of the increments, too, by a second run with increments twice as long: half the time more.
        #[arg(long)]
        estimate: bool,
        /// Print nothing but warnings and errors.
        #[arg(long)]
        quiet: bool,
        /// Write a page about the run at its end, report.html in the folder, also when it fails or is interrupted.
        #[arg(long)]
        report: bool,
        /// Options of PETSc, such as `-snes_monitor -mat_mumps_icntl_14 200`; one that nothing asks for is warned about.
        #[arg(last = true, value_name = "PETSC OPTIONS")]
        petsc: Vec<String>,
    },
    /// Write a page of HTML about one or several runs, ended or not: curves over each other, increments, convergence, costs.
    #[command(after_help = examples(&["nagata report out/first", "nagata report out/first out/slippery --out both.html"]))]
    Report {
        /// Folders that `nagata run` has written, or writes to.
        #[arg(required = true, value_name = "OUT")]
        folders: Vec<PathBuf>,
        /// The page [default: report.html in the folder; of several folders, where you are]
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
    /// Check a scene and print what would be modelled, and how large it is, without running it.
    #[command(after_help = examples(&[
        "nagata check first.toml",
        "mpirun -n 2 nagata check first.toml --set body.pad.refine=1",
    ]))]
    Check {
        #[command(flatten)]
        scene: SceneArguments,
    },
    /// Write a commented scene to start from, which runs as it is.
    #[command(after_help = examples(&["nagata new first.toml", "nagata new ../seal.toml"]))]
    New {
        /// The scene file to write; one that is there stays.
        scene: PathBuf,
    },
    /// Print the JSON schema of scene files, by which editors complete and check them: see docs/running.md.
    #[command(after_help = examples(&["nagata schema", "nagata schema > nagata.json"]))]
    Schema,
    /// Measure how fast this machine works, by which `check` and `run` predict time and memory, and keep it in the user's
    /// cache. Start it on as many ranks as runs will have, while nothing else computes.
    #[command(after_help = examples(&["nagata calibrate", "mpirun -n 2 nagata calibrate --repeats 3"]))]
    Calibrate {
        /// Repetitions of each kernel, of which the fastest counts.
        #[arg(long, value_name = "N", default_value = "7")]
        repeats: NonZeroUsize,
    },
    /// Turn a whole deck of Abaqus or CalculiX into a scene; what cannot be is refused, what is passed over is named.
    #[command(after_help = examples(&["nagata convert deck.inp", "nagata convert deck.inp --out lug.toml"]))]
    Convert {
        /// The deck (.inp), which stays the mesh of the scene.
        deck: PathBuf,
        /// The scene file; it may not exist yet [default: the deck with .toml in the place of its .inp]
        #[arg(long, value_name = "SCENE")]
        out: Option<PathBuf>,
    },
    /// Measure the surface of a tool: its size, its errors against another description, and its dead zones.
    #[command(after_help = examples(&[
        "nagata surface inputs/ironing-rigid.toml",
        "nagata surface inputs/ironing-rigid.toml --against profile --refine",
        "nagata surface inputs/ironing-rigid.toml --description nurbs --points points.csv",
    ]))]
    Surface(SurfaceArguments),
    /// Run a scene in many settings and show what speed costs in accuracy. Not under mpirun; see docs/trade.md.
    #[command(after_help = examples(&[
        "nagata trade first.toml --list",
        "nagata trade first.toml --ranks 2 --vary solver.pace=2,0.5",
        "nagata trade first.toml --reference body.pad.refine=1 --set step.drag.increments=5",
    ]))]
    Trade(TradeArguments),
}

#[derive(Args, Debug)]
struct TradeArguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// Vary an entry, as in `solver.pace=2,0.5`, in the place of what the scene says or suggests; may be repeated.
    #[arg(long, value_name = "KEY=VALUE,VALUE")]
    vary: Vec<String>,
    /// Override an entry of the reference, as in `solver.pace=0.25`, in the place of what the scene says or suggests; may
    /// be repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    reference: Vec<String>,
    /// Override an entry of the run that tells the error of the reference: all that it has, but a little less.
    #[arg(long, value_name = "KEY=VALUE", requires = "reference")]
    next: Vec<String>,
    /// Run only the first N steps of the scene.
    #[arg(long, value_name = "N")]
    steps: Option<NonZeroUsize>,
    /// Ranks of each run.
    #[arg(long, value_name = "N", default_value = "1")]
    ranks: NonZeroUsize,
    /// What all runs that the scene suggests may take, roughly, times the scene as it is.
    #[arg(long, value_name = "N", default_value_t = 20.0, allow_negative_numbers = true, value_parser = positive)]
    budget: f64,
    /// Stop a run after so many seconds [default: five times what it should take]
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = positive)]
    limit: Option<f64>,
    /// Make finished runs anew, too.
    #[arg(long)]
    fresh: bool,
    /// Leave out the runs that combine the best settings.
    #[arg(long)]
    no_combined: bool,
    /// Print what would be run.
    #[arg(long)]
    list: bool,
    /// Folder for the results, and for the runs, which are not made again [default: out/<name of the scene file>-trade]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

#[derive(Args, Debug)]
struct SurfaceArguments {
    /// A scene file (TOML), of which only the tools count.
    file: PathBuf,
    /// The tool [default: the only one]
    #[arg(long, value_name = "NAME")]
    tool: Option<String>,
    /// The description to measure, such as `nagata` or `nurbs` [default: the one that acts]
    #[arg(long, value_name = "NAME")]
    description: Option<String>,
    /// What to measure against: another description of the tool, or another tool.
    #[arg(long, value_name = "NAME")]
    against: Option<String>,
    /// Samples along each side of a piece.
    #[arg(long, value_name = "N", default_value_t = 13, value_parser = value_parser!(u16).range(2..=1000))]
    samples: u16,
    /// Follow the largest errors to where they are largest between the samples.
    #[arg(long, requires = "against")]
    refine: bool,
    /// Length that errors are compared with [default: radius of the reference, or diagonal of the surface]
    #[arg(long, value_name = "L", requires = "against", allow_negative_numbers = true, value_parser = positive)]
    length: Option<f64>,
    /// Find the points at this distance from the reference that have no normal projection.
    #[arg(long, value_name = "D", requires = "against", allow_negative_numbers = true, value_parser = positive)]
    distance: Option<f64>,
    /// Project the points of a CSV file (x, y, z) onto the surface.
    #[arg(long, value_name = "FILE")]
    points: Option<PathBuf>,
    /// How far pieces reach beyond their edges, of their parameters, for points without a normal projection.
    #[arg(long, value_name = "E", default_value_t = EXTENSION, value_parser = extension)]
    extension: f64,
    /// Override an entry of the scene by its dotted key, as in `tool.punch.smoothing=facet`; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Folder for the results; those of an earlier study in it are replaced [default: out/<name of the file>-surface]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

#[derive(Args, Debug)]
struct SceneArguments {
    /// The scene file (TOML).
    scene: PathBuf,
    /// Override an entry of the scene by its dotted key, as in `tool.indenter.smoothing=facet`; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
}

/// The end of a help: command lines about the scene that `nagata new first.toml` writes, and those of `inputs/`.
fn examples(lines: &[&str]) -> String {
    lines.iter().fold("Examples:".into(), |text: String, line| text + "\n  " + line)
}

/// The versions of nagata and of the libraries it runs on.
fn version() -> String {
    let (major, minor, patch) = hdf5::library_version();
    let mpi = mpi::environment::library_version().unwrap_or_default();
    let mpi = mpi.split(',').next().unwrap_or_default().trim().to_string();
    let loaded = std::fs::read_to_string("/proc/self/maps").unwrap_or_default();
    let (mumps, metis) = (series(&loaded, "/libdmumps"), series(&loaded, "/libmetis"));
    let petsc = Petsc::version();
    let nagata = env!("CARGO_PKG_VERSION");
    format!("{nagata} (PETSc {petsc}, MUMPS{mumps}, METIS{metis}, HDF5 {major}.{minor}.{patch}, {mpi})")
}

/// Major and minor version of a loaded library that has no call to tell it, by the name of its file, behind a blank.
fn series(loaded: &str, library: &str) -> String {
    let file = loaded.split(library).nth(1).and_then(|rest| rest.lines().next()).unwrap_or_default();
    let digits = file.trim_start_matches(|c: char| !c.is_ascii_digit()).split(|c: char| !c.is_ascii_digit());
    let series: Vec<&str> = digits.take(2).filter(|part| !part.is_empty()).collect();
    if series.is_empty() { String::new() } else { format!(" {}", series.join(".")) }
}

impl Cli {
    /// The options for PETSc.
    fn petsc_options(&self) -> &[String] {
        match &self.command {
            Command::Run { petsc, .. } => petsc,
            _ => &[],
        }
    }

    fn execute(&self, comm: &SimpleCommunicator) -> Result<()> {
        let petsc = Petsc::initialize(comm, self.petsc_options())
            .map_err(|e| Error::input_anywhere(e.to_string(), "options after `--` go to PETSc"))?;
        petsc.reserve_memory()?;
        match &self.command {
            Command::Run { scene, out, steps, restart, estimate, quiet, report, .. } => {
                // A run that goes on has left its scene in its folder.
                let left = (*restart && scene.scene.is_dir()).then_some(&scene.scene);
                let loaded = match left {
                    None => scene.load(comm)?,
                    Some(folder) => {
                        let loaded = agree(comm, scene::load(&folder.join("scene.toml"), &scene.overrides))?;
                        Scene { name: name_of(folder), ..loaded }
                    }
                };
                let default = left.map_or_else(|| Path::new("out").join(&loaded.name), Clone::clone);
                let steps = steps.map(NonZeroUsize::get);
                if let Some(asked) = steps.filter(|asked| *asked > loaded.steps.len() && comm.rank() == 0) {
                    eprintln!("warning: --steps {asked}, and the scene has {}", loaded.steps.len());
                }
                let out = out.as_deref().unwrap_or(&default);
                let source = &scene.scene;
                let (restart, report) = (*restart, *report);
                let options = Options { out, steps, estimate: *estimate, restart, report, quiet: *quiet, source };
                let outcome = analysis::run(comm, &petsc, &loaded, &options);
                if matches!(outcome, Ok(()) | Err(Error::Diverged(_) | Error::Interrupted(_))) && comm.rank() == 0 {
                    warn_of_unused(&petsc.unused_options()?);
                }
                outcome
            }
            Command::Report { folders, out } => {
                let default = if let [folder] = &folders[..] { folder.join(report::NAME) } else { report::NAME.into() };
                let out = out.as_ref().unwrap_or(&default);
                agree(comm, if comm.rank() == 0 { report::write(folders, out) } else { Ok(()) })?;
                let text = format!("report: {}\n", out.display());
                print_from_root(comm, &text)
            }
            Command::Check { scene } => {
                let loaded = scene.load(comm)?;
                let begun = Instant::now();
                let mut model = Model::new(comm, &loaded, &Phases::default())?;
                let text = analysis::check(comm, &petsc, &loaded, &mut model, begun)?;
                print_from_root(comm, &text)
            }
            Command::New { scene } => agree(comm, if comm.rank() == 0 { scene::begin(scene) } else { Ok(()) }),
            Command::Schema => print_from_root(comm, &scene::schema()),
            Command::Calibrate { repeats } => {
                let rates = calibrate(comm, &petsc, repeats.get())?;
                let kept = machine::keep(comm, &rates);
                let text = describe::rates(&rates, kept.as_deref().ok());
                print_from_root(comm, &text)?;
                agree(comm, kept.map(drop))
            }
            Command::Surface(arguments) => arguments.measure(comm),
            // In a process without MPI, see `run`.
            Command::Trade(_) | Command::Convert { .. } => {
                Err(Error::System("`trade` and `convert` must be the first argument".into()))
            }
        }
    }
}

impl TradeArguments {
    /// In a process in which MPI is not initialized.
    fn trade(&self) -> Result<()> {
        let stem = self.scene.scene.file_stem().unwrap_or_default().to_string_lossy();
        let default = Path::new("out").join(format!("{stem}-trade"));
        let wishes = Wishes {
            overrides: &self.scene.overrides,
            vary: &self.vary,
            reference: &self.reference,
            next: &self.next,
            steps: self.steps.map(NonZeroUsize::get),
            budget: self.budget,
        };
        trade::run(&trade::Options {
            scene: &self.scene.scene,
            wishes,
            out: self.out.as_deref().unwrap_or(&default),
            ranks: self.ranks.get(),
            limit: self.limit,
            fresh: self.fresh,
            combine: !self.no_combined,
            list: self.list,
        })
    }
}

impl SurfaceArguments {
    /// Collective.
    fn measure(&self, comm: &SimpleCommunicator) -> Result<()> {
        let loaded = agree(comm, Loaded::new(&self.names()))?;
        if comm.rank() == 0 {
            loaded.warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
        }
        let stem = self.file.file_stem().unwrap_or_default().to_string_lossy();
        let default = Path::new("out").join(format!("{stem}-surface"));
        let sampling = Sampling {
            grid: Grid::new(self.samples.into()),
            refine: self.refine,
            distance: self.distance,
            extension: self.extension,
        };
        let out = self.out.as_deref().unwrap_or(&default);
        accuracy::run(comm, &loaded.subject(), &accuracy::Options { out, sampling, points: self.points.as_deref() })
    }

    fn names(&self) -> Names<'_> {
        Names {
            file: &self.file,
            overrides: &self.overrides,
            tool: self.tool.as_deref(),
            description: self.description.as_deref(),
            against: self.against.as_deref(),
            length: self.length,
        }
    }
}

/// The command line; what new users get wrong is told with what would be right.
fn parse() -> std::result::Result<Cli, clap::Error> {
    Cli::try_parse().map_err(|mut error| {
        if let Some(tip) = tip(&error) {
            error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
        }
        error
    })
}

/// What was meant by a scene without a command, and by an override in two words.
fn tip(error: &clap::Error) -> Option<String> {
    let word = |kind| match error.get(kind) {
        Some(ContextValue::String(word)) => Some(word.clone()),
        _ => None,
    };
    match error.kind() {
        ErrorKind::InvalidSubcommand => {
            let scene = word(ContextKind::InvalidSubcommand).filter(|word| word.ends_with(".toml"))?;
            Some(format!("to run a scene: nagata run {scene}"))
        }
        ErrorKind::UnknownArgument => {
            let value = word(ContextKind::InvalidArg)?;
            let given: Vec<String> = std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect();
            let three = given.windows(3).find(|three| three[0] == "--set" && three[2] == value)?;
            let key = &three[1];
            (!key.contains('=')).then(|| format!("an override is one word: --set {key}={value}"))
        }
        _ => None,
    }
}

/// A number above 0.
fn positive(text: &str) -> std::result::Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "must be a number above 0".into())
}

/// Part of a piece by which it may be extended.
fn extension(text: &str) -> std::result::Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| (0.0..=0.5).contains(number));
    number.ok_or_else(|| "must be a number from 0 to 0.5".into())
}

impl SceneArguments {
    /// Collective.
    fn load(&self, comm: &SimpleCommunicator) -> Result<Scene> {
        agree(comm, scene::load(&self.scene, &self.overrides))
    }
}

/// The name that a run has in its folder.
fn name_of(folder: &Path) -> String {
    let folder = folder.canonicalize().unwrap_or_else(|_| folder.into());
    folder.file_name().unwrap_or_default().to_string_lossy().into()
}

/// Says what was converted, and what of it is not as in the deck.
fn tell_of(converted: &convert::Converted) -> Result<()> {
    converted.notes.iter().for_each(|note| eprintln!("warning: {note}"));
    let groups = converted.groups.as_ref().map_or(String::new(), |groups| format!(" and {}", groups.display()));
    print(&format!("{}{groups}\n", converted.scene.display()))
}

/// Names the options for PETSc that a run has not asked for: they are misspelt, or belong to what was not used. Some PETSc
/// asks for when it ends.
fn warn_of_unused(options: &[String]) {
    const LATE: [&str; 5] = ["log_", "malloc_", "memory_", "objects_", "options_"];
    for option in options.iter().filter(|option| !LATE.iter().any(|late| option.starts_with(late))) {
        eprintln!("warning: nothing asked for the PETSc option -{option}; is it misspelt?");
    }
}

/// Runs the program and returns its exit code. A command line that is wrong is reported by rank 0 alone; so is an error,
/// on which all ranks have agreed.
pub fn run() -> i32 {
    // Who looks at the results while the run goes on must not keep it from writing.
    petsc::environment::set_default("HDF5_USE_FILE_LOCKING", "FALSE");
    // A rank alone starts no others, and needs no daemon of Open MPI for it: when the two take leave of each other, Open MPI's
    // thread now and then calls what is unloaded already, and the process ends by a signal after all is done.
    petsc::environment::set_default("OMPI_MCA_ess_singleton_isolated", "1");
    petsc::environment::set_default("MUMPS_OOC_PREFIX", FACTORS);
    petsc::environment::leave_hdf5_at_exit();
    petsc::environment::return_freed_memory();
    if std::env::args_os().nth(1).is_some_and(|command| command == "trade" || command == "convert") {
        return run_alone();
    }
    let parsed = parse();
    // Help needs none of the memory that MPI takes to start. Of several ranks one that failed alone would have mpirun end the
    // others before they have said why: they fail together, below.
    if let Err(error) = &parsed
        && (launched_as().is_none() || error.exit_code() == 0)
    {
        if speaks() {
            let _ = error.print();
        }
        return error.exit_code();
    }
    if let Err(error) = petsc::enough_to_start() {
        if speaks() {
            eprintln!("error: {error}");
        }
        return 3;
    }
    let Some(universe) = mpi::initialize() else {
        eprintln!("error: MPI cannot be initialized");
        return 3;
    };
    let world = universe.world();
    abort_on_panic();
    interrupt::outlive_file_limit();
    let root = world.rank() == 0;
    let cli = match parsed {
        Ok(cli) => cli,
        Err(error) => {
            if root {
                let _ = error.print();
            }
            return error.exit_code();
        }
    };
    match cli.execute(&world) {
        Ok(()) => 0,
        Err(error) => {
            if root {
                eprintln!("error: {error}");
            }
            error.exit_code()
        }
    }
}

/// Under mpirun the number of this rank.
fn launched_as() -> Option<String> {
    ["OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"].iter().find_map(|name| std::env::var(name).ok())
}

/// Whether this process tells, before MPI runs, what all of them would.
fn speaks() -> bool {
    launched_as().is_none_or(|rank| rank == "0")
}

/// Runs a command that needs no MPI, or that starts others, to which MPI would hand its state down in the environment.
fn run_alone() -> i32 {
    let rank = launched_as();
    let outcome = match (&rank, parse()) {
        (_, Err(error)) => {
            if speaks() {
                let _ = error.print();
            }
            return error.exit_code();
        }
        (Some(_), Ok(Cli { command: Command::Convert { .. } })) => {
            Err(Error::input_anywhere("`convert` runs in one process, not under mpirun", "start it without"))
        }
        (Some(_), _) => {
            Err(Error::input_anywhere("`trade` starts its runs itself, not under mpirun", "give it --ranks N instead"))
        }
        (None, Ok(Cli { command: Command::Trade(arguments) })) => arguments.trade(),
        (None, Ok(Cli { command: Command::Convert { deck, out } })) => {
            convert::convert(&deck, out.as_deref()).and_then(|converted| tell_of(&converted))
        }
        (None, Ok(_)) => Err(Error::System("only `trade` and `convert` run alone".into())),
    };
    match outcome {
        Ok(()) => 0,
        Err(error) => {
            if speaks() {
                eprintln!("error: {error}");
            }
            error.exit_code()
        }
    }
}

/// A panic on one rank must not leave the others waiting.
fn abort_on_panic() {
    let report = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        report(info);
        SimpleCommunicator::world().abort(101);
    }));
}
