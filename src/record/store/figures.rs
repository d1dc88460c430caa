//! Figures of a run: `/figures` of its result file.

use hdf5::{Dataset, File, Group};

use super::Figures;
use super::attributes::{describe, get, get_text};
use super::read::{ResultFile, gauge_groups};
use super::scales::attach;
use crate::error::Result;
use crate::record::Profile;

type Hdf<T> = hdf5::Result<T>;

/// Returns an upper bound of the bytes that [`write`] adds to the file.
pub(super) fn bytes(figures: &Figures) -> u64 {
    2048 * figures.0.iter().map(|group| 5 + group.figures.len() as u64).sum::<u64>()
}

/// Writes `/figures`: one group for each place, in which every figure is a scalar dataset and every profile a
/// one-dimensional one. `gauges` are the names of the groups of the gauges.
pub(super) fn write<'a>(file: &File, figures: &Figures, mut gauges: impl Iterator<Item = &'a String>) -> Hdf<()> {
    file.create_group("figures")?;
    for group in &figures.0 {
        let mut path = group.path.clone();
        if let [first, name] = &mut path[..]
            && first == "gauges"
            && let Some(link) = gauges.next()
        {
            name.clone_from(link);
        }
        let mut place = file.group("figures")?;
        for name in &path {
            place = if place.link_exists(name) { place.group(name)? } else { place.create_group(name)? };
        }
        if let Some(profile) = &group.profile {
            write_profile(&place, profile)?;
        }
        for figure in &group.figures {
            let dataset = place.new_dataset::<f64>().create(figure.name)?;
            dataset.write_scalar(&figure.value)?;
            describe(&dataset, &figure.dimension.units(), figure.description)?;
        }
    }
    Ok(())
}

/// Name of the dataset with the positions of a profile's values, relative to the undeformed length.
const POSITION: &str = "relative_position";

fn write_profile(place: &Group, profile: &Profile) -> Hdf<()> {
    let count = profile.values.len();
    let middles: Vec<f64> = (0..count).map(|k| (k as f64 + 0.5) / count as f64).collect();
    let texts = [(POSITION, "centre of each tenth of the undeformed bar, relative to its length", &middles)];
    for (name, description, values) in texts.into_iter().chain([(profile.name, profile.description, &profile.values)]) {
        let dataset = place.new_dataset::<f64>().shape(count).create(name)?;
        dataset.write_raw(values)?;
        describe(&dataset, "1", description)?;
    }
    attach(place, &[POSITION], &[profile.name])
}

/// Figure as read from a file.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredFigure {
    /// Name without the unit.
    pub name: String,
    /// Description.
    pub long_name: String,
    /// SI unit; "1" for dimensionless numbers.
    pub units: String,
    /// Value in SI units.
    pub value: f64,
}

/// Figures of one place of a bar, as read from a file.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredPlace {
    /// Kind of the place: "left", "right", "joints", "gauges", "segments" or "fragments"; empty for the whole bar.
    pub kind: &'static str,
    /// Number, or name of a gauge, if there are several places of this kind; otherwise empty.
    pub name: String,
    /// Figures in the order of their names.
    pub figures: Vec<StoredFigure>,
}

/// Returns the scalar datasets of a group in the order of their attribute `index`; those without it in the order of their names.
pub(super) fn scalars(group: &Group) -> Hdf<Vec<StoredFigure>> {
    let datasets = group.datasets()?;
    let read = |dataset: &Dataset| {
        let name = dataset.name().rsplit('/').next().unwrap_or_default().to_owned();
        let (long_name, units) = (get_text(dataset, "long_name")?, get_text(dataset, "units")?);
        let index = get::<u32>(dataset, "index").unwrap_or(0);
        Ok((index, StoredFigure { name, long_name, units, value: dataset.read_scalar()? }))
    };
    let mut figures =
        datasets.iter().filter(|dataset| dataset.is_scalar()).map(read).collect::<Hdf<Vec<(u32, StoredFigure)>>>()?;
    figures.sort_by_key(|(index, _)| *index);
    Ok(figures.into_iter().map(|(_, figure)| figure).collect())
}

impl ResultFile {
    /// Returns the figures of a run of a bar, place by place; empty for an unfinished file.
    ///
    /// # Errors
    /// An error if the file cannot be read.
    pub fn figures(&self) -> Result<Vec<StoredPlace>> {
        self.run(|file| {
            if !file.link_exists("figures") {
                return Ok(Vec::new());
            }
            let all = file.group("figures")?;
            let mut places = vec![StoredPlace { kind: "", name: String::new(), figures: scalars(&all)? }];
            for kind in ["left", "right"].into_iter().filter(|kind| all.link_exists(kind)) {
                places.push(StoredPlace { kind, name: String::new(), figures: scalars(&all.group(kind)?)? });
            }
            for kind in ["joints", "gauges", "segments", "fragments"].into_iter().filter(|kind| all.link_exists(kind)) {
                let group = all.group(kind)?;
                for (link, name) in names(file, &group, kind)? {
                    places.push(StoredPlace { kind, name, figures: scalars(&group.group(&link)?)? });
                }
            }
            Ok(places)
        })
    }
}

/// Returns the links to the places of a kind and their names, in the order of the scene. HDF5 lists links in alphabetical order, 10 before 2.
fn names(file: &File, group: &Group, kind: &str) -> Hdf<Vec<(String, String)>> {
    if kind == "gauges" {
        let gauges = gauge_groups(file)?.into_iter().filter(|(link, _)| group.link_exists(link));
        return gauges.map(|(link, gauge)| Ok((link, get_text(&gauge, "name")?))).collect();
    }
    let mut links = group.member_names()?;
    links.sort_by_key(|link| link.parse::<u64>().ok());
    Ok(links.into_iter().map(|link| (link.clone(), link)).collect())
}
