//! Which settings are combined once each has been tried by itself.

use super::Made;
use super::errors::{Errors, Quantity};
use super::history::largest;
use super::plan::Variant;

/// What decides: quantities that users ask for.
fn decides(of: &Quantity) -> bool {
    use Quantity::*;
    matches!(of, Force | EndForce | Displacement | Pressure | Stress | Strain)
}

/// Errors of a run over those of the scene as it is, neither below what the reference can tell; the largest over quantities.
/// Infinite when it has none.
fn growth(errors: &Errors, base: &Errors, floor: &Errors) -> f64 {
    let ratios = Quantity::ALL.iter().filter(|of| decides(of)).filter_map(|&of| {
        let least = floor.get(of).unwrap_or(0.0).max(f64::MIN_POSITIVE);
        Some(errors.get(of)?.max(least) / base.get(of)?.max(least))
    });
    largest(ratios).filter(|growth| !growth.is_nan()).unwrap_or(f64::INFINITY)
}

/// Wall time from which a setting is no cheaper, over that of the scene as it is.
const CHEAPER: f64 = 0.97;

/// By how much errors may grow: hardly, and in the large.
const GROWTHS: [(&str, f64); 2] = [("combined: as accurate", 1.25), ("combined: rough", 4.0)];

/// What a setting that lowers errors may cost, and how far it must lower the largest of them.
const DEARER: f64 = 4.0;
const LOWER: f64 = 0.9;

/// Of each setting the cheapest way that leaves all errors nearly as they are, or lets them grow a little; and of each the way
/// that lowers all errors most. `runs[0]` is the scene as it is; errors are as in `errors`, `None` of runs that failed, and
/// `floor` is what the reference can tell.
pub fn combinations(runs: &[Made], errors: &[Option<Errors>], floor: &Errors) -> Vec<Variant> {
    let (Some(base), Some(Some(base_errors))) = (runs.first().and_then(|run| run.cost()), errors.first()) else {
        return Vec::new();
    };
    let singles: Vec<(&Variant, f64, f64)> = (runs.iter().zip(errors))
        .filter(|(run, _)| !run.variant.setting.is_empty() && run.variant.setting != PRESETS)
        .filter_map(|(run, errors)| {
            let growth = growth(errors.as_ref()?, base_errors, floor);
            Some((&run.variant, run.cost()?.wall_s / base.wall_s, growth))
        })
        .collect();
    let mut found: Vec<Variant> = Vec::new();
    let mut keep = |label: &str, parts: Vec<&Variant>| {
        let overrides: Vec<String> = parts.iter().flat_map(|part| part.overrides.clone()).collect();
        if parts.len() > 1 && found.iter().all(|other| other.overrides != overrides) {
            found.push(Variant::new(label, overrides, None));
        }
    };
    for (label, most) in GROWTHS {
        let fit = singles.iter().filter(|(_, cost, growth)| *cost < CHEAPER && *growth <= most);
        keep(label, of_each(fit, |(_, cost, _)| *cost));
    }
    let fit = singles.iter().filter(|(_, cost, growth)| *cost < DEARER && *growth < LOWER);
    keep("combined: more accurate", of_each(fit, |(_, _, growth)| *growth));
    found
}

/// Presets set what other settings set, too.
const PRESETS: &str = "solver.accuracy";

/// Of each setting the least by a measure, those first that are least; none that changes a key again.
fn of_each<'a>(
    fit: impl Iterator<Item = &'a (&'a Variant, f64, f64)>,
    measure: impl Fn(&(&Variant, f64, f64)) -> f64,
) -> Vec<&'a Variant> {
    let mut fit: Vec<_> = fit.collect();
    fit.sort_by(|a, b| measure(a).total_cmp(&measure(b)));
    let mut parts: Vec<&Variant> = Vec::new();
    let key = |text: &String| text.split('=').next().unwrap_or_default().to_string();
    for (variant, ..) in fit {
        let clashes = |other: &&Variant| {
            let keys: Vec<String> = other.overrides.iter().map(key).collect();
            other.setting == variant.setting || variant.overrides.iter().any(|text| keys.contains(&key(text)))
        };
        if !parts.iter().any(clashes) {
            parts.push(variant);
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::super::child::{Cost, Ended};
    use super::*;

    fn made(setting: &str, overrides: &[&str], wall_s: f64) -> Made {
        let overrides = overrides.iter().map(ToString::to_string).collect();
        let variant = Variant { label: setting.into(), setting: setting.into(), overrides, cost: None };
        let cost = Some(Cost { wall_s, ..Cost::default() });
        Made { variant, ended: Ended { code: Some(0), cost, ..Ended::default() } }
    }

    fn force(error: f64) -> Option<Errors> {
        let mut errors = Errors::default();
        errors.set(Quantity::Force, Some(error));
        errors.set(Quantity::Penetration, Some(1e3 * error));
        Some(errors)
    }

    #[test]
    fn the_best_of_each_setting_are_combined() {
        let runs = [
            made("", &[], 10.0),
            made("pace", &["p=4"], 3.0),
            made("pace", &["p=2"], 5.0),
            made("mesh", &["m=1"], 2.0),
            made("tolerance", &["t=1"], 9.0),
            made("surface", &["s=f"], 9.0),
            made("solver.accuracy", &["a=d"], 1.0),
            made("surface", &["s=x"], 11.0),
            made("fine", &["p=0.5"], 20.0),
        ];
        let errors = [0.1, 0.3, 0.12, 5.0, 0.1, 2.0, 0.1, 0.05, 0.02].map(force);
        let found = combinations(&runs, &errors, &Errors::default());
        let shown: Vec<(&str, String)> = found.iter().map(|v| (v.label.as_str(), v.overrides.join(" "))).collect();
        let expected = [
            ("combined: as accurate", "p=2 t=1"),
            ("combined: rough", "p=4 t=1"),
            ("combined: more accurate", "p=0.5 s=x"),
        ];
        assert_eq!(shown, expected.map(|(label, overrides)| (label, overrides.to_string())));
    }

    /// What the reference cannot tell is no growth.
    #[test]
    fn errors_below_the_reference_do_not_count() {
        let [base, run, floor] = [0.01, 0.03, 0.04].map(|error| force(error).unwrap());
        assert_eq!(growth(&run, &base, &floor), 1.0);
        assert_eq!(growth(&run, &base, &Errors::default()), 3.0);
        assert_eq!(growth(&Errors::default(), &base, &floor), f64::INFINITY);
    }

    #[test]
    fn one_setting_or_none_is_no_combination() {
        let runs = [made("", &[], 10.0), made("pace", &["p=4"], 3.0)];
        assert!(combinations(&runs, &[force(0.1), force(0.1)], &Errors::default()).is_empty());
        assert!(combinations(&runs, &[None, force(0.1)], &Errors::default()).is_empty());
    }
}
