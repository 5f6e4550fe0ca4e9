//! Further samples of a fabric, with scattered stiffness.

use super::fabric::KnownFabric;
use super::noise::stream;
use rand_distr::{Distribution, StandardNormal};

impl KnownFabric {
    /// A sample of the fabric. The first is the fabric itself; in the others every curve is multiplied by a factor
    /// exp(N(0, `sample_scatter`)) that depends only on the sample number.
    ///
    /// Source: second samples, Miguel et al. 2012, §6; the distribution is our own.
    #[must_use]
    pub fn sample(&self, number: usize) -> Self {
        let mut sample = self.clone();
        if number == 1 {
            return sample;
        }
        sample.name = format!("{}.{number}", self.name);
        for (component, values) in sample.curves.values_mut() {
            let normal: f64 = StandardNormal.sample(&mut stream(number as u64, &component.to_string()));
            let factor = (self.sample_scatter * normal).exp();
            values.iter_mut().for_each(|value| *value *= factor);
        }
        sample
    }
}
