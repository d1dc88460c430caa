//! Result of the audit for one effect.

use super::AuditRow;

/// Estimate for an effect that changes the outcome, such as fracture.
pub(super) const DECISIVE: f64 = 1.0;

/// Estimate of a neglected effect.
#[derive(Debug)]
pub(super) struct Finding {
    /// Relative change of the stress; NaN if it is not known.
    estimate: f64,
    /// Neglected phenomenon; empty if `text` is complete.
    neglected: &'static str,
    /// Text with the size of the effect, or the reason for having no estimate.
    text: String,
    /// Instruction for including the effect; empty if it is not needed.
    remedy: String,
}

impl Finding {
    /// Creates the finding that neglecting `what` changes the stress by the fraction `estimate`, determined from
    /// `basis`; `written` is the line of the scene that includes the effect.
    pub fn of(estimate: f64, what: &'static str, basis: &str, written: &str) -> Self {
        let text = format!("estimated effect on stress {:.2} % ({basis})", 100.0 * estimate);
        Self { estimate, neglected: what, text, remedy: include(written) }
    }

    /// Creates the finding that the effect would change the outcome.
    pub fn decisive(text: String, written: &str) -> Self {
        Self { estimate: DECISIVE, neglected: "", text, remedy: include(written) }
    }

    /// Replaces the remedy, if there is one, by the note that no method simulates the effect together with `what`, which the scene contains.
    #[must_use]
    pub fn not_with(self, what: &str) -> Self {
        if self.remedy.is_empty() {
            return self;
        }
        Self { text: format!("{}; not simulated together with {what}", self.text), remedy: String::new(), ..self }
    }

    /// Creates the finding that the effect would change nothing, with the reason.
    pub fn nothing(text: impl Into<String>) -> Self {
        Self { estimate: 0.0, neglected: "", text: text.into(), remedy: String::new() }
    }

    /// Creates the finding that there is no estimate, with the reason.
    pub fn unknown(why: impl std::fmt::Display) -> Self {
        Self { estimate: f64::NAN, neglected: "", text: format!("not estimated: {why}"), remedy: String::new() }
    }

    /// Creates the finding that there is no estimate because the named material (or its curve) lacks `what`.
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
