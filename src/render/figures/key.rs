//! The key above a panel: how wide labels are, and where they go.

use super::chart::TICK_SIZE;

/// Width of a swatch.
pub(super) const SWATCH: f64 = 18.0;

/// How a key's swatch looks.
#[derive(Debug, Clone)]
pub(super) enum Swatch {
    Area(&'static str, f64),
    Line(&'static str, bool),
    Dot(&'static str),
}

/// The width of a label, a little more than it is in the widest of the fonts asked for; kuva's own metrics
/// are not public.
pub(super) fn text_width(text: &str) -> f64 {
    let em = |c: char| match c {
        'i' | 'j' | 'l' | 't' | 'f' | 'r' | '.' | ',' | ':' | ' ' | '(' | ')' | '/' => 0.41,
        'm' | 'w' | 'M' | 'W' | '%' => 0.97,
        'A'..='Z' => 0.72,
        _ => 0.64,
    };
    f64::from(TICK_SIZE) * text.chars().map(em).sum::<f64>()
}

/// Keys from left to right, wrapped: for each row, the place and index of its members.
pub(super) fn key_rows(keys: &[(Swatch, String)], width: f64) -> Vec<Vec<(f64, usize)>> {
    let mut rows: Vec<Vec<(f64, usize)>> = Vec::new();
    let mut x = f64::INFINITY;
    for (k, (_, label)) in keys.iter().enumerate() {
        let wide = SWATCH + 6.0 + text_width(label);
        if x + wide > width {
            rows.push(Vec::new());
            x = 0.0;
        }
        if let Some(row) = rows.last_mut() {
            row.push((x, k));
        }
        x += wide + 18.0;
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::figures::chart::BLUE;

    #[test]
    fn property_keys_wrap_inside_the_width() {
        let keys: Vec<_> =
            (0..7).map(|k| (Swatch::Dot(BLUE), format!("a key, number {k}"))).collect();
        let rows = key_rows(&keys, 400.0);
        assert!(rows.len() > 1);
        assert_eq!(rows.iter().map(Vec::len).sum::<usize>(), keys.len());
        for (x, k) in rows.into_iter().flatten() {
            assert!(x + SWATCH + 6.0 + text_width(&keys[k].1) <= 400.0);
        }
    }
}
