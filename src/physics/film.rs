//! The brake in detail: temperature over radius and across the film, in place of the three nodes.
//!
//! One representative film between two faces, annuli from `ri` to `ro` at a distance `d = 2n/Σ(1/d_k)`. (The excess
//! of a film's temperature over its walls does not depend on its gap, so films differ in heat flux and not in
//! temperature.) With `z` across the film and `r` along it,
//! ```text
//! film     c_f ∂T/∂t = k_f ∂²T/∂z² + τ²/μ(T) − h13 ,   T = T_m at both walls ,  c_f = C1/(2n A d)
//! stress   τ(r) does not vary across the film ,  ∫ τ/μ dz = ω r
//! metal    c_m ∂T_m/∂t = (heat from both walls) + k_m t_m (1/r) ∂/∂r (r ∂T_m/∂r) − h23 ,  c_m = C2/(2n A) ,  t_m = c_m/c_v
//! housing  C3 dT3/dt = K13 (T̄1 − T3) + K23 (T̄2 − T3) + Ka (Ta − T3)
//! torque   M = 2n ∫ τ r 2πr dr
//! ```
//! `h13` draws `K13 (T̄1 − T3)` evenly from the fluid's volume, `h23` draws `K23 (T̄2 − T3)` evenly from the metal; `T̄1` and
//! `T̄2` are means over the fluid's volume and the metal's area; the metal's edges are insulated. Heat is neither lost
//! nor made: the film takes up `M ω`.
//!
//! # In space
//! Galerkin's method on Gauss–Lobatto points with lumped masses, `P` along the radius (weight `r`) and an odd number across
//! the film, whose temperature is symmetric about its middle: `K` unknowns a radius, the wall first and the middle last.
//! The wall's share of the film's mass moves with the metal, and its row of the stiffness is the heat flux into the metal,
//! so that energy is kept to rounding.
//!
//! # Shear thinning
//! `μ = ρ ν(T)/(1 + X^m)` with the Cross group `X = λ (ν/ν0) γ̇`: time–temperature superposition, for `λ` scales with the
//! viscosity. Then `τ = τ* X/(1 + X^m)` with `τ* = ρ ν0/λ`, so `X` is one number across the film, `X = λ f f_lot A ω r/(d ē)`, with
//! `ē` the mean of the fluidity `e = exp(−B/T)` across the film: nothing has to be iterated for.
//! With a thermal expansion `α` the density, and `ρ ν` with it, falls as `exp(−α (T − 25 °C))`, in the group too.

#![allow(
    clippy::needless_range_loop,
    reason = "an index is a point in space, of several fields at once"
)]

use super::design::Design;
use super::fluid::{Fluid, MORE_STEPS};
use super::parameters::Parameter;
use super::space::{DENSITY_TEMPERATURE_K, PI, SMALLEST_BORE, Space};
use super::thermal::Thermal;
use crate::numerics::real::{CONVERGED, Real};
use std::array::from_fn;

/// The film and the metal of one design.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Film<R> {
    /// Middle of the faces, `(ro + ri)/2`, m.
    pub middle_radius_m: R,
    /// Half their width, `(ro − ri)/2`, m.
    pub half_width_m: R,
    /// `4 k_f 2n A/(d C1)`, 1/s: conduction across the film per temperature on the reference interval [−1, 1].
    pub conduction_per_s: R,
    /// `λ f f_lot A/d`, s/m: Cross group per rim speed in the limit of an infinitely hot fluid.
    pub cross_time_s_per_m: R,
    /// `(k_m/c_v)/((ro − ri)/2)²`, 1/s: conduction along the metal on the reference interval.
    pub spreading_per_s: R,
    /// Thermal expansion `α`, 1/K.
    pub expansion_per_k: R,
}

impl<R: Real> Film<R> {
    /// The film of a design.
    #[inline(always)]
    pub fn new(design: &Design<R>) -> Self {
        let get = |parameter| design.get(parameter);
        let (one, half) = (R::constant(1.0), R::constant(0.5));
        let outer = get(Parameter::BrakeOuterRadius);
        // The larger of the bore and its smallest: −min(−a, −b).
        let inner = -(-get(Parameter::BrakeInnerRadius)).min(-(R::constant(SMALLEST_BORE) * outer));
        let half_width = half * (outer - inner);
        let (mut inverse_gaps, mut count) = (R::constant(0.0), R::constant(0.0));
        for &gap in design.gaps() {
            inverse_gaps = inverse_gaps + one / gap;
            count = count + one;
        }
        let inverse_gap = inverse_gaps / count;
        let area = R::constant(PI) * (outer * outer - inner * inner);
        Film {
            middle_radius_m: half * (outer + inner),
            half_width_m: half_width,
            conduction_per_s: R::constant(4.0)
                * get(Parameter::FluidConductivity)
                * area
                * inverse_gaps
                / get(Parameter::ThermalFluidCapacity),
            cross_time_s_per_m: get(Parameter::FluidCrossTimeConstant)
                * Fluid::thickness(design)
                * inverse_gap,
            spreading_per_s: get(Parameter::MetalConductivity)
                / (get(Parameter::MetalHeatCapacity) * half_width * half_width),
            expansion_per_k: get(Parameter::FluidExpansion),
        }
    }
}

/// Temperatures over the radius and across the film, K: `[i][0]` is the metal at radius `i`, `[i][K − 1]` the film's middle.
pub type Field<R, const P: usize, const K: usize> = [[R; K]; P];

/// The faces in numbers of a type: what depends on the radii alone.
#[derive(Debug, Clone, Copy)]
pub struct Faces<R, const P: usize> {
    /// Radii, m.
    pub radius_m: [R; P],
    /// Shares of a face's area.
    pub area: [R; P],
    /// Shares of the torque of a film of one viscosity.
    pub torque: [R; P],
    /// `1/(2 C1 …)`: heating of a fluid of one temperature per `k (ω r)²`, 1/m²: `1/(rm² + rh²)`.
    pub heating_per_m2: R,
    /// `rh/rm`.
    pub flare: R,
}

impl<R: Real, const P: usize> Faces<R, P> {
    /// The faces of a film.
    #[inline(always)]
    pub fn new<const K: usize>(film: &Film<R>, space: &Space<P, K>) -> Self {
        let middle = film.middle_radius_m;
        let half = film.half_width_m;
        let heating = R::constant(1.0) / middle.mul_add(middle, half * half);
        let per_middle = R::constant(0.5) / middle;
        let radius: [R; P] = from_fn(|i| half.mul_add(R::constant(space.radial[i]), middle));
        let area: [R; P] =
            from_fn(|i| (R::constant(space.radial_weights[i]) * radius[i]) * per_middle);
        Faces {
            radius_m: radius,
            area,
            torque: from_fn(|i| area[i] * (radius[i] * radius[i]) * heating),
            heating_per_m2: heating,
            flare: half / middle,
        }
    }

    /// Shares of area summed over a row of values.
    #[inline(always)]
    pub fn mean(&self, values: &[R; P]) -> R {
        let mut sum = self.area[0] * values[0];
        for i in 1..P {
            sum = self.area[i].mul_add(values[i], sum);
        }
        sum
    }
}

/// The fluid's resistance at a field of temperatures.
#[derive(Debug, Clone, Copy)]
pub struct Resistance<R, const P: usize, const K: usize> {
    /// Fluidity `e = exp(−B/T + α (T − 25 °C))`.
    pub fluidity: Field<R, P, K>,
    /// Its relative slope `B/T² + α`, 1/K.
    pub slope_per_k: Field<R, P, K>,
    /// `1/ē`, the reciprocal of the mean across the film.
    pub thickening: [R; P],
}

impl<R: Real, const P: usize, const K: usize> Resistance<R, P, K> {
    /// The resistance of a fluid with viscosity temperature `B`.
    #[inline(always)]
    pub fn new(
        film: &Film<R>,
        space: &Space<P, K>,
        viscosity_temperature_k: R,
        field: &Field<R, P, K>,
    ) -> Self {
        let zero = R::constant(0.0);
        let one = R::constant(1.0);
        let mut fluidity = [[zero; K]; P];
        let mut slope = [[zero; K]; P];
        let mut mean = [zero; P];
        for i in 0..P {
            let inverse = reciprocals(&field[i]);
            for a in 0..K {
                let over = viscosity_temperature_k * inverse[a];
                let warm = field[i][a] - R::constant(DENSITY_TEMPERATURE_K);
                fluidity[i][a] = film.expansion_per_k.mul_add(warm, -over).exp();
                slope[i][a] = over.mul_add(inverse[a], film.expansion_per_k);
                mean[i] = fluidity[i][a].mul_add(R::constant(space.share[a]), mean[i]);
            }
        }
        Resistance { fluidity, slope_per_k: slope, thickening: mean.map(|mean| one / mean) }
    }
}

/// One division for several reciprocals.
#[inline(always)]
fn reciprocals<R: Real, const K: usize>(values: &[R; K]) -> [R; K] {
    let mut before = *values;
    for a in 1..K {
        before[a] = before[a - 1] * values[a];
    }
    let mut inverse = R::constant(1.0) / before[K - 1];
    let mut results = *values;
    for a in (1..K).rev() {
        results[a] = before[a - 1] * inverse;
        inverse = inverse * values[a];
    }
    results[0] = inverse;
    results
}

/// Shear at a reel speed: how far the fluid thins, and what the brake's torque is.
#[derive(Debug, Clone, Copy)]
pub struct Shear<R, const P: usize> {
    /// `1/(1 + X^m)`, 1 without shear thinning.
    pub thinning: [R; P],
    /// `dln(thinning)/dln X = −m X^m/(1 + X^m)`, 0 without.
    pub exponent: [R; P],
    /// Torque over `k ω`, with `k` the torque per reel speed of an infinitely hot fluid.
    pub stiffness: R,
}

impl<R: Real, const P: usize> Shear<R, P> {
    /// The shear at a reel speed, given the reciprocals of the mean fluidities.
    #[inline(always)]
    pub fn new(
        film: &Film<R>,
        faces: &Faces<R, P>,
        thickening: &[R; P],
        speed: R,
        cross: Option<R>,
    ) -> Self {
        let (zero, one) = (R::constant(0.0), R::constant(1.0));
        let mut shear = Shear { thinning: [one; P], exponent: [zero; P], stiffness: zero };
        if let Some(power) = cross {
            let rate = film.cross_time_s_per_m * speed.abs();
            for i in 0..P {
                let grown = ((rate * faces.radius_m[i]) * thickening[i]).power(power);
                shear.thinning[i] = one / (one + grown);
                shear.exponent[i] = -(power * (grown * shear.thinning[i]));
            }
        }
        for i in 0..P {
            let part = faces.torque[i] * thickening[i];
            shear.stiffness = part.mul_add(shear.thinning[i], shear.stiffness);
        }
        shear
    }
}

/// Rates of a field of temperatures, of the housing's, and the heat put in, K/s.
#[derive(Debug, Clone, Copy)]
pub struct Heating<R, const P: usize, const K: usize> {
    /// Rates of the field, K/s.
    pub field: Field<R, P, K>,
    /// Rate of the housing's temperature, K/s.
    pub housing: R,
    /// Heating by shear alone, K/s of the fluid.
    pub source: Field<R, P, K>,
    /// Mean temperature of the fluid `T̄1`, K.
    pub fluid_k: R,
    /// Mean temperature of the metal `T̄2`, K.
    pub metal_k: R,
}

/// Heat paths as rates: conductances over capacities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Paths<R> {
    /// `K13/C1`, 1/s.
    pub fluid_housing_1: R,
    /// `K23/C2`, 1/s.
    pub rotor_housing_2: R,
    /// `K13/C3`, 1/s.
    pub fluid_housing_3: R,
    /// `K23/C3`, 1/s.
    pub rotor_housing_3: R,
    /// `Ka/C3`, 1/s.
    pub air_3: R,
    /// Air temperature `Ta`, K.
    pub air_k: R,
    /// `C1/C2`.
    pub capacity_ratio: R,
}

impl<R: Real> Paths<R> {
    /// The paths of a thermal model.
    pub fn new(thermal: &Thermal<R>) -> Self {
        let Thermal {
            fluid_capacity_j_per_k: c1,
            rotor_capacity_j_per_k: c2,
            housing_capacity_j_per_k: c3,
            ..
        } = *thermal;
        Paths {
            fluid_housing_1: thermal.fluid_housing_w_per_k / c1,
            rotor_housing_2: thermal.rotor_housing_w_per_k / c2,
            fluid_housing_3: thermal.fluid_housing_w_per_k / c3,
            rotor_housing_3: thermal.rotor_housing_w_per_k / c3,
            air_3: thermal.air_w_per_k / c3,
            air_k: thermal.air_k,
            capacity_ratio: c1 / c2,
        }
    }

    /// Shares of film and metal in what moves with the wall, `C1 s0/(C2 + C1 s0)` and `C2/(C2 + C1 s0)`, where `s0` is the walls'
    /// share of the film's volume.
    #[inline(always)]
    pub fn wall_shares(&self, share: R) -> (R, R) {
        let film = share * self.capacity_ratio;
        let metal = R::constant(1.0) / (R::constant(1.0) + film);
        (film * metal, metal)
    }
}

/// Rates of all temperatures, with `drive = k ω²/C1`, K/s, and the fluid's resistance and shear known.
#[inline(always)]
#[expect(
    clippy::too_many_arguments,
    reason = "the equations' own terms, each worked out once by the caller"
)]
pub fn heating<R: Real, const P: usize, const K: usize>(
    film: &Film<R>,
    paths: &Paths<R>,
    space: &Space<P, K>,
    faces: &Faces<R, P>,
    resistance: &Resistance<R, P, K>,
    shear: &Shear<R, P>,
    drive: R,
    (field, housing_k): (&Field<R, P, K>, R),
) -> Heating<R, P, K> {
    let zero = R::constant(0.0);
    let (wall_film, wall_metal) = paths.wall_shares(R::constant(space.share[0]));
    let mut means = [zero; P];
    for i in 0..P {
        means[i] = R::constant(space.share[0]) * field[i][0];
        for a in 1..K {
            means[i] = R::constant(space.share[a]).mul_add(field[i][a], means[i]);
        }
    }
    let fluid_k = faces.mean(&means);
    let walls: [R; P] = from_fn(|i| field[i][0]);
    let metal_k = faces.mean(&walls);
    let to_housing = fluid_k - housing_k;
    let metal_to_housing = metal_k - housing_k;
    let lost = paths.fluid_housing_1 * to_housing;
    let metal_lost = paths.rotor_housing_2 * metal_to_housing;
    let mut rates = [[zero; K]; P];
    let mut source = [[zero; K]; P];
    let per_area = drive * faces.heating_per_m2;
    for i in 0..P {
        let rim = (faces.radius_m[i] * faces.radius_m[i]) * per_area;
        let strength =
            rim * ((resistance.thickening[i] * resistance.thickening[i]) * shear.thinning[i]);
        for a in 0..K {
            source[i][a] = strength * resistance.fluidity[i][a];
            let mut conducted = R::constant(space.across[a][0]) * field[i][0];
            for b in 1..K {
                conducted = R::constant(space.across[a][b]).mul_add(field[i][b], conducted);
            }
            rates[i][a] = (source[i][a] - lost) - film.conduction_per_s * conducted;
        }
        let spread = spreading(film, space, faces, i, &walls);
        rates[i][0] = wall_film.mul_add(rates[i][0], wall_metal * (spread - metal_lost));
    }
    let from_air = paths.air_k - housing_k;
    let housing = paths.fluid_housing_3.mul_add(
        to_housing,
        paths.rotor_housing_3.mul_add(metal_to_housing, paths.air_3 * from_air),
    );
    Heating { field: rates, housing, source, fluid_k, metal_k }
}

/// Conduction along the metal at radius `i`, K/s.
#[inline(always)]
fn spreading<R: Real, const P: usize, const K: usize>(
    film: &Film<R>,
    space: &Space<P, K>,
    faces: &Faces<R, P>,
    i: usize,
    walls: &[R; P],
) -> R {
    let (mut strip, mut flare) = (R::constant(0.0), R::constant(0.0));
    for k in 0..P {
        strip = R::constant(space.strip[i][k]).mul_add(walls[k], strip);
        flare = R::constant(space.flare[i][k]).mul_add(walls[k], flare);
    }
    -(faces.spreading_factor(film, i) * faces.flare.mul_add(flare, strip))
}

impl<R: Real, const P: usize> Faces<R, P> {
    /// `κ/(w_i (1 + ρ x_i))`: what multiplies the radial stiffness at radius `i`, 1/s.
    #[inline(always)]
    pub fn spreading_factor(&self, film: &Film<R>, i: usize) -> R {
        // w r/(2 rm) is the share of area, so w (1 + ρ x) is twice that.
        film.spreading_per_s / (self.area[i] + self.area[i])
    }
}

/// What a reel speed is sought for, over the torque per reel speed `k` of an infinitely hot fluid.
#[derive(Debug, Clone, Copy)]
pub enum Demand<R> {
    /// A torque: `ω S(ω)`, rad/s.
    Torque(R),
    /// A power: `ω² S(ω)`, rad²/s².
    Power(R),
}

/// Reel speed at which `ω^q S(ω)` is what is demanded, rad/s: `q` = 1 for a torque, 2 for a power.
///
/// Newton's method on `q ln ω + ln S(ω) = ln(target)`, which is increasing and concave in `ln ω`, from the larger of its
/// two asymptotes, both of which lie left of the root.
#[inline(always)]
pub fn speed_of<R: Real, const P: usize>(
    film: &Film<R>,
    faces: &Faces<R, P>,
    thickening: &[R; P],
    demand: Demand<R>,
    cross: Option<R>,
) -> R {
    let (zero, one) = (R::constant(0.0), R::constant(1.0));
    let (target, order) = match demand {
        Demand::Torque(torque) => (torque, one),
        Demand::Power(power) => (power, R::constant(2.0)),
    };
    let mut newtonian = zero;
    for i in 0..P {
        newtonian = faces.torque[i].mul_add(thickening[i], newtonian);
    }
    let thin = match demand {
        Demand::Torque(torque) => torque / newtonian,
        Demand::Power(power) => (power / newtonian).sqrt(),
    };
    let Some(power) = cross else {
        return thin;
    };
    // ln X = ln ω + ln(group per speed) at every radius. A fluid that hardly thins has no thick asymptote: it is put far to
    // the left.
    let least = R::constant(-1e-300);
    let mut groups = [zero; P];
    let mut parts = [zero; P];
    let mut thick = zero;
    for i in 0..P {
        let group = (film.cross_time_s_per_m * faces.radius_m[i]) * thickening[i];
        groups[i] = (-(-group).min(least)).ln();
        parts[i] = faces.torque[i] * thickening[i];
        thick = parts[i].mul_add((-(power * groups[i])).exp(), thick);
    }
    let aim = target.ln();
    let thick = (aim - thick.ln()) / (order - power);
    // The larger of the two: −min(−a, −b).
    let mut speed = -(-thin.ln()).min(-thick);
    let step = |speed: R| {
        let (mut stiffness, mut lean) = (zero, zero);
        for i in 0..P {
            let grown = (power * (speed + groups[i])).exp();
            let thinning = one / (one + grown);
            let part = parts[i] * thinning;
            stiffness = stiffness + part;
            lean = (part * thinning).mul_add(grown, lean);
        }
        let slope = order - power * (lean / stiffness);
        let miss = aim - order.mul_add(speed, stiffness.ln());
        miss / slope
    };
    let mut last = one;
    for _ in 0..SPEED_STEPS {
        last = step(speed);
        speed = speed + last;
    }
    for _ in 0..MORE_STEPS {
        if last.beyond(CONVERGED).is_zero() {
            break;
        }
        last = step(speed).beyond(CONVERGED);
        speed = speed + last;
    }
    speed.exp()
}

/// Newton steps of [`speed_of`] that are always taken; the convergence is monotone, and in the end quadratic.
const SPEED_STEPS: usize = 6;

#[cfg(test)]
#[path = "film_test.rs"]
mod tests;
