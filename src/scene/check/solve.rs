//! The solution method, its keys, and whether it supports the scene.

use super::super::capability::{Asked, Solver, method_can};
use super::super::raw::{RawMethod, RawScheme, RawSolve};
use super::super::{Method, Solve, Tolerance};
use super::Checker;
use crate::bar::Bar;
use crate::error::Result;
use crate::input::GivenKey;
use crate::typed::Placed;

/// Largest number of steps of a run: with a thousand cells they take about ten days.
const MOST_STEPS: f64 = 1e12;

impl RawSolve {
    /// Returns whether the scheme muscl is requested.
    fn is_muscl(&self) -> bool {
        self.scheme.as_ref().is_some_and(|scheme| *scheme.get_ref() == RawScheme::Muscl)
    }
}

impl RawMethod {
    fn word(self) -> &'static str {
        match self {
            Self::Fd => "fd",
            Self::Moc => "moc",
        }
    }

    /// Returns the keys of this method in addition to `until` and `method`, with or without the effect `rate`.
    fn keys(self, rate: bool) -> &'static [&'static str] {
        match (self, rate) {
            (Self::Fd, _) => &["scheme", "cells", "cfl"],
            (Self::Moc, false) => &["front-tolerance", "max-events"],
            (Self::Moc, true) => &["cells"],
        }
    }
}

impl Checker<'_> {
    pub(super) fn solve(&self, raw: &Placed<RawSolve>, asked: &Asked<'_>) -> Result<Solve> {
        let (span, raw) = (raw.span(), raw.get_ref());
        let Some(until) = &raw.until else {
            let help = "add the end time, e.g. until = \"200 us\"; an elastic wave needs length/c0 to cross the bar";
            return Err(self.missing(span, "solve.until", help));
        };
        let until = self.si(until)?;
        let tolerance = self.tolerance(raw)?;
        let rate = asked.effects.rate.is_some();
        // A net resolves the fronts of rate-dependent bars within one cell.
        let default = if rate && Solver::Net.can(asked) { RawMethod::Moc } else { RawMethod::Fd };
        let method = raw.method.as_ref().map_or(default, |m| *m.get_ref());
        method_can(self.document, raw, Solver::of(method, raw.is_muscl(), rate), asked)?;
        self.only_keys_of(method, rate)?;
        let method = match (method, rate) {
            (RawMethod::Fd, _) => self.on_a_grid(raw)?,
            (RawMethod::Moc, false) => self.front_tracking(raw)?,
            (RawMethod::Moc, true) => Method::CharacteristicNet { cells: self.cells(raw)? },
        };
        // The errors due to neglected effects should not exceed the requested tolerance.
        let default = tolerance.as_ref().map_or(Solve::AUDIT_TOLERANCE, |t| t.value);
        let audit_tolerance = self.si(&raw.audit_tolerance)?.unwrap_or(default);
        Ok(Solve { until, method, tolerance, estimate_error: false, audit_tolerance })
    }

    /// Checks the number of time steps up to the end time; front tracking has none.
    pub(super) fn steps_can_be_taken(&self, raw: &RawSolve, solve: &Solve, bar: &Bar) -> Result<()> {
        let (cells, cfl) = match solve.method {
            Method::Leapfrog { cells, cfl } | Method::Muscl { cells, cfl } => (cells, cfl),
            Method::CharacteristicNet { cells } => (cells, 1.0),
            Method::FrontTracking { .. } => return Ok(()),
        };
        let steps = solve.until * cells as f64 / (cfl * bar.transit_time());
        let Some(until) = raw.until.as_ref().filter(|_| steps > MOST_STEPS) else { return Ok(()) };
        let message = format!("the run would take {steps:.1e} steps of {cells} cells");
        let error = self.error(until.span(), "solve.until", message).allowed(format!("at most {MOST_STEPS:e} steps"));
        Err(error.help("use a shorter time or fewer cells, and check length, modulus and density").into())
    }

    /// Reads the tolerance, which replaces a method and its keys. The caller determines its methods.
    fn tolerance(&self, raw: &RawSolve) -> Result<Option<Tolerance>> {
        let Some(value) = self.si(&raw.tolerance)? else { return Ok(None) };
        if let Some(GivenKey { name, value: span, .. }) = self.given(&["method"]).next() {
            let message =
                format!("`{name}` and `tolerance` are both given; `tolerance` selects the method and its settings");
            let help =
                format!("remove one of them (on the command line: --set solve.{name}= or --set solve.tolerance=)");
            let error = self.error(span.clone(), &format!("solve.{name}"), message).allowed("until and tolerance");
            return Err(error.help(help).into());
        }
        Ok(Some(Tolerance { value, methods: Vec::new() }))
    }

    fn on_a_grid(&self, raw: &RawSolve) -> Result<Method> {
        let cells = self.cells(raw)?;
        let cfl = self.si(&raw.cfl)?;
        Ok(if raw.is_muscl() { Method::Muscl { cells, cfl } } else { Method::Leapfrog { cells, cfl } })
    }

    fn cells(&self, raw: &RawSolve) -> Result<usize> {
        self.count_of_cells(&raw.cells)
    }

    fn front_tracking(&self, raw: &RawSolve) -> Result<Method> {
        let event_budget = self.si(&raw.event_budget)? as u64;
        Ok(Method::FrontTracking { front_tolerance: self.si(&raw.front_tolerance)?, event_budget })
    }

    fn only_keys_of(&self, method: RawMethod, rate: bool) -> Result<()> {
        let foreign = self.given(&[]).find(|given| !method.keys(rate).contains(&&*given.name));
        let Some(GivenKey { name, value: span, .. }) = foreign else { return Ok(()) };
        let (word, out) = (method.word(), format!("remove `{name}` (on the command line: --set solve.{name}=)"));
        let (message, help) = if rate && method == RawMethod::Fd {
            (format!("`{name}` does not apply to a rate-dependent bar, in which no fronts are tracked"), out)
        } else if rate {
            let help = if RawMethod::Fd.keys(rate).contains(&&**name) {
                format!("use method = \"fd\", which supports it, or {out}")
            } else {
                out
            };
            (format!("`{name}` does not apply to a rate-dependent bar on a characteristic net, method = \"moc\""), help)
        } else {
            let other = if method == RawMethod::Fd { RawMethod::Moc } else { RawMethod::Fd };
            let help = format!("use method = \"{}\", which supports it, or {out}", other.word());
            (format!("`{name}` does not apply to method = \"{word}\""), help)
        };
        let allowed = format!("until, method, {}, audit-tolerance", method.keys(rate).join(", "));
        Err(self.error(span.clone(), &format!("solve.{name}"), message).allowed(allowed).help(help).into())
    }

    /// Returns the keys of methods that are given, including those of `others`, with the positions of their values.
    fn given(&self, others: &[&str]) -> impl Iterator<Item = &GivenKey> {
        let of_methods = [(RawMethod::Fd, false), (RawMethod::Moc, false)];
        let keys: Vec<&str> =
            of_methods.iter().flat_map(|(method, rate)| method.keys(*rate)).chain(others).copied().collect();
        self.keys[1].iter().filter(move |given| keys.contains(&&*given.name))
    }
}
