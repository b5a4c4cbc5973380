//! STL files, ASCII and binary (3D Systems, StereoLithography Interface Specification, 1989): triangles with a corner each to
//! itself. Corners at one place become one node, and the named solids of an ASCII file groups. The order of the corners tells
//! the outside; normals in the file are passed over.

use super::raw::{FileGroup, FileMesh};
use super::{Facet, Group, message};
use crate::Vec3;
use crate::error::{Error, Location, Result};
use std::collections::{BTreeMap, HashMap};

/// Bytes before the triangles of a binary file: a header, and their number.
const HEAD: usize = 84;
/// Bytes of a triangle: a normal and three corners in single precision, and two more.
const TRIANGLE: usize = 50;

/// Corners are one node when they are closer than this times the diagonal of the box around all.
const MERGED: f64 = 1e-6;
/// Or than this times the largest coordinate, which is four roundings in single precision.
const SINGLE: f64 = 2.4e-7;

type Point = [f64; 3];

/// Triangles as they are listed.
#[derive(Default)]
struct Listed {
    triangles: Vec<[Point; 3]>,
    /// Where each named solid begins.
    solids: Vec<(String, usize)>,
}

/// Whether these are the bytes of a binary file: as many as it says that it has triangles.
pub(super) fn is_binary(data: &[u8]) -> bool {
    count(data).is_some_and(|count| data.len() == HEAD + TRIANGLE * count)
}

/// Whether this may be an ASCII file.
pub(super) fn is_text(data: &[u8]) -> bool {
    data.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
}

/// The number of triangles that a binary file says it has.
fn count(data: &[u8]) -> Option<usize> {
    let bytes = data.get(HEAD - 4..HEAD)?;
    Some(u32::from_le_bytes(bytes.try_into().ok()?) as usize)
}

/// Reads a whole file; `source` names it in messages.
pub(super) fn read(source: &str, data: Vec<u8>) -> Result<FileMesh> {
    // The header of a binary file may begin as a text, but there is a zero in the number of its triangles.
    let listed = match is_text(&data) && !is_binary(&data) && !data.contains(&0) {
        true => read_text(source, &data)?,
        false => read_binary(source, &data)?,
    };
    let number = |corner: &Point| corner.iter().all(|x| x.is_finite());
    if let Some(bad) = listed.triangles.iter().position(|triangle| !triangle.iter().all(number)) {
        let what = format!("facet {} has a corner that is not at a finite place", bad + 1);
        return Err(message::whole_file(source, what, "export the file again"));
    }
    if listed.triangles.is_empty() {
        return Err(message::whole_file(source, "the file has no facets", "export the file again"));
    }
    Ok(finish(source, &listed))
}

fn read_binary(source: &str, data: &[u8]) -> Result<Listed> {
    if !is_binary(data) {
        let found = data.len();
        let what = match count(data) {
            Some(count) => {
                let (needed, whole) = (HEAD + TRIANGLE * count, found.saturating_sub(HEAD) / TRIANGLE);
                let cut = if found < needed { format!(": it ends in facet {}", whole + 1) } else { String::new() };
                format!("a binary STL file of {count} facets has {needed} bytes, this has {found}{cut}")
            }
            None => format!("a binary STL file has {HEAD} bytes or more, this has {found}"),
        };
        return Err(message::whole_file(source, what, "the file is cut off or of another format: export it again"));
    }
    let number = |bytes: &[u8], at: usize| {
        let bytes = [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]];
        f64::from(f32::from_le_bytes(bytes))
    };
    // Behind the normal.
    let corner = |bytes: &[u8], corner: usize| [0, 4, 8].map(|at| number(bytes, 12 + 12 * corner + at));
    let triangles = data[HEAD..].chunks_exact(TRIANGLE).map(|bytes| [0, 1, 2].map(|at| corner(bytes, at)));
    Ok(Listed { triangles: triangles.collect(), solids: Vec::new() })
}

fn read_text(source: &str, data: &[u8]) -> Result<Listed> {
    let mut listed = Listed::default();
    // The corners of the open facet.
    let mut open: Option<Vec<Point>> = None;
    let mut last = 0;
    for (line, bytes) in (1..).zip(data.split(|&byte| byte == b'\n')) {
        let text = String::from_utf8_lossy(bytes.trim_ascii());
        let error = |what: String, help: &str| {
            let text = message::shorten(bytes.trim_ascii(), 100).into();
            Err(Error::input(&Location { file: source.into(), line, column: 1, text }, what, help))
        };
        let mut words = text.split_whitespace();
        let Some(word) = words.next().map(str::to_ascii_lowercase) else { continue };
        last = line;
        match (word.as_str(), &mut open) {
            ("solid", None) => {
                let name: Vec<&str> = words.collect();
                if !name.is_empty() {
                    listed.solids.push((name.join(" "), listed.triangles.len()));
                }
            }
            ("facet", None) => open = Some(Vec::new()),
            ("endsolid", None) | ("outer" | "endloop", Some(_)) => {}
            ("vertex", Some(corners)) => {
                let numbers: Vec<f64> = words.map_while(|word| word.parse().ok()).collect();
                match numbers[..] {
                    [x, y, z] => corners.push([x, y, z]),
                    _ => return error(format!("expected 3 coordinates, found '{text}'"), ""),
                }
            }
            ("endfacet", Some(corners)) => {
                let [a, b, c] = corners[..] else {
                    return error(format!("a facet has {} corners, not 3", corners.len()), "STL has triangles alone");
                };
                listed.triangles.push([a, b, c]);
                open = None;
            }
            _ => {
                let expected = if open.is_some() { "vertex or endfacet" } else { "facet or endsolid" };
                return error(format!("expected {expected}, found '{}'", message::shorten(text.as_bytes(), 30)), "");
            }
        }
    }
    match open {
        None => Ok(listed),
        Some(_) => {
            let what = format!("the file ends in a facet, at line {last}");
            Err(message::whole_file(source, what, "the file is cut off: export it again"))
        }
    }
}

/// Nodes, facets and groups.
fn finish(source: &str, listed: &Listed) -> FileMesh {
    let corners: Vec<Point> = listed.triangles.iter().flatten().copied().collect();
    let (points, nodes, farthest) = merge(&corners);
    let mut file = FileMesh::new(source);
    file.attached = vec![false; points.len()];
    file.mesh.point_ids = (1..=points.len() as u64).collect();
    file.mesh.points = points;
    file.is_closed = true;
    let mut groups: BTreeMap<&str, Group> = BTreeMap::new();
    let mut empty: Vec<u64> = Vec::new();
    for (at, &[a, b, c]) in nodes.as_chunks::<3>().0.iter().enumerate() {
        let id = at as u64 + 1;
        if a == b || b == c || c == a {
            empty.push(id);
            continue;
        }
        let began = listed.solids.partition_point(|(_, first)| *first <= at);
        if let Some((name, _)) = began.checked_sub(1).map(|solid| &listed.solids[solid]) {
            groups.entry(name).or_default().facets.push(file.mesh.facets.len() as u32);
        }
        file.mesh.facets.push(Facet { count: 3, nodes: [a, b, c, 0], id });
        [a, b, c].iter().for_each(|&node| file.attached[node as usize] = true);
    }
    let group = |(name, group): (&str, Group)| (name.to_string(), FileGroup { group, ..FileGroup::default() });
    file.groups = groups.into_iter().map(group).collect();
    if farthest > 0.0 {
        let what = format!("'{source}': corners of facets up to {farthest:.1e} apart are taken for one node");
        file.mesh.warnings.push(what);
    }
    if !empty.is_empty() {
        let what = format!(
            "'{source}': {} without area, two corners being one, and left out",
            message::several("facet", &empty)
        );
        file.mesh.warnings.push(what);
    }
    file
}

/// Nodes for corners, the node of each, and how far the farthest corners of one node are apart, 0 if that may be rounding.
fn merge(corners: &[Point]) -> (Vec<Point>, Vec<u32>, f64) {
    let mut known: HashMap<[u64; 3], u32> = HashMap::new();
    let mut places: Vec<Vec3> = Vec::new();
    let mut place_of: Vec<u32> = Vec::with_capacity(corners.len());
    for corner in corners {
        // -0 is 0.
        let place = *known.entry(corner.map(|x| (x + 0.0).to_bits())).or_insert(places.len() as u32);
        if place as usize == places.len() {
            places.push(Vec3::from(*corner));
        }
        place_of.push(place);
    }
    let (low, high) = places.iter().fold((places[0], places[0]), |(low, high), x| (low.inf(x), high.sup(x)));
    let rounding = SINGLE * low.amax().max(high.amax());
    let close = rounding.max(MERGED * (high - low).norm());
    // Along a direction that no mesh is aligned with, close places are near in the order.
    let direction = Vec3::new(0.5357, 0.6214, 0.5718);
    let mut order: Vec<(f64, u32)> = places.iter().zip(0..).map(|(x, at)| (x.dot(&direction), at)).collect();
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    // The first of the places that each is one with.
    let mut first: Vec<u32> = (0..places.len() as u32).collect();
    fn root(first: &[u32], mut place: u32) -> u32 {
        while first[place as usize] != place {
            place = first[place as usize];
        }
        place
    }
    let mut farthest = 0.0f64;
    for (at, &(along, a)) in order.iter().enumerate() {
        for &(_, b) in order[at + 1..].iter().take_while(|other| other.0 - along <= close) {
            let distance = (places[a as usize] - places[b as usize]).norm();
            if distance <= close {
                let [a, b] = [root(&first, a), root(&first, b)];
                first[a.max(b) as usize] = a.min(b);
                farthest = farthest.max(distance);
            }
        }
    }
    let mut points: Vec<Point> = Vec::new();
    let mut node_of: Vec<u32> = Vec::with_capacity(places.len());
    for (place, x) in (0..).zip(&places) {
        let earlier = root(&first, place);
        node_of.push(if earlier == place { points.len() as u32 } else { node_of[earlier as usize] });
        if earlier == place {
            points.push((*x).into());
        }
    }
    (
        points,
        place_of.iter().map(|&place| node_of[place as usize]).collect(),
        if farthest > rounding { farthest } else { 0.0 },
    )
}
