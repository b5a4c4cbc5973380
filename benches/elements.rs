//! Elements a second on one core.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use nagata::scene::{Hardening, MaterialModel};
use nagata::solid::element::{ElementMatrices, Medium, hex8, hex8_eas, hex8_fbar, hex8_sri, tet4};
use nagata::solid::material::Material;
use std::hint::black_box;

type Nodes<const N: usize> = [[f64; 3]; N];

/// Nodes of a slightly irregular element and displacements of a few percent.
fn nodes<const N: usize>(corners: Nodes<N>) -> (Nodes<N>, Nodes<N>) {
    let wave = |n: usize, i: usize, phase: f64| 0.05 * (phase + 1.7 * n as f64 + 2.9 * i as f64).sin();
    let x0 = std::array::from_fn(|n| std::array::from_fn(|i| corners[n][i] + wave(n, i, 0.0)));
    (x0, std::array::from_fn(|n| std::array::from_fn(|i| wave(n, i, 0.5))))
}

fn elements(criterion: &mut Criterion) {
    let neo_hookean = Material::new(&MaterialModel::NeoHookean { young: 210.0, poisson: 0.3 });
    let hooke = Material::new(&MaterialModel::Hooke { young: 210.0, poisson: 0.3 });
    let hardening = Hardening::Swift { k: 0.5653, e0: 0.0071156, n: 0.2589 };
    let plastic = MaterialModel::Plastic { young: 210.0, poisson: 0.3, hill: None, hardening };
    let plastic = Material::new(&plastic);
    let hex = nodes(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
            .map(|corner: [u8; 3]| corner.map(f64::from)),
    );
    let tet = nodes([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|corner: [u8; 3]| corner.map(f64::from)));
    let mut out24 = ElementMatrices::<24>::default();
    let mut out12 = ElementMatrices::<12>::default();

    let mut group = criterion.benchmark_group("elements");
    group.throughput(Throughput::Elements(1));
    for (law, material) in [("neo-hookean", &neo_hookean), ("hooke", &hooke), ("j2", &plastic)] {
        // As at the end of an iteration.
        let mut known = ElementMatrices::default();
        hex8_eas::evaluate(&hex.0, &hex.1, Medium::virgin(material), true, &mut known).expect("sound element");
        for (what, want_tangent) in [("residual", false), ("residual+tangent", true)] {
            let mut run = |element: &str, f: &mut dyn FnMut()| {
                group.bench_function(format!("{element} {law} {what}"), |bencher| bencher.iter(&mut *f));
            };
            run("hex8", &mut || {
                let (x0, u) = black_box(&hex);
                hex8::evaluate(x0, u, Medium::virgin(material), want_tangent, black_box(&mut out24))
                    .expect("sound element");
            });
            run("hex8-fbar", &mut || {
                let (x0, u) = black_box(&hex);
                hex8_fbar::evaluate(x0, u, Medium::virgin(material), want_tangent, black_box(&mut out24))
                    .expect("sound element");
            });
            run("hex8-sri", &mut || {
                let (x0, u) = black_box(&hex);
                hex8_sri::evaluate(x0, u, Medium::virgin(material), want_tangent, black_box(&mut out24))
                    .expect("sound element");
            });
            run("hex8-eas", &mut || {
                let (x0, u) = black_box(&hex);
                hex8_eas::evaluate(x0, u, Medium::virgin(material), want_tangent, black_box(&mut out24))
                    .expect("sound element");
            });
            run("hex8-eas with known amplitudes", &mut || {
                let (x0, u) = black_box(&hex);
                let medium = Medium { amplitudes: Some(&known.amplitudes), ..Medium::virgin(material) };
                hex8_eas::evaluate(x0, u, medium, want_tangent, black_box(&mut out24)).expect("sound element");
            });
            run("tet4", &mut || {
                let (x0, u) = black_box(&tet);
                tet4::evaluate(x0, u, Medium::virgin(material), want_tangent, black_box(&mut out12))
                    .expect("sound element");
            });
        }
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(30)
        .warm_up_time(std::time::Duration::from_millis(500))
        .measurement_time(std::time::Duration::from_secs(1));
    targets = elements
}
criterion_main!(benches);
