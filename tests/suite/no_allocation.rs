//! Stepping allocates no memory, and a disabled effect needs none.
#![allow(unsafe_code, reason = "a global allocator that counts")]

use crate::common::{self, long_bars, muscl, net};

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use barwave::assemble::segment_law;
use barwave::bar::{Bar, EndCondition, History};
use barwave::scene::{Effects, HardeningRule};
use barwave::solver::fd::{DistributedForces, Grid, Leapfrog, Quantity};
use barwave::solver::moc::{FrontTracking, Settings, Stopped};
use barwave::wave::riemann::Flow;

/// The system allocator with a count of the calls on each thread, since tests run in parallel.
struct Counting;

thread_local! {
    static CALLS: Cell<usize> = const { Cell::new(0) };
}

fn count() {
    CALLS.with(|calls| calls.set(calls.get() + 1));
}

// SAFETY: every call is passed unchanged to the system allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: as guaranteed by the caller.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as guaranteed by the caller.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: as guaranteed by the caller.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: as guaranteed by the caller.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Returns the number of allocations during some steps.
fn allocations(bar: &mut Leapfrog, steps: usize) -> usize {
    let before = CALLS.with(Cell::get);
    common::advance(bar, steps);
    CALLS.with(Cell::get) - before
}

/// Returns a bar of 5000 cells in ten blocks, struck at its left end.
fn struck(velocity: f64, hardening: Option<HardeningRule>) -> Leapfrog {
    let ends = [common::moved(velocity), EndCondition::Fixed];
    common::leapfrog(vec![common::segment(common::bilinear_steel(), 1.0)], ends, hardening, 5000, 1.0)
}

#[test]
fn the_counter_counts() {
    let before = CALLS.with(Cell::get);
    let boxed = std::hint::black_box(Box::new(1));
    assert_eq!((*boxed, CALLS.with(Cell::get) - before), (1, 1));
}

#[test]
fn an_elastic_run_allocates_nothing_and_carries_no_state() {
    for hardening in [None, Some(HardeningRule::Isotropic), Some(HardeningRule::Kinematic)] {
        // 2 m/s corresponds to 79 MPa, and twice that after the reflection: below yield at 200 MPa.
        let mut bar = struck(2.0, hardening);
        assert_eq!(allocations(&mut bar, 7000), 0);
        assert!(bar.stayed_elastic() && bar.value(Quantity::Stress, 4999) < -100e6);
        assert_eq!(bar.state_bytes(), 0);
    }
}

#[test]
fn a_plastic_run_allocates_nothing_once_every_block_has_yielded() {
    for (hardening, numbers) in [
        (None, 1),
        (Some(HardeningRule::Isotropic), 2),
        (Some(HardeningRule::Kinematic), 4),
        (Some(HardeningRule::Mixed(0.3)), 4),
    ] {
        let mut bar = struck(20.0, hardening);
        assert!(allocations(&mut bar, 6000) > 0);
        // The state variables of all cells, and nothing more.
        assert_eq!(bar.state_bytes(), 8 * numbers * 5000);
        assert_eq!(allocations(&mut bar, 2000), 0);
    }
}

/// With distributed forces, a step allocates nothing, and the memory per cell is that stated by `plan`.
#[test]
fn damping_and_lateral_inertia_allocate_nothing_and_cost_what_is_said() {
    let along = DistributedForces {
        internal: 1e3,
        external: 1e3,
        foundation: 1e6,
        lateral: vec![1e-8],
        ..DistributedForces::default()
    };
    let [elastic, yielded] = along.bytes_per_cell();
    for (velocity, bytes, spare) in [(2.0, elastic, 1000), (20.0, yielded + 16, 1000)] {
        let bar = Bar { segments: vec![common::segment(common::bilinear_steel(), 1.0)], area_given: true };
        let effects = Effects { hardening: Some(HardeningRule::Isotropic), ..Effects::default() };
        let (grid, laws) = (Grid::new(&bar, 5000, 1.0), vec![segment_law(&bar.segments[0], &effects)]);
        let mut bar = Leapfrog::with_along(&bar, grid, laws, [common::moved(velocity), EndCondition::Fixed], &along);
        common::advance(&mut bar, 6000);
        assert_eq!(allocations(&mut bar, 2000), 0);
        // There is one node more than cells, and a few that belong to the ends.
        let all = bar.state_bytes();
        assert!(all >= bytes * 5000 && all < bytes * 5000 + spare * 8, "{all} for {bytes} a cell");
    }
}

#[test]
fn muscl_allocates_nothing_once_every_block_has_yielded() {
    for hardening in [None, Some(HardeningRule::Isotropic), Some(HardeningRule::Kinematic)] {
        let segments =
            || vec![common::segment(common::power_law_steel(), 0.5), common::segment(common::bilinear_steel(), 0.5)];
        let run = |velocity: f64, warm: usize, steps: usize| {
            let ends = [common::moved(velocity), EndCondition::Fixed];
            let mut bar = muscl::muscl(segments(), ends, hardening, 1000, 1.0);
            (0..warm).for_each(|_| bar.advance());
            let before = CALLS.with(Cell::get);
            (0..steps).for_each(|_| bar.advance());
            (CALLS.with(Cell::get) - before, bar.stayed_elastic())
        };
        assert_eq!(run(2.0, 0, 1500), (0, true));
        // The first Riemann problem of a block that is not simple allocates space for its paths.
        assert_eq!(run(20.0, 4000, 2000), (0, false));
    }
}

#[test]
fn the_characteristic_net_allocates_nothing_from_its_first_step_on() {
    let thick = || barwave::bar::Segment::new(0.5, 2.0, common::power_law_steel());
    let segments = vec![thick(), common::segment(common::bilinear_steel(), 0.5)];
    let striker = EndCondition::Striker { mass: 1e4, velocity: 30.0 };
    let mut bar = net::malvern(segments, [striker, EndCondition::Fixed], 1e5, 500);
    let before = CALLS.with(Cell::get);
    for _ in 0..1000 {
        bar.advance();
    }
    assert_eq!(CALLS.with(Cell::get) - before, 0);
    assert!(!bar.stayed_elastic());
}

#[test]
fn only_yielded_blocks_carry_state() {
    // 100 steps after the start, waves are within the first block of 256 cells.
    let mut bar = struck(20.0, Some(HardeningRule::Isotropic));
    common::advance(&mut bar, 100);
    assert_eq!(bar.state_bytes(), 8 * 2 * 256);
}

/// Nodes, free slots, interactions, steps of the ends and working arrays of merging are in 17 lists, which double when they are full. Seven doublings
/// of each take a warmed-up run of some hundred fronts to the largest one here.
const DOUBLINGS: usize = 17 * 7;

/// Advances a tracked bar to `warm`, and from there to `until` (s) or to its event limit, and checks that the number of allocations is small compared
/// with the number of events.
#[track_caller]
fn assert_none_for_an_event(mut bar: FrontTracking, warm: f64, until: f64, name: &str) {
    bar.advance_to(warm).expect("few events");
    let (calls, events) = (CALLS.with(Cell::get), bar.events());
    if let Err(stopped) = bar.advance_to(until) {
        assert!(matches!(stopped, Stopped::EventBudget { .. }), "{name}: {stopped}");
    }
    let (calls, events) = (CALLS.with(Cell::get) - calls, bar.events() - events);
    println!("{name}: {calls} allocations, {events} events");
    assert!(calls <= DOUBLINGS && events > 40 * DOUBLINGS as u64, "{name}: {calls} allocations, {events} events");
}

fn tracked(ends: [EndCondition; 2], front_tolerance: f64) -> (FrontTracking, f64) {
    let bar = Bar { segments: vec![common::segment(common::power_law_table(6), 1.0)], area_given: true };
    let settings = Settings { front_tolerance, event_budget: 200_000, ..Settings::default() };
    let flow = Flow::Plastic { kinematic: 0.0 };
    (FrontTracking::new(&bar, flow, ends, settings), bar.transit_time())
}

#[test]
fn thinned_front_tracking_allocates_nothing_for_an_event() {
    for case in long_bars::cases().into_iter().take(4) {
        let settings = Settings { front_tolerance: 1e-2, event_budget: 400_000, ..Settings::default() };
        let bar = FrontTracking::new(&case.bar, case.flow, case.ends.clone(), settings);
        assert_none_for_an_event(bar, 0.1 * case.until(), case.until(), case.name);
    }
}

#[test]
fn exact_front_tracking_allocates_nothing_for_an_event() {
    let pulled = EndCondition::Velocity { history: History::constant(-20.0), release: Some(5e-5) };
    let (bar, transit) = tracked([pulled, EndCondition::Free], 0.0);
    assert_none_for_an_event(bar, 2.0 * transit, 1000.0 * transit, "exact");
}

#[test]
fn bodies_at_the_ends_allocate_nothing_for_an_event() {
    let striker = EndCondition::Striker { mass: 4.0 * common::DENSITY, velocity: 20.0 };
    let (bar, transit) = tracked([striker, EndCondition::Fixed], 1e-3);
    assert_none_for_an_event(bar, transit, 3.0 * transit, "striker");
    let spring = EndCondition::Spring { stiffness: common::MODULUS };
    let (bar, transit) = tracked([spring, common::moved(-20.0)], 1e-3);
    assert_none_for_an_event(bar, transit, 3.0 * transit, "spring");
}
