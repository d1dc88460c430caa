//! Checked scene as JSON in SI units, with all defaults filled in.

use serde_json::{Map, Value, json};

use super::{Method, Record, Scene, Solve};
use crate::bar::{Distribution, EndCondition, History, Joint, Segment};

pub(super) fn json(scene: &Scene) -> Value {
    let scene = scene.discretized.as_ref().map_or(scene, |cut| &cut.original);
    let mut value = json!({
        "title": scene.title,
        "name": scene.name,
        "overrides": scene.overrides,
        "bar": {
            "mode": "axial",
            "area_given": scene.bar.area_given,
            "segment": scene.bar.segments.iter().map(segment).collect::<Vec<_>>(),
        },
        "left": end(&scene.left),
        "right": end(&scene.right),
        "effects": scene.effects,
        "solve": solve(&scene.solve),
        "record": record(&scene.record, &scene.solve.method),
    });
    if let Some(auto) = &scene.auto {
        value["auto"] = json!(auto.choices);
    }
    if let Some(torsion) = &scene.torsion {
        // All other values are quantities of the surface.
        value["bar"]["mode"] = json!("torsion");
        value["bar"]["radius"] = json!(torsion.radius);
        value["bar"]["polar_moment"] = json!(torsion.polar);
    }
    value
}

fn segment(segment: &Segment) -> Value {
    let (joint, gap) = match segment.joint {
        Joint::Bonded => ("bonded", None),
        Joint::Contact { gap } => ("contact", Some(gap)),
    };
    let mut value = json!({
        "length": segment.length,
        "area": segment.area,
        "material": *segment.material,
        "velocity": segment.velocity,
        "initial": segment.initial,
        "joint": joint,
        "gap": gap,
    });
    if let Some(taper) = &segment.taper {
        value["taper"] = json!(**taper);
    }
    if let Some(profile) = &segment.profile {
        value["initial_over_x"] = json!({
            "velocity": table(&profile.velocity),
            "stress": table(&profile.stress),
            "plastic_strain": table(&profile.plastic_strain),
            "accumulated": table(&profile.accumulated),
            "temperature_rise": table(&profile.temperature_rise),
        });
    }
    value
}

fn table(table: &Distribution) -> Vec<[f64; 2]> {
    table.rows().map(|(x, value)| [x, value]).collect()
}

fn end(end: &EndCondition) -> Value {
    match end {
        EndCondition::Velocity { history, release } => {
            json!({ "kind": "velocity", "history": rows(history), "release": release })
        }
        EndCondition::Stress { history } => json!({ "kind": "stress", "history": rows(history) }),
        EndCondition::Free => json!({ "kind": "free" }),
        EndCondition::Fixed => json!({ "kind": "fixed" }),
        EndCondition::Absorbing => json!({ "kind": "absorbing" }),
        EndCondition::Dashpot { coefficient } => json!({ "kind": "dashpot", "coefficient": coefficient }),
        EndCondition::Wall { gap } => json!({ "kind": "wall", "gap": gap }),
        EndCondition::Striker { mass, velocity } => json!({ "kind": "striker", "mass": mass, "velocity": velocity }),
        EndCondition::Ball { mass, velocity, contact } => json!({
            "kind": "ball",
            "mass": mass,
            "velocity": velocity,
            "radius": contact.radius,
            "contact_modulus": contact.modulus,
        }),
        EndCondition::Spring { stiffness } => json!({ "kind": "spring", "stiffness": stiffness }),
    }
}

fn rows(history: &History) -> Vec<[f64; 2]> {
    history.time().iter().zip(history.value()).map(|(&t, &v)| [t, v]).collect()
}

fn solve(solve: &Solve) -> Value {
    let mut value = method_of(solve);
    value["audit-tolerance"] = json!(solve.audit_tolerance);
    if let Some(tolerance) = &solve.tolerance {
        value["tolerance"] = json!(tolerance.value);
    }
    value
}

fn method_of(solve: &Solve) -> Value {
    let [method, scheme] = solve.method.names();
    match solve.method {
        Method::Leapfrog { cells, cfl } | Method::Muscl { cells, cfl } => {
            json!({ "until": solve.until, "method": method, "scheme": scheme, "cells": cells, "cfl": cfl })
        }
        Method::CharacteristicNet { cells } => {
            json!({ "until": solve.until, "method": method, "scheme": scheme, "cells": cells })
        }
        Method::FrontTracking { front_tolerance, event_budget } => json!({
            "until": solve.until,
            "method": method,
            "front-tolerance": front_tolerance,
            "max-events": event_budget,
        }),
    }
}

fn record(record: &Record, method: &Method) -> Value {
    let gauges: Map<String, Value> = record.gauges.iter().map(|(name, x)| (name.clone(), json!(x))).collect();
    let mut value = json!({
        "times": record.times,
        "cells": record.cells,
        "fields": record.fields.iter().map(|f| f.name()).collect::<Vec<_>>(),
        "gauges": gauges,
        "precision": record.precision,
        "compression": record.compression,
    });
    if matches!(method, Method::FrontTracking { .. }) {
        value["paths"] = json!(record.paths);
    }
    value
}
