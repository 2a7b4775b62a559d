//! One sample of points, seen through changed laws and designs: common random numbers.
//!
//! Row `k` of every variant comes from the same point of the unit cube, so two variants differ where the
//! change matters and nowhere else, and the difference of their breach probabilities has a far smaller
//! error than either.

pub use super::breaches::{Breaches, Event};
use super::{Ensemble, Progress, in_parallel, sampler};
use crate::error::{Error, Result};
use crate::numerics::columns::Columns;
use crate::outcomes::OutcomeTable;
use crate::physics::Target;
use crate::sampling::{Design, Sampler};
use crate::sensitivity::conditional_normal::Conditioning;
use crate::streams::Purpose;
use crate::study::Study;
use crate::uncertainty::{JointSample, Marginal};
use std::ops::Range;

/// What a variant changes in a study.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Change {
    /// Inputs that follow another law.
    pub marginals: Vec<(usize, Marginal)>,
    /// Inputs whose value, SI, is known; the others follow their laws given it.
    pub known: Vec<(usize, f64)>,
    /// Design values, SI. Of an input, the law's mean moves there.
    pub design: Vec<(Target, f64)>,
}

impl Change {
    /// The spread of these inputs multiplied by `factor`, truncation limits moving along; a factor of 0
    /// is [`Self::LEAST_SPREAD`].
    ///
    /// # Errors
    /// If a law cannot be stretched so.
    pub fn spread(study: &Study, columns: &[usize], factor: f64) -> Result<Self> {
        Self::default().and_spread(study, columns, factor)
    }

    /// The factor that stands for no spread at all.
    pub const LEAST_SPREAD: f64 = 1e-6;

    /// This change, and the spread of these inputs multiplied by `factor`.
    ///
    /// # Errors
    /// If a law cannot be stretched so.
    pub fn and_spread(mut self, study: &Study, columns: &[usize], factor: f64) -> Result<Self> {
        for &column in columns {
            let marginal =
                study.inputs[column].marginal.with_spread(factor.max(Self::LEAST_SPREAD))?;
            self.marginals.push((column, marginal));
        }
        Ok(self)
    }

    /// The mean of these inputs moved by `delta`, SI, truncation limits moving along.
    ///
    /// # Errors
    /// If a law cannot be moved so.
    pub fn shift(study: &Study, columns: &[usize], delta: f64) -> Result<Self> {
        let mut change = Self::default();
        for &column in columns {
            let marginal = study.inputs[column].marginal.with_shifted_mean(delta)?;
            change.marginals.push((column, marginal));
        }
        Ok(change)
    }

    /// This change, and a design value.
    pub fn and_design(mut self, target: Target, value: f64) -> Self {
        self.design.push((target, value));
        self
    }
}

/// A sample of points of a study, kept to be looked at again.
#[derive(Debug)]
pub struct CommonSample<'a> {
    study: &'a Study,
    replicates: usize,
    /// Uniforms of independent inputs, correlated standard normal values of others.
    points: Columns,
    inputs: Columns,
}

impl<'a> CommonSample<'a> {
    /// The first `rows` points of the study's own design; fewer if it has fewer. Rows of every replicate
    /// are there in equal number.
    ///
    /// # Errors
    /// What [`sampler`] refuses.
    pub fn of_run(study: &'a Study, rows: u64) -> Result<Self> {
        let sampler = sampler(study)?;
        let replicates = u64::from(sampler.replicates());
        let rows = (rows.min(sampler.samples()) / replicates).max(1) * replicates;
        Self::drawn(study, &sampler, 0..rows)
    }

    /// The study's own points of these indices, ascending.
    ///
    /// # Errors
    /// What [`sampler`] refuses, and an index beyond the design.
    pub fn of_rows(study: &'a Study, rows: &[usize]) -> Result<Self> {
        let sampler = sampler(study)?;
        let mut uniforms = Columns::new(rows.len(), study.joint.dimension());
        let mut start = 0;
        while start < rows.len() {
            let next = rows[start..].windows(2).take_while(|pair| pair[1] == pair[0] + 1);
            let run = next.count() + 1;
            let mut block = Columns::new(run, uniforms.columns());
            sampler.fill(rows[start] as u64, &mut block)?;
            for j in 0..uniforms.columns() {
                uniforms.column_mut(j)[start..start + run].copy_from_slice(block.column(j));
            }
            start += run;
        }
        Ok(Self::at(study, sampler.replicates() as usize, uniforms))
    }

    /// Independent points of a purpose's stream, by their indices.
    ///
    /// # Errors
    /// If nothing is uncertain.
    pub fn independent(study: &'a Study, rows: Range<u64>, purpose: Purpose) -> Result<Self> {
        let seed = study.sampling.seed;
        let dimension = study.joint.dimension();
        let sampler = Sampler::new(Design::MonteCarlo, dimension, rows.end, 1, seed, purpose)?;
        Self::drawn(study, &sampler, rows)
    }

    fn drawn(study: &'a Study, sampler: &Sampler, rows: Range<u64>) -> Result<Self> {
        let count = rows.end.saturating_sub(rows.start) as usize;
        let mut uniforms = Columns::new(count, study.joint.dimension());
        sampler.fill(rows.start, &mut uniforms)?;
        Ok(Self::at(study, sampler.replicates() as usize, uniforms))
    }

    /// The draws at points of the unit cube.
    fn at(study: &'a Study, replicates: usize, uniforms: Columns) -> Self {
        let points = match study.joint.copula() {
            None => uniforms,
            Some(copula) => {
                let mut normals = Columns::new(uniforms.rows(), uniforms.columns());
                for j in 0..uniforms.columns() {
                    let column = normals.column_mut(j);
                    crate::numerics::special::normal::quantile_column(uniforms.column(j), column);
                }
                let mut correlated = Columns::default();
                copula.correlate(&normals, &mut correlated);
                correlated
            }
        };
        let inputs = Columns::new(points.rows(), points.columns());
        let mut sample = CommonSample { study, replicates, points, inputs };
        let columns: Vec<usize> = (0..study.inputs.len()).filter(|&j| sample.is_alone(j)).collect();
        let values = in_parallel(&columns, |&j| sample.column(&study.inputs[j].marginal, j));
        for (&j, column) in columns.iter().zip(&values) {
            sample.inputs.column_mut(j).copy_from_slice(column);
        }
        sample.fill_drawn_together();
        sample
    }

    /// Writes the inputs that are drawn together with others.
    fn fill_drawn_together(&mut self) {
        let CommonSample { study, points, inputs, .. } = self;
        match study.joint.copula() {
            None => study.joint.fill_from_uniform(points, inputs),
            Some(_) => study.joint.fill_from_standard_normal(points, inputs),
        }
    }

    /// The study.
    pub fn study(&self) -> &'a Study {
        self.study
    }

    /// Number of points.
    pub fn rows(&self) -> usize {
        self.points.rows()
    }

    /// Independently randomised replicates to which the points belong in turn; 1 if every point is
    /// independent.
    pub fn replicates(&self) -> usize {
        self.replicates
    }

    /// The unchanged inputs, SI.
    pub fn inputs(&self) -> &Columns {
        &self.inputs
    }

    /// Some of the points, as a sample of their own.
    pub fn rows_of(&self, rows: &[u32]) -> CommonSample<'a> {
        let gather = |from: &Columns| {
            let mut columns = Columns::new(rows.len(), from.columns());
            for j in 0..from.columns() {
                let own = from.column(j);
                let into = columns.column_mut(j).iter_mut();
                into.zip(rows).for_each(|(value, &row)| *value = own[row as usize]);
            }
            columns
        };
        CommonSample {
            study: self.study,
            replicates: self.replicates,
            points: gather(&self.points),
            inputs: gather(&self.inputs),
        }
    }

    /// The normal scores of the places of the rows from which inputs are drawn together.
    pub fn row_scores(&self, drawn: &JointSample) -> Vec<f64> {
        let coordinate = self.points.column(drawn.coordinate());
        let mut scores = coordinate.to_vec();
        if self.study.joint.copula().is_none() {
            crate::numerics::special::normal::quantile_column(coordinate, &mut scores);
        }
        scores
    }

    /// The normal scores Φ⁻¹(F(x)) of an input.
    pub fn normal_scores(&self, j: usize) -> Vec<f64> {
        if !self.is_alone(j) {
            // A value drawn from a table: its law runs from 0 at the least to 1 at the greatest, and each row
            // has an equal part of the interval, of which this is the middle.
            let law = &self.study.inputs[j].marginal;
            let rows =
                self.study.joint.sample_of(j).map_or(1, |sample| sample.rows().rows()) as f64;
            let middle = |&x: &f64| ((rows - 1.0) * law.cdf(x) + 0.5) / rows;
            let scores = self.inputs.column(j).iter().map(middle);
            return scores.map(crate::numerics::special::normal::quantile).collect();
        }
        let mut scores = self.points.column(j).to_vec();
        if self.study.joint.copula().is_none() {
            crate::numerics::special::normal::quantile_column(self.points.column(j), &mut scores);
        }
        scores
    }

    /// Input `j` under the law `marginal`. One that is drawn together with others keeps the rank that its row
    /// has among the rows: what depends on what stays, and the law alone changes.
    fn column(&self, marginal: &Marginal, j: usize) -> Vec<f64> {
        let mut values = vec![0.0; self.rows()];
        if self.study.joint.sample_of(j).is_some() {
            let own = &self.study.inputs[j].marginal;
            for (value, &x) in values.iter_mut().zip(self.inputs.column(j)) {
                let (below, above) = (own.cdf(x), own.survival(x));
                *value = match below <= above {
                    true => marginal.quantile_lower(below),
                    false => marginal.quantile_upper(above),
                };
            }
            return values;
        }
        match self.study.joint.copula() {
            None => marginal.quantile_column(self.points.column(j), &mut values),
            Some(_) => marginal.from_standard_normal_column(self.points.column(j), &mut values),
        }
        values
    }

    /// The breaches of the unchanged study.
    ///
    /// # Errors
    /// As [`Self::changed`].
    pub fn base(&self, progress: &Progress) -> Result<Breaches> {
        self.changed(&Change::default(), progress)
    }

    /// The breaches of a variant of the study at these points.
    ///
    /// # Errors
    /// If a design value does not fit an input's law.
    pub fn changed(&self, change: &Change, progress: &Progress) -> Result<Breaches> {
        Ok(Breaches::of(self.study, &self.table(change, progress)?))
    }

    /// What becomes of a variant of the study at these points.
    ///
    /// # Errors
    /// As [`Self::changed`].
    pub fn table(&self, change: &Change, progress: &Progress) -> Result<OutcomeTable> {
        let mut study = self.study.clone();
        let mut inputs = self.inputs.clone();
        let mut marginals = change.marginals.clone();
        for &(target, value) in &change.design {
            study.design.set(target, value);
            for (j, input) in self.study.inputs.iter().enumerate() {
                // A whole gap is the mean of every surface's.
                let whole = target.surface.is_none() && input.target.parameter == target.parameter;
                if whole || input.target == target {
                    let changed = marginals.iter().position(|(k, _)| *k == j);
                    let law = changed.map_or(&input.marginal, |at| &marginals[at].1);
                    let moved = law.with_shifted_mean(value - law.law().anchor())?;
                    marginals.retain(|(k, _)| *k != j);
                    marginals.push((j, moved));
                }
            }
        }
        for (j, marginal) in &marginals {
            inputs.column_mut(*j).copy_from_slice(&self.column(marginal, *j));
        }
        if !change.known.is_empty() {
            self.condition(&change.known, &marginals, &mut inputs)?;
        }
        Ok(Ensemble::new(&study).at_inputs(&inputs, progress))
    }

    /// Gives every row the known values, and the inputs that depend on them their laws given those.
    fn condition(
        &self,
        known: &[(usize, f64)],
        marginals: &[(usize, Marginal)],
        inputs: &mut Columns,
    ) -> Result<()> {
        let law = |j: usize| {
            let changed = marginals.iter().find(|(k, _)| *k == j);
            changed.map_or(&self.study.inputs[j].marginal, |(_, marginal)| marginal)
        };
        if let Some(copula) = self.study.joint.copula() {
            let given: Vec<usize> = known.iter().map(|(j, _)| *j).collect();
            let targets: Vec<f64> =
                known.iter().map(|&(j, value)| law(j).to_standard_normal(value)).collect();
            if targets.iter().any(|z| !z.is_finite()) {
                return Err(Error::argument("a known value lies outside its law's support"));
            }
            let conditioning = Conditioning::new(self.rows_of_correlation(copula), &given)?;
            let mut points = self.points.clone();
            for k in 0..points.rows() {
                conditioning.apply(&mut points, k, &targets);
            }
            for j in (0..points.columns()).filter(|&j| self.is_alone(j)) {
                law(j).from_standard_normal_column(points.column(j), inputs.column_mut(j));
            }
        }
        for &(j, value) in known {
            inputs.column_mut(j).fill(value);
        }
        Ok(())
    }

    /// Whether input `j` is not drawn together with others.
    fn is_alone(&self, j: usize) -> bool {
        self.study.joint.sample_of(j).is_none()
    }

    fn rows_of_correlation(&self, copula: &crate::uncertainty::Copula) -> Vec<Vec<f64>> {
        let n = copula.dimension();
        let row = |i| (0..n).map(|j| copula.normal_correlation(i, j)).collect();
        (0..n).map(row).collect()
    }

    /// Draws in which row `k` keeps the inputs `given` of row `of(k)` of this sample and takes the others
    /// from `others`' row `k`, by their laws given those. Inputs that are drawn together are given together.
    ///
    /// # Errors
    /// If the copula cannot be conditioned so, or some of the inputs drawn together are given and others not.
    pub fn mixed(
        &self,
        given: &[usize],
        of: impl Fn(usize) -> usize,
        others: &CommonSample<'_>,
    ) -> Result<Columns> {
        for sample in self.study.joint.samples() {
            let count = sample.inputs().iter().filter(|j| given.contains(j)).count();
            if count != 0 && count != sample.inputs().len() {
                let reason = "inputs that are drawn together cannot be given apart";
                return Err(Error::argument(reason));
            }
        }
        let mut inputs = others.inputs.clone();
        if let Some(copula) = self.study.joint.copula() {
            let conditioning = Conditioning::new(self.rows_of_correlation(copula), given)?;
            let mut points = others.points.clone();
            for k in 0..points.rows() {
                let targets: Vec<f64> = given.iter().map(|&j| self.points.get(of(k), j)).collect();
                conditioning.apply(&mut points, k, &targets);
            }
            for j in (0..points.columns()).filter(|&j| self.is_alone(j)) {
                let marginal = &self.study.inputs[j].marginal;
                marginal.from_standard_normal_column(points.column(j), inputs.column_mut(j));
            }
        }
        for &j in given {
            let column = self.inputs.column(j);
            for (k, value) in inputs.column_mut(j).iter_mut().enumerate() {
                *value = column[of(k)];
            }
        }
        Ok(inputs)
    }

    /// The breaches at draws of the study.
    pub fn breaches_at(&self, inputs: &Columns, progress: &Progress) -> Breaches {
        Breaches::of(self.study, &Ensemble::new(self.study).at_inputs(inputs, progress))
    }
}
