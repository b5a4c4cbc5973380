//! The contact element of a node: a rigid tool, and a patch of a deformable master that depends on 12 nodes.

use criterion::{Criterion, criterion_group, criterion_main};
use nagata::contact::element::{Contact, Element, Method, Opposite, Origin, Site};
use nagata::contact::{Compliance, Guide, Law, Multiplier, Tangent};
use nagata::controls::Controls;
use nagata::mesh::{Facet, Mesh};
use nagata::scene::Smoothing;
use nagata::surface::{MovingPatch, PatchSet, Transfer};
use nagata::{Mat3, Vec3};
use std::hint::black_box;

/// A dome of 5 by 5 quadrilaterals.
fn dome() -> Mesh {
    let mut mesh = Mesh { source: "dome".into(), ..Mesh::default() };
    for j in 0..6 {
        for i in 0..6 {
            let (x, y) = (i as f64 - 2.5, j as f64 - 2.5);
            mesh.points.push([x, y, -0.1 * x * x - 0.08 * y * y]);
        }
    }
    for j in 0..5 {
        for i in 0..5 {
            let k = 6 * j + i;
            mesh.facets.push(Facet { count: 4, nodes: [k, k + 1, k + 7, k + 6], id: (5 * j + i) as u64 });
        }
    }
    mesh
}

fn contact(c: &mut Criterion) {
    let mesh = dome();
    let numbers: Vec<u64> = (0..mesh.points.len() as u64).collect();
    let law = Law {
        friction: 0.3,
        normal: 40.0,
        tangential: 40.0,
        penalty: 40.0,
        rough: false,
        glides: false,
        clings: false,
        allowed: 0.0,
        compliance: Compliance::default(),
        barrier: 0.0,
        creep: 0.0,
        drawn_least: 0.1,
    };
    let augmented = Multiplier::Augmented(Vec3::new(1.0, 2.0, -8.0));
    let x = Vec3::new(0.21, -0.13, -0.03);
    for smoothing in [Smoothing::Nagata, Smoothing::Facet] {
        let patches = MovingPatch::all(&mesh, &numbers, smoothing, 40.0, &[], &Controls::default()).expect("a dome");
        let place = |patch: &MovingPatch| -> Vec<Vec3> {
            patch.nodes.iter().map(|n| Vec3::from(mesh.points[*n as usize])).collect()
        };
        let set = PatchSet::new(patches.iter().map(|p| p.shape(&place(p))).collect());
        let projection = set.closest(&x, 1.0, None).expect("a projection");
        let patch = &patches[projection.patch as usize];
        let (positions, before) = (place(patch), place(&patches[7]));
        let stencil = |patch: &MovingPatch| -> Vec<u32> { patch.nodes.iter().map(|n| *n as u32).collect() };
        let (on, from) = (stencil(patch), stencil(&patches[7]));
        let site = Site { patch: &patches[7], stencil: &from, positions: &before, xi: [0.4, 0.6] };
        let foot = Site { patch, stencil: &on, positions: &positions, xi: projection.xi };
        let (projection, carried) = (&projection, Vec3::zeros());
        let contact = Contact { projection, opposite: Opposite::Patch(foot), origin: Origin::Carried(site), carried };
        let mut e = Element::default();
        let name = |what: &str| format!("{smoothing:?}, {} nodes: {what}", patch.nodes.len());
        c.bench_function(&name("shape"), |b| b.iter(|| patch.shape(black_box(&positions))));
        for transfer in [Transfer::Variational, Transfer::Bilinear] {
            let method = Method { law, transfer, tangent: Tangent::Exact };
            c.bench_function(&name(&format!("{transfer:?} residual")), |b| {
                b.iter(|| e.residual(&method, black_box(&augmented), Some(&contact), &Guide::default()))
            });
            c.bench_function(&name(&format!("{transfer:?} tangent")), |b| {
                b.iter(|| e.tangent(&method, black_box(&augmented), Some(&contact), &Guide::default()))
            });
        }
        let origin = Origin::Fixed(patches[7].shape(&before).point([0.4, 0.6]));
        let rigid = Contact { projection, opposite: Opposite::Tool(Mat3::identity(), None), origin, carried };
        for (friction, name) in [(0.3, name("rigid, with friction")), (0.0, name("rigid, without friction"))] {
            let law = Law { friction, ..law };
            let method = Method { law, transfer: Transfer::Bilinear, tangent: Tangent::Exact };
            c.bench_function(&name, |b| {
                b.iter(|| e.tangent(&method, black_box(&augmented), Some(&rigid), &Guide::default()))
            });
        }
    }
}

criterion_group!(benches, contact);
criterion_main!(benches);
