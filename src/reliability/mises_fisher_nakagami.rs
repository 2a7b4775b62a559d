//! Mixtures of von Mises–Fisher directions with Nakagami distances: densities that follow a rare breach
//! through two dimensions or a hundred, where a Gaussian's weights degenerate.
//!
//! Sources: Papaioannou, Geyer and Straub, Reliability Engineering and System Safety 191 (2019) 106564, the
//! family; Wood, Communications in Statistics 23 (1994) 157, directions; Banerjee, Dhillon, Ghosh and
//! Sra, J. Machine Learning Research 6 (2005) 1345, the fit of the concentration.

use super::draws::{direction, gamma, open_uniform};
use super::vectors::{dot, norm};
use crate::numerics::elementary::{exp, ln};
use crate::numerics::special::gamma::ln_gamma;
use crate::streams::Stream;
use std::f64::consts::PI;

/// One component in n ≥ 2 dimensions.
#[derive(Debug, Clone, PartialEq)]
pub struct Component {
    /// Share in the mixture.
    pub share: f64,
    /// Mean direction μ, a unit vector.
    pub mean: Vec<f64>,
    /// Concentration κ of the directions around it.
    pub concentration: f64,
    /// Shape m of the distances.
    pub shape: f64,
    /// Mean square Ω of the distances.
    pub spread: f64,
    /// Logarithm of the factors that do not depend on the point.
    ln_norm: f64,
}

/// A point by its direction and its distance from the origin, of which densities need the logarithm and
/// the square.
#[derive(Clone)]
struct Polar {
    direction: Vec<f64>,
    ln_radius: f64,
    square: f64,
}

impl Polar {
    fn of(point: &[f64]) -> Self {
        let square = dot(point, point);
        let radius = square.sqrt();
        let direction = point.iter().map(|x| x / radius).collect();
        Polar { direction, ln_radius: ln(radius), square }
    }
}

/// Points that most rounds of a fit are content with.
const COARSE: usize = 1000;

/// Largest mean resultant length that a fit may claim, lest a lucky cluster close off its surroundings.
const MOST_RESULTANT: f64 = 0.995;

impl Component {
    fn new(share: f64, mean: Vec<f64>, concentration: f64, shape: f64, spread: f64) -> Self {
        let n = mean.len() as f64;
        let order = 0.5 * n - 1.0;
        // κ^ν / I_ν(κ) with its limit 2^ν Γ(ν + 1) at κ = 0 taken out of the series.
        let ln_directions = order * ln(2.0) + ln_gamma(order + 1.0)
            - ln_bessel_series(order, concentration)
            - 0.5 * n * ln(2.0 * PI);
        let ln_distances = ln(2.0) + shape * ln(shape / spread) - ln_gamma(shape);
        let ln_norm = ln_directions + ln_distances;
        Component { share, mean, concentration, shape, spread, ln_norm }
    }

    /// Logarithm of the density at a point.
    fn ln_density(&self, at: &Polar) -> f64 {
        self.ln_norm
            + self.concentration * dot(&self.mean, &at.direction)
            + (2.0 * self.shape - self.mean.len() as f64) * at.ln_radius
            - self.shape / self.spread * at.square
    }

    fn draw(&self, stream: &mut Stream) -> Vec<f64> {
        let n = self.mean.len();
        let cosine = self.draw_cosine(stream);
        let mut across = direction(stream, n);
        let along = dot(&across, &self.mean);
        across.iter_mut().zip(&self.mean).for_each(|(x, m)| *x -= along * m);
        let length = norm(&across).max(1e-300);
        let radius = (gamma(stream, self.shape) * self.spread / self.shape).sqrt();
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let parts = self.mean.iter().zip(&across);
        parts.map(|(m, a)| radius * (cosine * m + sine * a / length)).collect()
    }

    /// Cosine of the angle to the mean direction, by Wood's rejection.
    fn draw_cosine(&self, stream: &mut Stream) -> f64 {
        let d = self.mean.len() as f64 - 1.0;
        let kappa = self.concentration;
        let b = d / (2.0 * kappa + (4.0 * kappa * kappa + d * d).sqrt());
        let x = (1.0 - b) / (1.0 + b);
        let c = kappa * x + d * ln(1.0 - x * x);
        loop {
            let (one, other) = (gamma(stream, 0.5 * d), gamma(stream, 0.5 * d));
            let z = one / (one + other);
            let w = (1.0 - (1.0 + b) * z) / (1.0 - (1.0 - b) * z);
            if kappa * w + d * ln(1.0 - x * w) - c >= ln(open_uniform(stream)) {
                return w.clamp(-1.0, 1.0);
            }
        }
    }
}

/// ln Σ_k (κ²/4)^k / (k! (ν + 1)_k): the Bessel function I_ν without its leading power.
fn ln_bessel_series(order: f64, kappa: f64) -> f64 {
    let quarter = 0.25 * kappa * kappa;
    let (mut term, mut sum, mut scale, mut k) = (1.0_f64, 1.0_f64, 0.0, 0.0);
    while k < 100_000.0 {
        k += 1.0;
        term *= quarter / (k * (order + k));
        sum += term;
        if sum > 1e200 {
            term *= 1e-200;
            sum *= 1e-200;
            scale += 200.0 * std::f64::consts::LN_10;
        }
        if term < 1e-17 * sum && quarter < k * (order + k) {
            break;
        }
    }
    ln(sum) + scale
}

/// A mixture of components.
#[derive(Debug, Clone, PartialEq)]
pub struct Mixture {
    /// The components; their shares sum to 1.
    pub components: Vec<Component>,
}

impl Mixture {
    /// Logarithm of the density; −∞ at the origin, which is never drawn.
    pub fn ln_density(&self, point: &[f64]) -> f64 {
        if norm(point) <= 0.0 {
            return f64::NEG_INFINITY;
        }
        let at = Polar::of(point);
        let terms = self.components.iter().map(|c| ln(c.share) + c.ln_density(&at));
        ln_sum(&terms.collect::<Vec<f64>>())
    }

    /// A point.
    pub fn draw(&self, stream: &mut Stream) -> Vec<f64> {
        let mut left = open_uniform(stream);
        for component in &self.components {
            if left <= component.share {
                return component.draw(stream);
            }
            left -= component.share;
        }
        self.components[self.components.len() - 1].draw(stream)
    }

    /// The mixture with directions and distances spread more: a density to sample from should have
    /// heavier tails than the one that fits best, or what lies beyond carries large weights.
    pub fn widened(&self, factor: f64) -> Mixture {
        let wider = self.components.iter().map(|component| {
            Component::new(
                component.share,
                component.mean.clone(),
                component.concentration * factor,
                component.shape * factor,
                component.spread,
            )
        });
        Mixture { components: wider.collect() }
    }

    /// Several mixtures side by side, each with its share.
    pub fn side_by_side(mixtures: &[(Mixture, f64)]) -> Mixture {
        let scaled = |component: &Component, share: f64| Component {
            share: component.share * share,
            ..component.clone()
        };
        let components = mixtures.iter().flat_map(|(mixture, share)| {
            mixture.components.iter().map(move |component| scaled(component, *share))
        });
        Mixture { components: components.collect() }
    }

    /// Fits at most `components` components to weighted points by expectation and maximisation, from
    /// heavy points far apart; `None` if no weight is positive.
    pub fn fit(points: &[Vec<f64>], weights: &[f64], components: usize) -> Option<Mixture> {
        let total: f64 = weights.iter().sum();
        if !(total > 0.0 && total.is_finite()) {
            return None;
        }
        // What is left out carries less than a ten-thousandth of the weight, and most of the time.
        let least = 1e-4 * total / weights.len() as f64;
        let kept: Vec<usize> =
            (0..points.len()).filter(|&i| weights[i] > least && norm(&points[i]) > 0.0).collect();
        let weights: Vec<f64> = kept.iter().map(|&i| weights[i] / total).collect();
        let n = points.first().map_or(0, Vec::len);
        let points: Vec<Polar> = kept.iter().map(|&i| Polar::of(&points[i])).collect();
        // Most of the way on every so many points, the rest on all of them.
        let stride = (points.len() / COARSE).max(1);
        let every = || (0..points.len()).step_by(stride);
        let weight: f64 = every().map(|i| weights[i]).sum();
        let coarse: Vec<Polar> = every().map(|i| points[i].clone()).collect();
        let coarse_weights: Vec<f64> = every().map(|i| weights[i] / weight).collect();
        let owners = first_owners(&coarse, &coarse_weights, components);
        let least = (n as f64).max(20.0);
        let mut fitted = improved(&coarse, &coarse_weights, owners, least / stride as f64, 20);
        if stride > 1 && !fitted.is_empty() {
            let (owners, _) = expect(&fitted, &points, &weights);
            fitted = improved(&points, &weights, owners, least, 5);
        }
        if fitted.is_empty() {
            fitted.extend(maximise(&points, &weights, &vec![1.0; points.len()]));
        }
        let shares: f64 = fitted.iter().map(|component| component.share).sum();
        fitted.iter_mut().for_each(|component| component.share /= shares);
        (!fitted.is_empty()).then_some(Mixture { components: fitted })
    }
}

/// At most `rounds` of expectation and maximisation, from first owners; components that effectively own
/// fewer than `least` points are dropped.
fn improved(
    points: &[Polar],
    weights: &[f64],
    mut owners: Vec<Vec<f64>>,
    least: f64,
    rounds: usize,
) -> Vec<Component> {
    let mut fitted: Vec<Component> = Vec::new();
    let mut likelihood = f64::NEG_INFINITY;
    for _ in 0..rounds {
        fitted = owners
            .iter()
            .filter(|owned| effective(weights, owned) >= least)
            .filter_map(|owned| maximise(points, weights, owned))
            .collect();
        if fitted.len() < 2 {
            break;
        }
        let (next, gained) = expect(&fitted, points, weights);
        owners = next;
        if gained - likelihood < 1e-3 {
            break;
        }
        likelihood = gained;
    }
    fitted
}

fn ln_sum(terms: &[f64]) -> f64 {
    let most = terms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if most == f64::NEG_INFINITY {
        return most;
    }
    most + ln(terms.iter().map(|term| exp(term - most)).sum())
}

/// Points to the nearest of a few centres: the heaviest, then again and again the one whose weight times
/// distance (1 − cosine) from all before is largest.
fn first_owners(points: &[Polar], weights: &[f64], components: usize) -> Vec<Vec<f64>> {
    let mut centres: Vec<usize> = Vec::new();
    let mut distance = vec![1.0_f64; points.len()];
    while centres.len() < components.max(1).min(points.len()) {
        let mut best = 0;
        for i in 1..points.len() {
            if weights[i] * distance[i] > weights[best] * distance[best] {
                best = i;
            }
        }
        if centres.contains(&best) {
            break;
        }
        for (i, point) in points.iter().enumerate() {
            let apart = (1.0 - dot(&point.direction, &points[best].direction)).max(0.0);
            distance[i] = if centres.is_empty() { apart } else { distance[i].min(apart) };
        }
        centres.push(best);
    }
    let mut owners = vec![vec![0.0; points.len()]; centres.len()];
    for (i, point) in points.iter().enumerate() {
        let along = |centre: usize| dot(&point.direction, &points[centre].direction);
        let mut nearest = 0;
        for k in 1..centres.len() {
            if along(centres[k]) > along(centres[nearest]) {
                nearest = k;
            }
        }
        owners[nearest][i] = 1.0;
    }
    owners
}

/// Responsibilities of the components for the points, and the mean logarithm of the mixture.
fn expect(fitted: &[Component], points: &[Polar], weights: &[f64]) -> (Vec<Vec<f64>>, f64) {
    let mut likelihood = 0.0;
    let mut owners = vec![vec![0.0; points.len()]; fitted.len()];
    let ln_shares: Vec<f64> = fitted.iter().map(|component| ln(component.share)).collect();
    let mut terms = vec![0.0; fitted.len()];
    for (i, point) in points.iter().enumerate() {
        for ((term, component), ln_share) in terms.iter_mut().zip(fitted).zip(&ln_shares) {
            *term = ln_share + component.ln_density(point);
        }
        let most = terms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        terms.iter_mut().for_each(|term| *term = exp(*term - most));
        let sum: f64 = terms.iter().sum();
        for (owner, term) in owners.iter_mut().zip(&terms) {
            owner[i] = term / sum;
        }
        likelihood += weights[i] * (most + ln(sum));
    }
    (owners, likelihood)
}

/// Effective number of the points that a component owns: fewer than their dimension fit anything.
fn effective(weights: &[f64], owned: &[f64]) -> f64 {
    let products = weights.iter().zip(owned).map(|(w, o)| w * o);
    let sum: f64 = products.clone().sum();
    let squares: f64 = products.map(|x| x * x).sum();
    if squares > 0.0 { sum * sum / squares } else { 0.0 }
}

/// The component that fits its points best; none if it owns next to nothing.
fn maximise(points: &[Polar], weights: &[f64], owned: &[f64]) -> Option<Component> {
    let n = points.first()?.direction.len();
    let (mut share, mut second, mut fourth) = (0.0, 0.0, 0.0);
    let mut resultant = vec![0.0; n];
    for (i, point) in points.iter().enumerate() {
        let weight = weights[i] * owned[i];
        share += weight;
        second += weight * point.square;
        fourth += weight * point.square * point.square;
        resultant.iter_mut().zip(&point.direction).for_each(|(r, u)| *r += weight * u);
    }
    let length = norm(&resultant);
    if share < 1e-3 || length <= 1e-12 * share {
        return None;
    }
    let dimension = n as f64;
    let mean_length = (length / share).min(MOST_RESULTANT);
    let concentration =
        mean_length * (dimension - mean_length * mean_length) / (1.0 - mean_length * mean_length);
    let spread = second / share;
    let variance = (fourth / share - spread * spread).max(1e-12 * spread * spread);
    // Nominal distances have m = n/2; a few times that is as narrow as a fit should claim.
    let shape = (spread * spread / variance).clamp(0.5, 20.0 * dimension);
    let mean = resultant.iter().map(|x| x / length).collect();
    Some(Component::new(share, mean, concentration, shape, spread))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::streams::{Purpose, stream};

    /// κ = 0, m = n/2, Ω = n is the standard normal density.
    #[test]
    fn analytic_no_concentration_is_the_normal_density() {
        for n in [2_usize, 3, 10, 100] {
            let mut mean = vec![0.0; n];
            mean[0] = 1.0;
            let component = Component::new(1.0, mean, 0.0, 0.5 * n as f64, n as f64);
            let point: Vec<f64> = (0..n).map(|j| 0.1 * j as f64 - 1.3).collect();
            let exact = -0.5 * dot(&point, &point) - 0.5 * n as f64 * ln(2.0 * PI);
            let found = component.ln_density(&Polar::of(&point));
            // Both sides are sums of a few numbers of size n ln n: a hundred roundings of the largest.
            assert!((found - exact).abs() < 1e-12 * exact.abs().max(10.0), "{n}: {found} {exact}");
        }
    }

    /// I_½(κ) = √(2/(πκ)) sinh κ, so the series is sinh κ/κ.
    #[test]
    fn analytic_bessel_series_of_order_one_half() {
        for kappa in [1e-3, 1.0, 30.0, 600.0, 3000.0] {
            let exact = kappa + ln(1.0 - exp(-2.0 * kappa)) - ln(2.0 * kappa);
            let found = ln_bessel_series(0.5, kappa);
            assert!(
                (found - exact).abs() < 1e-11 * exact.abs().max(1.0),
                "{kappa}: {found} {exact}"
            );
        }
    }

    /// The mean of (normal density)/(mixture density) over the mixture's own draws is 1.
    #[test]
    fn property_draws_follow_the_density() {
        for n in [2, 8] {
            let mut one = vec![0.0; n];
            one[0] = 1.0;
            let mut other = vec![0.0; n];
            other[1] = 1.0;
            let mixture = Mixture {
                components: vec![
                    Component::new(0.7, one, 1.5, 0.4 * n as f64, 1.2 * n as f64),
                    Component::new(0.3, other, 0.5, 0.5 * n as f64, 1.1 * n as f64),
                ],
            };
            let mut stream = stream(5, Purpose::Test, n as u64);
            let draws = 20_000;
            let (mut sum, mut squares) = (0.0, 0.0);
            for _ in 0..draws {
                let point = mixture.draw(&mut stream);
                let normal = -0.5 * dot(&point, &point) - 0.5 * n as f64 * ln(2.0 * PI);
                let ratio = exp(normal - mixture.ln_density(&point));
                sum += ratio;
                squares += ratio * ratio;
            }
            let mean = sum / f64::from(draws);
            let error = ((squares / f64::from(draws) - mean * mean) / f64::from(draws)).sqrt();
            assert!((mean - 1.0).abs() < 4.5 * error, "{n}: {mean} ± {error}");
        }
    }
}
