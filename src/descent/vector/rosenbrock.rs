//! One step of the Rosenbrock method Rodas4P2 over lanes.
//!
//! G. Steinebach, *Improvement of Rosenbrock–Wanner Method RODASP* (2020): order 4, six stages, stiffly
//! accurate, with an embedded method of order 3. In the transformed variables of Hairer and Wanner
//! (*Solving Ordinary Differential Equations II*, IV.7), for an autonomous system y′ = F(y) with
//! Jacobian J,
//! ```text
//! (I/(hγ) − J) u_i = F(y + Σ_j A_ij u_j) + Σ_j (C_ij/h) u_j ,   y₁ = y + Σ_i b_i u_i .
//! ```
//! Stages 5 and 6 share a row of `A` up to the last entry, which is 1, and `b` continues it with another
//! 1: the sixth argument is the fifth plus u₅, the result the sixth argument plus u₆, and u₆ is the
//! difference from the embedded method. A variable that counts the clock (here line length, or time)
//! is a component of `y` as any other, which is the same as the method's form for y′ = F(τ, y).

use crate::numerics::lanes::Lanes;

/// Number of stages.
pub const STAGES: usize = 6;
/// γ, the diagonal of the method.
pub const GAMMA: f64 = 0.25;
/// Rows 2 to 5 of `A`; row 6 is row 5 continued with 1, and so is `b` once more.
pub const A: [[f64; 4]; 4] = [
    [3.0, 0.0, 0.0, 0.0],
    [0.906_377_755_268_814, -0.189_707_390_391_685, 0.0, 0.0],
    [3.758_617_027_739_064, 1.161_741_776_019_525, -0.849_258_085_312_803, 0.0],
    [7.089_566_927_282_776, 4.573_591_406_461_604, -8.423_496_976_860_259, -0.959_280_113_459_775],
];
/// Rows 2 to 6 of `C`.
pub const C: [[f64; 5]; 5] = [
    [-12.0, 0.0, 0.0, 0.0, 0.0],
    [-6.354_581_592_719_008, 0.338_972_550_544_623, 0.0, 0.0, 0.0],
    [-8.575_016_317_114_033, -7.606_483_992_117_508, 12.224_997_650_124_82, 0.0, 0.0],
    [
        -5.888_975_457_523_102,
        -8.157_396_617_841_82,
        24.805_546_872_612_922,
        12.790_401_512_796_98,
        0.0,
    ],
    [
        -4.408_651_676_063_871,
        -6.692_003_137_674_639,
        24.625_568_527_593_117,
        16.627_521_966_636_085,
        -5.714_285_714_285_718,
    ],
];

/// Dense output of order 3, `y(θ) = y + θ (y₁ − y) + θ (1 − θ) Σ_i (P_i + θ Q_i) u_i`: the weights `P` and
/// `P + Q`, whose sums give the derivatives at the step's ends. They satisfy the order conditions up to
/// order 3 for every θ and those of the algebraic part of an index-1 problem up to order 2 (for this
/// method these follow from the others); of all that do, they are the smallest.
pub const DENSE: [[f64; 5]; 2] = [
    [
        -2.289_974_597_783_153,
        -7.039_166_005_778_763,
        16.806_434_285_091_637,
        2.783_288_336_733_503,
        -3.529_186_178_713_210_6,
    ],
    [
        -1.763_460_034_531_527,
        -6.517_961_781_496_553,
        16.742_420_438_317_36,
        4.148_057_196_898_42,
        0.432_513_355_425_928_1,
    ],
];

/// An autonomous system of `N` equations over lanes, with its own elimination of `I/(hγ) − J`.
pub trait System<V: Lanes, const N: usize> {
    /// The stiff component, whose right-hand side is no use as a derivative: an error far below the
    /// tolerance in it is multiplied by its large negative eigenvalue.
    const STIFF: usize;
    /// What a right-hand side's evaluation leaves behind for the Jacobian and the observer.
    type Moment: Copy;
    /// What a step's six solves share.
    type Factored;
    /// Evaluates the right-hand side.
    fn moment(&self, y: &[V; N]) -> Self::Moment;
    /// The right-hand side's value.
    fn rates(moment: &Self::Moment) -> [V; N];
    /// Prepares the solution of `(I/hγ − J) u = r` at the state `y` with its moment, given `hγ` and its
    /// reciprocal.
    fn factor(
        &self,
        y: &[V; N],
        moment: &Self::Moment,
        h_gamma: V,
        inverse_h_gamma: V,
    ) -> Self::Factored;
    /// Solves `(I/hγ − J) u = r`.
    fn solve(factored: &Self::Factored, r: &[V; N]) -> [V; N];
}

/// What a step arrives at.
pub struct Step<M, V, const N: usize> {
    /// The state after the step.
    pub state: [V; N],
    /// Its difference from the embedded method's.
    pub error: [V; N],
    /// The moment at the embedded method's result, a local error away from `state`.
    pub moment: M,
    /// Derivatives of the stiff component in the clock at the step's start and end.
    pub slopes: [V; 2],
}

/// One step of size `h` from `y`, whose moment is known.
#[inline(always)]
pub fn step<V: Lanes, S: System<V, N>, const N: usize>(
    system: &S,
    y: &[V; N],
    moment: &S::Moment,
    h: V,
) -> Step<S::Moment, V, N> {
    let inverse_h = V::splat(1.0) / h;
    let inverse_h_gamma = V::splat(1.0 / GAMMA) * inverse_h;
    let factored = system.factor(y, moment, h * V::splat(GAMMA), inverse_h_gamma);
    let mut u = [[V::splat(0.0); N]; STAGES];
    u[0] = S::solve(&factored, &S::rates(moment));
    let mut argument: [V; N];
    macro_rules! stage {
        ($i:literal) => {
            argument = *y;
            for j in 0..$i {
                for n in 0..N {
                    argument[n] = u[j][n].mul_add(V::splat(A[$i - 1][j]), argument[n]);
                }
            }
            u[$i] =
                S::solve(&factored, &right_side::<V, S, N, $i>(system, &argument, &u, inverse_h).0);
        };
    }
    stage!(1);
    stage!(2);
    stage!(3);
    stage!(4);
    for n in 0..N {
        argument[n] = argument[n] + u[4][n];
    }
    let (right, last) = right_side::<V, S, N, 5>(system, &argument, &u, inverse_h);
    let error = S::solve(&factored, &right);
    for n in 0..N {
        argument[n] = argument[n] + error[n];
    }
    let stiff = S::STIFF;
    let rise = argument[stiff] - y[stiff];
    let mut slopes = [rise; 2];
    for j in 0..5 {
        slopes[0] = u[j][stiff].mul_add(V::splat(DENSE[0][j]), slopes[0]);
        slopes[1] = u[j][stiff].neg_mul_add(V::splat(DENSE[1][j]), slopes[1]);
    }
    let slopes = [slopes[0] * inverse_h, slopes[1] * inverse_h];
    Step { state: argument, error, moment: last, slopes }
}

/// `F(argument) + Σ_j (C_ij/h) u_j` for stage `I` (counted from 0), and the moment at the argument.
#[inline(always)]
fn right_side<V: Lanes, S: System<V, N>, const N: usize, const I: usize>(
    system: &S,
    argument: &[V; N],
    u: &[[V; N]; STAGES],
    inverse_h: V,
) -> ([V; N], S::Moment) {
    let moment = system.moment(argument);
    let mut right = S::rates(&moment);
    for n in 0..N {
        let mut sum = u[0][n] * V::splat(C[I - 1][0]);
        for j in 1..I {
            sum = u[j][n].mul_add(V::splat(C[I - 1][j]), sum);
        }
        right[n] = sum.mul_add(inverse_h, right[n]);
    }
    (right, moment)
}
