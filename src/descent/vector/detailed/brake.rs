//! The brake over lanes at a moment: heat, torque, and what can be read off them.

use crate::descent::vector::clock::Clock;
use crate::descent::vector::constants::Constants;
use crate::numerics::lanes::{Lanes, Wide};
use crate::physics::film::{self, Faces, Field, Film, Paths, Resistance, Shear};
use crate::physics::space::Space;

/// What both detailed models are made of.
pub struct Detailed<V, const P: usize, const K: usize> {
    pub constants: Constants<V>,
    pub clock: Clock<V>,
    pub any_cross: bool,
    pub space: Space<P, K>,
}

/// The brake at a moment.
#[derive(Clone, Copy)]
pub struct Heat<V, const P: usize, const K: usize> {
    pub faces: Faces<Wide<V>, P>,
    pub resistance: Resistance<Wide<V>, P, K>,
    pub shear: Shear<Wide<V>, P>,
    pub heating: film::Heating<Wide<V>, P, K>,
    /// Reel speed, rad/s.
    pub speed: V,
}

/// A right-hand side's evaluation, motion and heat.
#[derive(Clone, Copy)]
pub struct Moment<V, const P: usize, const K: usize, const N: usize> {
    pub rates: [V; N],
    pub heat: Heat<V, P, K>,
    /// Relative velocity.
    pub v: V,
    pub p: V,
    /// Viscous pull `y = M/R`, N, and how it changes with `v`.
    pub pull: V,
    pub pull_by_v: V,
    /// Weight hanging, N.
    pub load: V,
    /// Force left to accelerate, N, `1/Q`, `η`, the drag's slope, free lift less drag; zero where nothing accelerates.
    pub force: V,
    pub inverse_q: V,
    pub eta: V,
    pub drag_slope: V,
    pub lift: V,
}

impl<V: Lanes, const P: usize, const K: usize> Detailed<V, P, K> {
    #[inline(always)]
    pub fn film(&self) -> Film<Wide<V>> {
        let k = &self.constants;
        Film {
            middle_radius_m: Wide(k.middle_radius),
            half_width_m: Wide(k.half_width),
            conduction_per_s: Wide(k.conduction),
            cross_time_s_per_m: Wide(k.cross_time),
            spreading_per_s: Wide(k.spreading),
            expansion_per_k: Wide(k.expansion),
        }
    }

    #[inline(always)]
    pub fn paths(&self) -> Paths<Wide<V>> {
        let k = &self.constants;
        Paths {
            fluid_housing_1: Wide(k.fluid_housing_1),
            rotor_housing_2: Wide(k.rotor_housing_2),
            fluid_housing_3: Wide(k.fluid_housing_3),
            rotor_housing_3: Wide(k.rotor_housing_3),
            air_3: Wide(k.air_3),
            air_k: Wide(k.air_k),
            capacity_ratio: Wide(k.capacity_ratio),
        }
    }

    #[inline(always)]
    pub fn cross(&self) -> Option<Wide<V>> {
        if self.any_cross { Some(Wide(self.constants.cross_exponent)) } else { None }
    }

    /// The brake at a field, at the speed that `speed` gives once the resistance is known.
    #[inline(always)]
    pub fn heat(
        &self,
        field: &Field<V, P, K>,
        housing: V,
        speed: impl FnOnce(&Self, &Faces<Wide<V>, P>, &[Wide<V>; P]) -> V,
    ) -> Heat<V, P, K> {
        let k = &self.constants;
        let film = self.film();
        let faces = Faces::new(&film, &self.space);
        let field = field.map(|row| row.map(Wide));
        let b = Wide(-k.minus_viscosity_temperature);
        let resistance = Resistance::new(&film, &self.space, b, &field);
        let speed = speed(self, &faces, &resistance.thickening);
        let shear = Shear::new(&film, &faces, &resistance.thickening, Wide(speed), self.cross());
        let drive = Wide((k.torque * k.inverse_fluid_capacity) * (speed * speed));
        let heating = film::heating(
            &film,
            &self.paths(),
            &self.space,
            &faces,
            &resistance,
            &shear,
            drive,
            (&field, Wide(housing)),
        );
        Heat { faces, resistance, shear, heating, speed }
    }

    /// Means over the fluid's volume and the metal's area.
    #[inline(always)]
    pub fn means(&self, field: &Field<V, P, K>) -> [V; 2] {
        let faces = Faces::new(&self.film(), &self.space);
        let zero = V::splat(0.0);
        let mut means = [zero; 2];
        for i in 0..P {
            let mut across = zero;
            for a in 0..K {
                across = field[i][a].mul_add(V::splat(self.space.share[a]), across);
            }
            means[0] = faces.area[i].0.mul_add(across, means[0]);
            means[1] = faces.area[i].0.mul_add(field[i][0], means[1]);
        }
        means
    }

    /// The hottest of the film's points, and its rate where the field's rates are known.
    #[inline(always)]
    pub fn hottest(field: &Field<V, P, K>, rates: Option<&Field<Wide<V>, P, K>>) -> (V, V) {
        let mut hottest = field[P - 1][K - 1];
        let mut rate = rates.map_or(V::splat(0.0), |rates| rates[P - 1][K - 1].0);
        for i in 0..P {
            for a in 0..K {
                let hotter = hottest.lt(field[i][a]);
                hottest = V::select(hotter, field[i][a], hottest);
                if let Some(rates) = rates {
                    rate = V::select(hotter, rates[i][a].0, rate);
                }
            }
        }
        (hottest, rate)
    }
}

#[inline(always)]
pub fn field_of<V: Lanes, const P: usize, const K: usize, const N: usize>(
    y: &[V; N],
    first: usize,
) -> Field<V, P, K> {
    let mut field = [[y[first]; K]; P];
    for i in 0..P {
        for a in 0..K {
            field[i][a] = y[first + i * K + a];
        }
    }
    field
}

/// Mean over the torque of `ε = dln(thinning)/dln X`: `dln S/dln ω`.
#[inline(always)]
pub fn lean<V: Lanes, const P: usize, const K: usize>(heat: &Heat<V, P, K>) -> V {
    let mut sum = V::splat(0.0);
    for i in 0..P {
        let part =
            (heat.faces.torque[i].0 * heat.resistance.thickening[i].0) * heat.shear.thinning[i].0;
        sum = part.mul_add(heat.shear.exponent[i].0, sum);
    }
    sum / heat.shear.stiffness.0
}

/// Rates of the field and the housing in the clock.
#[inline(always)]
pub fn fill<V: Lanes, const P: usize, const K: usize, const N: usize>(
    rates: &mut [V; N],
    first: usize,
    heat: &Heat<V, P, K>,
    g: V,
) {
    for i in 0..P {
        for a in 0..K {
            rates[first + i * K + a] = heat.heating.field[i][a].0 * g;
        }
    }
    rates[first + P * K] = heat.heating.housing.0 * g;
}

#[inline(always)]
pub fn put<V: Lanes, const P: usize, const K: usize, const N: usize>(
    u: &mut [V; N],
    first: usize,
    field: &Field<V, P, K>,
    housing: V,
) {
    for i in 0..P {
        for a in 0..K {
            u[first + i * K + a] = field[i][a];
        }
    }
    u[first + P * K] = housing;
}

impl<V: Lanes, const P: usize, const K: usize, const N: usize> Moment<V, P, K, N> {
    /// Change of the viscous pull in time apart from that of `v`: `−y (A3 − (s/2p)(2 + η) v)` with the field's rates.
    #[inline(always)]
    pub fn softening_rate(&self, k: &Constants<V>, space: &Space<P, K>) -> V {
        let heat = &self.heat;
        let mut sum = V::splat(0.0);
        for i in 0..P {
            let g = heat.resistance.thickening[i].0;
            let weight = (heat.faces.torque[i].0 * (g * g))
                * (heat.shear.thinning[i].0 * (V::splat(1.0) + heat.shear.exponent[i].0));
            let mut across = V::splat(0.0);
            for b in 0..K {
                let soft = (heat.resistance.fluidity[i][b].0 * heat.resistance.slope_per_k[i][b].0)
                    * V::splat(space.share[b]);
                across = soft.mul_add(heat.heating.field[i][b].0, across);
            }
            sum = weight.mul_add(across, sum);
        }
        let lean = lean(heat);
        let half_slope = V::splat(0.5) * (k.radius_slope / self.p);
        let widening = (half_slope * self.v) * (V::splat(2.0) + lean);
        self.pull * (widening - sum / heat.shear.stiffness.0)
    }

    /// Weighted error of a field's temperatures, as a relative change of the velocity.
    #[inline(always)]
    pub fn heat_error(&self, space: &Space<P, K>, e: &[V; N], first: usize, late: V) -> V {
        let heat = &self.heat;
        let mut metal = V::splat(0.0);
        let mut film = V::splat(0.0);
        for i in 0..P {
            let area = heat.faces.area[i].0 * heat.resistance.slope_per_k[i][0].0;
            metal = area.mul_add(e[first + i * K].abs(), metal);
            let mut across = V::splat(0.0);
            for a in 1..K {
                across = e[first + i * K + a].abs().mul_add(V::splat(space.share[a]), across);
            }
            film = area.mul_add(across, film);
        }
        let hottest = heat.resistance.slope_per_k[P - 1][K - 1].0 * e[first + P * K - 1].abs();
        let seen = V::splat(0.05) * hottest;
        (V::splat(0.15) + late).mul_add(film, V::splat(0.8).mul_add(metal, seen))
    }
}

macro_rules! points {
    ($P:literal, $K:literal, $across:literal) => {
        impl<V: Lanes> Fresh<V> for Detailed<V, $P, $K> {
            fn fresh(constants: Constants<V>, clock: Clock<V>) -> Self {
                let space = Space::<$P, $K>::new::<$across>();
                Detailed { constants, clock, any_cross: false, space }
            }
        }
    };
}
points!(6, 3, 5);
points!(7, 4, 7);

/// A model with its points laid out.
pub trait Fresh<V> {
    /// The model with the lanes' constants and clocks.
    fn fresh(constants: Constants<V>, clock: Clock<V>) -> Self;
}
