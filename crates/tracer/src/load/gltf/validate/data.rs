//! Rules for the numbers in accessors: they are finite, and within the bounds that are given.

use crate::load::gltf::accessor::Accessor;
use crate::load::gltf::fault::{Fault, require};
use crate::load::gltf::layout::Component;

/// How far a number may be out of its bounds, as a part of the larger bound: what bounds written with four decimal
/// digits may be off, and less than any fault that matters.
const BOUNDS_TOLERANCE: f64 = 1e-3;

pub(super) fn check(accessors: &[Accessor<'_>]) -> Result<(), Fault> {
    accessors
        .iter()
        .filter(|accessor| accessor.has_data())
        .try_for_each(check_one)
}

fn check_one(accessor: &Accessor<'_>) -> Result<(), Fault> {
    let is_float = accessor.component == Component::F32;
    if !is_float && accessor.min.is_none() && accessor.max.is_none() {
        return Ok(());
    }
    for component in 0..accessor.components() {
        let bound = |bounds: &Option<Vec<f64>>, otherwise: f64| {
            bounds
                .as_ref()
                .and_then(|bounds| bounds.get(component).copied())
                .unwrap_or(otherwise)
        };
        let min = bound(&accessor.min, f64::NEG_INFINITY);
        let max = bound(&accessor.max, f64::INFINITY);
        let largest = [min, max]
            .into_iter()
            .filter(|bound| bound.is_finite())
            .fold(0.0, |largest: f64, bound| largest.max(bound.abs()));
        let tolerance = BOUNDS_TOLERANCE * largest;
        let range = min - tolerance..=max + tolerance;
        for element in 0..accessor.count {
            let value = accessor.stored(element, component);
            if range.contains(&value) && value.is_finite() {
                continue;
            }
            require(value.is_finite(), &accessor.name, || {
                format!("component {component} of element {element} is {value}")
            })?;
            let reason = format!(
                "component {component} of element {element} is {value}, not between its bounds {min} and {max}"
            );
            return Err(Fault::invalid(&accessor.name, reason));
        }
    }
    Ok(())
}
