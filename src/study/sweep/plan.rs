//! The cases of a sweep and the changes that they make to the scene.

use std::collections::BTreeSet;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::axis::{Axis, Level, MOST_VALUES};
use crate::error::{InputError, Result};
use crate::input::Checked;

/// Most cases of a sweep.
const MOST_CASES: usize = 10 * MOST_VALUES;

/// Scene key of the fields that are kept.
pub(super) const FIELDS: &str = "record.fields";

/// How axes are combined.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Combine {
    /// Every value of each axis with every one of the others; the last axis varies fastest.
    #[default]
    Product,
    /// The first values of all axes, the second ones, and so on.
    Zip,
}

/// The cases of a sweep. Two runs of one sweep file have the same plan on any machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Name and version of the program.
    pub program: String,
    /// Title of the scene, for display.
    pub title: String,
    /// Checksum of the scene's text.
    pub scene: u32,
    /// Checksum of all files that the scene names with the values of the axes.
    #[serde(default)]
    pub files: u32,
    /// Axes in the order of the file.
    pub axes: Vec<Axis>,
    /// Combination of the axes.
    pub combine: Combine,
    /// Requested metrics; empty: every scalar of the summary.
    pub metrics: Vec<String>,
    /// Fields that are kept of every case. If empty, no result files are written.
    pub fields: Vec<String>,
}

impl Plan {
    /// Refuses axes that give no cases or whose keys are not distinct, and too many cases.
    pub(super) fn check(&self) -> Checked {
        let axes = &self.axes;
        if axes.is_empty() {
            let help = "add [axes] with the keys that vary, such as \"left.value\" = [-10, -20]";
            return Err(InputError::new("there are no axes").key("axes").help(help));
        }
        if let Some(k) = axes.iter().position(|axis| axis.levels.is_empty()) {
            let error = InputError::new(format!("the axis {} has no values", axes[k].key));
            return Err(error.key(format!("axes.{k}.levels")).allowed("at least one value").help("add values"));
        }
        if let Some(k) = (1..axes.len()).find(|&k| axes[..k].iter().any(|other| other.key == axes[k].key)) {
            let error = InputError::new(format!("there are two axes of {}", axes[k].key)).key("axes");
            return Err(error.allowed("one axis for a key").help("put all values into one axis"));
        }
        if self.combine == Combine::Zip
            && let Some(other) = axes.iter().find(|axis| axis.levels.len() != axes[0].levels.len())
        {
            let [first, other] = [&axes[0], other].map(|axis| format!("{} has {}", axis.key, axis.levels.len()));
            let message = format!("axes that are combined by \"zip\" need equal numbers of values: {first}, {other}");
            let error = InputError::new(message).key("combine");
            return Err(error.help("give them as many values, or use combine = \"product\""));
        }
        if self.count().is_some_and(|cases| cases <= MOST_CASES) {
            return Ok(());
        }
        let error =
            InputError::new("the sweep has too many cases").key("axes").allowed(format!("cases <= {MOST_CASES}"));
        Err(error.help("use fewer values, or random samples combined by \"zip\""))
    }

    /// Returns the number of cases, or `None` if it exceeds the range of `usize`.
    pub(super) fn count(&self) -> Option<usize> {
        let lengths = self.axes.iter().map(|axis| axis.levels.len());
        match self.combine {
            Combine::Product => lengths.into_iter().try_fold(1_usize, usize::checked_mul),
            Combine::Zip => lengths.max(),
        }
    }

    /// Returns the number of cases.
    pub fn cases(&self) -> usize {
        self.count().unwrap_or(0)
    }

    /// Returns the values of a case, one per axis.
    pub(crate) fn levels(&self, case: usize) -> Vec<&Level> {
        if self.combine == Combine::Zip {
            return self.axes.iter().map(|axis| &axis.levels[case]).collect();
        }
        let mut rest = case;
        let mut levels: Vec<&Level> = self
            .axes
            .iter()
            .rev()
            .map(|axis| {
                let level = &axis.levels[rest % axis.levels.len()];
                rest /= axis.levels.len();
                level
            })
            .collect();
        levels.reverse();
        levels
    }

    /// Returns the first case, and cases in which every text of an axis, such as the name of a material, occurs once.
    pub(super) fn cases_of_texts(&self) -> BTreeSet<usize> {
        let shortest = self.axes.iter().map(|axis| axis.levels.len()).min().unwrap_or(0);
        let (mut cases, mut stride) = (BTreeSet::from([0]), 1_usize);
        for axis in self.axes.iter().rev() {
            let mut known = BTreeSet::new();
            let texts = axis.levels.iter().enumerate().filter(|(_, level)| level.si.is_none());
            let new = texts.filter(|(_, level)| known.insert(&level.typed)).map(|(k, _)| k);
            if self.combine == Combine::Zip {
                cases.extend(new.filter(|k| *k < shortest));
            } else {
                cases.extend(new.map(|k| k.saturating_mul(stride)));
                stride = stride.saturating_mul(axis.levels.len());
            }
        }
        cases
    }

    /// Returns the changes of the scene by a case (from 0), each `KEY=VALUE` as for [`crate::scene::Scene::read`].
    ///
    /// # Errors
    /// A case that the sweep does not have.
    pub fn overrides(&self, case: usize) -> Result<Vec<String>> {
        let cases = self.cases();
        if case < cases {
            return Ok(self.changes(case));
        }
        let error = InputError::new(format!("there is no case {case}: the sweep has {cases}")).key("case");
        Err(error.allowed(format!("0 <= case < {cases}")).help("cases are counted from 0").into())
    }

    /// Returns the changes of the scene by a case that the sweep has.
    pub(super) fn changes(&self, case: usize) -> Vec<String> {
        let axes = self.axes.iter().zip(self.levels(case));
        let mut all: Vec<String> = axes.map(|(axis, level)| format!("{}={}", axis.key, level.typed)).collect();
        if !self.fields.is_empty() {
            let names: Vec<String> = self.fields.iter().map(|name| format!("\"{name}\"")).collect();
            all.push(format!("{FIELDS}=[{}]", names.join(", ")));
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(combine: Combine) -> Plan {
        let axis = |key: &str, values: &[f64]| Axis {
            key: key.into(),
            unit: String::new(),
            levels: values.iter().map(|v| Level { typed: v.to_string(), si: Some(*v) }).collect(),
            logarithmic: false,
        };
        Plan {
            program: String::new(),
            title: String::new(),
            scene: 0,
            files: 0,
            axes: vec![axis("a", &[1.0, 2.0]), axis("b.c", &[3.0, 4.0])],
            combine,
            metrics: Vec::new(),
            fields: Vec::new(),
        }
    }

    #[test]
    fn every_text_is_in_a_case() {
        let mut plan = plan(Combine::Product);
        let text = |name: &str| Level { typed: name.into(), si: None };
        plan.axes[0].levels = vec![text("x"), text("y"), text("x"), text("z")];
        let texts: Vec<String> = plan.cases_of_texts().into_iter().map(|k| plan.changes(k)[0].clone()).collect();
        assert_eq!(texts, ["a=x", "a=y", "a=z"]);
        plan.combine = Combine::Zip;
        assert_eq!(plan.cases_of_texts(), BTreeSet::from([0, 1]));
    }

    #[test]
    fn the_last_axis_varies_fastest() {
        let overrides =
            |combine| (0..plan(combine).cases()).map(|k| plan(combine).changes(k).join(" ")).collect::<Vec<_>>();
        assert_eq!(overrides(Combine::Product), ["a=1 b.c=3", "a=1 b.c=4", "a=2 b.c=3", "a=2 b.c=4"]);
        assert_eq!(overrides(Combine::Zip), ["a=1 b.c=3", "a=2 b.c=4"]);
    }
}
