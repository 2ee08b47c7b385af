//! What a panel shows, from the bottom up.

use nalgebra::{Point2, Vector2, Vector3};

use super::{Panel, at};
use crate::plot::figure::{Axes, Svg};
use crate::plot::ink::{SPACING, beside, draw_flow, draw_track, ring, rings, thinned};
use crate::plot::labels::Labels;
use crate::plot::outline;
use crate::plot::paths::{self, Stroke};
use crate::plot::seen::Seen;
use crate::plot::style::{
    ARRIVED, ATTRACTOR, ATTRACTOR_HEAD, ATTRACTOR_TRACK, BEFORE, BEFORE_INSIDE, CLEARANCE, CLEARANCE_CASING,
    CLEARANCE_END, CORE, DOT, ENTRY, LOST, MARGIN, OVERLAP, OVERLAP_LINE, REFERENCE, SCAN, SCAN_POINT, SHELL, START,
    TRACK, TRACK_HEAD, demonstration,
};
use crate::plot::trajectory::TrajectoryPoint;

impl Panel<'_> {
    /// Draws all but frame and title. `name` is unique in the figure.
    pub fn draw(&self, svg: &mut Svg, axes: &Axes, name: &str) {
        axes.grid(svg);
        svg.clipped(&format!("panel{name}"), axes, |svg| {
            let pixel = |p: &Vector3<f64>| axes.pixel(&self.view.project(p));
            self.draw_flow(svg, axes);
            self.draw_soft(svg, axes);
            let still = self.moment.tail.is_none();
            // An overlap may be hardly wider than a path: that has its white edge under it then.
            let edged = still && !self.overlaps.is_empty();
            if !edged {
                self.draw_overlaps(svg, axes, name);
            }
            for shown in &self.options.demonstrations {
                let pixels: Vec<_> = shown.iter().map(pixel).collect();
                svg.path(thinned(&pixels, 0.1), false, &demonstration(0.6 * self.line()));
            }
            let draw = |svg: &mut Svg, part: &[TrajectoryPoint], stroke| {
                paths::draw(svg, part, pixel, self.speeds, stroke, self.line());
            };
            let size = 1.0 + 1.125 * self.line();
            let starts = |svg: &mut Svg| self.scene.starts().iter().for_each(|p| svg.circle(pixel(p), size, START));
            // Where robots were before, a core may have come since: it hides that. In space it hides what is behind it.
            let (mut under, mut over) = (Vec::new(), Vec::new());
            for t in self.trajectories {
                let parts = paths::parts(self.thick(t), &self.seen, &self.view);
                if self.is_projection() || still {
                    over.extend(parts);
                } else {
                    under.extend(parts);
                }
            }
            if !still && !self.is_projection() {
                self.trajectories.iter().for_each(|t| draw(svg, &t.points, Stroke::Thin));
            }
            let reference: Vec<_> = self.options.reference.iter().map(pixel).collect();
            svg.path(thinned(&reference, 0.1), false, REFERENCE);
            under.iter().for_each(|(_, part)| draw(svg, part, Stroke::Thick));
            if !still && !self.is_projection() {
                starts(svg);
            }
            self.draw_hard(svg, axes, name);
            if !still && self.is_projection() {
                for (behind, part) in
                    self.trajectories.iter().flat_map(|t| paths::parts(&t.points, &self.seen, &self.view))
                {
                    draw(svg, part, if behind { Stroke::ThinDashed } else { Stroke::Thin });
                }
                starts(svg);
            }
            draw_track(svg, axes, &self.aim, ATTRACTOR_TRACK, ATTRACTOR_HEAD);
            if edged {
                over.iter().for_each(|(_, part)| paths::edge(svg, part, pixel, self.line()));
                let cores: Vec<&outline::Region> = self.seen.iter().map(|s| &s.core).collect();
                beside(svg, axes, name, &cores, &|svg| self.draw_overlaps(svg, axes, name));
            }
            for (behind, part) in over {
                let thick = if edged { Stroke::Bare } else { Stroke::Thick };
                draw(svg, part, if behind { Stroke::Dashed } else { thick });
            }
            if still {
                starts(svg);
            }
            let mut labels = Labels::new(axes);
            self.trajectories.iter().for_each(|t| labels.avoid(self.thick(t).iter().map(|p| pixel(&p.position))));
            self.draw_places(svg, axes, &mut labels);
        });
    }

    fn draw_flow(&self, svg: &mut Svg, axes: &Axes) {
        let Some(field) = &self.field else {
            return;
        };
        let seen = |p: Point2<f64>| Some(self.view.project_direction(&field(self.view.lift(&p))?));
        draw_flow(svg, axes, &seen, SPACING);
    }

    fn draw_soft(&self, svg: &mut Svg, axes: &Axes) {
        for s in &self.seen {
            s.before.iter().for_each(|before| svg.area(&[ring(before, axes)], BEFORE));
        }
        for shell in self.seen.iter().filter_map(|s| s.shell.as_ref()) {
            svg.area(&rings(shell, axes), SHELL);
        }
        self.commons.iter().for_each(|area| svg.area(&[ring(area, axes)], OVERLAP));
        if let Some(scan) = self.scene.scan() {
            let points = || scan.points().iter().map(|p| axes.pixel(&self.view.project(p)));
            points().for_each(|p| svg.circle(p, scan.radius() * axes.scale(), SCAN));
            points().for_each(|p| svg.circle(p, 1.2, SCAN_POINT));
        }
    }

    /// What soft layers have in common, in 2-D.
    fn draw_overlaps(&self, svg: &mut Svg, axes: &Axes, name: &str) {
        for (n, (a, b)) in self.overlaps.iter().enumerate() {
            let shell = |i: usize| self.seen.get(i).and_then(|s| s.shell.as_ref()).map(|area| rings(area, axes));
            if let (Some(a), Some(b)) = (shell(*a), shell(*b)) {
                svg.within(&format!("overlap{name}-{n}a"), &a, |svg| svg.area(&b, OVERLAP));
                svg.within(&format!("overlap{name}-{n}b"), &b, |svg| svg.area(&a, OVERLAP_LINE));
            }
        }
    }

    fn draw_hard(&self, svg: &mut Svg, axes: &Axes, name: &str) {
        // The farthest from the viewer first.
        let mut seen: Vec<_> = self.seen.iter().enumerate().collect();
        let height = |s: &Seen<'_>| s.posed.pose.center.dot(&self.view.toward());
        seen.sort_by(|a, b| height(a.1).total_cmp(&height(b.1)));
        for (i, s) in seen {
            let core = rings(&s.core, axes);
            svg.area(&core, CORE);
            if let Some(before) = &s.before {
                svg.within(&format!("core{name}-{i}"), &core, |svg| svg.area(&[ring(before, axes)], BEFORE_INSIDE));
            }
            if let Some(margin) = &s.margin {
                svg.area(&[ring(&margin.ring, axes)], MARGIN);
            }
            draw_track(svg, axes, &s.track, TRACK, TRACK_HEAD);
        }
    }

    /// Where robots and attractor are, and how near robots are to cores.
    fn draw_places(&self, svg: &mut Svg, axes: &Axes, labels: &mut Labels) {
        let pixel = |p: &Vector3<f64>| axes.pixel(&self.view.project(p));
        let star = axes.pixel(&self.attractor());
        labels.keep_free(star, 8.5);
        self.scene.starts().iter().for_each(|p| labels.keep_free(pixel(p), 5.0));
        for s in &self.seen {
            let ring = || ring(&s.core.ring, axes).into_iter();
            labels.avoid(ring().chain(ring().next()));
        }
        for p in self.scene.scan().iter().flat_map(|scan| scan.points()) {
            let (at, half) = (pixel(p), Vector2::new(2.0, 0.0));
            labels.avoid([at - half, at + half]);
        }
        for c in &self.clearances {
            let (from, to) = (pixel(&c.robot), pixel(&c.surface));
            svg.line([from, to], CLEARANCE_CASING);
            svg.line([from, to], CLEARANCE);
            svg.circle(to, 2.2, CLEARANCE_END);
            labels.avoid([from, to]);
            labels.keep_free(nalgebra::center(&from, &to), 1.0);
            labels.mark(nalgebra::center(&from, &to));
        }
        svg.star(star, 8.5, ATTRACTOR);
        for t in self.trajectories {
            let here = self.moment.tail.and_then(|_| at(t, self.moment.time));
            match (here, t.points.last()) {
                (Some(here), _) => {
                    svg.circle(pixel(&here.position), 3.6, DOT);
                    labels.keep_free(pixel(&here.position), 6.0);
                }
                (None, Some(end)) if self.has_aim() => svg.circle(pixel(&end.position), 3.0, ARRIVED),
                _ => {}
            }
        }
        if self.moment.tail.is_none() {
            self.clearances.iter().for_each(|c| svg.circle(pixel(&c.robot), 2.2, CLEARANCE_END));
        }
        self.options.lost.iter().for_each(|p| svg.square(pixel(p), 1.8 + self.line(), LOST));
        let entered = self.clearances.iter().filter(|c| c.inside).map(|c| &c.robot);
        self.options.entries.iter().chain(entered).for_each(|p| svg.cross(pixel(p), 1.8 + self.line(), ENTRY));
        for c in &self.clearances {
            labels.text(svg, nalgebra::center(&pixel(&c.robot), &pixel(&c.surface)), &c.label());
        }
    }
}
