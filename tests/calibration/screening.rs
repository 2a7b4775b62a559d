//! Readings with mistakes put in, and the mistakes found.

use reeldown::calibration::screening::{Suspicion, screen, suspect_factor, suspect_scale};

fn times(count: usize) -> Vec<f64> {
    (0..count).map(|k| k as f64).collect()
}

/// A ramp and a plateau with noise: nothing to find.
fn clean(count: usize) -> Vec<f64> {
    times(count).iter().map(|t| (t / 3.0).min(1.0) * 5.0 + 0.05 * (37.0 * t).sin()).collect()
}

#[test]
fn property_clean_readings_raise_no_suspicion() {
    assert_eq!(screen(&times(120), &clean(120)), []);
}

#[test]
fn property_a_spike_a_gap_and_a_stop_are_found_where_they_are() {
    let mut values = clean(120);
    values[40] += 3.0;
    let found = screen(&times(120), &values);
    assert!(
        matches!(found.as_slice(), [Suspicion::Outlier { time_s, .. }] if *time_s == 40.0),
        "{found:?}"
    );
    let mut late = times(120);
    late[60..].iter_mut().for_each(|t| *t += 9.0);
    let found = screen(&late, &clean(120));
    assert!(
        matches!(found.as_slice(), [Suspicion::Gap { from_s, to_s }] if *from_s == 59.0 && *to_s == 69.0),
        "{found:?}"
    );
    let stopped: Vec<f64> = clean(120).into_iter().map(|x| x.min(4.9)).collect();
    let found = screen(&times(120), &stopped);
    assert!(
        !found.is_empty()
            && found.iter().all(|s| matches!(s, Suspicion::Stuck { at_the_stop: true, .. })),
        "{found:?}"
    );
}

#[test]
fn analytic_unit_mistakes_are_named_and_the_card_is_given_its_due() {
    // Eight per cent of spread: twenty per cent off is explained, a factor of 4.448 is not.
    assert_eq!(suspect_factor(1.2, 0.08), None);
    let lbf = suspect_factor(4.448 * 1.05, 0.08);
    assert!(matches!(lbf, Some(Suspicion::Unit { factor, .. }) if (factor - 4.448).abs() < 0.01));
    assert!(matches!(suspect_factor(2.7, 0.05), Some(Suspicion::Implausible { .. })));
    assert_eq!(suspect_scale(350.0, 352.0, 4.0), None);
    // 80 °C read as 80 °F is 299.8 K where 353.15 K is predicted.
    let celsius = suspect_scale(299.8, 353.15, 4.0);
    assert!(
        matches!(celsius, Some(Suspicion::Unit { mistake: "°C called °F", .. })),
        "{celsius:?}"
    );
}
