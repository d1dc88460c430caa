//! The row of a case: its status, and the scalars of its summary by their dotted names.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::plan::Plan;
use crate::error::{Error, Result};
use crate::scene::CHANGES;

/// Keys of the summary that do not describe the physics of a case: they differ between machines or are the same in every case.
const LEFT_OUT: [&str; 9] =
    ["scene", "output", "outcome", "wall_s", "step_wall_s", "cell_steps_per_s", "events_per_s", "equation", "validity"];

/// Status of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// The end time was reached.
    Done,
    /// The bar fractured.
    Rupture,
    /// The run was stopped by an error.
    Stopped,
    /// The scene is invalid with these values.
    Refused,
}

impl Status {
    /// Returns the name as it is written in the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Rupture => "rupture",
            Self::Stopped => "stopped",
            Self::Refused => "refused",
        }
    }
}

/// Results of a case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Number of the case, starting at 0.
    pub case: usize,
    /// Status of the case.
    pub status: Status,
    /// Reason why the case was stopped or refused; empty otherwise.
    pub reason: String,
    /// Scalars of the summary: numbers (null if there is no value), texts and booleans.
    pub metrics: BTreeMap<String, Value>,
}

impl Row {
    /// Creates the row of a case from its summary, or from the error that ended it.
    ///
    /// # Errors
    /// Errors that do not concern the case itself: an interruption, or a file that cannot be written.
    pub(super) fn new(case: usize, ended: Result<Value>, asked: &[String]) -> Result<Self> {
        let failed = |status, reason: String| Ok(Self { case, status, reason, metrics: BTreeMap::new() });
        match ended {
            Ok(summary) => {
                let ruptured = summary["outcome"] == "rupture";
                let status = if ruptured { Status::Rupture } else { Status::Done };
                Ok(Self { case, status, reason: String::new(), metrics: metrics(&summary, asked) })
            }
            Err(Error::Input(mut error)) => {
                // A position in the value of an axis gives no more information than its key.
                error.place = error.place.filter(|place| place.file != CHANGES);
                failed(Status::Refused, error.to_string())
            }
            Err(error @ (Error::Run(_) | Error::Checks(_))) => failed(Status::Stopped, error.to_string()),
            Err(error @ (Error::File { .. } | Error::Interrupted)) => Err(error),
        }
    }
}

/// A row with the values of the axes.
#[derive(Debug, Serialize)]
pub struct FullRow<'a> {
    case: usize,
    /// Values by the keys of the axes: numbers in SI units, or texts.
    axes: serde_json::Map<String, Value>,
    status: Status,
    reason: &'a str,
    metrics: &'a BTreeMap<String, Value>,
}

impl Row {
    /// Adds the values of the axes of the case.
    pub fn with_axes(&self, plan: &Plan) -> FullRow<'_> {
        let axes = plan.axes.iter().zip(plan.levels(self.case));
        FullRow {
            case: self.case,
            axes: axes.map(|(axis, level)| (axis.key.clone(), level.value())).collect(),
            status: self.status,
            reason: &self.reason,
            metrics: &self.metrics,
        }
    }
}

/// Most values of a list of numbers for which each value becomes a column.
const LONGEST: usize = 10;

/// Key of the summary whose entries are named in the table without this key: `left.peak_force_N`.
const FIGURES: &str = "figures";

/// Returns the requested scalars of a summary, which may be inside lists (counted from 0). If none are requested, returns all that are not inside a
/// list, and the values of short lists of numbers.
fn metrics(summary: &Value, asked: &[String]) -> BTreeMap<String, Value> {
    if !asked.is_empty() {
        let of = |name: &String| scalar(summary, name).or_else(|| scalar(summary.get(FIGURES)?, name));
        let found = |name: &String| (name.clone(), of(name).unwrap_or(Value::Null));
        return asked.iter().map(found).collect();
    }
    let mut all = BTreeMap::new();
    collect(summary, "", &mut all);
    all
}

fn scalar(summary: &Value, name: &str) -> Option<Value> {
    let value = name.split('.').try_fold(summary, |value, part| match value {
        Value::Array(items) => items.get(part.parse::<usize>().ok()?),
        _ => value.get(part),
    })?;
    (!value.is_object() && !value.is_array()).then(|| value.clone())
}

fn collect(value: &Value, prefix: &str, all: &mut BTreeMap<String, Value>) {
    let Value::Object(entries) = value else { return };
    for (key, value) in entries.iter().filter(|(key, _)| !LEFT_OUT.contains(&key.as_str())) {
        let name = match (prefix, key.as_str()) {
            ("", FIGURES) => String::new(),
            ("", _) => key.clone(),
            _ => format!("{prefix}.{key}"),
        };
        match value {
            Value::Object(_) => collect(value, &name, all),
            // Longer lists, such as profiles along the bar, would need one column per value.
            Value::Array(items) if items.len() <= LONGEST && items.iter().all(Value::is_number) => {
                all.extend(items.iter().enumerate().map(|(k, item)| (format!("{name}.{k}"), item.clone())));
            }
            Value::Array(_) => {}
            _ => {
                all.insert(name, value.clone());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scalars_are_found_by_dotted_names() {
        let summary = serde_json::json!({ "outcome": "done", "wall_s": 3.0, "left": { "stress_Pa": 5.0 }, "fronts": [{ "speed_m_s": 7.0 }] });
        let all = metrics(&summary, &[]);
        assert_eq!(all.keys().collect::<Vec<_>>(), ["left.stress_Pa"]);
        let asked = metrics(&summary, &["fronts.0.speed_m_s".into(), "right.stress_Pa".into(), "left".into()]);
        assert_eq!(
            (&asked["fronts.0.speed_m_s"], &asked["right.stress_Pa"], &asked["left"]),
            (&7.0.into(), &Value::Null, &Value::Null)
        );
    }
}
