//! Cases 50 to 52: stopped runs, and runs that resume them.

use crate::fault::{Before, Bench, Fault, Run, names};
use crate::table::{Extent, Row};
use cloth_data::store::OutputFolder;
use std::collections::BTreeMap;

/// Ctrl-C at every call to the file system, and at allocations in between.
pub(crate) fn case_50(extent: Extent) -> Vec<Row> {
    let bench = Bench::new();
    let mut rows = at_every_call(50, &bench, extent, &[Fault::Interrupt]);
    let all = bench.fit(Before::Older, None).allocations;
    let points = extent.runs(6, 300) as usize;
    let mut row = Row::new(50, "SIGINT at any allocation, over an older result");
    let mut interrupted = 0;
    for point in 1..=points {
        let at = point * all / (points + 1);
        let tried = stopped(&bench, Before::Older, Fault::Allocate, at);
        interrupted += usize::from(tried.as_ref().is_ok_and(|run| run.code() == Some(130)));
        row.holds(tried.is_ok(), || format!("allocation {at} of {all}: {}", tried.err().unwrap_or_default()));
    }
    // All except before the handler is installed or after the last output.
    row.holds(interrupted * 10 >= points * 9, || format!("{interrupted} of {points} ended with 130"));
    rows.push(row);
    rows.push(compare_interrupted(extent));
    rows
}

/// A comparison resumes after the finished models and variants.
fn compare_interrupted(extent: Extent) -> Row {
    let mut row = Row::new(50, "SIGINT as a comparison keeps a row, into a new folder");
    let bench = Bench::of(&["compare", "set", "--nodes", "5x5", "--points", "1", "--out", "out"]);
    let calls = bench.fit(Before::Nothing, None).calls;
    let kept =
        calls.iter().enumerate().filter(|(_, (name, path))| name == "write" && path.ends_with("/journal"));
    for (i, _) in kept.skip(extent.runs(9, 0) as usize).step_by(extent.runs(2, 1) as usize) {
        let tried = stopped(&bench, Before::Nothing, Fault::Interrupt, i + 1);
        row.holds(tried.is_ok(), || format!("call {}: {}", i + 1, tried.err().unwrap_or_default()));
    }
    row
}

/// SIGKILL at every call and in the middle of every write.
pub(crate) fn case_51(extent: Extent) -> Vec<Row> {
    let mut bench = Bench::new();
    let mut rows = at_every_call(51, &bench, extent, &[Fault::Kill, Fault::Half]);
    bench = bench.without_exchange();
    let mut row = Row::new(51, "SIGKILL where folders are swapped in two steps, over an older result");
    let calls = bench.fit(Before::Older, None).calls;
    let renames =
        (1..=calls.len()).filter(|at| calls[at - 1].0 == "rename" && !calls[at - 1].1.contains(".work/new/"));
    for at in renames.flat_map(|at| [at, at + 1]) {
        let tried = stopped_between(&bench, at);
        row.holds(tried.is_ok(), || format!("call {at}: {}", tried.err().unwrap_or_default()));
    }
    rows.push(row);
    rows
}

/// A disk that is full from a call on, or for one call.
pub(crate) fn case_52(extent: Extent) -> Vec<Row> {
    at_every_call(52, &Bench::new(), extent, &[Fault::Full, Fault::Once])
}

/// A row for every kind of call and fault, with and without an older result.
fn at_every_call(case: u8, bench: &Bench, extent: Extent, faults: &[Fault]) -> Vec<Row> {
    let mut rows = Vec::new();
    for before in [Before::Older, Before::Nothing] {
        let mut places: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        let calls = bench.fit(before, None).calls;
        calls
            .iter()
            .enumerate()
            .for_each(|(i, (name, _))| places.entry(name.clone()).or_default().push(i + 1));
        // Without an older result, only the last step differs.
        places.retain(|name, _| extent == Extent::Full || before == Before::Older || name == "rename");
        for (name, places) in &places {
            // The last rename puts the result in place.
            let few = &places[places.len() - 1..];
            let chosen = if extent == Extent::Full { &places[..] } else { few };
            for &fault in faults.iter().filter(|fault| fault.strikes(name)) {
                let mut row = Row::new(case, condition(fault, name, before));
                for &at in chosen {
                    let tried = stopped(bench, before, fault, at);
                    let place = || format!("call {at}, {name} {}", calls[at - 1].1);
                    row.holds(tried.is_ok(), || format!("{}: {}", place(), tried.err().unwrap_or_default()));
                }
                rows.push(row);
            }
        }
    }
    rows
}

fn condition(fault: Fault, call: &str, before: Before) -> String {
    let fault = match fault {
        Fault::Full => format!("disk full from {call} on"),
        Fault::Once => format!("disk full for one {call}"),
        Fault::Kill => format!("SIGKILL before {call}"),
        Fault::Half => format!("SIGKILL halfway through {call}"),
        Fault::Interrupt => format!("SIGINT before {call}"),
        Fault::Allocate => "SIGINT at any allocation".into(),
    };
    match before {
        Before::Nothing => format!("{fault}, into a new folder"),
        Before::Older => format!("{fault}, over an older result"),
    }
}

fn check(holds: bool, complaint: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(complaint()) }
}

/// Stops a fit, checks what is left, and runs the same command again.
fn stopped(bench: &Bench, before: Before, fault: Fault, at: usize) -> Result<Run, String> {
    let run = bench.fit(before, Some((fault, at)));
    let said = run.said();
    check(!said.contains("panicked"), || said.clone())?;
    let (then, now) = (bench.then(before), bench.now());
    let (is_old, is_new) = (now == then, now.as_ref() == Some(&bench.newer));
    check(is_old || is_new, || "the folder holds neither the old result nor the new one".into())?;
    let kept = match fault {
        Fault::Kill | Fault::Half => {
            check(run.signal() == Some(9), || format!("ended with {:?}: {said}", run.code()))?;
            None
        }
        Fault::Full | Fault::Once => {
            check(run.code() == Some(1), || format!("ended with {:?}: {said}", run.code()))?;
            check(said.contains("No space left") && said.contains("out"), || said.clone())?;
            check(is_old, || "the new result is in place, and the exit code denies it".into())?;
            None
        }
        Fault::Interrupt | Fault::Allocate => Some(interrupted(bench, fault, &run, is_old)?),
    };
    let again = bench.again(None);
    let said = again.said();
    check(again.code() == bench.code, || format!("again: {:?}: {said}", again.code()))?;
    check(bench.now().as_ref() == Some(&bench.newer), || {
        "again: not the bytes of an uninterrupted run".into()
    })?;
    check(bench.leftovers().is_empty(), || format!("again: left {:?}", bench.leftovers()))?;
    let recalled = said
        .split_once("already finished: ")
        .map_or(0, |(_, names)| names.lines().next().unwrap().split("; ").count());
    check(kept.is_none_or(|kept| kept == recalled), || format!("kept {kept:?}, recalled {recalled}"))?;
    // A journal without records may lack its key, too.
    let (fitted, records) = (bench.stages - recalled, again.records());
    let is_rest = records == fitted || recalled == 0 && records == fitted + 1;
    check(is_rest, || format!("{records} records after {recalled}, of {}", bench.stages))?;
    Ok(run)
}

/// Checks the output and files of an interrupted fit; returns the number of stages kept.
fn interrupted(bench: &Bench, fault: Fault, run: &Run, is_old: bool) -> Result<usize, String> {
    let (said, left) = (run.said(), bench.leftovers());
    let told = String::from_utf8_lossy(&run.output.stdout).contains("Written to out");
    match (run.code(), run.signal()) {
        (Some(130), _) => check(said.contains("interrupted"), || said.clone())?,
        // Before the handler is installed, or after the last output.
        (_, Some(2)) if fault == Fault::Allocate => check(is_old, || "killed, with a new result".into())?,
        (code, None) if fault == Fault::Allocate && code == bench.code => {
            check(told, || "not interrupted".into())?
        }
        (code, signal) => return Err(format!("ended with {code:?}, signal {signal:?}: {said}")),
    }
    check(!said.contains("the result is in") || !is_old, || said.clone())?;
    check(!said.contains("is unchanged") || is_old, || said.clone())?;
    let kept = said
        .split_once("resumes after ")
        .map_or(0, |(_, rest)| rest.split(' ').next().unwrap().parse().unwrap());
    let expected: &[&str] = if kept > 0 { &[".out.work"] } else { &[] };
    check(left == expected, || format!("{kept} kept, left {left:?}: {said}"))?;
    let within = names(&bench.path(".out.work"));
    check(kept == 0 || within == ["journal"], || format!("left {within:?}"))?;
    Ok(kept)
}

/// Kills a fit between the steps of a swap: the next run that claims the folder restores the old result.
fn stopped_between(bench: &Bench, at: usize) -> Result<(), String> {
    let run = bench.fit(Before::Older, Some((Fault::Kill, at)));
    check(run.signal() == Some(9), || format!("ended with {:?}: {}", run.code(), run.said()))?;
    drop(OutputFolder::claim(&bench.path("out")).map_err(|error| error.to_string())?);
    let now = bench.now();
    let whole = now == bench.then(Before::Older) || now.as_ref() == Some(&bench.newer);
    check(whole, || "neither the old result nor the new one".into())
}
