//! Runs the cases of a sweep on all threads.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use serde_json::Value;

use super::file::Sweep;
use super::journal::Journal;
use super::metrics::{Row, Status};
use super::plan::Plan;
use super::shard::Shard;
use super::table::{check_tables, write_tables};
use crate::error::{Error, InputError, Result};
use crate::run;
use crate::scene::Problem;

/// Result of a sweep.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finished {
    /// Number of cases by status, including those of earlier runs.
    pub statuses: BTreeMap<&'static str, usize>,
    /// Number of cases in this run.
    pub run: usize,
    /// Metrics of the sweep file that no case has.
    pub without_values: Vec<String>,
    /// Most frequent reason for a refused or stopped case, and its number of cases.
    pub commonest_reason: Option<(String, usize)>,
}

/// State that the threads share: rows, the first error, and the request to stop.
struct Under<'a> {
    journal: Mutex<Journal>,
    rows: Mutex<Vec<Row>>,
    failed: Mutex<Option<Error>>,
    on_row: &'a (dyn Fn(&Row) + Sync),
    stop: &'a AtomicBool,
}

/// Runs the cases of a shard that have no row in the folder yet, and writes `table.csv` and `sweep.h5` there. A row is stored when its case ends, so
/// a sweep that is stopped or killed loses only the running cases. `on_row` receives every new row. Cases run on all threads of the pool; the table
/// does not depend on their number.
///
/// # Errors
/// [`Error::Interrupted`] if `stop` is set (the tables then contain the rows so far), input errors, existing files in place of the tables that were
/// not written by a sweep, and files that cannot be written.
pub fn run(
    sweep: &Sweep,
    folder: &Path,
    shard: Shard,
    resume: bool,
    on_row: &(dyn Fn(&Row) + Sync),
    stop: &AtomicBool,
) -> Result<Finished> {
    shard.check()?;
    let plan = &sweep.plan;
    let tables = ["table.csv", "sweep.h5"].map(|name| folder.join(name));
    check_tables(&tables[0], &tables[1], false).map_err(|error| {
        let help = error.help.replace("another name", "another folder");
        error.key("folder").help(help)
    })?;
    let (journal, before) = if resume && Journal::has_rows(folder) {
        Journal::resume(folder, plan, shard)?
    } else {
        (Journal::begin(folder, plan, shard)?, Vec::new())
    };
    let known: std::collections::BTreeSet<usize> = before.iter().map(|row| row.case).collect();
    let cases: Vec<usize> = (0..plan.cases()).filter(|case| shard.has(*case) && !known.contains(case)).collect();
    let under =
        Under { journal: Mutex::new(journal), rows: Mutex::new(before), failed: Mutex::new(None), on_row, stop };
    run_all(sweep, folder, &cases, &under);
    let mut rows = under.rows.into_inner().unwrap_or_default();
    rows.sort_by_key(|row| row.case);
    let failed = under.failed.into_inner().unwrap_or_default();
    let refused = if failed.is_none() { refusal(sweep, shard, &rows) } else { None };
    // If all cases of a new sweep are refused, its folder is removed. A shard is kept, because merging needs its rows.
    if refused.is_some() && !resume && shard == Shard::WHOLE {
        if let Ok(journal) = under.journal.into_inner() {
            journal.remove(folder);
        }
    } else {
        write_tables(&tables[0], &tables[1], plan, &rows)?;
    }
    if let Some(error) = failed.or(refused) {
        return Err(error);
    }
    Ok(Finished {
        statuses: count_statuses(&rows),
        run: cases.len(),
        without_values: without_values(plan, &rows),
        commonest_reason: commonest_reason(&rows),
    })
}

/// Returns the most frequent reason. Reasons that differ only in their numbers, the values of the axes, count as the same.
fn commonest_reason(rows: &[Row]) -> Option<(String, usize)> {
    let without_numbers = |reason: &str| reason.replace(|c: char| c.is_ascii_digit() || ".-+".contains(c), "");
    let mut reasons: Vec<(&str, String, usize)> = Vec::new();
    for row in rows.iter().filter(|row| !row.reason.is_empty()) {
        let like = without_numbers(&row.reason);
        match reasons.iter_mut().find(|known| known.1 == like) {
            Some(known) => known.2 += 1,
            None => reasons.push((&row.reason, like, 1)),
        }
    }
    // The first of equally frequent reasons is returned.
    let most = reasons.iter().rev().max_by_key(|known| known.2)?;
    Some((most.0.to_owned(), most.2))
}

/// Returns the metrics that no case has, if any case has run.
fn without_values(plan: &Plan, rows: &[Row]) -> Vec<String> {
    if rows.iter().all(|row| !row.reason.is_empty()) {
        return Vec::new();
    }
    let is_in = |name: &String, row: &Row| row.metrics.get(name).is_some_and(|value| !value.is_null());
    plan.metrics.iter().filter(|name| !rows.iter().any(|row| is_in(name, row))).cloned().collect()
}

/// Counts the cases by status.
fn count_statuses(rows: &[Row]) -> BTreeMap<&'static str, usize> {
    let mut statuses = BTreeMap::new();
    for row in rows {
        *statuses.entry(row.status.name()).or_default() += 1;
    }
    statuses
}

/// Returns the error of a sweep of which every case is refused, also those of the other shards, which are only read; `None` for any other sweep.
fn refusal(sweep: &Sweep, shard: Shard, rows: &[Row]) -> Option<Error> {
    let first = rows.first().filter(|_| rows.iter().all(|row| row.status == Status::Refused))?;
    if (0..sweep.plan.cases()).any(|case| !shard.has(case) && sweep.unplaced_problem(case).is_ok()) {
        return None;
    }
    let all = |reason: &str| format!("every case is refused; the first one: {reason}");
    // The error itself contains more details than its line in the table.
    if let Err(Error::Input(error)) = sweep.problem(first.case) {
        return Some(InputError { message: all(&error.message), ..error }.into());
    }
    let help = "check the keys of the axes and their values with `barwave run SCENE --set KEY=VALUE`";
    Some(InputError::new(all(&first.reason)).help(help).into())
}

/// Runs as many cases at a time as there are threads, in the order of their numbers.
fn run_all(sweep: &Sweep, folder: &Path, cases: &[usize], under: &Under<'_>) {
    let next = AtomicUsize::new(0);
    let work = || {
        while let Some(&case) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
            if let Err(error) = run_one(sweep, folder, case, under) {
                under.stop.store(true, Ordering::Relaxed);
                if let Ok(mut failed) = under.failed.lock() {
                    failed.get_or_insert(error);
                }
                return;
            }
        }
    };
    rayon::scope(|scope| (0..rayon::current_num_threads()).for_each(|_| scope.spawn(|_| work())));
}

fn run_one(sweep: &Sweep, folder: &Path, case: usize, under: &Under<'_>) -> Result<()> {
    if under.stop.load(Ordering::Relaxed) {
        return Err(Error::Interrupted);
    }
    let row = Row::new(case, simulate(sweep, folder, case, under.stop), &sweep.plan.metrics)?;
    let line = serde_json::to_string(&row).map_err(|e| Error::file(folder, e))?;
    if let Ok(mut journal) = under.journal.lock() {
        journal.add(&line)?;
    }
    (under.on_row)(&row);
    if let Ok(mut rows) = under.rows.lock() {
        rows.push(row);
    }
    Ok(())
}

/// Returns the path of the result file of a case, which exists if fields are kept.
pub fn case_file(folder: &Path, case: usize) -> PathBuf {
    folder.join(format!("case-{case:06}.h5"))
}

/// Reads the rows in a folder, ordered by case.
///
/// # Errors
/// A file that cannot be read.
pub fn rows(folder: &Path) -> Result<Vec<Row>> {
    let mut rows = Journal::rows(folder)?;
    rows.sort_by_key(|row| row.case);
    Ok(rows)
}

/// Runs a case and returns its summary.
fn simulate(sweep: &Sweep, folder: &Path, case: usize, stop: &AtomicBool) -> Result<Value> {
    let plan = &sweep.plan;
    let output = (!plan.fields.is_empty()).then(|| case_file(folder, case));
    let audited = plan.metrics.iter().any(|name| name.split('.').next() == Some("audit"));
    let json = |e: serde_json::Error| Error::file(folder, e);
    match sweep.unplaced_problem(case)? {
        Problem::Bar(scene) => {
            let mut progress =
                |_| if stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
            let summary = if output.is_some() || audited {
                run::run(&scene, output.as_deref(), &mut progress)
            } else {
                run::run_unaudited(&scene, &mut progress)
            };
            serde_json::to_value(summary?).map_err(json)
        }
        Problem::Impact(scene) => {
            let mut watch =
                |_| if stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
            serde_json::to_value(run::run_impact(&scene, output.as_deref(), &mut watch)?).map_err(json)
        }
    }
}
