//! Properties over random inputs; a failing input is shrunk and reported.

use crate::table::Row;
use proptest::strategy::Strategy;
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestError, TestRng, TestRunner};
use std::cell::RefCell;
use std::fmt::Debug;

/// Tries a property on a number of inputs, the same every time; each is a run of the row. A failure is reported with
/// the smallest failing input found.
///
/// * `property` — adds one run to the row, by [`Row::holds`] or [`Row::measure`], and returns its result
pub(crate) fn for_all<S: Strategy>(
    mut row: Row,
    runs: u32,
    inputs: S,
    property: impl Fn(&mut Row, S::Value) -> bool,
) -> Row
where
    S::Value: Debug + Clone,
{
    let config =
        Config { cases: runs, failure_persistence: None, max_shrink_iters: 500, ..Config::default() };
    // A seed per row, so that cases with the same strategy get different numbers.
    let mut seed = [0u8; 32];
    let name = row.condition.bytes().chain([row.case]);
    name.enumerate().for_each(|(i, byte)| seed[i % 32] = seed[i % 32].wrapping_mul(31).wrapping_add(byte));
    let mut runner = TestRunner::new_with_rng(config, TestRng::from_seed(RngAlgorithm::ChaCha, &seed));
    let counted = RefCell::new(row.clone());
    let outcome = runner.run(&inputs, |input| {
        // Inputs tried while shrinking do not count as runs.
        let failed = counted.borrow().failure.is_some();
        let mut scratch = Row { failure: None, ..counted.borrow().clone() };
        let holds = property(&mut scratch, input.clone());
        let failure = scratch.failure.take();
        if !failed {
            scratch.failure = failure.clone();
            *counted.borrow_mut() = scratch;
        }
        if holds { Ok(()) } else { Err(TestCaseError::fail(failure.unwrap_or_default())) }
    });
    row = counted.into_inner();
    // A run that panicked was not counted yet.
    row.runs += u64::from(outcome.is_err() && row.runs == row.survived);
    match outcome {
        Err(TestError::Fail(reason, smallest)) => {
            row.failure = Some(format!("{reason}\n  from {smallest:?}"))
        }
        Err(TestError::Abort(reason)) => row.failure = Some(format!("given up: {reason}")),
        Ok(()) => (),
    }
    row
}
