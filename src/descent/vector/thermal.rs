//! The heat's part of a step's linear algebra, shared by both models.
//!
//! With `c = 1/(hγ g)`, the three nodes' rows of `(I/hγ − J) u = r`, divided by the clock's rate `g`, are
//! ```text
//! (c + k12/C1 + k13/C1 + φ(1+ε)) u1 − (k12/C1 + φ ε) u2 − k13/C1 u3 = r1/g + (terms in ul, uv)
//! −k12/C2 u1 + (c + k12/C2 + k23/C2) u2 − k23/C2 u3                 = r2/g + (terms in uv)
//! −k13/C3 u1 − k23/C3 u2 + (c + (k13 + k23 + ka)/C3) u3             = r3/g + (terms in uv)
//! ```
//! where `φ = −∂Ṫ1/∂Tv` at constant relative velocity. The inverse of this matrix costs one division a
//! step, and its nine products a stage do not wait for one another as a substitution would.

use super::constants::Constants;
use crate::numerics::lanes::Lanes;

/// Rates of the three temperatures in time, K/s, with `power` heating the fluid.
#[inline(always)]
pub fn rates<V: Lanes>(k: &Constants<V>, fluid: V, rotor: V, housing: V, power: V) -> [V; 3] {
    let fluid_rotor = fluid - rotor;
    let fluid_housing = fluid - housing;
    let rotor_housing = rotor - housing;
    let to_air = k.air_k - housing;
    [
        fluid_housing.neg_mul_add(
            k.fluid_housing_1,
            fluid_rotor.neg_mul_add(k.fluid_rotor_1, k.inverse_fluid_capacity * power),
        ),
        rotor_housing.neg_mul_add(k.rotor_housing_2, fluid_rotor * k.fluid_rotor_2),
        to_air.mul_add(
            k.air_3,
            rotor_housing.mul_add(k.rotor_housing_3, fluid_housing * k.fluid_housing_3),
        ),
    ]
}

/// The thermal matrix, and its inverse's nine entries once multiplied with `1/determinant`.
pub struct Cofactors<V> {
    /// Cofactors, transposed: `adjugate[i][j]/determinant` is the inverse's entry (i, j).
    pub adjugate: [[V; 3]; 3],
    /// Determinant.
    pub determinant: V,
}

/// Adjugate and determinant of the thermal matrix with `c = 1/(hγ g)` and the feedback
/// `φ = −∂Ṫ1/∂Tv`.
#[inline(always)]
pub fn cofactors<V: Lanes>(k: &Constants<V>, c: V, feedback: V) -> Cofactors<V> {
    let eps = k.averaging_offset;
    let a11 = (c + k.fluid_rotor_1) + (k.fluid_housing_1 + feedback.mul_add(eps, feedback));
    let a22 = c + (k.fluid_rotor_2 + k.rotor_housing_2);
    let a33 = c + ((k.fluid_housing_3 + k.rotor_housing_3) + k.air_3);
    // Signs turned: the off-diagonal entries are −b.
    let b12 = feedback.mul_add(eps, k.fluid_rotor_1);
    let b13 = k.fluid_housing_1;
    let (b21, b23) = (k.fluid_rotor_2, k.rotor_housing_2);
    let (b31, b32) = (k.fluid_housing_3, k.rotor_housing_3);
    let minor11 = b23.neg_mul_add(b32, a22 * a33);
    let minor12 = b23.mul_add(b31, b21 * a33);
    let minor13 = a22.mul_add(b31, b21 * b32);
    let adjugate = [
        [minor11, b13.mul_add(b32, b12 * a33), b12.mul_add(b23, b13 * a22)],
        [minor12, b13.neg_mul_add(b31, a11 * a33), a11.mul_add(b23, b13 * b21)],
        [minor13, a11.mul_add(b32, b12 * b31), b12.neg_mul_add(b21, a11 * a22)],
    ];
    let determinant = b13.neg_mul_add(minor13, b12.neg_mul_add(minor12, a11 * minor11));
    Cofactors { adjugate, determinant }
}

/// `u_Tv = (1 + ε) u_1 − ε u_2`: how the viscosity's temperature follows fluid and rotors.
#[inline(always)]
pub fn blend<V: Lanes>(averaging_offset: V, fluid: V, rotor: V) -> V {
    averaging_offset.mul_add(fluid - rotor, fluid)
}

/// The temperatures' part of a step's solution. (Functions, not closures: those cannot be told to be inlined,
/// and one that is not makes every operation in it a call.)
pub struct Solution<V> {
    /// `u_Ti` by the right side of each temperature's own rows.
    pub own: [[V; 3]; 3],
    /// `u_Ti` by the right side of the line's row.
    pub by_line: [V; 3],
    /// `u_Ti` by `u_v`.
    pub by_v: [V; 3],
}

impl<V: Lanes> Solution<V> {
    /// The three `u_Ti`, given the right sides of line, fluid, rotors and housing, and `u_v`.
    #[inline(always)]
    pub fn solve(&self, r: [V; 4], u_v: V) -> [V; 3] {
        let mut u = [u_v; 3];
        for (i, value) in u.iter_mut().enumerate() {
            let [first, second, third] = self.own[i];
            let own = third.mul_add(r[3], second.mul_add(r[2], first * r[1]));
            *value = self.by_v[i].mul_add(u_v, self.by_line[i].mul_add(r[0], own));
        }
        u
    }
}
