//! Regions and contour lines of a field on a grid, linear on each half of a cell.

/// A point of the plane.
pub(super) type Point = (f64, f64);

/// Values on a grid: `values[i][j]` at `(xs[i], ys[j])`; NaN where unknown.
#[derive(Debug, Clone)]
pub(super) struct Field {
    pub xs: Vec<f64>,
    pub ys: Vec<f64>,
    pub values: Vec<Vec<f64>>,
}

impl Field {
    /// The field of another value at each point.
    pub fn map(&self, value: impl Fn(usize, usize) -> f64) -> Field {
        let row = |i| (0..self.ys.len()).map(|j| value(i, j)).collect();
        Field { values: (0..self.xs.len()).map(row).collect(), ..self.clone() }
    }

    /// Polygons that cover where the value is at least `level`; whole cells in a column are one.
    pub fn at_least(&self, level: f64) -> Vec<Vec<Point>> {
        let mut polygons = Vec::new();
        for i in 0..self.xs.len().saturating_sub(1) {
            let mut whole: Option<usize> = None;
            for j in 0..self.ys.len().saturating_sub(1) {
                let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
                if corners.iter().all(|&(a, b)| self.values[a][b] >= level) {
                    whole = whole.or(Some(j));
                    continue;
                }
                polygons.extend(whole.take().map(|from| self.column(i, from, j)));
                for triangle in self.triangles(i, j) {
                    let part = clipped(&triangle, level);
                    if part.len() > 2 {
                        polygons.push(part);
                    }
                }
            }
            polygons.extend(whole.take().map(|from| self.column(i, from, self.ys.len() - 1)));
        }
        polygons
    }

    fn column(&self, i: usize, from: usize, to: usize) -> Vec<Point> {
        let (left, right) = (self.xs[i], self.xs[i + 1]);
        // Every grid point on its sides is a corner, as it is of the neighbours.
        let up = (from..=to).map(|j| (right, self.ys[j]));
        let down = (from..=to).rev().map(|j| (left, self.ys[j]));
        up.chain(down).collect()
    }

    fn triangles(&self, i: usize, j: usize) -> [[(Point, f64); 3]; 2] {
        let at = |i: usize, j: usize| ((self.xs[i], self.ys[j]), self.values[i][j]);
        let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        [[a, b, c], [a, c, d]]
    }

    /// The lines along which the value is `level`, piece by piece.
    pub fn contour(&self, level: f64) -> Vec<[Point; 2]> {
        let mut segments = Vec::new();
        for i in 0..self.xs.len().saturating_sub(1) {
            for j in 0..self.ys.len().saturating_sub(1) {
                for triangle in self.triangles(i, j) {
                    if triangle.iter().any(|(_, value)| value.is_nan()) {
                        continue;
                    }
                    let ends: Vec<Point> = edges(&triangle)
                        .filter(|(a, b)| (a.1 >= level) != (b.1 >= level))
                        .map(|(a, b)| crossing(a, b, level))
                        .collect();
                    if let [a, b] = ends[..] {
                        segments.push([a, b]);
                    }
                }
            }
        }
        segments
    }
}

/// A contour's segments, line by line: those that share an end belong together.
pub(super) fn lines(segments: &[[Point; 2]], tolerance: Point) -> Vec<Vec<[Point; 2]>> {
    let same =
        |a: Point, b: Point| (a.0 - b.0).abs() <= tolerance.0 && (a.1 - b.1).abs() <= tolerance.1;
    let touch = |a: &[Point; 2], b: &[Point; 2]| a.iter().any(|&p| b.iter().any(|&q| same(p, q)));
    let mut lines: Vec<Vec<[Point; 2]>> = Vec::new();
    for segment in segments {
        let (with, apart): (Vec<_>, Vec<_>) =
            lines.into_iter().partition(|line| line.iter().any(|other| touch(segment, other)));
        lines = apart;
        lines.push(with.into_iter().flatten().chain([*segment]).collect());
    }
    lines
}

type Corner = (Point, f64);

fn edges(triangle: &[Corner; 3]) -> impl Iterator<Item = (Corner, Corner)> {
    let corners = *triangle;
    (0..3).map(move |k| (corners[k], corners[(k + 1) % 3]))
}

/// Where the value is `level` between two corners; the same bits from either.
fn crossing(a: Corner, b: Corner, level: f64) -> Point {
    let (a, b) = if a.1 <= b.1 { (a, b) } else { (b, a) };
    let share = (level - a.1) / (b.1 - a.1);
    (a.0.0 + share * (b.0.0 - a.0.0), a.0.1 + share * (b.0.1 - a.0.1))
}

/// The part of a triangle where the value is at least `level`.
fn clipped(triangle: &[Corner; 3], level: f64) -> Vec<Point> {
    if triangle.iter().any(|(_, value)| value.is_nan()) {
        return Vec::new();
    }
    let mut part = Vec::new();
    for (a, b) in edges(triangle) {
        if a.1 >= level {
            part.push(a.0);
        }
        if (a.1 >= level) != (b.1 >= level) {
            part.push(crossing(a, b, level));
        }
    }
    part
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane() -> Field {
        let values = (0..3).map(|i| (0..3).map(|j| (i + j) as f64).collect()).collect();
        Field { xs: vec![0.0, 1.0, 2.0], ys: vec![0.0, 1.0, 2.0], values }
    }

    fn area(polygon: &[Point]) -> f64 {
        let next = |k: usize| polygon[(k + 1) % polygon.len()];
        let twice: f64 =
            polygon.iter().enumerate().map(|(k, a)| a.0 * next(k).1 - next(k).0 * a.1).sum();
        twice.abs() / 2.0
    }

    #[test]
    fn analytic_the_region_of_a_plane_has_its_area() {
        // Of the square of side 2, x + y ≥ c leaves 4 − c²/2 for c ≤ 2.
        for level in [0.25, 1.0, 1.5] {
            let total: f64 = plane().at_least(level).iter().map(|p| area(p)).sum();
            assert!((total - (4.0 - level * level / 2.0)).abs() < 1e-12, "{level}: {total}");
        }
        assert!(plane().at_least(9.0).is_empty());
    }

    #[test]
    fn analytic_the_contour_of_a_plane_is_its_line() {
        let segments = plane().contour(1.5);
        let length: f64 = segments
            .iter()
            .map(|[a, b]| ((a.0 - b.0) * (a.0 - b.0) + (a.1 - b.1) * (a.1 - b.1)).sqrt())
            .sum();
        assert!((length - 1.5 * 2f64.sqrt()).abs() < 1e-12);
        assert!(segments.iter().flatten().all(|(x, y)| (x + y - 1.5).abs() < 1e-12));
    }
}
