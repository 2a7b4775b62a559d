//! The film's equations against exact solutions.

use super::super::space::Space;
use super::*;
use crate::numerics::elementary::{exp, ln};
use crate::numerics::gauss_lobatto::GaussLobatto;

const RADIAL: usize = 9;
const HALF: usize = 9;

/// A film of which everything can be chosen: faces from 3 to 8.5 in, no heat to the housing.
struct Case<const P: usize, const K: usize> {
    film: Film<f64>,
    space: Space<P, K>,
    paths: Paths<f64>,
    viscosity_temperature_k: f64,
}

impl<const P: usize, const K: usize> Case<P, K> {
    fn new(space: Space<P, K>, viscosity_temperature_k: f64, expansion_per_k: f64) -> Self {
        let mut design = Design::baseline();
        design.set(super::super::Target::whole(Parameter::FluidExpansion), expansion_per_k);
        let film = Film::new(&design);
        let mut paths = Paths::new(&Thermal::new(&design));
        (paths.fluid_housing_1, paths.rotor_housing_2) = (0.0, 0.0);
        Case { film, space, paths, viscosity_temperature_k }
    }

    fn heating(&self, field: &Field<f64, P, K>, speed: f64, drive: f64) -> Heating<f64, P, K> {
        let faces = Faces::new(&self.film, &self.space);
        let b = self.viscosity_temperature_k;
        let resistance = Resistance::new(&self.film, &self.space, b, field);
        let shear = Shear::new(&self.film, &faces, &resistance.thickening, speed, None);
        let (film, space) = (&self.film, &self.space);
        heating(film, &self.paths, space, &faces, &resistance, &shear, drive, (field, 300.0))
    }
}

/// Points across half a film, from the wall (−1) to the middle (0).
fn across<const N: usize, const K: usize>() -> [f64; K] {
    let rule = GaussLobatto::<N>::new();
    from_fn(|a| rule.points[a])
}

/// A uniformly heated film is a parabola whose mean excess over its walls is q d²/12k.
#[test]
fn analytic_uniformly_heated_film() {
    let case = Case::<5, 3>::new(Space::new::<5>(), 0.0, 0.0);
    let points = across::<5, 3>();
    // Excess (1 − x²) on the reference interval: conduction 2 × the rate, everywhere inside.
    let field: Field<f64, 5, 3> = [points.map(|x| 300.0 + 12.0 * (1.0 - x * x)); 5];
    let rates = case.heating(&field, 0.0, 0.0).field;
    for row in rates {
        for rate in &row[1..] {
            let want = -24.0 * case.film.conduction_per_s;
            assert!((rate / want - 1.0).abs() < 1e-12, "{rate} {want}");
        }
    }
    let mean: f64 = case.space.share.iter().zip(field[0]).map(|(s, t)| s * t).sum();
    // Mean of 1 − x² is 2/3; with q = 24 k per interval of half-width one, q d²/12 k = 24 · 4/12 k/k = 8.
    assert!((mean - 308.0).abs() < 1e-12, "{mean}");
}

/// Nahme and Griffith: plane Couette flow, viscosity exp(−β T), walls at one temperature. With a = Na/8 the excess is
/// β (T − T_w) = ln((1 + a)/cosh²(c x)), c = asinh √a, and the stress asinh(√a)/√(a (1 + a)) of the cold film's.
#[test]
fn analytic_nahme_griffith_film() {
    for (nahme, stress) in [(2.0, 0.860_817_88), (10.0, 0.573_878_59)] {
        let beta = 0.02;
        // The law without B is the exponential one.
        let case = Case::<RADIAL, HALF>::new(Space::new::<17>(), 0.0, beta);
        let a: f64 = nahme / 8.0;
        // asinh √a, cosh.
        let c = ln(a.sqrt() + (1.0 + a).sqrt());
        let cosh = |x: f64| 0.5 * (exp(x) + exp(-x));
        let exact = c / (a * (1.0 + a)).sqrt();
        assert!((exact - stress).abs() < 5e-9, "{exact}");
        let points = across::<17, HALF>();
        let row = points.map(|x| 350.0 + ln((1.0 + a) / (cosh(c * x) * cosh(c * x))) / beta);
        let field: Field<f64, RADIAL, HALF> = [row; RADIAL];
        let faces = Faces::new(&case.film, &case.space);
        let resistance = Resistance::new(&case.film, &case.space, 0.0, &field);
        // Stress over that of a film at the walls' temperature.
        let got = resistance.thickening[0] * resistance.fluidity[0][0];
        assert!((got / exact - 1.0).abs() < 1e-9, "{got} {exact}");
        // Na = β μ_w U²/k per film is the heating of a cold film, 4 conduction Na/β on the reference interval.
        for i in 0..RADIAL {
            let rim = faces.radius_m[i] * faces.radius_m[i] * faces.heating_per_m2;
            let cold = nahme / beta * case.film.conduction_per_s / 4.0;
            let drive = cold * resistance.fluidity[i][0] / rim;
            let rates = case.heating(&field, 1.0, drive).field;
            for rate in &rates[i][1..] {
                assert!(rate.abs() < 1e-7 * cold, "{nahme} {i}: {rate} of {cold}");
            }
        }
    }
}

/// Heat put in as Q r² with insulated edges leaves the steady shape −[r⁴/16 − m r²/4 + C ln r],
/// m = (ro² + ri²)/2, C = −ri⁴/4 + m ri²/2, on which conduction is m − r².
#[test]
fn analytic_radial_conduction() {
    let case = Case::<13, 3>::new(Space::new::<5>(), 0.0, 0.0);
    let faces = Faces::new(&case.film, &case.space);
    let (ri, ro) = (faces.radius_m[0], faces.radius_m[12]);
    let m = (ro * ro + ri * ri) / 2.0;
    let c = -(ri * ri * ri * ri) / 4.0 + m * ri * ri / 2.0;
    let shape = |r: f64| -((r * r * r * r) / 16.0 - m * r * r / 4.0 + c * ln(r));
    let walls = faces.radius_m.map(shape);
    let kappa = case.film.spreading_per_s * case.film.half_width_m * case.film.half_width_m;
    for i in 0..13 {
        let got = spreading(&case.film, &case.space, &faces, i, &walls) / kappa;
        let r = faces.radius_m[i];
        assert!((got - (m - r * r)).abs() < 2e-6 * m, "{r}: {got} {}", m - r * r);
    }
}

/// The slowest radial mode decays as J0(kr) Y1(k ri) − Y0(kr) J1(k ri) with J1(k ro) Y1(k ri) = J1(k ri) Y1(k ro).
/// SciPy (`jv`, `yv`, `brentq`) for ri/ro = 3/8.5: k ro = 5.037162919637.
#[test]
fn reference_bessel_mode_of_radial_conduction() {
    let case = Case::<9, 3>::new(Space::new::<5>(), 0.0, 0.0);
    let faces = Faces::new(&case.film, &case.space);
    let kappa = case.film.spreading_per_s * case.film.half_width_m * case.film.half_width_m;
    // Inverse iteration would need a solver; power iteration of exp(−t A) finds the slowest mode beside the constant.
    let mut mode: [f64; 9] = from_fn(|i| case.space.radial[i]);
    let mut decay = 0.0;
    let step = 2e-7 / kappa;
    for _ in 0..60_000 {
        let mean = faces.mean(&mode);
        mode.iter_mut().for_each(|value| *value -= mean);
        let size = faces.mean(&mode.map(|value| value * value)).sqrt();
        mode.iter_mut().for_each(|value| *value /= size);
        let rates: [f64; 9] = from_fn(|i| spreading(&case.film, &case.space, &faces, i, &mode));
        decay = -faces.mean(&from_fn(|i| rates[i] * mode[i])) / kappa;
        for (value, rate) in mode.iter_mut().zip(rates) {
            *value += step * rate;
        }
    }
    let k = decay.sqrt() * faces.radius_m[8];
    assert!((k - BESSEL_ROOT).abs() < 1e-8, "{k}");
}
const BESSEL_ROOT: f64 = 5.037_162_919_637;

/// What shear puts in is what all temperatures take up, but for the air: to rounding, at any field.
#[test]
fn property_energy_is_kept_to_rounding() {
    let design = Design::baseline();
    let thermal = Thermal::new(&design);
    let film = Film::new(&design);
    let space = Space::<7, 4>::new::<7>();
    let paths = Paths::new(&thermal);
    let faces = Faces::new(&film, &space);
    let fluid =
        super::super::fluid::Fluid::new(&design, &super::super::brake::Brake::new(&design), false);
    let field: Field<f64, 7, 4> =
        from_fn(|i| from_fn(|a| 330.0 + 7.0 * (i as f64) + 11.0 * ((i * 3 + a * 5) % 4) as f64));
    let resistance = Resistance::new(&film, &space, fluid.viscosity_temperature_k, &field);
    for cross in [None, Some(0.7)] {
        let mut film = film;
        film.cross_time_s_per_m = 2e-3;
        let speed = 3.3;
        let shear = Shear::new(&film, &faces, &resistance.thickening, speed, cross);
        let factor = fluid.torque_per_speed_nms;
        let drive = factor * speed * speed / thermal.fluid_capacity_j_per_k;
        let rates =
            heating(&film, &paths, &space, &faces, &resistance, &shear, drive, (&field, 310.0));
        let power = factor * shear.stiffness * speed * speed;
        let mut taken = thermal.housing_capacity_j_per_k * rates.housing;
        for i in 0..7 {
            let row = &rates.field[i];
            let across: f64 = (0..4).map(|a| space.share[a] * row[a]).sum();
            taken += faces.area[i]
                * (thermal.fluid_capacity_j_per_k * across
                    + thermal.rotor_capacity_j_per_k * row[0]);
        }
        assert!((taken / power - 1.0).abs() < 1e-12, "{taken} {power}");
    }
}
