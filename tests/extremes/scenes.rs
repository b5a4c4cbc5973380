//! Scenes that several families share, and the closed forms for them.

use crate::case::{Case, Scene};
use crate::common::root;

/// The four methods.
pub const METHODS: [&str; 4] = ["augmented-lagrangian", "lagrange", "uzawa", "penalty"];

/// `inputs/sphere-on-block.toml` with other elements and increments: a block of E = 100 under a cap of radius 20 that is
/// pressed by 1 and drawn by 1 with friction 0.3.
pub fn sphere(variant: impl Into<String>, elements: [usize; 3], press: usize, slide: usize) -> Case {
    Case::new(variant, Scene::Input("sphere-on-block.toml"))
        .set(format!("body.block.block.elements={elements:?}"))
        .set(format!("step.press.increments={press}"))
        .set(format!("step.slide.increments={slide}"))
        .set("output.every=1000")
}

/// A bar of 2 x 2 x 2 on rollers under a smooth plate, of which a quarter is modelled: every element is strained alike.
pub const BAR: &str = r#"[body.b]
material = "m"
element = "hex8"
symmetry = ["xmin", "ymin", "zmin"]
block = { box = { size = [2.0, 2.0, 2.0] }, elements = [2, 2, 2] }
[material.m]
model = "hooke"
young = 10.0
poisson = 0.3
[tool.p]
plane = { point = [0.0, 0.0, 2.0], normal = [0.0, 0.0, -1.0] }
[contact.c]
slave = "b.zmax"
master = "p"
[[step]]
name = "press"
increments = 2
move = [{ target = "p", by = [0.0, 0.0, -0.4] }]
[output]
every = 1000
history = ["b.zmin", "b.zmax"]
"#;

/// Force on such a bar of logarithmic Hooke's law: Kirchhoff stress E ln l under a stretch l over the current area,
/// A l^(-2 nu), with J = l^(1 - 2 nu): A E ln l / l.
pub fn bar_force(young: f64, area: f64, stretch: f64) -> f64 {
    area * young * stretch.ln() / stretch
}

/// The stretch at a force.
pub fn bar_stretch(young: f64, area: f64, force: f64) -> f64 {
    root(0.3, 2.7, |stretch| bar_force(young, area, stretch) - force)
}

/// Force on a bar that is held sideways: the same with the modulus E (1 - nu) / ((1 + nu) (1 - 2 nu)).
pub fn held_bar_force(young: f64, poisson: f64, area: f64, stretch: f64) -> f64 {
    bar_force(young * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), area, stretch)
}

/// A slab under a plate, pressed by 0.2 of 2 and drawn by 0.5 with friction 0.3.
pub const SLAB: &str = r#"[body.b]
material = "m"
element = "hex8"
block = { box = { size = [4.0, 4.0, 2.0] }, elements = [4, 4, 2] }
[material.m]
model = "neo-hookean"
young = 100.0
poisson = 0.3
[tool.t]
plane = { point = [0.0, 0.0, 2.0], normal = [0.0, 0.0, -1.0] }
[contact.c]
slave = "b.zmax"
master = "t"
friction = 0.3
[[step]]
name = "press"
increments = 2
fix = [{ set = "b.zmin" }]
move = [{ target = "t", by = [0.0, 0.0, -0.2] }]
[[step]]
name = "draw"
increments = 4
fix = [{ set = "b.zmin" }]
move = [{ target = "t", by = [0.5, 0.0, 0.0] }]
[output]
every = 1000
history = ["b.zmin", "b.zmax"]
"#;

/// Two bars on each other, held sideways: `lower` is the slave. Pressed by 0.2.
pub const STACK: &str = r#"[body.lower]
material = "a"
element = "hex8"
block = { box = { size = [2.0, 2.0, 2.0] }, elements = [2, 2, 2] }
[body.upper]
material = "b"
element = "hex8"
block = { box = { origin = [0.0, 0.0, 2.0], size = [2.0, 2.0, 2.0] }, elements = [2, 2, 2] }
[material.a]
model = "hooke"
young = 100.0
poisson = 0.3
[material.b]
model = "hooke"
young = 100.0
poisson = 0.3
[contact.c]
slave = "lower.zmax"
master = "upper.zmin"
[[step]]
name = "press"
increments = 2
fix = [
    { set = "lower.zmin", directions = "z" },
    { set = "lower.xmin", directions = "x" }, { set = "lower.xmax", directions = "x" },
    { set = "lower.ymin", directions = "y" }, { set = "lower.ymax", directions = "y" },
    { set = "upper.xmin", directions = "x" }, { set = "upper.xmax", directions = "x" },
    { set = "upper.ymin", directions = "y" }, { set = "upper.ymax", directions = "y" },
]
move = [{ target = "upper.zmax", by = [0.0, 0.0, -0.2], directions = "z" }]
[output]
every = 1000
history = ["upper.zmax", "lower.zmin"]
"#;

/// Force on two bars on each other, each 2 x 2 x 2 and held sideways, shortened by `by` together.
pub fn stack_force(lower: f64, upper: f64, poisson: f64, by: f64) -> f64 {
    // The softer one takes all but nothing of it at extreme ratios: its shortening is the unknown.
    let (soft, stiff) = (lower.min(upper), lower.max(upper));
    let force = |young: f64, by: f64| held_bar_force(young, poisson, 4.0, 1.0 - by / 2.0);
    let taken = root(0.0, by, |taken| force(soft, taken) - force(stiff, by - taken));
    force(soft, taken)
}

/// Balance of the two, and the force of the plate.
pub const GLUED: &str = "nodes that are moved with the plate";

/// [`SLAB`] with its upper face tied to the plate: what any sufficient friction gives.
pub fn glued(by: [f64; 3]) -> Case {
    let text = SLAB
        .replace("target = \"t\", by = [0.0, 0.0, -0.2]", "target = \"b.zmax\", by = [0.0, 0.0, -0.2]")
        .replace("target = \"t\", by = [0.5, 0.0, 0.0]", &format!("target = \"b.zmax\", by = {by:?}"));
    let (bodies, rest) = text.split_once("[tool.t]").unwrap();
    let (_, steps) = rest.split_once("[[step]]").unwrap();
    // A set that a step moves goes on from where it was.
    Case::text("glued", format!("{bodies}[[step]]{steps}"))
}

/// A plane that looks along its axis, as a mesh of `n` x `n` facets over [-w, w]^2 at a height z.
pub fn plate(n: usize, half: f64, z: f64, up: bool) -> String {
    let at = |s: f64| half * (2.0 * s - 1.0);
    crate::common::msh::surface(n, |s, t| if up { [at(s), at(t), z] } else { [at(t), at(s), z] })
}
