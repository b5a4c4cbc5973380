//! More ranks than there is work.

use crate::case::Case;
use crate::oracle::value;
use crate::scenes::{BAR, STACK, bar_force, stack_force};

family!(more_than_elements);

fn more_than_elements() -> Vec<Case> {
    let mut cases = Vec::new();
    for ranks in [1, 2, 3, 4, 7] {
        let bar = |name: String, elements: &str| {
            Case::text(format!("{name}, {ranks} ranks"), BAR)
                .set(format!("body.b.block.elements={elements}"))
                .ranks(ranks)
                .oracle(value("p.fz", bar_force(10.0, 4.0, 0.8), 1e-6, "closed form"))
                .must_run()
        };
        cases.push(bar("one element".into(), "[1, 1, 1]"));
        cases.push(bar("two elements".into(), "[1, 1, 2]").slow());
        for discretization in ["one-pass", "two-pass", "node-to-node", "segment"] {
            let stack = Case::text(format!("one on one, {discretization}, {ranks} ranks"), STACK)
                .sets(["body.lower.block.elements=[1, 1, 1]", "body.upper.block.elements=[1, 1, 1]"])
                .set(format!("contact.c.discretization={discretization}"))
                .ranks(ranks)
                .oracle(value("upper.zmax.fz", stack_force(100.0, 100.0, 0.3, 0.2), 1e-6, "closed form"))
                .must_run();
            cases.push(if ranks == 4 { stack } else { stack.slow() });
        }
    }
    cases
}
