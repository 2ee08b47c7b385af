//! What each field of a scene file may be: the one place that says it, quoted by every complaint about that field.

/// Field and what is allowed there.
const ALLOWED: &[(&str, &str)] = &[
    (
        "ds",
        "either `model = \"path/of/model.toml\"` (relative to the scene file) or `linear = { attractor = [x, y], gain = 1.0 }`",
    ),
    (
        "ds.model",
        "the path of a model file, relative to the scene file; `pliant learn DEMO... -o MODEL.toml` writes one",
    ),
    ("ds.linear", "`{ attractor = [x, y] or [x, y, z] in m, gain = 1/s }`"),
    ("ds.linear.attractor", "[x, y] or [x, y, z] in m, within +-1000; their number is the scene's dimension"),
    ("ds.linear.gain", "a number above 0, at most 1000 (1/s)"),
    ("modulation", "`method`, `c`, `steering`, `beta`; all have defaults"),
    ("modulation.method", "\"deformable\" (default), or \"original\" to treat soft layers as if they were not there"),
    ("modulation.c", "a number from 0 to 10 (m/s); default 0.03"),
    ("modulation.steering", "\"with-flow\" (default) or { fixed = ANGLE } with the angle in rad"),
    ("modulation.steering.fixed", "an angle in rad, within +-1000"),
    (
        "modulation.beta",
        "a number from 0 to 10, the largest push over the nominal speed, only with `steering = \"with-flow\"`; default 1",
    ),
    ("limits", "`speed`, `acceleration`, `deceleration`; all have defaults"),
    ("limits.speed", "a number above 0, at most 100 (m/s); default 0.5"),
    ("limits.acceleration", "a number above 0, at most 10000 (m/s^2); left out, the acceleration is free"),
    ("limits.deceleration", "a number above 0, at most 10000 (m/s^2); default 2"),
    ("ageing", "`time_to_live`, `growth`, `hold`; all have defaults"),
    ("ageing.time_to_live", "a number from 0 to 3600 (s); default 0.2, six updates at 30 Hz"),
    ("ageing.growth", "a number from 0 to 10 (m/s); default 0.02"),
    ("ageing.hold", "a number from `time_to_live` to 3600 (s); default 1"),
    ("goal", "`tolerance`, `timeout`; both have defaults"),
    ("goal.tolerance", "a number above 0, at most 1000 (m); default 0.01"),
    ("goal.timeout", "a number above 0, at most 3600 (s); default 30"),
    ("start", "at least one `[[start]]` with its `position = [x, y]`"),
    ("start.position", "as many coordinates as the scene has dimensions, in m, within +-1000, outside every hard core"),
    ("obstacle", "at most 64 `[[obstacle]]` tables, each with `name`, `shape` and `center` (or `path`)"),
    ("obstacle.name", "a text that no other obstacle has, such as \"post\""),
    ("obstacle.shape", "{ ellipsoid = [a, b] } with the hard semi-axes in m (three in 3-D)"),
    ("obstacle.shape.ellipsoid", "one hard semi-axis for each dimension, from 0.0001 to 1000 (m)"),
    ("obstacle.center", "as many coordinates as the scene has dimensions, in m, within +-1000"),
    ("obstacle.angle", "a number in rad, within +-1000, in 2-D; 3-D takes `rotation = [w, x, y, z]`"),
    ("obstacle.rotation", "a unit quaternion [w, x, y, z] in 3-D; 2-D takes `angle` in rad"),
    ("obstacle.stiffness", "k >= 1: the soft semi-axes are ln k + 1 (at most 100) times the hard ones; 1 is rigid"),
    ("obstacle.soft", "one soft semi-axis for each dimension, in m, from the hard one to 100 times the hard one"),
    ("obstacle.layer", "the soft layer's thickness in m, 0 or more; no soft semi-axis beyond 100 times the hard one"),
    ("obstacle.curvature", "a whole number from 1 (ellipsoid, the default) to 8 (nearly a box)"),
    ("obstacle.margin", "one safety factor for each dimension, from 1 (the default) to 100"),
    ("obstacle.velocity", "as many numbers as the scene has dimensions, in m/s, within +-100; not with `path`"),
    ("obstacle.angular_velocity", "a number (2-D) or [x, y, z] (3-D), in rad/s, within +-100"),
    ("obstacle.reference", "a point in the obstacle's own frame, in m, inside the hard core; default its centre"),
    (
        "obstacle.path",
        "[[t, x, y], ...] (3-D: [t, x, y, z]): one point or more, t in s from 0 upwards and increasing, at most 100 m/s between points",
    ),
];

/// What is allowed in a field, if there is such a field.
pub(super) fn allowed(field: &str) -> Option<&'static str> {
    ALLOWED.iter().find(|(name, _)| *name == field).map(|(_, what)| *what)
}
