//! Mutants of scenes, meshes, decks and CAD files: each is read or refused, without a panic, a hang, or more than 1 GB.
//!
//! Some dozens of each kind run by default; `NAGATA_FUZZ=10000` asks for so many in all. `NAGATA_FUZZ_SEED` begins
//! elsewhere. What readers have stumbled over, or are likely to, is kept in `tests/corpus/` and is read by each run.

mod common;

use common::keys::{Row, described};
use nagata::controls::{Control, Controls};
use nagata::mesh::Purpose;
use nagata::scene::{Located, MeshSource};
use nagata::{error::Location, mesh, scene, tool};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use toml::Value;

/// Bytes that a process may have: libraries, stacks and heap.
const MEMORY: u64 = 1 << 30;
/// Seconds that one mutant may take: all of the seeds together take a fraction of one.
const TIME: Duration = Duration::from_secs(60);
/// One in so many mutants goes through the whole of `nagata check`, too, and is run for a while where that accepts it.
const END_TO_END: u64 = 40;
const RUN: Duration = Duration::from_secs(5);
/// Names the work of a process that [`batch`] starts: kind, first mutant, number, folder.
const WORKER: &str = "NAGATA_FUZZ_WORKER";

/// What is mutated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Scene,
    Gmsh,
    Deck,
    Stl,
    Iges,
    Bezier,
}

const KINDS: [Kind; 6] = [Kind::Scene, Kind::Gmsh, Kind::Deck, Kind::Stl, Kind::Iges, Kind::Bezier];

impl Kind {
    fn extension(self) -> &'static str {
        match self {
            Self::Scene => "toml",
            Self::Gmsh => "msh",
            Self::Deck => "inp",
            Self::Stl => "stl",
            Self::Iges => "igs",
            Self::Bezier => "bpt",
        }
    }

    /// Files that are in order.
    fn seeds(self) -> Vec<Vec<u8>> {
        let input = |name: &str| fs::read(inputs().join(name)).unwrap();
        match self {
            Self::Scene => vec![
                ALL_KEYS.into(),
                RINGS.into(),
                controls().into(),
                input("ironing-rigid.toml"),
                input("c-strip.toml"),
                input("square-cup-small.toml"),
                input("sphere-on-block.toml"),
            ],
            Self::Gmsh => {
                let tets = common::msh::block([1, 1, 1], true, |p| p);
                let hexes = common::msh::block([2, 1, 1], false, |p| p);
                let skin = common::msh::surface(3, |s, t| [s, t, 0.1 * s * t]);
                let binary = binary_2(&skin);
                let (new, new_binary) = version_4();
                vec![tets.into(), hexes.into(), skin.into(), input("ironing-indenter.msh"), binary, new, new_binary]
            }
            Self::Deck => {
                let decks = inputs().with_file_name("tests/decks");
                let whole = ["calculix-rubber.inp", "prepomax-pressure.inp", "freecad-gravity.inp"];
                let read = |name: &str| fs::read(decks.join(name)).unwrap();
                whole.map(read).into_iter().chain([common::deck([2, 1, 1]).into(), DECK.into()]).collect()
            }
            Self::Stl => {
                let ball = common::stl::sphere(2, 1.0);
                vec![common::stl::text("ball", &ball[..12]).into(), common::stl::binary(&ball)]
            }
            Self::Iges => vec![input("flanged-hole.igs"), input("ironing-indenter.igs")],
            Self::Bezier => vec![input("ironing-indenter.bpt"), input("square-cup-holder.bpt")],
        }
    }

    /// Reads a file as the program does. Whether it was in order does not matter.
    fn read(self, path: &Path) {
        let nowhere = Location { file: "scene.toml".into(), line: 1, column: 1, text: "".into() };
        let located = |value| Located { value, at: nowhere.clone() };
        match self {
            Self::Scene => {
                let text = fs::read(path).unwrap();
                let text = String::from_utf8_lossy(&text);
                if let Ok(scene) = scene::parse("scene.toml", &text, &inputs(), &[]) {
                    // A saved scene is a scene.
                    if let Err(error) = scene::parse("scene.toml", &scene.text, &inputs(), &[]) {
                        panic!("what is saved of it cannot be read: {error}");
                    }
                }
                let _ = scene::parse("scene.toml", ALL_KEYS, &inputs(), &[text.lines().next().unwrap_or("").into()]);
            }
            Self::Gmsh | Self::Deck => {
                for purpose in [Purpose::Body, Purpose::Tool] {
                    for group in [None, Some("surface"), Some("solid")] {
                        let group = group.map(|group| located(group.to_string()));
                        let path = Located { value: path.to_path_buf(), at: nowhere.clone() };
                        let _ = mesh::load(&MeshSource::File { path, group }, purpose);
                    }
                }
                if self == Self::Deck {
                    let folder = tempfile::tempdir().unwrap();
                    let _ = nagata::convert::convert(path, Some(&folder.path().join("scene.toml")));
                }
                for more in ["", "refine = 1"] {
                    describe(&format!("mesh = {:?}\n{more}", path.display()), path);
                }
            }
            Self::Stl => describe(&format!("mesh = {:?}", path.display()), path),
            Self::Iges => describe(&format!("nurbs = {:?}\nincomplete = true", path.display()), path),
            Self::Bezier => describe(&format!("bezier = {:?}", path.display()), path),
        }
    }

    /// A scene with such a file.
    fn scene(self, path: &Path) -> String {
        let file = path.display();
        let block = "block = { box = { size = [1.0, 1.0, 1.0] }, elements = [2, 2, 1] }";
        let (body, tool) = match self {
            Self::Scene => return String::from_utf8_lossy(&fs::read(path).unwrap()).into_owned(),
            Self::Gmsh | Self::Deck => (format!("mesh = {file:?}\nrefine = 1"), String::new()),
            Self::Stl => (block.into(), format!("mesh = {file:?}")),
            Self::Iges => (block.into(), format!("nurbs = {file:?}\nincomplete = true")),
            Self::Bezier => (block.into(), format!("bezier = {file:?}")),
        };
        let files = match self {
            Self::Gmsh | Self::Deck => format!(
                "[body.b]\n{body}\n[tool.t]\nplane = {{ point = [0.0, 0.0, 1.0], normal = [0.0, 0.0, -1.0] }}\n"
            ),
            _ => format!("[body.b]\n{body}\n[tool.t]\n{tool}\n"),
        };
        let files = files.replacen("\n[tool", "\nmaterial = \"m\"\n[tool", 1);
        format!(
            "{files}[material.m]\nmodel = \"hooke\"\nyoung = 1.0\npoisson = 0.3\n[contact.c]\nslave = \"b.zmax\"\nmaster = \"t\"\n[[step]]\nincrements = 1\nfix = [{{ set = \"b.zmin\" }}]\n"
        )
    }
}

fn inputs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs")
}

/// Reads a tool, smooths and sews its surface, and projects a point onto it.
fn describe(tool: &str, path: &Path) {
    let scene = path.with_extension("tool.toml");
    fs::write(&scene, format!("[tool.t]\n{tool}\n")).unwrap();
    for tool in scene::load_tools(&scene, &[]).unwrap() {
        if let Ok(described) = tool::describe(&tool, tool.smoothing.value, &Controls::default()) {
            let shape = described.geometry.whole();
            let _ = shape.closest(&nagata::Vec3::new(0.3, 0.4, 0.5), 1e3, None);
        }
    }
}

/// A generator of numbers that goes on from any seed (Steele, Lea and Flood, OOPSLA 2014: SplitMix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }

    fn of<'a, T>(&mut self, choices: &'a [T]) -> &'a T {
        &choices[self.below(choices.len())]
    }
}

/// Numbers that readers may stumble over.
const NUMBERS: [&str; 34] = [
    "0",
    "-1",
    "1",
    "2",
    "3",
    "7",
    "-0.0",
    "0.5",
    "1e-300",
    "-1e-300",
    "5e-324",
    "1e300",
    "-1e300",
    "1e309",
    "nan",
    "inf",
    "-inf",
    "255",
    "65536",
    "2147483647",
    "2147483648",
    "-2147483648",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "9223372036854775808",
    "18446744073709551615",
    "18446744073709551616",
    "1e18",
    "0x10",
    "1_000",
    "1.0.0",
    "1d3",
    "",
];

/// Mutant number `seed` of a kind: one to four changes of one of its seeds.
fn mutant(kind: Kind, seed: u64) -> Vec<u8> {
    let mut random = Random(seed ^ (kind as u64) << 56);
    let seeds = kind.seeds();
    let mut data = random.of(&seeds).clone();
    for _ in 0..1 + random.below(4) {
        let other = random.of(&seeds).clone();
        change(&mut data, &other, &mut random);
    }
    data
}

/// One change. `other` is another seed, of which words are taken.
fn change(data: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    let word_byte = |c: &u8| c.is_ascii_alphanumeric() || b"._-+*\"$".contains(c);
    let words = |data: &[u8]| -> Vec<(usize, usize)> {
        let mut found = Vec::new();
        let mut at = 0;
        while at < data.len() {
            let length = data[at..].iter().take_while(|c| word_byte(c)).count();
            if length > 0 {
                found.push((at, at + length));
            }
            at += length.max(1);
        }
        found
    };
    let lines = |data: &[u8]| -> Vec<(usize, usize)> {
        let mut start = 0;
        data.split_inclusive(|&c| c == b'\n')
            .map(|line| {
                start += line.len();
                (start - line.len(), start)
            })
            .collect()
    };
    if data.is_empty() {
        return data.extend_from_slice(other);
    }
    let at = random.below(data.len());
    match random.below(14) {
        // Bytes.
        0 => data[at] ^= 1 << random.below(8),
        1 => data[at] = *random.of(b"\0\n\r\t ,;=\"'[]{}#$*/eE+-.0123456789\x7f\xff"),
        2 => drop(data.remove(at)),
        3 => data.truncate(at),
        4 => {
            let end = (at + 1 + random.below(64)).min(data.len());
            let piece = data[at..end].to_vec();
            let to = random.below(data.len());
            data.splice(to..to, piece);
        }
        // Eight bytes of a binary file.
        5 if at + 8 <= data.len() => {
            let new = match random.below(4) {
                0 => u64::MAX.to_le_bytes(),
                1 => f64::NAN.to_le_bytes(),
                2 => (random.next() % 300).to_le_bytes(),
                _ => 1e300f64.to_le_bytes(),
            };
            data[at..at + 8].copy_from_slice(&new);
        }
        // Words: another number, one of another seed, the same place in a card (IGES keeps to its columns), none, twice.
        6..=10 => {
            let all = words(data);
            if all.is_empty() {
                return;
            }
            let numbers: Vec<_> =
                all.iter().filter(|(from, _)| data[*from].is_ascii_digit() || b"-.".contains(&data[*from])).collect();
            let (from, to) =
                if random.below(2) == 0 || numbers.is_empty() { *random.of(&all) } else { **random.of(&numbers) };
            let pool = words(other);
            let new = match random.below(5) {
                0 | 1 => random.of(&NUMBERS).as_bytes().to_vec(),
                2 if !pool.is_empty() => {
                    let (a, b) = *random.of(&pool);
                    other[a..b].to_vec()
                }
                3 => {
                    let (a, b) = *random.of(&all);
                    data[a..b].to_vec()
                }
                _ => Vec::new(),
            };
            if random.below(2) == 0 {
                data.splice(from..to, new);
            } else {
                let mut same = new;
                same.resize(to - from, b' ');
                data.splice(from..to, same);
            }
        }
        // Lines: away, twice, exchanged, from elsewhere.
        _ => {
            let all = lines(data);
            let (from, to) = *random.of(&all);
            match random.below(4) {
                0 => drop(data.splice(from..to, [])),
                1 => {
                    let line = data[from..to].to_vec();
                    data.splice(from..from, line);
                }
                2 => {
                    let (a, b) = *random.of(&all);
                    let line = data[a..b].to_vec();
                    data.splice(from..to, line);
                }
                _ => {
                    let pool = lines(other);
                    let (a, b) = *random.of(&pool);
                    data.splice(from..from, other[a..b].iter().copied());
                }
            }
        }
    }
}

/// The work of a process: mutants one after the other, and a line with its number before each.
fn work(kind: Kind, first: u64, count: u64, folder: &Path) {
    let file = folder.join(format!("mutant.{}", kind.extension()));
    for seed in first..first + count {
        fs::write(folder.join("seed"), seed.to_string()).unwrap();
        fs::write(&file, mutant(kind, seed)).unwrap();
        kind.read(&file);
    }
    fs::write(folder.join("seed"), "done").unwrap();
}

/// How a child ended that may have no more than [`MEMORY`] and `limit`: its exit code, none at the limit; its complaint, if it
/// did not end in order.
fn limited(
    program: &Path,
    arguments: &[&str],
    variable: Option<(&str, String)>,
    limit: Duration,
) -> Result<Option<i32>, String> {
    let said = tempfile::tempfile().unwrap();
    let mut command = Command::new("prlimit");
    command.arg(format!("--data={MEMORY}")).arg("--core=0").arg(program).args(arguments).envs(variable);
    for (key, value) in common::mpirun_of(1, program).get_envs() {
        command.env(key, value.unwrap());
    }
    let mut child =
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(said.try_clone().unwrap()).spawn().unwrap();
    let started = Instant::now();
    let status = loop {
        match child.try_wait().unwrap() {
            Some(status) => break status,
            None if started.elapsed() > limit => {
                child.kill().unwrap();
                child.wait().unwrap();
                return Ok(None);
            }
            None => std::thread::sleep(Duration::from_millis(5)),
        }
    };
    let mut text = String::new();
    use std::io::{Read, Seek};
    let mut said = said;
    said.rewind().unwrap();
    let _ = said.read_to_string(&mut text);
    let text: String = text.chars().take(2000).collect();
    match status.code() {
        Some(code) if !text.contains("panicked") => Ok(Some(code)),
        Some(code) => Err(format!("exit code {code}: {text}")),
        None => Err(format!("signal {:?}: {text}", status.signal())),
    }
}

/// How a child ended, in words.
fn ended(code: Option<i32>, limit: Duration) -> String {
    code.map_or(format!("no end within {} s", limit.as_secs()), |code| format!("exit code {code}"))
}

/// Runs mutants in a process of their own; those that fail it, each with what it said.
fn batch(test: &str, kind: Kind, first: u64, count: u64, folder: &Path) -> Vec<(u64, String)> {
    let mut failures = Vec::new();
    let (mut from, end) = (first, first + count);
    while from < end {
        let job = format!("{kind:?} {from} {} {}", end - from, folder.display());
        let limit = TIME + Duration::from_millis(200) * (end - from) as u32;
        let program = std::env::current_exe().unwrap();
        let arguments = ["--exact", test, "--nocapture", "--test-threads", "1"];
        let outcome = limited(&program, &arguments, Some((WORKER, job)), limit);
        let seed = fs::read_to_string(folder.join("seed")).unwrap_or_default();
        match (outcome, seed.parse::<u64>()) {
            (Ok(Some(0)), Err(_)) => break,
            (outcome, Ok(seed)) => {
                failures.push((seed, outcome.map_or_else(|text| text, |code| ended(code, limit))));
                from = seed + 1;
            }
            (outcome, Err(_)) => panic!("{outcome:?}"),
        }
    }
    failures
}

/// Elements of a block above which its memory is what was asked for.
const LARGE: usize = 50_000;

/// Whether a scene has a block or a refined mesh that is large.
fn is_large(text: &str) -> bool {
    let scene = scene::parse("scene.toml", text, &inputs(), &[]);
    scene.is_ok_and(|scene| {
        let times = |refine: &Option<Located<u32>>| refine.as_ref().map_or(0, |times| times.value);
        scene.tools.iter().any(|tool| tool.mesh.as_ref().is_some_and(|mesh| times(&mesh.refine) > 3))
            || scene.bodies.iter().any(|body| match &body.mesh {
                MeshSource::Block(block) => {
                    block.value.elements.iter().product::<usize>() << (3 * times(&body.refine)) > LARGE
                }
                MeshSource::File { .. } => times(&body.refine) > 1,
            })
    })
}

/// Runs `nagata check` on a mutant, and `nagata run` on what that accepts; what is wrong with how they end.
fn check(kind: Kind, data: &[u8], folder: &Path) -> Option<String> {
    if kind == Kind::Scene && is_large(&String::from_utf8_lossy(data)) {
        return None;
    }
    let file = folder.join(format!("checked.{}", kind.extension()));
    fs::write(&file, data).unwrap();
    let scene = folder.join("scene.toml");
    fs::write(&scene, kind.scene(&file)).unwrap();
    for mesh in fs::read_dir(inputs()).unwrap().map(|entry| entry.unwrap().path()) {
        let _ = std::os::unix::fs::symlink(&mesh, folder.join(mesh.file_name().unwrap()));
    }
    let program = Path::new(env!("CARGO_BIN_EXE_nagata"));
    let scene = scene.to_str().unwrap();
    match limited(program, &["check", scene], None, TIME) {
        Ok(Some(0)) => {}
        Ok(Some(2)) => return None,
        Ok(code) => return Some(format!("`nagata check`: {}", ended(code, TIME))),
        Err(text) => return Some(format!("`nagata check`: {text}")),
    }
    let out = tempfile::tempdir_in(folder).unwrap();
    match limited(program, &["run", scene, "--quiet", "--out", out.path().to_str().unwrap()], None, RUN) {
        Ok(None | Some(0..=2)) => None,
        Ok(Some(code)) => Some(format!("`nagata run`: exit code {code}")),
        Err(text) => Some(format!("`nagata run`: {text}")),
    }
}

/// All mutants of a kind: a share of `NAGATA_FUZZ`.
fn fuzz(test: &str, kind: Kind) {
    if let Ok(job) = std::env::var(WORKER) {
        let words: Vec<&str> = job.splitn(4, ' ').collect();
        if words[0] == format!("{kind:?}") {
            work(kind, words[1].parse().unwrap(), words[2].parse().unwrap(), Path::new(words[3]));
        }
        return;
    }
    let number = |name: &str, default: u64| std::env::var(name).ok().map_or(default, |text| text.parse().unwrap());
    let count = number("NAGATA_FUZZ", 400) / KINDS.len() as u64;
    let first = number("NAGATA_FUZZ_SEED", 0);
    let folder = tempfile::tempdir().unwrap();
    let mut failures = batch(test, kind, first, count, folder.path());
    for seed in (first..first + count).step_by(END_TO_END as usize) {
        failures.extend(check(kind, &mutant(kind, seed), folder.path()).map(|text| (seed, text)));
    }
    let kept = std::env::temp_dir().join("nagata-fuzz");
    for (seed, text) in &failures {
        fs::create_dir_all(&kept).unwrap();
        let file = kept.join(format!("{seed}.{}", kind.extension()));
        fs::write(&file, mutant(kind, *seed)).unwrap();
        println!("{}: {text}", file.display());
    }
    println!("{count} mutants of {kind:?} files, {} failed", failures.len());
    assert!(failures.is_empty(), "the mutants that failed are in {}", kept.display());
}

#[test]
fn scenes() {
    fuzz("scenes", Kind::Scene);
}

#[test]
fn gmsh_files() {
    fuzz("gmsh_files", Kind::Gmsh);
}

#[test]
fn stl_files() {
    fuzz("stl_files", Kind::Stl);
}

#[test]
fn decks() {
    fuzz("decks", Kind::Deck);
}

#[test]
fn iges_files() {
    fuzz("iges_files", Kind::Iges);
}

#[test]
fn bezier_files() {
    fuzz("bezier_files", Kind::Bezier);
}

/// What is kept, with the time and memory of a mutant.
#[test]
fn the_corpus() {
    if let Ok(job) = std::env::var(WORKER) {
        let file = Path::new(job.strip_prefix("corpus ").unwrap());
        let kind = KINDS.into_iter().find(|kind| file.extension().is_some_and(|end| end == kind.extension()));
        return kind.unwrap().read(file);
    }
    let folder = tempfile::tempdir().unwrap();
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus");
    for entry in fs::read_dir(corpus).unwrap() {
        let path = entry.unwrap().path();
        let kind = KINDS.into_iter().find(|kind| path.extension().is_some_and(|end| end == kind.extension())).unwrap();
        let data = fs::read(&path).unwrap();
        let copy = folder.path().join(path.file_name().unwrap());
        fs::write(&copy, &data).unwrap();
        let job = format!("corpus {}", copy.display());
        let arguments = ["--exact", "the_corpus", "--nocapture"];
        let outcome = limited(&std::env::current_exe().unwrap(), &arguments, Some((WORKER, job)), TIME);
        assert_eq!(outcome, Ok(Some(0)), "{}", path.display());
        assert_eq!(check(kind, &data, folder.path()), None, "{}", path.display());
    }
}

/// A panic, too much memory and a hang of a worker are seen.
#[test]
fn failures_are_seen() {
    match std::env::var(WORKER).as_deref() {
        Ok("panic") => panic!("on purpose"),
        Ok("memory") => drop(std::hint::black_box(vec![1u8; 2 * MEMORY as usize])),
        Ok("hang") => std::thread::sleep(TIME),
        _ => {
            let run = |job: &str| {
                let arguments = ["--exact", "failures_are_seen", "--nocapture"];
                let limit = Duration::from_secs(if job == "hang" { 2 } else { 60 });
                limited(&std::env::current_exe().unwrap(), &arguments, Some((WORKER, job.into())), limit)
            };
            assert!(run("panic").unwrap_err().contains("on purpose"));
            assert!(run("memory").unwrap_err().contains("memory allocation"));
            assert_eq!(run("hang"), Ok(None));
        }
    }
}

/// A mesh file of Gmsh 2.2 in binary: that of a text with quadrilaterals in one group.
fn binary_2(text: &str) -> Vec<u8> {
    let section = |name: &str| text.split(&format!("${name}\n")).nth(1).unwrap().split("$End").next().unwrap();
    let rows = |name: &str| -> Vec<Vec<f64>> {
        section(name).lines().skip(1).map(|line| line.split(' ').map(|w| w.parse().unwrap()).collect()).collect()
    };
    let mut data = b"$MeshFormat\n2.2 1 8\n".to_vec();
    data.extend(1i32.to_le_bytes());
    data.extend(b"\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"surface\"\n$EndPhysicalNames\n$Nodes\n");
    let nodes = rows("Nodes");
    data.extend(format!("{}\n", nodes.len()).bytes());
    for node in &nodes {
        data.extend((node[0] as i32).to_le_bytes());
        node[1..].iter().for_each(|x| data.extend(x.to_le_bytes()));
    }
    let elements = rows("Elements");
    data.extend(format!("\n$EndNodes\n$Elements\n{}\n", elements.len()).bytes());
    [3, elements.len() as i32, 2].iter().for_each(|n| data.extend(n.to_le_bytes()));
    for element in &elements {
        let numbers = element[..1].iter().chain(&element[3..]);
        numbers.for_each(|n| data.extend((*n as i32).to_le_bytes()));
    }
    data.extend(b"\n$EndElements\n");
    data
}

/// Two quadrilaterals in a mesh file of Gmsh 4.1, as text and in binary.
fn version_4() -> (Vec<u8>, Vec<u8>) {
    let names = "$PhysicalNames\n1\n2 1 \"surface\"\n$EndPhysicalNames\n";
    let points = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 1.0], [1.0, 1.0], [2.0, 1.0]];
    let facets = [[1u64, 2, 5, 4], [2, 3, 6, 5]];
    let mut text = format!(
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n{names}$Entities\n0 0 1 0\n1 0 0 0 2 1 0 1 1 0\n$EndEntities\n$Nodes\n1 6 1 6\n2 1 0 6\n1\n2\n3\n4\n5\n6\n"
    );
    points.iter().for_each(|[x, y]| text += &format!("{x:?} {y:?} 0.0\n"));
    text += "$EndNodes\n$Elements\n1 2 1 2\n2 1 3 2\n";
    facets.iter().enumerate().for_each(|(k, [a, b, c, d])| text += &format!("{} {a} {b} {c} {d}\n", k + 1));
    text += "$EndElements\n";

    let mut data = b"$MeshFormat\n4.1 1 8\n".to_vec();
    let ints = |data: &mut Vec<u8>, numbers: &[i32]| numbers.iter().for_each(|n| data.extend(n.to_le_bytes()));
    let longs = |data: &mut Vec<u8>, numbers: &[u64]| numbers.iter().for_each(|n| data.extend(n.to_le_bytes()));
    let reals = |data: &mut Vec<u8>, numbers: &[f64]| numbers.iter().for_each(|n| data.extend(n.to_le_bytes()));
    ints(&mut data, &[1]);
    data.extend(format!("\n$EndMeshFormat\n{names}$Entities\n").bytes());
    longs(&mut data, &[0, 0, 1, 0]);
    ints(&mut data, &[1]);
    reals(&mut data, &[0.0, 0.0, 0.0, 2.0, 1.0, 0.0]);
    longs(&mut data, &[1]);
    ints(&mut data, &[1]);
    longs(&mut data, &[0]);
    data.extend(b"\n$EndEntities\n$Nodes\n");
    longs(&mut data, &[1, 6, 1, 6]);
    ints(&mut data, &[2, 1, 0]);
    longs(&mut data, &[6, 1, 2, 3, 4, 5, 6]);
    points.iter().for_each(|[x, y]| reals(&mut data, &[*x, *y, 0.0]));
    data.extend(b"\n$EndNodes\n$Elements\n");
    longs(&mut data, &[1, 2, 1, 2]);
    ints(&mut data, &[2, 1, 3]);
    longs(&mut data, &[2]);
    facets.iter().enumerate().for_each(|(k, nodes)| {
        longs(&mut data, &[k as u64 + 1]);
        longs(&mut data, nodes);
    });
    data.extend(b"\n$EndElements\n");
    (text.into(), data)
}

/// A table of tables or of keys of a scene under a heading of docs/scene.md, gone through: each key, and each word.
fn uses(used: &mut BTreeSet<String>, tables: &BTreeMap<String, BTreeMap<String, Row>>, heading: &str, value: &Value) {
    if let Some(list) = value.as_array() {
        return list.iter().for_each(|item| uses(used, tables, heading, item));
    }
    let Some(table) = value.as_table() else { return };
    for (key, value) in table {
        used.insert(format!("{heading}.{key}"));
        let inner = format!("{heading}.{key}");
        if tables.contains_key(&inner) {
            uses(used, tables, &inner, value);
        } else if let Some(word) = value.as_str() {
            used.insert(format!("{heading}.{key} = {word:?}"));
        }
    }
}

/// No key can come that no seed has: docs/scene.md lists those that the reader knows, which tests/documents.rs holds.
#[test]
fn the_seeds_have_all_keys() {
    let tables = described();
    let mut used = BTreeSet::new();
    for seed in Kind::Scene.seeds() {
        let scene: toml::Table = toml::from_str(&String::from_utf8(seed).unwrap()).unwrap();
        for (key, value) in &scene {
            used.insert(key.clone());
            let named = format!("{key}.NAME");
            match value.as_table().filter(|_| tables.contains_key(&named)) {
                Some(all) => all.values().for_each(|value| uses(&mut used, &tables, &named, value)),
                None => uses(&mut used, &tables, key, value),
            }
        }
    }
    let keys = tables.iter().flat_map(|(heading, rows)| rows.keys().map(move |key| format!("{heading}.{key}")));
    // Words that choose other ways through the reader.
    let words = ["material.NAME.model", "contact.NAME.discretization", "contact.NAME.method"];
    let of = |place: &&str| {
        let (heading, key) = place.rsplit_once('.').unwrap();
        let words = tables[heading][key].words.iter();
        words.map(|word| format!("{place} = {word:?}")).collect::<Vec<_>>()
    };
    let controls = Controls::TABLE.iter().map(|control| format!("controls.{}", control.name));
    let all = keys.chain(words.iter().flat_map(of)).chain(controls).chain(["title".into()]);
    let missing: Vec<String> = all.filter(|key| !used.contains(key)).collect();
    assert!(missing.is_empty(), "in no seed: {missing:#?}");
}

/// The seeds are in order, or their mutants would only be found to be broken in one place.
#[test]
fn seeds_are_in_order() {
    let folder = tempfile::tempdir().unwrap();
    for kind in KINDS {
        for (k, seed) in kind.seeds().iter().enumerate() {
            let path = folder.path().join(format!("{k}.{}", kind.extension()));
            fs::write(&path, seed).unwrap();
            match kind {
                Kind::Scene => {
                    let scene = scene::parse("scene.toml", &String::from_utf8_lossy(seed), &inputs(), &[]);
                    assert!(scene.is_ok(), "{k}: {}", scene.unwrap_err());
                }
                Kind::Gmsh | Kind::Deck | Kind::Stl => {
                    let at = Location { file: "scene.toml".into(), line: 1, column: 1, text: "".into() };
                    let source =
                        || MeshSource::File { path: Located { value: path.clone(), at: at.clone() }, group: None };
                    let [body, tool] = [Purpose::Body, Purpose::Tool].map(|purpose| mesh::load(&source(), purpose));
                    assert!(body.is_ok() || tool.is_ok(), "{k}: {}", tool.unwrap_err());
                }
                Kind::Iges | Kind::Bezier => {
                    let cad = nagata::cad::read(&path, false);
                    assert!(cad.is_ok(), "{k}: {}", cad.unwrap_err());
                }
            }
        }
    }
}

/// A deck of the keywords that are read.
const DECK: &str = "*HEADING
 two parts
*PART, NAME=block
*NODE, NSET=all
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
*ELEMENT, TYPE=C3D8R, ELSET=solid
1, 1, 2, 3, 4, 5, 6, 7,
 8
*NSET, NSET=low, GENERATE
1, 4, 1
*ELSET, ELSET=one
solid,
*SURFACE, NAME=zmax, TYPE=ELEMENT
solid, S2
*SURFACE, NAME=zmin
1, S1
*SOLID SECTION, ELSET=solid, MATERIAL=m
*END PART
*ASSEMBLY, NAME=a
*INSTANCE, NAME=first, PART=block
*END INSTANCE
*INSTANCE, NAME=second, PART=block
0., 0., 3.
0., 0., 3., 0., 1., 3., 30.
*END INSTANCE
*END ASSEMBLY
*STEP
*STATIC
*END STEP
";

/// A scene with every control.
fn controls() -> String {
    let line = |control: &Control| format!("{} = {:?}\n", control.name, control.default);
    format!("{SMALL}[controls]\n{}", Controls::TABLE.iter().map(line).collect::<String>())
}

/// A scene that says as little as it can.
const SMALL: &str = r#"[body.b]
block = { box = { size = [1.0, 1.0, 1.0] }, elements = [1, 1, 1] }
material = "m"
[material.m]
model = "hooke"
young = 1.0
poisson = 0.3
[[step]]
increments = 1
fix = [{ set = "b" }]
"#;

/// What axisymmetric bodies alone have, and wholes without a plane of strain.
const RINGS: &str = r#"[body.pad]
block = { box = { size = [4.0, 1.0, 0.1] }, elements = [4, 2, 1] }
material = "rubber"
axisymmetric = true
element = "hex8-fbar"
[body.disk]
block = { box = { origin = [0.0, 1.0, 0.0], size = [3.0, 1.0, 0.1] }, elements = [5, 2, 1] }
material = "wood"
axisymmetric = true
[material.rubber]
model = "ogden"
terms = [[1.0, 2.0], [-0.1, -2.0]]
d = 0.01
density = 1e-9
[material.wood]
model = "orthotropic"
density = 5e-10
orthotropic = { e1 = 10.0, e2 = 9.0, e3 = 10.0, nu12 = 0.3, nu13 = 0.2, nu23 = 0.3, g12 = 4.0, g13 = 4.0, g23 = 4.0, x = [1.0, 0.0, 0.0], y = [0.0, 1.0, 0.0] }
[tool.ball]
cylinder = { point = [0.0, 5.0, 0.0], axis = [0.0, 0.0, 1.0], radius = 3.0 }
[contact.c]
slave = "disk.ymax"
master = "ball"
discretization = "segment"
method = "lagrange"
[tie.t]
slave = "disk.ymin"
master = "pad.ymax"
tolerance = 0.01
[[step]]
name = "press"
increments = 4
duration = 2.0
fix = [{ set = "pad.ymin", directions = "y" }]
move = [{ target = "ball", by = [0.0, -0.1, 0.0], table = [[0.0, 0.0], [1.0, 0.5], [2.0, 1.0]] }]
gravity = { acceleration = [0.0, -9810.0, 0.0], table = [[0.0, 0.0], [2.0, 1.0]] }
spin = [{ body = "disk", point = [0.0, 0.0, 0.0], axis = [0.0, 1.0, 0.0], speed = 3.0, table = [[0.0, 0.0], [2.0, 1.0]] }]
spring = [{ set = "pad.ymin", stiffness = [0.0, 1.0, 0.0] }]
dashpot = [{ set = "disk", damping = [0.0, 0.1, 0.0] }]
[[step]]
increments = 2
duration = 1.0
keep = true
release = ["pad.ymin"]
[solver]
linear = "direct"
"#;

/// A scene with all keys but those of [`RINGS`] and [`controls`].
const ALL_KEYS: &str = r#"title = "all"
[body.b]
block = { box = { origin = [0.0, 0.0, 0.0], size = [4.0, 4.0, 2.0] }, elements = [2, 2, 2], grading = [1.0, 2.0, 1.0], faces = { top = "zmax", sides = ["xmax", "ymax"] } }
material = "m"
element = "hex8-fbar"
symmetry = ["xmin", "ymin"]
[body.sheet]
block = { box = { origin = [0.0, 0.0, 40.0], size = [4.0, 4.0, 0.2] }, elements = [4, 4, 1] }
material = "y"
element = "hex8-shell"
shell = { points = 5, face = "zmax" }
[body.ring]
block = { sector = { center = [20.0, 0.0, 0.0], radii = [1.0, 2.0], angles = [0.0, 90.0], length = 1.0 }, elements = [1, 8, 1] }
material = "h"
plane_strain = true
[body.indenter]
mesh = "ironing-indenter-elastic.msh"
material = "n"
materials = { solid = "r" }
group = "solid"
refine = 1
[material.m]
model = "j2"
young = 1e3
poisson = 0.3
hardening = { swift = { k = 5.0, n = 0.2, e0 = 0.01 } }
[material.h]
model = "hill"
young = 1000.0
poisson = 0.3
yield_stress = 1.0
hardening = { voce = { saturation = 2.0, rate = 3.0, linear = 0.1 } }
hill = { f = 0.5, g = 0.5, h = 0.5, l = 1.5, m = 1.5, n = 1.5, x = [1.0, 0.0, 0.0], y = [0.0, 1.0, 0.0] }
[material.n]
model = "neo-hookean"
young = 10.0
poisson = 0.49
[material.e]
model = "hooke"
young = 10.0
poisson = 0.3
density = 1e-9
[material.r]
model = "mooney-rivlin"
c10 = 1.0
c01 = 0.1
bulk = 50.0
[material.y]
model = "yeoh"
c10 = 1.0
c20 = 0.1
c30 = 0.01
poisson = 0.4
[material.l]
model = "j2"
young = 10.0
poisson = 0.4
yield_stress = 1.0
hardening = { linear = 0.1 }
[material.t]
model = "j2"
young = 10.0
poisson = 0.4
hardening = { table = [[0.0, 1.0], [0.1, 1.2], [1.0, 2.0]] }
[tool.mesh]
mesh = "ironing-indenter.msh"
nurbs = "ironing-indenter.igs"
bezier = "ironing-indenter.bpt"
smoothing = "nagata"
flip = false
feature_angle = 40.0
normals = "angle"
group = "surface"
sharp = ["surface"]
refine = 1
incomplete = true
tolerance = 1e-3
symmetry = [{ point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }]
[tool.plane]
plane = { point = [0.0, 0.0, 2.0], normal = [0.0, 0.0, -1.0] }
[tool.cylinder]
cylinder = { point = [0.0, 0.0, 9.0], axis = [0.0, 1.0, 0.0], radius = 1.0, hollow = false }
[tool.cone]
cone = { apex = [0.0, 0.0, 2.0], axis = [0.0, 0.0, 1.0], angle = 30.0, hollow = false }
[tool.sphere]
sphere = { center = [0.0, 0.0, 9.0], radius = 1.0, hollow = true }
[tool.torus]
torus = { center = [0.0, 0.0, 9.0], axis = [0.0, 0.0, 1.0], radius = 3.0, tube = 1.0, hollow = false }
[tool.profile]
profile = { points = [[5.0, 40.0], [5.0, 0.0], [45.0, 0.0], [45.0, 40.0]], fillets = [0.0, 1.0, 2.0, 0.0], closed = false, extrude = { origin = [0.0, 0.0, 0.0], x = [1.0, 0.0, 0.0], y = [0.0, 1.0, 0.0], length = 3.0 } }
[tool.turned]
profile = { points = [[0.0, 9.0], [1.0, 9.0], [1.0, 10.0]], revolve = { point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0] } }
flip = true
[contact.c]
slave = "b.top"
master = "plane"
friction = 0.3
discretization = "one-pass"
method = "augmented-lagrangian"
penalty = 10.0
reach = 2.0
interference = "ramped"
tangent = "fixed-frame"
[contact.f]
slave = "b.xmax"
master = "indenter.top"
discretization = "segment"
slave_curvature = "deformed"
[contact.s]
slave = "ring.rmax"
master = "ring.rmax"
method = "uzawa"
tolerance = 1e-6
thickness = 1.0
smoothing = "facet"
feature_angle = 30.0
transfer = "variational"
[contact.d]
slave = "b.zmin"
master = "indenter.top"
discretization = "two-pass"
penalty = "auto"
[contact.n]
slave = "b.sides"
master = "indenter.top"
discretization = "node-to-node"
method = "penalty"
penalty = 5.0
[[step]]
name = "press"
duration = 2.0
increment = { initial = 0.1, min = 1e-4, max = 0.2, strain = 0.1, contacts = 0.5 }
fix = [{ set = "b.zmin", directions = "xyz" }, { set = "ring" }, { set = "sheet.xmin", normal = [1.0, 0.0, 1.0] }, { set = "sheet.ymin", directions = "rz", around = { point = [9.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0] } }]
torque = [{ tool = "cone", total = 1.0, point = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0], table = [[0.0, 0.0], [2.0, 1.0]] }]
move = [{ target = "sheet.xmax", by = [0.1, 0.0, 0.1], normal = [1.0, 0.0, 1.0] }, { target = "sheet.ymax", by = [0.1, 0.0, 0.0], directions = "rt", around = { point = [9.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0] } }, { target = "plane", by = [0.0, 0.0, -0.1] }, { target = "cylinder", rotate = { point = [0.0, 0.0, 9.0], axis = [0.0, 1.0, 0.0], angle = 90.0 } }]
force = [{ target = "sphere", total = [0.0, 0.0, -1.0], directions = "z", table = [[0.0, 0.0], [2.0, 1.0]] }]
pressure = [{ set = "b.sides", value = 0.1, table = [[0.0, 0.0], [2.0, 1.0]] }]
body_force = [{ body = "b", per_volume = [0.0, 0.0, -1.0], table = [[0.0, 0.0], [2.0, 1.0]] }]
[[step]]
increments = 3
fix = [{ set = "b.zmin" }]
[output]
every = 5
checkpoint = { increments = 10, minutes = 5.0 }
history = ["b", "b.top"]
fields = ["displacement", "nodal_stress", "status", "gap"]
vtkhdf = true
probe = [{ name = "tip", point = [1.0, 1.0, 1.0], body = "b" }, { name = "side", set = "b.sides", fields = ["nodal_stress"] }, { name = "line", path = { from = [0.0, 0.0, 1.0], to = [4.0, 4.0, 1.0], points = 5 } }]
[solver]
accuracy = "draft"
pace = 2.0
tolerance = 1e-9
max_iterations = 20
force_floor = 1e-3
linear = "iterative"
[trade]
steps = 1
set = ["output.every=100"]
vary = [{ key = "solver.pace", values = [1.0, 2.0] }, { name = "coarse", set = ["contact.c.penalty=3.0"] }]
reference = ["solver.pace=0.5"]
next = ["solver.pace=1.0"]
exact = [{ of = "plane.fz", value = -1.0, step = "press" }, { of = "plane.fx", curve = [[0.0, 0.0], [2.0, 1.0]] }]
"#;
