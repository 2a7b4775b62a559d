//! The inner sample: P(event | what is not known) by integration along lines.
//!
//! In the standard normal space of what varies every point lies on one line of a given direction; the part of v across
//! the lines and the place t along them are independent, and t is standard normal. So P(e) is the mean over lines of the
//! normal probability of those t at which the event happens (line sampling; Koutsourelakis, Pradlwarter and Schuëller,
//! Probab. Eng. Mech. 19 (2004) 409), for any direction, and a good one makes the lines differ little. On a line the
//! margins are known at evenly spaced t and interpolated between; of a limit the crossing is found there. Where one input
//! varies there is one line, and nothing is left to chance.
//!
//! The two halves of a set have the same spacing, half a step apart, and different lines: how they differ shows the error of
//! the interpolation as well as that of the lines.

use super::{NestedState, hypercube, varying};
use crate::error::Result;
use crate::numerics::columns::Columns;
use crate::numerics::special::normal;
use crate::streams::Purpose;

/// Points of a line where there are several lines.
const LINE: usize = 16;
/// Fewest points of a line; with fewer a half counts.
const FEWEST: usize = 6;
/// Farthest point of a line from its middle, in standard deviations: 3.4e-6 lie beyond either end.
const REACH: f64 = 4.5;
/// Step of the differences that give the direction, in standard deviations.
const STEP: f64 = 0.5;

/// An event of a system of limits whose conditional probability is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NestedEvent {
    /// Any limit's margin is negative.
    Any,
    /// The margin of one limit is below a value.
    Below {
        /// The limit.
        limit: usize,
        /// The value, in the margin's unit.
        margin: f64,
    },
}

impl NestedEvent {
    /// The limits that decide it, each with the margin below which it happens.
    fn members(self, limits: usize) -> impl Iterator<Item = (usize, f64)> {
        let (range, margin) = match self {
            NestedEvent::Any => (0..limits, 0.0),
            NestedEvent::Below { limit, margin } => (limit..limit + 1, margin),
        };
        range.map(move |limit| (limit, margin))
    }

    /// Whether it happens at a point; `None` where that is not known.
    fn at(self, margins: &Columns, k: usize) -> Option<bool> {
        let mut unknown = false;
        for (limit, least) in self.members(margins.columns()) {
            let margin = margins.get(k, limit);
            if margin < least {
                return Some(true);
            }
            unknown |= margin.is_nan();
        }
        (!unknown).then_some(false)
    }
}

/// Where the points of a half lie.
#[derive(Debug, Clone)]
pub(super) struct Inner {
    size: usize,
    varying: Vec<usize>,
    /// Unit vector in the normal space of the coordinates that vary; none where a half counts.
    direction: Option<Vec<f64>>,
    /// Points of each line.
    lines: Vec<usize>,
}

impl Inner {
    /// Halves of `size` points. Several coordinates that vary cost two evaluations each, at the medians of everything, for the
    /// direction.
    ///
    /// # Errors
    /// Those of the system.
    pub(super) fn new(state: &dyn NestedState, size: usize) -> Result<Self> {
        let varying = varying(state);
        let continuous: Vec<usize> =
            (0..varying.len()).filter(|&m| state.is_continuous(varying[m])).collect();
        let direction = match (&continuous[..], size >= FEWEST) {
            ([], _) | (_, false) => None,
            ([only], true) => {
                Some((0..varying.len()).map(|m| f64::from(u8::from(m == *only))).collect())
            }
            (several, true) => Some(steepest(state, &varying, several)?),
        };
        let count = match (&direction, varying.len()) {
            (None, _) => 0,
            (Some(_), 1) => 1,
            _ => (size / LINE).max(1),
        };
        let lines =
            (0..count).map(|line| size / count + usize::from(line < size % count)).collect();
        Ok(Inner { size, varying, direction, lines })
    }

    /// Points of a half.
    pub(super) fn size(&self) -> usize {
        self.size
    }

    /// Places of the coordinates that vary.
    pub(super) fn varying(&self) -> &[usize] {
        &self.varying
    }

    /// Whether a half integrates along lines; if not it counts.
    pub(super) fn integrates(&self) -> bool {
        self.direction.is_some()
    }

    /// Smallest conditional probability that the two halves of a set resolve.
    pub(super) fn resolution(&self) -> f64 {
        match self.integrates() {
            true => normal::cdf(-REACH),
            false => 0.5 / self.size as f64,
        }
    }

    /// Places t along a line of `points` points, ascending.
    fn places(points: usize, side: usize) -> impl Iterator<Item = f64> {
        let step = 2.0 * REACH / (points as f64 - 0.5);
        // The outermost points of the two halves lie at the two ends.
        (0..points).map(move |i| step * (i as f64 + 0.5 * side as f64) - REACH)
    }

    /// Points of one half: rows × coordinates that vary.
    pub(super) fn points(&self, side: usize, seed: u64, purpose: Purpose, index: u64) -> Columns {
        let n = self.varying.len();
        let Some(direction) = &self.direction else {
            return hypercube(n, self.size, seed, purpose, index);
        };
        let across = match n {
            1 => Columns::from_rows(&[[0.5]]),
            _ => hypercube(n, self.lines.len(), seed, purpose, index),
        };
        let mut table = Columns::new(self.size, n);
        let mut row = 0;
        for (line, &points) in self.lines.iter().enumerate() {
            let u = across.row(line);
            let z: Vec<f64> = u.iter().map(|&u| normal::quantile(u)).collect();
            let along: f64 = z.iter().zip(direction).map(|(z, a)| z * a).sum();
            for t in Self::places(points, side) {
                for m in 0..n {
                    // A coordinate that the line does not move keeps its value to the bit: it may pick a row of a file.
                    let value = match direction[m] {
                        0.0 => u[m],
                        a => normal::cdf(z[m] + (t - along) * a)
                            .clamp(f64::MIN_POSITIVE, 1.0 - f64::EPSILON / 2.0),
                    };
                    table.set(row, m, value);
                }
                row += 1;
            }
        }
        table
    }

    /// The share of what varies for which each point of a half stands.
    pub(super) fn weights(&self, side: usize) -> Vec<f64> {
        if self.direction.is_none() {
            return vec![1.0 / self.size as f64; self.size];
        }
        let mut weights = Vec::with_capacity(self.size);
        for &points in &self.lines {
            let places: Vec<f64> = Self::places(points, side).collect();
            let ends = places.windows(2).map(|pair| normal::cdf(0.5 * (pair[0] + pair[1])));
            let mut before = 0.0;
            for end in ends.chain([1.0]) {
                weights.push((end - before) / self.lines.len() as f64);
                before = end;
            }
        }
        weights
    }

    /// The conditional probability of an event by the points of a half, which start at row `start`, among that part of what
    /// varies where it is known; NaN if it is nowhere.
    pub(super) fn share(
        &self,
        margins: &Columns,
        start: usize,
        side: usize,
        event: NestedEvent,
    ) -> f64 {
        let (mut happened, mut known) = (0.0, 0.0);
        if self.direction.is_none() {
            for yes in (start..start + self.size).filter_map(|k| event.at(margins, k)) {
                known += 1.0;
                happened += f64::from(u8::from(yes));
            }
            return happened / known;
        }
        let mut first = start;
        for &points in &self.lines {
            let places: Vec<f64> = Self::places(points, side).collect();
            let line = Line { margins, first, places: &places };
            let (yes, all) = line.probability(event);
            happened += yes;
            known += all;
            first += points;
        }
        // Rounding only: no event is likelier than what is known.
        (happened / known).min(1.0)
    }
}

/// The margins along one line.
struct Line<'m> {
    margins: &'m Columns,
    first: usize,
    places: &'m [f64],
}

impl Line<'_> {
    /// Normal probability of the places where an event happens, and of those where it is known.
    fn probability(&self, event: NestedEvent) -> (f64, f64) {
        let last = self.places.len() - 1;
        let (mut happened, mut known) = (0.0, 0.0);
        // Beyond the ends nothing is interpolated: what holds at the end holds there.
        let ends = [(0, normal::cdf(self.places[0])), (last, normal::cdf(-self.places[last]))];
        for (end, weight) in ends {
            if let Some(yes) = event.at(self.margins, self.first + end) {
                known += weight;
                happened += weight * f64::from(u8::from(yes));
            }
        }
        for cell in 0..last {
            let (from, to) = (self.places[cell], self.places[cell + 1]);
            let Some((left, right)) = self.cell(event, cell) else { continue };
            let all = between(from, to);
            known += all;
            happened += if left >= right { all } else { between(from, left) + between(right, to) };
        }
        (happened, known)
    }

    /// The event happens in a cell from its beginning to the first place, and from the second to its end; `None` where that
    /// is not known.
    fn cell(&self, event: NestedEvent, cell: usize) -> Option<(f64, f64)> {
        let (from, to) = (self.places[cell], self.places[cell + 1]);
        let (mut left, mut right) = (from, to);
        let mut unknown = false;
        for (limit, least) in event.members(self.margins.columns()) {
            let margin = |i: usize| self.margins.get(self.first + i, limit) - least;
            let (a, b) = (margin(cell), margin(cell + 1));
            match (a < 0.0, b < 0.0) {
                _ if a.is_nan() || b.is_nan() => unknown = true,
                (true, true) => return Some((to, from)),
                (false, false) => {}
                (true, false) => left = left.max(self.crossing(cell, &margin)),
                (false, true) => right = right.min(self.crossing(cell, &margin)),
            }
        }
        match unknown && left < right {
            true => None,
            false => Some((left, right)),
        }
    }

    /// Where a margin that changes its sign in a cell is zero: by the cubic through the two points on either side, by a
    /// straight line where there are not so many or where that cubic leaves the cell's range.
    fn crossing(&self, cell: usize, margin: &dyn Fn(usize) -> f64) -> f64 {
        let (from, to) = (self.places[cell], self.places[cell + 1]);
        let (a, b) = (margin(cell), margin(cell + 1));
        if !(a.is_finite() && b.is_finite()) {
            return 0.5 * (from + to);
        }
        // The slopes at both ends, a cell long; limited as Fritsch and Carlson do (SIAM J. Numer. Anal. 17 (1980) 238) so
        // that the cubic is monotone, and crosses zero once.
        let chord = b - a;
        let slope = |outer: Option<usize>, sign: f64, at: f64| {
            let beyond = outer.filter(|&i| i < self.places.len()).map(margin);
            let slope =
                beyond.filter(|x| x.is_finite()).map_or(chord, |x| 0.5 * (sign * (x - at) + chord));
            if slope * chord > 0.0 {
                slope.abs().min(3.0 * chord.abs()) * chord.signum()
            } else {
                0.0
            }
        };
        let p = slope(cell.checked_sub(1), -1.0, a);
        let q = slope(Some(cell + 2), 1.0, b);
        let cubic = |s: f64| {
            let r = 1.0 - s;
            a * r * r * (1.0 + 2.0 * s) + b * s * s * (3.0 - 2.0 * s) + s * r * (p * r - q * s)
        };
        let (mut low, mut high) = (0.0, 1.0);
        // A cell is known to 2⁻³⁰ of itself.
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            if (cubic(middle) < 0.0) == (a < 0.0) { low = middle } else { high = middle }
        }
        from + 0.5 * (low + high) * (to - from)
    }
}

/// Normal probability between two places, accurate in both tails.
fn between(from: f64, to: f64) -> f64 {
    let difference = if from > 0.0 {
        normal::cdf(-from) - normal::cdf(-to)
    } else {
        normal::cdf(to) - normal::cdf(from)
    };
    difference.max(0.0)
}

/// The direction in which the margins change most, each limit counting alike, at the medians of everything: the sum of the
/// limits' unit gradients, each with the sign that takes it along with the others.
fn steepest(state: &dyn NestedState, varying: &[usize], among: &[usize]) -> Result<Vec<f64>> {
    let mut points = Vec::with_capacity(2 * among.len());
    for &m in among {
        for z in [-STEP, STEP] {
            let mut point = vec![0.5; state.dimension()];
            point[varying[m]] = normal::cdf(z);
            points.push(point);
        }
    }
    let mut margins = Columns::new(points.len(), state.limits());
    state.margins(&Columns::from_rows(&points), &mut margins)?;
    let mut sum = vec![0.0; varying.len()];
    for limit in 0..state.limits() {
        let mut gradient = vec![0.0; varying.len()];
        for (i, &m) in among.iter().enumerate() {
            gradient[m] = margins.get(2 * i + 1, limit) - margins.get(2 * i, limit);
        }
        let norm = gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
        if !(norm > 0.0 && norm.is_finite()) {
            continue;
        }
        let along: f64 = gradient.iter().zip(&sum).map(|(g, s)| g * s).sum();
        let scale = if along < 0.0 { -norm.recip() } else { norm.recip() };
        sum.iter_mut().zip(&gradient).for_each(|(s, g)| *s += scale * g);
    }
    let norm = sum.iter().map(|g| g * g).sum::<f64>().sqrt();
    if norm > 0.0 {
        sum.iter_mut().for_each(|g| *g /= norm);
    } else {
        // Nothing matters at the medians: any direction is right.
        among.first().into_iter().for_each(|&m| sum[m] = 1.0);
    }
    Ok(sum)
}
