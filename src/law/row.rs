//! Advances a row of cells by one step, in chunks of fixed length, for which the compiler removes bounds checks and remainder loops.

use std::ops::Range;

use multiversion::multiversion;

use super::{Aligned, CHUNK, CellLaw, LANES, Response, Steps};

/// Data that a step of a row reads and writes, besides the state.
#[derive(Debug)]
pub struct Row<'a> {
    /// E dt/dx, Pa s/m.
    pub gain: f64,
    /// Velocities of the nodes, m/s: one more than there are cells.
    pub v: &'a [f64],
    /// Stresses, Pa.
    pub sigma: &'a mut [f64],
    /// Set to (`sigma_onset` + `sigma_after`) * E `d_eps_plastic`, Pa^2: the plastic work of the step times 2 E per volume,
    /// and exactly 0 in cells that do not flow. See [`CellLaw::onset`]. `None` unless needed cell by cell; its sum is always returned.
    pub work: Option<&'a mut [f64]>,
    /// Set to the part of the work that is not done by the mean stress of the step: (`sigma_onset` - `sigma_before`) * E `d_eps_plastic`, Pa^2.
    /// `None` unless needed cell by cell.
    pub onset_correction: Option<&'a mut [f64]>,
    /// Set to E `d_eps_plastic`, Pa, in cells that flow by more than rounding, to 0 in others. The values of the previous step only decide by which
    /// operations a result is computed, not the result.
    pub flow: &'a mut [f32],
    /// Range of the cells that are advanced. Of the other cells, only the velocities of shared nodes are read.
    pub cells: Range<usize>,
}

/// Sums and maxima of a row over one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Advanced {
    /// Sum of [`Row::work`] over the cells that were advanced, Pa^2.
    pub work: f64,
    /// Sum of [`Row::onset_correction`] over these cells, Pa^2.
    pub onset_correction: f64,
    /// E times the largest accumulated plastic strain among these cells, Pa.
    pub accumulated: f64,
}

/// Running sums of a row over its chunks. The work is summed in [`LANES`] partial sums, so that its bits do not depend on the width of the
/// processor's registers.
#[derive(Default)]
struct Totals {
    work: [f64; LANES],
    onset_correction: [f64; LANES],
    largest: f64,
}

/// Advances a row by one step, each cell independently of the others.
pub(super) fn advance<L: CellLaw<N>, const N: usize>(law: &L, row: Row<'_>, state: &mut [f64]) -> Advanced {
    let Row { gain, v, sigma, mut work, mut onset_correction, flow, cells: Range { start, end } } = row;
    let mut totals = Totals::default();
    let whole = start..end - (end - start) % CHUNK;
    let few = whole.end..end;
    let asked = [work.as_deref_mut(), onset_correction.as_deref_mut()];
    step(law, gain, v, sigma, flow, state, asked, whole, &mut totals);
    // Remaining cells, fewer than a chunk, are copied into a chunk of their own that is filled up with cells at rest.
    if !few.is_empty() {
        let mut copy = Copied::<N>::of(few.clone(), v, sigma, state);
        let Copied { v, sigma: stresses, state: columns, work: works, onset_correction: corrections, flow: flows } =
            &mut copy;
        let asked = [Some(&mut works[..]), Some(&mut corrections[..])];
        step(law, gain, &v[..], stresses, flows, columns.as_flattened_mut(), asked, 0..CHUNK, &mut totals);
        copy.put_back(few, sigma, flow, state, [work, onset_correction]);
    }
    let [work, onset_correction] = [totals.work, totals.onset_correction].map(|total| total.iter().sum());
    Advanced { work, onset_correction, accumulated: totals.largest }
}

/// Splits the state of a row into one slice per state variable.
#[inline(always)]
fn columns<const N: usize>(state: &mut [f64], cells: usize) -> [&mut [f64]; N] {
    let mut columns = state.chunks_exact_mut(cells);
    std::array::from_fn(|_| columns.next().unwrap_or_default())
}

#[inline(always)]
fn cut(values: &[f64], from: usize) -> &[f64; CHUNK] {
    values[from..].first_chunk().expect("a piece inside the row")
}

#[inline(always)]
fn cut_mut<T>(values: &mut [T], from: usize) -> &mut [T; CHUNK] {
    values[from..].first_chunk_mut().expect("a piece inside the row")
}

#[inline(always)]
fn cut_columns<'a, const N: usize>(columns: &'a mut [&mut [f64]; N], from: usize) -> [&'a mut [f64; CHUNK]; N] {
    let mut columns = columns.iter_mut();
    std::array::from_fn(|_| cut_mut(columns.next().expect("a column for each number"), from))
}

/// Copy of the last cells of a row, fewer than a chunk, filled up to a chunk.
struct Copied<const N: usize> {
    v: [f64; CHUNK + 1],
    sigma: [f64; CHUNK],
    state: [[f64; CHUNK]; N],
    work: [f64; CHUNK],
    onset_correction: [f64; CHUNK],
    flow: [f32; CHUNK],
}

impl<const N: usize> Copied<N> {
    fn of(cells: Range<usize>, v: &[f64], sigma: &[f64], state: &[f64]) -> Self {
        let (n, zeros) = (cells.len(), [0.0; CHUNK]);
        let mut copy = Self {
            v: [v[cells.end]; CHUNK + 1],
            sigma: zeros,
            state: [zeros; N],
            work: zeros,
            onset_correction: zeros,
            flow: [0.0; CHUNK],
        };
        copy.v[..n].copy_from_slice(&v[cells.clone()]);
        copy.sigma[..n].copy_from_slice(&sigma[cells.clone()]);
        for (values, column) in copy.state.iter_mut().zip(state.chunks_exact(sigma.len())) {
            values[..n].copy_from_slice(&column[cells.clone()]);
        }
        copy
    }

    fn put_back(
        &self,
        cells: Range<usize>,
        sigma: &mut [f64],
        flow: &mut [f32],
        state: &mut [f64],
        asked: [Option<&mut [f64]>; 2],
    ) {
        let n = cells.len();
        for (values, column) in self.state.iter().zip(state.chunks_exact_mut(sigma.len())) {
            column[cells.clone()].copy_from_slice(&values[..n]);
        }
        for (asked, values) in asked.into_iter().zip([&self.work, &self.onset_correction]) {
            if let Some(asked) = asked {
                asked[cells.clone()].copy_from_slice(&values[..n]);
            }
        }
        flow[cells.clone()].copy_from_slice(&self.flow[..n]);
        sigma[cells].copy_from_slice(&self.sigma[..n]);
    }
}

/// Returns the state of cell `i` of a chunk.
#[inline(always)]
fn read<const N: usize>(columns: &[&mut [f64; CHUNK]; N], i: usize) -> [f64; N] {
    let mut state = [0.0; N];
    for (value, column) in state.iter_mut().zip(columns) {
        *value = column[i];
    }
    state
}

/// Advances whole chunks of a row by one step. `asked` are [`Row::work`] and [`Row::onset_correction`].
///
/// Each row is an argument of its own, not part of a structure: the compiler then knows that the rows do not overlap, and need not check this in
/// every chunk.
#[expect(clippy::too_many_arguments)]
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
fn step<L: CellLaw<N>, const N: usize>(
    law: &L,
    gain: f64,
    v: &[f64],
    sigma: &mut [f64],
    flow: &mut [f32],
    state: &mut [f64],
    asked: [Option<&mut [f64]>; 2],
    cells: Range<usize>,
    totals: &mut Totals,
) {
    let mut columns = columns::<N>(state, sigma.len());
    let [mut asked_work, mut asked_correction] = asked;
    let [mut predictor, mut abscissa, mut table] = [const { Aligned([0.0; CHUNK]) }; 3];
    let (predictor, abscissa, table) = (&mut predictor.0, &mut abscissa.0, &mut table.0);
    let [mut plastic, mut work, mut turned_work] = [const { Aligned([0.0; CHUNK]) }; 3];
    let (plastic, work, turned_work) = (&mut plastic.0, &mut work.0, &mut turned_work.0);
    for from in cells.step_by(CHUNK) {
        let [left, right] = [cut(v, from), cut(v, from + 1)];
        let (sigma, flow, mut columns) = (cut_mut(sigma, from), cut_mut(flow, from), cut_columns(&mut columns, from));
        let [asked_work, asked_correction] = [&mut asked_work, &mut asked_correction]
            .map(|asked| asked.as_deref_mut().map(|asked| cut_mut(asked, from)));
        // Cells that flowed in the previous step mostly still flow.
        let may_be_elastic = L::BOUNDS_ELASTICITY && !piece_flows(flow);
        if may_be_elastic && let Some(largest) = stay_elastic(law, gain, [left, right], sigma, &columns, predictor) {
            for asked in [asked_work, asked_correction].into_iter().flatten() {
                asked.fill(0.0);
            }
            totals.largest = largest.max(totals.largest);
            continue;
        }
        if L::READS_TABLE {
            for i in 0..CHUNK {
                let increment = gain * (right[i] - left[i]);
                let before = read(&columns, i);
                predictor[i] = law.base(sigma[i], before) + increment;
                abscissa[i] = law.table_abscissa(predictor[i], before);
            }
            law.interpolate(abscissa, predictor, table);
        }
        let steps = L::TAKES_TIME.then(|| timed(law, gain, [left, right], sigma, &columns));
        // Bitwise OR over all cells detects whether any cell flows or has a negative onset: cheaper than comparisons.
        let ([mut onsets, mut flowed], mut most) = ([0_u64; 2], 0);
        for i in 0..CHUNK {
            let (before, sigma_before) = (read(&columns, i), sigma[i]);
            let after = if let Some(steps) = &steps {
                steps.of(i)
            } else if L::READS_TABLE {
                law.return_map(predictor[i], before, table[i])
            } else {
                law.respond(sigma_before, law.base(sigma_before, before) + gain * (right[i] - left[i]), before)
            };
            let onset = law.onset(sigma_before, before, &after);
            // Adding 0.0 turns -0 into +0, so that the sign bit is set for negative numbers only.
            onsets |= (onset + 0.0).to_bits();
            flowed |= after.plastic.to_bits();
            most = most.max(size_bits(law.accumulated(after.state)));
            plastic[i] = after.plastic;
            work[i] = (sigma_before + after.sigma) * after.plastic;
            turned_work[i] = if onset < 0.0 { law.turned_work(before, &after) } else { work[i] };
            flow[i] = flow_of(after.plastic, work[i], after.sigma);
            sigma[i] = after.sigma;
            for (column, value) in columns.iter_mut().zip(after.state) {
                column[i] = value;
            }
        }
        totals.largest = f64::from_bits(most as u64).max(totals.largest);
        if onsets >> 63 != 0 {
            let added = turn(turned_work, work);
            for i in 0..CHUNK {
                flow[i] = flow_of(plastic[i], work[i], sigma[i]);
            }
            add(&mut totals.onset_correction, &added);
            if let Some(onset_correction) = asked_correction {
                *onset_correction = added;
            }
        } else if let Some(onset_correction) = asked_correction {
            onset_correction.fill(0.0);
        }
        // The shift discards the sign.
        if flowed << 1 != 0 {
            add(&mut totals.work, work);
        }
        if let Some(asked) = asked_work {
            *asked = *work;
        }
    }
}

/// Takes the elastic step of a chunk. Returns E times its largest accumulated plastic strain, Pa. Returns `None`, with the stresses unchanged, if a
/// cell may flow.
#[inline(always)]
fn stay_elastic<L: CellLaw<N>, const N: usize>(
    law: &L,
    gain: f64,
    [left, right]: [&[f64; CHUNK]; 2],
    sigma: &mut [f64; CHUNK],
    columns: &[&mut [f64; CHUNK]; N],
    predictor: &mut [f64; CHUNK],
) -> Option<f64> {
    let [mut size, mut least, mut most] = [0, i64::MAX, 0];
    for i in 0..CHUNK {
        let before = read(columns, i);
        predictor[i] = law.base(sigma[i], before) + gain * (right[i] - left[i]);
        size = size.max(size_bits(predictor[i]));
        let accumulated = size_bits(law.accumulated(before));
        least = least.min(accumulated);
        most = most.max(accumulated);
    }
    let [size, least, most] = [size, least, most].map(|bits| f64::from_bits(bits as u64));
    law.is_elastic_up_to(size, least).then(|| {
        *sigma = *predictor;
        most
    })
}

/// Returns the magnitude of a number as bits. They compare as magnitudes do, with faster loops; the bits of NaN compare larger than any number.
#[inline(always)]
fn size_bits(number: f64) -> i64 {
    (number.to_bits() & !(1 << 63)) as i64
}

/// Computes the step of a rate-dependent law: most cells at once, the others one by one.
#[inline(always)]
fn timed<L: CellLaw<N>, const N: usize>(
    law: &L,
    gain: f64,
    [left, right]: [&[f64; CHUNK]; 2],
    sigma: &[f64; CHUNK],
    columns: &[&mut [f64; CHUNK]; N],
) -> Steps<N> {
    let mut predictor = const { Aligned([0.0; CHUNK]) };
    let predictor = &mut predictor.0;
    for i in 0..CHUNK {
        predictor[i] = law.base(sigma[i], read(columns, i)) + gain * (right[i] - left[i]);
    }
    let mut steps = Steps::unknown();
    law.respond_batch(sigma, predictor, columns.each_ref().map(|column| &**column), &mut steps);
    for i in 0..CHUNK {
        if steps.known[i] == 0 {
            steps.set(i, &law.respond_scalar(sigma[i], predictor[i], read(columns, i)));
        }
    }
    steps
}

/// Corrects the work of the few cells whose plastic work is not that of the mean stress of the step. Returns the added work. (Inlined, because the
/// compiler cannot rule out aliasing of the arrays if they are passed to a function.)
#[inline(always)]
fn turn(turned_work: &[f64; CHUNK], work: &mut [f64; CHUNK]) -> [f64; CHUNK] {
    let mut added = *turned_work;
    for (added, work) in added.iter_mut().zip(work.iter()) {
        *added -= work;
    }
    *work = *turned_work;
    added
}

/// Plastic strain of a step that counts as rounding, relative to the elastic strain. A cell that reaches its yield stress exactly has a plastic
/// strain of the order of 1e-16.
const ROUNDING: f64 = 1e-12;

/// Returns true if a cell with this [`Row::work`] and stress (Pa) flowed by more than rounding.
#[inline(always)]
pub fn flows(work: f64, sigma: f64) -> bool {
    work.abs() > ROUNDING * sigma * sigma
}

/// Returns [`Row::flow`] of a cell, given E times its plastic strain (Pa), its [`Row::work`] and its stress (Pa).
#[inline(always)]
fn flow_of(plastic: f64, work: f64, sigma: f64) -> f32 {
    if flows(work, sigma) { plastic as f32 } else { 0.0 }
}

/// Returns true if any cell of a row flows, according to [`Row::flow`].
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
pub fn any_flows(flow: &[f32]) -> bool {
    piece_flows(flow)
}

/// Returns [`any_flows`] for a chunk of a row, for inlining into vectorized loops.
#[inline(always)]
pub fn piece_flows(flow: &[f32]) -> bool {
    // Bits are combined instead of comparing numbers, which gives faster loops. A sign bit alone (-0) is no flow.
    flow.iter().fold(0, |any, flow| any | flow.to_bits()) << 1 != 0
}

/// Adds the values of the cells to the partial sums, lane by lane.
#[inline(always)]
fn add(sums: &mut [f64; LANES], values: &[f64; CHUNK]) {
    for group in values.as_chunks::<LANES>().0 {
        for (sum, value) in sums.iter_mut().zip(group) {
            *sum += value;
        }
    }
}

/// Advances a row by given increments of E times the strain, Pa; `work` is as in [`Row`].
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
pub(super) fn strain<L: CellLaw<N>, const N: usize>(
    law: &L,
    increment: &[f64],
    sigma: &mut [f64],
    state: &mut [f64],
    work: &mut [f64],
) {
    let cells = sigma.len();
    let (increment, work) = (&increment[..cells], &mut work[..cells]);
    let mut columns = columns::<N>(state, cells);
    for column in &columns {
        assert_eq!(column.len(), cells);
    }
    let whole = if L::READS_TABLE { cells - cells % CHUNK } else { 0 };
    let [mut predictor, mut abscissa, mut table] = [const { Aligned([0.0; CHUNK]) }; 3];
    let (predictor, abscissa, table) = (&mut predictor.0, &mut abscissa.0, &mut table.0);
    for from in (0..whole).step_by(CHUNK) {
        let (increment, sigma, work) = (cut(increment, from), cut_mut(sigma, from), cut_mut(work, from));
        let mut columns = cut_columns(&mut columns, from);
        for i in 0..CHUNK {
            let before = read(&columns, i);
            predictor[i] = law.base(sigma[i], before) + increment[i];
            abscissa[i] = law.table_abscissa(predictor[i], before);
        }
        law.interpolate(abscissa, predictor, table);
        for i in 0..CHUNK {
            let before = read(&columns, i);
            let after = law.return_map(predictor[i], before, table[i]);
            (work[i], sigma[i]) = (work_of(law, sigma[i], before, &after), after.sigma);
            for (column, value) in columns.iter_mut().zip(after.state) {
                column[i] = value;
            }
        }
    }
    for i in whole..cells {
        let before: [f64; N] = std::array::from_fn(|k| columns[k][i]);
        let after = law.respond(sigma[i], law.base(sigma[i], before) + increment[i], before);
        (work[i], sigma[i]) = (work_of(law, sigma[i], before, &after), after.sigma);
        for (column, value) in columns.iter_mut().zip(after.state) {
            column[i] = value;
        }
    }
}

/// Returns the plastic work of a step of a cell, as defined in [`Row::work`].
#[inline(always)]
fn work_of<L: CellLaw<N>, const N: usize>(law: &L, sigma: f64, before: [f64; N], after: &Response<N>) -> f64 {
    if law.onset(sigma, before, after) < 0.0 {
        law.turned_work(before, after)
    } else {
        (sigma + after.sigma) * after.plastic
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::rate::{Heated, LAWS, Overstress, RateLaw, Timed, heating};
    use crate::law::{Backbone, Envelope, Indexed, Isotropic, Mixed, PathIndependent, Response, Searched, Table};
    use crate::material::{Beyond, Curve};

    const MODULUS: f64 = 200e9;

    fn table(rows: u32) -> Table {
        let strain = |k: u32| 1e-3 * 50.0_f64.powf(f64::from(k) / f64::from(rows - 1));
        let rows: Vec<(f64, f64)> = (0..rows).map(|k| (strain(k), 200e6 * (strain(k) / 1e-3).powf(0.2))).collect();
        Table::new(&Curve::new(&rows, Beyond::Extend).expect("rows rise"), MODULUS)
    }

    /// Returns pseudorandom numbers between -1 and 1.
    fn noise(seed: usize) -> f64 {
        let bits = (seed as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        ((bits ^ (bits >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9) >> 11) as f64 / 2.0_f64.powi(52) - 1.0
    }

    /// Advances a row many cells at once, with the vector instructions of this processor, and compares the bits with those of single cells.
    fn assert_bits_of_cells<L: CellLaw<N>, const N: usize>(law: &L) {
        for cells in [1, 7, 8, 63, 64, 65, 200, 256] {
            let (mut sigma, mut state) = (vec![0.0; cells], vec![0.0; N * cells]);
            let (mut work, mut onset_correction, mut flow) = (vec![1.0; cells], vec![1.0; cells], vec![7.0; cells]);
            let mut flowed = 0;
            for step in 0..40 {
                let v = if step < 30 { noisy(step, cells) } else { halving(&sigma) };
                let (sigma_before, state_before) = (sigma.clone(), state.clone());
                let row = Row {
                    gain: MODULUS,
                    v: &v,
                    sigma: &mut sigma,
                    work: Some(&mut work),
                    onset_correction: Some(&mut onset_correction),
                    flow: &mut flow,
                    cells: 0..cells,
                };
                let advanced = advance(law, row, &mut state);
                let (mut sums, mut onset_correction, mut largest) = ([0.0; LANES], [0.0; LANES], 0.0_f64);
                for i in 0..cells {
                    let before = std::array::from_fn(|k| state_before[k * cells + i]);
                    let predictor = law.base(sigma_before[i], before) + MODULUS * (v[i + 1] - v[i]);
                    let after = law.respond(sigma_before[i], predictor, before);
                    let turns = law.onset(sigma_before[i], before, &after) < 0.0;
                    let of_mean = (sigma_before[i] + after.sigma) * after.plastic;
                    let of_cell = if turns { law.turned_work(before, &after) } else { of_mean };
                    let after_row: [f64; N] = std::array::from_fn(|k| state[k * cells + i]);
                    assert_eq!((sigma[i], after_row, work[i]), (after.sigma, after.state, of_cell), "cell {i}");
                    let expected = if flows(of_cell, sigma[i]) { after.plastic as f32 } else { 0.0 };
                    assert_eq!(flow[i], expected, "flow of cell {i}");
                    sums[i % LANES] += of_cell;
                    onset_correction[i % LANES] += of_cell - of_mean;
                    largest = largest.max(law.accumulated(after.state));
                    flowed += usize::from(flow[i] != 0.0);
                }
                assert_eq!(
                    advanced,
                    Advanced {
                        work: sums.iter().sum(),
                        onset_correction: onset_correction.iter().sum(),
                        accumulated: largest
                    }
                );
            }
            assert!(flowed > 0, "nothing flowed");
            let size = sigma.iter().fold(0.0, |size: f64, sigma| size.max(sigma.abs()));
            let cell = |i: usize| law.accumulated(std::array::from_fn(|k| state[k * cells + i]));
            let least = (0..cells).map(cell).fold(f64::INFINITY, f64::min);
            assert_eq!(law.is_elastic_up_to(size, least), L::BOUNDS_ELASTICITY, "all cells are unloaded");
            let states = || (0..cells).map(|i| std::array::from_fn(|k| state[k * cells + i]));
            let up_to = law.elastic_up_to(0.0, states());
            for (stress, before) in
                [up_to, -up_to].into_iter().flat_map(|stress| states().map(move |state| (stress, state)))
            {
                let after = law.respond(0.0, law.base(stress, before), before);
                let elastic = Response { sigma: stress, state: before, plastic: 0.0 };
                assert!(up_to == 0.0 || after == elastic, "{after:?}, not {elastic:?}");
            }
        }
    }

    fn noisy(step: usize, cells: usize) -> Vec<f64> {
        (0..=cells).map(|i| 2e-3 * noise(1000 * step + i)).collect()
    }

    /// Returns velocities that halve the stresses.
    fn halving(sigma: &[f64]) -> Vec<f64> {
        let mut v = vec![0.0];
        v.extend(sigma.iter().scan(0.0, |v, sigma| {
            *v -= 0.5 * sigma / MODULUS;
            Some(*v)
        }));
        v
    }

    #[test]
    fn cells_that_do_not_step_are_left_alone() {
        let (law, cells) = (Isotropic(Indexed::new(&table(60)).expect("fits")), 200);
        let v: Vec<f64> = (0..=cells).map(|i| 2e-2 * noise(i)).collect();
        let start = (vec![0.0; cells], vec![0.0; 2 * cells], vec![1.0; cells], vec![7.0; cells]);
        let step = |stepped: Range<usize>| {
            let (mut sigma, mut state, mut work, mut flow) = start.clone();
            let row = Row {
                gain: MODULUS,
                v: &v,
                sigma: &mut sigma,
                work: Some(&mut work),
                onset_correction: None,
                flow: &mut flow,
                cells: stepped,
            };
            advance(&law, row, &mut state);
            (sigma, state, work, flow)
        };
        let whole = step(0..cells);
        for stepped in [64..128, 0..192, 128..200, 64..64] {
            let part = step(stepped.clone());
            for i in 0..cells {
                let expected = if stepped.contains(&i) { &whole } else { &start };
                let cell = |(sigma, state, work, flow): &(Vec<f64>, Vec<f64>, Vec<f64>, Vec<f32>)| {
                    (sigma[i], state[i], state[cells + i], work[i], flow[i])
                };
                assert_eq!(cell(&part), cell(expected), "cell {i} of {stepped:?}");
            }
        }
    }

    fn assert_bits_over<B: Backbone + Clone>(backbone: &B) {
        assert_bits_of_cells(&PathIndependent(backbone.clone()));
        assert_bits_of_cells(&Isotropic(backbone.clone()));
        assert_bits_of_cells(&Mixed { backbone: backbone.clone(), yield_stress: 200e6, kinematic: 0.4 });
    }

    #[test]
    fn a_row_has_the_bits_of_its_cells() {
        assert_bits_over(&Envelope::<4>::new(&table(3)).expect("few lines"));
        assert_bits_over(&Indexed::new(&table(60)).expect("fits"));
        assert_bits_over(&Searched(table(60)));
    }

    #[test]
    fn a_row_of_a_law_that_takes_time_has_the_bits_of_its_cells() {
        for rows in [2, 3, 60] {
            // From a relaxation that is resolved by the steps to one that is not.
            for k in [1e4, 1e6, 1e8] {
                let law = |kinematic| RateLaw::new(Overstress::Malvern { k }, &table(rows), None, kinematic);
                assert_bits_of_cells(&Timed::<5>::new(law(0.0), 1e-7));
                assert_bits_of_cells(&Timed::<6>::new(law(0.5), 1e-7));
            }
            for law in LAWS {
                let [fixed, moving] = [0.0, 0.5].map(|kinematic| RateLaw::new(law, &table(rows), None, kinematic));
                assert_bits_of_cells(&Timed::<5>::new(fixed.clone(), 1e-7));
                assert_bits_of_cells(&Timed::<6>::new(moving.clone(), 1e-7));
                for exponent in [1.0, 1.09] {
                    assert_bits_of_cells(&Heated::<6>::new(fixed.clone(), &heating(exponent), MODULUS, 1e-7));
                    assert_bits_of_cells(&Heated::<7>::new(moving.clone(), &heating(exponent), MODULUS, 1e-7));
                }
            }
        }
    }
}
