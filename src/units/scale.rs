//! Units in which numbers are shown, and the SI values of the inch-pound ones.

/// A display unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Symbol, e.g. "MPa"; empty for plain numbers.
    pub symbol: &'static str,
    /// SI value of one such unit.
    pub si: f64,
}

pub(super) const INCH: f64 = 0.0254;
pub(super) const POUND: f64 = 0.453_592_37;
pub(super) const POUND_FORCE: f64 = POUND * 9.806_65;
pub(super) const FOOT_POUND: f64 = 12.0 * INCH * POUND_FORCE;
pub(super) const PSI: f64 = POUND_FORCE / (INCH * INCH);
