//! Where rays cross the boundary of an event: roots of many one-dimensional margins, found together.

use super::event::{BATCH, Evaluator};
use crate::error::Result;
use crate::numerics::columns::Columns;

/// A ray origin + t direction.
pub struct Ray {
    /// Values of t where the margin is looked at, ascending, the same number for every ray.
    pub grid: Vec<f64>,
    /// The point at t = 0.
    pub origin: Vec<f64>,
    /// The unit direction.
    pub direction: Vec<f64>,
}

/// The stretches of a ray that breach, as intervals of t, ascending. The first and last reach to the
/// ends of the grid where the ray breaches there.
pub type Breached = Vec<(f64, f64)>;

/// A root is known to about this distance.
pub const TOLERANCE: f64 = 1e-5;

/// A grid from `from` to `to` whose inner nodes, `cell` apart, are shifted by a share of a cell.
///
/// With a random shift a stretch thinner than a cell is seen with probability width/cell, so that what is
/// seen can stand for what is not ([`measure`]).
pub fn shifted_grid(from: f64, to: f64, cells: usize, shift: f64) -> Vec<f64> {
    let cell = (to - from) / cells as f64;
    let mut grid = vec![from];
    grid.extend((0..cells).map(|k| from + (k as f64 + shift) * cell));
    grid.push(to);
    grid
}

/// Measure of the breached stretches, each thinner than a cell raised by the inverse of the probability
/// that a random grid sees it, and each thin gap between two likewise lowered.
///
/// Source: Horvitz and Thompson, J. Am. Stat. Assoc. 47 (1952) 663.
pub fn measure(stretches: &Breached, cell: f64, of: impl Fn(f64, f64) -> f64) -> f64 {
    let weight = |from: f64, to: f64| (cell / (to - from).max(TOLERANCE)).max(1.0);
    let seen: f64 = stretches.iter().map(|&(from, to)| weight(from, to) * of(from, to)).sum();
    let gaps = stretches.windows(2).map(|pair| (pair[0].1, pair[1].0));
    seen - gaps.map(|(from, to)| (weight(from, to) - 1.0) * of(from, to)).sum::<f64>()
}

/// A change of sign between two values of t, being closed in on.
struct Bracket {
    ray: usize,
    /// (t, margin) on either side.
    left: (f64, f64),
    right: (f64, f64),
    /// Which side the last root estimate replaced.
    last: Option<bool>,
    root: Option<f64>,
}

impl Bracket {
    fn next(&self) -> f64 {
        let ((a, fa), (b, fb)) = (self.left, self.right);
        let middle = 0.5 * (a + b);
        let secant = b - fb * (b - a) / (fb - fa);
        // Margins of read faults are infinite, and have no secant.
        if secant.is_finite() { secant.clamp(a, b) } else { middle }
    }

    /// The Illinois rule: the end that stays has its margin halved, so both ends close in.
    fn take(&mut self, t: f64, margin: f64) {
        let replaces_left = (margin < 0.0) == (self.left.1 < 0.0);
        if replaces_left {
            self.left = (t, margin);
            if self.last == Some(true) {
                self.right.1 *= 0.5;
            }
        } else {
            self.right = (t, margin);
            if self.last == Some(false) {
                self.left.1 *= 0.5;
            }
        }
        self.last = Some(replaces_left);
        let moved = (self.next() - t).abs();
        if moved < TOLERANCE || self.right.0 - self.left.0 < TOLERANCE {
            self.root = Some(self.next());
        }
    }
}

/// The breached stretches of every ray: margins on its grid, changes of sign closed in on in batches.
///
/// A stretch that begins and ends within one cell of the grid is not seen.
///
/// # Errors
/// Those of the limit state.
pub fn breached(evaluator: &mut Evaluator, rays: &[Ray]) -> Result<Vec<Breached>> {
    let mut all = Vec::with_capacity(rays.len());
    let nodes = rays.first().map_or(1, |ray| ray.grid.len().max(1));
    for chunk in rays.chunks((BATCH / nodes).max(1)) {
        all.extend(chunk_breached(evaluator, chunk)?);
    }
    Ok(all)
}

fn at(ray: &Ray, t: f64) -> Vec<f64> {
    ray.origin.iter().zip(&ray.direction).map(|(o, d)| o + t * d).collect()
}

fn chunk_breached(evaluator: &mut Evaluator, rays: &[Ray]) -> Result<Vec<Breached>> {
    let rows: Vec<Vec<f64>> =
        rays.iter().flat_map(|ray| ray.grid.iter().map(|&t| at(ray, t))).collect();
    let mut values = Vec::new();
    evaluator.evaluate(&Columns::from_rows(&rows), &mut values)?;
    let mut left = &values[..];
    let mut margins: Vec<Vec<f64>> = Vec::with_capacity(rays.len());
    for ray in rays {
        let (own, rest) = left.split_at(ray.grid.len());
        margins.push(own.to_vec());
        left = rest;
    }
    let mut brackets: Vec<Bracket> = Vec::new();
    for (ray, margins) in margins.iter().enumerate() {
        let grid = &rays[ray].grid;
        for k in 1..grid.len() {
            if (margins[k - 1] < 0.0) != (margins[k] < 0.0) {
                let (left, right) = ((grid[k - 1], margins[k - 1]), (grid[k], margins[k]));
                brackets.push(Bracket { ray, left, right, last: None, root: None });
            }
        }
    }
    for _ in 0..60 {
        let open: Vec<usize> =
            (0..brackets.len()).filter(|&k| brackets[k].root.is_none()).collect();
        if open.is_empty() {
            break;
        }
        let ts: Vec<f64> = open.iter().map(|&k| brackets[k].next()).collect();
        let rows: Vec<Vec<f64>> =
            open.iter().zip(&ts).map(|(&k, &t)| at(&rays[brackets[k].ray], t)).collect();
        evaluator.evaluate(&Columns::from_rows(&rows), &mut values)?;
        for ((&k, &t), &margin) in open.iter().zip(&ts).zip(&values) {
            brackets[k].take(t, margin);
        }
    }
    let mut all: Vec<Breached> = Vec::with_capacity(rays.len());
    let mut next = brackets.iter().peekable();
    for (ray, margins) in margins.iter().enumerate() {
        let mut stretches = Breached::new();
        let grid = &rays[ray].grid;
        let mut start = (margins[0] < 0.0).then_some(grid[0]);
        while let Some(bracket) = next.next_if(|bracket| bracket.ray == ray) {
            let root = bracket.root.unwrap_or_else(|| bracket.next());
            match start.take() {
                Some(from) => stretches.push((from, root)),
                None => start = Some(root),
            }
        }
        if let (Some(from), Some(&to)) = (start, grid.last()) {
            stretches.push((from, to));
        }
        all.push(stretches);
    }
    Ok(all)
}
