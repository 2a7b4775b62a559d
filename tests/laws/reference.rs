//! Reads the reference values that `references/quantiles.py` computed.

use serde_json::Value;

/// The whole reference file.
pub fn values() -> Value {
    serde_json::from_str(include_str!("references/quantiles.json"))
        .expect("the reference file is JSON")
}

/// The number under `key`, NaN where there is none.
pub fn number(row: &Value, key: &str) -> f64 {
    row[key].as_f64().unwrap_or(f64::NAN)
}

/// The list under `key`.
pub fn list<'a>(row: &'a Value, key: &str) -> &'a [Value] {
    row[key].as_array().map_or(&[], Vec::as_slice)
}

/// Collects relative errors and fails at the end with the worst ones.
pub struct Errors {
    name: &'static str,
    tolerance: f64,
    checked: usize,
    worst: (f64, String),
    failures: Vec<String>,
}

impl Errors {
    /// Comparisons under one `name` with one relative `tolerance`.
    pub fn new(name: &'static str, tolerance: f64) -> Self {
        Errors { name, tolerance, checked: 0, worst: (0.0, String::new()), failures: Vec::new() }
    }

    /// Compares `got` with `expected`, the error in units of `scale`; a NaN `expected` is no reference.
    pub fn check_scaled(&mut self, got: f64, expected: f64, scale: f64, what: impl Fn() -> String) {
        if expected.is_nan() {
            return;
        }
        self.checked += 1;
        let error = if got == expected { 0.0 } else { (got - expected).abs() / scale };
        if error.is_nan() || error > self.worst.0 {
            self.worst = (error, what());
        }
        if error.is_nan() || error > self.tolerance {
            self.failures.push(format!("{error:.2e}: {} gives {got:e}, not {expected:e}", what()));
        }
    }

    /// Compares `got` with `expected`, relatively.
    pub fn check(&mut self, got: f64, expected: f64, what: impl Fn() -> String) {
        self.check_scaled(got, expected, expected.abs(), what);
    }

    /// Fails if any comparison did, or if there were fewer than `at_least`.
    pub fn finish(self, at_least: usize) {
        println!(
            "{}: {} values, worst {:.2e} at {}",
            self.name, self.checked, self.worst.0, self.worst.1
        );
        assert!(self.checked >= at_least, "{}: only {} comparisons", self.name, self.checked);
        assert!(
            self.failures.is_empty(),
            "{}: {} of {} beyond {:.0e}\n{}",
            self.name,
            self.failures.len(),
            self.checked,
            self.tolerance,
            self.failures[..self.failures.len().min(30)].join("\n")
        );
    }
}
