//! How sets are held and moved, as items of `fix` and `move`.

use super::frames::Frame;
use super::scene::{Rotation, in_time, letters, quoted};
use super::tables::Table;
use crate::Vec3;

/// A set that is held or moved.
#[derive(Clone)]
pub(super) struct Support {
    pub set: String,
    /// That of all of its nodes; `None` of the global axes.
    pub frame: Option<Frame>,
    /// The way along its three directions; `None` where it is free.
    pub ways: [Option<f64>; 3],
    pub rotation: Option<Rotation>,
    pub table: Option<Table>,
}

impl Support {
    fn held(&self) -> [bool; 3] {
        self.ways.map(|way| way == Some(0.0))
    }

    fn moved(&self) -> [bool; 3] {
        self.ways.map(|way| way.is_some_and(|way| way != 0.0))
    }

    /// The way, 0 where it is free.
    pub fn by(&self) -> [f64; 3] {
        self.ways.map(|way| way.unwrap_or(0.0))
    }

    /// The items of `fix`.
    pub fn fixes(&self) -> Vec<String> {
        let (set, held) = (quoted(&self.set), self.held());
        if !held.contains(&true) || self.rotation.is_some() {
            return self.across().map(|across| format!("{{ set = {set}, normal = {across} }}")).into_iter().collect();
        }
        match &self.frame {
            Some(Frame::Axes(axes)) if held != [true; 3] => {
                if self.ways.iter().all(Option::is_some) {
                    return Vec::new();
                }
                let along = (0..3).filter(|&d| held[d]).map(|d| vector(&axes[d]));
                along.map(|normal| format!("{{ set = {set}, normal = {normal} }}")).collect()
            }
            Some(Frame::Around { point, axis }) if held != [true; 3] => {
                vec![format!("{{ set = {set}, {} }}", around(point, axis, held))]
            }
            _ => vec![format!("{{ set = {set}{} }}", letters("xyz", held))],
        }
    }

    /// The item of `move`, if it moves.
    pub fn motion(&self, duration: f64) -> Option<String> {
        let (set, moved, by) = (quoted(&self.set), self.moved(), self.by());
        let table = in_time(&self.table, duration);
        if let Some(rotation) = self.rotation {
            let by = if by == [0.0; 3] { String::new() } else { format!(", by = {by:?}") };
            return Some(format!("{{ target = {set}{by}, {}{table} }}", rotation.write()));
        }
        if !moved.contains(&true) {
            return None;
        }
        Some(match &self.frame {
            None => format!("{{ target = {set}, by = {by:?}{}{table} }}", letters("xyz", moved)),
            Some(Frame::Around { point, axis }) => {
                format!("{{ target = {set}, by = {by:?}, {}{table} }}", around(point, axis, moved))
            }
            Some(Frame::Axes(axes)) => {
                let way = along(axes, by);
                let is_whole = self.ways.iter().all(Option::is_some);
                let normal = if is_whole { String::new() } else { format!(", normal = {}", vector(&way.normalize())) };
                format!("{{ target = {set}, by = {}{normal}{table} }}", vector(&way))
            }
        })
    }

    /// The direction across the way of a set that moves along two axes of its frame and is free along the third.
    fn across(&self) -> Option<String> {
        let Some(Frame::Axes(axes)) = &self.frame else { return None };
        let free = (0..3).find(|&d| self.ways[d].is_none())?;
        let way = along(axes, self.by());
        let is_askew = self.moved().iter().filter(|moved| **moved).count() == 2;
        is_askew.then(|| vector(&axes[free].cross(&way).normalize()))
    }
}

/// The way by so much along axes.
fn along(axes: &[Vec3; 3], by: [f64; 3]) -> Vec3 {
    axes.iter().zip(by).map(|(axis, by)| axis * by).sum()
}

fn around(point: &Vec3, axis: &Vec3, which: [bool; 3]) -> String {
    let frame = format!("around = {{ point = {}, axis = {} }}", vector(point), vector(axis));
    format!("{frame}{}", letters("rtz", which))
}

/// As a list.
fn vector(v: &Vec3) -> String {
    format!("{:?}", [v.x, v.y, v.z].map(|part| part + 0.0))
}
