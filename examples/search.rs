//! What the search for contact costs: `mpirun -n RANKS search nagata|facet N...` for wavy surfaces of N x N patches that
//! move with their nodes, and as many slave nodes above them, as CSV; `scripts/studies/search.py` makes tables of it. Ranks
//! own strips of the surface, and the slave nodes above those of other ranks: none has what it needs.

use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use nagata::Vec3;
use nagata::contact::BodySurface;
use nagata::controls::Controls;
use nagata::mesh::{Facet, Mesh};
use nagata::parallel::{max, sent};
use nagata::partition::Bounds;
use nagata::partition::directory::recipients;
use nagata::partition::parcels::bounds;
use nagata::scene::{MasterSurface, Smoothing, Transfer};
use nagata::surface::MovingPatch;
use std::collections::BTreeSet;

fn main() {
    let universe = mpi::initialize().expect("MPI has not been started");
    let comm = universe.world();
    let mut arguments = std::env::args().skip(1);
    let smoothing = if arguments.next().as_deref() == Some("facet") { Smoothing::Facet } else { Smoothing::Nagata };
    if comm.rank() == 0 {
        println!("ranks,nodes,search,fetch,iterate,first,project,messages_search,messages_iterate,patches");
    }
    for n in arguments.filter_map(|n| n.parse().ok()) {
        Case::new(&comm, smoothing, n).measure();
    }
}

/// The surface at `[0, 1]^2` and a time.
fn wave(x: f64, y: f64, t: f64) -> Vec3 {
    Vec3::new(x, y, 0.05 * (6.0 * x + t).sin() * (5.0 * y).cos())
}

/// A surface of n x n patches, and the slave nodes of this rank.
struct Case<'a> {
    comm: &'a SimpleCommunicator,
    n: usize,
    starts: Vec<u64>,
    surface: BodySurface,
    slaves: Vec<Vec3>,
    reach: f64,
}

impl<'a> Case<'a> {
    fn new(comm: &'a SimpleCommunicator, smoothing: Smoothing, n: usize) -> Self {
        let (rank, size) = (comm.rank() as usize, comm.size() as usize);
        let starts: Vec<u64> = (0..=size).map(|r| ((n + 1) * (r * (n + 1) / size)) as u64).collect();
        let patches = if rank == 0 { patches(n, smoothing) } else { Vec::new() };
        let given = MasterSurface { smoothing, feature_angle: 40.0, transfer: Transfer::Patch };
        let edge = 1.0 / n as f64;
        let surface = BodySurface::new(comm, "wave", given, &patches, &starts, edge);
        let at = |i: usize, j: usize| wave((i as f64 + 0.3) * edge, (j as f64 + 0.6) * edge, 0.0);
        let other = (rank + size / 2) % size;
        let strip = other * n / size..(other + 1) * n / size;
        let slaves = strip.flat_map(|j| (0..n).map(move |i| at(i, j) + Vec3::z() * (0.3 * edge))).collect();
        Self { comm, n, starts, surface, slaves, reach: 2.0 * edge }
    }

    /// Boxes of the facets that this rank owns.
    fn boxes(&self) -> Vec<Bounds> {
        let (rank, width) = (self.comm.rank() as usize, self.n as u64 + 1);
        let corners = |k: u64| [k, k + 1, k + width + 1, k + width].map(|k| node(self.n, k, 0.0));
        let first =
            (self.starts[rank]..self.starts[rank + 1]).filter(|k| k % width + 1 < width && k / width + 1 < width);
        first.filter_map(|k| bounds(corners(k).into_iter())).collect()
    }

    /// Lets the surface follow its nodes at a time, for the first `count` slave nodes.
    fn follow(&mut self, count: usize, t: f64) {
        let (n, first) = (self.n, self.starts[self.comm.rank() as usize]);
        let place = |k: u32| node(n, first + u64::from(k), t);
        self.surface.follow(self.comm, &self.slaves[..count], self.reach, &BTreeSet::new(), place);
    }

    /// Prints a row: seconds on the processor, messages and patches of the ranks with most.
    fn measure(mut self) {
        let (comm, reach, count) = (self.comm, self.reach, self.slaves.len());
        let nodes = self.n * self.n;
        let times = (100_000 / nodes).max(1);
        let boxes = self.boxes();
        let begun = sent().messages;
        let search = timed(comm, times, |_| drop(recipients(comm, &boxes, &self.slaves, 3.0 * reach)));
        let messages = (sent().messages - begun) as f64 / times as f64;
        // Another number of slave nodes is a new question.
        let fetch = timed(comm, times, |k| self.follow(count - (times - 1 - k) % 2, 0.0));
        let begun = sent().messages;
        let iterate = timed(comm, times, |k| self.follow(count, 1e-6 * (k % 2) as f64));
        let messages_iterate = (sent().messages - begun) as f64 / times as f64;
        let shapes = self.surface.shapes();
        let mut found = Vec::new();
        let all = || self.slaves.iter().map(|x| shapes.closest(x, reach, None));
        let first = timed(comm, times, |_| found = all().collect());
        let project = timed(comm, times, |_| {
            for (x, last) in self.slaves.iter().zip(&found) {
                std::hint::black_box(shapes.closest(x, reach, last.map(|p| (p.patch, p.xi))));
            }
        });
        let mut most = [messages, messages_iterate, shapes.pieces().len() as f64];
        max(comm, &mut most);
        if comm.rank() == 0 {
            let [messages, messages_iterate, patches] = most;
            let seconds = [search, fetch, iterate, first, project].map(|s| format!("{s:.3e}")).join(",");
            println!("{},{nodes},{seconds},{messages},{messages_iterate},{patches}", comm.size());
        }
    }
}

/// Node `k` of the surface of n x n patches at a time.
fn node(n: usize, k: u64, t: f64) -> Vec3 {
    let [i, j] = [k as usize % (n + 1), k as usize / (n + 1)].map(|k| k as f64 / n as f64);
    wave(i, j, t)
}

fn patches(n: usize, smoothing: Smoothing) -> Vec<MovingPatch> {
    let count = ((n + 1) * (n + 1)) as u64;
    let facet = |k: usize| {
        let first = (k % n + (n + 1) * (k / n)) as u32;
        let up = first + n as u32 + 1;
        Facet { count: 4, nodes: [first, first + 1, up + 1, up], id: k as u64 }
    };
    let mesh = Mesh {
        points: (0..count).map(|k| node(n, k, 0.0).into()).collect(),
        point_ids: (0..count).collect(),
        facets: (0..n * n).map(facet).collect(),
        ..Mesh::default()
    };
    MovingPatch::all(&mesh, &(0..count).collect::<Vec<_>>(), smoothing, 40.0, &[], &Controls::default())
        .expect("a surface")
}

/// Seconds on the processor that work takes which is done so many times, of the rank with most.
fn timed(comm: &SimpleCommunicator, times: usize, mut work: impl FnMut(usize)) -> f64 {
    comm.barrier();
    let begun = on_processor();
    (0..times).for_each(&mut work);
    let mut seconds = [(on_processor() - begun) / times as f64];
    max(comm, &mut seconds);
    seconds[0]
}

/// Seconds that this process has had a processor, whatever else runs on the machine.
fn on_processor() -> f64 {
    let told = std::fs::read_to_string("/proc/self/schedstat").unwrap_or_default();
    told.split_whitespace().next().and_then(|ns| ns.parse().ok()).unwrap_or(f64::NAN) * 1e-9
}
