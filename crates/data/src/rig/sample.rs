//! Other samples of a fabric: cut from the same roll, and yet not the same.

use super::fabric::KnownFabric;
use super::noise::stream;
use rand_distr::{Distribution, StandardNormal};

impl KnownFabric {
    /// A sample of the fabric: the first is the fabric itself; in the others every curve is stiffer or softer
    /// as a whole, by a factor exp(N(0, `sample_scatter`)) that depends on the number only.
    ///
    /// Source: second samples, Miguel et al. 2012, §6; the law is ours.
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
