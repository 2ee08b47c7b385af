//! Figures: a scene with its streamlines, its hard and soft regions, and where robots went; SVG, and PNG from the same SVG.
//!
//! ```no_run
//! use pliant::{plot, scene::Scene};
//! # fn main() -> Result<(), pliant::error::Error> {
//! let scene = Scene::load("scenes/sbend-pair.toml")?;
//! plot::scene_figure(&scene, &[], &plot::Options::default())?.save("pair.png".as_ref())?;
//! # Ok(())
//! # }
//! ```

mod approach;
pub mod chart;
pub mod figure;
mod gallery;
mod ink;
mod labels;
mod legend;
mod outline;
mod panel;
mod paths;
mod png;
mod portrait;
mod seen;
mod sheet;
mod streamlines;
mod style;
mod ticks;
mod trajectory;
mod view;

use std::io;
use std::path::Path;

use nalgebra::{Point2, Vector2, Vector3};

use crate::output;
use crate::scene::{ConvertError, Scene};
use figure::{Anchor, Axes, Svg};
pub use gallery::{Tile, gallery};
use panel::Panel;
pub use portrait::{Portrait, portrait};
pub use sheet::contact_sheet;
pub use streamlines::streamlines;
pub use trajectory::{Trajectory, TrajectoryPoint, trajectories};
use view::View;

/// What a scene's figure is to look like.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Scene time the obstacles and the field are drawn at, the first one if they change, s.
    pub time: f64,
    /// Width, px, half as much again for a scene that changes; text has a fixed size, so a smaller figure has larger text when both are shown equally wide.
    pub width: f64,
    /// Draw the streamlines?
    pub streamlines: bool,
    /// Colour trajectories by their speed?
    pub speed: bool,
    /// Show how near each trajectory comes to a core?
    pub clearances: bool,
    /// A path to compare with, m; drawn under the trajectories.
    pub reference: Vec<Vector3<f64>>,
    /// What the motion was learnt from, m; drawn under all paths.
    pub demonstrations: Vec<Vec<Vector3<f64>>>,
    /// Where trajectories ended in a core, m; each gets a cross.
    pub entries: Vec<Vector3<f64>>,
    /// Where others ended that never arrived, m; each gets a square.
    pub lost: Vec<Vector3<f64>>,
    /// Two opposite corners, m: trajectories that leave the box between them are cut where the axes end, and do not stretch these.
    pub limit: Option<[Vector3<f64>; 2]>,
    /// How wide trajectories are drawn, px; where they start is marked the larger the wider they are.
    pub line: f64,
}

impl Default for Options {
    /// At time 0, 560 pixels wide, with everything.
    fn default() -> Self {
        Self {
            time: 0.0,
            width: 560.0,
            streamlines: true,
            speed: true,
            clearances: true,
            reference: Vec::new(),
            demonstrations: Vec::new(),
            entries: Vec::new(),
            lost: Vec::new(),
            limit: None,
            line: 3.2,
        }
    }
}

/// Why there is no figure.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum PlotError {
    /// Neither .svg nor .png.
    #[error("{0}: a figure's name ends in .svg or .png")]
    Format(String),
    /// The file cannot be written.
    #[error("{path}: cannot be written: {problem}")]
    Unwritable {
        /// As it was given.
        path: String,
        /// What the system says.
        problem: io::Error,
    },
    /// The scene cannot be evaluated at the time asked for.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scene(#[from] ConvertError),
    /// The pixels could not be made.
    #[error("the figure cannot be made a PNG: {0}")]
    Png(String),
}

/// A finished figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    svg: String,
    cut: usize,
}

/// Pixels of a PNG for one of the SVG.
const PNG_SCALE: f32 = 2.0;

impl Figure {
    /// A figure from SVG made elsewhere, such as with [`figure`].
    pub fn from_svg(svg: String) -> Self {
        Self { svg, cut: 0 }
    }

    /// How many trajectories leave the axes they are drawn in, by a [limit](Options::limit).
    pub fn cut(&self) -> usize {
        self.cut
    }

    /// The SVG document.
    pub fn svg(&self) -> &str {
        &self.svg
    }

    /// The same as a PNG file, twice as many pixels each way.
    ///
    /// # Errors
    /// The SVG is none, or too large.
    pub fn png(&self) -> Result<Vec<u8>, PlotError> {
        png::encode(&self.svg, PNG_SCALE)
    }

    /// Writes the figure, .svg or .png by its name, and the folder it is in if need be.
    ///
    /// # Errors
    /// Another ending, or a file that cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), PlotError> {
        let bytes = match format(path)? {
            Format::Svg => self.svg.clone().into_bytes(),
            Format::Png => self.png()?,
        };
        output::write(path, bytes)
            .map_err(|problem| PlotError::Unwritable { path: path.display().to_string(), problem })
    }
}

enum Format {
    Svg,
    Png,
}

fn format(path: &Path) -> Result<Format, PlotError> {
    match path.extension().and_then(|e| e.to_str()).map(str::to_lowercase).as_deref() {
        Some("svg") => Ok(Format::Svg),
        Some("png") => Ok(Format::Png),
        _ => Err(PlotError::Format(path.display().to_string())),
    }
}

/// Is this a name a figure can be saved under? To be asked before long work.
///
/// # Errors
/// Another ending than .svg and .png.
pub fn check_format(path: &Path) -> Result<(), PlotError> {
    format(path).map(|_| ())
}

/// Room above and to the right of everything, px.
const EDGE: f64 = 12.0;
/// Room for the colour scale, px.
const SCALE_ROOM: f64 = 62.0;
/// Room under a panel for ticks, and for a name as well, px.
const BELOW: [f64; 2] = [16.0, 42.0];
/// Room between two columns, px.
const BETWEEN: f64 = 18.0;
/// Room for a title, px.
const TITLE: f64 = 18.0;

/// A scene with streamlines, obstacles and trajectories. One that changes while robots are under way is drawn at several moments, two in a
/// row, among them those at which robots come nearest to what moves. In 3-D: from above (x-y) and from the side (x-z), obstacles by their
/// silhouettes, and without streamlines.
///
/// # Errors
/// A time at which an obstacle has left the range.
pub fn scene_figure(scene: &Scene, trajectories: &[Trajectory], options: &Options) -> Result<Figure, PlotError> {
    let speeds = trajectory::speeds(trajectories).filter(|_| options.speed);
    let moments = approach::moments(scene, trajectories, options.time);
    let panel = |view: &View, moment| Panel::new(scene, view, trajectories, speeds, moment, options);
    let of_view = |view: &View| moments.iter().map(|moment| panel(view, moment)).collect::<Result<Vec<_>, _>>();
    let views: Vec<Vec<Panel<'_>>> = View::of(scene).iter().map(of_view).collect::<Result<_, _>>()?;
    let extents = panel::shared(&views);
    let columns = moments.len().min(2);
    let width = options.width * if columns > 1 { 1.5 } else { 1.0 };
    let right = EDGE + if speeds.is_some() { SCALE_ROOM } else { 0.0 };
    let high = |e: &figure::Extent| e.size().y / e.size().x * width / columns as f64 * 0.8;
    let left = extents.iter().map(|e| Axes::left_room(e, high(e))).fold(0.0, f64::max);
    let each = (width - left - right - BETWEEN * (columns - 1) as f64) / columns as f64;
    let mut svg = Svg::default();
    let mut top = EDGE;
    let mut scale_at = None;
    let rows = moments.len().div_ceil(columns);
    for row in 0..rows {
        for (v, (panels, extent)) in views.iter().zip(&extents).enumerate() {
            let last = row + 1 == rows && v + 1 == views.len();
            let shown = panels.iter().enumerate().skip(row * columns).take(columns);
            top += if panels.iter().any(|p| p.title().is_some()) { TITLE } else { 0.0 };
            let mut bottom = top;
            for (column, (i, panel)) in shown.enumerate() {
                let corner = Point2::new(left + (each + BETWEEN) * column as f64, top);
                let axes = Axes::equal(corner, each, *extent);
                panel.draw(&mut svg, &axes, &format!("{v}-{i}"));
                let [x, y] = panel.names();
                axes.frame(&mut svg, last.then_some(&x), (column == 0).then_some(&y));
                if let Some(title) = panel.title() {
                    svg.text(corner + Vector2::new(0.0, -6.0), Anchor::Start, "", &title);
                }
                bottom = axes.end().y;
                // Beside the last of the first row.
                if row + v == 0 {
                    scale_at = Some(axes);
                }
            }
            top = bottom + BELOW[usize::from(last)];
        }
    }
    if let (Some(speeds), Some(first)) = (speeds, scale_at) {
        legend::speed_scale(&mut svg, &first, top - BELOW[1], speeds);
    }
    let all: Vec<&Panel<'_>> = views.iter().flatten().collect();
    let bottom = legend::draw(&mut svg, &all, Point2::new(left, top + 6.0), width - EDGE);
    let cut = views.iter().zip(&extents).flat_map(|(v, e)| v.iter().map(|p| p.cut(e)).max()).max();
    Ok(Figure { svg: svg.finish(Vector2::new(width, bottom + EDGE)), cut: cut.unwrap_or(0) })
}

#[cfg(test)]
mod tests;
