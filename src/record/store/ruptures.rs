//! Fractures: `/ruptures` of a result file.

use hdf5::File;

use super::create::energy_units;
use super::read::ResultFile;
use super::tables::{self, Column, numbers, texts};
use crate::error::Result;
use crate::law::rupture::Rupture;

/// Fracture as read from a file.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredRupture {
    /// Site: "left end", "right end", "joint 1", ..., "segment 1", ...
    pub site: String,
    /// Criterion that was met.
    pub cause: String,
    /// Time of the fracture, s.
    pub time: f64,
    /// Position in the undeformed bar, m.
    pub x: f64,
    /// Engineering stress at the fracture, Pa.
    pub stress: f64,
    /// Engineering strain at the fracture.
    pub strain: f64,
}

pub(super) fn write(file: &File, ruptures: &[Rupture], area_given: bool) -> hdf5::Result<()> {
    let number = |name: &str, units, long_name: &str, value: fn(&Rupture) -> f64| {
        Column::numbers(name, units, long_name, ruptures.iter().map(value).collect())
    };
    let columns = [
        Column::texts("site", "end, joint or segment", ruptures.iter().map(|r| r.site.to_string()).collect()),
        Column::texts("cause", "criterion that was met", ruptures.iter().map(|r| r.cause.name().to_owned()).collect()),
        number("time", "s", "time of the rupture", |r| r.time),
        number("x", "m", "position in the undeformed bar", |r| r.x),
        number("stress", "Pa", "engineering stress at the rupture", |r| r.stress),
        number("strain", "1", "engineering strain at the rupture", |r| r.strain),
        number("absorbed", "J/m^3", "energy per volume absorbed there", |r| r.absorbed),
        number("bar_absorbed", energy_units(area_given), "strain energy and plastic work of the whole bar", |r| {
            r.bar_absorbed
        }),
    ];
    tables::write(file, "ruptures", "rupture", &columns, ruptures.len()).map(|_| ())
}

impl ResultFile {
    /// Returns the fractures in order of time; empty for an unfinished file, or if fracture was not simulated.
    ///
    /// # Errors
    /// An error if the file cannot be read.
    pub fn ruptures(&self) -> Result<Vec<StoredRupture>> {
        self.run(|file| {
            if !file.link_exists("ruptures") {
                return Ok(Vec::new());
            }
            let group = file.group("ruptures")?;
            let (sites, causes) = (texts(&group, "site")?, texts(&group, "cause")?);
            let [time, x, stress, strain] = ["time", "x", "stress", "strain"].map(|name| numbers(&group, name));
            let columns = [time?, x?, stress?, strain?];
            let rows = sites.into_iter().zip(causes).enumerate().map(|(row, (site, cause))| {
                let [time, x, stress, strain] =
                    [0, 1, 2, 3].map(|column: usize| columns[column].get(row).copied().unwrap_or(f64::NAN));
                StoredRupture { site, cause, time, x, stress, strain }
            });
            Ok(rows.collect())
        })
    }
}
