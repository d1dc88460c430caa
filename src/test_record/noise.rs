//! The noise of a record, without a model of its curve.

/// Variance of the noise at each row, Pa^2: each stress against the straight line between its neighbours (Gasser, Sroka and
/// Jennen-Steinmetz, Biometrika 73, 1986, 625-633). Single rows far off are bounded.
pub(super) fn variances(rows: &[(f64, f64)]) -> Vec<f64> {
    let mut squares: Vec<f64> = rows.windows(3).map(|three| square(three[0], three[1], three[2])).collect();
    let (Some(&first), Some(&last)) = (squares.first(), squares.last()) else { return vec![0.0; rows.len()] };
    let most = 36.0 * median_of_blocks(&squares);
    for square in &mut squares {
        *square = square.min(most);
    }
    std::iter::once(first.min(most)).chain(squares).chain([last.min(most)]).collect()
}

fn square(a: (f64, f64), b: (f64, f64), c: (f64, f64)) -> f64 {
    let part = (b.0 - a.0) / (c.0 - a.0);
    let off = b.1 - (a.1 + part * (c.1 - a.1));
    off * off / (1.0 + part * part + (1.0 - part) * (1.0 - part))
}

/// The largest median of blocks: noise may grow along the record.
fn median_of_blocks(values: &[f64]) -> f64 {
    let middle = |block: &[f64]| {
        let mut sorted = block.to_vec();
        sorted.sort_by(f64::total_cmp);
        sorted[sorted.len() / 2]
    };
    values.chunks(100).map(middle).fold(0.0, f64::max)
}
