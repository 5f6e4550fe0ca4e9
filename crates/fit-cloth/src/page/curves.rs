//! A fit's curves and their convergence, as data for the page's charts.

use crate::shown::curve_labels;
use crate::text::{self, NO_KNOWLEDGE};
use cloth_fit::incremental::FitReport;
use cloth_fit::stage::report::{CurveRow, Histogram, StageReport};
use cloth_sim::material::Component;
use serde::{Deserialize, Serialize};

/// A component's curve; an unobserved one has only labels and a reason.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Curve {
    component: String,
    observed: bool,
    x_label: String,
    y_label: String,
    stiffness_label: String,
    /// 201 rows: strain, stress and, where known, both sides of the band.
    samples: Vec<Vec<f64>>,
    points: Vec<Point>,
    visited: [f64; 2],
    histogram: Histogram,
    /// Correlation matrix of the control values.
    correlations: Vec<Vec<Option<f64>>>,
    /// The verdict as a sentence; `course` holds the basis and course of the stage, line by line.
    verdict: String,
    course: Vec<String>,
}

/// A control point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Point {
    strain: f64,
    stiffness: f64,
    /// Half the 95 % band of the control value, as a share of it.
    share: Option<f64>,
    stress: f64,
}

/// The residual after every step of a curve's stages, over all numbers of control points, N or m.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Course {
    name: String,
    rms: Vec<f64>,
}

/// The curves of all components, observed or not.
pub(super) fn curves(report: &FitReport) -> Vec<Curve> {
    report.model.components().into_iter().map(|component| curve(report, component)).collect()
}

fn curve(report: &FitReport, component: Component) -> Curve {
    let [x_label, y_label] = curve_labels(report.model, component);
    let stiffness_label = if component.is_bending() { "rigidity [N m]" } else { "stiffness [N/m]" }.into();
    let empty =
        Curve { component: component.to_string(), x_label, y_label, stiffness_label, ..Curve::default() };
    let Some(stage) = report.stage(component).filter(|stage| stage.curve.observed) else {
        let missing = text::missing(report, component);
        return Curve { verdict: missing.unwrap_or_else(|| format!("{component} was given.")), ..empty };
    };
    let found = &stage.curve;
    let sample = |sample: &CurveRow| {
        let band = sample.band.into_iter().flatten();
        [sample.strain, sample.stress].into_iter().chain(band).collect()
    };
    let point = |(i, point): (usize, &CurveRow)| {
        let value = found.curve.stiffnesses()[i];
        Point {
            strain: point.strain,
            // For stretch and shear, exactly the control value in material.json.
            stiffness: if component.is_bending() { point.stiffness } else { value },
            share: found.half_bands[i].map(|half| half / value).filter(|share| *share < NO_KNOWLEDGE),
            stress: point.stress,
        }
    };
    let samples = &found.samples;
    Curve {
        observed: true,
        samples: samples.iter().map(sample).collect(),
        points: found.points.iter().enumerate().map(point).collect(),
        visited: found.seen,
        histogram: found.histogram.clone(),
        correlations: found.correlations.clone(),
        verdict: text::verdict(stage, &report.notices),
        course: text::course(stage),
        ..empty
    }
}

/// Convergence of every curve, over all passes.
pub(super) fn courses(report: &FitReport) -> Vec<Course> {
    let course = |stage: &StageReport| Course { name: stage.name(), rms: report.course(stage) };
    report.last_stages().map(course).collect()
}
