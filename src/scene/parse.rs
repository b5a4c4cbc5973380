//! Reads a scene: the tree of the TOML text, the overrides, then the schema table by table.

use super::reader::{Item, Table};
use super::references::Names;
use super::tree::{self, Node};
use super::{
    Block, BlockShape, Body, Checkpoint, FaceGroup, Formulation, Located, MeshSource, Output, Quantity, Reduction,
    Scene, Shell, Tool, contacts, gravity, materials, overrides, probes, solver, steps, ties, tools, trade,
};
use crate::Vec3;
use crate::controls::Controls;
use crate::encoding;
use crate::error::{Error, Faults, Result};
use crate::mesh::SolidShape;
use std::io::ErrorKind;
use std::path::Path;

/// The tables and keys of a scene.
const KEYS: [&str; 11] =
    ["title", "body", "material", "tool", "contact", "tie", "step", "output", "solver", "controls", "trade"];

/// Elements a block may have: nodes are numbered in 32 bits on a rank.
const MOST_ELEMENTS: usize = 1 << 31;

/// Degrees by which the span of a full circle may be off.
const ROUND_OFF: f64 = 1e-9;

/// Reads and checks a scene file; `overrides` are `key=value`, applied in order.
///
/// # Errors
/// The file cannot be read, is not TOML, or is not a scene: [`Error::Input`] with the place of what is wrong.
pub fn load(path: &Path, overrides: &[String]) -> Result<Scene> {
    parse(&path.display().to_string(), &text_of(path)?, folder_of(path), overrides)
}

/// Reads the tools of a scene file, or of a file with nothing but tools, and leaves the rest of the scene unchecked.
///
/// # Errors
/// As [`load`]; a file without tools.
pub fn load_tools(path: &Path, overrides: &[String]) -> Result<Vec<Tool>> {
    let root = tree_of(&path.display().to_string(), &text_of(path)?, overrides)?;
    let root = Item::root(&root).table(&KEYS)?;
    let tools = root.named("tool")?;
    if tools.is_empty() {
        return Err(Error::input(root.at(), "the scene has no tool", "add a table `[tool.NAME]`"));
    }
    Faults::all(tools.into_iter().map(|(name, item)| tools::read(name, &item, folder_of(path))))
}

fn text_of(path: &Path) -> Result<String> {
    let name = path.display();
    let data = std::fs::read(path).map_err(|error| {
        let help = match error.kind() {
            ErrorKind::IsADirectory => "give the path of a TOML file; the folder of results goes with --out",
            _ => "give the path of a TOML file",
        };
        Error::input_anywhere(format!("cannot read the scene {name}: {error}"), help)
    })?;
    let data = encoding::unmarked(path, data)
        .map_err(|(what, help)| Error::input_anywhere(format!("the scene {name} {what}"), help))?;
    String::from_utf8(data).map_err(|error| {
        let line = 1 + error.as_bytes()[..error.utf8_error().valid_up_to()].iter().filter(|b| **b == b'\n').count();
        let what = format!("the scene {name} is not in UTF-8: line {line} has a byte of another encoding");
        Error::input_anywhere(what, "save it as UTF-8")
    })
}

fn folder_of(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// Reads and checks the text of a scene. `file_name` is for messages and [`Scene::name`]; other files are relative to
/// `directory`.
///
/// # Errors
/// As [`load`].
pub fn parse(file_name: &str, text: &str, directory: &Path, overrides: &[String]) -> Result<Scene> {
    let root = tree_of(file_name, text, overrides)?;
    let name = Path::new(file_name).file_stem().map_or("scene".into(), |stem| stem.to_string_lossy().into_owned());
    let mut scene = scene(&root, name, directory)?;
    let text = if overrides.is_empty() { text.to_string() } else { tree::to_toml(&root) };
    scene.text = tree::with_absolute_files(&text, directory);
    Ok(scene)
}

/// The tree of a text with the overrides applied.
fn tree_of(file_name: &str, text: &str, overrides: &[String]) -> Result<Node> {
    let mut root = tree::parse_document(file_name, text)?;
    for text in overrides {
        overrides::apply(&mut root, text)?;
    }
    Ok(root)
}

/// The schema; leaves [`Scene::text`] empty.
fn scene(root: &Node, name: String, directory: &Path) -> Result<Scene> {
    let root = Item::root(root).table(&KEYS)?;
    let (bodies, materials) = (root.named("body")?, root.named("material")?);
    let (tools, contacts) = (root.named("tool")?, root.named("contact")?);
    let names = Names::new(&bodies, &materials, &tools);
    if bodies.is_empty() {
        return Err(Error::input(
            root.at(),
            "the scene has no body",
            "add a table `[body.NAME]` with a mesh and a material",
        ));
    }
    // Tables refer to each other by names alone: what is wrong in one says nothing of the others.
    let mut faults = Faults::default();
    faults.note(&names.check(&tools));
    let bodies = Faults::all(bodies.into_iter().map(|(name, item)| body(name, &item, &names, directory)));
    let materials = Faults::all(materials.into_iter().map(|(name, item)| materials::read(name, &item)));
    let tools = Faults::all(tools.into_iter().map(|(name, item)| tools::read(name, &item, directory)));
    let (contacts, steps) = (contacts::read(contacts, &names), steps::read(&root, &names));
    let ties = ties::read(&root, &names);
    let (output, solver, controls) = (output(&root, &names), solver::read(&root), controls(&root));
    let (title, trade) = (root.optional("title", Item::string), trade::read(&root));
    faults.note(&bodies);
    faults.note(&materials);
    faults.note(&tools);
    faults.note(&contacts);
    faults.note(&ties);
    faults.note(&steps);
    faults.note(&output);
    faults.note(&solver);
    faults.note(&controls);
    faults.note(&title);
    faults.note(&trade);
    faults.finish()?;
    let (bodies, materials, mut steps, solver) = (bodies?, materials?, steps?, solver?);
    gravity::weigh(&mut steps, &bodies, &materials)?;
    let contacts = contacts?;
    Ok(Scene {
        title: title?.map_or_else(|| name.clone(), str::to_string),
        name,
        text: String::new(),
        materials,
        tools: tools?,
        bodies,
        contacts,
        ties: ties?,
        steps: steps.into_iter().map(|step| step.at_pace(solver.pace)).collect(),
        output: output?,
        solver,
        controls: controls?,
        trade: trade?,
    })
}

fn body(name: Located<String>, item: &Item, names: &Names, directory: &Path) -> Result<Body> {
    let table = item.table(&[
        "mesh",
        "group",
        "block",
        "material",
        "materials",
        "element",
        "shell",
        "plane_strain",
        "axisymmetric",
        "symmetry",
        "refine",
    ])?;
    let mesh = mesh_of(&table, directory);
    let material = table.get("material").ok_or_else(|| table.error("has no `material`", names.help_material()));
    let material = material.and_then(|item| names.material(&item));
    let materials = mesh.as_ref().map_or(Ok(Vec::new()), |mesh| materials(&table, mesh, names));
    let elements = Formulation::ALL.map(|e| (e.key(), e));
    let element = table.optional("element", |item| Ok(item.located(item.choice(&elements)?)));
    let shell = table.optional("shell", |item| shell(item, &element));
    let reduction = reduction(&table);
    let group = |item: &Item| Ok(item.located(format!("{}.{}", name.value, item.string()?)));
    let symmetry = table.each("symmetry", group);
    let refine = table.optional("refine", Item::splits);
    let mut faults = Faults::default();
    faults.note(&mesh);
    faults.note(&material);
    faults.note(&materials);
    faults.note(&element);
    faults.note(&shell);
    faults.note(&reduction);
    faults.note(&symmetry);
    faults.note(&refine);
    faults.finish()?;
    let (mesh, material, materials, element) = (mesh?, material?, materials?, element?);
    let (shell, reduction, symmetry, refine) = (shell?.unwrap_or_default(), reduction?, symmetry?, refine?.flatten());
    let body = Body { name, mesh, material, materials, element, shell, reduction, symmetry, refine };
    check_block_use(&body)?;
    if let (Some(asked), Some(reduction)) = (&body.element, &body.reduction)
        && let Some(kind) = match asked.value {
            Formulation::Hex8Shell => Some("solid-shell elements"),
            Formulation::Hex27 => Some("quadratic hexahedra"),
            Formulation::Wedge18 | Formulation::Wedge18Sri => Some("quadratic wedges"),
            _ => None,
        }
    {
        let is = reduction.value.words();
        let what = format!("body.{} is {is}, which {kind} are not for", body.name.value);
        return Err(Error::input(&asked.at, what, "leave `element` out, or mesh the body in space"));
    }
    Ok(body)
}

/// The table that says more of elements for sheets.
fn shell(item: &Item, element: &Result<Option<Located<Formulation>>>) -> Result<Shell> {
    let table = item.table(&["points", "face"])?;
    let [least, most] = [Formulation::LAYERS.start(), Formulation::LAYERS.end()];
    let points = table.optional("points", |item| match item.count()? {
        count if Formulation::LAYERS.contains(&count) => Ok(count),
        _ => Err(item.error(format!("must be from {least} to {most}"), "5 for a metal that flows")),
    });
    let face = table.optional("face", Item::located_string);
    let mut faults = Faults::default();
    faults.note(&points);
    faults.note(&face);
    if let Ok(asked) = element
        && asked.as_ref().is_none_or(|asked| asked.value != Formulation::Hex8Shell)
    {
        faults.note(&Err::<(), _>(item.error("is for solid-shell elements", "add element = \"hex8-shell\"")));
    }
    faults.finish()?;
    Ok(Shell { points: points?, face: face? })
}

fn mesh_of(table: &Table, directory: &Path) -> Result<MeshSource> {
    match (table.get("mesh"), table.get("block")) {
        (Some(_), Some(block)) => Err(block.error("stands beside a mesh", "keep one of `mesh` and `block`")),
        (Some(file), None) => mesh_file(table, &file, directory),
        (None, Some(item)) => match table.get("group") {
            Some(group) => Err(group.error("needs a mesh file", "the groups of a block are its `faces`")),
            None => Ok(MeshSource::Block(item.located(block(&item)?))),
        },
        (None, None) => Err(table.error("has no `mesh`", "add `mesh = \"FILE\"`, or `block = { ... }`")),
    }
}

/// What groups of elements of a mesh file are made of.
fn materials(table: &Table, mesh: &MeshSource, names: &Names) -> Result<Vec<(Located<String>, Located<String>)>> {
    let of_group = |(group, material): (Located<String>, Item)| Ok((group, names.material(&material)?));
    match (mesh, table.get("materials")) {
        (MeshSource::Block(_), Some(item)) => {
            Err(item.error("needs a mesh file", "the elements of a block have no groups; make two bodies"))
        }
        (_, item) => item.map_or(Ok(Vec::new()), |item| item.named()?.into_iter().map(of_group).collect()),
    }
}

fn reduction(table: &Table) -> Result<Option<Located<Reduction>>> {
    let asked = |key: &str, reduction: Reduction| -> Result<Option<Located<Reduction>>> {
        let is = table.optional(key, |item| Ok(item.located(item.boolean()?)))?;
        Ok(is.filter(|is| is.value).map(|is| Located { value: reduction, at: is.at }))
    };
    let plane_strain = asked("plane_strain", Reduction::PlaneStrain)?;
    let axisymmetric = asked("axisymmetric", Reduction::Axisymmetric)?;
    match table.get("axisymmetric").filter(|_| plane_strain.is_some() && axisymmetric.is_some()) {
        Some(item) => Err(item.error("stands beside `plane_strain`", "a body is one of the two: take one of them out")),
        None => Ok(plane_strain.or(axisymmetric)),
    }
}

/// A block is made of hexahedra, and of one layer of them where that stands for all of the body.
fn check_block_use(body: &Body) -> Result<()> {
    let MeshSource::Block(block) = &body.mesh else { return Ok(()) };
    let name = &body.name.value;
    let is_hexahedron = |element: &Formulation| matches!(element.shape(), SolidShape::Hex8 | SolidShape::Hex27);
    if let Some(element) = body.element.as_ref().filter(|element| !is_hexahedron(&element.value)) {
        let help = "use element = \"hex8\", \"hex8-fbar\", \"hex8-sri\", \"hex8-eas\", \"hex8-shell\" or \"hex27\"";
        return Err(Error::input(&element.at, format!("body.{name} is a block of hexahedra, of no others"), help));
    }
    if let Some(reduction) = body.reduction.as_ref().filter(|_| block.value.elements[2] != 1) {
        let layers = block.value.elements[2];
        let what = format!("body.{name} is {} but has {layers} layers of elements along z", reduction.value.words());
        return Err(Error::input(&reduction.at, what, "make the third of `elements` 1"));
    }
    Ok(())
}

/// A mesh file, and the `group` that stands beside it.
pub(super) fn mesh_file(table: &Table, file: &Item, directory: &Path) -> Result<MeshSource> {
    Ok(MeshSource::File { path: file.file(directory)?, group: table.optional("group", Item::located_string)? })
}

fn block(item: &Item) -> Result<Block> {
    let table = item.table(&["box", "sector", "elements", "grading", "faces"])?;
    let shape = match (table.get("box"), table.get("sector")) {
        (Some(cuboid), None) => box_shape(&cuboid)?,
        (None, Some(sector)) => sector_shape(&sector)?,
        _ => {
            return Err(
                table.error("must have one of `box` and `sector`", "for example `box = { size = [1.0, 1.0, 1.0] }`")
            );
        }
    };
    let elements = table.require("elements", "[10, 10, 1]")?;
    let counts = elements.array::<usize, 3>(Item::count, "[10, 10, 1]")?;
    let total = counts.iter().try_fold(1usize, |total, &count| total.checked_mul(count));
    if total.is_none_or(|total| total > MOST_ELEMENTS) {
        return Err(elements.error("are more than 2^31 elements", ""));
    }
    let mut face_names = ["xmin", "xmax", "ymin", "ymax", "zmin", "zmax"];
    let mut faces = face_names.as_slice();
    if let BlockShape::Sector { angles, .. } = shape {
        face_names[..4].copy_from_slice(&["rmin", "rmax", "amin", "amax"]);
        let closed = angles[1] - angles[0] >= 360.0 - ROUND_OFF;
        if closed && counts[1] < 3 {
            return Err(elements.error("must have 3 or more around a full circle", ""));
        }
        faces = if closed { &["rmin", "rmax", "zmin", "zmax"] } else { &face_names };
    }
    Ok(Block {
        shape,
        elements: counts,
        grading: table.optional("grading", |item| item.array(Item::positive, "[1.0, 1.0, 1.0]"))?.unwrap_or([1.0; 3]),
        faces: table.optional("faces", |item| face_groups(item, faces))?.unwrap_or_default(),
    })
}

fn box_shape(item: &Item) -> Result<BlockShape> {
    let table = item.table(&["origin", "size"])?;
    let size = table.require("size", "[1.0, 1.0, 1.0]")?.array::<f64, 3>(Item::positive, "[1.0, 1.0, 1.0]")?;
    let origin = table.optional("origin", Item::vector)?.unwrap_or_else(Vec3::zeros);
    Ok(BlockShape::Box { origin, size: Vec3::from(size) })
}

fn sector_shape(item: &Item) -> Result<BlockShape> {
    let table = item.table(&["center", "radii", "angles", "length"])?;
    let radii_item = table.require("radii", "[1.0, 2.0]")?;
    let radii = radii_item.array::<f64, 2>(Item::positive, "[1.0, 2.0]")?;
    let angles_item = table.require("angles", "[0.0, 90.0]")?;
    let angles = angles_item.array::<f64, 2>(Item::number, "[0.0, 90.0]")?;
    if radii[1] <= radii[0] {
        return Err(radii_item.error("must increase", "write the inner radius, then the outer"));
    }
    if !(angles[0] < angles[1] && angles[1] - angles[0] <= 360.0 + ROUND_OFF) {
        return Err(angles_item.error("must increase, by 360 at most", "angles are in degrees, from x towards y"));
    }
    let center = table.optional("center", Item::vector)?.unwrap_or_else(Vec3::zeros);
    Ok(BlockShape::Sector { center, radii, angles, length: table.require("length", "1.0")?.positive()? })
}

/// Groups of block faces: `{ top = "ymax", sides = ["xmin", "xmax"] }`.
fn face_groups(item: &Item, known: &[&str]) -> Result<Vec<FaceGroup>> {
    let face = |item: &Item| {
        item.choice(&known.iter().map(|&face| (face, ())).collect::<Vec<_>>())?;
        item.located_string()
    };
    let group = |(name, faces): (Located<String>, Item)| {
        if known.contains(&name.value.as_str()) {
            return Err(Error::input(
                &name.at,
                format!("`{}` already is the name of a face", name.value),
                "choose another",
            ));
        }
        let faces = match faces.is_string() {
            true => vec![face(&faces)?],
            false => faces.filled_list()?.iter().map(face).collect::<Result<_>>()?,
        };
        Ok((name, faces))
    };
    item.named()?.into_iter().map(group).collect()
}

fn output(root: &Table, names: &Names) -> Result<Output> {
    let fields = Quantity::USUAL.to_vec();
    let mut output =
        Output { every: 1, checkpoint: None, history: Vec::new(), fields, vtkhdf: false, probes: Vec::new() };
    let keys = ["every", "checkpoint", "history", "fields", "vtkhdf", "probe"];
    let Some(table) = root.optional("output", |item| item.table(&keys))? else { return Ok(output) };
    let (every, checkpoint) = (table.optional("every", Item::count), table.optional("checkpoint", checkpoint));
    let history = history(&table, names);
    let fields = table.optional("fields", |item| probes::fields(item, &Quantity::ALL));
    let (vtkhdf, probes) = (table.optional("vtkhdf", Item::boolean), probes::read(&table, names));
    let mut faults = Faults::default();
    faults.note(&every);
    faults.note(&checkpoint);
    faults.note(&history);
    faults.note(&fields);
    faults.note(&vtkhdf);
    faults.note(&probes);
    faults.finish()?;
    (output.every, output.checkpoint, output.history) = (every?.unwrap_or(1), checkpoint?, history?);
    if let Some(asked) = fields? {
        output.fields = asked;
        if !output.fields.contains(&Quantity::Displacement) {
            output.fields.insert(0, Quantity::Displacement);
        }
    }
    (output.vtkhdf, output.probes) = (vtkhdf?.unwrap_or(false), probes?);
    Ok(output)
}

/// The sets of the history, each once.
fn history(table: &Table, names: &Names) -> Result<Vec<Located<String>>> {
    let items = table.optional("history", Item::list)?.unwrap_or_default();
    let sets = Faults::all(items.iter().map(|item| names.set(item, "tools always are in the history")))?;
    Faults::all(items.iter().zip(&sets).enumerate().map(|(k, (item, set))| {
        let repeats = sets[..k].iter().any(|other| other.value == set.value);
        if repeats { Err(item.error(format!("repeats `{}`", set.value), "list it once")) } else { Ok(()) }
    }))?;
    Ok(sets)
}

fn checkpoint(item: &Item) -> Result<Checkpoint> {
    let table = item.table(&["increments", "minutes"])?;
    let (increments, minutes) =
        (table.optional("increments", Item::count)?, table.optional("minutes", Item::positive)?);
    if increments.is_none() && minutes.is_none() {
        return Err(table.error("does not say how often", "add `increments = 10`, or `minutes = 30.0`"));
    }
    Ok(Checkpoint { increments, minutes })
}

fn controls(root: &Table) -> Result<Controls> {
    let mut controls = Controls::default();
    let names: Vec<&str> = Controls::TABLE.iter().map(|control| control.name).collect();
    let Some(table) = root.optional("controls", |item| item.table(&names))? else { return Ok(controls) };
    Faults::all(Controls::TABLE.iter().map(|control| {
        let value = |item: &Item| {
            let help = format!("it is in: {}; by default {:?}", control.unit, control.default);
            item.number_that_is(&control.admitted(), |value| control.admits(value), &help)
        };
        if let Some(value) = table.optional(control.name, value)? {
            controls.set(control.name, value);
        }
        Ok(())
    }))?;
    Ok(controls)
}
