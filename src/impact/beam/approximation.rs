//! The half-sine approximation: coefficient of restitution by (9.31), contact force by (9.22), response by (9.24).

use std::f64::consts::PI;

use super::{Beam, Face};
use crate::impact::oscillator::Oscillator;
use crate::impact::plate::disturbed;
use crate::impact::pulse::Pulse;
use crate::impact::solution::{Figure, Line, Solution, ratio};
use crate::units::Dimension::{Force, None as Plain, Time, Velocity};

/// Length over depth, and distance of the impact from a support over depth, below which bending theory is inaccurate.
const LEAST_SLENDERNESS: f64 = 10.0;
const LEAST_DEPTHS: f64 = 2.0;
/// Wavelength of the flexural waves of the contact over the depth, below which bending theory is inaccurate.
const LEAST_WAVE: f64 = 10.0;

/// Disturbed radius of a plate over half the width of a beam, below which the beam responds as a plate: at this ratio it absorbs 9 % more energy.
const MOST_SPREAD: f64 = 1.8;
/// Width over length above which the beam responds as a plate under static forces: at this ratio it deflects by 10 % more.
const MOST_WIDTH: f64 = 1.25;

/// Largest number of modes in the sums of (9.31).
const MOST_MODES: usize = 100_000;

/// The half-sine contact force m v (1 + e) pi/(2 tau) sin(pi t/tau).
#[derive(Debug, Clone, Copy)]
pub(super) struct HalfSine {
    /// Duration tau, s.
    pub duration: f64,
    /// Coefficient of restitution e by (9.31).
    pub restitution: f64,
    /// Impulse, N s.
    pub impulse: f64,
}

impl HalfSine {
    /// Returns the contact force at time t, N.
    pub fn force(&self, t: f64) -> f64 {
        let rate = PI / self.duration;
        if t < self.duration { 0.5 * self.impulse * rate * (rate * t).sin() } else { 0.0 }
    }

    /// Returns the state at a time of a mode under the pulse, at rest at t = 0.
    pub fn drives(&self, (mode, pulse): &(Oscillator, Pulse), time: f64) -> Oscillator {
        let [q, v] = pulse.at(time).map(|value| self.impulse * mode.shape / mode.mass * value);
        Oscillator { q, v, ..*mode }
    }

    pub fn peak(&self) -> f64 {
        0.5 * PI * self.impulse / self.duration
    }
}

impl Beam {
    /// Returns the half-sine pulse. Its duration, tau of (9.30), is computed from the definition 4 pi/5 a/v with Hertz's largest approach a, for
    /// which the pulse has the peak of Hertz's force. (The printed factor 3.28 is 1.5 % above the one that follows from this, 3.2318.)
    pub(super) fn half_sine(&self) -> HalfSine {
        let (mass, velocity) = (self.striker.mass, self.striker.velocity);
        let duration = 0.8 * PI * self.contact().largest_approach(mass, velocity) / velocity;
        let ratio = mass / self.modal_mass();
        let mut sum = 0.0;
        for (n, mode) in (1_u32..).zip(self.oscillators(MOST_MODES)) {
            let [phi, psi] = mode.phi_psi(duration);
            sum += mode.shape * mode.shape * (phi + psi);
            // Phi and Psi decrease at least as n^-4 for modes faster than the pulse.
            if n % 2 == 1 && f64::from(n) * (phi + psi) < 1e-10 * sum && mode.omega * duration > 20.0 {
                break;
            }
        }
        let restitution = (1.0 - ratio * sum) / (1.0 + ratio * sum);
        HalfSine { duration, restitution, impulse: mass * velocity * (1.0 + restitution) }
    }

    /// Returns the first `count` modes with the pulse acting on each.
    pub(super) fn pulses(&self, pulse: &HalfSine, count: usize) -> Vec<(Oscillator, Pulse)> {
        self.bending_modes(count).map(|mode| (mode, Pulse::new(mode.omega, mode.delta, pulse.duration))).collect()
    }

    /// Returns the results that need no integration.
    pub(super) fn approximation(&self) -> Solution {
        let pulse = self.half_sine();
        let mut solution = Solution {
            scheme: "timoshenko",
            equation: self.equation(),
            validity: "Euler-Bernoulli beam, simply supported: wavelengths long compared with the depth; elastic contact, \
                       small compared with the sphere; (9.31) needs a single contact that ends before reflections from the \
                       supports return"
                .into(),
            ..Solution::default()
        };
        let [omega, delta] = self.frequency(1);
        solution.lines.push(Line::new("lowest mode", "period {}", &[(2.0 * PI / omega, Time)]));
        if delta > 0.0 {
            let part = |n: usize| (self.frequency(n)[1] / self.frequency(n)[0], Plain);
            let text = "mode 1 {}, mode 3 {}, mode 9 {}, mode 27 {} of critical";
            solution.lines.push(Line::new("damping", text, &[part(1), part(3), part(9), part(27)]));
        }
        let figure = |name, dimension, long_name, value| Figure::new(name, dimension, long_name, value);
        solution.figures.extend([
            figure("lowest_period", Time, "period of the lowest mode, undamped", 2.0 * PI / omega),
            figure("lowest_damping", Plain, "damping ratio of the lowest mode", delta / omega),
            figure("half_sine_restitution", Plain, "coefficient of restitution by (9.31)", pulse.restitution),
            figure("half_sine_duration", Time, "duration of the half-sine pulse, (9.30)", pulse.duration),
            figure("half_sine_peak_force", Force, "largest force of the half-sine pulse, (9.22)", pulse.peak()),
            figure(
                "half_sine_striker_velocity",
                Velocity,
                "velocity of the striker after the half-sine pulse",
                -pulse.restitution * self.striker.velocity,
            ),
        ]);
        let values = [(pulse.restitution, Plain), (pulse.peak(), Force), (pulse.duration, Time)];
        solution.lines.push(Line::new("half-sine (9.22)", "e {} by (9.31), largest force {}, duration {}", &values));
        solution.warnings.extend(self.is_not_slender());
        solution.warnings.extend(self.excites_short_waves());
        solution.warnings.extend(self.is_wide());
        solution.warnings.extend(self.modes.map(|_| {
            "`solve.modes` fixes the number of modes: the error is not estimated, and `solve.tolerance` of the result is not checked".into()
        }));
        solution
    }

    /// Warns if shear and local deformation are not small compared with bending.
    fn is_not_slender(&self) -> Option<String> {
        let [slender, near] =
            [self.length, self.at.min(self.length - self.at)].map(|length| length / self.section.depth);
        let what = if slender < LEAST_SLENDERNESS {
            format!("the beam is {} times as long as deep", ratio(slender, 4))
        } else if near < LEAST_DEPTHS {
            format!("the beam is struck {} of its depth from a support", ratio(near, 4))
        } else {
            return None;
        };
        Some(format!("{what}: Euler-Bernoulli theory neglects shear deformation, which is not small there"))
    }

    /// Warns if the flexural waves of a contact are not long; their frequency is the one of which Hertz's contact time is half a period. The share
    /// of the energy was determined for steel beams of rectangular section: sums over the modes of Timoshenko beams, with light balls, differ from
    /// those of this program by 10, 13, 29, 42 and 59 % at wavelengths of 5.7, 5.1, 3.6, 2.9 and 2.5 depths, and by less with balls that lose more
    /// of their velocity.
    fn excites_short_waves(&self) -> Option<String> {
        let line = self.elastic.density * self.section.area;
        let wave = 2.0 * PI * (self.bending() / line).powf(0.25) / (PI / self.contact_time()).sqrt();
        let depths = wave / self.section.depth;
        let more = 370.0 / (depths * depths);
        let size = if more < 70.0 {
            format!(
                "up to about {more:.0} % more of the energy goes into the beam, and strains differ by 10 % and more"
            )
        } else {
            "most of the energy that goes into the beam, and its strains, are unknown here".into()
        };
        (depths < LEAST_WAVE).then(|| {
            format!(
                "the flexural waves of the contact are {depths:.2} times as long as the beam is deep: with shear deformation and \
                 rotary inertia, which Euler-Bernoulli theory neglects, {size}"
            )
        })
    }

    /// Warns if a rectangular beam also bends across its width, like a plate. The energies are those of a thin strip with free edges, struck in the
    /// middle by Hertz's pulse, relative to those of the beam, from sums over the modes across the width with a Poisson's ratio of 0.3: 3.7, 1.9,
    /// 1.45, 1.16 and 1.03 at a disturbed radius of 0.5, 1, 1.4, 1.7 and 1.9 half widths. The static deflections at midspan, from the same sums,
    /// are 1.01, 1.10, 1.52 and 3.68 times that of the beam at a width of 1, 1.25, 2 and 5 lengths.
    fn is_wide(&self) -> Option<String> {
        let Face::Flat { width } = self.section.face else { return None };
        let (spread, long) = (self.disturbed_radius() / (0.5 * width), width / self.length);
        if !width.is_finite() || spread >= MOST_SPREAD && long <= MOST_WIDTH {
            return None;
        }
        if spread < MOST_SPREAD {
            let energy = if spread < 1.0 { 1.9 / spread } else { 1.9 - 1.1 * (spread - 1.0) };
            return Some(format!(
                "the disturbed radius of a plate of this thickness, (9.8), is {} of half the width at the end of Hertz's contact: the \
                 beam responds as a plate, and up to about {} times the energy goes into it",
                ratio(spread, 3),
                ratio(energy, 2)
            ));
        }
        let deflection = 0.735 * long + 0.36 * long.powi(-3);
        Some(format!(
            "the beam is {} times as wide as long: it bends across its width, too, and a force at midspan deflects it about {} \
             times as far",
            ratio(long, 3),
            ratio(deflection, 2)
        ))
    }

    /// Returns the disturbed radius (9.8) of a plate as thick as the depth of the beam at the end of Hertz's contact, m.
    fn disturbed_radius(&self) -> f64 {
        disturbed(self.contact_time(), self.section.depth, &self.elastic).sqrt()
    }

    fn equation(&self) -> String {
        let along = if self.is_plain() {
            "(9.18), Timoshenko's integral equation, with the modes of the beam weighted by sin^2(n pi x0/l)"
        } else {
            "(9.23) and (9.24) for the beam in place of (9.16) in Timoshenko's integral equation (9.18), with the weights \
             sin^2(n pi x0/l)"
        };
        let contact = match self.section.face {
            Face::Flat { .. } => "",
            Face::Round => "; Hertz's elliptical contact of sphere and cylinder",
        };
        format!(
            "{along}{contact}; for comparison, the half-sine pulse (9.22) with the coefficient of restitution (9.31)"
        )
    }

    fn is_plain(&self) -> bool {
        self.foundation == super::Foundation::default()
    }
}
