//! Many lists in two arrays.

/// The things that concern each of several owners: those of owner k are `items[starts[k]..starts[k + 1]]`, rising.
pub struct Lists {
    starts: Vec<usize>,
    items: Vec<u32>,
}

impl Lists {
    /// Of so many owners and things, of which `each` calls its argument with every owner that one concerns, once.
    pub fn new(owners: usize, things: usize, each: impl Fn(usize, &mut dyn FnMut(usize))) -> Self {
        let mut starts = vec![0; owners + 1];
        (0..things).for_each(|k| each(k, &mut |owner| starts[owner + 1] += 1));
        (0..owners).for_each(|owner| starts[owner + 1] += starts[owner]);
        let mut next = starts.clone();
        let mut items = vec![0; starts[owners]];
        for k in 0..things {
            each(k, &mut |owner| {
                items[next[owner]] = k as u32;
                next[owner] += 1;
            });
        }
        Self { starts, items }
    }

    /// Those of one owner.
    pub fn of(&self, owner: usize) -> &[u32] {
        &self.items[self.starts[owner]..self.starts[owner + 1]]
    }
}
