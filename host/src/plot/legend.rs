//! What the colours and signs mean.

use nalgebra::{Point2, Vector2};

use super::figure::{Anchor, Axes, FONT_SIZE, Pixel, Svg, text_width, ticks};
use super::panel::Panel;
use super::style::{
    ATTRACTOR, ATTRACTOR_TRACK, CORE, CUT_CORE, DOT, GHOST, LINE, MARGIN, OVERLAP, SCAN, SCAN_POINT, SHELL, START,
    TRACK, speed_colour,
};

/// The scale of speeds, right of the panels.
pub(super) fn speed_scale(svg: &mut Svg, first: &Axes, last: &Axes, (low, high): (f64, f64)) {
    let colours: Vec<String> = (0..=16).map(|i| speed_colour(f64::from(i) / 16.0)).collect();
    svg.gradient("speed", &colours);
    let height = (last.end().y - first.corner.y).min(260.0);
    let corner = Point2::new(first.end().x + 14.0, first.corner.y);
    let size = Vector2::new(11.0, height);
    svg.rect(corner, size, r##"fill="url(#speed)" stroke="#3a3f47" stroke-width="0.8""##);
    let mut widest = 0.0f64;
    for t in ticks(low, high, height / 50.0) {
        let y = corner.y + height * (1.0 - (t.value - low) / (high - low));
        let from = Point2::new(corner.x + size.x, y);
        svg.line([from, from + Vector2::new(3.0, 0.0)], r##"stroke="#3a3f47""##);
        svg.text(from + Vector2::new(5.0, 4.2), Anchor::Start, "", &t.label);
        widest = widest.max(text_width(&t.label));
    }
    let at = Point2::new(corner.x + size.x + widest + 16.0, corner.y + height / 2.0);
    svg.text(at, Anchor::Middle, &format!(r#"transform="rotate(-90 {:.2} {:.2})""#, at.x, at.y), "speed (m/s)");
}

type Sign = fn(&mut Svg, Pixel);

/// Lines of signs with their meaning; the lower end of the last.
pub(super) fn draw(svg: &mut Svg, panels: &[Panel<'_>], corner: Pixel, right: f64) -> f64 {
    let any = |has: &dyn Fn(&Panel<'_>) -> bool| panels.iter().any(has);
    let entries: [(bool, &str, Sign); 13] = [
        (true, "start", |svg, p| svg.circle(p, 4.2, START)),
        (true, "attractor", |svg, p| svg.star(p, 7.0, ATTRACTOR)),
        (any(&|p| p.has_aim()), "attractor moves", |svg, p| dash(svg, p, ATTRACTOR_TRACK)),
        (any(&|p| p.has_trajectories()), "path", |svg, p| dash(svg, p, LINE)),
        (any(&|p| p.has_cores()), "hard core", |svg, p| patch(svg, p, CORE)),
        (any(&|p| p.has_cut_cores()), "hard core, cut", |svg, p| patch(svg, p, CUT_CORE)),
        (any(&|p| p.has_scan()), "scan", |svg, p| {
            svg.circle(p, 6.0, SCAN);
            svg.circle(p, 1.2, SCAN_POINT);
        }),
        (any(&|p| p.has_margins()), "with margin", |svg, p| dash(svg, p, MARGIN)),
        (any(&|p| p.has_shells()), "soft layer", |svg, p| patch(svg, p, SHELL)),
        (any(&|p| p.has_overlaps()), "overlap of layers", |svg, p| {
            patch(svg, p, SHELL);
            patch(svg, p, OVERLAP);
        }),
        (any(&|p| p.has_shadows()), "silhouette", |svg, p| dash(svg, p, GHOST)),
        (any(&|p| p.has_tracks()), "moves", |svg, p| dash(svg, p, TRACK)),
        (any(&|p| p.has_marks()), "at the times given", |svg, p| {
            svg.circle(p - Vector2::new(5.0, 0.0), 3.2, DOT);
            svg.circle(p + Vector2::new(5.0, 0.0), 4.4, GHOST);
        }),
    ];
    let mut at = corner + Vector2::new(0.0, FONT_SIZE);
    for (_, name, sign) in entries.into_iter().filter(|(there, ..)| *there) {
        let width = 26.0 + text_width(name) + 16.0;
        if at.x + width - 16.0 > right && at.x > corner.x {
            at = Point2::new(corner.x, at.y + FONT_SIZE + 8.0);
        }
        sign(svg, at + Vector2::new(10.0, -4.0));
        svg.text(at + Vector2::new(26.0, 0.0), Anchor::Start, "", name);
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
