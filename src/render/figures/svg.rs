//! What kuva's SVG lacks: a view box, a role, a name, and short numbers.

/// The SVG with a view box, so that it scales, a role and a name; and no digits below a hundredth of a
/// pixel, which are rounding.
pub(super) fn accessible(
    svg: &str,
    name: &str,
    (width, height): (f64, f64),
    title: &str,
    description: &str,
) -> String {
    let (open, body) = svg.split_once('>').unwrap_or((svg, ""));
    format!(
        "{open} viewBox=\"0 0 {width} {height}\" role=\"img\" aria-labelledby=\"{name}-title {name}-desc\">\
         <title id=\"{name}-title\">{}</title><desc id=\"{name}-desc\">{}</desc>{}\n",
        escaped(title),
        escaped(description),
        short_numbers(body)
    )
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Inside tags, numbers with more than four decimals lose all but two.
fn short_numbers(svg: &str) -> String {
    let mut short = String::with_capacity(svg.len());
    let mut inside = false;
    let mut decimals: Option<String> = None;
    for c in svg.chars() {
        match (&mut decimals, c) {
            (Some(digits), '0'..='9') => {
                digits.push(c);
                continue;
            }
            (Some(digits), _) => {
                let kept = if digits.len() > 4 { &digits[..2] } else { digits };
                short.push_str(kept);
                decimals = None;
            }
            (None, _) => {}
        }
        match c {
            '<' => inside = true,
            '>' => inside = false,
            '.' if inside => decimals = Some(String::new()),
            _ => {}
        }
        short.push(c);
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_rounding_noise_goes_and_text_stays() {
        let svg = "<line x1=\"210.73000000000002\" y=\"1.25\"/><text>0.000012345</text>";
        let short = "<line x1=\"210.73\" y=\"1.25\"/><text>0.000012345</text>";
        assert_eq!(short_numbers(svg), short);
    }
}
