//! The design space over two paths: maps of P(any breach) and of the nominal margin, and the best value.

use super::Figure;
use super::axis::Axis;
use super::chart::{BLUE, Chart, GREEN, INK};
use super::contour::{Field, Point};
use super::key::Swatch;
use super::sweep::path_label;
use crate::findings::known::GoAnswer;
use crate::findings::sweep::{PathFinding, SweepFinding};
use crate::findings::sweep_best::BestFinding;
use crate::numerics::special::normal;
use crate::render::figures_of_speech::{count, probability, value};
use crate::units::display;

/// Okabe and Ito's yellow: seen on the blues where P is small.
const MET: &str = "#f0e442";
/// A map needs more room than a curve.
const TALL: f64 = 430.0;
/// Classes of P(any breach), by their lower ends, from what keeps the limits to what breaches them.
const PROBABILITY: [(f64, &str, &str); 6] = [
    (0.0, "#3d7fb8", "P < 1 %"),
    (0.01, "#8dbbd9", "1 to 5 %"),
    (0.05, "#cfe1ee", "5 to 10 %"),
    (0.1, "#fbe0cc", "10 to 50 %"),
    (0.5, "#f2ab80", "50 to 90 %"),
    (0.9, "#d0693f", "above 90 %"),
];
/// Classes of the relative margin of the limiting outcome, by their lower ends.
const MARGIN: [(f64, &str, &str); 6] = [
    (f64::NEG_INFINITY, "#d0693f", "below −25 %"),
    (-0.25, "#f2ab80", "−25 to −10 %"),
    (-0.1, "#fbe0cc", "−10 to 0 %"),
    (0.0, "#cfe1ee", "0 to 5 %"),
    (0.05, "#8dbbd9", "5 to 10 %"),
    (0.1, "#3d7fb8", "above 10 %"),
];
/// Contours with a label, and how far up the map the label is sought.
const LABELLED: [(f64, f64); 4] = [(0.01, 0.18), (0.05, 0.42), (0.1, 0.66), (0.5, 0.9)];

type Classes = [(f64, &'static str, &'static str); 6];

/// The figures of two paths: the chosen one to the right, the other upwards.
pub(super) fn figures(
    sweep: &SweepFinding,
    first: &PathFinding,
    second: &PathFinding,
) -> Vec<Figure> {
    let map = Map::new(sweep, first, second);
    let figures = [map.probability(), map.margin(), map.best()];
    figures.into_iter().flatten().collect()
}

struct Map<'s> {
    sweep: &'s SweepFinding,
    across: &'s PathFinding,
    upward: &'s PathFinding,
    grid: Field,
}

impl<'s> Map<'s> {
    fn new(sweep: &'s SweepFinding, first: &'s PathFinding, second: &'s PathFinding) -> Self {
        let (across, upward) = if sweep.choice == 0 { (first, second) } else { (second, first) };
        let shown = |path: &PathFinding| {
            path.values.iter().map(|&v| display(path.quantity).shown(v)).collect()
        };
        let grid = Field { xs: shown(across), ys: shown(upward), values: Vec::new() };
        Map { sweep, across, upward, grid }
    }

    /// The place of the cell at a value of the path across and one of the path upward.
    fn cell(&self, i: usize, j: usize) -> usize {
        if self.sweep.choice == 0 { i * self.grid.ys.len() + j } else { j * self.grid.xs.len() + i }
    }

    fn axes(&self) -> Option<(Axis, Axis)> {
        let ends = |values: &[f64]| Some((*values.first()?, *values.last()?));
        let ((left, right), (low, high)) = (ends(&self.grid.xs)?, ends(&self.grid.ys)?);
        let x = Axis::linear(path_label(self.across), left, right);
        Some((x, Axis::linear(path_label(self.upward), low, high)))
    }

    /// The smallest relative margin of each nominal descent.
    fn margins(&self) -> Field {
        self.grid.map(|i, j| {
            let cell = &self.sweep.cells[self.cell(i, j)];
            cell.limiting.and_then(|k| cell.relative_margins[k]).unwrap_or(f64::NAN)
        })
    }

    /// P(any breach) as a normal deviate, on which contours are straighter than on P.
    fn deviates(&self) -> Option<Field> {
        self.sweep.samples?;
        Some(self.grid.map(|i, j| {
            let counts = self.sweep.cells[self.cell(i, j)].counts.first();
            counts.map_or(f64::NAN, |any| {
                normal::quantile((any.most_breaches() as f64 + 0.5) / (any.samples as f64 + 1.0))
            })
        }))
    }

    fn keys(classes: &Classes) -> Vec<(Swatch, String)> {
        classes
            .iter()
            .map(|(_, fill, text)| (Swatch::Area(fill, 1.0), (*text).to_owned()))
            .collect()
    }

    fn fill(chart: &mut Chart, field: &Field, classes: &Classes, level: impl Fn(f64) -> f64) {
        for (from, fill, _) in classes {
            // Every class over the whole of those before it leaves no seam between them.
            chart.region(&field.at_least(level(*from)), fill);
        }
    }

    fn present(&self) -> Option<Point> {
        let place = |path: &PathFinding, values: &[f64]| {
            let present = display(path.quantity).shown(path.present);
            let inside = *values.first()? <= present && present <= *values.last()?;
            inside.then_some(present)
        };
        Some((place(self.across, &self.grid.xs)?, place(self.upward, &self.grid.ys)?))
    }

    fn mark_present(&self, chart: &mut Chart) {
        if let Some(present) = self.present() {
            chart.dots(&[present], INK, 6.0, 1.0);
            chart.dots(&[present], "#ffffff", 3.6, 1.0);
        }
    }

    fn present_key(&self) -> Option<(Swatch, String)> {
        self.present().map(|_| (Swatch::Dot(INK), "the study's design".to_owned()))
    }

    fn probability(&self) -> Option<Figure> {
        let field = self.deviates()?;
        let samples = self.sweep.samples?;
        let (x, y) = self.axes()?;
        let mut keys = Self::keys(&PROBABILITY);
        let met: Vec<Point> = self.points(|k| self.sweep.cells[k].answer == GoAnswer::Go);
        if !met.is_empty() {
            keys.push((Swatch::Dot(MET), "requirement shown to be met".to_owned()));
        }
        keys.push((Swatch::Line(INK, false), "nominal descent keeps all limits inside".to_owned()));
        keys.extend(self.present_key());
        let name = "sweep-map-probability";
        let mut chart = Chart::new(name, TALL, &x, &y, keys, false);
        Self::fill(&mut chart, &field, &PROBABILITY, |p| match p {
            p if p <= 0.0 => f64::NEG_INFINITY,
            p => normal::quantile(p),
        });
        let contours: Vec<(f64, f64, Vec<[Point; 2]>)> = LABELLED
            .iter()
            .map(|&(p, height)| (p, height, field.contour(normal::quantile(p))))
            .collect();
        for (_, _, segments) in &contours {
            chart.contour(segments, "#4d4d4d", 0.8);
        }
        chart.contour(&self.margins().contour(0.0), INK, 2.2);
        chart.dots(&met, MET, 1.9, 1.0);
        self.mark_present(&mut chart);
        for (p, height, segments) in &contours {
            let wanted =
                self.grid.ys[0] + height * (self.grid.ys[self.grid.ys.len() - 1] - self.grid.ys[0]);
            let middle = |s: &[Point; 2]| (0.5 * (s[0].0 + s[1].0), 0.5 * (s[0].1 + s[1].1));
            let near = segments.iter().map(middle);
            let place = near.min_by(|a, b| (a.1 - wanted).abs().total_cmp(&(b.1 - wanted).abs()));
            if let Some(place) = place {
                chart.note(place, &probability(*p));
            }
        }
        let title = format!("P(any breach) over {} and {}", self.across.path, self.upward.path);
        let caption = format!(
            "{} samples in each of {} cells, the same points in all of them; contours at 1, 5, 10 and 50 %.",
            count(samples),
            count(self.sweep.cells.len() as u64),
        );
        let alternative = format!(
            "Map of P(any breach); {} of {} cells are shown to meet the requirement, and in {} the nominal \
             descent keeps every limit.",
            met.len(),
            self.sweep.cells.len(),
            self.points(|k| self.nominal_keeps(k)).len()
        );
        let svg = chart.svg(&title, &alternative);
        Some(Figure { name: name.to_owned(), title, caption, alternative, svg })
    }

    fn nominal_keeps(&self, k: usize) -> bool {
        let margins = &self.sweep.cells[k].margins;
        margins.iter().all(|margin| margin.is_some_and(|m| m >= 0.0))
    }

    fn points(&self, holds: impl Fn(usize) -> bool) -> Vec<Point> {
        let all =
            (0..self.grid.xs.len()).flat_map(|i| (0..self.grid.ys.len()).map(move |j| (i, j)));
        all.filter(|&(i, j)| holds(self.cell(i, j)))
            .map(|(i, j)| (self.grid.xs[i], self.grid.ys[j]))
            .collect()
    }

    fn margin(&self) -> Option<Figure> {
        let sweep = self.sweep;
        if sweep.limits.is_empty() {
            return None;
        }
        let (x, y) = self.axes()?;
        let field = self.margins();
        let mut keys = Self::keys(&MARGIN);
        keys.push((Swatch::Line(INK, false), "a limit is just kept".to_owned()));
        keys.extend(self.present_key());
        let name = "sweep-map-margin";
        let mut chart = Chart::new(name, TALL, &x, &y, keys, false);
        Self::fill(&mut chart, &field, &MARGIN, |m| m);
        let mut places = Vec::new();
        for (k, limit) in sweep.limits.iter().enumerate() {
            // Above zero where this limit is the one with the smallest margin.
            let lead = self.grid.map(|i, j| {
                let margins = &sweep.cells[self.cell(i, j)].relative_margins;
                let own = margins[k].unwrap_or(f64::NAN);
                let others = margins.iter().enumerate().filter(|(other, _)| *other != k);
                let least = others.filter_map(|(_, m)| *m).fold(f64::INFINITY, f64::min);
                (least - own).min(10.0)
            });
            if k > 0 {
                chart.contour(&lead.contour(0.0), "#666666", 1.2);
            }
            let inside = self.points(|cell| sweep.cells[cell].limiting == Some(k));
            if inside.len() >= 8 {
                places.push((middle(&inside), limit.quantity.title()));
            }
        }
        chart.contour(&field.contour(0.0), INK, 2.2);
        self.mark_present(&mut chart);
        for (place, text) in places {
            chart.note(place, text);
        }
        let title =
            format!("Smallest nominal margin over {} and {}", self.across.path, self.upward.path);
        let caption = "The margin of the limiting outcome, named in its region, as a share of the limit (of a \
                       temperature: of the rise from the start to the limit). Inside the black line the \
                       nominal descent keeps every limit."
            .to_owned();
        let kept = self.points(|k| self.nominal_keeps(k)).len();
        let alternative = format!(
            "Map of the smallest margin; the nominal descent keeps every limit in {kept} of {} cells.",
            sweep.cells.len()
        );
        let svg = chart.svg(&title, &alternative);
        Some(Figure { name: name.to_owned(), title, caption, alternative, svg })
    }

    /// The best value across for each value upward: here the given value runs to the right.
    fn best(&self) -> Option<Figure> {
        let sweep = self.sweep;
        sweep.samples?;
        let (across, given) = (display(self.across.quantity), display(self.upward.quantity));
        let place = |best: &BestFinding, v: f64| Some((given.shown(best.given?), across.shown(v)));
        let points: Vec<Point> =
            sweep.best.iter().filter_map(|b| place(b, b.best.value?)).collect();
        let stretch = |read: fn(&BestFinding) -> Option<(f64, f64)>| -> Vec<Vec<(f64, f64, f64)>> {
            let mut stretches = vec![Vec::new()];
            for best in &sweep.best {
                match (best.given, read(best)) {
                    (Some(x), Some((low, high))) => {
                        let row = (given.shown(x), across.shown(low), across.shown(high));
                        if let Some(last) = stretches.last_mut() {
                            last.push(row);
                        }
                    }
                    _ => stretches.push(Vec::new()),
                }
            }
            stretches
        };
        let met = stretch(|b| b.met);
        let feasible = stretch(|b| b.feasible);
        let mut keys = vec![
            (Swatch::Line(BLUE, false), "least P(any breach)".to_owned()),
            (Swatch::Area(BLUE, 0.35), "95 % interval".to_owned()),
            (Swatch::Area("#bdbdbd", 0.55), "nominal descent keeps all limits".to_owned()),
        ];
        if met.iter().any(|part| !part.is_empty()) {
            keys.push((Swatch::Area(GREEN, 0.55), "requirement shown to be met".to_owned()));
        }
        keys.extend(self.present_key());
        let (y, x) = self.axes()?;
        let name = "sweep-best";
        let mut chart = Chart::new(name, 360.0, &x, &y, keys, false);
        for (parts, fill, opacity) in [(&feasible, "#bdbdbd", 0.55), (&met, GREEN, 0.55)] {
            for part in parts {
                match part[..] {
                    [(x, low, high)] => chart.line(&[(x, low), (x, high)], fill, 3.0, false),
                    _ => chart.band(part, fill, opacity),
                }
            }
        }
        let interval = stretch(|b| b.best.interval.interval().map(|i| (i.lower, i.upper)));
        for part in &interval {
            chart.band(part, BLUE, 0.35);
        }
        chart.line(&points, BLUE, 1.6, false);
        chart.dots(&points, BLUE, 3.2, 1.0);
        // A best value without an interval is hollow: mostly an end of the swept range.
        let hollow: Vec<Point> = sweep
            .best
            .iter()
            .filter(|best| best.best.interval.interval().is_none())
            .filter_map(|best| place(best, best.best.value?))
            .collect();
        chart.dots(&hollow, "#ffffff", 2.0, 1.0);
        if let Some((x, y)) = self.present() {
            chart.dots(&[(y, x)], INK, 6.0, 1.0);
            chart.dots(&[(y, x)], "#ffffff", 3.6, 1.0);
        }
        let title = format!("The best {} for each {}", self.across.path, self.upward.path);
        let caption =
            "Where P(any breach) is least, with its interval; hollow where there is none, as at an \
                       end of the swept range."
                .to_owned();
        let (first, last) = (sweep.best.first()?, sweep.best.last()?);
        let words = |best: &BestFinding| {
            let found =
                best.best.value.map_or("none".to_owned(), |v| value(v, self.across.quantity));
            let at = best.given.map_or(String::new(), |v| value(v, self.upward.quantity));
            format!("{found} at {at}")
        };
        let alternative = format!("The best value goes from {} to {}.", words(first), words(last));
        let svg = chart.svg(&title, &alternative);
        Some(Figure { name: name.to_owned(), title, caption, alternative, svg })
    }
}

/// The point of a set that is nearest to its centre of gravity.
fn middle(points: &[Point]) -> Point {
    let n = points.len().max(1) as f64;
    let span = |read: fn(&Point) -> f64| {
        let low = points.iter().map(read).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(read).fold(f64::NEG_INFINITY, f64::max);
        (points.iter().map(read).sum::<f64>() / n, (high - low).max(f64::MIN_POSITIVE))
    };
    let ((x, wide), (y, high)) = (span(|p| p.0), span(|p| p.1));
    let far = |p: &Point| {
        let (a, b) = ((p.0 - x) / wide, (p.1 - y) / high);
        a * a + b * b
    };
    points.iter().copied().min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or((x, y))
}
