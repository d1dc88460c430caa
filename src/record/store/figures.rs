//! The figures of a run: `/figures` of its result file.

use hdf5::{File, Group};

use super::Figures;
use super::attributes::describe;
use super::scales::attach;
use crate::record::Profile;

type Hdf<T> = hdf5::Result<T>;

/// Largest number of bytes that [`write`] accepts.
pub(super) fn bytes(figures: &Figures) -> u64 {
    2048 * figures.0.iter().map(|group| 5 + group.figures.len() as u64).sum::<u64>()
}

/// Writes `/figures`: a group for each place, in which every figure is a scalar dataset, and every profile one of one dimension. `gauges` are
/// the names of the gauges' groups.
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

/// The position at which a profile's values stand, over the undeformed length.
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
