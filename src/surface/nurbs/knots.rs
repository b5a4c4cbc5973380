//! Knot vectors and their B-splines.
//!
//! The p+1 B-splines of degree p that are not zero on the span [t_k, t_k+1) come from those of degree p-1 by the
//! recursion (43), together with their derivatives N'_i,p = p [N_i,p-1/(t_i+p - t_i) - N_i+1,p-1/(t_i+p+1 - t_i+1)]
//! (Piegl and Tiller, The NURBS Book, 1997, algorithms A2.1 to A2.3).

/// The highest degree; CAD systems stop at 25.
pub const MAX_DEGREE: usize = 64;

/// Degrees below this are evaluated in less scratch space.
const USUAL: usize = 10;

/// Fails unless 1 <= `degree` <= [`MAX_DEGREE`].
pub fn check_degree(degree: usize) -> Result<(), String> {
    match degree {
        1..=MAX_DEGREE => Ok(()),
        _ => Err(format!("the degree is {degree}, but must be 1 to {MAX_DEGREE}")),
    }
}

/// A degree p and non-decreasing knots t_0, t_1, ...; n+p+1 knots belong to n control points and the domain is
/// [t_p, t_n]. The outer knots may lie beyond it (unclamped, periodic).
#[derive(Clone, Debug, PartialEq)]
pub struct KnotVector {
    degree: usize,
    knots: Vec<f64>,
}

impl KnotVector {
    /// Fails unless the knots are finite, non-decreasing, at least 2 degree + 2, and not all of the domain one point. A
    /// knot may occur `degree` times inside the domain, where the curve then has a corner, once more elsewhere.
    pub fn new(degree: usize, knots: Vec<f64>) -> Result<Self, String> {
        check_degree(degree)?;
        if knots.len() / 2 <= degree {
            return Err(format!("{} knots are not enough for degree {degree}: 2 (degree + 1) at least", knots.len()));
        }
        if let Some(k) = knots.iter().position(|t| !t.is_finite()) {
            return Err(format!("knot {} is {}, not a finite number", k + 1, knots[k]));
        }
        if let Some(k) = knots.windows(2).position(|pair| pair[1] < pair[0]) {
            return Err(format!("knot {} ({}) is less than the one before ({})", k + 2, knots[k + 1], knots[k]));
        }
        if !(knots[knots.len() - 1] - knots[0]).is_finite() {
            return Err(format!("the knots run from {} to {}, too far", knots[0], knots[knots.len() - 1]));
        }
        let vector = Self { degree, knots };
        let [start, end] = vector.domain();
        if start == end {
            return Err(format!("the domain of the knots is the single point {start}"));
        }
        for same in vector.knots.chunk_by(|a, b| a == b) {
            let inside = start < same[0] && same[0] < end;
            let most = if inside { degree } else { degree + 1 };
            if same.len() > most {
                let place = if inside { " inside the domain" } else { "" };
                let (t, count) = (same[0], same.len());
                return Err(format!("knot {t} occurs {count} times; degree {degree} allows {most}{place}"));
            }
        }
        Ok(vector)
    }

    /// The knots of one Bézier piece on [0, 1], of a degree from 1 to [`MAX_DEGREE`].
    pub fn bezier(degree: usize) -> Self {
        Self::pieces(degree.clamp(1, MAX_DEGREE), &[0.0, 1.0])
    }

    /// The knots of Bézier pieces between `breaks`, which increase.
    pub(super) fn pieces(degree: usize, breaks: &[f64]) -> Self {
        let last = breaks.len() - 1;
        let copies = |k: usize| if k == 0 || k == last { degree + 1 } else { degree };
        Self { degree, knots: (0..=last).flat_map(|k| std::iter::repeat_n(breaks[k], copies(k))).collect() }
    }

    /// The degree p.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// All knots, in order.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// Number of control points.
    pub fn count(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// Lowest and highest parameter.
    pub fn domain(&self) -> [f64; 2] {
        [self.knots[self.degree], self.knots[self.count()]]
    }

    /// How many knots are equal to `t`.
    pub fn multiplicity(&self, t: f64) -> usize {
        self.knots.iter().filter(|knot| **knot == t).count()
    }

    /// The k with t_k <= `t` < t_k+1 in the domain; the last span at its end, the first or last one beyond it.
    pub fn span(&self, t: f64) -> usize {
        let [start, end] = self.domain();
        let t = t.max(start);
        self.knots.partition_point(|knot| if t < end { *knot <= t } else { *knot < end }) - 1
    }

    /// The span that `t`, a parameter of the domain, is inside or at the end of.
    pub(super) fn span_before(&self, t: f64) -> usize {
        self.knots.partition_point(|knot| *knot < t).max(self.degree + 1) - 1
    }

    /// The intervals between different knots of the domain, in order.
    pub fn spans(&self) -> impl Iterator<Item = [f64; 2]> {
        let inner = &self.knots[self.degree..=self.count()];
        inner.windows(2).filter(|pair| pair[0] < pair[1]).map(|pair| [pair[0], pair[1]])
    }

    /// Values, first and second derivatives at `t` of the p+1 B-splines that are not zero there, into `splines` of that
    /// length; returns the number of the first. Outside the domain the polynomials of the nearest span go on.
    pub fn basis(&self, t: f64, splines: &mut [[f64; 3]]) -> usize {
        let span = self.span(t);
        splines[0] = [1.0, 0.0, 0.0];
        for degree in 1..=self.degree {
            let mut carried = [0.0; 3];
            for (j, spline) in splines[..degree].iter_mut().enumerate() {
                let (low, high) = (self.knots[span + 1 + j - degree], self.knots[span + 1 + j]);
                let [value, first, _] = spline.map(|b| b / (high - low));
                let slope = degree as f64 * value;
                let curvature = degree as f64 * first;
                *spline = [carried[0] + (high - t) * value, carried[1] - slope, carried[2] - curvature];
                carried = [(t - low) * value, slope, curvature];
            }
            splines[degree] = carried;
        }
        span - self.degree
    }

    /// The knots mapped so that the domain runs from `a` to `b`; in reverse order when `b` is less than `a`.
    pub(super) fn onto(&self, [a, b]: [f64; 2]) -> Self {
        let [start, end] = self.domain();
        let scale = (b - a) / (end - start);
        let image = |t: &f64| if t - start < end - t { a + (t - start) * scale } else { b - (end - t) * scale };
        let mut knots: Vec<f64> = self.knots.iter().map(image).collect();
        if scale < 0.0 {
            knots.reverse();
        }
        // Rounding may have exchanged two that are next to the middle.
        for k in 1..knots.len() {
            knots[k] = knots[k].max(knots[k - 1]);
        }
        Self { degree: self.degree, knots }
    }

    /// Knots of the parts of a curve before and behind `t`, a parameter inside the domain.
    pub(super) fn split(&self, t: f64) -> [Self; 2] {
        let ends = vec![t; self.degree + 1];
        let before = [&self.knots[..=self.span_before(t)], &ends].concat();
        let behind = [&ends, &self.knots[self.span(t) + 1..]].concat();
        [before, behind].map(|knots| Self { degree: self.degree, knots })
    }
}

/// Runs `work` with scratch space for the basis functions of two directions, on the stack.
pub fn with_scratch<R>([p, q]: [usize; 2], work: impl FnOnce(&mut [[f64; 3]], &mut [[f64; 3]]) -> R) -> R {
    if p < USUAL && q < USUAL {
        work(&mut [[0.0; 3]; USUAL][..=p], &mut [[0.0; 3]; USUAL][..=q])
    } else {
        work(&mut [[0.0; 3]; MAX_DEGREE + 1][..=p], &mut [[0.0; 3]; MAX_DEGREE + 1][..=q])
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::knot_vectors;
    use super::*;
    use proptest::prelude::*;

    fn basis(knots: &KnotVector, t: f64) -> (usize, Vec<[f64; 3]>) {
        let mut splines = vec![[f64::NAN; 3]; knots.degree() + 1];
        (knots.basis(t, &mut splines), splines)
    }

    /// Sums over the splines at `t` of `coefficient` times value, first and second derivative.
    fn sums(knots: &KnotVector, t: f64, coefficient: impl Fn(&[f64]) -> f64) -> [f64; 3] {
        let (first, splines) = basis(knots, t);
        let p = knots.degree();
        let of = |i: usize| coefficient(&knots.knots()[i + 1..=i + p]);
        std::array::from_fn(|k| splines.iter().enumerate().map(|(j, spline)| spline[k] * of(first + j)).sum())
    }

    /// Spline i of degree p by (43) as printed, with 0/0 = 0.
    fn cox_de_boor(t: &[f64], i: usize, p: usize, x: f64) -> f64 {
        let ratio = |a: f64, b: f64| if b == 0.0 { 0.0 } else { a / b };
        if p == 0 {
            return if t[i] <= x && x < t[i + 1] { 1.0 } else { 0.0 };
        }
        ratio(x - t[i], t[i + p] - t[i]) * cox_de_boor(t, i, p - 1, x)
            + ratio(t[i + p + 1] - x, t[i + p + 1] - t[i + 1]) * cox_de_boor(t, i + 1, p - 1, x)
    }

    /// Marsden's identity: with the mean and the mean product of pairs of its p knots, splines sum to t and t^2.
    fn check_reproduction(knots: &KnotVector, t: f64, tolerance: f64) {
        let p = knots.degree() as f64;
        let h = knots.spans().find(|[_, end]| t <= *end).map_or(1.0, |[start, end]| end - start);
        let near = |sums: [f64; 3], truth: [f64; 3]| {
            for k in 0..3 {
                let error = (sums[k] - truth[k]).abs() * (h / p).powi(k as i32);
                assert!(error < tolerance, "derivative {k} at {t}: {error:e}");
            }
        };
        near(sums(knots, t, |_| 1.0), [1.0, 0.0, 0.0]);
        near(sums(knots, t, |inner| inner.iter().sum::<f64>() / p), [t, 1.0, 0.0]);
        if knots.degree() > 1 {
            let pairs = |inner: &[f64]| inner.iter().sum::<f64>().powi(2) - inner.iter().map(|t| t * t).sum::<f64>();
            near(sums(knots, t, |inner| pairs(inner) / (p * (p - 1.0))), [t * t, 2.0 * t, 2.0]);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(100))]
        #[test]
        fn splines_are_those_of_the_recursion_and_reproduce_polynomials(knots in knot_vectors(), s in 0.0..1.0_f64) {
            let [start, end] = knots.domain();
            let t = start + s * (end - start);
            let (first, splines) = basis(&knots, t);
            for i in 0..knots.count() {
                let truth = if (first..=first + knots.degree()).contains(&i) { splines[i - first][0] } else { 0.0 };
                prop_assert!((cox_de_boor(knots.knots(), i, knots.degree(), t) - truth).abs() < 1e-14);
            }
            prop_assert!(splines.iter().all(|spline| spline[0] >= 0.0));
            for t in [start, t, end] {
                check_reproduction(&knots, t, 1e-12);
            }
        }

        #[test]
        fn spans_hold_their_parameters(knots in knot_vectors(), s in -0.2..1.2_f64) {
            let [start, end] = knots.domain();
            let t = start + s * (end - start);
            let k = knots.span(t);
            let [low, high] = [knots.knots()[k], knots.knots()[k + 1]];
            prop_assert!(low < high && start <= low && high <= end);
            prop_assert!(t < start && low == start || t >= end && high == end || low <= t && t < high);
            let spans: Vec<_> = knots.spans().collect();
            prop_assert_eq!(spans[0][0], start);
            prop_assert_eq!(spans[spans.len() - 1][1], end);
            prop_assert!(spans.windows(2).all(|pair| pair[0][1] == pair[1][0]));
            prop_assert!(spans.iter().all(|[low, _]| knots.knots()[knots.span(*low)] == *low));
        }

        #[test]
        fn mapped_knots_are_in_order_and_keep_their_multiplicities(knots in knot_vectors(), a in -3.0..3.0_f64) {
            for ends in [[a, a + 0.7], [a + 0.7, a]] {
                let mapped = knots.onto(ends);
                prop_assert!(KnotVector::new(mapped.degree(), mapped.knots().to_vec()).is_ok());
                prop_assert_eq!(mapped.domain(), [a, a + 0.7]);
                prop_assert_eq!(mapped.spans().count(), knots.spans().count());
            }
            let [start, end] = knots.domain();
            let back = knots.onto([end, start]).onto([end, start]);
            prop_assert!(back.knots().iter().zip(knots.knots()).all(|(a, b)| (a - b).abs() < 1e-14));
        }
    }

    #[test]
    fn high_degrees_and_near_knots_keep_their_digits() {
        let mut inner: Vec<f64> = (1..12).map(|k| (k as f64 * 0.37).sin().abs()).collect();
        inner.sort_by(f64::total_cmp);
        let knots = KnotVector::new(25, [vec![0.0; 26], inner, vec![1.0; 26]].concat()).unwrap();
        for k in 0..=50 {
            check_reproduction(&knots, k as f64 / 50.0, 1e-12);
        }
        let near = vec![0.5, 0.5 + 1e-15, 0.5 + 1e-13, 0.5 + 1e-13];
        let knots = KnotVector::new(3, [vec![0.0; 4], near, vec![1.0; 4]].concat()).unwrap();
        for t in [0.0, 0.3, 0.5 - 1e-14, 0.5, 0.5 + 5e-16, 0.5 + 5e-14, 0.7, 1.0] {
            let (_, splines) = basis(&knots, t);
            assert!((splines.iter().map(|spline| spline[0]).sum::<f64>() - 1.0).abs() < 1e-15);
            assert!(splines.iter().all(|spline| (0.0..=1.0).contains(&spline[0])));
        }
    }

    #[test]
    fn beyond_the_domain_the_polynomial_goes_on() {
        let knots = KnotVector::new(2, vec![-0.5, 0.0, 0.0, 1.0, 2.0, 2.0, 2.5]).unwrap();
        assert_eq!((knots.domain(), knots.count()), ([0.0, 2.0], 4));
        for t in [-0.3, 2.3] {
            check_reproduction(&knots, t, 1e-14);
        }
        assert_eq!((knots.span(f64::NAN), knots.span(-9.0), knots.span(9.0)), (2, 2, 3));
        assert_eq!((knots.multiplicity(0.0), knots.multiplicity(0.7)), (2, 0));
    }

    #[test]
    fn wrong_knots_are_explained() {
        let fails = |degree: usize, knots: &[f64], what: &str| {
            let message = KnotVector::new(degree, knots.to_vec()).unwrap_err();
            assert!(message.contains(what), "{message}");
        };
        fails(0, &[0.0, 1.0], "degree is 0");
        fails(usize::MAX, &[0.0, 1.0], "1 to 64");
        fails(2, &[0.0, 0.0, 0.0, 1.0, 1.0], "5 knots are not enough for degree 2");
        fails(1, &[0.0, 0.0, f64::NAN, 1.0], "knot 3 is NaN");
        fails(1, &[0.0, 0.5, 0.4, 1.0], "knot 3 (0.4) is less");
        fails(1, &[-1e308, 0.0, 1.0, 1e308], "too far");
        fails(1, &[0.0, 1.0, 1.0, 2.0], "single point 1");
        fails(1, &[0.0, 0.0, 0.5, 0.5, 1.0, 1.0], "knot 0.5 occurs 2 times; degree 1 allows 1 inside");
        fails(1, &[0.0, 0.0, 0.0, 1.0, 1.0], "knot 0 occurs 3 times; degree 1 allows 2");
    }
}
