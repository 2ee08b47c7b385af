//! What the colours and signs mean.

use nalgebra::{Point2, Vector2};

use super::figure::{Anchor, Axes, FONT_SIZE, Pixel, Svg, text_width};
use super::panel::Panel;
use super::style::{
    ARRIVED, ATTRACTOR, ATTRACTOR_TRACK, BEFORE, BEHIND_CASING, CLEARANCE, CLEARANCE_END, CORE, DOT, ENTRY, FLOW,
    FLOW_HEAD, LINE_COLOUR, LOST, MARGIN, OVERLAP, REFERENCE, SCAN, SCAN_POINT, SHELL, START, TRACK, demonstration,
    speed_colour,
};
use super::ticks::scale_ticks;

/// The scale of speeds, right of the panels.
pub(super) fn speed_scale(svg: &mut Svg, first: &Axes, bottom: f64, (low, high): (f64, f64)) {
    let colours: Vec<String> = (0..=16).map(|i| speed_colour(f64::from(i) / 16.0)).collect();
    svg.gradient("speed", &colours);
    let height = (bottom - first.corner.y).min(260.0);
    let corner = Point2::new(first.end().x + 14.0, first.corner.y);
    let size = Vector2::new(11.0, height);
    svg.rect(corner, size, r##"fill="url(#speed)" stroke="#3a3f47" stroke-width="0.8""##);
    let mut widest = 0.0f64;
    for t in scale_ticks(low, high, height, 50.0, |_| FONT_SIZE) {
        let y = corner.y + height * (1.0 - (t.value - low) / (high - low));
        let from = Point2::new(corner.x + size.x, y);
        svg.line([from, from + Vector2::new(3.0, 0.0)], r##"stroke="#3a3f47""##);
        svg.text(from + Vector2::new(5.0, 4.2), Anchor::Start, "", &t.label);
        widest = widest.max(text_width(&t.label));
    }
    let at = Point2::new(corner.x + size.x + widest + 16.0, corner.y + height / 2.0);
    svg.text(at, Anchor::Middle, &format!(r#"transform="rotate(-90 {:.2} {:.2})""#, at.x, at.y), "speed (m/s)");
}

/// Is it there, what it means, and the sign.
type Entry<'a> = (bool, String, Box<dyn Fn(&mut Svg, Pixel) + 'a>);

/// Lines of signs with their meaning; the lower end of the last.
pub(super) fn draw(svg: &mut Svg, panels: &[&Panel<'_>], corner: Pixel, right: f64) -> f64 {
    let any = |has: &dyn Fn(&Panel<'_>) -> bool| panels.iter().any(|p| has(p));
    let tail = panels.iter().find_map(|p| p.tail());
    let seconds = tail.unwrap_or_default();
    let colour = if any(&|p| p.has_speeds()) { speed_colour(0.75) } else { LINE_COLOUR.into() };
    let stroke = |width: f64| format!(r#"fill="none" stroke="{colour}" stroke-width="{width}""#);
    let moving = tail.is_some();
    let seen = if any(&|p| p.is_projection()) { " (silhouette)" } else { "" };
    let path = if moving { format!("path, last {seconds:.1} s") } else { "path".into() };
    let flow = if moving { "flow at that time" } else { "flow" };
    let clearance = if moving { "distance to the nearest core" } else { "nearest approach to a core" };
    let paths = any(&|p| p.has_paths());
    let line = panels.iter().map(|p| p.line()).fold(0.0, f64::max);
    let entries: Vec<Entry<'_>> = vec![
        (true, "start".into(), Box::new(|svg, p| svg.circle(p, 4.2, START))),
        (true, "attractor".into(), Box::new(|svg, p| svg.star(p, 7.0, ATTRACTOR))),
        (any(&|p| p.has_aim()), "its way".into(), Box::new(|svg, p| dash(svg, p, ATTRACTOR_TRACK))),
        (moving && any(&|p| p.has_aim()), "arrived".into(), Box::new(|svg, p| svg.circle(p, 3.0, ARRIVED))),
        (moving, "robot".into(), Box::new(|svg, p| svg.circle(p, 3.6, DOT))),
        (paths, path, Box::new(|svg, p| dash(svg, p, &stroke(line)))),
        (moving, "path at other times".into(), Box::new(|svg, p| dash(svg, p, &stroke(1.3)))),
        (
            any(&|p| p.has_demonstrations()),
            "demonstration".into(),
            Box::new(|svg, p| dash(svg, p, &demonstration(line))),
        ),
        (
            any(&|p| p.has_entries()),
            if any(&|p| p.has_ends()) { "ends in a core" } else { "in a core" }.into(),
            Box::new(|svg, p| svg.cross(p, 4.5, ENTRY)),
        ),
        (any(&|p| p.has_lost()), "never arrives".into(), Box::new(|svg, p| svg.square(p, 3.2, LOST))),
        (any(&|p| p.has_reference()), "path without obstacles".into(), Box::new(|svg, p| dash(svg, p, REFERENCE))),
        (
            any(&|p| p.has_hidden()),
            "path behind a core".into(),
            Box::new(|svg, p| {
                patch(svg, p, CORE);
                for x in [-6.0, 0.0, 6.0] {
                    let ends = [-2.0, 2.0].map(|half| p + Vector2::new(x + half, 0.0));
                    svg.line(ends, BEHIND_CASING);
                    svg.line(ends, &stroke(2.4));
                }
            }),
        ),
        (
            any(&|p| p.has_clearances()),
            clearance.into(),
            Box::new(|svg, p| {
                svg.line([-9.0, 7.0].map(|x| p + Vector2::new(x, 0.0)), CLEARANCE);
                svg.circle(p + Vector2::new(7.0, 0.0), 2.2, CLEARANCE_END);
            }),
        ),
        (any(&|p| p.has_cores()), format!("hard core{seen}"), Box::new(|svg, p| patch(svg, p, CORE))),
        (
            any(&|p| p.has_scan()),
            "scan".into(),
            Box::new(|svg, p| {
                svg.circle(p, 6.0, SCAN);
                svg.circle(p, 1.2, SCAN_POINT);
            }),
        ),
        (any(&|p| p.has_margins()), "with margin".into(), Box::new(|svg, p| dash(svg, p, MARGIN))),
        (any(&|p| p.has_shells()), format!("soft layer{seen}"), Box::new(|svg, p| patch(svg, p, SHELL))),
        (
            any(&|p| p.has_overlaps()),
            "overlap of layers".into(),
            Box::new(|svg, p| {
                patch(svg, p, SHELL);
                patch(svg, p, OVERLAP);
            }),
        ),
        (any(&|p| p.has_before()), format!("core {seconds:.1} s before"), Box::new(|svg, p| dash(svg, p, BEFORE))),
        (any(&|p| p.has_tracks()), "way of a core".into(), Box::new(|svg, p| dash(svg, p, TRACK))),
        (
            any(&|p| p.has_flow()),
            flow.into(),
            Box::new(|svg, p| {
                dash(svg, p, FLOW);
                svg.arrowhead(p + Vector2::new(4.0, 0.0), &Vector2::x(), 7.5, FLOW_HEAD);
            }),
        ),
    ];
    let mut at = corner + Vector2::new(0.0, FONT_SIZE);
    for (_, name, sign) in entries.into_iter().filter(|(there, ..)| *there) {
        let width = 26.0 + text_width(&name) + 16.0;
        if at.x + width - 16.0 > right && at.x > corner.x {
            at = Point2::new(corner.x, at.y + FONT_SIZE + 8.0);
        }
        sign(svg, at + Vector2::new(10.0, -4.0));
        svg.text(at + Vector2::new(26.0, 0.0), Anchor::Start, "", &name);
        at.x += width;
    }
    at.y
}

fn patch(svg: &mut Svg, at: Pixel, style: &str) {
    svg.rect(at - Vector2::new(9.0, 5.0), Vector2::new(18.0, 10.0), style);
}

fn dash(svg: &mut Svg, at: Pixel, style: &str) {
    svg.line([at - Vector2::new(10.0, 0.0), at + Vector2::new(10.0, 0.0)], style);
}
