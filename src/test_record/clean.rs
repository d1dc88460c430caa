//! Cleaning of a record: negative signs, outliers, unloading and the rows after the fracture are removed, and the rows are sorted by strain.

/// Number of rows on either side of a row with which it is compared to detect outliers.
const NEIGHBOURS: usize = 3;

/// An outlier differs from the median of its neighbours by more than this fraction of the largest value ...
const OUTLIER: f64 = 0.05;

/// ... and by more than this number of standard deviations of the noise.
const OUTLIER_NOISE: f64 = 8.0;

/// A yield peak rises by at most this factor times the smaller of the two preceding steps; an outlier rises suddenly.
const LED_UP_TO: f64 = 1.5;

/// During unloading, the strain falls below its previous maximum by more than this number of standard deviations of its noise ...
const UNLOADING_NOISE: f64 = 6.0;

/// ... and by more than this fraction of the largest strain.
const UNLOADING: f64 = 1e-5;

/// A fracture is a fall of the force by more than this factor times the usual change between rows (ISO 6892-1:2019, A.3.6.3) ...
const FRACTURE_STEP: f64 = 5.0;

/// ... and by at least this fraction of the largest force; the whole fall is at least [`FRACTURE`] of it.
const FRACTURE_STEP_LEAST: f64 = 0.01;

/// Fall over the largest force below which it is not a fracture.
const FRACTURE: f64 = 0.1;

/// If more than this fraction of the force is still carried at twice the strain, the fall is that of an upper yield point, not a fracture.
const CARRIED: f64 = 0.5;

/// A test that was stopped ends with strain and stress that fall along the elastic slope, within this factor. At a fracture the strain stays
/// constant or rises, or springs back so suddenly that no two rows lie within half of the fall.
const ELASTIC: f64 = 3.0;

/// Stresses over the largest stress between which the elastic slope is evaluated for this purpose.
const SLOPE_BETWEEN: [f64; 2] = [0.05, 0.15];

/// Rows sorted by strain, and the changes made to them.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Cleaned {
    /// (strain, stress), strain increasing.
    pub rows: Vec<(f64, f64)>,
    /// Number of rows of the record with the same strain of which each row is the mean.
    pub of_one_strain: Vec<usize>,
    /// Whether the record ends with a fracture.
    pub fractured: bool,
    /// One sentence for each change.
    pub changes: Vec<String>,
}

/// Cleans a record: takes magnitudes, removes outliers, the rows after the fracture, and unloading and reloading, and sorts the rows by strain.
pub(super) fn clean(record: &[(f64, f64)]) -> Cleaned {
    let mut changes = Vec::new();
    let mut rows = magnitudes(record, &mut changes);
    without_outliers(&mut rows, &mut changes);
    let fractured = cut_at_fracture(&mut rows, &mut changes);
    without_unloading(&mut rows, &mut changes);
    let held = without_held(&mut rows, &mut changes);
    let of_one_strain = sort(&mut rows, &mut changes);
    // A fracture while the strain is held occurs at an unknown strain.
    Cleaned { rows, of_one_strain, fractured: fractured && !held, changes }
}

/// Returns "1 row", "2 rows".
pub(super) fn count(rows: usize) -> String {
    if rows == 1 { "1 row".into() } else { format!("{rows} rows") }
}

/// Sentence for a record whose negative signs were removed.
pub(super) const NEGATIVE_SIGNS: &str = "negative signs removed: curves are given as magnitudes";

/// Removes negative signs of one column or both, with which compression is often recorded.
fn magnitudes(record: &[(f64, f64)], changes: &mut Vec<String>) -> Vec<(f64, f64)> {
    let sign = |pick: fn(&(f64, f64)) -> f64| {
        let extreme = record.iter().map(pick).fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
        if extreme < 0.0 { -1.0 } else { 1.0 }
    };
    let (strain, stress) = (sign(|row| row.0), sign(|row| row.1));
    if strain < 0.0 || stress < 0.0 {
        changes.push(NEGATIVE_SIGNS.into());
    }
    record.iter().map(|&(e, s)| (strain * e, stress * s)).collect()
}

/// Removes single rows far from their neighbours in strain or stress.
fn without_outliers(rows: &mut Vec<(f64, f64)>, changes: &mut Vec<String>) {
    let before = rows.len();
    for pick in [(|row| row.0) as fn(&(f64, f64)) -> f64, |row| row.1] {
        let values: Vec<f64> = rows.iter().map(pick).collect();
        let largest = values.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let limit = (OUTLIER * largest).max(OUTLIER_NOISE * noise(&values));
        let medians = running_median(&values, NEIGHBOURS);
        let off = |k: usize| (values[k] - medians[k]).abs() > limit;
        // The first and the last rows have neighbours on one side only, and a fracture there would look like an outlier.
        let inner = NEIGHBOURS..values.len().saturating_sub(NEIGHBOURS);
        let mut keep = vec![true; values.len()];
        for k in inner.filter(|k| off(*k)) {
            keep[k] =
                keep[k - NEIGHBOURS..k] == [true; NEIGHBOURS] && is_led_up_to(&values[k - NEIGHBOURS..=k + 1], limit);
        }
        let mut place = 0;
        rows.retain(|_| {
            place += 1;
            keep[place - 1]
        });
    }
    if rows.len() < before {
        changes.push(format!(
            "{} removed as outliers (more than 5 % from the median of 7 neighbours)",
            count(before - rows.len())
        ));
    }
}

/// Whether the last but one of five values continues the steep line of those before, or is the peak at its end, such as an upper yield point.
fn is_led_up_to(values: &[f64], limit: f64) -> bool {
    let [first, second, third, value, after] = *values else { return false };
    let rises = value > third && value - third <= LED_UP_TO * (third - second).min(second - first);
    rises && (after < value || (value - 0.5 * (third + after)).abs() <= limit)
}

/// Returns the standard deviation of the noise of a series: the median of its second differences over that of white noise.
fn noise(values: &[f64]) -> f64 {
    let mut seconds: Vec<f64> = values.windows(3).map(|v| (v[0] - 2.0 * v[1] + v[2]).abs()).collect();
    // 0.6745 is the median of |x| of a standard normal x; a second difference has 6 times the variance.
    median(&mut seconds) / (0.6745 * 6.0_f64.sqrt())
}

fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Returns the median of each value and `reach` neighbours on either side (fewer at the ends).
fn running_median(values: &[f64], reach: usize) -> Vec<f64> {
    let around = |k: usize| median(&mut values[k.saturating_sub(reach)..(k + reach + 1).min(values.len())].to_vec());
    (0..values.len()).map(around).collect()
}

/// Removes the rows after the one at which the force falls for good. Returns true if there is such a row.
fn cut_at_fracture(rows: &mut Vec<(f64, f64)>, changes: &mut Vec<String>) -> bool {
    let stress: Vec<f64> = rows.iter().map(|row| row.1).collect();
    let smooth = running_median(&stress, NEIGHBOURS);
    let Some(top) = (0..smooth.len()).max_by(|a, b| smooth[*a].total_cmp(&smooth[*b])) else { return false };
    let largest = smooth[top];
    let mut steps: Vec<f64> = stress.windows(2).map(|s| (s[1] - s[0]).abs()).collect();
    let step = (FRACTURE_STEP * median(&mut steps)).max(FRACTURE_STEP_LEAST * largest);
    let falls = |k: usize| stress[k] - stress[k + 1] > step;
    // After a fracture the previous force is not reached again.
    let mut highest_after = vec![f64::NEG_INFINITY; stress.len() + 1];
    for k in (0..stress.len()).rev() {
        highest_after[k] = highest_after[k + 1].max(stress[k]);
    }
    let first = top.saturating_sub(NEIGHBOURS);
    let last_strain = rows[rows.len() - 1].0;
    let carries_on = |k: usize, end: usize| highest_after[end] > CARRIED * stress[k] && last_strain > 2.0 * rows[k].0;
    let Some(last) = (first..stress.len().saturating_sub(1)).find(|&k| {
        let end = (k..stress.len() - 1).take_while(|&j| falls(j)).last().map_or(k, |j| j + 1);
        let for_good = highest_after[end] < stress[k] - FRACTURE * largest && !carries_on(k, end);
        end > k && stress[k] - stress[end] > FRACTURE * largest && for_good
    }) else {
        return false;
    };
    let last = last_of_neck(&stress, last);
    if is_unloading(rows, last, elastic_slope(rows, &smooth, largest)) {
        return false;
    }
    let removed = rows.len() - last - 1;
    rows.truncate(last + 1);
    changes.push(format!("{} after the fracture removed (abrupt fall of the force)", count(removed)));
    true
}

/// Returns an approximate elastic slope: that of the chord between two small stresses on the way to the largest.
fn elastic_slope(rows: &[(f64, f64)], smooth: &[f64], largest: f64) -> f64 {
    let reaches = |part: f64| smooth.iter().position(|&stress| stress >= part * largest).unwrap_or(0);
    let [low, high] = SLOPE_BETWEEN.map(reaches);
    let (low, high) = (low.saturating_sub(1), high.max(low + 1).min(rows.len() - 1));
    (rows[high].1 - rows[low].1) / (rows[high].0 - rows[low].0)
}

/// Whether the strain falls with the stress from this row on, over several rows, roughly along the elastic slope.
fn is_unloading(rows: &[(f64, f64)], last: usize, slope: f64) -> bool {
    let (strain, stress) = rows[last];
    let Some(lowest) = rows[last..].iter().map(|row| row.1).min_by(f64::total_cmp) else { return false };
    let reached = |part: f64| rows[last..].iter().position(|row| stress - row.1 >= part * (stress - lowest));
    let along = |row: usize| {
        let (fallen, back) = (stress - rows[last + row].1, strain - rows[last + row].0);
        back > 0.0 && (1.0 / ELASTIC..=ELASTIC).contains(&(slope * back / fallen))
    };
    reached(0.5).is_some_and(|row| row > 1 && along(row)) && reached(1.0).is_some_and(along)
}

/// Returns the row, from `first` on, at which the force starts to fall more abruptly than in the rows before `first`. Between sparse rows of a neck
/// the force can fall by as much as in a fracture, and these rows belong to the neck.
fn last_of_neck(stress: &[f64], first: usize) -> usize {
    let fall = |k: usize| stress[k] - stress[k + 1];
    let mut before: Vec<f64> = (first.saturating_sub(2 * NEIGHBOURS)..first).map(|k| fall(k).abs()).collect();
    let usual = FRACTURE_STEP * median(&mut before);
    let end = stress.len() - 1;
    let abrupt = (first..end).find(|&k| fall(k) > usual || fall(k) <= 0.0);
    abrupt.filter(|&k| fall(k) > usual).unwrap_or(first)
}

/// Removes the rows between the start of an unloading and the return to the strain before it.
fn without_unloading(rows: &mut Vec<(f64, f64)>, changes: &mut Vec<String>) {
    let strain: Vec<f64> = rows.iter().map(|row| row.0).collect();
    let largest = strain.iter().copied().fold(0.0, f64::max);
    let limit = (UNLOADING_NOISE * noise(&strain)).max(UNLOADING * largest);
    let (mut keep, mut loops) = (vec![true; rows.len()], 0);
    let (mut top, mut k) = (0, 1);
    while k < strain.len() {
        if strain[k] > strain[top] {
            top = k;
        } else if strain[top] - strain[k] > limit {
            let back = (k..strain.len()).find(|&j| strain[j] >= strain[top]).unwrap_or(strain.len());
            keep[top + 1..back].fill(false);
            loops += 1;
            top = back.min(strain.len() - 1);
            k = back;
        }
        k += 1;
    }
    let mut place = 0;
    rows.retain(|_| {
        place += 1;
        keep[place - 1]
    });
    let removed = strain.len() - rows.len();
    if removed > 0 {
        let times = if loops == 1 { "one unloading".into() } else { format!("{loops} unloadings") };
        changes.push(format!("{} of {times} removed", count(removed)));
    }
}

/// The largest strain is held if more than [`HELD_LEAST`] rows have it, and more than this factor times the rows of any other strain. A strain rate
/// that falls by this factor within one step of rounding is that of a stopped machine.
const HELD: usize = 4;
const HELD_LEAST: usize = 10;

/// Removes the rows after the first one with the largest strain if that strain is held: by an extensometer at its limit, while the specimen is
/// stretched further, or by the machine, while the stress relaxes. Returns true if it is.
fn without_held(rows: &mut Vec<(f64, f64)>, changes: &mut Vec<String>) -> bool {
    let mut strains: Vec<f64> = rows.iter().map(|row| row.0).collect();
    strains.sort_by(f64::total_cmp);
    let mut sizes: Vec<usize> = strains.chunk_by(|a, b| a == b).map(<[_]>::len).collect();
    let (last, most) = (sizes.pop().unwrap_or(0), sizes.iter().copied().max().unwrap_or(0));
    if last <= HELD_LEAST.max(HELD * most) {
        return false;
    }
    let largest = strains[strains.len() - 1];
    let first = rows.iter().position(|row| row.0 == largest);
    let mut place = 0;
    rows.retain(|row| {
        place += 1;
        row.0 < largest || Some(place - 1) == first
    });
    changes.push(format!(
        "{} at the largest strain, {largest:.5}, removed after the first: the extensometer is at its limit, or the strain is held",
        count(last - 1)
    ));
    true
}

/// Sorts by strain and averages rows of equal strain. Returns the number of rows of each strain.
fn sort(rows: &mut Vec<(f64, f64)>, changes: &mut Vec<String>) -> Vec<usize> {
    let falling = rows.windows(2).filter(|pair| pair[1].0 < pair[0].0).count();
    let before = rows.len();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mean = |same: &[(f64, f64)]| (same[0].0, same.iter().map(|row| row.1).sum::<f64>() / same.len() as f64);
    let of_one_strain = rows.chunk_by(|a, b| a.0 == b.0).map(<[_]>::len).collect();
    *rows = rows.chunk_by(|a, b| a.0 == b.0).map(mean).collect();
    if falling > 0 {
        changes.push(format!("{} of falling strain, within its noise, sorted by strain", count(falling)));
    }
    if rows.len() < before {
        changes.push(format!("{} of a strain given twice averaged", count(before - rows.len())));
    }
    of_one_strain
}

#[cfg(test)]
mod tests {
    use super::*;

    fn straight(rows: u32) -> Vec<(f64, f64)> {
        (0..rows).map(|i| (1e-4 * f64::from(i), 1e6 * f64::from(i))).collect()
    }

    #[test]
    fn rows_at_the_limit_of_the_extensometer_are_removed() {
        // 10 MPa per step; the extensometer ends at 40 steps, and the specimen breaks at 90.
        let strain = |k: u32| 1e-3 * f64::from(k.min(40));
        let stress = |k: u32| if k < 90 { 10e6 * f64::from(k) } else { 0.0 };
        let cleaned = clean(&(0..100).map(|k| (strain(k), stress(k))).collect::<Vec<_>>());
        assert_eq!((cleaned.rows.last(), cleaned.fractured), (Some(&(0.04, 400e6)), false), "{:?}", cleaned.changes);
        // Rounded strains: 12 rows have each strain, 20 the last one.
        let rounded: Vec<_> = (0..500_u32).map(|k| (f64::from(k.min(491) / 12), f64::from(k))).collect();
        let cleaned = clean(&rounded);
        assert!(cleaned.rows.last().is_some_and(|last| last.1 > 489.0), "{:?}", cleaned.rows.last());
    }

    #[test]
    fn a_clean_record_stays_as_it_is() {
        let record = straight(100);
        assert_eq!(
            clean(&record),
            Cleaned { rows: record, of_one_strain: vec![1; 100], fractured: false, changes: Vec::new() }
        );
    }

    /// Elastic rows in steps of 20 MPa up to a peak, then a plateau 40 MPa below it.
    fn with_yield_peak() -> Vec<(f64, f64)> {
        let rows = (0..100).map(|i| (1e-4 * f64::from(i), if i <= 15 { 20e6 * f64::from(i) } else { 260e6 }));
        rows.collect()
    }

    #[test]
    fn a_yield_peak_of_one_row_is_neither_outlier_nor_fracture() {
        let record = with_yield_peak();
        let cleaned = clean(&record);
        assert_eq!((&cleaned.rows, cleaned.fractured), (&record, false), "{:?}", cleaned.changes);
        // On the elastic line, before, at and behind its end, and on the plateau.
        for (place, stress) in [(8, 250e6), (8, 80e6), (14, 310e6), (16, 350e6), (17, 300e6), (60, 290e6), (60, 230e6)]
        {
            let mut wrong = record.clone();
            wrong[place].1 = stress;
            let cleaned = clean(&wrong);
            assert!(!cleaned.rows.contains(&wrong[place]), "{place}, {stress}: {:?}", cleaned.changes);
        }
    }

    /// Tests that stop while the stress rises end with it; a fracture may be recorded in as many rows, at the strain at which it happens.
    #[test]
    fn a_last_unloading_is_no_fracture() {
        let mut loaded = straight(30);
        loaded.extend((0..570).map(f64::from).map(|i| (3e-3 + 1e-4 * i, 29e6 + 0.03e6 * i)));
        let (strain, stress) = loaded[loaded.len() - 1];
        for (rows, down_to, springs_back) in [
            (4, 0.0, true),
            (10, 0.5, true),
            (40, 0.5, true),
            (40, 0.0, true),
            (200, 0.0, true),
            (4, 0.0, false),
            (40, 0.0, false),
        ] {
            let fall = (1..=rows).map(|i| (1.0 - down_to) * stress * f64::from(i) / f64::from(rows));
            let slope = if springs_back { 1e10 } else { f64::INFINITY };
            let mut record = loaded.clone();
            record.extend(fall.map(|fall| (strain - fall / slope, stress - fall)));
            let cleaned = clean(&record);
            let said = cleaned.changes.join("; ");
            assert_eq!(cleaned.fractured, !springs_back, "{rows} rows to {down_to}: {said}");
            assert_eq!(said.contains(&format!("{rows} rows of one unloading removed")), springs_back, "{said}");
        }
    }

    /// In a neck between sparse rows the force fell by more than 1 % from row to row, and four rows were removed instead of two.
    #[test]
    fn a_neck_is_not_part_of_the_fracture() {
        let mut record: Vec<(f64, f64)> = (0..300).map(|i| (1e-5 * f64::from(i), 1e6 * f64::from(i))).collect();
        let neck = (0..40).map(f64::from).map(|i| (0.003 + 0.005 * i, 300e6 - 0.1e6 * i * i));
        record.extend(neck);
        let whole = record.clone();
        let (strain, stress) = record[record.len() - 1];
        record.extend([(strain + 1e-4, 0.3 * stress), (strain + 2e-4, 1e6)]);
        let cleaned = clean(&record);
        assert!(cleaned.fractured && cleaned.rows == whole, "{:?}", cleaned.changes);
    }

    #[test]
    fn compression_unloading_outliers_and_fracture_are_found() {
        let mut record = straight(200);
        for (e, s) in &mut record[100..] {
            (*e, *s) = (*e, 100e6 + 0.1 * (*s - 100e6));
        }
        let clean_rows = record.clone();
        // From row 150 down and up again, 20 rows.
        let (e, s) = record[150];
        let down = (1..=10).map(|i| (e - 1e-5 * f64::from(i), s - 2e6 * f64::from(i)));
        let around: Vec<_> = down.clone().chain(down.rev().skip(1)).collect();
        record.splice(151..151, around);
        record[60].1 *= 2.0;
        record.extend([(0.0200, 60e6), (0.0201, 3e6), (0.0202, 0.0)]);
        let negative: Vec<_> = record.iter().map(|&(e, s)| (-e, -s)).collect();
        let cleaned = clean(&negative);
        assert!(cleaned.fractured);
        let expected: Vec<_> = clean_rows.iter().enumerate().filter(|(k, _)| *k != 60).map(|(_, row)| *row).collect();
        assert_eq!(cleaned.rows, expected, "{:?}", cleaned.changes);
        let all = cleaned.changes.join("\n");
        for part in
            ["negative signs", "1 row removed as outliers", "3 rows after the fracture", "19 rows of one unloading"]
        {
            assert!(all.contains(part), "{part}: {all}");
        }
    }
}
