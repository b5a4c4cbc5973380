//! `nagata convert`: a whole deck of Abaqus or CalculiX becomes a scene, which refers to the deck for its mesh.
//!
//! The deck is read once, with all its cards. Each connected part of the mesh is a body, each
//! rigid body that something meets a tool; materials, contacts and steps follow. In a deck conditions act until they are
//! changed, in a scene a step has only what it lists: they are carried on, and each step is written out.
//! A deck can also name nodes, faces and elements one by one; groups for those are put into a file of their own, which
//! includes the deck.
//!
//! What a scene cannot say is refused, with its line; what is passed over, or is not quite as in the deck, is told on
//! the terminal and at the top of the scene.

mod amplitudes;
mod bodies;
mod cards;
mod conditions;
mod contacts;
mod frames;
mod groups;
mod loads;
mod materials;
mod names;
mod orientations;
mod orthotropic;
mod planes;
mod rubber;
mod scene;
mod spread;
mod springs;
mod steps;
mod supported;
mod supports;
mod tables;

use crate::error::{Error, Faults, Result};
use crate::mesh::abaqus::{Whole, read_whole};
use crate::output::replace;
use bodies::Bodies;
use cards::Notes;
use contacts::Contacts;
use frames::Frames;
use groups::Groups;
use names::Namer;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Characters of a line of the comment at the top of a scene.
const WIDTH: usize = 118;

/// What was written, and what the user should know of it.
pub struct Converted {
    pub scene: PathBuf,
    /// The file with further groups, if there is one.
    pub groups: Option<PathBuf>,
    /// Each with its place in the deck.
    pub notes: Vec<String>,
}

/// Converts a deck; the scene is put beside it under its name unless `out` names it.
///
/// # Errors
/// The deck cannot be read or converted, the scene exists already or cannot be written.
pub fn convert(deck: &Path, out: Option<&Path>) -> Result<Converted> {
    let scene = out.map_or_else(|| deck.with_extension("toml"), Path::to_path_buf);
    let stem = scene.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let more = scene.with_file_name(format!("{stem}-groups.inp"));
    let whole = read_whole(deck)?;
    for path in [&scene, &more] {
        if path.exists() {
            let what = format!("{} exists already", path.display());
            return Err(Error::input_anywhere(what, "remove it, or name another scene by --out"));
        }
    }
    let mut notes = Notes::default();
    let folder = scene.parent().unwrap_or(Path::new(""));
    let mesh = relative(deck, folder);
    let file_of = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let Parts { text, groups } = parts(&whole, &mesh, &file_of(&more), &mut notes)?;
    let text = header(&mesh, &title(&whole, &stem), &notes) + &text;
    // What is not a scene is an error of the conversion, and nothing is written.
    if let Err(error) = crate::scene::parse(&scene.display().to_string(), &text, folder, &[]) {
        return Err(Error::System(format!("the deck makes no scene that can be run: {error}")));
    }
    if groups.is_some() && mesh.contains(',') {
        return Err(Error::input_anywhere(format!("the path '{mesh}' has a comma"), "rename the deck, or its folder"));
    }
    let groups = groups.map(|cards| {
        let about = format!("** Groups for {}, beside those of the deck; made by `nagata convert`.", file_of(&scene));
        replace(&more, &format!("{about}\n*INCLUDE, INPUT={mesh}\n{cards}")).map(|()| more.clone())
    });
    let groups = groups.transpose()?;
    replace(&scene, &text)?;
    Ok(Converted { scene, groups, notes: notes.lines() })
}

/// The tables of a scene, and the cards of its further groups.
struct Parts {
    text: String,
    groups: Option<String>,
}

fn parts(whole: &Whole, deck: &str, more: &str, notes: &mut Notes) -> Result<Parts> {
    cards::sort(&whole.cards, notes)?;
    if let Some(error) = &whole.unread {
        return Err(error.clone());
    }
    let mut groups = Groups::new(whole);
    // Bodies, tools and contacts share names in the history; materials and steps have their own.
    let (mut namer, mut of_steps) = (Namer::default(), Namer::default());
    let (materials, amplitudes) = both(materials::read(whole, &mut Namer::default()), amplitudes::read(&whole.cards))?;
    let bodies = Bodies::new(&mut groups, &materials, &mut namer, notes)?;
    let contacts = contacts::convert(&mut groups, &bodies, &mut namer, notes);
    let springs = springs::read(whole, &bodies, notes);
    let others = springs.and_then(|springs| Ok((Frames::read(whole, &bodies, &springs)?, springs)));
    let (Contacts { text: contacts, tools, masters }, (frames, springs)) = both(contacts, others)?;
    let (bodies, tools, frames) = (&bodies, &tools[..], &frames);
    let model = steps::Model { bodies, tools, frames, materials: &materials, amplitudes: &amplitudes, springs };
    let (steps, history, still) = steps::convert(&mut groups, &model, &mut of_steps, notes)?;
    tell_of_unused(whole, &model, notes);

    let mut bodies_say = Vec::new();
    for (number, body) in bodies.bodies.iter().enumerate() {
        let mut says = body.write(&mut groups, &materials, notes)?;
        let mut planes = Vec::new();
        for (_, faces) in masters.iter().filter(|(of, _)| *of == number) {
            planes.extend(still.planes(&mut groups, bodies, number, faces)?);
        }
        planes.sort();
        planes.dedup();
        if !planes.is_empty() {
            says += &format!("symmetry = {planes:?}\n");
            let name = &body.name;
            notes.whole(format!(
                "body `{name}` goes on as its mirror image across the planes in which its nodes are held"
            ));
        }
        bodies_say.push(says);
    }
    let mesh = if groups.more.is_empty() { deck } else { more };
    let mut text = String::new();
    for (body, says) in bodies.bodies.iter().zip(bodies_say) {
        let _ = write!(text, "\n[body.{}]\nmesh = {}\n{says}", body.name, scene::quoted(mesh));
    }
    for material in bodies.materials().into_iter().map(|index| &materials[index]) {
        text += &format!("\n{}", material.write()?);
    }
    tools.iter().for_each(|tool| text += &tool.write(mesh));
    text += &contacts;
    text += &steps;
    if !history.is_empty() {
        let sets: Vec<String> = history.iter().map(|set| scene::quoted(set).to_string()).collect();
        text += &format!("\n[output]\n{}", scene::list("history", &sets));
    }
    Ok(Parts { text, groups: (!groups.more.is_empty()).then_some(groups.more) })
}

/// Two results, or the errors of both.
fn both<A, B>(a: Result<A>, b: Result<B>) -> Result<(A, B)> {
    let mut faults = Faults::default();
    faults.note(&a);
    faults.note(&b);
    faults.finish()?;
    Ok((a?, b?))
}

/// What the deck has, and does nothing with; and the law of elasticity.
fn tell_of_unused(whole: &Whole, model: &steps::Model, notes: &mut Notes) {
    for (number, rigid) in model.bodies.rigids.iter().enumerate() {
        if rigid.nodes.is_empty() && model.tools.iter().all(|tool| tool.rigid != number) {
            notes.at(&rigid.at, "the rigid body is in no *CONTACT PAIR: it is passed over, for nothing meets it");
        }
    }
    let used = model.bodies.materials();
    for (_, material) in model.materials.iter().enumerate().filter(|(number, _)| !used.contains(number)) {
        notes.at(&material.at, format!("the material '{}' is of no body: it is passed over", material.deck));
    }
    for amplitude in model.amplitudes.iter().filter(|amplitude| !amplitude.is_named) {
        notes.at(&amplitude.at, format!("nothing has the amplitude '{}': it is passed over", amplitude.name));
    }
    let has = |name: &str| whole.cards.iter().find(|card| card.keyword.name == name);
    if let Some(card) = has("ELASTIC") {
        let what = "*ELASTIC becomes linear in the logarithmic strain: CalculiX with NLGEOM takes Green's strain, which differs \
                    by the order of the strain";
        notes.at(&card.at, what);
    }
}

impl Notes {
    fn lines(&self) -> Vec<String> {
        let place = |(at, what): &(Option<crate::error::Location>, String)| match at {
            Some(at) => format!("{at}: {what}"),
            None => what.clone(),
        };
        self.0.iter().map(place).collect()
    }
}

/// The heading of the deck if it says something, else the name of the scene.
fn title(whole: &Whole, stem: &str) -> String {
    let heading = whole.cards.iter().find(|card| card.keyword.name == "HEADING").and_then(|card| card.rows.first());
    let said = heading.map(|row| row.text.as_str()).filter(|text| !text.starts_with("Hash:"));
    said.unwrap_or(stem).to_string()
}

/// The comment at the top, and the title.
fn header(deck: &str, title: &str, notes: &Notes) -> String {
    let mut text = format!("# Made by `nagata convert` of {deck}, which it needs. Units are those of the deck.\n");
    if !notes.0.is_empty() {
        text += "#\n# What is not, or not quite, as in the deck:\n";
    }
    for (at, what) in &notes.0 {
        let place = at.as_ref().map_or(String::new(), |at| match at.file.ends_with(deck) {
            true => format!("line {}: ", at.line),
            false => format!("{at}: "),
        });
        let mut line = "# -".to_string();
        for word in format!("{place}{what}").split_whitespace() {
            if line.chars().count() + 1 + word.chars().count() > WIDTH {
                text += &format!("{line}\n");
                line = "#  ".to_string();
            }
            line += &format!(" {word}");
        }
        text += &format!("{line}\n");
    }
    format!("{text}title = {}\n", scene::quoted(title))
}

/// A file as seen from a folder: by its relative path where it lies in it, else by its absolute one.
fn relative(file: &Path, folder: &Path) -> String {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let inside = match (file.canonicalize(), folder.canonicalize()) {
        (Ok(file), Ok(folder)) => file.strip_prefix(folder).map_or(file.clone(), Path::to_path_buf),
        _ => file.to_path_buf(),
    };
    inside.display().to_string()
}
