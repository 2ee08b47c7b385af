use super::*;

/// What to replace in which scene, by what; the line and field of the complaint, and a word of it or of its help.
pub(super) type Case = (&'static str, &'static str, &'static str, usize, &'static str, &'static str);

#[rustfmt::skip]
const BAD: &[Case] = &[
    // syntax, types, keys
    (GOOD, "[0.20, 0.21]", "[0.20, 0.21", 15, "", "not TOML"),
    (GOOD, "c = 0.03", "c = \"fast\"", 5, "modulation.c", "expected a number"),
    (GOOD, "center = [0.20, 0.21]", "center = 0.2", 14, "obstacle.center", "expected an array"),
    (GOOD, "center = [0.20, 0.21]", "center = [0.2, \"a\"]", 14, "obstacle.center", "expected a number"),
    (GOOD, "curvature = 1", "curvature = 1.5", 17, "obstacle.curvature", "expected a whole number"),
    (GOOD, "speed = 0.5", "speed = true", 8, "limits.speed", "expected a number"),
    (GOOD, "stiffness =", "stifness =", 16, "obstacle.stifness", "did you mean `stiffness`"),
    (GOOD, "center =", "centre =", 14, "obstacle.centre", "did you mean `center`"),
    (GOOD, "position =", "pos =", 10, "start.pos", "`position`"),
    (GOOD, "[limits]", "[limit]", 7, "limit", "did you mean `limits`"),
    (GOOD, "[goal]", "[goal]\ncolour = 1", 23, "goal.colour", "no key `colour`"),
    (GOOD, "linear = { attractor", "linear = { atractor", 2, "ds.linear.atractor", "did you mean `attractor`"),
    (GOOD, "\"with-flow\"", "\"withflow\"", 6, "modulation.steering", "did you mean `with-flow`"),
    (GOOD, "\"deformable\"", "\"soft\"", 4, "modulation.method", "`original`"),
    (GOOD, "ellipsoid =", "elipsoid =", 13, "obstacle.shape.elipsoid", "did you mean `ellipsoid`"),
    (GOOD, "shape = { ellipsoid = [0.04, 0.05] }", "shape = 3", 13, "obstacle.shape", "expected a shape, such as"),
    (GOOD, "\"with-flow\"", "{ fixed = \"x\" }", 6, "modulation.steering.fixed", "expected a number"),
    (GOOD, "shape = { ellipsoid = [0.04, 0.05] }", "", 11, "obstacle.shape", "is missing"),
    (GOOD, "name = \"foam\"", "", 11, "obstacle.name", "is missing"),
    (GOOD, "center = [0.20, 0.21]", "", 11, "obstacle.center", "is missing"),
    (GOOD, "linear = { attractor = [0.0, 0.0], gain = 1.0 }", "", 1, "ds", "names no motion"),
    (GOOD, "[ds]\nlinear = { attractor = [0.0, 0.0], gain = 1.0 }\n", "", 1, "ds", "is missing"),
    (GOOD, "[[start]]\nposition = [0.37, 0.41]", "", 1, "start", "is missing"),
    (GOOD, "name = \"foam\"", "name = \"\"", 12, "obstacle.name", "empty"),
    (GOOD, "margin = [1.0, 1.0]", "margin = 1.05", 18, "obstacle.margin", "expected an array; did you mean [1.05, 1.05] (3-D: [1.05, 1.05, 1.05])?"),
    (GOOD, "stiffness = 1.6487", "soft = 1", 16, "obstacle.soft", "did you mean [1, 1]"),
    // whole numbers that TOML has no room for
    (GOOD, "gain = 1.0", "gain = 1000000000000000000000000", 2, "ds.linear.gain", "1000000000000000000000000 is too large"),
    (GOOD, "gain = 1.0", "gain = 1000000000000000000000000000000000000000000", 2, "ds.linear.gain", "000 is too large"),
    (GOOD, "0.37, 0.41", "-1000000000000000000000000000000000000000000, 0.41", 10, "start.position", "is too small"),
    (GOOD, "curvature = 1", "curvature = 99999999999999999999", 17, "obstacle.curvature", "99999999999999999999 is too large"),
    (GOOD, "angular_velocity = 0.0", "angular_velocity = 99999999999999999999", 20, "obstacle.angular_velocity", "is too large"),
    (GOOD, "name = \"foam\"", "name = 99999999999999999999", 12, "obstacle.name", "expected a string"),
    // numbers
    (GOOD, "0.20, 0.21", "nan, 0.21", 14, "obstacle.center", "NaN is not a finite number"),
    (GOOD, "0.37, 0.41", "inf, 0.41", 10, "start.position", "inf is not a finite number"),
    (GOOD, "0.37, 0.41", "1000.1, 0.41", 10, "start.position", "too large"),
    (GOOD, "0.20, 0.21", "-2000, 0.21", 14, "obstacle.center", "too small"),
    (GOOD, "c = 0.03", "c = -0.1", 5, "modulation.c", "too small"),
    (GOOD, "\"with-flow\"", "{ fixed = inf }", 6, "modulation.steering.fixed", "not a finite"),
    (GOOD, "\"with-flow\"", "\"with-flow\"\nbeta = 11", 7, "modulation.beta", "too large"),
    (GOOD, "\"with-flow\"", "{ fixed = 0.785 }\nbeta = 1", 7, "modulation.beta", "fixed steering"),
    (GOOD, "speed = 0.5", "speed = 0", 8, "limits.speed", "too small"),
    (GOOD, "speed = 0.5", "speed = 0.5\nacceleration = 0.0", 9, "limits.acceleration", "too small"),
    (GOOD, "speed = 0.5", "speed = 0.5\ndeceleration = nan", 9, "limits.deceleration", "NaN"),
    (GOOD, "gain = 1.0", "gain = 0.0", 2, "ds.linear.gain", "too small"),
    (GOOD, "[goal]", "[ageing]\ntime_to_live = 2.0\nhold = 1.0\n[goal]", 24, "ageing.hold", "too small"),
    (GOOD, "[goal]", "[goal]\ntolerance = 0", 23, "goal.tolerance", "too small"),
    (GOOD, "timeout = 30.0", "timeout = -1", 23, "goal.timeout", "too small"),
    (GOOD, "stiffness = 1.6487", "stiffness = 0.9", 16, "obstacle.stiffness", "k >= 1"),
    (GOOD, "stiffness = 1.6487", "stiffness = 1e300", 16, "obstacle.stiffness", "times the hard one"),
    (GOOD, "stiffness = 1.6487", "layer = -0.01", 16, "obstacle.layer", "too small"),
    (GOOD, "stiffness = 1.6487", "layer = 100", 16, "obstacle.layer", "times the hard one"),
    (GOOD, "stiffness = 1.6487", "soft = [0.06, 0.04]", 16, "obstacle.soft", "smaller than the hard semi-axis 0.05"),
    (GOOD, "stiffness = 1.6487", "stiffness = 1.6487\nlayer = 0.02", 17, "obstacle.layer", "beside `stiffness`"),
    (GOOD, "stiffness = 1.6487", "layer = 0.02\nsoft = [1.0, 1.0]", 17, "obstacle.soft", "rigid obstacle"),
    (GOOD, "[0.04, 0.05]", "[0.04, 0.0]", 13, "obstacle.shape.ellipsoid", "too small"),
    (GOOD, "[0.04, 0.05]", "[-0.04, 0.05]", 13, "obstacle.shape.ellipsoid", "too small"),
    (GOOD, "curvature = 1", "curvature = 0", 17, "obstacle.curvature", "1 (ellipsoid"),
    (GOOD, "curvature = 1", "curvature = 9", 17, "obstacle.curvature", "is 9"),
    (GOOD, "curvature = 1", "curvature = -3", 17, "obstacle.curvature", "is -3"),
    (GOOD, "margin = [1.0, 1.0]", "margin = [1.0, 0.99]", 18, "obstacle.margin", "too small"),
    (GOOD, "velocity = [0.0, 0.0]", "velocity = [200.0, 0.0]", 19, "obstacle.velocity", "too large"),
    (GOOD, "velocity = [0.0, 0.0]", "velocity = [50.0, 0.0]", 19, "obstacle.velocity", "before the timeout"),
    (GOOD, "angular_velocity = 0.0", "angular_velocity = inf", 20, "obstacle.angular_velocity", "out of range"),
    (GOOD, "angle = 0.0", "angle = nan", 15, "obstacle.angle", "NaN"),
    // finite here, infinite or zero on a device
    (GOOD, "stiffness = 1.6487", "soft = [1e300, 1.0]", 16, "obstacle.soft", "times the hard one"),
    (GOOD, "stiffness = 1.6487", "layer = 1e300", 16, "obstacle.layer", "times the hard one"),
    (GOOD, "angle = 0.0", "angle = 1e300", 15, "obstacle.angle", "too large"),
    (GOOD, "velocity = [0.0, 0.0]", "path = [[1e300, 0.2, 0.2]]", 19, "obstacle.path", "too large"),
    (GOOD, "[goal]", "[attractor]\npath = [[1e39, 0.0, 0.0]]\n[goal]", 23, "attractor.path", "too large"),
    (GOOD, "gain = 1.0", "gain = 1e-300", 2, "ds.linear.gain", "too small"),
    (GOOD, "speed = 0.5", "speed = 1e-300", 8, "limits.speed", "too small"),
    (GOOD, "speed = 0.5", "speed = 0.5\nacceleration = 1e-300", 9, "limits.acceleration", "too small"),
    (GOOD, "speed = 0.5", "speed = 0.5\ndeceleration = 1e-300", 9, "limits.deceleration", "too small"),
    (GOOD, "[goal]", "[guard]\napproach = 1e-300\n[goal]", 23, "guard.approach", "too small"),
    (SPATIAL, "rotation = [1.0, 0.0, 0.0, 0.0]", "rotation = [2.0, 0.0, 0.0, 0.0]", 9, "obstacle.rotation", "made one: [1.0"),
    (SPATIAL, "rotation = [1.0, 0.0, 0.0, 0.0]", "rotation = [0, 0, 0, 0]", 9, "obstacle.rotation", "length 0"),
    (SPATIAL, "rotation = [1.0, 0.0, 0.0, 0.0]", "rotation = [1.0, 0.0, 0.0]", 9, "obstacle.rotation", "has 3 numbers"),
    // places
    (GOOD, "reference = [0.0, 0.0]", "reference = [0.0, 0.05]", 21, "obstacle.reference", "outside the hard core"),
    (GOOD, "0.37, 0.41", "0.21, 0.22", 10, "start.position", "hard core of obstacle \"foam\""),
    (GOOD, "margin = [1.0, 1.0]", "margin = [6.0, 6.0]", 10, "start.position", "within the margin of obstacle \"foam\""),
    (GOOD, "0.20, 0.21", "0.01, 0.01", 14, "obstacle.center", "attractor inside the hard core"),
    // A margin makes the core larger.
    (GOOD, "margin = [1.0, 1.0]", "margin = [9.0, 9.0]", 14, "obstacle.center", "attractor inside the hard core"),
    // dimensions
    (GOOD, "attractor = [0.0, 0.0]", "attractor = [0.0]", 2, "ds.linear.attractor", "has 1 number"),
    (GOOD, "0.37, 0.41", "0.37, 0.41, 0.1", 10, "start.position", "has 3 numbers, but the scene has 2 dimensions"),
    (GOOD, "[0.04, 0.05]", "[0.04]", 13, "obstacle.shape.ellipsoid", "has 1 number,"),
    (GOOD, "0.20, 0.21", "", 14, "obstacle.center", "has 0 numbers"),
    (GOOD, "attractor = [0.0, 0.0]", "attractor = [0.0, 0.0, 0.0]", 13, "obstacle.shape.ellipsoid", "scene has 3 dimensions"),
    (GOOD, "angle = 0.0", "rotation = [1, 0, 0, 0]", 15, "obstacle.rotation", "takes `angle`"),
    (GOOD, "angular_velocity = 0.0", "angular_velocity = [0, 0, 1]", 20, "obstacle.angular_velocity", "2 dimensions"),
    (SPATIAL, "rotation = [1.0, 0.0, 0.0, 0.0]", "angle = 0.1", 9, "obstacle.angle", "takes `rotation"),
    (SPATIAL, "angular_velocity = [0.0, 0.0, 0.1]", "angular_velocity = 0.1", 11, "obstacle.angular_velocity", "3 dimensions"),
    // paths
    (GOOD, "velocity = [0.0, 0.0]", "path = []", 19, "obstacle.path", "no point"),
    (GOOD, "velocity = [0.0, 0.0]", "path = [[0.0, 0.2]]", 19, "obstacle.path", "a time and 2 coordinates make 3"),
    (GOOD, "velocity = [0.0, 0.0]", "path = [[1, 0.2, 0.2], [1, 0.3, 0.2]]", 19, "obstacle.path", "does not come after"),
    (GOOD, "velocity = [0.0, 0.0]", "path = [[-1, 0.2, 0.2]]", 19, "obstacle.path", "too small"),
    (GOOD, "velocity = [0.0, 0.0]", "path = [[1, 0.2, 0.2], [1.001, 9, 0.2]]", 19, "obstacle.path", "faster than 100 m/s"),
    (GOOD, "velocity = [0.0, 0.0]", "velocity = [0.1, 0.0]\npath = [[1, 0.2, 0.2]]", 19, "obstacle.velocity", "beside `path`"),
    (GOOD, "velocity = [0.0, 0.0]", "path = [[0, 0.3, 0.2]]", 14, "obstacle.center", "leave it out"),
    // models
    (GOOD, "linear = { attractor = [0.0, 0.0], gain = 1.0 }", "model = \"no.toml\"", 2, "ds.model", "`no.toml` cannot be read"),
    (GOOD, "linear =", "model = \"a.toml\"\nlinear =", 3, "ds.linear", "one of the two"),
];

#[test]
fn what_is_wrong_is_named_with_file_line_and_field() {
    assert!(parse(GOOD).is_ok() && parse(SPATIAL).is_ok());
    refused(BAD);
}

/// Every case has to be refused as it says.
pub(super) fn refused(cases: &[Case]) {
    for (good, from, to, line, field, word) in cases {
        let case = format!("`{from}` -> `{to}`");
        assert_eq!(good.matches(from).count(), 1, "{case}: the case itself");
        let error = parse(&good.replace(from, to)).expect_err(&case);
        let message = error.to_string();
        assert_eq!(error.line(), Some(*line), "{case}: {message}");
        assert_eq!(error.field(), *field, "{case}: {message}");
        assert!(message.starts_with(&format!("dir/bad.toml, line {line}: ")), "{case}: {message}");
        assert!(message.contains(field), "{case}: {message}");
        let help = error.help().map(|h| h.to_string()).unwrap_or_default();
        assert!(help.len() > "allowed: ".len(), "{case}: no help with {message}");
        assert!(message.contains(word) || help.contains(word), "{case}: {message} / {help}");
    }
}
