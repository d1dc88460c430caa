//! Creation of a result file: attributes, axes, empty datasets and materials.

use std::time::SystemTime;

use hdf5::{Extent, File, Group};

use super::attributes::{FORMAT, describe, identify, put, put_quantity, put_text, put_texts};
use super::filters::shuffled;
use super::scales::Axis;
use super::tables::{self, Column};
use super::{Geometry, Header, Layout, Part, RUNNING, Side, paths, scales};
use crate::record::{Field, MaterialRecord, Precision};
use crate::solver::Energies;
use crate::text_file::NamedFiles;

type Hdf<T> = hdf5::Result<T>;

/// Number of samples in a chunk of the fields. A chunk is a part of one frame, so that a chunk on the disk never
/// changes. HDF5 moves a compressed chunk that is written again, and a process killed between this and the next flush
/// leaves a chunk that cannot be decompressed (1 kill in 5 of a writer at full speed, with chunks of 64 frames).
pub(super) const CHUNK_COLUMNS: usize = 16_384;
/// Number of rows in a chunk of a history. Histories are not compressed, so that a chunk grows in place, for the same reason.
pub(super) const TRACE_ROWS: usize = 1024;
/// Number of rows in a chunk of the frame times and of the ledger.
const FRAME_ROWS: usize = 256;

/// Name of the dimension of the rows of a history.
pub(super) const SAMPLE: &str = "sample";

/// Description of repeated times.
const JUMPS: &str = "non-decreasing; at a repeated time the values jump from the first row to the second";

/// Columns of a gauge history: name, units, long name.
const GAUGE_COLUMNS: [[&str; 3]; 4] =
    [TIME, ["stress", "Pa", "engineering stress, tension positive"], ["strain", "1", "engineering strain"], VELOCITY];
/// Additional column of gauges with the effect of heat.
const GAUGE_TEMPERATURE: [&str; 3] = ["temperature", "K", "temperature"];
const END_COLUMNS: [[&str; 3]; 3] = [TIME, ["stress", "Pa", "engineering stress, tension positive"], VELOCITY];
/// Additional column of the ends of a bar with a known cross-section; in torsion [`END_TORQUE`] replaces it.
const END_FORCE: [&str; 3] = ["force", "N", "axial force, tension positive"];
pub(super) const END_TORQUE: [&str; 3] = ["torque", "N m", "torque in the section"];
const TIME: [&str; 3] = ["time", "s", "time"];
const VELOCITY: [&str; 3] = ["velocity", "m/s", "velocity in +x"];

/// Returns name and long name of each column of the ledger. All are energies except the time, the momenta and the residual.
pub(super) fn ledger_columns() -> impl Iterator<Item = [&'static str; 2]> {
    let after = [
        ["work_left", "work done by the left end since the start"],
        ["work_right", "work done by the right end since the start"],
        ["momentum", "momentum of the bar in +x"],
        ["impulse", "impulse given by both ends, external damping and a foundation since the start"],
        ["residual", "relative energy residual"],
    ];
    [["time", "time"]].into_iter().chain(Energies::COLUMNS.iter().copied()).chain(after)
}

/// Creates everything except the data in a new file.
pub(super) fn build(file: &File, header: &Header, layout: &Layout, materials: &[MaterialRecord]) -> Hdf<()> {
    build_root(file, header, layout.area_given)?;
    let twisted = header.torsion.is_some();
    build_fields(file, layout, twisted)?;
    build_histories(file, layout, twisted)?;
    build_ledger(file, layout, twisted)?;
    build_materials(file, materials, twisted)?;
    build_scene_files(file, &header.files)?;
    if layout.paths {
        paths::build(file, layout.compression)?;
    }
    Ok(())
}

pub(super) fn build_root(file: &File, header: &Header, area_given: bool) -> Hdf<()> {
    identify(file, FORMAT, &header.title)?;
    put_text(file, "created", &timestamp(SystemTime::now()))?;
    put_text(file, "run_id", &run_id(SystemTime::now()))?;
    put_text(file, "scene", &header.scene)?;
    put_text(file, "scene_resolved", &header.scene_resolved)?;
    put_texts(file, "overrides", &header.overrides)?;
    put_texts(file, "effects", &header.effects)?;
    put_texts(file, "notes", &header.notes)?;
    put_text(file, "method", &header.method)?;
    put_text(file, "scheme", &header.scheme)?;
    put_text(file, "energy_units", energy_units(area_given))?;
    if let Some(velocity) = header.critical_velocity {
        put_quantity(file, "critical_velocity", velocity, "m/s")?;
    }
    if let Some(radius) = header.torsion {
        put_text(file, "mode", "torsion")?;
        put_quantity(file, "radius", radius, "m")?;
    }
    put_text(file, "outcome", RUNNING)
}

fn build_fields(file: &File, layout: &Layout, twisted: bool) -> Hdf<()> {
    let time = file.new_dataset::<f64>().chunk(FRAME_ROWS).shape(Extent::resizable(0)).create("time")?;
    describe(&time, "s", "time")?;
    let x = file.new_dataset::<f64>().shape(layout.x.len()).create("x")?;
    x.write_raw(&layout.x)?;
    describe(&x, "m", "Lagrangian coordinate from the left end")?;
    for field in &layout.fields {
        let shape = (Extent::resizable(0), Extent::fixed(layout.x.len()));
        let builder = match layout.precision {
            Precision::F64 => file.new_dataset::<f64>().fill_value(f64::NAN),
            Precision::F32 => file.new_dataset::<f32>().fill_value(f32::NAN),
        };
        let dataset = shuffled(builder, layout.compression)
            .chunk((1, layout.x.len().clamp(1, CHUNK_COLUMNS)))
            .shape(shape)
            .create(field.name())?;
        let long_name = if twisted { field.long_name_in_torsion() } else { field.long_name() };
        describe(&dataset, field.units(), long_name)?;
        if !layout.sampling.is_empty() {
            put_text(&dataset, "sampling", &layout.sampling)?;
        }
    }
    build_geometry(file, &layout.geometry)?;
    let mut data: Vec<(&str, &[&str])> = layout.fields.iter().map(|f| (f.name(), &["time", "x"][..])).collect();
    data.push(("x_bounds", &["x", "bound"]));
    data.extend(layout.geometry.area.as_ref().map(|_| ("area", &["x"][..])));
    scales::attach_axes(file, &[Axis::Coordinate("time"), Axis::Coordinate("x"), Axis::Bare("bound")], &data)
}

/// Writes the cells and cross-sections along the bar, and its segments.
fn build_geometry(file: &File, geometry: &Geometry) -> Hdf<()> {
    let x = file.dataset("x")?;
    put_text(&x, "bounds", "x_bounds")?;
    file.new_dataset::<f32>().shape(2).create("bound")?;
    let bounds = file.new_dataset::<f64>().shape((geometry.bounds.len(), 2)).create("x_bounds")?;
    bounds.write_raw(geometry.bounds.as_flattened())?;
    describe(&bounds, "m", "left and right bound of the cell around each x")?;
    if let Some(area) = &geometry.area {
        let dataset = file.new_dataset::<f64>().shape(area.len()).create("area")?;
        dataset.write_raw(area)?;
        describe(&dataset, "m^2", "cross-section of the undeformed bar")?;
    }
    let number = |name, units, long_name, value: &dyn Fn(&Part) -> f64| {
        Column::numbers(name, units, long_name, geometry.parts.iter().map(value).collect())
    };
    let materials = geometry.parts.iter().map(|part| part.material.clone()).collect();
    let mut columns = vec![
        number("start", "m", "left end of the segment", &|part| part.start),
        number("end", "m", "right end of the segment", &|part| part.end),
        Column::texts("material", "material of the segment", materials),
    ];
    if geometry.area.is_some() {
        for (side, name, long_name) in
            [(0, "area_left", "cross-section of its left end"), (1, "area_right", "of its right end")]
        {
            columns.push(number(name, "m^2", long_name, &|part| part.areas.map_or(f64::NAN, |areas| areas[side])));
        }
    }
    let group = tables::write(file, "bar", "segment", &columns, geometry.parts.len())?;
    let length = group.new_dataset::<f64>().create("length")?;
    length.write_scalar(&geometry.length)?;
    describe(&length, "m", "length of the undeformed bar")
}

/// Returns the columns of the gauges of this file.
pub(super) fn gauge_columns(layout: &Layout) -> Vec<[&'static str; 3]> {
    GAUGE_COLUMNS.into_iter().chain(layout.temperature.then_some(GAUGE_TEMPERATURE)).collect()
}

/// Returns the columns of the ends of this file.
pub(super) fn end_columns(layout: &Layout, twisted: bool) -> Vec<[&'static str; 3]> {
    let load = layout.geometry.end_factors.map(|_| if twisted { END_TORQUE } else { END_FORCE });
    END_COLUMNS.into_iter().chain(load).collect()
}

/// Returns a column of stress, strain or velocity with its description in torsion if `twisted`; other columns unchanged.
fn in_mode(twisted: bool, [name, units, long_name]: [&'static str; 3]) -> [&'static str; 3] {
    let field =
        [Field::Stress, Field::Strain, Field::Velocity].into_iter().find(|field| twisted && field.name() == name);
    [name, units, field.map_or(long_name, Field::long_name_in_torsion)]
}

fn build_histories(file: &File, layout: &Layout, twisted: bool) -> Hdf<()> {
    let gauges = file.create_group("gauges")?;
    let columns: Vec<_> = gauge_columns(layout).into_iter().map(|column| in_mode(twisted, column)).collect();
    for (index, (link, (name, x))) in gauge_links(layout).iter().zip(&layout.gauges).enumerate() {
        let group = gauges.create_group(link)?;
        build_columns(&group, &columns, TRACE_ROWS)?;
        put_quantity(&group, "x", *x, "m")?;
        put(&group, "index", &(index as u32))?;
        put_text(&group, "name", name)?;
    }
    let ends = file.create_group("ends")?;
    for side in [Side::Left, Side::Right] {
        let columns: Vec<_> = end_columns(layout, twisted).into_iter().map(|column| in_mode(twisted, column)).collect();
        build_columns(&ends.create_group(side.name())?, &columns, TRACE_ROWS)?;
    }
    Ok(())
}

fn build_ledger(file: &File, layout: &Layout, twisted: bool) -> Hdf<()> {
    let columns = ledger_columns().map(|[name, long_name]| {
        let units = match (name, layout.area_given) {
            ("time", _) => "s",
            ("residual", _) => "1",
            ("momentum" | "impulse", area_given) => momentum_units(twisted, area_given),
            (_, area_given) => energy_units(area_given),
        };
        let long_name = match name {
            "momentum" if twisted => "angular momentum of the bar",
            "impulse" if twisted => "angular impulse given by both ends since the start",
            _ => long_name,
        };
        [name, units, long_name]
    });
    build_columns(&file.create_group("ledger")?, &columns.collect::<Vec<_>>(), FRAME_ROWS)
}

pub(super) fn momentum_units(twisted: bool, area_given: bool) -> &'static str {
    match (twisted, area_given) {
        (true, _) => "N m s",
        (false, true) => "N s",
        (false, false) => "N s/m^2",
    }
}

pub(super) fn energy_units(area_given: bool) -> &'static str {
    if area_given { "J" } else { "J/m^2" }
}

/// Creates the growing columns of a group over the dimension [`SAMPLE`]; the first column is the time. The time is not
/// a dimension, because readers of whole files require dimensions of one name to be identical, and histories have other
/// times than fields. It is not a coordinate (CF: `coordinates`) either, because rows of a group in
/// `xarray.open_datatree`, which inherits the times of the fields, could then not be indexed. Moreover, a time may
/// occur twice, at a jump.
fn build_columns(group: &Group, columns: &[[&str; 3]], rows: usize) -> Hdf<()> {
    for [name, units, long_name] in columns {
        let builder = group.new_dataset::<f64>().fill_value(f64::NAN);
        describe(&builder.chunk(rows).shape(Extent::resizable(0)).create(*name)?, units, long_name)?;
    }
    let samples = group.new_dataset::<f32>().chunk(rows).shape(Extent::resizable(0)).create(SAMPLE)?;
    put_text(&samples, "long_name", "row number; this dimension has no values")?;
    let names: Vec<&str> = columns.iter().map(|c| c[0]).collect();
    let time = group.dataset(names[0])?;
    put_text(&time, "comment", JUMPS)?;
    let data: Vec<(&str, &[&str])> = names.iter().map(|name| (*name, &[SAMPLE][..])).collect();
    scales::attach_axes(group, &[Axis::Bare(SAMPLE)], &data)
}

/// Writes the files to which a scene refers, so that the scene can be read again from its result alone.
fn build_scene_files(file: &File, files: &NamedFiles) -> Hdf<()> {
    if files.texts.is_empty() {
        return Ok(());
    }
    let (paths, texts) = files.texts.iter().cloned().unzip();
    let columns = [
        Column::texts("path", "path of the file, as the scene names it", paths),
        Column::texts("text", "content of the file", texts),
    ];
    let group = tables::write(file, "scene_files", "file", &columns, files.texts.len())?;
    put_text(&group, "base", &files.base)?;
    files.materials.iter().try_for_each(|folder| put_text(&group, "materials", folder))
}

pub(super) fn build_materials(file: &File, materials: &[MaterialRecord], twisted: bool) -> Hdf<()> {
    let [[.., strain_name], [.., stress_name]] = [2, 1].map(|k: usize| in_mode(twisted, GAUGE_COLUMNS[k]));
    let group = file.create_group("material")?;
    let names = link_names(materials.iter().map(|m| m.name.as_str()));
    for (material, name) in materials.iter().zip(&names) {
        let group = group.create_group(name)?;
        build_branches(&group, material, [strain_name, stress_name])?;
        put_quantity(&group, "density", material.density, "kg/m^3")?;
        put_quantity(&group, "modulus", material.modulus, "Pa")?;
        let provenance = &material.provenance;
        put_text(&group, "name", &material.name)?;
        put_text(&group, "citation", &provenance.citation)?;
        put_text(&group, "measured", &provenance.measured)?;
        put_text(&group, "confidence", &provenance.confidence)?;
        put_text(&group, "origin", &provenance.origin)?;
    }
    Ok(())
}

/// Writes the curve as a single signed one, and as magnitudes for each sense.
fn build_branches(group: &Group, material: &MaterialRecord, names: [&str; 2]) -> Hdf<()> {
    let of_sense = |sense: &str, k: usize| {
        let quantity = names[k].split(',').next().unwrap_or_default();
        (format!("{sense}_{}", ["strain", "stress"][k]), format!("magnitude of the {quantity} in {sense}"))
    };
    let column = |name: &str, k: usize, long_name: &str, values: &[f64]| -> Hdf<()> {
        let dataset = group.new_dataset::<f64>().shape(values.len()).create(name)?;
        dataset.write_raw(values)?;
        describe(&dataset, ["1", "Pa"][k], long_name)
    };
    column("strain", 0, names[0], &material.strain)?;
    column("stress", 1, names[1], &material.stress)?;
    scales::attach(group, &["strain"], &["stress"])?;
    for (sense, branch) in [("tension", &material.tension), ("compression", &material.compression)] {
        let [strain, stress] = [0, 1].map(|k| of_sense(sense, k));
        column(&strain.0, 0, &strain.1, &branch[0])?;
        column(&stress.0, 1, &stress.1, &branch[1])?;
        scales::attach(group, &[&strain.0], &[&stress.0])?;
    }
    Ok(())
}

pub(super) fn gauge_links(layout: &Layout) -> Vec<String> {
    link_names(layout.gauges.iter().map(|(name, _)| name.as_str()))
}

/// Converts names into unique names of groups: no slash, no leading dot, not empty.
fn link_names<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut links: Vec<String> = Vec::new();
    for name in names {
        let mut base = name.replace(['/', '\0'], "-");
        if base.is_empty() || base.starts_with('.') {
            base.insert(0, '_');
        }
        let mut link = base.clone();
        let mut number = 2;
        while links.contains(&link) {
            link = format!("{base}-{number}");
            number += 1;
        }
        links.push(link);
    }
    links
}

/// Returns an identifier that differs for every run: a checkpoint belongs to the file of exactly one run.
fn run_id(now: SystemTime) -> String {
    let nanoseconds = now.duration_since(SystemTime::UNIX_EPOCH).map_or(0, |d| d.as_nanos());
    format!("{nanoseconds:x}-{:x}", std::process::id())
}

/// Returns the time in UTC in the format of ISO 8601, to the second.
fn timestamp(now: SystemTime) -> String {
    let seconds = now.duration_since(SystemTime::UNIX_EPOCH).map_or(0, |d| d.as_secs());
    let (year, month, day) = civil_from_days((seconds / 86_400).cast_signed());
    let (hour, minute, second) = (seconds / 3600 % 24, seconds / 60 % 60, seconds % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

/// Returns year, month and day for a number of days since 1970-01-01 (Hinnant's algorithm, proleptic Gregorian
/// calendar: years start in March, so that the leap day is the last day).
fn civil_from_days(days: i64) -> (i64, i64, i64) {
    let shifted = days + 719_468;
    let era = shifted.div_euclid(146_097);
    let day_of_era = shifted.rem_euclid(146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    (year_of_era + era * 400 + i64::from(month <= 2), month, day)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn timestamps_are_civil_utc() {
        let at = |seconds| timestamp(SystemTime::UNIX_EPOCH + Duration::from_secs(seconds));
        assert_eq!(at(0), "1970-01-01T00:00:00Z");
        assert_eq!(at(951_782_399), "2000-02-28T23:59:59Z");
        assert_eq!(at(951_782_400), "2000-02-29T00:00:00Z");
        assert_eq!(at(1_709_251_199), "2024-02-29T23:59:59Z");
        assert_eq!(at(4_107_542_400), "2100-03-01T00:00:00Z");
    }

    #[test]
    fn link_names_are_safe_and_differ() {
        let links = link_names(["a/b", "a-b", "", ".x", "a/b"].into_iter());
        assert_eq!(links, ["a-b", "a-b-2", "_", "_.x", "a-b-3"]);
    }
}
