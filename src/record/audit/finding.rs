//! What one of the audit's watches says of its effect.

use super::AuditRow;

/// How large an effect would have been.
#[derive(Debug)]
pub(super) struct Finding {
    /// Relative change of the answer; NaN where it is not known.
    estimate: f64,
    /// For people.
    text: String,
    /// What would bring the effect in; empty where nothing calls for it.
    remedy: String,
}

impl Finding {
    /// The effect would change the answer by so much; `written` is how the scene asks for it.
    pub fn of(estimate: f64, text: String, written: &str) -> Self {
        Self { estimate, text, remedy: format!("Switch on with [effects] {written}") }
    }

    /// It would change nothing, because of this.
    pub fn nothing(text: impl Into<String>) -> Self {
        Self { estimate: 0.0, text: text.into(), remedy: String::new() }
    }

    /// Nobody knows, because of this.
    pub fn unknown(why: impl std::fmt::Display) -> Self {
        Self { estimate: f64::NAN, text: format!("no estimate: {why}"), remedy: String::new() }
    }

    pub fn row(self, effect: &str, threshold: f64) -> AuditRow {
        let Self { estimate, text, remedy } = self;
        AuditRow { effect: effect.to_owned(), estimate, threshold, finding: text, remedy }
    }
}
