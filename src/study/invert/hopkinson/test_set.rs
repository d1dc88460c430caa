//! Bars, specimen and gauge records of a split-Hopkinson test.

use serde::Serialize;

use crate::input::{Allowed, Checked, member, positive};
use crate::study::invert::given::check_record;
use crate::units::Dimension::{Area, Density, Length, Stress};

/// An elastic bar and the gauge on it.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct ElasticBar {
    /// Pa.
    #[serde(rename = "modulus_Pa")]
    pub modulus: f64,
    /// kg/m^3.
    #[serde(rename = "density_kg_m3")]
    pub density: f64,
    /// m^2.
    #[serde(rename = "area_m2")]
    pub area: f64,
    /// From the gauge to the specimen, m.
    #[serde(rename = "gauge_to_specimen_m")]
    pub distance: f64,
}

impl ElasticBar {
    /// m/s.
    pub fn c0(&self) -> f64 {
        (self.modulus / self.density).sqrt()
    }

    /// Time of the elastic wave between gauge and specimen, s.
    pub(super) fn delay(&self) -> f64 {
        self.distance / self.c0()
    }

    /// Of this name.
    fn check(&self, name: &str) -> Checked {
        let [modulus, density, area] = ["modulus", "density", "area"].map(|member| format!("{name}.{member}"));
        positive([(&modulus, self.modulus, Stress), (&density, self.density, Density), (&area, self.area, Area)])?;
        member(&format!("{name}.distance"), self.distance, Length, Allowed::NotNegative)
    }
}

impl Setup {
    pub(super) fn check(&self) -> Checked {
        self.incident.check("incident")?;
        self.transmitted.check("transmitted")?;
        positive([("length", self.length, Length), ("area", self.area, Area)])
    }
}

impl Records {
    pub(super) fn check(&self) -> Checked {
        [("incident", &self.incident), ("transmitted", &self.transmitted)]
            .into_iter()
            .try_for_each(|(name, (time, strain))| check_record(name, time, strain))
    }
}

/// Bars and specimen.
#[derive(Debug, Clone, Serialize)]
pub struct Setup {
    /// Incident bar.
    pub incident: ElasticBar,
    /// Transmission bar.
    pub transmitted: ElasticBar,
    /// m.
    #[serde(rename = "specimen_length_m")]
    pub length: f64,
    /// m^2.
    #[serde(rename = "specimen_area_m2")]
    pub area: f64,
}

/// Times (s, not decreasing) and strains of a gauge.
pub type Record = (Vec<f64>, Vec<f64>);

/// The records of both gauges.
#[derive(Debug, Clone, Default)]
pub struct Records {
    /// Of the gauge on the incident bar.
    pub incident: Record,
    /// The same of the transmission bar's.
    pub transmitted: Record,
}
