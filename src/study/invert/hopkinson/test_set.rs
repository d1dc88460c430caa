//! Bars, specimen and gauge records of a split-Hopkinson test.

use serde::Serialize;

use crate::input::{Allowed, Checked, member, positive};
use crate::study::invert::given::check_record;
use crate::units::Dimension::{Area, Density, Length, Stress};

/// An elastic bar and its gauge.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct ElasticBar {
    /// Elastic modulus, Pa.
    #[serde(rename = "modulus_Pa")]
    pub modulus: f64,
    /// Density, kg/m^3.
    #[serde(rename = "density_kg_m3")]
    pub density: f64,
    /// Area of the section, m^2.
    #[serde(rename = "area_m2")]
    pub area: f64,
    /// Distance from the gauge to the specimen, m.
    #[serde(rename = "gauge_to_specimen_m")]
    pub distance: f64,
}

impl ElasticBar {
    /// Returns the elastic wave speed, m/s.
    pub fn c0(&self) -> f64 {
        (self.modulus / self.density).sqrt()
    }

    /// Returns the travel time of the elastic wave between gauge and specimen, s.
    pub(super) fn delay(&self) -> f64 {
        self.distance / self.c0()
    }

    /// Checks the values of the bar; `name` is used in error keys.
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
    /// Length of the specimen, m.
    #[serde(rename = "specimen_length_m")]
    pub length: f64,
    /// Area of the specimen's section, m^2.
    #[serde(rename = "specimen_area_m2")]
    pub area: f64,
}

/// Times (s, not decreasing) and strains of a gauge.
pub type Record = (Vec<f64>, Vec<f64>);

/// Records of both gauges.
#[derive(Debug, Clone, Default)]
pub struct Records {
    /// Record of the gauge on the incident bar.
    pub incident: Record,
    /// Record of the gauge on the transmission bar.
    pub transmitted: Record,
}
