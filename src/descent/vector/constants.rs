//! A lane's constants: a descent's coefficients in the combinations that the kernels use.

use crate::numerics::lanes::{Lanes, Mask};
use crate::numerics::real::Real;
use crate::physics::{Coefficients, GRAVITY};

macro_rules! constants {
    ($($(#[$doc:meta])* $name:ident,)*) => {
        /// The constants of as many descents as there are lanes.
        #[derive(Clone, Copy)]
        #[repr(C)]
        pub struct Constants<V> {
            $($(#[$doc])* pub $name: V,)*
        }

        impl<V: Copy> Constants<V> {
            /// The same constants in another number type.
            #[inline(always)]
            pub fn map<T>(&self, convert: impl Fn(V) -> T) -> Constants<T> {
                Constants { $($name: convert(self.$name),)* }
            }
        }

        impl<V: Lanes> Constants<V> {
            /// Sets one lane's constants to those in a lane of others.
            #[inline(always)]
            pub fn copy_lane(&mut self, lane: usize, others: &Constants<V>, from: usize) {
                $(self.$name.lanes_mut()[lane] = others.$name.lanes()[from];)*
            }
        }
    };
}

constants! {
    /// Line length `L`, m.
    length,
    /// `1/L`, 1/m.
    inverse_length,
    /// `Ro²`, m².
    full_radius_squared,
    /// `s = (Ro² − Ri²)/L`, m.
    radius_slope,
    /// Reels' inertia `J`, kg·m².
    inertia,
    /// `½ J s`: factor of the spool's own pull in `(v/R²)²`.
    spool_pull,
    /// `k`: torque per reel speed in an infinitely hot fluid, N·m·s.
    torque,
    /// `1/k`.
    inverse_torque,
    /// `−B`, K.
    minus_viscosity_temperature,
    /// `ε`.
    averaging_offset,
    /// Cross group per `z R`, `χ = c/k`, 1/(N·m).
    cross_group,
    /// Cross exponent `m`.
    cross_exponent,
    /// 1 with shear thinning, 0 without.
    cross_on,
    /// Payload weight `W2`, N.
    weight,
    /// `x = Wx/L`, N/m.
    extraction,
    /// Both bodies' mass `M`, kg.
    total_mass,
    /// `1/M`.
    inverse_mass,
    /// Payload's share of the mass at the start, `η0`.
    payload_share,
    /// `−dη/dl = x/(g M)`, 1/m.
    share_slope,
    /// Free lift `B − W1 − W2`, N.
    free_lift,
    /// `½ ρ_air CdA`, kg/m.
    drag,
    /// `1/C1`, K/J.
    inverse_fluid_capacity,
    /// `K12/C1`, 1/s.
    fluid_rotor_1,
    /// `K13/C1`, 1/s.
    fluid_housing_1,
    /// `K12/C2`, 1/s.
    fluid_rotor_2,
    /// `K23/C2`, 1/s.
    rotor_housing_2,
    /// `K13/C3`, 1/s.
    fluid_housing_3,
    /// `K23/C3`, 1/s.
    rotor_housing_3,
    /// `Ka/C3`, 1/s.
    air_3,
    /// Air temperature, K.
    air_k,
    /// Temperature at release, K.
    initial_temperature,
    /// Rise speed before release, m/s.
    rise_speed,
    /// `C1/C2`.
    capacity_ratio,
    /// The film's constants, as in [`crate::physics::film::Film`].
    middle_radius,
    /// Half the faces' width, m.
    half_width,
    /// Conduction across the film, 1/s.
    conduction,
    /// Cross group per rim speed, s/m.
    cross_time,
    /// Conduction along the metal, 1/s.
    spreading,
    /// Thermal expansion, 1/K.
    expansion,
}

impl<V: Lanes> Constants<V> {
    /// Takes the shear thinning from one lane.
    pub fn set_newtonian(&mut self, lane: usize) {
        self.cross_group.lanes_mut()[lane] = NEWTONIAN.0;
        self.cross_exponent.lanes_mut()[lane] = NEWTONIAN.1;
        self.cross_on.lanes_mut()[lane] = 0.0;
        self.cross_time.lanes_mut()[lane] = 0.0;
    }
}

/// Cross group per `z R` and exponent of a fluid that does not thin.
const NEWTONIAN: (f64, f64) = (0.0, 0.5);

impl<R: Real> Constants<R> {
    /// The constants of a descent.
    #[inline(always)]
    pub fn new(c: &Coefficients<R>) -> Self {
        let value = R::constant;
        let one = value(1.0);
        let gravity = value(GRAVITY);
        let payload_mass = c.payload.weight_n / gravity;
        let total_mass = c.balloon.moving_mass_kg + payload_mass;
        let inverse_mass = one / total_mass;
        let heat = &c.thermal;
        let per_c1 = one / heat.fluid_capacity_j_per_k;
        let per_c2 = one / heat.rotor_capacity_j_per_k;
        let per_c3 = one / heat.housing_capacity_j_per_k;
        let torque = c.fluid.torque_per_speed_nms;
        let inverse_torque = one / torque;
        let thins = c.fluid.shear_thinning;
        Constants {
            length: c.reel.line_length_m,
            inverse_length: one / c.reel.line_length_m,
            full_radius_squared: c.reel.full_radius_squared_m2,
            radius_slope: c.reel.squared_radius_slope_m,
            inertia: c.reel.inertia_kg_m2,
            spool_pull: value(0.5) * c.reel.inertia_kg_m2 * c.reel.squared_radius_slope_m,
            torque,
            inverse_torque,
            minus_viscosity_temperature: -c.fluid.viscosity_temperature_k,
            averaging_offset: c.fluid.averaging_offset,
            cross_group: if thins {
                c.fluid.cross_time_s * inverse_torque
            } else {
                value(NEWTONIAN.0)
            },
            cross_exponent: if thins { c.fluid.cross_exponent } else { value(NEWTONIAN.1) },
            cross_on: value(if thins { 1.0 } else { 0.0 }),
            weight: c.payload.weight_n,
            extraction: c.payload.extraction_n_per_m,
            total_mass,
            inverse_mass,
            payload_share: payload_mass * inverse_mass,
            share_slope: c.payload.extraction_n_per_m / gravity * inverse_mass,
            free_lift: c.balloon.net_lift_n - c.payload.weight_n,
            drag: c.balloon.drag_factor_kg_per_m,
            inverse_fluid_capacity: per_c1,
            fluid_rotor_1: heat.fluid_rotor_w_per_k * per_c1,
            fluid_housing_1: heat.fluid_housing_w_per_k * per_c1,
            fluid_rotor_2: heat.fluid_rotor_w_per_k * per_c2,
            rotor_housing_2: heat.rotor_housing_w_per_k * per_c2,
            fluid_housing_3: heat.fluid_housing_w_per_k * per_c3,
            rotor_housing_3: heat.rotor_housing_w_per_k * per_c3,
            air_3: heat.air_w_per_k * per_c3,
            air_k: heat.air_k,
            initial_temperature: c.initial_temperature_k,
            rise_speed: c.balloon.rise_speed_m_per_s,
            capacity_ratio: heat.fluid_capacity_j_per_k * per_c2,
            middle_radius: c.film.middle_radius_m,
            half_width: c.film.half_width_m,
            conduction: c.film.conduction_per_s,
            cross_time: c.film.cross_time_s_per_m,
            spreading: c.film.spreading_per_s,
            expansion: c.film.expansion_per_k,
        }
    }
}

impl Constants<f64> {
    /// The constants of a descent, or nothing if they are impossible.
    pub fn possible(c: &Coefficients<f64>) -> Option<Self> {
        let constants = Constants::new(c);
        let heat = &c.thermal;
        let capacities = [heat.rotor_capacity_j_per_k, heat.housing_capacity_j_per_k];
        constants.possible_lanes(c.balloon.moving_mass_kg, capacities).then_some(constants)
    }
}

impl<V: Lanes> Constants<V> {
    /// Where a descent is possible: its constants finite, and of the sign that the equations need.
    #[inline(always)]
    pub fn possible_lanes(&self, moving_mass: V, capacities: [V; 2]) -> V::Mask {
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        let infinite = V::splat(f64::INFINITY);
        let positive = [
            self.length,
            self.inverse_length,
            self.full_radius_squared,
            self.full_radius_squared - self.radius_slope * self.length,
            self.torque,
            self.inverse_torque,
            self.weight,
            self.weight - self.extraction * self.length,
            moving_mass,
            self.total_mass,
            self.inverse_mass,
            self.drag,
            self.inverse_fluid_capacity,
            capacities[0],
            one / capacities[0],
            capacities[1],
            one / capacities[1],
            self.initial_temperature,
            self.cross_exponent,
            self.middle_radius,
            self.half_width,
            self.conduction,
            self.spreading,
        ];
        let not_negative = [
            self.inertia,
            -self.minus_viscosity_temperature,
            self.cross_group,
            self.extraction,
            self.fluid_rotor_1,
            self.fluid_housing_1,
            self.fluid_rotor_2,
            self.rotor_housing_2,
            self.fluid_housing_3,
            self.rotor_housing_3,
            self.air_3,
            self.cross_time,
            self.expansion,
        ];
        let finite =
            [self.averaging_offset, self.free_lift, self.air_k, self.rise_speed, self.spool_pull];
        let mut possible = zero.lt(one);
        for value in positive {
            possible = possible.and(zero.lt(value)).and(value.lt(infinite));
        }
        for value in not_negative {
            possible = possible.and(zero.le(value)).and(value.lt(infinite));
        }
        for value in finite {
            possible = possible.and(value.abs().lt(infinite));
        }
        possible
    }
}
