//! The overstress of a steadily strained bar on the characteristic net is that of its strain rate for any step.

use crate::common;
use crate::common::net;

use barwave::bar::EndCondition;
use barwave::law::rate::Overstress;
use barwave::material::{Beyond, Material};
use barwave::solver::fd::Quantity;
use barwave::solver::net::Net;
use common::{DENSITY, MODULUS, moved, segment};

const YIELD: f64 = 400e6;

const LAWS: [Overstress; 6] = [
    Overstress::Malvern { k: 1e8 },
    Overstress::CowperSymonds { rate: MODULUS * 40.0, exponent: 5.0 },
    Overstress::CowperSymonds { rate: MODULUS * 1e4, exponent: 2.0 },
    Overstress::CowperSymonds { rate: MODULUS * 1e7, exponent: 0.6 },
    Overstress::JohnsonCook { c: 0.014, rate: MODULUS },
    Overstress::ZerilliArmstrong { stress: 150e6, sensitivity: 0.12, rate: MODULUS * 1e-3, thermal: [7e-3, 4e-4] },
];

fn c0() -> f64 {
    (MODULUS / DENSITY).sqrt()
}

/// Returns a material with this slope of the static stress against the plastic strain, Pa.
fn material(hardening: f64) -> Material {
    let (strain, stress) = (3.0, YIELD + 3.0 * hardening);
    let rows = [(YIELD / MODULUS, YIELD), (strain + stress / MODULUS, stress.max(YIELD * (1.0 + 1e-12)))];
    common::material(&rows, Beyond::Extend)
}

/// Pull of a bar: strain rate (1/s), strain per time step, and the cells of its segments.
#[derive(Debug, Clone, Copy)]
struct Pull<'a> {
    rate: f64,
    strain_of_step: f64,
    cells: &'a [usize],
}

/// Returns the bar after 40 to 4000 steps, at a strain of 0.4 if possible. Its balances are checked.
fn pulled(law: Overstress, hardening: f64, pull: Pull<'_>) -> Net {
    let dx = c0() * pull.strain_of_step / pull.rate;
    let segments = pull.cells.iter().map(|&cells| segment(material(hardening), cells as f64 * dx)).collect();
    let all = pull.cells.iter().sum::<usize>();
    let velocity = 0.5 * pull.rate * dx * all as f64;
    let mut bar = net::net(segments, [moved(-velocity), moved(velocity)], law, 0.0, all);
    let balance = net::Balance::new(&bar);
    for _ in 0..(0.4 / pull.strain_of_step).clamp(40.0, 4000.0) as usize {
        bar.advance();
    }
    let residuals = balance.residuals(&bar);
    assert!(residuals.iter().all(|r| *r < 1e-12), "{law:?} {pull:?}: {residuals:?}");
    bar
}

/// Returns the overstress of the cells relative to their static stress.
fn overstress(bar: &Net) -> Vec<f64> {
    let of = |cell| bar.value(Quantity::Stress, cell) / bar.static_stress(cell) - 1.0;
    (0..bar.grid().cells()).map(of).collect()
}

fn largest(found: impl IntoIterator<Item = f64>, exact: f64) -> f64 {
    found.into_iter().map(|x| (x - exact).abs() / (1.0 + exact)).fold(0.0, f64::max)
}

fn rates_and_steps() -> impl Iterator<Item = (f64, f64)> {
    (2..=6).flat_map(|exponent| [1e-4, 1e-3, 1e-2].map(|strain| (10.0_f64.powi(exponent), strain)))
}

/// Steps whose elastic stress is a twentieth of the yield stress to five times as much.
#[test]
fn the_overstress_is_that_of_the_strain_rate_whatever_the_step() {
    for law in LAWS {
        let mut worst = [0.0_f64; 2];
        for (rate, strain_of_step) in rates_and_steps() {
            for cells in [&[1][..], &[4]] {
                let pull = Pull { rate, strain_of_step, cells };
                let bar = pulled(law, 0.0, pull);
                let exact = law.overstress(MODULUS * rate, YIELD) / YIELD;
                let ends = bar.ends().map(|end| end.stress / YIELD - 1.0);
                let off = [largest(overstress(&bar), exact), largest(ends, exact)];
                worst = [0, 1].map(|k| off[k].max(worst[k]));
                assert!(off[0] < 2e-3, "{law:?} {pull:?}: {off:?}");
                // With Malvern's law, the net is diffusive where steps do not resolve the relaxation.
                assert!(off[1] < 2e-3 || matches!(law, Overstress::Malvern { .. }), "{law:?} {pull:?}: {off:?}");
            }
        }
        println!("{law:?}: cells off by {:.1e}, ends by {:.1e} of the stress", worst[0], worst[1]);
    }
}

/// A node that relaxed from the stress on arrival would give 0.090 and 0.092, and 0.103 and 0.326 at the ends.
#[test]
fn johnson_cook_has_its_logarithm_in_millimetre_cells() {
    let law = Overstress::JohnsonCook { c: 0.014, rate: MODULUS };
    for rate in [1e3, 1e4] {
        let bar = pulled(law, 0.0, Pull { rate, strain_of_step: 1e-3 * rate / c0(), cells: &[5] });
        let exact = 0.014 * f64::ln(rate);
        let ends = bar.ends().map(|end| end.stress / YIELD - 1.0);
        assert!(largest(overstress(&bar), exact) < 2e-4 && largest(ends, exact) < 2e-4, "{rate}: {ends:?} {exact}");
    }
}

/// A bonded joint of two pieces of the same bar does not change the solution.
#[test]
fn a_joint_flows_at_the_strain_rate_too() {
    for law in LAWS {
        let mut worst = 0.0_f64;
        for (rate, strain_of_step) in rates_and_steps() {
            let pull = Pull { rate, strain_of_step, cells: &[3, 3] };
            let off = largest(overstress(&pulled(law, 0.0, pull)), law.overstress(MODULUS * rate, YIELD) / YIELD);
            worst = worst.max(off);
        }
        println!("{law:?}: beside a joint off by {worst:.1e} of the stress");
        // The sides of a joint relax with half the weight of a node: another theta where the step equals the relaxation time.
        assert!(worst < 1e-2, "{law:?}: {worst:e}");
    }
}

/// The plastic strain of the first steps, and with it the rate, varies from cell to cell: the overstress is that of the flow of each cell.
#[test]
fn the_overstress_of_a_bar_that_hardens_is_that_of_its_flow() {
    for law in LAWS {
        let mut worst = 0.0_f64;
        for (rate, strain_of_step) in rates_and_steps() {
            let mut bar = pulled(law, 2e9, Pull { rate, strain_of_step, cells: &[4] });
            let (before, start) = (overstress(&bar), net::profile(&bar, Quantity::AccumulatedPlasticStrain));
            bar.advance();
            for cell in 0..4 {
                let flow = bar.value(Quantity::AccumulatedPlasticStrain, cell) - start[cell];
                let exact =
                    law.overstress(MODULUS * flow / bar.grid().dt, bar.static_stress(cell)) / bar.static_stress(cell);
                worst = worst.max(largest([0.5 * (before[cell] + overstress(&bar)[cell])], exact));
            }
        }
        println!("{law:?}, hardening: off by {worst:.1e} of the stress");
        // The largest step increases the static stress by a twentieth.
        assert!(worst < 1e-2, "{law:?}: {worst:e}");
    }
}

/// A jump on a net that does not resolve the relaxation at all: the compression increases towards the struck end, except for the error of the
/// trapezoidal rule at the jump.
#[test]
fn an_impact_does_not_ring_by_laws_of_low_sensitivity() {
    for law in &LAWS[1..] {
        let bilinear = common::bilinear_steel();
        let mut bar = net::net(vec![segment(bilinear, 1.0)], [moved(20.0), EndCondition::Free], *law, 0.0, 400);
        for _ in 0..360 {
            bar.advance();
        }
        let scale = (MODULUS * DENSITY).sqrt() * 20.0;
        let stress = net::profile(&bar, Quantity::Stress);
        let ripple = stress.windows(2).map(|pair| pair[0] - pair[1]).fold(0.0, f64::max) / scale;
        let energies = bar.energies();
        println!("{law:?}: ripple {ripple:.1e}, numerical {:.1e}", energies.numerical / energies.total());
        assert!(ripple < 1e-4 && energies.numerical >= 0.0, "{law:?}: {ripple:e}");
    }
}
