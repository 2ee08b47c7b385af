//! What each field of a scene file may be: the one place that says it, quoted by every complaint about that field.

/// Field and what is allowed there.
pub(super) const ALLOWED: &[(&str, &str)] = &[
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
    ("guard", "`enabled`, `approach`; both have defaults"),
    ("guard.enabled", "true (default): the next sample is kept outside every hard core; or false"),
    (
        "guard.approach",
        "a number above 0, at most 1: the share of the distance to a core that a tick may use up; default 0.02",
    ),
    ("goal", "`tolerance`, `timeout`; both have defaults"),
    ("goal.tolerance", "a number above 0, at most 1000 (m), the distance to where the attractor then is; default 0.01"),
    ("goal.timeout", "a number above 0, at most 3600 (s); default 30"),
    ("attractor", "`velocity` or `path`: how the place where the motion ends moves; without the table it does not"),
    ("attractor.velocity", "as many numbers as the scene has dimensions, in m/s, within +-100; not with `path`"),
    (
        "attractor.path",
        "[[t, x, y], ...] (3-D: [t, x, y, z]), as an obstacle's; if it begins after t = 0, from where the motion has its attractor",
    ),
    ("scan", "`points` and `radius`: range points that are in the way as they are"),
    (
        "scan.points",
        "[[x, y], ...] (3-D: [x, y, z]): 1 to 128 points in m, within +-1000, none within the radius of the attractor",
    ),
    (
        "scan.radius",
        "a number from 0.0001 to 100 (m): what each point is kept away from by; half the points' spacing or more",
    ),
    ("start", "at least one `[[start]]` with its `position = [x, y]`"),
    (
        "start.position",
        "as many coordinates as the scene has dimensions, in m, within +-1000, outside every hard core and inside every wall",
    ),
    ("obstacle", "at most 64 `[[obstacle]]` tables, each with `name`, `shape` and `center` (or `path`)"),
    ("obstacle.name", "a text that no other obstacle has, such as \"post\""),
    (
        "obstacle.shape",
        "one of { ellipsoid = [a, b] }, { box = [a, b], rounding = r }, { polygon = [[x, y], ...] } (2-D), \
         { cylinder = [radius, half_length], rounding = r } (3-D) and { capsule = [radius, half_length] } (3-D), all in m",
    ),
    ("obstacle.shape.ellipsoid", "one hard semi-axis for each dimension, from 0.0001 to 1000 (m)"),
    ("obstacle.shape.box", "half of each side, one for each dimension, from 0.0001 to 1000 (m)"),
    (
        "obstacle.shape.cylinder",
        "[radius, half_length], from 0.0001 to 1000 (m), along the third axis of the obstacle's frame; in 3-D",
    ),
    (
        "obstacle.shape.capsule",
        "[radius, half_length], within 1000 (m), the radius at least 0.0001: all within the radius of a segment of the third axis; in 3-D",
    ),
    (
        "obstacle.shape.polygon",
        "[[x, y], ...]: 3 to 12 corners in order, in m, in the obstacle's frame; its origin, `center`, sees all of the polygon from inside, \
         0.0001 m or more from the line of every edge; in 2-D",
    ),
    (
        "obstacle.shape.rounding",
        "the radius of a box's edges or a cylinder's rims, from 0.0001 m to its least half side, radius or half length; default a tenth of that",
    ),
    (
        "obstacle.wall",
        "true: the shape is the free space, and the obstacle what is around it, its soft layer inside; default false",
    ),
    ("obstacle.center", "as many coordinates as the scene has dimensions, in m, within +-1000"),
    ("obstacle.angle", "a number in rad, within +-1000, in 2-D; 3-D takes `rotation = [w, x, y, z]`"),
    ("obstacle.rotation", "a unit quaternion [w, x, y, z] in 3-D; 2-D takes `angle` in rad"),
    (
        "obstacle.stiffness",
        "k >= 1: the soft semi-axes are ln k + 1 (at most 100) times the hard ones (of a wall, the hard ones over that); 1 is rigid",
    ),
    (
        "obstacle.soft",
        "one soft semi-axis (half extent) for each dimension, in m, from the hard one to 100 times the hard one; of a wall, a hundredth of it to it; \
         of a polygon the same times the hard one along both",
    ),
    (
        "obstacle.layer",
        "the soft layer's thickness along the axes (of a polygon, as seen from its centre: as thick as asked where the boundary is nearest to the \
         centre, in proportion thicker elsewhere), in m, 0 or more; no soft semi-axis beyond 100 times the hard one, of a wall below a hundredth",
    ),
    ("obstacle.curvature", "a whole number from 1 (ellipsoid, the default) to 8 (nearly a box); only with `ellipsoid`"),
    (
        "obstacle.margin",
        "one safety factor for each dimension, from 1 (the default) to 100; of a polygon the same for both",
    ),
    ("obstacle.velocity", "as many numbers as the scene has dimensions, in m/s, within +-100; not with `path`"),
    ("obstacle.angular_velocity", "a number (2-D) or [x, y, z] (3-D), in rad/s, within +-100"),
    (
        "obstacle.growth",
        "a number within +-100 (m/s): how fast every half extent becomes longer (a polygon: how fast its nearest edge moves out, the rest in \
         proportion), the soft layer along with it; below zero it shrinks, to almost nothing in the end; default 0",
    ),
    (
        "obstacle.reference",
        "a point in the obstacle's own frame, in m, inside the hard core (of a wall, in the free space; of a polygon, where all of it is seen \
         from inside, a fifth of the centre's distance or more from the line of every edge); default its centre",
    ),
    (
        "obstacle.path",
        "[[t, x, y], ...] (3-D: [t, x, y, z]): one point or more, t in s from 0 to 1000000 and increasing, at most 100 m/s between points",
    ),
];

/// What is allowed in a field, if there is such a field.
pub(super) fn allowed(field: &str) -> Option<&'static str> {
    ALLOWED.iter().find(|(name, _)| *name == field).map(|(_, what)| *what)
}
