//! Which directions lines run along: limits whose gradients point the same way share theirs.

use super::design_point::{DesignPoint, DesignPoints, SearchOptions, design_points};
use super::event::{Evaluator, Event};
use super::limit_state::LimitState;
use super::vectors::{dot, norm};
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::numerics::special::normal;

/// Design points farther than the nearest by no more than this share its probability.
const RIVAL: f64 = 1.5;
/// Limits less probable than this share of the most probable one get no lines of their own.
const NEGLIGIBLE_SHARE: f64 = 1e-4;
/// From this first-order probability up lines across a second design point would be met by chance; below it
/// second design points are searched.
const COMMON: f64 = 0.02;
/// Cosine of the angle within which two limits share their lines, at either end.
const PARALLEL: f64 = 0.8;

/// What was evaluated.
#[derive(Default)]
pub(super) struct Spent {
    pub evaluations: u64,
    pub faults: u64,
}

/// Lines along one direction.
#[derive(Clone)]
pub(super) struct Group {
    pub direction: Vec<f64>,
    /// Where crossings are expected.
    pub distance: f64,
    /// Places among the event's members of the limits that these lines answer for …
    pub own: Vec<usize>,
    /// … and of those whose breaches earlier groups have counted.
    pub counted: Vec<usize>,
    /// Slope of each member's margin along the direction, where it is known.
    pub slopes: Vec<Option<f64>>,
}

pub(super) type Fit<T> = std::result::Result<T, String>;

/// Half the distance over which slopes along a line are taken.
const SLOPE_STEP: f64 = 0.25;

/// Slopes of the members' margins along the line through the origin, where its crossing is expected.
pub(super) fn slopes(
    evaluator: &mut Evaluator,
    group: &Group,
    members: &[usize],
) -> Result<Vec<Option<f64>>> {
    let rows = [SLOPE_STEP, -SLOPE_STEP].map(|step| -> Vec<f64> {
        group.direction.iter().map(|x| (group.distance + step) * x).collect()
    });
    let margins = evaluator.margins(&Columns::from_rows(&rows))?;
    let slope = |&limit: &usize| {
        let slope = (margins.get(0, limit) - margins.get(1, limit)) / (2.0 * SLOPE_STEP);
        (slope.is_finite() && slope != 0.0).then_some(slope)
    };
    Ok(members.iter().map(slope).collect())
}

/// The groups of lines of an event.
pub(super) fn directions(
    state: &dyn LimitState,
    event: Event,
    members: &[usize],
    options: &SearchOptions,
    spent: &mut Spent,
) -> Result<Fit<Vec<Group>>> {
    let rough = SearchOptions {
        directions: 0,
        iterations: 12,
        distance_tolerance: 0.02,
        angle_tolerance: 0.05,
        ..options.clone()
    };
    let mut search = |event: Event, options: &SearchOptions| -> Result<DesignPoints> {
        let found = design_points(state, event, options)?;
        spent.evaluations += found.evaluations;
        spent.faults += found.faults;
        Ok(found)
    };
    let around = SearchOptions { directions: options.directions.min(8), ..options.clone() };
    let several = |found: &DesignPoints| {
        let nearest = found.points.first().map_or(f64::INFINITY, |p| p.reliability_index);
        found.points.iter().filter(|p| p.reliability_index < nearest + RIVAL).count() > 1
    };
    if members.len() > 1 && !event.is_union() {
        let found = search(event, &around)?;
        return Ok(match &found.points[..] {
            [] => Err("the common breach has no design point".to_owned()),
            _ if several(&found) => Err("there are several design points".to_owned()),
            [point, ..] => Ok(vec![joint_group(point, members.len())]),
        });
    }
    let mut points: Vec<(usize, DesignPoint)> = Vec::new();
    for (place, &limit) in members.iter().enumerate() {
        if let Some(point) = search(Event::Limit(limit), &rough)?.points.into_iter().next() {
            points.push((place, point));
        }
    }
    points.sort_by(|a, b| a.1.reliability_index.total_cmp(&b.1.reliability_index));
    let Some(most) = points.first().map(|(_, p)| normal::survival(p.reliability_index)) else {
        return Ok(Err("no limit has a design point".to_owned()));
    };
    points.retain(|(_, p)| normal::survival(p.reliability_index) >= NEGLIGIBLE_SHARE * most);
    let mut groups: Vec<Group> = Vec::new();
    for (place, point) in &points {
        let rare = normal::survival(point.reliability_index) < COMMON;
        if rare && several(&search(Event::Limit(members[*place]), &around)?) {
            return Ok(Err("a limit has several design points".to_owned()));
        }
        let Some(half) = point.half_spaces.first() else { continue };
        let along = |group: &&mut Group| dot(&group.direction, &half.direction).abs() > PARALLEL;
        match groups.iter_mut().find(along) {
            Some(group) => group.own.push(*place),
            None => groups.push(Group {
                direction: half.direction.clone(),
                distance: half.reliability_index,
                own: vec![*place],
                counted: Vec::new(),
                slopes: vec![None; members.len()],
            }),
        }
    }
    let mut before: Vec<usize> = Vec::new();
    for (k, group) in groups.iter_mut().enumerate() {
        if k == 0 {
            // Limits without a direction of their own are looked for on the first lines.
            let rest = (0..members.len()).filter(|m| points.iter().all(|(place, _)| place != m));
            group.own.extend(rest);
        }
        group.counted.clone_from(&before);
        before.extend(&group.own);
    }
    Ok(Ok(groups))
}

/// The lines of an intersection: along its joint design point.
fn joint_group(point: &DesignPoint, members: usize) -> Group {
    let length = norm(&point.point).max(1e-9);
    Group {
        direction: point.point.iter().map(|x| x / length).collect(),
        distance: length,
        own: (0..members).collect(),
        counted: Vec::new(),
        slopes: vec![None; members],
    }
}
