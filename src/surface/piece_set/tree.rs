//! A tree of boxes that follows them: made once, fitted to boxes that have moved in linear time.
//!
//! It is a complete binary tree, each node before its two children; the leaves are runs of items of equal length.

use crate::Vec3;
use std::ops::Range;

/// Lower and upper corner.
pub type Box = (Vec3, Vec3);

/// Most items of a leaf.
const LEAF: usize = 4;
/// More than there are levels.
const DEPTH: usize = 40;

/// Boxes of items that are numbered from 0.
pub struct Tree {
    /// Leaf by leaf.
    items: Vec<u32>,
    /// Those of the items, in the same order.
    boxes: Vec<Box>,
    nodes: Vec<Box>,
    leaves: usize,
}

impl Tree {
    /// Halves the items along the longest side of their centers, again and again.
    pub fn new(boxes: &[Box]) -> Self {
        let leaves = boxes.len().div_ceil(LEAF).next_power_of_two();
        let items = (0..boxes.len() as u32).collect();
        let nowhere = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
        let mut tree = Self { items, boxes: boxes.to_vec(), nodes: vec![nowhere; 2 * leaves - 1], leaves };
        tree.sort(0..leaves, boxes);
        tree.fit(boxes);
        tree
    }

    fn sort(&mut self, leaves: Range<usize>, boxes: &[Box]) {
        if leaves.len() < 2 {
            return;
        }
        let middle = (leaves.start + leaves.end) / 2;
        let [from, to, end] = [leaves.start, middle, leaves.end].map(|leaf| self.run(leaf).start);
        let items = &mut self.items[from..end];
        let center = |item: &u32| boxes[*item as usize].0 + boxes[*item as usize].1;
        let start = center(&items[0]);
        let (low, high) = items.iter().map(center).fold((start, start), |(lo, hi), x| (lo.inf(&x), hi.sup(&x)));
        let axis = (high - low).imax();
        items.select_nth_unstable_by(to - from, |a, b| center(a)[axis].total_cmp(&center(b)[axis]));
        self.sort(leaves.start..middle, boxes);
        self.sort(middle..leaves.end, boxes);
    }

    /// Items of a leaf.
    fn run(&self, leaf: usize) -> Range<usize> {
        let start = |leaf: usize| leaf * self.items.len() / self.leaves;
        start(leaf)..start(leaf + 1)
    }

    /// Takes new boxes for the same items.
    pub fn fit(&mut self, boxes: &[Box]) {
        self.boxes.iter_mut().zip(&self.items).for_each(|(own, &item)| *own = boxes[item as usize]);
        for node in (0..self.nodes.len()).rev() {
            let within = match node.checked_sub(self.leaves - 1) {
                Some(leaf) => &self.boxes[self.run(leaf)],
                None => &self.nodes[2 * node + 1..2 * node + 3],
            };
            if let Some(hull) = within.iter().copied().reduce(|a, b| (a.0.inf(&b.0), a.1.sup(&b.1))) {
                self.nodes[node] = hull;
            }
        }
    }

    /// The items whose boxes touch a box.
    pub fn meeting(&self, low: &Vec3, high: &Vec3) -> Meeting<'_> {
        Meeting { tree: self, bounds: (*low, *high), open: [0; DEPTH], count: 1, run: 0..0 }
    }

    /// Visits items, near ones mostly first, and all whose boxes are no farther from `x` than the last bound that `visit`
    /// gave; `bound` is the first.
    pub fn approach(&self, x: &Vec3, mut bound: f64, mut visit: impl FnMut(usize) -> f64) {
        let (mut open, mut count) = ([(0, 0.0); DEPTH], 1);
        while count > 0 {
            count -= 1;
            let (node, distance) = open[count];
            if distance > bound {
                continue;
            }
            if let Some(leaf) = usize::checked_sub(node, self.leaves - 1) {
                let run = self.run(leaf);
                let mut near = [(0.0, 0); LEAF];
                let near = &mut near[..run.len()];
                near.iter_mut().zip(run).for_each(|(near, k)| *near = (away(&self.boxes[k], x), self.items[k]));
                near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
                for &mut (distance, item) in near {
                    if distance <= bound {
                        bound = visit(item as usize);
                    }
                }
                continue;
            }
            let child = |node: usize| (node, away(&self.nodes[node], x));
            let [one, other] = [child(2 * node + 1), child(2 * node + 2)];
            let (near, far) = if one.1 <= other.1 { (one, other) } else { (other, one) };
            (open[count], open[count + 1]) = (far, near);
            count += 2;
        }
    }
}

/// Distance of a point from a box.
pub fn away((low, high): &Box, x: &Vec3) -> f64 {
    (x - x.sup(low).inf(high)).norm()
}

fn meet(one: &Box, other: &Box) -> bool {
    (0..3).all(|d| one.0[d] <= other.1[d] && other.0[d] <= one.1[d])
}

/// See [`Tree::meeting`].
pub struct Meeting<'a> {
    tree: &'a Tree,
    bounds: Box,
    /// Nodes yet to be looked at.
    open: [u32; DEPTH],
    count: usize,
    /// Rest of a leaf.
    run: Range<usize>,
}

impl Iterator for Meeting<'_> {
    type Item = (usize, Box);

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let tree = self.tree;
            if let Some(k) = self.run.find(|&k| meet(&tree.boxes[k], &self.bounds)) {
                return Some((tree.items[k] as usize, tree.boxes[k]));
            }
            self.count = self.count.checked_sub(1)?;
            let node = self.open[self.count] as usize;
            if !meet(&tree.nodes[node], &self.bounds) {
                continue;
            }
            match node.checked_sub(tree.leaves - 1) {
                Some(leaf) => self.run = tree.run(leaf),
                None => {
                    let child = 2 * node as u32 + 1;
                    (self.open[self.count], self.open[self.count + 1]) = (child, child + 1);
                    self.count += 2;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn vector() -> impl Strategy<Value = Vec3> {
        [0.0..1.0_f64, 0.0..1.0, 0.0..1.0].prop_map(Vec3::from)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn all_boxes_are_found_also_when_they_have_moved(
            items in prop::collection::vec((vector(), vector(), vector()), 0..200),
            (x, size) in (vector(), 0.0..0.3),
        ) {
            let place = |moved: f64| -> Vec<Box> {
                items.iter().map(|(at, extent, way)| (at + way * moved, at + way * moved + extent * 0.1)).collect()
            };
            let mut tree = Tree::new(&place(0.0));
            for boxes in [place(0.0), place(0.1), place(-3.0)] {
                tree.fit(&boxes);
                let bounds = (x, x.add_scalar(size));
                let mut found: Vec<usize> = tree.meeting(&bounds.0, &bounds.1).map(|(k, _)| k).collect();
                found.sort_unstable();
                let all = || 0..boxes.len();
                prop_assert_eq!(found, all().filter(|&k| meet(&boxes[k], &bounds)).collect::<Vec<_>>());

                let nearest = boxes.iter().map(|b| away(b, &x)).fold(f64::INFINITY, f64::min);
                let (mut best, mut seen) = (f64::INFINITY, Vec::new());
                tree.approach(&x, best, |k| {
                    best = best.min(away(&boxes[k], &x));
                    seen.push(k);
                    best + 0.1
                });
                prop_assert_eq!(best, nearest);
                seen.sort_unstable();
                prop_assert!(seen.windows(2).all(|pair| pair[0] < pair[1]), "no item twice");
                prop_assert!(all().all(|k| seen.contains(&k) || away(&boxes[k], &x) > nearest + 0.1));
            }
        }
    }
}
