//! The settings of a scene that trade speed for accuracy, and the reference that it suggests: only what applies to it.

use super::plan::Variant;
use crate::mesh::SolidShape;
use crate::scene::{
    Accuracy, Body, Description, Discretization, Enforcement, Formulation, Linear, Located, MaterialModel, MeshSource,
    Scene, Smoothing, Tangent, Tool,
};

/// A setting with the ways that it can be, one of which the scene has: label, overrides, and wall time over that of the scene
/// as it is, roughly.
#[derive(Clone, Debug)]
pub struct Setting {
    pub name: String,
    pub ways: Vec<(String, Vec<String>, Option<f64>)>,
}

impl Setting {
    /// Of keys that share each of the values.
    pub fn of_keys(keys: &[String], values: &[String]) -> Self {
        let name = match keys {
            [key] => key.clone(),
            _ => common_end(keys),
        };
        let all = |value: &String| keys.iter().map(|key| format!("{key}={value}")).collect();
        let ways = values.iter().map(|value| (format!("{name}={value}"), all(value), None)).collect();
        Self { name: keys.join(","), ways }
    }

    /// The runs that it asks for.
    pub fn variants(self) -> Vec<Variant> {
        let Self { name, ways } = self;
        ways.into_iter()
            .map(|(label, overrides, cost)| Variant { label, setting: name.clone(), overrides, cost })
            .collect()
    }

    fn new(name: &str) -> Self {
        Self { name: name.into(), ways: Vec::new() }
    }

    fn add(&mut self, label: &str, overrides: Vec<String>, cost: f64) {
        if !overrides.is_empty() {
            self.ways.push((label.to_string(), overrides, Some(cost)));
        }
    }
}

/// The last word of keys, if they share it.
fn common_end(keys: &[String]) -> String {
    let end = |key: &String| key.rsplit('.').next().unwrap_or_default().to_string();
    match keys {
        [first, rest @ ..] if rest.iter().all(|key| end(key) == end(first)) => end(first),
        _ => keys.join(","),
    }
}

/// What the scene can be varied by, what is worth most first. `every` is how often the scene writes fields.
pub fn of(scene: &Scene, every: usize) -> Vec<Setting> {
    let [direct, rest] = linear(scene);
    let all = [
        pace(scene),
        accuracy(scene, Accuracy::Draft),
        mesh(scene),
        surface(scene),
        masters(scene),
        tolerance(scene),
        method(scene, &[Enforcement::Penalty]),
        penalty(scene),
        element(scene),
        direct,
        accuracy(scene, Accuracy::Reference),
        control(scene),
        method(scene, &[Enforcement::Lagrange, Enforcement::Uzawa]),
        rest,
        patches(scene),
        tangent(scene),
        output(scene, every),
    ];
    all.into_iter().filter(|setting| !setting.ways.is_empty()).collect()
}

/// Whether all bodies are layers.
fn is_plane(scene: &Scene) -> bool {
    scene.bodies.iter().all(Body::is_layer)
}

/// Times the wall time when all elements are split.
fn cost_of_split(scene: &Scene) -> f64 {
    if is_plane(scene) { 4.4 } else { 12.0 }
}

/// The reference, and less of it, as [`Reference`](super::plan::Reference) has it: meshes split once, of which an error of
/// second order leaves a third of the difference, and increments of half the size, of which one of first order leaves all;
/// exact surfaces of tools, no penalty, a tight tolerance.
pub fn references(scene: &Scene, budget: f64) -> Vec<(Variant, f64)> {
    let split: Vec<String> = scene
        .bodies
        .iter()
        .map(|body| format!("body.{}.refine={}", body.name.value, splits(&body.refine) + 1))
        .collect();
    let pace = vec![format!("solver.pace={:?}", 0.5 * scene.solver.pace)];
    let mut fixed: Vec<String> = scene.tools.iter().filter_map(best).collect();
    let bodies = scene.contacts.iter().filter(|c| c.surface.is_some_and(|s| s.smoothing == Smoothing::Facet));
    fixed.extend(bodies.map(|contact| format!("contact.{}.smoothing=nagata", contact.name.value)));
    let yielding = scene.contacts.iter().filter(|contact| contact.method == Enforcement::Penalty);
    fixed.extend(yielding.map(|contact| format!("contact.{}.method=augmented-lagrangian", contact.name.value)));
    if scene.solver.tolerance > TIGHT {
        fixed.push(format!("solver.tolerance={TIGHT:e}"));
    }
    let run = |label: &str, parts: &[&Vec<String>], cost: f64| {
        let overrides = parts.iter().flat_map(|part| part.iter().cloned()).collect();
        Variant::new(label, overrides, Some(cost))
    };
    let cost = cost_of_split(scene);
    if 2.0 * cost <= budget {
        let coarse = run("reference without split", &[&pace, &fixed], 2.0);
        let coarser = run("reference without split and pace", &[&fixed], 1.0);
        vec![(run("reference", &[&split, &pace, &fixed], 2.0 * cost), 0.0), (coarse, 1.0 / 3.0), (coarser, 1.0)]
    } else if cost <= budget {
        let coarse = run("reference without split", &[&fixed], 1.0);
        vec![(run("reference", &[&split, &fixed], cost), 0.0), (coarse, 1.0 / 3.0)]
    } else {
        let coarse = run("reference without pace", &[&fixed], 1.0);
        vec![(run("reference", &[&pace, &fixed], 2.0), 0.0), (coarse, 1.0)]
    }
}

/// The tolerance of references.
const TIGHT: f64 = 1e-10;

/// How often elements or facets are split in the scene.
fn splits(refine: &Option<Located<u32>>) -> u32 {
    refine.as_ref().map_or(0, |times| times.value)
}

/// The override that makes a tool's surface the best that is described, unless it is.
fn best(tool: &Tool) -> Option<String> {
    let rank = |description: &Description| match description {
        Description::Mesh(Smoothing::Facet) => 0,
        Description::Mesh(Smoothing::Nagata) => 1,
        Description::Bezier => 2,
        Description::Nurbs => 3,
        _ => 4,
    };
    let best = tool.descriptions().into_iter().max_by_key(rank)?;
    let better = rank(&best) > rank(&tool.smoothing.value);
    better.then(|| format!("tool.{}.smoothing={}", tool.name.value, best.key()))
}

/// Longer increments.
fn pace(scene: &Scene) -> Setting {
    let mut setting = Setting::new("solver.pace");
    let now = scene.solver.pace;
    for (times, cost) in [(4.0, 0.3), (2.0, 0.5)] {
        let pace = format!("solver.pace={:?}", times * now);
        setting.add(&pace.clone(), vec![pace], cost);
    }
    setting
}

/// The presets, which set the pace.
fn accuracy(scene: &Scene, preset: Accuracy) -> Setting {
    let mut setting = Setting::new("solver.accuracy");
    if scene.solver.accuracy != preset {
        let text = format!("solver.accuracy={}", preset.key());
        setting.add(&text.clone(), vec![text], scene.solver.pace / preset.solver().pace);
    }
    setting
}

/// Blocks with half the elements along each edge; even numbers of those that become quadratic ones.
fn mesh(scene: &Scene) -> Setting {
    let mut setting = Setting::new("mesh");
    let halved = |body: &Body| match &body.mesh {
        MeshSource::Block(block) => {
            let is_quadratic = body.element.as_ref().is_some_and(|element| element.value == Formulation::Hex27);
            let least = if is_quadratic { 2 } else { 1 };
            let count = block.value.elements.map(|count| count.div_ceil(2 * least) * least);
            (count != block.value.elements).then(|| format!("body.{}.block.elements={count:?}", body.name.value))
        }
        MeshSource::File { .. } => None,
    };
    let blocks = scene.bodies.iter().filter_map(halved).collect();
    setting.add("half as many elements along edges of blocks", blocks, if is_plane(scene) { 0.3 } else { 0.15 });
    setting
}

/// Other descriptions of tools, and refined facets in the place of smooth surfaces.
fn surface(scene: &Scene) -> Setting {
    let mut setting = Setting::new("surface");
    let mut keys: Vec<&str> = Vec::new();
    for description in scene.tools.iter().flat_map(Tool::descriptions) {
        if !keys.contains(&description.key()) {
            keys.push(description.key());
        }
    }
    let to = |key: &str| {
        let others = scene.tools.iter().filter(|tool| {
            tool.smoothing.value.key() != key && tool.descriptions().iter().any(|known| known.key() == key)
        });
        others.map(|tool| format!("tool.{}.smoothing={key}", tool.name.value)).collect::<Vec<_>>()
    };
    let facets = to("facet");
    setting.add("tools: facet", facets.clone(), 1.0);
    if scene.tools.iter().any(|tool| tool.mesh.is_some()) {
        let patched = [facets, split_tools(scene, 2)].concat();
        setting.add("tools: facet, split twice", patched, 1.0);
    }
    for key in keys.into_iter().filter(|&key| key != "facet") {
        setting.add(&format!("tools: {key}"), to(key), 1.0);
    }
    setting
}

/// Tools made of meshes with each facet split so many times more.
fn split_tools(scene: &Scene, times: u32) -> Vec<String> {
    let meshes = scene.tools.iter().filter_map(|tool| Some((&tool.name.value, tool.mesh.as_ref()?)));
    meshes.map(|(name, mesh)| format!("tool.{name}.refine={}", splits(&mesh.refine) + times)).collect()
}

/// More patches, where tools are made of them.
fn patches(scene: &Scene) -> Setting {
    let mut setting = Setting::new("surface");
    let patched = |tool: &Tool| tool.smoothing.value == Description::Mesh(Smoothing::Nagata);
    if scene.tools.iter().any(patched) {
        setting.add("tools: split once", split_tools(scene, 1), 1.0);
    }
    setting
}

/// Facets or patches as masters on bodies.
fn masters(scene: &Scene) -> Setting {
    let mut setting = Setting::new("masters");
    for (key, smoothing) in [("facet", Smoothing::Facet), ("nagata", Smoothing::Nagata)] {
        let others = scene.contacts.iter().filter(|c| c.surface.is_some_and(|s| s.smoothing != smoothing));
        let others = others.map(|contact| format!("contact.{}.smoothing={key}", contact.name.value)).collect();
        setting.add(&format!("masters: {key}"), others, 1.0);
    }
    setting
}

fn tolerance(scene: &Scene) -> Setting {
    let mut setting = Setting::new("solver.tolerance");
    for tolerance in [1e-4, 1e-6].into_iter().filter(|&loose| loose > 10.0 * scene.solver.tolerance) {
        let text = format!("solver.tolerance={tolerance:e}");
        setting.add(&text.clone(), vec![text], 0.8);
    }
    setting
}

/// Other ways to enforce contact.
fn method(scene: &Scene, methods: &[Enforcement]) -> Setting {
    let mut setting = Setting::new("method");
    for method in methods {
        let others = scene.contacts.iter().filter(|contact| contact.method != *method);
        let others = others.map(|contact| format!("contact.{}.method={}", contact.name.value, method.key())).collect();
        setting.add(&format!("contacts: {}", method.key()), others, 1.0);
    }
    setting
}

/// A tenth and ten times the penalty, where it is given.
fn penalty(scene: &Scene) -> Setting {
    let mut setting = Setting::new("penalty");
    for (label, times) in [("penalty / 10", 0.1), ("penalty * 10", 10.0)] {
        let given = scene.contacts.iter().filter_map(|contact| Some((&contact.name.value, contact.penalty?)));
        let given = given.map(|(name, penalty)| format!("contact.{name}.penalty={:?}", times * penalty)).collect();
        setting.add(label, given, 1.0);
    }
    setting
}

/// The other formulations that suit hexahedra of the material; of a mesh file only where the scene says that it has them.
fn element(scene: &Scene) -> Setting {
    let mut setting = Setting::new("element");
    for element in [Formulation::Hex8Fbar, Formulation::Hex8Sri, Formulation::Hex8Eas, Formulation::Hex8] {
        let others = scene.bodies.iter().filter(|body| {
            let given = body.element.as_ref().map(|element| element.value);
            let now = given.unwrap_or_else(|| scene.default_element(&body.material.value, SolidShape::Hex8, false));
            let is_block = matches!(body.mesh, MeshSource::Block(_));
            let hexahedra = is_block || given.is_some_and(|given| given.shape() == SolidShape::Hex8);
            let locks = scene.material(&body.material.value).is_some_and(|model| model.keeps_volume().is_some());
            let directed = matches!(scene.material(&body.material.value), Some(MaterialModel::Orthotropic(_)));
            let suits = match element {
                Formulation::Hex8 => !locks,
                Formulation::Hex8Eas => !directed && !body.is_axisymmetric(),
                _ => true,
            };
            // Sheets of one layer lock with any other.
            hexahedra && now != element && now != Formulation::Hex8Shell && suits
        });
        let others = others.map(|body| format!("body.{}.element={}", body.name.value, element.key())).collect();
        setting.add(&format!("elements: {}", element.key()), others, 1.0);
    }
    setting
}

/// Whether there is a choice.
fn has_tangents(discretization: Discretization) -> bool {
    matches!(discretization, Discretization::OnePass | Discretization::TwoPass)
}

fn tangent(scene: &Scene) -> Setting {
    let mut setting = Setting::new("tangent");
    let exact = scene
        .contacts
        .iter()
        .filter(|contact| contact.tangent == Tangent::Exact && has_tangents(contact.discretization));
    let exact = exact.map(|contact| format!("contact.{}.tangent=fixed-frame", contact.name.value)).collect();
    setting.add("tangents: fixed-frame", exact, 1.2);
    setting
}

/// Other solvers of linear systems: first a factorization each, then what iterates. In plane strain factors are always
/// cheaper than multigrid.
fn linear(scene: &Scene) -> [Setting; 2] {
    let now = scene.solver.linear;
    let of = |ways: &[(Linear, &str)]| {
        let mut setting = Setting::new("solver.linear");
        for (_, key) in ways.iter().filter(|(linear, _)| *linear != now) {
            let text = format!("solver.linear={key}");
            setting.add(&text.clone(), vec![text], 1.0);
        }
        setting
    };
    let reuse = (Linear::Reuse, "reuse");
    let rest = [reuse, (Linear::Iterative, "iterative")];
    let rest = match (is_plane(scene), now) {
        (true, Linear::Auto) => &rest[..0],
        (true, _) => &rest[..1],
        (false, _) => &rest[..],
    };
    [of(&[(Linear::Direct, "direct")]), of(rest)]
}

/// Increments that adapt to what changes in them.
fn control(scene: &Scene) -> Setting {
    let mut setting = Setting::new("increments");
    let table: toml::Table = scene.text.parse().unwrap_or_default();
    let given = |k: usize| table.get("step").and_then(|steps| steps.get(k)?.get("increment")).is_some();
    let adapts = scene.steps.iter().enumerate().filter(|(k, _)| given(*k));
    let names: Vec<usize> = adapts.map(|(k, _)| k).collect();
    for (key, value) in [("strain", "0.02"), ("contacts", "0.1")] {
        let limits = names.iter().map(|k| format!("step.{k}.increment.{key}={value}")).collect();
        setting.add(&format!("increments: {key}={value}"), limits, 1.5);
    }
    setting
}

/// Fields as often as the scene writes them.
fn output(scene: &Scene, every: usize) -> Setting {
    let mut setting = Setting::new("output");
    let increments: f64 = scene.steps.iter().map(|step| step.duration / step.increment.max).sum();
    if (every as f64) < increments {
        let label =
            if every == 1 { "fields every increment".into() } else { format!("fields every {every} increments") };
        setting.add(&label, vec![format!("output.every={every}")], 1.0);
    }
    setting
}
