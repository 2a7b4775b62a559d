//! The numbers behind the figures against the counts of the campaign.

use crate::sample::{independent, replicated};
use reeldown::findings::EventKind;

#[test]
fn property_histograms_hold_every_sample_and_break_at_the_limit() {
    for sample in [independent(), replicated()] {
        let limits = sample.findings.probabilities.iter().filter(|p| p.kind == EventKind::Limit);
        let data = &sample.findings.figures.distributions;
        assert_eq!(data.len(), limits.clone().count());
        for (distribution, limit) in data.iter().zip(limits) {
            let drawn: u64 = distribution.counts.iter().sum();
            let (below, above) = distribution.outside;
            assert_eq!(drawn + below + above, distribution.samples);
            assert_eq!(distribution.edges.len(), distribution.counts.len() + 1);
            assert!(distribution.edges.windows(2).all(|pair| pair[0] < pair[1]));
            // All limits of the default study are upper ones: a bin breaches if its middle does.
            let breaching = distribution
                .edges
                .windows(2)
                .zip(&distribution.counts)
                .filter(|(ends, _)| 0.5 * (ends[0] + ends[1]) > distribution.limit_value)
                .map(|(_, count)| count)
                .sum::<u64>();
            let beyond = if distribution.limit_value < *distribution.edges.last().unwrap() {
                above
            } else {
                above.min(limit.counts.breaches)
            };
            assert_eq!(breaching + beyond, limit.counts.breaches, "{}", distribution.limit);
        }
    }
}

#[test]
fn property_the_tail_crosses_the_limit_at_the_breach_probability() {
    let findings = &independent().findings;
    for distribution in &findings.figures.distributions {
        let at_limit =
            distribution.exceedance.iter().find(|e| e.value == distribution.limit_value).unwrap();
        let event = findings
            .probabilities
            .iter()
            .find(|p| p.kind == EventKind::Limit && p.limits[0] == distribution.limit)
            .unwrap();
        assert_eq!(Some(at_limit.share), event.probability);
        let interval = event.interval.interval().unwrap();
        assert_eq!(at_limit.interval, Some((interval.lower, interval.upper)));
        let shares: Vec<f64> = distribution.exceedance.iter().map(|e| e.share).collect();
        assert!(shares.windows(2).all(|pair| pair[0] >= pair[1]));
    }
}

#[test]
fn property_convergence_ends_with_the_estimate_of_the_report() {
    for sample in [independent(), replicated()] {
        let any = sample.findings.probabilities.iter().find(|p| p.kind == EventKind::Any).unwrap();
        let convergence = sample.findings.figures.convergence.as_ref().unwrap();
        let last = convergence.checkpoints.last().unwrap();
        assert_eq!(last.samples, any.counts.samples);
        assert_eq!(Some(last.probability), any.probability);
        let interval = any.interval.interval().unwrap();
        assert_eq!(last.interval, Some((interval.lower, interval.upper)));
    }
}

#[test]
fn property_a_replicated_design_has_no_band_it_has_not_earned() {
    for distribution in &replicated().findings.figures.distributions {
        assert!(distribution.exceedance.iter().all(|e| e.interval.is_none()));
        assert_eq!(distribution.simultaneous_half_width, None);
        assert!(distribution.why_no_interval.is_some());
    }
}

#[test]
fn analytic_the_whole_curve_s_band_has_massart_s_half_width() {
    // sqrt(ln(2/0.05)/(2·600)) = 0.0554443…: ln 40 = 3.688879454113936.
    let distribution = &independent().findings.figures.distributions[0];
    let expected = (3.688_879_454_113_936_f64 / 1200.0).sqrt();
    let found = distribution.simultaneous_half_width.unwrap();
    // A few roundings of a logarithm, a quotient and a root.
    assert!((found - expected).abs() < 1e-15, "{found} {expected}");
}

#[test]
fn property_the_scatter_shows_the_samples_that_breached() {
    let sample = independent();
    let shown = sample.findings.figures.interaction.as_ref().unwrap();
    let limits = sample.findings.margins.len();
    let breached: Vec<bool> = (0..shown.breached.len())
        .map(|k| (0..limits).any(|i| sample.sampling.record.margins(i)[k] < 0.0))
        .collect();
    assert_eq!(shown.added, 0);
    assert_eq!(shown.breached, breached);
    assert_eq!(shown.x.values.len(), breached.len());
    assert_ne!(shown.x.path, shown.y.path);
    assert!(replicated().findings.figures.interaction.is_err());
}

#[test]
fn property_bands_are_nested_and_line_is_never_taken_back() {
    let fan = &independent().findings.figures.fan;
    assert_eq!((fan.trajectories, fan.not_deployed), (300, 0));
    for band in [&fan.line_over_time, &fan.fluid_temperature_over_line, &fan.velocity_over_line] {
        for quantiles in band.quantiles.iter().map(|q| q.unwrap()) {
            assert!(quantiles.windows(2).all(|pair| pair[0] <= pair[1]));
        }
    }
    let medians: Vec<f64> =
        fan.line_over_time.quantiles.iter().map(|quantiles| quantiles.unwrap()[2]).collect();
    assert!(medians.windows(2).all(|pair| pair[0] <= pair[1]));
}
