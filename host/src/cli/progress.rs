//! Progress on a terminal; nothing anywhere else.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar from 0 to 1000 with a message behind it, drawn on stderr if that is a terminal.
pub(super) fn bar(json: bool) -> ProgressBar {
    let bar = ProgressBar::new(1000);
    if json {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {msg}") {
        bar.set_style(style);
    }
    bar
}
