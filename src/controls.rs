//! The controls: every number that decides whether a solution is found, which one, or when it counts.
//!
//! Each is written once, below, with its unit or what it is relative to, its default, the range that makes sense, and its
//! reason: a source or a measurement. The expert table `[controls]` of a scene sets them by name; `log.txt` records all of
//! them. docs/controls.md has what half and twice of each does to the scenes in inputs/ (`scripts/studies/controls.py`).
//!
//! Not controls, and left where they are used, are
//!
//! - tolerances of rounding, by which equal numbers are seen to be equal, and ends of local iterations that go on to
//!   rounding: closest points, return mapping, enhanced modes;
//! - numbers of which half and twice did nothing in any scene, and which bound nothing that could go wrong: the sufficient
//!   decrease of the line search, slivers of increments, how far a slip origin or a mate may lie aside, samples of ways;
//! - numbers that cost time alone: margins of what is fetched, candidates of the sparsity pattern, which is built anew where
//!   it lacks some, leaves of search trees;
//! - the extension of patches ([`crate::surface::EXTENSION`]) and how far normals at ends may lean, which are part of what a
//!   surface is, and what CAD files are read by;
//! - tolerances of the linear solver: so tight that Newton's method goes the way that it goes with exact steps;
//! - limits by which warnings before a run are worded;
//! - what the user decides: `[solver]`, increments, penalties, feature angles.

/// What is known of a control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    pub group: &'static str,
    /// What the scene calls it.
    pub name: &'static str,
    /// Its unit, or what it is relative to.
    pub unit: &'static str,
    pub default: f64,
    /// The least and the largest value that it may have.
    pub range: [f64; 2],
    pub is_integer: bool,
    /// A source or a measurement.
    pub reason: &'static str,
}

impl Control {
    /// Whether it may have this value.
    pub fn admits(&self, value: f64) -> bool {
        let [low, high] = self.range;
        (low..=high).contains(&value) && (!self.is_integer || value.fract() == 0.0)
    }

    /// What it may be, in words.
    pub fn admitted(&self) -> String {
        let [low, high] = self.range;
        format!("{} from {low:?} to {high:?}", if self.is_integer { "an integer" } else { "a number" })
    }
}

/// A type of a control.
trait Number {
    const IS_INTEGER: bool;
    fn of(value: f64) -> Self;
    fn value(self) -> f64;
}

impl Number for f64 {
    const IS_INTEGER: bool = false;

    fn of(value: f64) -> Self {
        value
    }

    fn value(self) -> f64 {
        self
    }
}

impl Number for usize {
    const IS_INTEGER: bool = true;

    fn of(value: f64) -> Self {
        value as Self
    }

    fn value(self) -> f64 {
        self as f64
    }
}

/// Writes the struct, its defaults and its table from one list of `name: type = default, range, unit, reason`.
macro_rules! controls {
    ($($group:literal {
        $($name:ident: $kind:ident = $default:expr, [$low:expr, $high:expr], $unit:literal, $reason:literal;)*
    })*) => {
        /// The controls of a run; see [`Controls::TABLE`].
        ///
        /// ```
        /// use nagata::controls::Controls;
        ///
        /// let mut controls = Controls::default();
        /// assert!(controls.set("jump_tries", 4.0) && !controls.set("jump_tries", -1.0) && !controls.set("junp_tries", 4.0));
        /// assert_eq!(controls.jump_tries, 4);
        /// ```
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Controls {
            $($(
                #[doc = concat!($reason, " In: ", $unit, ".")]
                pub $name: $kind,
            )*)*
        }

        impl Default for Controls {
            fn default() -> Self {
                Self { $($($name: $default,)*)* }
            }
        }

        impl Controls {
            /// All of them, by groups.
            pub const TABLE: &'static [Control] = &[$($(Control {
                group: $group,
                name: stringify!($name),
                unit: $unit,
                default: $default as f64,
                range: [$low as f64, $high as f64],
                is_integer: <$kind as Number>::IS_INTEGER,
                reason: $reason,
            },)*)*];

            /// The value of a control; `None` if there is none of this name.
            pub fn get(&self, name: &str) -> Option<f64> {
                match name {
                    $($(stringify!($name) => Some(self.$name.value()),)*)*
                    _ => None,
                }
            }

            /// Sets a control. `false`, and nothing is set, if there is none of this name or it does not admit the value.
            pub fn set(&mut self, name: &str, value: f64) -> bool {
                let known = Self::TABLE.iter().find(|control| control.name == name);
                if !known.is_some_and(|control| control.admits(value)) {
                    return false;
                }
                match name {
                    $($(stringify!($name) => self.$name = Number::of(value),)*)*
                    _ => {}
                }
                true
            }
        }
    };
}

controls! {
    "newton" {
        settling_iterations: usize = 5, [1, 100], "iterations",
            "Iterations in which what touches sticks, at most. Two bring bodies along with a tool that turns, four where that strains them; contacts that open and close while all others stick may go to and fro for ever, and settle as soon as they may slip.";
        calm_flips: usize = 3, [1, 100], "changes in succession",
            "A node whose status or slip direction changes so often overshoots the friction cone from one side to the other: its friction penalty is reduced. The solution does not depend on it, only the path to it.";
        calm_factor: f64 = 0.1, [0.001, 0.9], "times the friction penalty",
            "By how much it is reduced each time.";
        calm_least: f64 = 1e-3, [1e-9, 1.0], "friction penalty over the augmentation",
            "A penalty below is not reduced further: slip directions turn the more slowly the lower it is.";
        step_facets: f64 = 1.5, [0.1, 100.0], "longest edge of the slave facets",
            "How far a slave node may move in one iteration: farther, and it may come out behind what it should meet.";
        step_halvings: usize = 6, [0, 60], "halvings",
            "How often a step that turns an element inside out is halved before it is taken even so, and the increment fails.";
        line_search_shortest: f64 = 0.01, [1e-6, 1.0], "shortest step over the full one",
            "When no step down to this one helps, the full step is taken.";
        line_search_memory: usize = 8, [1, 1000], "iterates",
            "The residual must fall below the largest of so many (Grippo, Lampariello and Lucidi 1986). It need not fall below the last one: where contact changes it rises on the way to a solution.";
        line_search_least: f64 = 0.1, [0.001, 0.25], "next step over the last",
            "Dennis and Schnabel 1983, algorithm A6.3.1.";
        line_search_most: f64 = 0.5, [0.25, 0.95], "next step over the last",
            "Dennis and Schnabel 1983, algorithm A6.3.1.";
        rounding: f64 = 64.0, [1.0, 1e6], "machine epsilons",
            "What rounding leaves of a sum of some ten products of three factors: no residual gets below.";
        rounding_cap: f64 = 1e-6, [1e-12, 1e-2], "force that acts on a body",
            "Above this share rounding excuses no residual, for it is what users take for exact: the run ends with the reason.";
        strained: f64 = 1.0, [1e-3, 1e3], "element forces over what they round to",
            "A body with more counts as strained; of one that is not they are some hundredths of it.";
        eased_share: f64 = 1e-4, [0.0, 1.0], "largest force so far",
            "Residuals are compared with this share of it as long as there is less: after a press of 1e6 N, 1 N is still right to 1e-8 at the default tolerance.";
        force_floor_share: f64 = 1e-6, [1e-14, 1e-2], "largest nodal stiffness times the element size",
            "The force that counts while nothing acts yet: far below any of interest, well above rounding. `force_floor` of the table `solver` replaces it.";
        loose_tolerance: f64 = 1e-3, [1e-10, 0.1], "residual over the largest force",
            "Enough to change an active set that is not the last one, or to end settling; measured to take four fifths of the iterations.";
        outer_rounds: usize = 60, [1, 10000], "rounds",
            "Most rounds of held multipliers, of active sets, and of constraints that are tightened. Each leaves a thousandth of the error with the automatic penalty and with `slack`, where it leads anywhere.";
        uzawa_tolerance: f64 = 100.0, [1.0, 1e6], "tolerance of Newton's method",
            "Automatic tolerance of Uzawa's method: penetration and slip of sticking nodes, times the largest nodal stiffness, over the largest force.";
        singular_residual: f64 = 1e-2, [1e-8, 1.0], "residual of the linear solution over its right-hand side",
            "A solution with more is none: the matrix counts as singular. What rounding leaves of less, 1e-6 to 1e-4 in sheets that are 300 to 1000 times as long as thick, the next iteration makes up for.";
        step_turn: f64 = 0.1, [1e-3, 0.5], "radians",
            "By how much an iteration may turn a tool that a torque drives: a sixth of what an increment may.";
    }
    "increments" {
        easy_iterations: usize = 6, [1, 1000], "iterations",
            "After no more the next increment may grow; after more, up to these that shrink it, to below what was shortened or failed last.";
        hard_iterations: usize = 10, [1, 1000], "iterations",
            "After more the next increment shrinks, unless that has saved too little: then length is not why.";
        increment_growth: f64 = 1.5, [1.0, 10.0], "times the increment",
            "How much an increment grows after an easy one, up to the scene's largest.";
        increment_cut: f64 = 0.5, [0.05, 0.9], "times the increment",
            "After a hard increment and the first failure; its square after the second; one over its square is how much longer the next jump is tried.";
        short_increment: f64 = 0.00390625, [1e-9, 1.0], "the scene's largest increment",
            "Below, a shorter one hardly serves, and a jump is tried: what sticks is then carried along by so little that the jump does not disturb its friction.";
        stability_checks: usize = 20, [1, 1000000], "judgements in a step",
            "Where friction makes the tangent unsymmetric stability takes a factorization more: in steps of so many increments in each, in longer ones as often, and where the determinant changes its sign. In each of 100 increments it takes half the time of a disk that turns in a plate, which solves with the factors of earlier increments.";
        busy_share: f64 = 0.25, [0.0, 1.0], "contact nodes",
            "Where more of those that bear change sides the next increment is not longer.";
        busy_turn: f64 = 0.3, [0.01, 10.0], "slip over the radius of curvature, radians",
            "Where a node slid farther, its path is no longer short against the radius and the next increment is not longer.";
        extrapolate: usize = 1, [0, 2], "0 never, 1 not for elastic bodies on facets, 2 always",
            "Between the facets of tools the solution of elastic bodies jumps: extrapolated, it would be sought on the facet that a node is about to leave. Flow is path-dependent anyway, and without extrapolation hardly gets on. Ironing with faceted fillets in 90 increments takes 13 % fewer iterations with 2, but other branches of the chatter: forces differ by up to 3 % in between.";
        extrapolate_farthest: f64 = 2.0, [0.1, 100.0], "the increments that it goes on from",
            "A short last increment, to a time of the grid, says too little of a long one: what it follows is then part of the base.";
        linger: f64 = 1e-4, [1e-8, 1.0], "largest nodal stiffness of the body",
            "Springs of the first stage that keep in place what comes loose: under them bodies keep their shape.";
        linger_fall: f64 = 0.01, [1e-6, 0.9], "of the springs",
            "The next stage begins where the last has ended, with springs so much weaker: a sheet is far softer in bending than its nodes are.";
        linger_stages: usize = 4, [1, 100], "stages",
            "Weaker ones would be lost among the roundings of a matrix. More of the last follow while each leaves no more than `linger_fall` of what was not in balance; what is not then is let go.";
        remedy_period: usize = 2, [1, 100], "failures",
            "An increment that fails is tried by turns: in plastic bodies with the last residual alone (`line_search_memory`) after the first failure of each period, with contacts that settle after its last. Neither serves both contacts that come and go and flow that overshoots.";
    }
    "jumps" {
        jump_drag: f64 = 0.1, [1e-6, 100.0], "largest nodal stiffness",
            "Drag of the first step of a jump: so much that its motion is small against the size of the structure.";
        jump_fall: f64 = 0.25, [0.01, 0.9], "times the drag",
            "How it falls after each step.";
        jump_rise: f64 = 8.0, [1.1, 1000.0], "times the drag",
            "How it rises after a step that failed: by more than it falls, or the same step would come back.";
        jump_negligible: f64 = 1e-4, [1e-12, 1.0], "largest nodal stiffness",
            "Below, the next step is without drag.";
        jump_useless: f64 = 1e-9, [1e-15, 1e-2], "largest nodal stiffness",
            "When a drag below has led nowhere, the jump has failed.";
        jump_strongest: f64 = 100.0, [1.0, 1e6], "largest nodal stiffness",
            "When a drag beyond fails, the jump has failed.";
        jump_steps: usize = 100, [1, 10000], "steps",
            "Most steps of a jump.";
        jump_iterations: usize = 7, [1, 1000], "iterations",
            "Most iterations of a step with drag: beyond, more drag is the shorter way.";
        jump_tries: usize = 2, [1, 100], "jumps",
            "Jumps that are tried at an increment where friction or flow make it depend on its length, each longer than the last. Where nothing does, they may become as long as an increment.";
        jump_weight: usize = 4, [1, 100], "increments",
            "Increments without a jump that make up for one.";
        jump_run: usize = 8, [1, 100], "jumps",
            "Jumps in succession that end the run: a path of little but jumps is none, for what lies between depends on the drag.";
    }
    "contact" {
        augmentation: f64 = 0.2, [1e-3, 10.0], "stiffness with which the slave node, or a softer master, resists contact",
            "Measured to be robust over loading, reversal and sliding. Above a few times the stiffness slipping nodes flip between opposite slips, far below it slip directions turn slowly. Twice and half change the number of iterations, and with it increments.";
        soft_augmentation: f64 = 0.01, [1e-6, 1.0], "augmentation",
            "Of an increment that has failed, and of those after it where that helped: slender bodies bend far more easily than what is around a node. A hook of 20 x 1 that snaps over a catch fails after 321 increments and 192 cuts without, and takes 124 and none with it; in ironing, where nothing fails, as low from the beginning would take 40 times the iterations.";
        central_gap: f64 = 1e-4, [1e-8, 0.1], "longest edge of the slave facets",
            "First stage of the central path: the gap that contacts have where forces are ε times it. A strip of 120 x 2 elements that is drawn by 10 mm between die, holder and punch, elastic and without friction, ended after 11 increments without the path, and takes 141 and 2456 iterations with it.";
        central_fall: f64 = 0.1, [1e-3, 0.9], "times the force of the stage before",
            "How θ falls from stage to stage: so far that each stage takes a few iterations. With 0.01 in three stages the strip takes as many.";
        central_stages: usize = 6, [1, 100], "stages",
            "Stages before the law itself. After six the gap that is left is 1e-9 of a facet, and the contacts are those of the solution but for a few.";
        uzawa_penalty: f64 = 1000.0, [1.0, 1e6], "the same stiffness",
            "Automatic penalty of Uzawa's method: Newton's method does not mind it, and each round divides the error by about as much.";
        penalty_method: f64 = 100.0, [1.0, 1e6], "the same stiffness",
            "Automatic penalty of the penalty method: penetrations of some hundredths of what the nodes around give way. It is part of the model that the user chooses with this method, and the result depends on it: twice and half change the forces of a cap on a block by 3e-3 and 5e-3.";
        touching_gap: f64 = 1e-4, [1e-12, 0.01], "longest edge of the slave facets",
            "A gap below is but rounding of a mesh file, and closed in the first iteration of a step, and an active set begins with it: a body that only a force drives would have no support otherwise. Further iterations see the gap as it is.";
        no_gap: f64 = 1e-9, [1e-15, 1e-6], "longest edge of the slave facets",
            "A gap below is none: a node no deeper behind a master is not behind it, and what closes such a gap may be lost in rounding.";
        slack: f64 = 1e-3, [1e-6, 0.1], "compliance over that of the automatic penalty",
            "Of constraints that give way: always in self-contact, where slave nodes that meet each other make the same condition twice. What is left of it when it is tightened there is an error: in the forces of the strip in inputs/ 2e-7 while it closes, up to 5e-4 where its legs are drawn along each other, and as much more as there is more of it. Half of it, or a third, costs the 54 strips of `wide_slack` 2.7 or 3.5 times the iterations, and 25 or 29 cuts instead of 6. With 3e-4 facets without friction slide off each other, tip from tip, long before they do with this; with 2e-3 nodes of the strip that meet each other are balanced on a point, and rounding decides to which side they slide.";
        slack_segments: f64 = 1e-2, [1e-6, 0.5], "compliance over that of the automatic penalty",
            "That of self-contact from segment to segment, where the conditions of both sides are means over unlike faces, and contradict each other by what the surface is off a smooth one. Half and twice change the forces of the strip in inputs/ by 1e-4 of the largest; with a tenth the strip of elements of a quarter of the size finds no increment as it is drawn without friction.";
        slack_left: f64 = 1e-3, [1e-9, 0.1], "forces on the nodes of a surface that meets itself",
            "What conditions that give way may leave of the forces when they are tightened no more, by what the last rounds have added. Without it sheets of a tenth of a facet bore 9 to 35 % too little from segment to segment and 2 % by nodes, and confined rubber with a Poisson's ratio of 0.499 25 %. Other scenes have less left after the first round.";
        wide_slack: f64 = 3e-2, [1e-6, 1.0], "compliance over that of the automatic penalty",
            "That of self-contact where Newton's method has failed. A strip that closes onto itself in 54 ways (faceted and smoothed, mu = 0, 0.2 and 1, in 10 to 40 increments): none fails, with 1e-3 after 1e-3 there are 36 cuts, with 1e-2 11, with this 6. It is taken back with `slack`, in two rounds; one round with itself left gaps of up to 2e-3 of a facet, and forces off by 4e-4.";
        two_pass_bulge: f64 = 0.99, [0.0, 1.0], "bulge of a Nagata patch",
            "Share of it that patches take with two passes, but where one side is hollow in the initial mesh and the other round. Smooth surfaces that share the whole of it may curve together without any node entering the other side: on flat faces the conditions of two passes would depend on each other: with all of it the patch test takes 11 iterations for 4, and is off by 4e-4. A shaft in its bore has the whole of it: with 99 % the nodal pressures of a press fit, 6 elements in 30 degrees over 12, alternated by 47 %. A dome on a slab has not: with the whole it takes three times the iterations, and comes to lean by 7e-3 of its force with a friction of 1.";
        repeat_distance: f64 = 0.05, [0.0, 0.45], "shortest edge of the master patch",
            "A slave node of a second pass that is nearer to a node of the master leaves the contact to that one, up to twice as far away while it is less than half as deep as `watch_deep`: the same condition twice would leave open how the two share the force.";
        creep: f64 = 1e-6, [1e-12, 1e-3], "friction force, with each longest edge of the slave facets that a node slips in an increment",
            "Of increments in which friction alone holds a body and all of it slips to both sides, as a ring that is crushed between two plates: where it is then only this tells. No node may slip by more than an edge, so that friction is off by no more than this share. Below 1e-9 rounding would tell.";
        drawn_least: f64 = 0.1, [0.001, 1.0], "friction force",
            "A node that tools or supports draw over its master slips along that way, and what of its friction is not across it is along it; so much at least, where an iteration finds all of it across, which leaves no way back.";
        friction_steep: f64 = 0.5, [0.0, 0.7], "share of a velocity that is normal to the contacts",
            "Below, friction is what holds a body: that of a wedge of 30 degrees. Dents of a soft body hold it a little without friction, too, but not against an iteration in which all slips; and what has lost its friction is let go, though it still touches.";
    }
    "segments" {
        segment_least: f64 = 0.1, [1e-6, 0.5], "area of the slave faces around a node, weighted by its shape functions",
            "A node of which no more lies over the master is in the gap: its condition would be that of its neighbour, at the end of the master. So contact ends a part of a facet earlier or later there: forces of a block that sinks into another differ by 8e-3 with half of it. Twice as much makes nodes come and go. One that touches stays until half of it is left.";
        segment_facing: f64 = -0.1, [-0.99, -1e-3], "cosine of the angle between the normals of a slave face and a master face",
            "Below, they look at each other. At 0 one is seen edge on, and the overlap has no area.";
        segment_settled: f64 = 100.0, [1e-3, 1e8], "tolerance of Newton's method",
            "Below, the points of segments between bodies stand still, and the tangent is exact from there. Found anew at the end, as after a restart, they change forces by some hundredths of this, no more than the tolerance. With 10,000 a dome of facets that is drawn to and fro with a friction of 5 leans by 2e-9 of its force, and an elastic indenter takes 3.4 iterations an increment instead of 4.6.";
        segment_stalled: f64 = 1e-3, [1e-14, 1e-2], "residual over the forces that it counts against",
            "The same where it is below this, and falls by less than half: points that come and go with the overlaps may carry it to and fro. Where it falls, but they have carried it back up so twice, they stay: else matching smooth tetrahedra go from 9e-8 to 1e-4 for ever.";
    }
    "kinks" {
        kink_gap: f64 = 1e-3, [0.0, 0.02], "shortest edge of a patch",
            "A node that iterations carry to and fro over a kink between patches, tools' or bodies', keeps to its side from then on, however slight the kink, while its gap there differs from that on the other side by no more: a tenth of what the watch takes for a penetration. Only such nodes do. One without friction in a hollow is held between both sides, so that no side's gap differs from their mean by more while all press it. When all did that crossed a kink, forces of shallow ironing were off by 4e-4 for it and those of the strip by 3e-3. A block that is drawn over an edge takes 73 increments with none, 64 with this.";
        kink_returns: usize = 2, [1, 100], "returns",
            "How often a node has come back to a patch within an increment when it counts as going to and fro; once, where the increment has failed before. Of 24 strips that close onto themselves none fails with 1 or 2, three with 3.";
        hand_over: f64 = 0.1, [0.0, 1.0], "longest edge of the slave facets",
            "A node that touched one master and is found behind another, no deeper and with much the same normal (`kink_turn`), has come over a joint from the one to the other, and not under it past its end: faces that lie flush, but sink differently under it. A higher one has a wall, over which nothing lifts it: with 0.25 a block climbs a step of 0.18 facets and gains the energy.";
        kink_turn: f64 = 0.1, [0.0, 0.5], "1 - cosine of the angle between the normals of both sides",
            "Beyond, 26 degrees, both sides are not of one surface that is smooth but for its patches, and what is on either side is another contact.";
        even_turn: f64 = 0.234, [0.0, 0.5], "1 - cosine of the angle between the normals of both sides",
            "Beyond, 40 degrees, as where an edge is sharp by default (`feature_angle`), pieces between which a node is exactly are not of one surface, and it is on one of them, unless it looks at both aslant. What iterations fold counts, too: with 0.1 a dome of facets that goes to and fro over a slab, in two passes without friction, leans by 3 % of its force.";
        edge_aside: f64 = 1e-3, [0.0, 0.02], "longest edge of the slave facets",
            "A node so little past a sharp edge of a side that it was on is still on it: so exact are the places of meshes and the iterates of nodes that stick. A platen that is as wide as the block that it presses would lose the nodes of the rim to rounding, a third of the force.";
        edge_beside: f64 = 0.5, [0.0, 2.0], "patch parameters",
            "How far beyond a sharp edge of a body a patch is used.";
    }
    "search" {
        reach_facets: f64 = 2.0, [0.5, 100.0], "longest edge of the slave facets",
            "How far a slave node may be from the master and still be watched, where the scene does not say. A node that moves farther than that widens it.";
        reach_farther: f64 = 1.5, [1.0, 10.0], "way of the farthest slave node",
            "The reach after a node moved farther than it: more than its way, so that the same solution fits.";
    }
    "self_contact" {
        self_facing: f64 = 60.0, [5.0, 89.0], "degrees",
            "What meets looks back: the angle between the normal of a node and the opposite of that of the patch, at most. Sides of a fold that closes are nearly opposite, patches around a bend are not.";
        self_thick: f64 = 8.0, [1.0, 1000.0], "longest edge",
            "Thickness up to which sheets are measured: no search looks deeper into a thicker one.";
        self_depth: f64 = 0.5, [0.05, 0.95], "thickness of the sheet",
            "A node deeper below a patch is on the other side of its sheet: what comes from either side is told apart best in the middle.";
        self_step: f64 = 0.5, [0.05, 10.0], "depth that `self_depth` allows",
            "How far a node may go in one iteration without a danger of coming out on the other side of a sheet.";
    }
    "watch" {
        watch_deep: f64 = 0.01, [1e-6, 1.0], "longest edge of the slave facets",
            "From there a penetration is one. Contact is at nodes: between them a facet that touches a radius of ten of its lengths is 1/80 of its length inside, and no finer is the shape of the body known.";
        watch_segment: f64 = 0.25, [1e-6, 1.0], "longest edge of the slave facets",
            "The same on top of `watch_deep` from segment to segment, where gaps are closed in the mean around a node: beside a radius or an end of the master that is no larger than a facet its nodes may be so deep.";
        watch_unfelt: f64 = 1e-4, [1e-9, 1.0], "longest edge of the slave facets",
            "Nodes that are deeper at the end of the last step in a master that segments never felt end the run: coordinates of mesh files are as exact as that. At the end of other steps, and where it has been felt and eased, it is `watch_deep`, and what would push them out half of what it has borne.";
        watch_let_in: f64 = 0.1, [0.01, 1e6], "how far both sides have given way",
            "A master that is sharper than the facets is in the slave where nodes do not feel it: between them, and from segment to segment at nodes whose gaps are closed in the mean. If it is deeper than this when the contact bears its largest force, with what other contacts of its bodies let in, and to push the slave out, each node as stiff as the surface around it, would take more than half of that, it is told of at the end: forces lack about as much. Twice the energy of both bodies over the force is how far they have given way.";
        watch_between: f64 = 0.2, [0.01, 10.0], "size of the slave facet",
            "A master that is deeper in the slave between its nodes is told of at the end. The size is the diagonal where a node of the facet touches, else the edge of a square of its area, of a layer its length. A facet of the slave whose nodes are on a ball of its own size is 1/4 of its edge inside, and one that bends by a right angle at the edge of a punch as much.";
        watch_between_most: f64 = 0.5, [0.01, 10.0], "size of the slave facet",
            "The same, deeper than this, ends the run: what is between nodes is larger than what they feel.";
        watch_yields: f64 = 1e-3, [1e-6, 1.0], "longest edge of the slave facets",
            "Nodes that leave the contact to one of the other side (`repeat_distance`), and are deeper in the master, are told of at the end: nothing pushes them out. In a random scene with two passes 4e-3 are 0.6 % of the force.";
        watch_slid: f64 = 0.1, [1e-3, 1.0], "force of the contact",
            "Nodes that slide off the end of a master in an increment with more of its force are told of at the end: a facet that still reaches over the end feels it no more. One row of ten leaves a block of ten with a tenth.";
        watch_shared: f64 = 0.1, [1e-3, 1.0], "force of the contact",
            "Nodes that several tools hold by friction at once, and that bear more of it, are told of at the end: what each tool bears of them is left open. Two rows of ten that meet in a corner share a tenth.";
        watch_hooked: f64 = 0.1, [1e-3, 1.0], "force of the contact",
            "Nodes that are held by a side which they do not look at, as by the wall of a sharp punch that is drawn along, end the run where their forces, less what is in balance among them, are more: where single nodes happen to stand decides it. Frictionless on a flat it is nine tenths where nothing is right.";
        watch_aside: f64 = 0.1, [1e-3, 1e6], "largest force of the contact",
            "Sides that are more than 15 degrees off all that is between the normals of the facets around a node push it aside: if ever by more than this, less what is in balance among nodes that touch side by side, it is told of at the end. A sharp edge does that to the nodes beside it. In 330 scenes whose forces are right it is 0 in nearly all, and 0.03 to 0.16 on coarse facets over small radii.";
        watch_aside_most: f64 = 0.3, [1e-3, 1e6], "largest force of the contact",
            "The same, more than this, and the run ends with an error: of forces that were up to 20 times too large, and of energy from nothing, it was 0.36 to 0.9.";
        watch_unpaid: f64 = 1.5, [0.01, 1e6], "what loads, supports and tools can have given",
            "Elastic energy that an increment gains beyond this is told of where friction may hold what supports do not: no way leads to such a state. Their largest forces at both ends of an increment over its way are more than what they give, but for those that rise and fall within it.";
        watch_pushed: f64 = 0.5, [0.0, 1.0], "cosine of the angle between the friction on a node and its way",
            "Beyond, friction pushes a node that slips on a tool along, where it must resist, and the increment is none: 30 degrees either way of across, for a way is the chord of its path.";
        watch_opposed: f64 = -0.99, [-1.0, -0.5], "cosine of the angle between normals of sides of two masters",
            "At most, where a node is, they lie on each other, as pieces of one tool do, and a node that one holds is in the seam, which ends the increment: 8 degrees are more than facets of both sides of a curved seam turn against each other.";
        watch_inward: f64 = -0.5, [-1.0, 0.0], "cosine of the angle between the normal of a contact and that of the slave outwards",
            "At most, the surface of the slave looks at what holds it, as a sheet does between two tools, which are as near to each other as pieces of one, and the node is in no seam.";
        watch_mirror: f64 = 1e-3, [1e-9, 1.0], "extent of the body across the plane",
            "How far a body may come beyond a plane of symmetry: more than rounding; what a penalty lets through that holds it off is added.";
        watch_lift: f64 = 0.1, [1e-3, 1.0], "longest edge of the slave facets",
            "Lift of the way of a node: by so much it may cut a corner. What turns more in one increment than its chord and this lift allow is no longer followed by it.";
        watch_along: f64 = 0.5, [0.0, 0.99], "cosine of the turn of the normal",
            "Up to there a way along the surface is taken for one without looking.";
        watch_turn: f64 = 0.0873, [0.001, 0.5], "radians",
            "Turn of a tool, 5 degrees, of which a node's way in its frame is taken for straight.";
        watch_step: f64 = 0.01, [1e-4, 1.0], "longest edge of the slave facets",
            "Shortest step along a way.";
        watch_steps: usize = 10000, [10, 100000000], "steps along a way",
            "A node that takes more of them in an increment, close along the master by some thousand facets, is not followed, and the increment fails: no node may go through a wall unseen, and no watch on for ever.";
        watch_mates: f64 = 1.0, [0.01, 100.0], "longest edge of the slave facets",
            "A node that bears from node to node and has slid farther from the other one ends the run: another node is nearer. A tenth, as far as they may begin apart, is told of at the end.";
        watch_around: f64 = 2.0, [0.5, 100.0], "longest edge of the slave facets",
            "How far the watch looks, besides `watch_farther`.";
        watch_around_self: f64 = 1.0, [0.5, 100.0], "longest edge of the slave facets",
            "The same in self-contact, where no way is followed: what is within a facet is enough.";
        watch_farther: f64 = 1.5, [1.0, 100.0], "way of the farthest slave node",
            "How far the watch looks: a way is seen from its end, with all that is as near to it as half its length.";
    }
    "normals" {
        end_corner: f64 = 150.0, [10.0, 180.0], "degrees",
            "Facets around a node at an end of the surface that fill a smaller angle are at a corner, and follow the others: half a turn less what a kink of 30 degrees in the end takes away.";
        end_around: f64 = 270.0, [181.0, 360.0], "degrees",
            "Facets that fill a larger angle see the surface all around, and their mean needs no extrapolation.";
        coplanar: f64 = 0.02, [1e-6, 0.5], "turn at the junction",
            "A turn that is this small beside the one at the junction counts as none.";
        straight_misfit: f64 = 0.2, [0.0, 10.0], "misfit of the normal of the straight side",
            "Where mean normals carry the curvature on so much better, they stay: the middle of an S-bend.";
        straight_depth: f64 = 3.0, [1.5, 1e6], "depth of the facet beside",
            "A facet that is so much deeper than the next one across a smooth edge may be a flat beside a fillet, as CAD programs write them: it is, where its normal fits the fillet by less than `straight_misfit` of what the mean is off. On arcs of unequal facets the mean fits.";
    }
}

impl Controls {
    /// Names, values and defaults of those that differ from their defaults.
    pub fn changed(&self) -> impl Iterator<Item = (&'static str, f64, f64)> + '_ {
        let values = Self::TABLE.iter().filter_map(|c| Some((c.name, self.get(c.name)?, c.default)));
        values.filter(|(_, value, default)| value != default)
    }

    /// All of them for the log: a line for each group, those that differ from their defaults with these.
    pub fn describe(&self) -> String {
        let mut text = "controls:".to_string();
        let mut group = "";
        for control in Self::TABLE {
            if control.group != group {
                group = control.group;
                text += &format!("\n  {group}:");
            }
            let value = self.get(control.name).unwrap_or(control.default);
            let short = |value: f64| if control.is_integer { format!("{value}") } else { format!("{value:?}") };
            text += &format!(" {} = {}", control.name, short(value));
            if value != control.default {
                text += &format!(" (changed from {})", short(control.default));
            }
            text.push(',');
        }
        text.replace(",\n", "\n").trim_end_matches(',').to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_control_has_a_name_a_range_and_a_reason_of_its_own() {
        for (k, control) in Controls::TABLE.iter().enumerate() {
            let Control { name, unit, reason, .. } = control;
            assert!(Controls::TABLE[..k].iter().all(|other| other.name != *name), "{name}");
            assert!(control.admits(control.default), "{name}");
            assert!(!unit.is_empty() && reason.len() > 20 && reason.ends_with('.'), "{name}");
            assert_eq!(Controls::default().get(name), Some(control.default));
        }
    }

    #[test]
    fn controls_are_set_by_name_within_their_ranges() {
        for control in Controls::TABLE {
            let mut controls = Controls::default();
            let [low, high] = control.range;
            for value in [low, high] {
                assert!(controls.set(control.name, value), "{}", control.name);
                assert_eq!(controls.get(control.name), Some(value));
            }
            for value in [low - 1.0, high + 1.0, f64::NAN] {
                assert!(!controls.set(control.name, value), "{}", control.name);
            }
            assert_eq!(controls.set(control.name, low + 0.5), control.admits(low + 0.5));
            assert_eq!(controls.get("no such control"), None);
        }
        assert!(!Controls::default().set("no such control", 1.0));
    }

    /// The documentation has a row for each control, with its default and its reason.
    #[test]
    fn the_documentation_has_all_controls() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/controls.md");
        let text = std::fs::read_to_string(path).unwrap();
        let rows: Vec<Vec<&str>> = (text.lines().filter(|line| line.starts_with("| `")))
            .map(|line| line.trim_matches(['|', ' ']).split(" | ").collect())
            .collect();
        assert_eq!(rows.len(), Controls::TABLE.len());
        for (row, control) in rows.iter().zip(Controls::TABLE) {
            assert_eq!((row[0].trim_matches('`'), row[1].parse()), (control.name, Ok(control.default)));
            assert_eq!((row[2], row[3]), (control.unit, control.reason), "{}", control.name);
        }
    }

    #[test]
    fn what_was_changed_is_marked() {
        let mut controls = Controls::default();
        assert!(controls.changed().next().is_none() && !controls.describe().contains("changed"));
        assert!(controls.set("jump_drag", 0.2) && controls.set("outer_rounds", 30.0));
        let changed: Vec<_> = controls.changed().collect();
        assert_eq!(changed, [("outer_rounds", 30.0, 60.0), ("jump_drag", 0.2, 0.1)]);
        let text = controls.describe();
        assert!(text.contains("\n  jumps: jump_drag = 0.2 (changed from 0.1), jump_fall = 0.25,"), "{text}");
        assert!(text.contains(" outer_rounds = 30 (changed from 60),") && text.lines().count() == 11, "{text}");
    }
}
