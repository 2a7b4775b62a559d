//! An axis in the units shown, and how its ticks are written.

use crate::numerics::elementary::ln;
use crate::render::figures_of_speech::count;
use crate::units::number;
use kuva::prelude::TickFormat;
use std::sync::Arc;

/// An axis in the units shown.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    /// What it shows, with its unit.
    pub label: String,
    /// Its left or lower end.
    pub min: f64,
    /// Its right or upper end.
    pub max: f64,
    scale: Scale,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Scale {
    Linear,
    Counts,
    Shares,
    ShareDecades,
}

impl Axis {
    /// A linear axis.
    pub fn linear(label: impl Into<String>, min: f64, max: f64) -> Self {
        let max = if max > min { max } else { min + min.abs().max(1.0) * 1e-3 };
        Axis { label: label.into(), min, max, scale: Scale::Linear }
    }

    /// A linear axis of probabilities, its ticks in per cent.
    pub fn shares(label: impl Into<String>, min: f64, max: f64) -> Self {
        Axis { scale: Scale::Shares, ..Axis::linear(label, min, max) }
    }

    /// A logarithmic axis of counts.
    pub fn counts(label: impl Into<String>, min: f64, max: f64) -> Self {
        Axis { label: label.into(), min, max: max.max(min * 10.0), scale: Scale::Counts }
    }

    /// A logarithmic axis of probabilities.
    pub fn share_decades(label: impl Into<String>, min: f64, max: f64) -> Self {
        Axis { label: label.into(), min, max, scale: Scale::ShareDecades }
    }

    /// Whether it is logarithmic.
    pub fn is_logarithmic(&self) -> bool {
        matches!(self.scale, Scale::Counts | Scale::ShareDecades)
    }

    /// The widest tick of a logarithmic axis of probabilities, which is the lowest; nothing for others.
    pub fn widest_decade(&self) -> String {
        if self.scale != Scale::ShareDecades || self.min <= 0.0 {
            return String::new();
        }
        let lowest = std::iter::successors(Some(1.0), |decade: &f64| Some(decade / 10.0))
            .take_while(|decade| *decade > 0.999 * self.min && *decade > 0.9e-5)
            .last();
        format!("{} %", number(100.0 * lowest.unwrap_or(1.0), 3))
    }

    /// What a tick at its right end says.
    pub fn last_tick(&self) -> String {
        match self.format() {
            TickFormat::Custom(write) => write(self.max),
            _ => String::new(),
        }
    }

    /// How its ticks are written.
    pub fn format(&self) -> TickFormat {
        match self.scale {
            Scale::Linear => TickFormat::Custom(Arc::new(|v| grouped(&number(v, 6)))),
            // Large numbers are wide: of 1, 2, 5 only the decades are labelled.
            Scale::Counts => TickFormat::Custom(Arc::new(|v| match number(v, 3) {
                digits if v >= 10_000.0 && !digits.starts_with('1') => String::new(),
                digits => grouped(&digits),
            })),
            Scale::Shares => {
                TickFormat::Custom(Arc::new(|v| format!("{} %", number(100.0 * v, 4))))
            }
            Scale::ShareDecades => TickFormat::Custom(Arc::new(|v| match v {
                v if v < 0.9e-5 => format!("1e{:.0}", ln(v) / std::f64::consts::LN_10),
                v => format!("{} %", number(100.0 * v, 3)),
            })),
        }
    }
}

/// 20000 as "20 000".
fn grouped(digits: &str) -> String {
    match digits.parse::<u64>() {
        Ok(whole) if whole >= 10_000 => count(whole),
        _ => digits.replace('-', "−"),
    }
}
