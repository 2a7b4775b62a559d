//! A report that is composed as Markdown, as one HTML page: the same words, tables and figures, laid out like the report
//! of a run. It asks the network for nothing: style, script and figures are inside, and its content security policy
//! forbids the rest.

use super::figures::Figure;
use super::html::{SCRIPT, STYLE};
use crate::error::{Error, Result};
use minijinja::Environment;
use pulldown_cmark::{Alignment, Event, HeadingLevel, Options, Parser, Tag, TagEnd, html};
use serde::Serialize;

const TEMPLATE: &str = include_str!("../../reports/templates/page.html");

/// How the answer at the head of a page is marked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// What was required is met, or what was tested passed.
    Met,
    /// It is not met.
    NotMet,
    /// It is undecided, or in doubt.
    Undecided,
    /// There is nothing to be met.
    None,
}

impl Mark {
    /// The class of the style sheet.
    fn class(self) -> &'static str {
        match self {
            Mark::Met => "met",
            Mark::NotMet => "not-met",
            Mark::Undecided => "undecided",
            Mark::None => "none",
        }
    }
}

/// A heading to jump to.
#[derive(Debug, Serialize)]
struct Entry {
    title: String,
    anchor: String,
}

#[derive(Serialize)]
struct Page<'a> {
    title: &'a str,
    kind: &'a str,
    class: &'static str,
    lead: &'a str,
    body: &'a str,
    contents: &'a [Entry],
    style: &'static str,
    script: &'static str,
    version: &'static str,
}

/// The page of a Markdown report whose figures are `figures`; `kind` stands above its title.
///
/// What stands before the first table or second-level heading is the answer, which `mark` marks. HTML in the Markdown is shown as
/// text, and links lead to the page's own headings only.
///
/// # Errors
/// If the template is at fault: a mistake of this program's, which its tests would have shown.
pub fn page(kind: &str, mark: Mark, markdown: &str, figures: &[Figure]) -> Result<String> {
    let mut layout = Layout { figures, ..Layout::default() };
    for event in Parser::new_ext(markdown, Options::ENABLE_TABLES) {
        layout.take(event);
    }
    layout.end_section();
    let broken = |reason: minijinja::Error| {
        Error::argument(format!("the page's template cannot be filled in: {reason:#}"))
    };
    let mut environment = Environment::new();
    environment.add_template("page.html", TEMPLATE).map_err(broken)?;
    let filled = Page {
        title: &layout.title,
        kind,
        class: mark.class(),
        lead: &layout.lead,
        body: &layout.body,
        contents: &layout.contents,
        style: STYLE,
        script: SCRIPT,
        version: env!("CARGO_PKG_VERSION"),
    };
    environment
        .get_template("page.html")
        .and_then(|template| template.render(minijinja::value::Serde(filled)))
        .map_err(broken)
}

/// The anchor that forges give a heading: lower case, blanks as hyphens, other marks dropped.
pub(super) fn anchor(title: &str) -> String {
    let kept = title.to_lowercase();
    kept.chars()
        .filter(|c| c.is_alphanumeric() || *c == ' ' || *c == '-')
        .map(|c| if c == ' ' { '-' } else { c })
        .collect()
}

/// The page as far as it is laid out.
#[derive(Default)]
struct Layout<'a> {
    figures: &'a [Figure],
    title: String,
    lead: String,
    body: String,
    contents: Vec<Entry>,
    /// Whether the answer is over.
    begun: bool,
    /// Whether a section is open.
    inside: bool,
    /// Events of the paragraph, heading or cell that is being read.
    held: Vec<Event<'a>>,
    /// The heading above, which names the tables below it.
    heading: String,
    alignments: Vec<Alignment>,
    column: usize,
    in_head: bool,
}

impl<'a> Layout<'a> {
    fn out(&mut self) -> &mut String {
        if self.begun { &mut self.body } else { &mut self.lead }
    }

    fn put(&mut self, text: &str) {
        self.out().push_str(text);
    }

    /// What is held, as HTML.
    fn held_html(&mut self) -> String {
        let mut text = String::new();
        html::push_html(&mut text, self.held.drain(..));
        // A number does not part from its sign at a line's end.
        text.replace(" %", "\u{a0}%")
    }

    /// What is held, as plain text.
    fn held_text(&self) -> String {
        let plain = self.held.iter().filter_map(|event| match event {
            Event::Text(text) | Event::Code(text) => Some(text.as_ref()),
            Event::SoftBreak => Some(" "),
            _ => None,
        });
        plain.collect()
    }

    fn take(&mut self, event: Event<'a>) {
        match event {
            Event::Start(Tag::Heading { .. } | Tag::TableCell) => self.held.clear(),
            Event::End(TagEnd::Heading(level)) => self.heading(level),
            Event::Start(Tag::Table(alignments)) => {
                self.begun = true;
                self.alignments = alignments;
                let label = super::html::prose(&self.heading);
                self.put(&format!(
                    "<div class=\"table\" tabindex=\"0\" role=\"region\" aria-label=\"{label}\">\n<table class=\"sortable\">\n"
                ));
            }
            Event::End(TagEnd::Table) => self.put("</tbody>\n</table>\n</div>\n"),
            Event::Start(Tag::TableHead) => {
                (self.column, self.in_head) = (0, true);
                self.put("<thead><tr>");
            }
            Event::End(TagEnd::TableHead) => {
                self.in_head = false;
                self.put("</tr></thead>\n<tbody>\n");
            }
            Event::Start(Tag::TableRow) => {
                self.column = 0;
                self.put("<tr>");
            }
            Event::End(TagEnd::TableRow) => self.put("</tr>\n"),
            Event::End(TagEnd::TableCell) => self.cell(),
            Event::End(TagEnd::Paragraph) => self.paragraph(),
            Event::Start(Tag::Paragraph) => self.held.clear(),
            Event::Start(Tag::Item) => {
                self.held.clear();
                self.put("<li>");
            }
            Event::End(TagEnd::Item) => {
                let text = self.held_html();
                self.put(&format!("{text}</li>\n"));
            }
            Event::Start(Tag::List(_)) => self.put("<ul>\n"),
            Event::End(TagEnd::List(_)) => self.put("</ul>\n"),
            Event::Start(Tag::CodeBlock(_)) => self.held.clear(),
            Event::End(TagEnd::CodeBlock) => {
                let code = super::html::prose(&self.held_text().replace('`', "'"));
                self.held.clear();
                self.put(&format!("<pre tabindex=\"0\">{code}</pre>\n"));
            }
            // Markup in a text is a text; a link that leads away is none.
            Event::Html(text) | Event::InlineHtml(text) => self.held.push(Event::Text(text)),
            Event::Start(Tag::Link { ref dest_url, .. }) if !dest_url.starts_with('#') => {
                self.held.push(Event::Start(Tag::Emphasis));
            }
            Event::End(TagEnd::Link) if !self.link_is_open() => {
                self.held.push(Event::End(TagEnd::Emphasis));
            }
            other => self.held.push(other),
        }
    }

    fn link_is_open(&self) -> bool {
        let mut open = 0;
        for event in &self.held {
            match event {
                Event::Start(Tag::Link { .. }) => open += 1,
                Event::End(TagEnd::Link) => open -= 1,
                _ => {}
            }
        }
        open > 0
    }

    fn heading(&mut self, level: HeadingLevel) {
        let title = self.held_text();
        if level == HeadingLevel::H1 {
            self.held.clear();
            self.heading.clone_from(&title);
            self.title = title;
            return;
        }
        let text = self.held_html();
        let anchor = self.free_anchor(&title);
        self.begun = true;
        self.heading.clone_from(&title);
        if level == HeadingLevel::H2 {
            self.end_section();
            self.inside = true;
            self.put(&format!("<section id=\"{anchor}\">\n<h2>{text}</h2>\n"));
            self.contents.push(Entry { title, anchor });
        } else {
            self.put(&format!("<h3 id=\"{anchor}\">{text}</h3>\n"));
        }
    }

    /// The anchor of a title that no heading has yet.
    fn free_anchor(&self, title: &str) -> String {
        let wanted = anchor(title);
        let taken = |name: &str| self.body.contains(&format!("id=\"{name}\""));
        let mut tried = wanted.clone();
        let mut k = 1;
        while taken(&tried) || tried == "verdict" {
            tried = format!("{wanted}-{k}");
            k += 1;
        }
        tried
    }

    fn end_section(&mut self) {
        if std::mem::take(&mut self.inside) {
            self.body.push_str("</section>\n");
        }
    }

    fn cell(&mut self) {
        let text = self.held_html();
        let number = match self.alignments.get(self.column) {
            Some(Alignment::Right) => " class=\"number\"",
            _ => "",
        };
        let (tag, scope) = match (self.in_head, self.column) {
            (true, _) => ("th", " scope=\"col\""),
            (false, 0) => ("th", " scope=\"row\""),
            (false, _) => ("td", ""),
        };
        self.column += 1;
        self.put(&format!("<{tag}{scope}{number}>{text}</{tag}>"));
    }

    /// A paragraph, or the figure that it links.
    fn paragraph(&mut self) {
        if let Some(Event::Start(Tag::Image { dest_url, .. })) = self.held.first() {
            let name = dest_url.strip_prefix("figures/").unwrap_or(dest_url).to_owned();
            self.held.clear();
            if let Some(figure) = self.figures.iter().find(|figure| figure.file_name() == name) {
                self.begun = true;
                let svg = figure.svg.clone();
                self.put(&format!("<figure>\n{svg}\n</figure>\n"));
            }
            return;
        }
        let text = self.held_html();
        self.put(&format!("<p>{text}</p>\n"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(markdown: &str) -> String {
        page("A page", Mark::Met, markdown, &[]).unwrap()
    }

    #[test]
    fn analytic_anchors_of_headings() {
        assert_eq!(anchor("Figure 5: brake torque"), "figure-5-brake-torque");
    }

    #[test]
    fn property_the_answer_stands_before_the_first_table_and_sections_are_linked() {
        let text = of(
            "# T\n\nYes, 4 %.\n\n| a | b |\n| --- | ---: |\n| 1 | 2 |\n\n## Why\n\n- `x`\n\n## Why\n\nthis\n",
        );
        assert!(text.contains("id=\"verdict\">\n<p>Yes, 4\u{a0}%.</p>\n</div>"), "{text}");
        assert!(text.contains("<th scope=\"row\">1</th><td class=\"number\">2</td>"), "{text}");
        assert!(
            text.contains("<a href=\"#why\">Why</a>") && text.contains("id=\"why-1\""),
            "{text}"
        );
        assert!(text.contains("<li><code>x</code></li>"), "{text}");
    }

    #[test]
    fn property_no_text_becomes_markup_or_leads_away() {
        let text =
            of("# <script>a</script>\n\n<b>x</b> [y](javascript:z) [w](#here)\n\n```\n<i>`\n```\n");
        assert!(!text.contains("<script>a") && !text.contains("<b>"), "{text}");
        assert!(!text.contains("javascript:") && !text.contains("<i>"), "{text}");
        assert!(text.contains("<a href=\"#here\">w</a>"), "{text}");
        assert!(text.contains("&lt;i&gt;"), "{text}");
    }
}
