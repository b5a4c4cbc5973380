//! Output files written by several ranks, read back by one.
//!
//! Each test starts `mpirun` on this same test binary; `rank_program` is then what every rank runs.

mod common;

use common::mpirun_of;
use mpi::traits::*;
use nagata::error::{Error, Location, Result};
use nagata::failure::Cause;
use nagata::mesh::MOST_NODES;
use nagata::output::fields::{Cell, CellShape, Field, Fields, Grid, GridData};
use nagata::output::history::HistoryFile;
use nagata::output::log::{Increment, Iteration, Log};
use nagata::output::phases::{Phase, Phases};
use nagata::output::summary::{Asked, Counts, Summary};
use nagata::output::{OutputFolder, RUN};
use nagata::parallel::{Sent, agree, number};
use std::path::Path;
use std::process::Output;

/// Elements of the slab, a row of cubes.
const ELEMENTS: u64 = 5;

fn mpirun(ranks: usize, program: &str, folder: &Path) -> Output {
    mpirun_of(ranks, &std::env::current_exe().unwrap())
        .args(["rank_program", "--exact", "--ignored", "--nocapture", "--test-threads=1"])
        .env("NAGATA_TEST_PROGRAM", program)
        .env("NAGATA_TEST_FOLDER", folder)
        .output()
        .unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

#[test]
#[ignore = "what the ranks of the other tests run"]
fn rank_program() {
    let (Ok(program), Some(folder)) = (std::env::var("NAGATA_TEST_PROGRAM"), std::env::var_os("NAGATA_TEST_FOLDER"))
    else {
        return;
    };
    let universe = mpi::initialize().unwrap();
    let (comm, folder) = (universe.world(), Path::new(&folder));
    match program.as_str() {
        "write" => write_all(&comm, folder).unwrap(),
        "abort" => abort_in_third_increment(&comm, folder).unwrap(),
        "agree" => agree_on_errors(&comm),
        "unwritable" => unwritable(&comm, folder),
        _ => panic!("no program {program}"),
    }
}

/// The rows `0 .. total` that this rank owns when rank 0 owns none, unless it is alone.
fn own_rows(comm: &impl Communicator, total: u64) -> std::ops::Range<u64> {
    let (rank, size) = (comm.rank() as u64, comm.size() as u64);
    if size == 1 {
        return 0..total;
    }
    (rank.saturating_sub(1) * total / (size - 1))..(rank * total / (size - 1))
}

fn slab_point(index: u64) -> [f64; 3] {
    let (x, corner) = (index / 4, index % 4);
    [x as f64, [0.0, 1.0, 1.0, 0.0][corner as usize], [0.0, 0.0, 1.0, 1.0][corner as usize]]
}

fn slab_cell(index: u64) -> [u64; 8] {
    std::array::from_fn(|node| 4 * index + node as u64)
}

fn values(rows: std::ops::Range<u64>, components: u64, time: f64) -> Vec<f64> {
    (rows.start * components..rows.end * components).map(|i| time + 0.001 * i as f64).collect()
}

struct Scene {
    fields: Fields,
    points: std::ops::Range<u64>,
    cells: std::ops::Range<u64>,
    grids: [nagata::output::fields::GridId; 4],
}

/// A slab of which rank 0 owns nothing, a tool of which only rank 0 owns anything, a mixed skin, and an empty grid.
fn add_grids(comm: &impl Communicator, folder: &OutputFolder) -> Result<Scene> {
    let mut fields = Fields::create(folder, "fields", comm)?;
    let (points, cells) = (own_rows(comm, 4 * (ELEMENTS + 1)), own_rows(comm, ELEMENTS));
    assert_eq!(number(comm, points.end - points.start), (points.start, 4 * (ELEMENTS + 1)));
    let slab_points: Vec<_> = points.clone().map(slab_point).collect();
    let cell = |shape: CellShape, of: &[u64]| {
        let mut nodes = [0; MOST_NODES];
        nodes[..of.len()].copy_from_slice(of);
        Cell { shape, nodes }
    };
    let hexahedron = |index| cell(CellShape::Hexahedron, &slab_cell(index));
    let slab_cells: Vec<_> = cells.clone().map(hexahedron).collect();
    let slab = fields.add_grid(comm, &Grid { name: "slab", points: &slab_points, cells: &slab_cells })?;

    let corners =
        [[0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [1.0, 1.0, 2.0], [0.0, 1.0, 2.0], [2.0, 0.0, 2.0], [2.0, 1.0, 2.0]];
    let quadrilateral = cell(CellShape::Quadrilateral, &[0, 1, 2, 3]);
    let triangles = [[1, 4, 2], [4, 5, 2]].map(|nodes| cell(CellShape::Triangle, &nodes));
    let (first, last) = (comm.rank() == 0, comm.rank() == comm.size() - 1);
    let tool_points = if first { &corners[..4] } else { &[] };
    let tool_cells = if first { &[quadrilateral][..] } else { &[] };
    let tool = fields.add_grid(comm, &Grid { name: "die <1>/a", points: tool_points, cells: tool_cells })?;

    let skin_points = if last { &corners[..] } else { &[] };
    let mut skin_cells = if first { vec![quadrilateral] } else { Vec::new() };
    skin_cells.extend(triangles.iter().filter(|_| last));
    let skin = fields.add_grid(comm, &Grid { name: "die__1__a", points: skin_points, cells: &skin_cells })?;

    let empty = fields.add_grid(comm, &Grid { name: "empty", points: &[], cells: &[] })?;
    Ok(Scene { fields, points, cells, grids: [slab, tool, skin, empty] })
}

fn write_increment(comm: &impl Communicator, scene: &mut Scene, time: f64) -> Result<()> {
    let last = comm.rank() == comm.size() - 1;
    let displacement = values(scene.points.clone(), 3, time);
    let stress = values(scene.cells.clone(), 6, time);
    let mises = values(scene.cells.clone(), 1, time);
    let gap = if last { values(0..6, 1, time) } else { vec![] };
    let [slab, tool, skin, empty] = scene.grids;
    let vector = |values| Field { name: "displacement", components: 3, values };
    let data = [
        GridData {
            grid: slab,
            node_fields: &[vector(&displacement)],
            cell_fields: &[
                Field { name: "stress", components: 6, values: &stress },
                Field { name: "von Mises", components: 1, values: &mises },
            ],
        },
        GridData { grid: tool, node_fields: &[], cell_fields: &[] },
        GridData { grid: skin, node_fields: &[Field { name: "gap", components: 1, values: &gap }], cell_fields: &[] },
        GridData { grid: empty, node_fields: &[vector(&[])], cell_fields: &[] },
    ];
    scene.fields.write(comm, time, &data)
}

fn write_all(comm: &impl Communicator, path: &Path) -> Result<()> {
    let folder = OutputFolder::create(path, &RUN, &[], comm)?;
    let mut log = Log::create(&folder, comm, false)?;
    let mut history = HistoryFile::create(&folder, comm, &["die.fx".to_string()])?;
    let phases = Phases::default();
    let mut scene = add_grids(comm, &folder)?;
    log.start(1.0);
    for (number, time) in [(1, 0.25), (2, 1.0)] {
        phases.time(Phase::Output, || write_increment(comm, &mut scene, time))?;
        history.row(comm, "press", number, time, 3, &[1.0 / 3.0])?;
        log.increment(&Increment { step: "press", number, time, size: 0.75, iterations: 3, note: "" });
    }
    let mut short = scene.fields;
    let field = Field { name: "gap", components: 1, values: &[1.0; 99] };
    let data = GridData { grid: scene.grids[2], node_fields: &[field], cell_fields: &[] };
    let error = short.write(comm, 2.0, &[data]).unwrap_err();
    assert!(error.to_string().contains("99 values"), "{error}");
    folder.write(comm, "scene.toml", "title = \"t\"\n")?;
    // Nobody else may have the folder meanwhile, and nothing in it is lost to who tries.
    let other = OutputFolder::create(path, &RUN, &[], comm).unwrap_err();
    assert!(other.exit_code() == 2 && other.to_string().contains("another run writes to"), "{other}");
    phases.add(Phase::Solve, std::time::Duration::from_secs(comm.rank() as u64 + 1));
    let sent = Sent { messages: 3 + comm.rank() as u64, bytes: 2_000_000 };
    Summary {
        converged: true,
        asked: Asked { scene: "s".into(), ..Asked::default() },
        counts: Counts { increments: 2, ..Counts::default() },
        ..Summary::default()
    }
    .write(&folder, comm, &phases, sent)
}

fn abort_in_third_increment(comm: &impl Communicator, path: &Path) -> Result<()> {
    let folder = OutputFolder::create(path, &RUN, &[], comm)?;
    let mut log = Log::create(&folder, comm, true)?;
    for (number, residual, changes) in [(0, 1.0, 3), (1, 2e-4, 0)] {
        log.iteration(&Iteration { step: "press", increment: 1, number, residual, changes, touching: 5 });
    }
    let mut scene = add_grids(comm, &folder)?;
    write_increment(comm, &mut scene, 0.25)?;
    write_increment(comm, &mut scene, 1.0)?;
    if comm.rank() == comm.size() - 1 {
        std::process::abort();
    }
    write_increment(comm, &mut scene, 2.0)
}

/// Two ranks fail, each in its way; all get the error of the lower one, and values pass when none fails.
fn agree_on_errors(comm: &impl Communicator) {
    let rank = comm.rank();
    assert_eq!(agree(comm, Ok(rank)).unwrap(), rank);
    let at = Location { file: "a.toml".into(), line: 2, column: 7, text: "x = 1".into() };
    let own = match rank {
        0 => Ok(()),
        1 => Err(Error::input(&at, "wrong on 1", "make it right")),
        _ => Err(Error::System("wrong on 2".into())),
    };
    let error = agree(comm, own).unwrap_err();
    assert_eq!(error.to_string(), "a.toml:2:7: wrong on 1\n  | x = 1\n  help: make it right");
    assert_eq!(error.exit_code(), 2);
    let last = comm.size() - 1;
    let error =
        agree(comm, if rank == last { Err(Error::diverged(Cause::Iteration, "")) } else { Ok(rank) }).unwrap_err();
    assert_eq!((error.exit_code(), error.to_string().as_str()), (1, ""));
    assert_eq!(agree(comm, Ok(rank)).unwrap(), rank);
}

fn unwritable(comm: &impl Communicator, path: &Path) {
    let error = OutputFolder::create(&path.join("file/below"), &RUN, &[], comm).unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().contains("cannot write to output folder"), "{error}");
    let folder = OutputFolder::create(&path.join("gone"), &RUN, &[], comm).unwrap();
    let mut scene = add_grids(comm, &folder).unwrap();
    write_increment(comm, &mut scene, 0.25).unwrap();
    comm.barrier();
    if comm.rank() == 0 {
        std::fs::remove_dir_all(folder.path()).unwrap();
    }
    let error = write_increment(comm, &mut scene, 0.5).unwrap_err();
    assert!(error.to_string().contains("cannot write") && error.to_string().contains("fields.h5"), "{error}");
    assert_eq!(error.exit_code(), 3);
}

#[test]
fn ranks_write_one_file() {
    for ranks in [1, 2, 3, 4] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out/case");
        let output = mpirun(ranks, "write", &path);
        assert!(output.status.success(), "{ranks} ranks: {}", said(&output));
        check_fields(&path, &[0.25, 1.0]);
        let history = std::fs::read_to_string(path.join("history.csv")).unwrap();
        let third = "0.3333333333333333";
        let rows = format!("press,1,0.25,3,{third}\npress,2,1,3,{third}\n");
        assert_eq!(history, format!("step,increment,time,iterations,die.fx\n{rows}"));
        let log = std::fs::read_to_string(path.join("log.txt")).unwrap();
        assert_eq!(log.lines().count(), 2);
        assert!(log.lines().all(|line| said(&output).matches(line).count() == 1), "{}", said(&output));
        assert_eq!(std::fs::read_to_string(path.join("scene.toml")).unwrap(), "title = \"t\"\n");
        let summary = std::fs::read_to_string(path.join("summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        assert_eq!(summary["ranks"], ranks);
        assert_eq!(summary["phases_s"]["solve"], ranks as f64);
        assert!(summary["peak_memory_mb"].as_f64().unwrap() > ranks as f64);
        let messages: Vec<usize> = (3..3 + ranks).collect();
        assert_eq!(summary["by_rank"]["messages"], serde_json::json!(messages));
        assert_eq!(summary["by_rank"]["sent_mb"], serde_json::json!(vec![2.0; ranks]));
        assert_eq!(std::fs::read_dir(&path).unwrap().count(), 6);
    }
}

#[test]
fn files_open_after_an_abort() {
    let folder = tempfile::tempdir().unwrap();
    let output = mpirun(2, "abort", folder.path());
    assert!(!output.status.success());
    check_fields(folder.path(), &[0.25, 1.0]);
    let log = std::fs::read_to_string(folder.path().join("log.txt")).unwrap();
    assert_eq!(log, "    residual/force (status changes): 1.0e0 (3) 2.0e-4");
}

#[test]
fn all_ranks_return_the_lowest_error() {
    let folder = tempfile::tempdir().unwrap();
    let output = mpirun(3, "agree", folder.path());
    assert!(output.status.success(), "{}", said(&output));
}

#[test]
fn a_lost_folder_is_an_error_on_all_ranks() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("file"), "").unwrap();
    let output = mpirun(2, "unwritable", folder.path());
    assert!(output.status.success(), "{}", said(&output));
}

/// Everything the XDMF file names is in the HDF5 file with the shape it says, and holds what the ranks wrote.
fn check_fields(folder: &Path, times: &[f64]) {
    let file = hdf5::File::open(folder.join("fields.h5")).unwrap();
    let text = std::fs::read_to_string(folder.join("fields.xdmf")).unwrap();
    check_tags(&text);
    let found: Vec<f64> = attributes(&text, "Time Value").map(|time| time.parse().unwrap()).collect();
    assert_eq!(found, times);
    let items: Vec<_> = text.split("Dimensions=\"").skip(1).map(|rest| rest.split_once('"').unwrap()).collect();
    assert_eq!(items.len(), times.len() * (6 + 4));
    for (dimensions, rest) in items {
        let path = rest.strip_prefix(">fields.h5:/").unwrap().split('<').next().unwrap();
        let shape: Vec<usize> = dimensions.split(' ').map(|n| n.parse().unwrap()).collect();
        assert_eq!(file.dataset(path).unwrap().shape(), shape, "{path}");
    }
    assert!(text.contains(r#"<Grid Name="die &lt;1&gt;/a""#) && !text.contains(r#"Name="empty""#));

    let points = file.dataset("grids/slab/points").unwrap().read_raw::<f64>().unwrap();
    assert_eq!(points, (0..4 * (ELEMENTS + 1)).flat_map(slab_point).collect::<Vec<_>>());
    let cells = file.dataset("grids/slab/cells").unwrap().read_raw::<u64>().unwrap();
    assert_eq!(cells, (0..ELEMENTS).flat_map(slab_cell).collect::<Vec<_>>());
    assert_eq!(file.dataset("grids/die__1__a/cells").unwrap().shape(), [1, 4]);
    let skin = file.dataset("grids/die__1__a_/cells").unwrap().read_raw::<i64>().unwrap();
    assert_eq!(skin, [5, 0, 1, 2, 3, 4, 1, 4, 2, 4, 4, 5, 2]);
    for (index, &time) in times.iter().enumerate() {
        let read = |name: &str| {
            let path = format!("increments/{:06}/{name}", index + 1);
            file.dataset(&path).unwrap_or_else(|error| panic!("{path}: {error}")).read_raw::<f64>().unwrap()
        };
        assert_eq!(read("time"), [time]);
        assert_eq!(read("slab/node/displacement"), values(0..4 * (ELEMENTS + 1), 3, time));
        assert_eq!(read("slab/cell/stress"), values(0..ELEMENTS, 6, time));
        assert_eq!(read("slab/cell/von_Mises"), values(0..ELEMENTS, 1, time));
        assert_eq!(read("die__1__a_/node/gap"), values(0..6, 1, time));
    }
}

fn attributes<'a>(text: &'a str, name: &str) -> impl Iterator<Item = &'a str> {
    let start = format!("{name}=\"");
    let found: Vec<_> = text.match_indices(&start).map(|(at, _)| &text[at + start.len()..]).collect();
    found.into_iter().map(|rest| rest.split('"').next().unwrap())
}

/// Every tag of an XML text is closed in order, by its own name.
fn check_tags(text: &str) {
    let body = text.strip_prefix("<?xml version=\"1.0\" encoding=\"utf-8\"?>\n").unwrap();
    let mut open = Vec::new();
    for tag in body.split('<').skip(1) {
        let (tag, _) = tag.split_once('>').unwrap();
        match tag.strip_prefix('/') {
            Some(name) => assert_eq!(open.pop(), Some(name)),
            None if tag.ends_with('/') => {}
            None => open.push(tag.split(' ').next().unwrap()),
        }
        assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
    }
    assert!(open.is_empty() && body.trim_end().ends_with("</Xdmf>"));
}
