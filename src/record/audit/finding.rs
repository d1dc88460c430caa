//! The result of the audit for one effect.

use super::AuditRow;

/// Estimate for an effect that changes the outcome, such as fracture.
pub(super) const DECISIVE: f64 = 1.0;

/// The estimate of a neglected effect.
#[derive(Debug)]
pub(super) struct Finding {
    /// Relative change of the stress; NaN if it is not known.
    estimate: f64,
    /// What was neglected; empty where the text says all.
    neglected: &'static str,
    /// For people.
    text: String,
    /// How to include the effect; empty if it is not needed.
    remedy: String,
}

impl Finding {
    /// Neglecting `what` changes the stress by the fraction `estimate`, found from `basis`; `written` is the line of the scene that
    /// includes the effect.
    pub fn of(estimate: f64, what: &'static str, basis: &str, written: &str) -> Self {
        let text = format!("estimated effect on stress {:.2} % ({basis})", 100.0 * estimate);
        Self { estimate, neglected: what, text, remedy: include(written) }
    }

    /// The effect would change the outcome.
    pub fn decisive(text: String, written: &str) -> Self {
        Self { estimate: DECISIVE, neglected: "", text, remedy: include(written) }
    }

    /// No method simulates the effect together with `what`, which the scene has.
    #[must_use]
    pub fn not_with(self, what: &str) -> Self {
        if self.remedy.is_empty() {
            return self;
        }
        Self { text: format!("{}; not simulated together with {what}", self.text), remedy: String::new(), ..self }
    }

    /// The effect would change nothing, for this reason.
    pub fn nothing(text: impl Into<String>) -> Self {
        Self { estimate: 0.0, neglected: "", text: text.into(), remedy: String::new() }
    }

    /// There is no estimate, for this reason.
    pub fn unknown(why: impl std::fmt::Display) -> Self {
        Self { estimate: f64::NAN, neglected: "", text: format!("not estimated: {why}"), remedy: String::new() }
    }

    /// There is no estimate: the named material (or its curve) lacks `what`.
    pub fn lacks(name: &str, what: &str) -> Self {
        Self::unknown(format_args!("{name} lacks {what}"))
    }

    pub fn row(self, effect: &str, threshold: f64) -> AuditRow {
        let Self { estimate, neglected, text, remedy } = self;
        AuditRow {
            effect: effect.to_owned(),
            estimate,
            threshold,
            neglected: neglected.to_owned(),
            finding: text,
            remedy,
        }
    }
}

fn include(written: &str) -> String {
    format!("Add `{written}` under [effects] to include it")
}
