//! Line sampling: along parallel lines through random points the probability is known exactly, so only
//! the limit's shape across the lines is sampled.
//!
//! Lines run along the gradient at a design point and are spread across it by independently scrambled Sobol' points,
//! whose scatter is the error. A limit is taken to be crossed once on a line, so that a safeguarded secant finds
//! the crossing in about three evaluations, begun at the design point's distance; the breach of a union is the union of
//! its limits' half lines, at either end of the line. Limits of a union whose gradients point elsewhere get lines of
//! their own, of which only what no earlier limit breaches counts.
//!
//! Where the limit bends towards the origin across the direction, lines far out carry far more than the others, and
//! plain ones meet too few of them: a fifth of the lines is spread twice as wide, and all are weighed by the balance
//! heuristic. Without these the interval held RP14 (a shaft) in 85 seeds of a hundred, with them in 94 (2 000 seeds). In many
//! dimensions a wide line is too far out in all of them to count for much: a parabola of distance times curvature 0.5 to
//! 0.8 is held in 94 to 98 of a hundred in two to ten dimensions and in 92 in twenty (400 seeds).
//!
//! What is taken for granted is checked: points at random places of every fourth line ask whether they breach as the
//! crossings say, limits are searched for several design points, and lines that carry the estimate alone are
//! noticed. Where a check fails the whole is done again by lines that are searched over their whole length
//! (`searched_lines`), and the estimate says so.
//!
//! Sources: Hohenbichler and Rackwitz, J. Eng. Mech. 114 (1988) 2195; Koutsourelakis, Pradlwarter and
//! Schuëller, Probabilistic Engineering Mechanics 19 (2004) 409; Owen, Annals of Statistics 25 (1997) 1541, for the
//! variance on scrambled nets.

use super::crossings::TOLERANCE;
use super::design_point::SearchOptions;
use super::draws::open_uniform;
use super::estimate::{Estimate, Method};
use super::event::{BATCH, Evaluator, Event, FaultReading};
use super::limit_state::LimitState;
use super::line_groups::{Fit, Group, Spent, directions, slopes};
use super::line_root::{Crossing, crossing};
use super::searched_lines::{SearchedLineOptions, between, searched_lines, widen};
use super::vectors::dot;
use super::weighted::{WeightChecks, WeightedBreaches};
use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use crate::numerics::elementary::{exp, ln};
use crate::numerics::interval::{Earned, Interval};
use crate::numerics::special::normal;
use crate::sampling::{Design, Sampler};
use crate::streams::{Purpose, stream};

/// How line sampling is done.
#[derive(Debug, Clone, PartialEq)]
pub struct LineOptions {
    /// Independent scrambles of the lines: the interval is from their scatter.
    pub scrambles: u32,
    /// Lines of a scramble. Not as many as it takes: a number that depends on the scatter seen so far is reached soonest
    /// where that happens to be small, and the interval is too narrow then.
    pub lines: u64,
    /// A line is followed from −reach to reach.
    pub reach: f64,
    /// Confidence of the interval.
    pub confidence: f64,
    /// The search of the design points that give the directions.
    pub search: SearchOptions,
    /// Seed of the lines.
    pub seed: u64,
}

impl LineOptions {
    /// The usual choices, with the seed of every stream.
    pub fn seeded(seed: u64) -> Self {
        LineOptions {
            scrambles: 32,
            lines: 32,
            reach: 8.2,
            confidence: 0.95,
            search: SearchOptions::seeded(seed),
            seed,
        }
    }
}

/// Lines of a scramble after which the checks are asked first.
const FIRST_LINES: u64 = 8;
/// One line in so many is spread …
const WIDE_SHARE: u64 = 4;
/// … by this factor: where lines far from the design point carry much more than those near it, plain ones would
/// meet too few of them to know what is missing.
const WIDE: f64 = 2.0;
/// A crossing may leave this share of the first-order probability open.
const OPEN_SHARE: f64 = 1e-4;
/// Rounds of evaluations that a crossing may take.
const ROUNDS: usize = 24;
/// One line in so many is probed.
const PROBED: usize = 4;
/// Share of the estimate that the probes may put into question.
const QUESTIONED_SHARE: f64 = 2e-3;
/// Share of the lines that may be without an answer.
const LOST_SHARE: f64 = 0.01;
/// Least effective number of lines, (Σp)²/Σp², and the largest share of one.
const LEAST_EFFECTIVE: f64 = 50.0;
const LARGEST_SHARE: f64 = 0.05;

/// Line sampling of an event along the directions of its design points.
///
/// A line that met a fault counts as all safe in `probability` and the interval's lower end, and as all breach in
/// `probability_with_faults` and its upper end.
///
/// # Errors
/// If an option is out of range, the event does not fit, or the limit state fails.
pub fn line_sampling(
    state: &dyn LimitState,
    event: Event,
    options: &LineOptions,
) -> Result<Estimate> {
    if options.lines == 0 || options.scrambles < 2 || !(2.0..38.0).contains(&options.reach) {
        return Err(Error::argument(
            "line sampling needs two scrambles, a line in each, and a reach between 2 and 38",
        ));
    }
    let mut spent = Spent::default();
    match scrambled(state, event, options, &mut spent)? {
        Ok(estimate) => Ok(estimate),
        Err(why) => {
            let whole = SearchedLineOptions {
                confidence: options.confidence,
                search: options.search.clone(),
                ..SearchedLineOptions::seeded(options.seed)
            };
            let mut estimate = searched_lines(state, event, &whole)?;
            estimate.evaluations += spent.evaluations;
            estimate.faults += spent.faults;
            let note = format!(
                "lines with one crossing each do not fit here: {why}; every line was searched whole"
            );
            estimate.diagnostics.insert(0, note);
            Ok(estimate)
        }
    }
}

/// How the lines of a group lie across its direction.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Spread {
    Plain,
    Wide,
}

impl Spread {
    fn factor(self) -> f64 {
        match self {
            Spread::Plain => 1.0,
            Spread::Wide => WIDE,
        }
    }

    /// Lines of this spread where `plain` are of the plain one.
    fn lines(self, plain: u64) -> u64 {
        match self {
            Spread::Plain => plain,
            Spread::Wide => (plain / WIDE_SHARE).max(1),
        }
    }

    /// What a line counts for, by the balance heuristic (Veach and Guibas, SIGGRAPH 1995): the plain density there over
    /// the mean density of all lines, times this spread's share of the lines.
    fn weight(self, across: &[f64], plain: u64) -> f64 {
        let square = dot(across, across);
        let dimension = across.len() as f64;
        let wide = exp(0.5 * square * (1.0 - 1.0 / (WIDE * WIDE)) - dimension * ln(WIDE));
        let (own, wide_share) = (self.lines(plain) as f64, Spread::Wide.lines(plain) as f64 * wide);
        own / (plain as f64 + wide_share)
    }
}

fn scrambled(
    state: &dyn LimitState,
    event: Event,
    options: &LineOptions,
    spent: &mut Spent,
) -> Result<Fit<Estimate>> {
    let members = event.members(state.limits())?;
    if state.dimension() > Design::Sobol.max_dimension() {
        return Ok(Err("there are more coordinates than Sobol' numbers".to_owned()));
    }
    let mut found = match directions(state, event, &members, &options.search, spent)? {
        Ok(found) => found,
        Err(why) => return Ok(Err(why)),
    };
    let first_order: f64 =
        found.iter().map(|group| normal::survival(group.distance)).fold(0.0, f64::max);
    let mut evaluator = Evaluator::new(state, Event::Limit(members[0]), FaultReading::Kept)?;
    for group in &mut found {
        group.slopes = slopes(&mut evaluator, group, &members)?;
    }
    let found: Vec<(Group, Spread)> =
        found.into_iter().flat_map(|g| [(g.clone(), Spread::Plain), (g, Spread::Wide)]).collect();
    let mut sampling = Sampling {
        members: &members,
        union: event.is_union() || members.len() == 1,
        open: OPEN_SHARE * first_order,
        options,
        lines: found.iter().map(|_| Lines::default()).collect(),
    };
    // A few lines show soon enough where a line has more than one crossing.
    let mut count = options.lines.min(FIRST_LINES);
    let fit = loop {
        for (k, (group, spread)) in found.iter().enumerate() {
            sampling.extend(&mut evaluator, (group, *spread), k, count)?;
        }
        let fit = sampling.estimate(event);
        if count == options.lines || matches!(fit, Err((_, true))) {
            break fit;
        }
        count = options.lines;
    };
    spent.evaluations += evaluator.evaluations;
    spent.faults += evaluator.faults;
    Ok(match fit {
        Ok(mut estimate) => {
            estimate.evaluations = spent.evaluations;
            estimate.faults += spent.faults;
            Ok(estimate)
        }
        Err((why, _)) => Err(why),
    })
}

/// The lines of one group.
#[derive(Default)]
struct Lines {
    /// Lines of each scramble.
    count: u64,
    /// Each line; line k is of scramble k mod R.
    values: Vec<Value>,
    /// What the tolerance of the crossings leaves open, summed over the lines.
    open: f64,
    /// Lines without an answer.
    lost: usize,
    /// Probes, those that breach otherwise than the crossings say, and the probability these stand for, summed.
    probes: usize,
    surprises: usize,
    questioned: f64,
}

/// A line's probability with faults as safe and as breaches, and what it counts for.
#[derive(Clone, Copy)]
struct Value {
    safe: f64,
    breach: f64,
    weight: f64,
}

/// A line under way.
struct Line {
    across: Vec<f64>,
    weight: f64,
    /// Where it was evaluated, and every member's margin there.
    seen: Vec<(f64, Vec<f64>)>,
}

struct Sampling<'a> {
    members: &'a [usize],
    union: bool,
    open: f64,
    options: &'a LineOptions,
    lines: Vec<Lines>,
}

impl Sampling<'_> {
    /// Brings group `k` to `count` lines a scramble.
    fn extend(
        &mut self,
        evaluator: &mut Evaluator,
        (group, spread): (&Group, Spread),
        k: usize,
        plain: u64,
    ) -> Result<()> {
        let count = spread.lines(plain);
        let scrambles = u64::from(self.options.scrambles);
        let (first, end) = (self.lines[k].count * scrambles, count * scrambles);
        let across = evaluator.dimension() - 1;
        let seed = self.options.seed ^ (k as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mut normals = Columns::new((end - first) as usize, across.max(1));
        let all = scrambles * spread.lines(self.options.lines);
        let scrambles = self.options.scrambles;
        let purpose = Purpose::LineSampling;
        Sampler::new(Design::Sobol, across.max(1), all, scrambles, seed, purpose)?
            .fill(first, &mut normals)?;
        let mirror = Mirror::new(&group.direction);
        for begin in (0..normals.rows()).step_by(BATCH) {
            let rows = begin..(begin + BATCH).min(normals.rows());
            let mut lines: Vec<Line> = rows
                .map(|row| {
                    let across: Vec<f64> = (0..across)
                        .map(|j| spread.factor() * normal::quantile(normals.get(row, j)))
                        .collect();
                    Line {
                        weight: spread.weight(&across, self.options.lines),
                        across,
                        seen: Vec::new(),
                    }
                })
                .collect();
            let crossings = self.follow(evaluator, group, &mirror, &mut lines)?;
            self.probe(evaluator, group, k, &mirror, (&lines, &crossings), first + begin as u64)?;
            for (line, crossings) in lines.iter().zip(&crossings) {
                let value = self.value(group, crossings);
                self.lines[k].take(line.weight, value);
            }
        }
        self.lines[k].count = count;
        Ok(())
    }

    /// Finds the crossings of every line: result\[line\]\[member\], in rounds of one batch each.
    fn follow(
        &self,
        evaluator: &mut Evaluator,
        group: &Group,
        mirror: &Mirror,
        lines: &mut [Line],
    ) -> Result<Vec<Vec<Crossing>>> {
        let reach = self.options.reach;
        let mut wanted: Vec<(usize, f64)> =
            (0..lines.len()).map(|k| (k, group.distance.clamp(-reach, reach))).collect();
        let mut found: Vec<Vec<Crossing>> = vec![Vec::new(); lines.len()];
        for round in 0..ROUNDS {
            let rows: Vec<Vec<f64>> =
                wanted.iter().map(|&(k, t)| mirror.point(t, &lines[k].across)).collect();
            let margins = evaluator.margins(&Columns::from_rows(&rows))?;
            for (row, &(k, t)) in wanted.iter().enumerate() {
                let own = self.members.iter().map(|&limit| margins.get(row, limit)).collect();
                lines[k].seen.push((t, own));
            }
            let mut next: Vec<(usize, f64)> = Vec::new();
            let mut touched: Vec<usize> = wanted.iter().map(|&(k, _)| k).collect();
            touched.dedup();
            for k in touched {
                found[k] = self.crossings(group, &lines[k]);
                for crossing in &found[k] {
                    if let Crossing::Wanted(t) = *crossing
                        && round + 1 < ROUNDS
                        && !next.iter().rev().any(|&(line, at)| line == k && at == t)
                    {
                        next.push((k, t));
                    }
                }
            }
            if next.is_empty() {
                break;
            }
            wanted = next;
        }
        Ok(found)
    }

    /// What a line has shown of every limit that its group asks for; the others are said to be safe.
    fn crossings(&self, group: &Group, line: &Line) -> Vec<Crossing> {
        (0..self.members.len())
            .map(|member| {
                if !group.own.contains(&member) && !group.counted.contains(&member) {
                    return Crossing::Nowhere { breach: false };
                }
                let seen: Vec<(f64, f64)> =
                    line.seen.iter().map(|(t, margins)| (*t, margins[member])).collect();
                crossing(&seen, group.slopes[member], self.options.reach, self.open)
            })
            .collect()
    }

    /// Whether the point t of a line counts, by its crossings.
    fn counts(&self, group: &Group, crossings: &[Crossing], t: f64) -> bool {
        self.counted_breach(group, |member| crossings[member].breaches(t))
    }

    fn counted_breach(&self, group: &Group, breaches: impl Fn(usize) -> bool) -> bool {
        if self.union {
            group.own.iter().any(|&m| breaches(m)) && !group.counted.iter().any(|&m| breaches(m))
        } else {
            group.own.iter().all(|&m| breaches(m))
        }
    }

    /// The probability of what counts on a line, and what is left open of it; none if it could not be followed.
    fn value(&self, group: &Group, crossings: &[Crossing]) -> Option<(f64, f64)> {
        let mut ends = vec![f64::NEG_INFINITY];
        let mut open = 0.0;
        for crossing in crossings {
            match *crossing {
                Crossing::Wanted(_) | Crossing::Lost => return None,
                Crossing::Nowhere { .. } => {}
                Crossing::At { t, error, .. } => {
                    ends.push(t);
                    open += between(t - error - TOLERANCE, t + error + TOLERANCE);
                }
            }
        }
        ends.push(f64::INFINITY);
        ends.sort_by(f64::total_cmp);
        let value = ends.windows(2).map(|pair| {
            let (from, to) = (pair[0], pair[1]);
            let middle = match (from.is_finite(), to.is_finite()) {
                (true, true) => 0.5 * (from + to),
                (true, false) => from + 1.0,
                (false, true) => to - 1.0,
                (false, false) => 0.0,
            };
            if self.counts(group, crossings, middle) { between(from, to) } else { 0.0 }
        });
        Some((value.sum(), open))
    }

    /// Looks at random places of some lines whether they breach as the crossings say.
    fn probe(
        &mut self,
        evaluator: &mut Evaluator,
        group: &Group,
        k: usize,
        mirror: &Mirror,
        (lines, crossings): (&[Line], &[Vec<Crossing>]),
        first: u64,
    ) -> Result<()> {
        let far = (group.distance.abs() + 2.0).clamp(4.0, self.options.reach);
        let seed = self.options.seed ^ (k as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let places: Vec<(usize, f64)> = (0..lines.len())
            .filter(|line| line % PROBED == (line / self.options.scrambles as usize) % PROBED)
            .map(|line| {
                let mut own = stream(seed, Purpose::LineSampling, first + line as u64);
                (line, far * (2.0 * open_uniform(&mut own) - 1.0))
            })
            .collect();
        let rows: Vec<Vec<f64>> =
            places.iter().map(|&(line, t)| mirror.point(t, &lines[line].across)).collect();
        let margins = evaluator.margins(&Columns::from_rows(&rows))?;
        for (row, &(line, t)) in places.iter().enumerate() {
            let near = |crossing: &Crossing| match *crossing {
                Crossing::At { t: root, error, .. } => (t - root).abs() < 1e-3 + 10.0 * error,
                _ => false,
            };
            if crossings[line].iter().any(near) {
                continue;
            }
            let seen = self.counted_breach(group, |m| margins.get(row, self.members[m]) < 0.0);
            let said = self.counts(group, &crossings[line], t);
            let found = &mut self.lines[k];
            found.probes += 1;
            if seen != said {
                found.surprises += 1;
                found.questioned += 2.0 * far * normal::density(t) * lines[line].weight;
            }
        }
        Ok(())
    }

    /// The estimate; or why there is none, and whether more lines could not mend that.
    fn estimate(&self, event: Event) -> std::result::Result<Estimate, (String, bool)> {
        let scrambles = self.options.scrambles as usize;
        let (mut low, mut high) = (vec![0.0; scrambles], vec![0.0; scrambles]);
        let (mut open, mut questioned, mut lost, mut all) = (0.0, 0.0, 0, 0);
        let (mut sum, mut squares, mut largest) = (0.0, 0.0, 0.0_f64);
        // The weights' mean is 1: what it differs by is taken off, so that lines that agree leave no error.
        let weighted = |of: fn(&Value) -> f64| -> f64 {
            let mean = |lines: &Lines| {
                lines.values.iter().map(of).sum::<f64>() / lines.values.len().max(1) as f64
            };
            self.lines.iter().map(mean).sum::<f64>()
        };
        let groups = 0.5 * self.lines.len() as f64;
        let unit = weighted(|value| value.weight) / groups;
        let level = |of: fn(&Value) -> f64| weighted(of) / unit / groups;
        let (level_low, level_high) =
            (level(|v| v.weight * v.safe), level(|v| v.weight * v.breach));
        for lines in &self.lines {
            for (k, value) in lines.values.iter().enumerate() {
                let share = value.weight / lines.count as f64;
                low[k % scrambles] += share * (value.safe - level_low);
                high[k % scrambles] += share * (value.breach - level_high);
                let part = share * value.safe;
                sum += part;
                squares += part * part;
                largest = largest.max(part);
            }
            open += lines.open / lines.values.len() as f64;
            questioned += lines.questioned / lines.probes.max(1) as f64;
            lost += lines.lost;
            all += lines.values.len();
        }
        low.iter_mut().for_each(|p| *p += groups * level_low);
        high.iter_mut().for_each(|p| *p += groups * level_high);
        let probability = low.iter().sum::<f64>() / scrambles as f64;
        let surprises: usize = self.lines.iter().map(|lines| lines.surprises).sum();
        let probes: usize = self.lines.iter().map(|lines| lines.probes).sum();
        if lost as f64 > LOST_SHARE * all as f64 {
            return Err((format!("{lost} of {all} lines could not be followed"), true));
        }
        if questioned > QUESTIONED_SHARE * probability {
            let why = format!(
                "{surprises} of {probes} probes breach otherwise than the lines' crossings say"
            );
            return Err((why, true));
        }
        let effective = if squares > 0.0 { sum * sum / squares } else { 0.0 };
        if effective < LEAST_EFFECTIVE || largest > LARGEST_SHARE * sum {
            let why = format!("the lines count as {effective:.0} only");
            return Err((why, false));
        }
        let trust =
            WeightChecks { effective_breaches: 0.0, largest_share: 1.0, tail_index: f64::INFINITY };
        let summary = |shares: Vec<f64>| {
            let replicates = WeightedBreaches { samples: scrambles as u64, weights: shares };
            replicates.summary(self.options.confidence, &trust)
        };
        let (low, high) = (summary(low), summary(high));
        let interval = match (low.interval, high.interval) {
            (Earned::Interval(low), Earned::Interval(high)) => Interval {
                upper: high.upper,
                method: "scrambled lines, Student t corrected for skewness",
                ..low
            }
            .into(),
            (Earned::None(why), _) | (_, Earned::None(why)) => Earned::None(why),
        };
        let mut estimate = Estimate {
            method: Method::LineSampling,
            event,
            probability: Some(low.probability),
            probability_with_faults: Some(high.probability),
            standard_error: Some(low.standard_error),
            interval,
            evaluations: 0,
            faults: lost as u64,
            diagnostics: vec![format!(
                "{} lines along {} directions, in {scrambles} scrambles; {surprises} of {probes} probes breach \
                 otherwise than the lines' crossings say",
                all,
                self.lines.len().div_ceil(2)
            )],
            replicates: Vec::new(),
        };
        widen(&mut estimate, open);
        Ok(estimate)
    }
}

impl Lines {
    fn take(&mut self, weight: f64, value: Option<(f64, f64)>) {
        let (safe, breach) = match value {
            Some((value, open)) => {
                self.open += weight * open;
                (value, value)
            }
            None => {
                self.lost += 1;
                (0.0, 1.0)
            }
        };
        self.values.push(Value { safe, breach, weight });
    }
}

/// The reflection that takes the first axis to a direction, and so the others to what is orthogonal to it.
struct Mirror {
    normal: Vec<f64>,
    /// 2/‖normal‖²; zero for the first axis itself.
    scale: f64,
}

impl Mirror {
    fn new(direction: &[f64]) -> Mirror {
        let mut normal: Vec<f64> = direction.iter().map(|x| -x).collect();
        normal[0] += 1.0;
        let square = dot(&normal, &normal);
        Mirror { normal, scale: if square > 1e-24 { 2.0 / square } else { 0.0 } }
    }

    /// The point t along the direction and `across` beside it.
    fn point(&self, t: f64, across: &[f64]) -> Vec<f64> {
        let mut point = Vec::with_capacity(across.len() + 1);
        point.push(t);
        point.extend_from_slice(across);
        let share = self.scale * dot(&self.normal, &point);
        point.iter_mut().zip(&self.normal).for_each(|(x, n)| *x -= share * n);
        point
    }
}
