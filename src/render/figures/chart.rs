//! One panel: axes, marks, labelled limits and a key above, on kuva's scene.

use super::axis::Axis;
use super::key::{SWATCH, Swatch, key_rows, text_width};
use super::svg::accessible;
use kuva::backend::svg::SvgBackend;
use kuva::prelude::{Layout, Theme};
use kuva::render::axis::{add_axes_and_grid, add_labels_and_title};
use kuva::render::color::Color;
use kuva::render::layout::ComputedLayout;
use kuva::render::render::{PathData, Primitive, Scene, TextAnchor};

/// Okabe and Ito's blue: what keeps the limits, and anything without a verdict.
pub(super) const BLUE: &str = "#0072b2";
/// Okabe and Ito's vermillion: what breaches a limit.
pub(super) const VERMILLION: &str = "#d55e00";
/// Okabe and Ito's bluish green: demonstrated to be allowed.
pub(super) const GREEN: &str = "#009e73";
/// Okabe and Ito's orange: undecided.
pub(super) const ORANGE: &str = "#e69f00";
/// Colours of curves side by side, darkest first; every other curve is dashed too.
pub(super) const PALETTE: [&str; 5] = [BLUE, VERMILLION, GREEN, "#cc79a7", ORANGE];
/// Text, limits, the nominal descent. The style sheet of the HTML report names these four greys, to
/// replace them on a dark page.
pub(super) const INK: &str = "#1a1a1a";
const AXIS: &str = "#4d4d4d";
const GRID: &str = "#dddddd";
const CARD: &str = "#ffffff";

/// Width of a figure; height is each figure's own. At a phone's 340 px the ticks are still 8.5 px.
pub(super) const WIDTH: f64 = 520.0;
/// Usual height.
pub(super) const HEIGHT: f64 = 330.0;
pub(super) const TICK_SIZE: u32 = 13;
const LABEL_SIZE: u32 = 14;
const ROW: f64 = 19.0;

/// A panel being drawn.
pub(super) struct Chart {
    name: String,
    computed: ComputedLayout,
    scene: Scene,
    limits: Vec<(f64, String)>,
    header: f64,
    keys: Vec<(Swatch, String)>,
    clipped: bool,
}

impl Chart {
    /// An empty panel. `keys` and whether there will be limits across it decide the room above.
    pub fn new(
        name: &str,
        height: f64,
        x: &Axis,
        y: &Axis,
        keys: Vec<(Swatch, String)>,
        vertical_limits: bool,
    ) -> Self {
        Self::with_rows(name, height, x, y, keys, vertical_limits, None)
    }

    /// As [`Chart::new`], with a named row at each whole number of y instead of numbers.
    pub fn with_rows(
        name: &str,
        height: f64,
        x: &Axis,
        y: &Axis,
        keys: Vec<(Swatch, String)>,
        vertical_limits: bool,
        rows: Option<Vec<String>>,
    ) -> Self {
        let theme = Theme {
            background: CARD.to_owned(),
            axis_color: AXIS.to_owned(),
            grid_color: GRID.to_owned(),
            tick_color: AXIS.to_owned(),
            text_color: INK.to_owned(),
            ..Theme::light()
        };
        let mut layout = Layout::new((x.min, x.max), (y.min, y.max))
            .with_width(WIDTH)
            .with_height(height)
            .with_clamp_axis()
            .with_x_axis_min(x.min)
            .with_x_axis_max(x.max)
            .with_y_axis_min(y.min)
            .with_y_axis_max(y.max)
            .with_ticks(5)
            .with_x_label(x.label.clone())
            .with_tick_size(TICK_SIZE)
            .with_label_size(LABEL_SIZE)
            .with_x_tick_format(x.format())
            .with_y_tick_format(y.format())
            .with_theme(theme);
        if !y.label.is_empty() {
            layout = layout.with_y_label(y.label.clone());
        }
        if x.is_logarithmic() {
            layout = layout.with_log_x();
        }
        if y.is_logarithmic() {
            layout = layout.with_log_y();
        }
        if let Some(rows) = rows {
            layout = layout.with_y_categories(rows);
        }
        let mut computed = ComputedLayout::from_layout(&layout);
        // kuva takes the width of the ticks on a logarithmic axis for that of its ends.
        let wider = (text_width(&y.widest_decade()) - computed.y_tick_label_px).max(0.0);
        computed.y_tick_label_px += wider;
        computed.margin_left += wider;
        if !y.label.is_empty() {
            let beside = computed.y_tick_label_px + 16.0 + 1.5 * f64::from(LABEL_SIZE);
            computed.margin_left = computed.margin_left.max(beside);
        }
        let lines = key_rows(&keys, WIDTH - 16.0).len() as f64;
        let header = 6.0 + lines * ROW;
        computed.margin_top = header + if vertical_limits { ROW + 4.0 } else { 6.0 };
        // The last tick's label is centred on the axis's end.
        computed.margin_right =
            computed.margin_right.max(0.5 * text_width(&x.last_tick()) + 4.0).max(22.0);
        computed.recompute_transforms();
        let mut scene = Scene::new(WIDTH, height);
        scene.background_color = Some(CARD.to_owned());
        scene.text_color = Some(INK.to_owned());
        scene.font_family = Some("DejaVu Sans, Verdana, Arial, sans-serif".to_owned());
        add_axes_and_grid(&mut scene, &computed, &layout);
        add_labels_and_title(&mut scene, &computed, &layout);
        let mut chart = Chart {
            name: name.to_owned(),
            computed,
            scene,
            limits: Vec::new(),
            header,
            keys,
            clipped: false,
        };
        chart.clip();
        chart
    }

    fn add(&mut self, primitive: Primitive) {
        self.scene.elements.push(primitive);
    }

    fn clip(&mut self) {
        let c = &self.computed;
        let (x, y) = (c.margin_left, c.margin_top);
        let (width, height) = (c.plot_width(), c.plot_height());
        let id = format!("{}-plot", self.name);
        // The writer opens the clipped group but leaves its path to whoever asks for it.
        self.scene.defs.push(format!(
            "<clipPath id=\"{id}\"><rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" \
             height=\"{height:.2}\"/></clipPath>"
        ));
        self.add(Primitive::ClipStart { x, y, width, height, id });
        self.clipped = true;
    }

    fn unclip(&mut self) {
        if std::mem::take(&mut self.clipped) {
            self.add(Primitive::ClipEnd);
        }
    }

    fn place(&self, x: f64, y: f64) -> (f64, f64) {
        (self.computed.map_x(x), self.computed.map_y(y))
    }

    /// A box between two corners; `hover` is shown under the pointer.
    pub fn bar(
        &mut self,
        from: (f64, f64),
        to: (f64, f64),
        fill: &str,
        opacity: f64,
        hover: String,
    ) {
        let (x0, y0) = self.place(from.0, from.1);
        let (x1, y1) = self.place(to.0, to.1);
        self.add(Primitive::GroupStart { transform: None, title: Some(hover), extra_attrs: None });
        self.add(Primitive::Rect {
            x: x0.min(x1),
            y: y0.min(y1),
            width: (x1 - x0).abs(),
            height: (y1 - y0).abs(),
            fill: Color::from(fill),
            stroke: None,
            stroke_width: None,
            opacity: Some(opacity),
        });
        self.add(Primitive::GroupEnd);
    }

    /// The area between two curves over the same abscissae: (x, lower, upper).
    pub fn band(&mut self, points: &[(f64, f64, f64)], fill: &str, opacity: f64) {
        if points.len() < 2 {
            return;
        }
        let there = points.iter().map(|&(x, lower, _)| self.place(x, lower));
        let back = points.iter().rev().map(|&(x, _, upper)| self.place(x, upper));
        let mut d = String::new();
        for (k, (x, y)) in there.chain(back).enumerate() {
            d += &format!("{}{x:.2} {y:.2}", if k == 0 { "M" } else { "L" });
        }
        self.add(Primitive::Path(Box::new(PathData {
            d: d + "Z",
            fill: Some(Color::from(fill)),
            stroke: Color::None,
            stroke_width: 0.0,
            opacity: Some(opacity),
            stroke_dasharray: None,
        })));
    }

    /// A curve.
    pub fn line(&mut self, points: &[(f64, f64)], stroke: &str, width: f64, dashed: bool) {
        if points.len() < 2 {
            return;
        }
        let points = points.iter().map(|&(x, y)| self.place(x, y)).collect();
        self.add(Primitive::PolyLine {
            points,
            stroke: Color::from(stroke),
            stroke_width: width,
            stroke_dasharray: dashed.then(|| "6 4".to_owned()),
        });
    }

    /// Closed polygons filled as one, so that those that share an edge show no seam.
    pub fn region(&mut self, polygons: &[Vec<(f64, f64)>], fill: &str) {
        let path = |polygon: &Vec<(f64, f64)>| self.path(polygon) + "Z";
        let d: String = polygons.iter().map(path).collect();
        self.path_of(d, Color::from(fill), Color::None, 0.0);
    }

    /// Many short lines as one curve, such as a contour.
    pub fn contour(&mut self, segments: &[[(f64, f64); 2]], stroke: &str, width: f64) {
        let d: String = segments.iter().map(|segment| self.path(segment)).collect();
        self.path_of(d, Color::None, Color::from(stroke), width);
    }

    fn path(&self, points: &[(f64, f64)]) -> String {
        let mut d = String::new();
        for (k, &(x, y)) in points.iter().enumerate() {
            let (x, y) = self.place(x, y);
            d += &format!("{}{x:.2} {y:.2}", if k == 0 { "M" } else { "L" });
        }
        d
    }

    fn path_of(&mut self, d: String, fill: Color, stroke: Color, stroke_width: f64) {
        if d.is_empty() {
            return;
        }
        self.add(Primitive::Path(Box::new(PathData {
            d,
            fill: Some(fill),
            stroke,
            stroke_width,
            opacity: None,
            stroke_dasharray: None,
        })));
    }

    /// A short text centred at a point of the panel, kept inside it.
    pub fn note(&mut self, (x, y): (f64, f64), content: &str) {
        let (x, y) = self.place(x, y);
        let (c, half) = (&self.computed, text_width(content) / 2.0 + 3.0);
        let (left, right) = (c.margin_left + half, c.width - c.margin_right - half);
        let (top, bottom) = (c.margin_top + 14.0, c.height - c.margin_bottom - 5.0);
        let (x, y) = (x.clamp(left, right.max(left)), (y + 4.5).clamp(top, bottom.max(top)));
        self.text(x, y, content.to_owned(), TextAnchor::Middle);
    }

    /// Dots.
    pub fn dots(&mut self, points: &[(f64, f64)], fill: &str, radius: f64, opacity: f64) {
        let (cx, cy) = points.iter().map(|&(x, y)| self.place(x, y)).unzip();
        self.add(Primitive::CircleBatch {
            cx,
            cy,
            r: radius,
            fill: Color::from(fill),
            fill_opacity: Some(opacity),
            stroke: None,
            stroke_width: None,
        });
    }

    /// A dashed line across the panel at x, its label above the panel.
    pub fn vertical_limit(&mut self, x: f64, label: String) {
        let c = &self.computed;
        let (at, top, bottom) = (c.map_x(x), c.margin_top, c.height - c.margin_bottom);
        self.dashed(at, top - 4.0, at, bottom);
        self.limits.push((at, label));
    }

    /// A dashed line at y from this share of the panel's width on; its name is a key.
    pub fn unnamed_limit(&mut self, y: f64, from: f64) {
        let c = &self.computed;
        let (left, right, at) = (c.margin_left, c.width - c.margin_right, c.map_y(y));
        self.dashed(left + from * (right - left), at, right, at);
    }

    /// A dashed line along the panel at y, labelled at its end.
    pub fn horizontal_limit(&mut self, y: f64, label: &str) {
        let c = &self.computed;
        let (left, right) = (c.margin_left, c.width - c.margin_right);
        let (at, top) = (c.map_y(y), c.margin_top);
        self.dashed(left, at, right, at);
        let y = if at - top < ROW { at + 15.0 } else { at - 5.0 };
        self.text(right - 5.0, y, label.to_owned(), TextAnchor::End);
    }

    fn dashed(&mut self, x1: f64, y1: f64, x2: f64, y2: f64) {
        self.unclip();
        self.add(Primitive::Line {
            x1,
            y1,
            x2,
            y2,
            stroke: Color::from(INK),
            stroke_width: 1.5,
            stroke_dasharray: Some("6 4".to_owned()),
        });
    }

    fn text(&mut self, x: f64, y: f64, content: String, anchor: TextAnchor) {
        self.unclip();
        self.add(Primitive::Text {
            x,
            y,
            content,
            size: TICK_SIZE,
            anchor,
            rotate: None,
            bold: false,
            color: None,
        });
    }

    /// The finished SVG, with its accessible name and description.
    pub fn svg(mut self, title: &str, description: &str) -> String {
        self.unclip();
        let baseline = self.header + ROW - 4.0;
        for (x, label) in std::mem::take(&mut self.limits) {
            let half = text_width(&label) / 2.0;
            let x = x.clamp(half + 4.0, WIDTH - half - 4.0);
            self.text(x, baseline, label, TextAnchor::Middle);
        }
        self.draw_keys();
        let drawn = SvgBackend::new().render_scene(&self.scene);
        accessible(&drawn, &self.name, (WIDTH, self.scene.height), title, description)
    }

    fn draw_keys(&mut self) {
        let keys = std::mem::take(&mut self.keys);
        for (row, members) in key_rows(&keys, WIDTH - 16.0).into_iter().enumerate() {
            let middle = 6.0 + (row as f64 + 0.5) * ROW;
            for (x, k) in members {
                let (swatch, label) = &keys[k];
                self.draw_swatch(swatch, x + 8.0, middle);
                let text_x = x + 8.0 + SWATCH + 6.0;
                self.text(text_x, middle + 4.5, label.clone(), TextAnchor::Start);
            }
        }
    }

    fn draw_swatch(&mut self, swatch: &Swatch, x: f64, middle: f64) {
        let primitive = match *swatch {
            Swatch::Area(fill, opacity) => Primitive::Rect {
                x,
                y: middle - 6.0,
                width: SWATCH,
                height: 12.0,
                fill: Color::from(fill),
                stroke: None,
                stroke_width: None,
                opacity: Some(opacity),
            },
            Swatch::Line(stroke, dashed) => Primitive::Line {
                x1: x,
                y1: middle,
                x2: x + SWATCH,
                y2: middle,
                stroke: Color::from(stroke),
                stroke_width: 2.0,
                stroke_dasharray: dashed.then(|| "6 4".to_owned()),
            },
            Swatch::Dot(fill) => Primitive::Circle {
                cx: x + SWATCH / 2.0,
                cy: middle,
                r: 4.5,
                fill: Color::from(fill),
                fill_opacity: None,
                stroke: None,
                stroke_width: None,
            },
        };
        self.add(primitive);
    }
}
