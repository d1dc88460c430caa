//! Histories recorded during the integration of an impact on a beam.

use super::Beam;
use super::approximation::HalfSine;
use super::extremes::{Extremes, Peak, Peaks};
use super::shape::{Place, Readings};
use crate::bar::Hertz;
use crate::impact::contact::Moment;
use crate::impact::oscillator::Oscillator;
use crate::impact::pulse::Pulse;
use crate::impact::solution::{Shapes, Table};
use crate::units::Dimension::{Force, Length, None as Plain, Torque, Velocity};

/// Number of points of a deflected shape.
const PLACES: usize = 101;

/// Names of the columns read at a gauge.
const READINGS: [&str; 3] = ["deflection", "moment", "strain"];

/// All histories so far.
pub(super) struct Observer {
    law: Hertz,
    pulse: HalfSine,
    pulses: Vec<(Oscillator, Pulse)>,
    /// The modes at the end of the half-sine pulse.
    pulsed: Vec<Oscillator>,
    struck: Place,
    gauges: Vec<Place>,
    line: Vec<Place>,
    /// Requested number of deflected shapes.
    asked: Option<usize>,
    shape_every: f64,
    shape_due: f64,
    start: f64,
    /// Extremes at the gauges, and at the point of impact if the yield stress is known.
    extremes: Extremes,
    finest: f64,
    pub contact: Table,
    pub ledger: Table,
    pub readings: Vec<Table>,
    pub shapes: Shapes,
}

fn contact_table() -> Table {
    Table::over_time(
        "contact",
        [
            ("force", Force, "contact force, integrated", "contact force"),
            ("force_half_sine", Force, "contact force, half-sine pulse (9.22)", "contact force"),
            ("approach", Length, "approach; negative while sphere and beam are separated", ""),
            ("striker_displacement", Length, "displacement of the striker", "displacements"),
            ("deflection", Length, "deflection of the beam at the impact", "displacements"),
            ("striker_velocity", Velocity, "velocity of the striker", "velocity of the striker"),
        ],
    )
}

fn ledger_table() -> Table {
    Table::ledger([
        ("striker", "kinetic energy of the striker"),
        ("contact", "elastic energy of the contact"),
        ("beam", "kinetic and elastic energy of the beam and its foundation"),
        ("damping", "energy dissipated by damping"),
    ])
}

fn gauge_table(name: &str, x: f64) -> Table {
    let columns = [
        ("deflection", Length, "deflection, integrated", "deflection at the gauges"),
        ("moment", Torque, "bending moment, integrated", "bending moment at the gauges"),
        ("strain", Plain, "strain of the face away from the striker, integrated", "strain at the gauges"),
        ("deflection_half_sine", Length, "deflection by the half-sine pulse (9.24)", "deflection at the gauges"),
        ("moment_half_sine", Torque, "bending moment by the half-sine pulse", ""),
        ("strain_half_sine", Plain, "strain by the half-sine pulse", "strain at the gauges"),
    ];
    Table { x: Some(x), ..Table::over_time(format!("gauges/{name}"), columns) }
}

/// Returns the number of columns of all histories with this number of gauges.
pub(super) fn columns(gauges: usize) -> usize {
    contact_table().columns.len() + ledger_table().columns.len() + gauges * gauge_table("", 0.0).columns.len()
}

/// Returns the largest value of a column over time of one sign, and its time, if it is reached in contact: the vertex of the parabola through the
/// largest sample and its neighbours, or the sample itself if these are farther apart than the finest steps of free flight. Returns zeros if it is
/// reached in free flight, in which the motion between samples is known.
fn vertex(table: &Table, column: &str, (force, finest): (&[f64], f64), sign: f64) -> [f64; 2] {
    let (time, values) = (table.own("time"), table.own(column));
    // The first of equal samples.
    let larger = |a: usize, b: usize| if sign * values[b] > sign * values[a] { b } else { a };
    let Some(i) = (0..values.len()).reduce(larger).filter(|&i| sign * values[i] > 0.0 && force[i] > 0.0) else {
        return [0.0, 0.0];
    };
    let sample = [values[i], time[i]];
    if i == 0 || i + 1 == values.len() {
        return sample;
    }
    let (before, after) = (time[i - 1] - time[i], time[i + 1] - time[i]);
    if after - before > 2.001 * finest {
        return sample;
    }
    let (low, high) = (values[i - 1] - values[i], values[i + 1] - values[i]);
    // slope t + bend t^2 passes through both neighbours.
    let bend = (high / after - low / before) / (after - before);
    let slope = high / after - bend * after;
    let vertex = -0.5 * slope / bend;
    // The parabola is not valid outside its three samples; for equal samples the vertex is NaN.
    if (before..=after).contains(&vertex) { [values[i] + 0.5 * slope * vertex, time[i] + vertex] } else { sample }
}

impl Observer {
    pub fn new(beam: &Beam, count: usize, pulse: HalfSine, end: f64) -> Self {
        let x: Vec<f64> = (0..PLACES).map(|i| beam.length * i as f64 / (PLACES - 1) as f64).collect();
        let line = if beam.shapes == 0 { Vec::new() } else { x.iter().map(|&x| beam.place(x, count)).collect() };
        let pulses = if beam.gauges.is_empty() { Vec::new() } else { beam.pulses(&pulse, count) };
        let struck = beam.place(beam.at, count);
        let gauges: Vec<Place> = beam.gauges.iter().map(|(_, x)| beam.place(*x, count)).collect();
        let mut places: Vec<(Place, Readings)> = gauges.iter().map(|gauge| (gauge.clone(), [0.0; 3])).collect();
        // At the point of impact only strains above yield are of interest.
        places.extend(beam.yield_strain().map(|strain| (struck.clone(), [f64::INFINITY, f64::INFINITY, strain])));
        let finest = beam.finest();
        Self {
            law: beam.contact(),
            pulse,
            pulsed: pulses.iter().map(|driven| pulse.drives(driven, pulse.duration)).collect(),
            pulses,
            struck,
            gauges,
            line,
            asked: (beam.shapes > 0).then_some(beam.shapes),
            shape_every: end / beam.shapes.max(1) as f64,
            shape_due: end / beam.shapes.max(1) as f64,
            start: 0.5 * beam.striker.mass * beam.striker.velocity.powi(2),
            extremes: Extremes::new(&places, [finest, end]),
            finest,
            contact: contact_table(),
            ledger: ledger_table(),
            readings: beam.gauges.iter().map(|(name, x)| gauge_table(name, *x)).collect(),
            shapes: Shapes { x, ..Shapes::default() },
        }
    }

    pub fn look(&mut self, moment: &Moment<'_>) {
        let Some((striker, modes)) = moment.system.modes.split_first() else { return };
        let (time, force) = (moment.time, moment.force);
        let [deflection, ..] = self.struck.read(modes, force);
        let half_sine = self.pulse.force(time);
        self.contact.push(&[time, force, half_sine, moment.approach, striker.q, deflection, striker.v]);
        self.extremes.look(modes, force, [time, moment.flown]);
        self.balance(moment, striker, modes);
        self.gauge(time, force, modes);
        self.shape(time, force, modes);
    }

    /// Stores the deflected shape if one is due. When more than twice the requested number are stored, every second one is discarded.
    fn shape(&mut self, time: f64, force: f64, modes: &[Oscillator]) {
        let Some(asked) = self.asked.filter(|_| time >= self.shape_due * (1.0 - 1e-12)) else { return };
        self.shapes.time.push(time);
        self.shapes.deflection.extend(self.line.iter().map(|place| place.read(modes, force)[0]));
        if self.shapes.time.len() > 2 * asked {
            let Shapes { time, deflection, .. } = &mut self.shapes;
            let kept = |i: &usize| i % 2 == 1;
            *time = (0..time.len()).filter(kept).map(|i| time[i]).collect();
            *deflection = deflection.chunks(PLACES).skip(1).step_by(2).flatten().copied().collect();
            self.shape_every *= 2.0;
        }
        self.shape_due = self.shape_every * (self.shapes.time.len() + 1) as f64;
    }

    fn balance(&mut self, moment: &Moment<'_>, striker: &Oscillator, modes: &[Oscillator]) {
        let (kinetic, stored) = (striker.energy(), self.law.energy(moment.approach));
        let tail = 0.5 * moment.system.compliance * moment.force * moment.force;
        let beam = modes.iter().map(Oscillator::energy).sum::<f64>() + tail;
        let damped = moment.system.damped;
        let residual = (kinetic + stored + beam + damped - self.start) / self.start;
        self.ledger.push(&[moment.time, kinetic, stored, beam, damped, residual]);
    }

    fn gauge(&mut self, time: f64, force: f64, modes: &[Oscillator]) {
        let since = time - self.pulse.duration;
        let driven: Vec<Oscillator> = if since > 0.0 {
            self.pulsed.iter().map(|mode| mode.after(since)).collect()
        } else {
            self.pulses.iter().map(|driven| self.pulse.drives(driven, time)).collect()
        };
        let half_sine = self.pulse.force(time);
        for (place, table) in self.gauges.iter().zip(&mut self.readings) {
            let [w, m, e] = place.read(modes, force);
            let [ws, ms, es] = place.read(&driven, half_sine);
            table.push(&[time, w, m, e, ws, ms, es]);
        }
    }

    /// Returns the reading of largest magnitude at a gauge, the first of equal ones; in contact, that of the parabola through the largest sample
    /// and its neighbours.
    pub fn largest(&self, gauge: usize, reading: usize) -> Peak {
        let mut peaks: Peaks = self.extremes.peaks[gauge][reading];
        let contact = (self.contact.own("force"), self.finest);
        for sign in [1.0, -1.0] {
            let [value, time] = vertex(&self.readings[gauge], READINGS[reading], contact, sign);
            peaks.note(value, time);
        }
        peaks.largest()
    }

    /// Returns the largest bending strain at the gauges, and at the point of impact if the yield stress is known.
    pub fn strain(&self) -> f64 {
        self.extremes.peaks.iter().fold(0.0, |most, peaks| most.max(peaks[2].largest().value.abs()))
    }
}
