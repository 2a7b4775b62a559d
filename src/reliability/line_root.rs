//! Where a margin crosses zero on a line, from the few places where it has been seen: a safeguarded secant.
//!
//! A pure function of what has been seen, so that lines can be followed in batches and a place that was looked at
//! for one limit serves the others.

use super::searched_lines::between;

/// What is known of a margin's crossing on a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Crossing {
    /// It is to be looked at here next.
    Wanted(f64),
    /// It is crossed here, to about `error`, and breached on the side above or below.
    At {
        /// The place.
        t: f64,
        /// Its error.
        error: f64,
        /// Whether what lies above breaches.
        above: bool,
    },
    /// It is not crossed within reach.
    Nowhere {
        /// Whether the line breaches.
        breach: bool,
    },
    /// A margin on the way could not be evaluated, or it changes sign more than once.
    Lost,
}

impl Crossing {
    /// Whether the limit is breached at `t`.
    pub fn breaches(&self, t: f64) -> bool {
        match *self {
            Crossing::At { t: root, above, .. } => (t > root) == above,
            Crossing::Nowhere { breach } => breach,
            Crossing::Wanted(_) | Crossing::Lost => false,
        }
    }
}

/// Share of its distance that a crossing known by one slope may be off.
const FAR_ERROR: f64 = 0.3;
/// Longest step beyond what has been seen.
const STEP: f64 = 3.0;
/// Places seen from which on every other step is a bisection.
const PATIENCE: usize = 6;

/// The crossing of a margin seen at `seen` = (t, margin), at least once; `slope` is its slope where it is known
/// beforehand. A crossing is settled when the probability between its ends of error is at most `open`.
pub fn crossing(seen: &[(f64, f64)], slope: Option<f64>, reach: f64, open: f64) -> Crossing {
    if seen.is_empty() || seen.iter().any(|(_, margin)| margin.is_nan()) {
        return Crossing::Lost;
    }
    let mut places = seen.to_vec();
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let changes: Vec<usize> =
        (1..places.len()).filter(|&k| (places[k - 1].1 < 0.0) != (places[k].1 < 0.0)).collect();
    let (root, error, above, next) = match changes[..] {
        [] => match outside(&places, slope, reach) {
            Ok(found) => found,
            Err(crossing) => return crossing,
        },
        [k] => inside(places[k - 1], places[k], &places),
        _ => return Crossing::Lost,
    };
    if between(root - error, root + error) <= open {
        Crossing::At { t: root, error, above }
    } else {
        Crossing::Wanted(next)
    }
}

type Found = (f64, f64, bool, f64);

/// Between two places of unlike sign.
fn inside(left: (f64, f64), right: (f64, f64), places: &[(f64, f64)]) -> Found {
    let ((a, fa), (b, fb)) = (left, right);
    let above = fb < 0.0;
    let middle = 0.5 * (a + b);
    let secant = b - fb * (b - a) / (fb - fa);
    let secant = if secant > a && secant < b { secant } else { middle };
    let third = places
        .iter()
        .filter(|place| place.0 != a && place.0 != b)
        .min_by(|x, y| (x.0 - secant).abs().total_cmp(&(y.0 - secant).abs()));
    let curved = third.map(|&(c, fc)| {
        a * fb * fc / ((fa - fb) * (fa - fc))
            + b * fa * fc / ((fb - fa) * (fb - fc))
            + c * fa * fb / ((fc - fa) * (fc - fb))
    });
    let (root, error) = match curved {
        Some(curved) if curved > a && curved < b => (curved, (curved - secant).abs()),
        _ => {
            let (near, far) = ((secant - a).min(b - secant), (secant - a).max(b - secant));
            (secant, if third.is_none() { near.max(near * near / far) } else { near })
        }
    };
    let patient = places.len() < PATIENCE || places.len() % 2 == 1;
    (root, error.min((b - root).max(root - a)), above, if patient { root } else { middle })
}

/// Beyond places of one sign.
fn outside(places: &[(f64, f64)], slope: Option<f64>, reach: f64) -> Result<Found, Crossing> {
    let mut near = places.to_vec();
    near.sort_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    let (t, margin) = near[0];
    let breach = margin < 0.0;
    let nowhere = Crossing::Nowhere { breach };
    let known = match near.get(1) {
        Some(&(other, value)) => Some((margin - value) / (t - other)),
        None => slope,
    };
    let Some(slope) = known.filter(|slope| slope.is_finite()) else {
        return Err(match near.len() {
            1 => Crossing::Wanted(if t > 0.0 { t - 1.0 } else { t + 1.0 }),
            _ => nowhere,
        });
    };
    let root = t - margin / slope;
    if !root.is_finite() {
        return Err(nowhere);
    }
    let last = (root - t).abs();
    let error = match near.get(1) {
        None => FAR_ERROR * last,
        Some(&(other, _)) => last * (last / (root - other).abs().max(1e-300)).clamp(0.02, 1.0),
    };
    let (least, most) = (places[0].0, places[places.len() - 1].0);
    let next = root.clamp(least - STEP, most + STEP).clamp(-reach, reach);
    if next != root && places.iter().any(|place| place.0 == next) {
        return Err(nowhere);
    }
    // By the slope and not by where the place lies: on the crossing itself that is a matter of rounding.
    Ok((root, error, slope < 0.0, next))
}
