//! The step's linear system, shared by both detailed models.
//!
//! Divided by the clock's rate as in `dynamic.rs`, with `c = G/(hγ)`. A temperature's row couples to its own radius (a dense block),
//! a wall to the other walls, and everything else only through four numbers: the means' excess over the housing `y1 = u_T̄1 − u_3`,
//! `y2 = u_T̄2 − u_3`, the velocity `u_v` and the line `u_l`:
//! ```text
//! Λ u + h1 y1 + h2 y2 − q (u_v/v + (s/2p) u_l) + α F u_v = G r        h1 = K13/C1 (on walls by their share), h2 = K23/C2 (walls)
//! q = (2 + ε) × source ,  ε = dln(thinning)/dln X
//! ```
//! `Λ` is factorised without pivots: each block from the film's middle to the wall, then what is left of the walls. Three columns
//! `Λ⁻¹ h1`, `Λ⁻¹ h2` and the one of `u_v` are worked out once a step, and leave a 3 × 3 system in `y1, y2, u_v`.

use super::brake::{Detailed, Moment, field_of};
use crate::numerics::lanes::{Lanes, Wide};
use crate::physics::film::Field;

/// What a step's solves share.
pub struct Factored<V, const P: usize, const K: usize> {
    blocks: [[[V; K]; K]; P],
    walls: [[V; P]; P],
    /// `Λ⁻¹ h1`, `Λ⁻¹ h2`, and the column of `u_v`.
    pub columns: [Field<V, P, K>; 3],
    /// `q s/2p`: what a change of the line heats.
    pub heat_by_line: Field<V, P, K>,
    /// Functionals: shares of the fluid, and the relative change of the pull per kelvin.
    pub fluid: Field<V, P, K>,
    pub area: [V; P],
    pub pull: Field<V, P, K>,
    /// Inverse of the 3 × 3 system.
    pub inverse: [[V; 3]; 3],
    pub pace: V,
    pub h_gamma: V,
    pub line_by_v: V,
    pub housing: [V; 4],
    pub centre: [V; 3],
    /// The velocity's row: its right side's factor, and what `u_l`, `u_U` and `A3` enter it with.
    pub velocity: [V; 4],
    pub time_by_v: V,
}

/// Blocks and walls factorised in place, without pivots.
#[inline(always)]
pub fn factorise<V: Lanes, const P: usize, const K: usize>(
    blocks: &mut [[[V; K]; K]; P],
    walls: &mut [[V; P]; P],
) {
    let one = V::splat(1.0);
    for i in 0..P {
        let block = &mut blocks[i];
        for p in (1..K).rev() {
            let inverse = one / block[p][p];
            block[p][p] = inverse;
            for q in 0..p {
                let factor = block[q][p] * inverse;
                block[q][p] = factor;
                for t in 0..p {
                    block[q][t] = factor.neg_mul_add(block[p][t], block[q][t]);
                }
            }
        }
        walls[i][i] = walls[i][i] + block[0][0];
    }
    for p in 0..P {
        let inverse = one / walls[p][p];
        walls[p][p] = inverse;
        for q in p + 1..P {
            let factor = walls[q][p] * inverse;
            walls[q][p] = factor;
            for t in p + 1..P {
                walls[q][t] = factor.neg_mul_add(walls[p][t], walls[q][t]);
            }
        }
    }
}

/// `Λ⁻¹ r` in place.
#[inline(always)]
pub fn solve_field<V: Lanes, const P: usize, const K: usize>(
    blocks: &[[[V; K]; K]; P],
    walls: &[[V; P]; P],
    r: &mut Field<V, P, K>,
) {
    for i in 0..P {
        for p in (1..K).rev() {
            for q in 0..p {
                r[i][q] = blocks[i][q][p].neg_mul_add(r[i][p], r[i][q]);
            }
        }
    }
    for p in 0..P {
        for q in p + 1..P {
            r[q][0] = walls[q][p].neg_mul_add(r[p][0], r[q][0]);
        }
    }
    for p in (0..P).rev() {
        for t in p + 1..P {
            r[p][0] = walls[p][t].neg_mul_add(r[t][0], r[p][0]);
        }
        r[p][0] = r[p][0] * walls[p][p];
    }
    for i in 0..P {
        for p in 1..K {
            for t in 0..p {
                r[i][p] = blocks[i][p][t].neg_mul_add(r[i][t], r[i][p]);
            }
            r[i][p] = r[i][p] * blocks[i][p][p];
        }
    }
}

#[inline(always)]
fn dot<V: Lanes, const P: usize, const K: usize>(f: &Field<V, P, K>, u: &Field<V, P, K>) -> V {
    let mut sum = f[0][0] * u[0][0];
    for i in 0..P {
        for a in 0..K {
            if i + a > 0 {
                sum = f[i][a].mul_add(u[i][a], sum);
            }
        }
    }
    sum
}

#[inline(always)]
fn dot_walls<V: Lanes, const P: usize, const K: usize>(area: &[V; P], u: &Field<V, P, K>) -> V {
    let mut sum = area[0] * u[0][0];
    for i in 1..P {
        sum = area[i].mul_add(u[i][0], sum);
    }
    sum
}

/// Inverse of a 3 × 3 matrix by its adjugate.
#[inline(always)]
fn inverse<V: Lanes>(m: &[[V; 3]; 3]) -> [[V; 3]; 3] {
    let minor =
        |a: usize, b: usize, c: usize, d: usize| m[a][d].neg_mul_add(m[b][c], m[a][c] * m[b][d]);
    let adjugate = [
        [minor(1, 2, 1, 2), -minor(0, 2, 1, 2), minor(0, 1, 1, 2)],
        [-minor(1, 2, 0, 2), minor(0, 2, 0, 2), -minor(0, 1, 0, 2)],
        [minor(1, 2, 0, 1), -minor(0, 2, 0, 1), minor(0, 1, 0, 1)],
    ];
    let determinant =
        m[0][2].mul_add(adjugate[2][0], m[0][1].mul_add(adjugate[1][0], m[0][0] * adjugate[0][0]));
    let scale = V::splat(1.0) / determinant;
    adjugate.map(|row| row.map(|entry| entry * scale))
}

impl<V: Lanes, const P: usize, const K: usize> Detailed<V, P, K> {
    /// The heat's part of a step's system, and what of the velocity's row does not depend on the model: the caller gives that
    /// row as `a_v u_v + a_l u_l + a_U u_U + a_3 A3 = g r` with the row of `U` as `u_U = centre · (r_l, r_U, u_v)`.
    #[inline(always)]
    pub fn factor<const N: usize>(
        &self,
        m: &Moment<V, P, K, N>,
        first: usize,
        (h_gamma, c): (V, V),
        (own, centre, row): (V, [V; 3], [V; 4]),
    ) -> Factored<V, P, K> {
        let k = &self.constants;
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        let (film, paths, space) = (self.film(), self.paths(), &self.space);
        let heat = &m.heat;
        let (wall_film, wall_metal) = paths.wall_shares(Wide(V::splat(space.share[0])));
        let (wall_film, wall_metal) = (wall_film.0, wall_metal.0);
        let alpha = self.clock.length;
        let two = V::splat(2.0);
        let mut blocks = [[[zero; K]; K]; P];
        let mut walls = [[zero; P]; P];
        let mut columns = [[[zero; K]; P]; 3];
        let mut heat_by_line = [[zero; K]; P];
        let mut fluid = [[zero; K]; P];
        let mut pull = [[zero; K]; P];
        let inverse_c = one / c;
        let line_by_v = alpha.neg_mul_add(m.rates[0], one) * inverse_c;
        let half_slope = V::splat(0.5) * (k.radius_slope / m.p);
        // q/v, without dividing by a velocity of zero at release: the heat then vanishes with its square.
        let still = m.v.abs().lt(V::splat(1e-100));
        let inverse_v = V::select(still, zero, one / V::select(still, one, m.v));
        let by_v = half_slope.mul_add(line_by_v, inverse_v);
        let per_stiffness = one / heat.shear.stiffness.0;
        for i in 0..P {
            let g = heat.resistance.thickening[i].0;
            let bent = two + heat.shear.exponent[i].0;
            let feeling = (heat.faces.torque[i].0 * g)
                * (heat.shear.thinning[i].0 * (one + heat.shear.exponent[i].0))
                * (g * per_stiffness);
            let mut softening = [zero; K];
            for b in 0..K {
                let share = V::splat(space.share[b]);
                softening[b] = (heat.resistance.fluidity[i][b].0
                    * heat.resistance.slope_per_k[i][b].0)
                    * share;
                fluid[i][b] = heat.faces.area[i].0 * share;
                pull[i][b] = feeling * softening[b];
                softening[b] = softening[b] * (g * bent);
            }
            for a in 0..K {
                let source = heat.heating.source[i][a].0;
                let slope = heat.resistance.slope_per_k[i][a].0;
                let scale = if a == 0 { wall_film } else { one };
                for b in 0..K {
                    let entry =
                        source.mul_add(softening[b], k.conduction * V::splat(space.across[a][b]));
                    let entry = if a == b { source.neg_mul_add(slope, entry) } else { entry };
                    blocks[i][a][b] = scale * entry;
                }
                blocks[i][a][a] = blocks[i][a][a] + c;
                let q = scale * (source * bent);
                heat_by_line[i][a] = q * half_slope;
                columns[0][i][a] = scale * k.fluid_housing_1;
                let clocked = alpha * m.rates[first + i * K + a];
                columns[2][i][a] = q.mul_add(by_v, -clocked);
            }
            columns[1][i][0] = wall_metal * k.rotor_housing_2;
            let spread = wall_metal * heat.faces.spreading_factor(&film, i).0;
            let flare = heat.faces.flare.0;
            for t in 0..P {
                let stiffness =
                    flare.mul_add(V::splat(space.flare[i][t]), V::splat(space.strip[i][t]));
                walls[i][t] = spread * stiffness;
            }
        }
        factorise(&mut blocks, &mut walls);
        for column in &mut columns {
            solve_field(&blocks, &walls, column);
        }
        let area = heat.faces.area.map(|area| area.0);
        // The housing: u_3 = m0 (G r_3 + k13 y1 + k23 y2 − α F3 u_v).
        let pivot = one / (c + k.air_3);
        let clocked = alpha * m.rates[first + P * K];
        let housing =
            [pivot, pivot * k.fluid_housing_3, pivot * k.rotor_housing_3, -(pivot * clocked)];
        let [by_v_own, by_line, by_centre, by_heat] = row;
        let mut system = [[zero; 3]; 3];
        for (n, column) in columns.iter().enumerate() {
            let sign = if n == 2 { -one } else { one };
            system[0][n] = (sign * dot(&fluid, column)) + housing[n + 1];
            system[1][n] = (sign * dot_walls(&area, column)) + housing[n + 1];
            system[2][n] = -(sign * (by_heat * dot(&pull, column)));
        }
        system[0][0] = system[0][0] + one;
        system[1][1] = system[1][1] + one;
        system[2][2] =
            system[2][2] + by_centre.mul_add(centre[2], by_line.mul_add(line_by_v, by_v_own));
        Factored {
            blocks,
            walls,
            columns,
            heat_by_line,
            fluid,
            area,
            pull,
            inverse: inverse(&system),
            pace: self.clock.pace(m.v),
            h_gamma,
            line_by_v,
            housing,
            centre,
            velocity: [own, by_line, by_centre, by_heat],
            time_by_v: -((alpha * m.rates[N - 1]) * inverse_c),
        }
    }
}

impl<V: Lanes, const P: usize, const K: usize> Factored<V, P, K> {
    /// Solves with the right sides of line, centre, velocity, the field, housing and time; returns them in that order.
    #[inline(always)]
    pub fn solve<const N: usize>(
        &self,
        r: &[V; N],
        first: usize,
    ) -> ([V; 3], Field<V, P, K>, V, V) {
        let centre_r = if first == 3 { r[1] } else { V::splat(0.0) };
        let velocity_r = if first == 3 { r[2] } else { V::splat(0.0) };
        let line = self.h_gamma * r[0];
        let mut u: Field<V, P, K> = field_of(r, first);
        for i in 0..P {
            for a in 0..K {
                u[i][a] = self.heat_by_line[i][a].mul_add(line, self.pace * u[i][a]);
            }
        }
        solve_field(&self.blocks, &self.walls, &mut u);
        let housing_own = (self.housing[0] * self.pace) * r[N - 2];
        let centre_own = self.centre[1].mul_add(r[0], self.centre[0] * centre_r);
        let [own, by_line, by_centre, by_heat] = self.velocity;
        let right = [
            dot(&self.fluid, &u) - housing_own,
            dot_walls(&self.area, &u) - housing_own,
            by_heat.neg_mul_add(
                dot(&self.pull, &u),
                by_centre.neg_mul_add(centre_own, by_line.neg_mul_add(line, own * velocity_r)),
            ),
        ];
        let mut small = [V::splat(0.0); 3];
        for (value, row) in small.iter_mut().zip(&self.inverse) {
            *value = row[2].mul_add(right[2], row[1].mul_add(right[1], row[0] * right[0]));
        }
        let [y1, y2, u_v] = small;
        for i in 0..P {
            for a in 0..K {
                let over = self.columns[0][i][a].neg_mul_add(y1, u[i][a]);
                let over = self.columns[1][i][a].neg_mul_add(y2, over);
                u[i][a] = self.columns[2][i][a].mul_add(u_v, over);
            }
        }
        let u_l = self.line_by_v.mul_add(u_v, line);
        let u_centre = self.centre[2].mul_add(u_v, centre_own);
        let u_3 = self.housing[3]
            .mul_add(u_v, self.housing[2].mul_add(y2, self.housing[1].mul_add(y1, housing_own)));
        let u_t = self.time_by_v.mul_add(u_v, self.h_gamma * r[N - 1]);
        ([u_l, u_centre, u_v], u, u_3, u_t)
    }
}
