//! The distribution families: parameters, tails, quantiles and densities.

mod construction;

pub(super) use construction::EULER_GAMMA;

use super::empirical::Empirical;
use crate::numerics::elementary::{exp, exp_m1, ln, ln_1p, pow};
use crate::numerics::special::gamma::ln_gamma;
use crate::numerics::special::{beta, gamma, normal, student};

/// A distribution family with its parameters, in SI units.
///
/// Made by the checked constructors, [`Law::normal`] and its sisters.
#[derive(Debug, Clone, PartialEq)]
pub enum Law {
    /// Normal law.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation, > 0.
        sd: f64,
    },
    /// Law of a positive quantity whose logarithm is normal.
    Lognormal {
        /// Mean of the logarithm.
        log_mean: f64,
        /// Standard deviation of the logarithm, > 0.
        log_sd: f64,
    },
    /// Uniform law.
    Uniform {
        /// Least value.
        lower: f64,
        /// Greatest value, > `lower`.
        upper: f64,
    },
    /// Triangular law.
    Triangular {
        /// Least value.
        lower: f64,
        /// Most probable value, of [lower, upper].
        mode: f64,
        /// Greatest value, > `lower`.
        upper: f64,
    },
    /// Beta law on an interval.
    Beta {
        /// First shape, > 0.
        alpha: f64,
        /// Second shape, > 0.
        beta: f64,
        /// Least value.
        lower: f64,
        /// Greatest value, > `lower`.
        upper: f64,
    },
    /// Weibull law: ((x − location)/scale)^shape is exponential with mean one.
    Weibull {
        /// Shape, > 0.
        shape: f64,
        /// Scale, > 0.
        scale: f64,
        /// Least value.
        location: f64,
    },
    /// Gumbel law, the extreme-value law of the first type.
    Gumbel {
        /// Mode.
        location: f64,
        /// Scale, > 0.
        scale: f64,
        /// False: the law of a maximum, with the long tail above. True: of a minimum, mirrored.
        minimum: bool,
    },
    /// Gamma law.
    Gamma {
        /// Shape, > 0.
        shape: f64,
        /// Scale, > 0.
        scale: f64,
        /// Least value.
        location: f64,
    },
    /// Exponential law.
    Exponential {
        /// Mean excess over the location, > 0.
        mean: f64,
        /// Least value.
        location: f64,
    },
    /// Student's t, of a quantity or of its logarithm: what readings predict, see [`super::Readings`].
    Student {
        /// Centre, of the logarithm if `logarithmic`.
        location: f64,
        /// Scale, > 0.
        scale: f64,
        /// Degrees of freedom, > 0.
        degrees: f64,
        /// Whether it is the logarithm that follows the law.
        logarithmic: bool,
    },
    /// The law of a set of observations, or of values with probabilities.
    Empirical(Empirical),
}

impl Law {
    /// The family's name, as a card writes it.
    pub fn family(&self) -> &'static str {
        match self {
            Law::Normal { .. } => "normal",
            Law::Lognormal { .. } => "lognormal",
            Law::Uniform { .. } => "uniform",
            Law::Triangular { .. } => "triangular",
            Law::Beta { .. } => "beta",
            Law::Weibull { .. } => "weibull",
            Law::Gumbel { .. } => "gumbel",
            Law::Gamma { .. } => "gamma",
            Law::Exponential { .. } => "exponential",
            Law::Student { logarithmic: false, .. } => "Student's t",
            Law::Student { logarithmic: true, .. } => "Student's t of the logarithm",
            Law::Empirical(empirical) if empirical.is_discrete() => "discrete",
            Law::Empirical(_) => "empirical",
        }
    }

    /// The smallest interval that holds the whole law, ends possibly infinite.
    pub fn support(&self) -> (f64, f64) {
        match *self {
            Law::Normal { .. } | Law::Gumbel { .. } | Law::Student { logarithmic: false, .. } => {
                (f64::NEG_INFINITY, f64::INFINITY)
            }
            Law::Lognormal { .. } | Law::Student { logarithmic: true, .. } => (0.0, f64::INFINITY),
            Law::Uniform { lower, upper }
            | Law::Triangular { lower, upper, .. }
            | Law::Beta { lower, upper, .. } => (lower, upper),
            Law::Weibull { location, .. }
            | Law::Gamma { location, .. }
            | Law::Exponential { location, .. } => (location, f64::INFINITY),
            Law::Empirical(ref empirical) => empirical.support(),
        }
    }

    /// The value whose lower tail is `p` of [0, 1].
    pub fn quantile_lower(&self, p: f64) -> f64 {
        if p > 0.5 { self.quantile_of_tail(1.0 - p, false) } else { self.quantile_of_tail(p, true) }
    }

    /// The value whose upper tail is `q` of [0, 1].
    pub fn quantile_upper(&self, q: f64) -> f64 {
        if q > 0.5 { self.quantile_of_tail(1.0 - q, true) } else { self.quantile_of_tail(q, false) }
    }

    /// The value whose `lower` or upper tail is `tail` ≤ ½.
    pub(super) fn quantile_of_tail(&self, tail: f64, lower: bool) -> f64 {
        // −ln of the survival probability, from either tail.
        let cumulative_hazard = || if lower { -ln_1p(-tail) } else { -ln(tail) };
        match *self {
            Law::Normal { mean, sd } => mean + sd * signed_normal(tail, lower),
            Law::Lognormal { log_mean, log_sd } => {
                super::transform::exponential_of(log_mean + log_sd * signed_normal(tail, lower))
            }
            Law::Uniform { lower: from, upper: to } => {
                super::transform::uniform_of(from, to, tail, lower)
            }
            Law::Triangular { lower: from, mode, upper: to } => {
                let width = to - from;
                let below_mode = (mode - from) / width;
                let above_mode = (to - mode) / width;
                if lower == (tail <= if lower { below_mode } else { above_mode }) {
                    let p = if lower { tail } else { 1.0 - tail };
                    from + (p * width * (mode - from)).sqrt()
                } else {
                    let q = if lower { 1.0 - tail } else { tail };
                    to - (q * width * (to - mode)).sqrt()
                }
            }
            Law::Beta { alpha, beta, lower: from, upper: to } => {
                let (x, y) = beta::quantile_pair(alpha, beta, tail, lower);
                if x <= 0.5 { from + (to - from) * x } else { to - (to - from) * y }
            }
            Law::Weibull { shape, scale, location } => {
                location + scale * pow(cumulative_hazard(), 1.0 / shape)
            }
            Law::Gumbel { location, scale, minimum } => {
                // The maximum type's x = location − scale ln(−ln F); the minimum type mirrors the tails.
                let minus_ln = if lower != minimum { -ln(tail) } else { -ln_1p(-tail) };
                let reduced = -ln(minus_ln);
                if minimum { location - scale * reduced } else { location + scale * reduced }
            }
            Law::Gamma { shape, scale, location } => {
                let x = if lower {
                    gamma::quantile_lower(shape, tail)
                } else {
                    gamma::quantile_upper(shape, tail)
                };
                location + scale * x
            }
            Law::Exponential { mean, location } => location + mean * cumulative_hazard(),
            Law::Student { location, scale, degrees, logarithmic } => {
                let t = student::quantile_upper(degrees, tail);
                let x = location + scale * if lower { -t } else { t };
                if logarithmic { super::transform::exponential_of(x) } else { x }
            }
            Law::Empirical(ref empirical) => empirical.quantile_of_tail(tail, lower),
        }
    }

    /// Distribution function: the lower tail at `x`.
    pub fn cdf(&self, x: f64) -> f64 {
        self.tails(x).0
    }

    /// Survival function: the upper tail at `x`, accurate where the distribution function rounds to one.
    pub fn survival(&self, x: f64) -> f64 {
        self.tails(x).1
    }

    /// Lower and upper tail at `x`, each to its own precision.
    pub(super) fn tails(&self, x: f64) -> (f64, f64) {
        if x.is_nan() {
            return (x, x);
        }
        if let Law::Empirical(empirical) = self {
            return empirical.tails(x);
        }
        let (least, greatest) = self.support();
        if x <= least {
            return (0.0, 1.0);
        }
        if x >= greatest {
            return (1.0, 0.0);
        }
        let of_hazard = |hazard: f64| (-exp_m1(-hazard), exp(-hazard));
        match *self {
            Law::Normal { mean, sd } => {
                let z = (x - mean) / sd;
                (normal::cdf(z), normal::survival(z))
            }
            Law::Lognormal { log_mean, log_sd } => {
                let z = (ln(x) - log_mean) / log_sd;
                (normal::cdf(z), normal::survival(z))
            }
            Law::Uniform { lower, upper } => {
                ((x - lower) / (upper - lower), (upper - x) / (upper - lower))
            }
            Law::Triangular { lower, mode, upper } => {
                let width = upper - lower;
                if x <= mode {
                    let p = (x - lower) / width * ((x - lower) / (mode - lower));
                    (p, 1.0 - p)
                } else {
                    let q = (upper - x) / width * ((upper - x) / (upper - mode));
                    (1.0 - q, q)
                }
            }
            Law::Beta { alpha, beta, lower, upper } => {
                let width = upper - lower;
                let (u, v) = ((x - lower) / width, (upper - x) / width);
                beta::tails_at(alpha, beta, u.min(v).min(0.5), u > v)
            }
            Law::Weibull { shape, scale, location } => {
                of_hazard(pow((x - location) / scale, shape))
            }
            Law::Gumbel { location, scale, minimum } => {
                let reduced = (x - location) / scale;
                let (survival, cdf) = of_hazard(exp(if minimum { reduced } else { -reduced }));
                if minimum { (survival, cdf) } else { (cdf, survival) }
            }
            Law::Gamma { shape, scale, location } => gamma::tails(shape, (x - location) / scale),
            Law::Exponential { mean, location } => of_hazard((x - location) / mean),
            Law::Student { location, scale, degrees, logarithmic } => {
                let t = ((if logarithmic { ln(x) } else { x }) - location) / scale;
                (student::cdf(degrees, t), student::survival(degrees, t))
            }
            Law::Empirical(ref empirical) => empirical.tails(x),
        }
    }

    /// ln of the density at `x`; −∞ outside the support.
    pub fn ln_density(&self, x: f64) -> f64 {
        let (least, greatest) = self.support();
        if x < least || x > greatest {
            return f64::NEG_INFINITY;
        }
        match *self {
            Law::Normal { mean, sd } => normal::ln_density((x - mean) / sd) - ln(sd),
            Law::Lognormal { log_mean, log_sd } => {
                if x == 0.0 {
                    return f64::NEG_INFINITY;
                }
                normal::ln_density((ln(x) - log_mean) / log_sd) - ln(log_sd) - ln(x)
            }
            Law::Uniform { lower, upper } => -ln(upper - lower),
            Law::Triangular { lower, mode, upper } => {
                let fall = if x < mode {
                    (x - lower) / (mode - lower)
                } else if x > mode {
                    (upper - x) / (upper - mode)
                } else {
                    1.0
                };
                ln(2.0 * fall / (upper - lower))
            }
            Law::Beta { alpha, beta, lower, upper } => {
                let width = upper - lower;
                let (u, v) = ((x - lower) / width, (upper - x) / width);
                let standard = if u <= v {
                    beta::ln_density(alpha, beta, u)
                } else {
                    beta::ln_density(beta, alpha, v)
                };
                standard - ln(width)
            }
            Law::Weibull { shape, scale, location } => {
                let reduced = (x - location) / scale;
                // At the edge, a shape of one has the factor 0^0 = 1.
                let growth = if shape == 1.0 { 0.0 } else { (shape - 1.0) * ln(reduced) };
                ln(shape / scale) + growth - pow(reduced, shape)
            }
            Law::Gumbel { location, scale, minimum } => {
                let reduced = (x - location) / scale;
                let reduced = if minimum { -reduced } else { reduced };
                -ln(scale) - reduced - exp(-reduced)
            }
            Law::Gamma { shape, scale, location } => {
                gamma::ln_density(shape, (x - location) / scale) - ln(scale)
            }
            Law::Exponential { mean, location } => -(x - location) / mean - ln(mean),
            Law::Student { logarithmic: true, .. } if x == 0.0 => f64::NEG_INFINITY,
            Law::Student { location, scale, degrees, logarithmic } => {
                let t = ((if logarithmic { ln(x) } else { x }) - location) / scale;
                let constant = ln_gamma(0.5 * (degrees + 1.0))
                    - ln_gamma(0.5 * degrees)
                    - 0.5 * ln(degrees * std::f64::consts::PI)
                    - ln(scale);
                let ln_x = if logarithmic { ln(x) } else { 0.0 };
                constant - 0.5 * (degrees + 1.0) * ln_1p(t * t / degrees) - ln_x
            }
            Law::Empirical(ref empirical) => empirical.ln_density(x),
        }
    }
}

/// The standard normal value whose `lower` or upper tail is `tail`.
fn signed_normal(tail: f64, lower: bool) -> f64 {
    let z = normal::magnitude(tail);
    if lower { -z } else { z }
}
