//! What a person reads: tables, and a verdict in words.

use cloth_fit::report::{SequenceReport, StageReport};
use std::fmt::Write;

/// The iterations of a stage, level by level.
pub fn iterations(stage: &StageReport) -> String {
    let mut text = format!("{}, {}\n", stage.name(), stage.model);
    let _ = writeln!(text, "  points  iteration   rms [N]     gain      step    radius  kept");
    for level in &stage.levels {
        if level.iterations.is_empty() {
            let _ = writeln!(
                text,
                "  {:6}  {:9}  {:9.3e}  {:>8}  {:>8}  {:>8}",
                level.points, 0, level.rms, "", "", ""
            );
        }
        // The level's residual belongs to its last iteration; sums of squares give the others in proportion.
        let last = level.iterations.last().map_or(1.0, |iteration| iteration.sum_of_squares);
        for iteration in &level.iterations {
            let rms =
                if last > 0.0 { level.rms * (iteration.sum_of_squares / last).sqrt() } else { level.rms };
            let gain = iteration.gain.map_or("-".into(), |gain| format!("{gain:.1e}"));
            let _ = writeln!(
                text,
                "  {:6}  {:9}  {rms:9.3e}  {gain:>8}  {:8.1e}  {:8.1e}  {}",
                level.points,
                iteration.iteration,
                iteration.step,
                iteration.radius,
                if iteration.accepted { "yes" } else { "no" }
            );
        }
    }
    let counters = &stage.counters;
    let _ = writeln!(
        text,
        "  {} equilibria, {} Newton steps, {} factorisations, {:.2} s; {}",
        counters.equilibria, counters.iterations, counters.factorisations, stage.seconds, stage.growth
    );
    text
}

/// The control points with their uncertainty.
pub fn curve(stage: &StageReport) -> String {
    let report = &stage.curve;
    let [low, high] = report.visited;
    let mut text =
        format!("  strain      stiffness [N/m]       stress [N/m]   (seen from {low:.4} to {high:.4})\n");
    for (i, (strain, k)) in report.curve.strains().iter().zip(report.curve.stiffnesses()).enumerate() {
        let deviation = match report.half_bands[i] {
            Some(half) => format!("± {:.1} %", 100.0 * half / k.abs().max(f64::MIN_POSITIVE)),
            None => "not known".into(),
        };
        let _ = writeln!(text, "  {strain:<8.5}  {k:12.5e} {deviation:>10}  {:12.5e}", k * strain);
    }
    for (i, j, correlation) in &report.correlated {
        let _ = writeln!(text, "  correlated: control points {} and {} ({correlation:.3})", i + 1, j + 1);
    }
    if report.active_constraints > 0 {
        let _ = writeln!(text, "  {} stability constraints hold the curve", report.active_constraints);
    }
    text
}

/// One row a sequence.
pub fn residuals(stages: &[StageReport]) -> String {
    let sequences: Vec<&SequenceReport> = stages.iter().flat_map(|stage| &stage.sequences).collect();
    let width = sequences.iter().map(|s| s.name.chars().count()).max().unwrap_or(0).max(8);
    let mut text = format!(
        "{:width$}  frames  left out  nodes    rms force [N]  of largest  rms position [mm]  loading  unloading\n",
        "sequence"
    );
    for s in sequences {
        let dropped = stages.iter().flat_map(|stage| &stage.dropped).filter(|d| d.sequence == s.name).count();
        let position = s.position_rms.map_or("-".into(), |rms| format!("{:.4}", 1e3 * rms));
        let branch = |value: Option<f64>| value.map_or("-".into(), |value| format!("{value:.3}"));
        let _ = writeln!(
            text,
            "{:width$}  {:6}  {:8}  {:7}  {:13.5}  {:8.2} %  {position:>17}  {:>7}  {:>9}",
            s.name,
            s.frames,
            s.at_rest + dropped,
            format!("{}x{}", s.nodes[0], s.nodes[1]),
            s.force_rms.unwrap_or(0.0),
            100.0 * s.force_rms.unwrap_or(0.0) / s.force_largest.max(f64::MIN_POSITIVE),
            branch(s.hysteresis.map(|h| h.loading)),
            branch(s.hysteresis.map(|h| h.unloading)),
        );
    }
    text
}

/// Frames that take no part, and frames to look at.
fn oddities(stage: &StageReport) -> String {
    let mut text = String::new();
    for dropped in &stage.dropped {
        let _ = write!(
            text,
            " Frame {} of {} takes no part: {}.",
            dropped.frame, dropped.sequence, dropped.status
        );
    }
    for sequence in stage.sequences.iter().filter(|sequence| !sequence.outliers.is_empty()) {
        let frames: Vec<String> = sequence.outliers.iter().take(8).map(|frame| frame.to_string()).collect();
        let more = if sequence.outliers.len() > 8 { " and others" } else { "" };
        let _ = write!(
            text,
            " Look at frame {}{more} of {}: far off the rest.",
            frames.join(", "),
            sequence.name
        );
    }
    text
}

/// Why it stopped, how good it is, what limits it, what to measure next.
pub fn verdict(stage: &StageReport) -> String {
    // Levels that did not pay come after the one that was kept.
    let kept = stage.levels.iter().find(|level| level.points == stage.curve.curve.len());
    let end = kept.map_or("", |level| &level.status[..]);
    let scatter = &stage.scatter;
    let state = if stage.converged { "converged" } else { "NOT converged" };
    let origin = if scatter.known { "given" } else { "estimated" };
    let limit = if scatter.misfit > 0.0 {
        format!(
            "it misses the forces by {:.2e} N beyond the {origin} noise of {:.2e} N (hysteresis, too few control points, or another law than the model's), and the band includes that",
            scatter.misfit, scatter.noise
        )
    } else {
        format!("nothing is left beyond the {origin} noise of {:.2e} N", scatter.noise)
    };
    let widest = stage
        .curve
        .samples
        .iter()
        .filter_map(|sample| sample.band.map(|[low, high]| (sample.strain, high - low)))
        .max_by(|a, b| a.1.total_cmp(&b.1));
    let next = match widest {
        Some((strain, width)) => {
            let largest = stage.curve.samples.iter().fold(0.0f64, |m, s| m.max(s.stress.abs()));
            format!(
                "the 95 % band is widest at strain {strain:.4}, ± {:.1} % of the largest stress: more frames there would narrow it most",
                50.0 * width / largest.max(f64::MIN_POSITIVE)
            )
        }
        None => "too few frames to judge all of the curve by: measure more".into(),
    };
    format!("{}: {state}: {}, and {end}; {limit}; {next}.{}", stage.name(), stage.growth, oddities(stage))
}
