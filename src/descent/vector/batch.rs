//! The descents to integrate, and how some of them are laid side by side.

use crate::numerics::columns::Columns;
use crate::numerics::lanes::{Lanes, Wide};
use crate::physics::{Coefficients, Design, FIELD_COUNT, Parameter, Target};
use std::ops::Range;

/// Descents, one after the other.
#[derive(Debug, Clone, Copy)]
pub enum Batch<'a> {
    /// By their coefficients.
    Coefficients(&'a [Coefficients<f64>]),
    /// By draws of a design's parameters.
    Draws(Draws<'a>),
}

/// Draws of some parameters of one design. What a draw makes of the design is worked out in lanes, with the bits
/// of [`Coefficients::new`].
#[derive(Debug, Clone, Copy)]
pub struct Draws<'a> {
    /// The design.
    pub design: &'a Design,
    /// Which of its parameters are drawn.
    pub targets: &'a [Target],
    /// The draws, SI: rows = descents, columns = targets.
    pub inputs: &'a Columns,
    /// Whether a row is a possible design; one that is not has a fault for its result.
    pub possible: &'a [bool],
}

/// Some descents of a batch side by side; lanes too many repeat one of them.
pub(super) struct Abreast<V> {
    /// Their coefficients, with shear thinning if any thins.
    pub coefficients: Coefficients<Wide<V>>,
    /// Bit `k` is set where the fluid in lane `k` thins with shear.
    pub thins: u32,
    /// Bit `k` is set where lane `k`'s is known to be impossible.
    pub impossible: u32,
}

/// A batch with what it takes to lay it side by side.
pub(super) enum Source<'a, V> {
    /// Coefficients, which are laid side by side as they are.
    Coefficients(&'a [Coefficients<f64>]),
    /// Draws, and the design that they are written into.
    Draws(Draws<'a>, Design<Wide<V>>),
}

impl<'a> Batch<'a> {
    /// Number of descents.
    pub fn len(&self) -> usize {
        match self {
            Batch::Coefficients(batch) => batch.len(),
            Batch::Draws(draws) => draws.inputs.rows().min(draws.possible.len()),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Some of the descents, to be integrated once more.
    pub(super) fn pick(&self, places: &[usize]) -> Picked<'a> {
        match self {
            Batch::Coefficients(batch) => {
                Picked::Coefficients(places.iter().map(|&place| batch[place]).collect())
            }
            Batch::Draws(draws) => {
                let mut inputs = Columns::new(places.len(), draws.inputs.columns());
                for j in 0..inputs.columns() {
                    let all = draws.inputs.column(j);
                    let picked = inputs.column_mut(j).iter_mut().zip(places);
                    picked.for_each(|(value, &place)| *value = all[place]);
                }
                Picked::Draws(*draws, inputs, vec![true; places.len()])
            }
        }
    }

    #[inline(always)]
    pub(super) fn source<V: Lanes>(self) -> Source<'a, V> {
        match self {
            Batch::Coefficients(batch) => Source::Coefficients(batch),
            Batch::Draws(draws) => {
                Source::Draws(draws, draws.design.map(|value| Wide(V::splat(value))))
            }
        }
    }
}

/// Some descents of a batch, all of them possible.
pub(super) enum Picked<'a> {
    /// By their coefficients.
    Coefficients(Vec<Coefficients<f64>>),
    /// By draws: what they belong to, their rows, and that each is possible.
    Draws(Draws<'a>, Columns, Vec<bool>),
}

impl Picked<'_> {
    /// As a batch.
    pub fn batch(&self) -> Batch<'_> {
        match self {
            Picked::Coefficients(some) => Batch::Coefficients(some),
            Picked::Draws(draws, inputs, possible) => {
                Batch::Draws(Draws { inputs, possible, ..*draws })
            }
        }
    }
}

impl<V: Lanes> Source<'_, V> {
    /// Descents `range`, at least one and at most as many as there are lanes, side by side.
    #[inline(always)]
    pub(super) fn abreast(&mut self, range: Range<usize>) -> Abreast<V> {
        match self {
            Source::Coefficients(batch) => of_coefficients(&batch[range]),
            Source::Draws(draws, design) => draws.abreast(range, design),
        }
    }
}

#[inline(always)]
fn of_coefficients<V: Lanes>(some: &[Coefficients<f64>]) -> Abreast<V> {
    let mut fields = [Wide(V::splat(0.0)); FIELD_COUNT];
    let mut thins = 0;
    for lane in 0..V::WIDTH {
        let one = &some[lane.min(some.len() - 1)];
        for (field, value) in fields.iter_mut().zip(one.fields()) {
            field.0.lanes_mut()[lane] = value;
        }
        thins |= u32::from(one.fluid.shear_thinning) << lane;
    }
    Abreast { coefficients: Coefficients::from_fields(fields, thins != 0), thins, impossible: 0 }
}

impl Draws<'_> {
    #[inline(always)]
    fn abreast<V: Lanes>(&self, range: Range<usize>, design: &mut Design<Wide<V>>) -> Abreast<V> {
        for (j, &target) in self.targets.iter().enumerate() {
            let values = &self.inputs.column(j)[range.clone()];
            let mut lanes = V::splat(values[0]);
            lanes.lanes_mut()[..values.len()].copy_from_slice(values);
            design.set(target, Wide(lanes));
        }
        let (mut thins, mut impossible) = (0, 0);
        let times = design.get(Parameter::FluidCrossTimeConstant).0;
        for (lane, &time) in times.lanes().iter().enumerate() {
            thins |= u32::from(time > 0.0) << lane;
        }
        for (lane, possible) in self.possible[range].iter().enumerate() {
            impossible |= u32::from(!possible) << lane;
        }
        let coefficients = Coefficients::with_shear_thinning(design, thins != 0);
        Abreast { coefficients, thins, impossible }
    }
}
