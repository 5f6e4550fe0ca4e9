//! Source: measured bending laws of fabrics, M = B₁κ + B₂κ² (fabrics618_bending/).
//!
//! Goal: bending fits meet the law and hold it in their bands, on shapes computed without cloth code.
//!
//! ```text
//!  ▒▒▒▒▒▒▒▒───╮        120 mm × 50 mm pushed off a table: eight overhangs up to Γ = 30 or 0.8 of the peak moment,
//!         ▒    ╲       vertices 1 and 2 mm apart, without noise and with 0.1 mm, told to the fit
//!  table  ▒     │
//! ```
//!
//! Of every fit: rms error of the moment over 20–100 % of its range; share of that range in which the band holds the
//! truth; error over the band's standard deviation at its middle. Pooled over the fabrics.

use cloth_data::frame::Kind;
use cloth_fit::incremental::{Stage, fit};
use cloth_fit::stage::knowledge::Knowledge;
use cloth_fit::stage::{Settings, Watch};
use cloth_sim::material::Component;
use fit_cloth_tests::cantilever::{Cantilever, GRAVITY};
use fit_cloth_tests::elastica::Elastica;
use fit_cloth_tests::rows;
use rayon::prelude::*;

const SIZE: [f64; 2] = [0.12, 0.05];
const NOISE: f64 = 1e-4;

/// A moment law, and the fabric's weight.
#[derive(Debug, Clone, Copy)]
struct Law {
    density: f64,
    linear: f64,
    quadratic: f64,
}

impl Law {
    /// Curvature at 0.8 of the peak moment, 1/m.
    fn limit(&self) -> f64 {
        let peak = -0.5 * self.linear / self.quadratic.min(-1e-300);
        peak * (1.0 - 0.2f64.sqrt())
    }

    /// N; beyond the limit along the tangent.
    fn moment(&self, curvature: f64) -> f64 {
        let size = curvature.abs().min(self.limit());
        let law = self.linear * size + self.quadratic * size * size;
        let beyond = (curvature.abs() - size) * (self.linear + 2.0 * self.quadratic * size);
        (law + beyond).copysign(curvature)
    }

    /// Eight overhangs, m, from 0.4 of the longest.
    fn overhangs(&self) -> Vec<f64> {
        let weight = self.density * GRAVITY;
        let longest = (30.0 * self.linear / weight).cbrt().min(0.1);
        let bends = |length: f64| Elastica::solve(length, weight, &|k| self.moment(k)).at(0.0).curvature;
        let (mut low, mut high) = (0.0, longest);
        if bends(longest) > self.limit() {
            for _ in 0..12 {
                let middle = 0.5 * (low + high);
                if bends(middle) > self.limit() { high = middle } else { low = middle }
            }
        } else {
            low = longest;
        }
        (0..8).map(|i| low * (0.4 + 0.6 * f64::from(i) / 7.0)).collect()
    }
}

/// The laws of all fabrics along warp, weft and the bias.
fn laws(nonlinear: bool) -> Vec<Law> {
    let number = |field: &String| field.parse::<f64>().unwrap();
    let fabrics = rows("fabrics618_bending/fabrics.csv");
    let law = |row: &Vec<String>, i: usize| Law {
        density: number(&row[2]),
        linear: number(&row[3 + i]),
        quadratic: if nonlinear { number(&row[6 + i]).min(0.0) } else { 0.0 },
    };
    fabrics.iter().enumerate().map(|(index, row)| law(row, index % 3)).collect()
}

struct Found {
    /// Γ of the longest overhang.
    gamma: f64,
    error: f64,
    inside: f64,
    half_width: f64,
    deviation: f64,
}

fn found(law: &Law, spacing: f64, noise: Option<(f64, u64)>, settings: &Settings) -> Option<Found> {
    let overhangs = law.overhangs();
    let moment = |curvature: f64| law.moment(curvature);
    let measured = SIZE.map(|side| (side / spacing).round() as usize + 1);
    let cantilever = Cantilever {
        kind: Kind::BendWeft,
        areal_density: law.density,
        moment: &moment,
        overhangs: &overhangs,
        size: SIZE,
        measured,
        noise,
    };
    let report =
        fit(&cantilever.measure(), &[Stage::Bend], &Knowledge::default(), settings, &mut Watch::default())
            .inspect_err(|error| println!("{error}"))
            .ok()?;
    let Some(stage) = report.stage(Component::BendWeft) else {
        println!("no curve: {:?} {:?}", report.failures, report.notices);
        return None;
    };
    let last = stage.curve.seen[1];
    let samples: Vec<_> =
        stage.curve.samples.iter().filter(|s| s.strain >= 0.2 * last && s.strain <= last).collect();
    let error = |s: &cloth_fit::stage::report::CurveRow| s.stress / moment(s.strain) - 1.0;
    let rms = (samples.iter().map(|s| error(s).powi(2)).sum::<f64>() / samples.len() as f64).sqrt();
    let holds = |s: &&&cloth_fit::stage::report::CurveRow| {
        s.band.is_some_and(|[low, high]| (low..=high).contains(&moment(s.strain)))
    };
    let inside = samples.iter().filter(holds).count() as f64 / samples.len() as f64;
    let middle = samples[samples.len() / 2];
    let [low, high] = middle.band?;
    let half = 0.5 * (high - low) / middle.stress;
    Some(Found {
        gamma: law.density * GRAVITY * overhangs[7].powi(3) / law.linear,
        error: rms,
        inside,
        half_width: half,
        deviation: error(middle) / (half / 1.96),
    })
}

fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get((share * values.len().saturating_sub(1) as f64).round() as usize).copied().unwrap_or(f64::NAN)
}

/// Fits every `step`-th law in all settings and prints the table.
fn pooled(step: usize, nodes: Option<[usize; 2]>) {
    for nonlinear in [false, true] {
        let laws: Vec<Law> = laws(nonlinear).into_iter().step_by(step).collect();
        let mut errors = Vec::new();
        for spacing in [1e-3, 2e-3] {
            for noise in [None, Some(NOISE)] {
                let settings = Settings { nodes, ..Settings::default() };
                let all: Vec<Option<Found>> = laws
                    .par_iter()
                    .enumerate()
                    .map(|(seed, law)| found(law, spacing, noise.map(|n| (n, seed as u64)), &settings))
                    .collect();
                let failed = all.iter().filter(|found| found.is_none()).count();
                let all: Vec<Found> = all.into_iter().flatten().collect();
                let of = |value: fn(&Found) -> f64, share| quantile(all.iter().map(value).collect(), share);
                let long: Vec<f64> = all.iter().filter(|f| f.gamma >= 10.0).map(|f| f.error).collect();
                let of_long = |share| 100.0 * quantile(long.clone(), share);
                let inside = all.iter().map(|f| f.inside).sum::<f64>() / all.len() as f64;
                println!(
                    "{} {} mm noise {noise:?}: {} fits, {failed} failed; error median {:.3} % p90 {:.3} worst {:.3}, \
                     of {} with Γ ≥ 10 {:.3} {:.3} {:.3}; inside {inside:.3}, half-width median {:.3} %, spread {:.2}",
                    if nonlinear { "nonlinear" } else { "linear" },
                    1e3 * spacing,
                    all.len(),
                    100.0 * of(|f| f.error, 0.5),
                    100.0 * of(|f| f.error, 0.9),
                    100.0 * of(|f| f.error, 1.0),
                    long.len(),
                    of_long(0.5),
                    of_long(0.9),
                    of_long(1.0),
                    100.0 * of(|f| f.half_width, 0.5),
                    1.4826 * of(|f| f.deviation.abs(), 0.5),
                );
                assert!(failed == 0 && inside >= 0.88);
                assert!(nonlinear || of_long(0.5) <= 0.15 && of_long(0.9) <= 1.0);
                errors.extend(long);
            }
        }
        // Of noisy nonlinear laws few are long enough in a reduced count.
        let of_all = |share| quantile(errors.clone(), share);
        assert!(!nonlinear || of_all(0.5) <= 0.006 && of_all(0.9) <= 0.025);
    }
}

#[test]
fn bending_laws_come_back_within_their_bands() {
    pooled(12, None);
}

#[test]
#[ignore = "full count"]
fn bending_laws_come_back_on_every_grid() {
    pooled(2, None);
    for nodes in [[26, 26], [50, 50], [98, 98]] {
        println!("nodes {nodes:?}");
        pooled(6, Some(nodes));
    }
}
