//! Axis labels of a curve.

use cloth_sim::material::{Component, Model};

/// Names and units of strain and stress, or curvature and moment.
pub(crate) fn curve_labels(model: Model, component: Component) -> [String; 2] {
    let [strain, stress] = model.strain_measure(component).names();
    match component.is_bending() {
        true => [format!("{strain} [1/m]"), format!("{stress} [N]")],
        false => [format!("{strain} [–]"), format!("{stress} [N/m]")],
    }
}
