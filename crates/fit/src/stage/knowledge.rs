//! The curves that the stages have found so far, with the joint covariance of their errors.
//!
//! ```text
//! a stage fits k with the curves q known:   k̂ errs by  −G δq + noise,   G = (JᵀJ)⁻¹ Jᵀ J_q
//! Cov(k) = C + G Cov(q) Gᵀ,   Cov(k, q) = −G Cov(q)
//! ```
//!
//! A later band therefore includes the uncertainty of earlier stages.

use cloth_sim::curve::StiffnessCurve;
use cloth_sim::material::{Component, Curves};
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

/// Control values of one curve within the joint covariance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Block {
    components: Vec<Component>,
    points: usize,
}

/// Curves taken as known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Knowledge {
    curves: Curves,
    blocks: Vec<Block>,
    covariance: DMatrix<f64>,
}

impl Default for Knowledge {
    /// No curves.
    fn default() -> Self {
        Self::exact(Curves::default())
    }
}

impl Knowledge {
    /// Curves taken as exact.
    pub fn exact(curves: Curves) -> Self {
        Self { curves, blocks: Vec::new(), covariance: DMatrix::zeros(0, 0) }
    }

    /// The curves.
    pub fn curves(&self) -> &Curves {
        &self.curves
    }

    /// True if a component's curve is known.
    pub fn knows(&self, component: Component) -> bool {
        self.curves.get(component).is_some()
    }

    /// A copy without some components.
    pub fn without(&self, components: &[Component]) -> Self {
        let mut kept = Self::exact(
            self.curves
                .components()
                .filter(|component| !components.contains(component))
                .filter_map(|component| Some((component, self.curves.get(component)?.clone())))
                .collect(),
        );
        let places = |block: &Block| !block.components.iter().any(|c| components.contains(c));
        let indices: Vec<usize> =
            self.ranges().filter(|(block, _)| places(block)).flat_map(|(_, r)| r).collect();
        kept.blocks = self.blocks.iter().filter(|block| places(block)).cloned().collect();
        kept.covariance =
            DMatrix::from_fn(indices.len(), indices.len(), |i, j| self.covariance[(indices[i], indices[j])]);
        kept
    }

    /// The components of every uncertain curve of which some take part, one group each: the columns of a
    /// [`sensitivity`](crate::equilibria::Equilibria::sensitivity_to) to them.
    pub fn groups(&self, parts: &[Component]) -> Vec<Vec<Component>> {
        let taking_part = |block: &&Block| block.components.iter().any(|c| parts.contains(c));
        self.blocks.iter().filter(taking_part).map(|block| block.components.clone()).collect()
    }

    /// Covariance of the control values of [`Knowledge::groups`].
    pub fn covariance(&self, parts: &[Component]) -> DMatrix<f64> {
        let indices = self.indices(parts);
        DMatrix::from_fn(indices.len(), indices.len(), |i, j| self.covariance[(indices[i], indices[j])])
    }

    /// Adds the result of a stage.
    ///
    /// * `covariance` — full covariance of the curve's control values
    /// * `gain` — G with respect to the groups of `parts`
    pub fn learn(
        &mut self,
        components: &[Component],
        curve: &StiffnessCurve,
        covariance: &DMatrix<f64>,
        parts: &[Component],
        gain: &DMatrix<f64>,
    ) {
        let known = self.without(components);
        let indices = known.indices(parts);
        let [old, points] = [known.covariance.nrows(), curve.len()];
        // −G Cov(q, all known values).
        let rows = DMatrix::from_fn(indices.len(), old, |i, j| known.covariance[(indices[i], j)]);
        let cross = if indices.is_empty() { DMatrix::zeros(points, old) } else { -(gain * rows) };
        let mut joint = DMatrix::zeros(old + points, old + points);
        joint.view_mut((0, 0), (old, old)).copy_from(&known.covariance);
        joint.view_mut((old, 0), (points, old)).copy_from(&cross);
        joint.view_mut((0, old), (old, points)).copy_from(&cross.transpose());
        joint.view_mut((old, old), (points, points)).copy_from(covariance);
        *self = known;
        self.covariance = joint;
        self.blocks.push(Block { components: components.to_vec(), points });
        components.iter().for_each(|&component| self.curves.set(component, curve.clone()));
    }

    fn ranges(&self) -> impl Iterator<Item = (&Block, std::ops::Range<usize>)> {
        self.blocks.iter().scan(0, |start, block| {
            let from = *start;
            *start += block.points;
            Some((block, from..*start))
        })
    }

    fn indices(&self, parts: &[Component]) -> Vec<usize> {
        let taking_part = |block: &Block| block.components.iter().any(|c| parts.contains(c));
        self.ranges().filter(|(block, _)| taking_part(block)).flat_map(|(_, range)| range).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cloth_sim::curve::NegativeStrain;

    #[test]
    fn what_is_learned_carries_the_errors_of_what_was_known() {
        let curve = |k| StiffnessCurve::constant(k, NegativeStrain::Odd).unwrap();
        let [a, b] = [Component::StretchWeft, Component::Shear];
        let mut knowledge = Knowledge::default();
        let one = DMatrix::from_element(1, 1, 4.0);
        knowledge.learn(&[a], &curve(10.0), &one, &[], &DMatrix::zeros(1, 0));
        assert_eq!(knowledge.groups(&[a, b]), vec![vec![a]]);
        // b's error is −½ of a's, plus an independent one of 1.
        let gain = DMatrix::from_element(1, 1, 0.5);
        let covariance = DMatrix::from_element(1, 1, 1.0 + 0.25 * 4.0);
        knowledge.learn(&[b], &curve(3.0), &covariance, &[a, b], &gain);
        assert_eq!(knowledge.covariance(&[a, b]), DMatrix::from_row_slice(2, 2, &[4.0, -2.0, -2.0, 2.0]));
        // Learned again, it still has one entry.
        knowledge.learn(&[b], &curve(5.0), &covariance, &[a, b], &gain);
        assert_eq!(knowledge.groups(&[a, b]).len(), 2);
        let forgotten = knowledge.without(&[a]);
        assert!(!forgotten.knows(a) && forgotten.knows(b));
        assert_eq!(forgotten.covariance(&[a, b]), DMatrix::from_element(1, 1, 2.0));
    }
}
