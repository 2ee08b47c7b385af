//! What things look like.

pub(super) const CORE: &str = r##"fill="#343a43" stroke="#15181c" stroke-width="1""##;
/// px
pub(super) const SMALL_SIZE: f64 = 10.0;
pub(super) const SMALL: &str =
    r##"font-size="10" stroke="#ffffff" stroke-width="3" stroke-linejoin="round" paint-order="stroke""##;
pub(super) const DOT: &str = r##"fill="#ffffff" stroke="#15181c" stroke-width="1.2""##;
pub(super) const MARGIN: &str = r##"fill="none" stroke="#15181c" stroke-width="1" stroke-dasharray="2 2.5""##;
pub(super) const SHELL: &str = r##"fill="#f0a54a" fill-opacity="0.30" stroke="#c97a1c" stroke-width="1""##;
pub(super) const OVERLAP: &str = r##"fill="#d03b5f" fill-opacity="0.42" stroke="#a81f45" stroke-width="0.8""##;
pub(super) const OVERLAP_LINE: &str = r##"fill="none" stroke="#a81f45" stroke-width="0.8""##;
/// A core a little earlier, and the part of that within what it is now.
pub(super) const BEFORE: &str = r##"fill="none" stroke="#6b7480" stroke-width="0.9" stroke-dasharray="4 3""##;
pub(super) const BEFORE_INSIDE: &str = r##"fill="none" stroke="#c3cad3" stroke-width="0.9" stroke-dasharray="4 3""##;
pub(super) const TRACK: &str =
    r##"fill="none" stroke="#343a43" stroke-width="1.3" stroke-dasharray="1.5 3" stroke-linecap="round""##;
/// The path that others are compared with.
pub(super) const REFERENCE: &str = r##"fill="none" stroke="#17a2b8" stroke-width="1.8" stroke-dasharray="6 3""##;
/// Paths whose speed is not shown.
pub(super) const LINE_COLOUR: &str = "#1f5fbf";
/// From a robot to the nearest place of a core.
pub(super) const CLEARANCE: &str = r##"stroke="#c2185b" stroke-width="1.5""##;
pub(super) const CLEARANCE_CASING: &str = r##"stroke="#ffffff" stroke-width="3.5""##;
pub(super) const CLEARANCE_END: &str = r##"fill="#c2185b""##;
/// Around what is seen of a path through the core that is before it.
pub(super) const BEHIND_CASING: &str = r##"fill="none" stroke="#ffffff" stroke-width="4""##;
/// The same of what is thin.
pub(super) const THIN_CASING: &str = r##"fill="none" stroke="#ffffff" stroke-width="2.4""##;
pub(super) const START: &str = r##"fill="#ffffff" stroke="#15181c" stroke-width="1.8""##;
pub(super) const ATTRACTOR: &str = r##"fill="#ffd43b" stroke="#15181c" stroke-width="1.1" stroke-linejoin="round""##;
/// The line of a cross where a path ended in a core.
pub(super) const ENTRY: &str = "#d0021b";
/// A square where one was given up.
pub(super) const LOST: &str = r##"fill="#d0021b" stroke="#ffffff" stroke-width="1.2""##;
pub(super) const FLOW: &str = r##"fill="none" stroke="#9db0c4" stroke-width="1""##;
pub(super) const FLOW_HEAD: &str = r##"fill="#8298af""##;
/// Around the points of a scan, which are many: it does not hide them.
pub(super) const SCAN: &str = r##"fill="#9aa2ad""##;
pub(super) const SCAN_POINT: &str = r##"fill="#15181c""##;
/// Where a path ended at a moving attractor.
pub(super) const ARRIVED: &str = r##"fill="#b8860b" stroke="#15181c" stroke-width="0.8""##;
pub(super) const ATTRACTOR_TRACK: &str =
    r##"fill="none" stroke="#b8860b" stroke-width="1.6" stroke-dasharray="1.5 3" stroke-linecap="round""##;
pub(super) const ATTRACTOR_HEAD: &str = r##"fill="#b8860b""##;
pub(super) const TRACK_HEAD: &str = r##"fill="#343a43""##;

/// Around a path so many px wide.
pub(super) fn casing(line: f64) -> String {
    let width = line + 2.2;
    format!(
        r##"fill="none" stroke="#ffffff" stroke-width="{width:.1}" stroke-linecap="round" stroke-linejoin="round""##
    )
}

/// A demonstration so many px wide.
pub(super) fn demonstration(line: f64) -> String {
    format!(
        r##"fill="none" stroke="#e8862a" stroke-opacity="0.75" stroke-width="{line}" stroke-linejoin="round" stroke-linecap="round""##
    )
}

/// The colour of a speed between 0 (the least) and 1 (the largest): viridis without its lightest end, which white paper swallows.
pub(super) fn speed_colour(share: f64) -> String {
    const COLOURS: [[f64; 3]; 8] = [
        [68.0, 1.0, 84.0],
        [70.0, 50.0, 126.0],
        [54.0, 92.0, 141.0],
        [39.0, 127.0, 142.0],
        [31.0, 161.0, 135.0],
        [74.0, 193.0, 109.0],
        [130.0, 211.0, 77.0],
        [178.0, 221.0, 45.0],
    ];
    let at = share.clamp(0.0, 1.0) * (COLOURS.len() - 1) as f64;
    let low = (at.floor() as usize).min(COLOURS.len() - 2);
    let mix = |i: usize| (COLOURS[low][i] + (COLOURS[low + 1][i] - COLOURS[low][i]) * (at - low as f64)).round() as u8;
    format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
}
