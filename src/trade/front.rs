//! Who is beaten by nobody.

/// Of pairs of cost and error, those that no other pair beats, which costs no more and errs no more, and one of them less:
/// the Pareto front. Pairs that are not finite are not on it; of equal pairs all are.
pub fn front(pairs: &[(f64, f64)]) -> Vec<bool> {
    let beats = |a: &(f64, f64), b: &(f64, f64)| a.0 <= b.0 && a.1 <= b.1 && (a.0 < b.0 || a.1 < b.1);
    let finite = |p: &&(f64, f64)| p.0.is_finite() && p.1.is_finite();
    pairs.iter().map(|p| finite(&p) && !pairs.iter().filter(finite).any(|other| beats(other, p))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_front_falls_from_the_cheap_to_the_exact() {
        let pairs = [(1.0, 9.0), (2.0, 9.0), (2.0, 4.0), (3.0, 4.5), (5.0, 1.0), (5.0, 2.0), (9.0, 1.0)];
        assert_eq!(front(&pairs), [true, false, true, false, true, false, false]);
    }

    #[test]
    fn equals_stand_together_and_what_failed_stands_nowhere() {
        assert_eq!(front(&[(1.0, 1.0), (1.0, 1.0), (f64::NAN, 0.0), (0.5, f64::NAN)]), [true, true, false, false]);
        assert!(front(&[]).is_empty());
    }

    proptest! {
        /// Whoever is not on the front is beaten by one who is, and those on it fall.
        #[test]
        fn a_front_beats_all_others(pairs in prop::collection::vec((0u8..20, 0u8..20), 1..40)) {
            let pairs: Vec<(f64, f64)> = pairs.into_iter().map(|(a, b)| (a.into(), b.into())).collect();
            let on = front(&pairs);
            let mut best: Vec<_> = pairs.iter().zip(&on).filter(|(_, on)| **on).map(|(p, _)| *p).collect();
            for (p, on) in pairs.iter().zip(&on) {
                let beaten = best.iter().any(|b| b.0 <= p.0 && b.1 <= p.1 && b != p);
                prop_assert_eq!(*on, !beaten);
            }
            best.sort_by(|a, b| a.0.total_cmp(&b.0));
            best.dedup();
            prop_assert!(best.windows(2).all(|w| w[0].0 < w[1].0 && w[0].1 > w[1].1));
        }
    }
}
