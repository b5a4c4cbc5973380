//! More ranks than there is work.

use crate::case::Case;
use crate::oracle::{same, value};
use crate::scenes::{BAR, STACK, bar_force, stack_force};

family!(more_than_elements, on_several_tools);

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

/// A block in a corner of tools with friction, whose nodes are on two and on three of them: how the block is pressed is the same on
/// any number of ranks, and what each tool bears is, or the run tells that it is left open.
fn on_several_tools() -> Vec<Case> {
    let tools = [("x", "[1.0, 0.0, 0.0]"), ("y", "[0.0, 1.0, 0.0]"), ("z", "[0.0, 0.0, 1.0]")];
    let contacts = tools.map(|(axis, normal)| {
        format!(
            "[tool.w{axis}]\nplane = {{ point = [0.0, 0.0, 0.0], normal = {normal} }}\n[contact.c{axis}]\nslave = \"b.{axis}min\"\nmaster = \"w{axis}\"\n"
        )
    });
    let text = format!(
        "[body.b]\nmaterial = \"m\"\nblock = {{ box = {{ size = [2.0, 2.0, 2.0] }}, elements = [3, 3, 3] }}\n[material.m]\nmodel = \"neo-hookean\"\nyoung = 100.0\npoisson = 0.3\n{}[[step]]\nincrements = 4\npressure = [{{ set = \"b.xmax\", value = 2.0 }}, {{ set = \"b.ymax\", value = 3.0 }}, {{ set = \"b.zmax\", value = 5.0 }}]\n[output]\nevery = 1000\nhistory = [\"b\"]\n",
        contacts.concat()
    );
    let mut cases = Vec::new();
    for method in crate::scenes::METHODS {
        for friction in [0.0, 0.3, 5.0] {
            let of = |ranks: usize| {
                let case = Case::text(format!("mu = {friction}, {method}, {ranks} ranks"), text.as_str()).ranks(ranks);
                tools.iter().fold(case, |case, (axis, _)| {
                    case.set(format!("contact.c{axis}.friction={friction:?}"))
                        .set(format!("contact.c{axis}.method={method}"))
                })
            };
            for ranks in [1, 2, 4] {
                let all = of(ranks).oracle(same("b.uz", of(1), 1e-4, "1 rank"));
                cases.push(all.slow());
                let each = of(ranks).named(&format!("each, mu = {friction}, {method}, {ranks} ranks"));
                let each =
                    each.oracle(same("wx.fx", of(1), 1e-6, "1 rank")).oracle(same("wz.fz", of(1), 1e-6, "1 rank"));
                cases.push(each.or_warns(&["hold by friction at once"]).quick_if(method == "lagrange" && ranks == 2));
            }
        }
    }
    cases
}
