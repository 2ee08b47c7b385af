//! Counts tests by reading what `cargo test` writes on stdout.

/// Tests counted so far over all the test programs of one `cargo test`.
#[derive(Debug, Default, Clone, PartialEq, Eq)]
pub struct Tally {
    passed: u64,
    failed: u64,
    ignored: u64,
    running: Option<Running>,
}

/// A test program that has announced its tests and not yet given its result.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Running {
    announced: u64,
    passed: u64,
    ignored: u64,
}

impl Tally {
    /// Takes one line in.
    pub fn line(&mut self, line: &str) {
        let line = line.trim_end();
        if let Some(announced) = announcement(line) {
            self.abandon();
            self.running = Some(Running { announced, passed: 0, ignored: 0 });
        } else if let Some((passed, failed, ignored)) = result(line) {
            self.running = None;
            self.passed += passed;
            self.failed += failed;
            self.ignored += ignored;
        } else if let Some(running) = &mut self.running
            && line.starts_with("test ")
        {
            if line.ends_with(" ... ok") {
                running.passed += 1;
            } else if line.contains(" ... ignored") {
                running.ignored += 1;
            }
        }
    }

    /// To be called after the last line: a program that died midway has no result line.
    pub fn finish(mut self) -> Self {
        self.abandon();
        self
    }

    /// A program that announced tests and gave no result crashed: those not seen to pass have failed,
    /// and at least one did.
    fn abandon(&mut self) {
        if let Some(running) = self.running.take() {
            self.passed += running.passed;
            self.ignored += running.ignored;
            let seen = running.passed + running.ignored;
            self.failed += running.announced.saturating_sub(seen).max(1);
        }
    }

    /// The plain closing line.
    pub fn closing_line(&self) -> String {
        format!("{} passed, {} failed", self.passed, self.failed)
    }

    /// Tests that did not pass.
    pub fn failed(&self) -> u64 {
        self.failed
    }

    /// Tests marked `#[ignore]`.
    pub fn ignored(&self) -> u64 {
        self.ignored
    }
}

/// `running 3 tests`
fn announcement(line: &str) -> Option<u64> {
    let (count, noun) = line.strip_prefix("running ")?.split_once(' ')?;
    (noun == "test" || noun == "tests").then_some(())?;
    count.parse().ok()
}

/// `test result: ok. 3 passed; 0 failed; 1 ignored; 0 measured; 0 filtered out; finished in 0.00s`
fn result(line: &str) -> Option<(u64, u64, u64)> {
    let (_, counts) = line.strip_prefix("test result: ")?.split_once(". ")?;
    let count = |name: &str| counts.split("; ").find_map(|part| part.strip_suffix(name)?.trim_end().parse().ok());
    Some((count("passed")?, count("failed")?, count("ignored")?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tally(text: &str) -> Tally {
        let mut tally = Tally::default();
        text.lines().for_each(|line| tally.line(line));
        tally.finish()
    }

    const GOOD: &str = "
running 2 tests
test gamma::one ... ok
test gamma::two ... ok

test result: ok. 2 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.01s

running 0 tests

test result: ok. 0 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.00s
";

    const BAD: &str = "
running 3 tests
test a ... ok
test b ... FAILED
test c ... ignored, needs a board

failures:

---- b stdout ----
assertion failed

failures:
    b

test result: FAILED. 1 passed; 1 failed; 1 ignored; 0 measured; 0 filtered out; finished in 0.00s
";

    #[test]
    fn programs_are_summed() {
        let sum = tally(&[GOOD, BAD].concat());
        assert_eq!(sum.closing_line(), "3 passed, 1 failed");
        assert_eq!((sum.failed(), sum.ignored()), (1, 1));
    }

    #[test]
    fn nothing_ran() {
        assert_eq!(tally("   Compiling core\n").closing_line(), "0 passed, 0 failed");
    }

    #[test]
    fn a_crash_midway_is_a_failure() {
        let crash = "running 5 tests\ntest a ... ok\ntest b ... ok\n";
        assert_eq!(tally(crash).closing_line(), "2 passed, 3 failed");
        // Also when another program follows it, and when every test had passed before the crash.
        assert_eq!(tally(&[crash, GOOD].concat()).closing_line(), "4 passed, 3 failed");
        assert_eq!(tally("running 1 test\ntest a ... ok\n").closing_line(), "1 passed, 1 failed");
    }

    #[test]
    fn look_alikes_are_no_counts() {
        assert_eq!(tally("running late\nrunning 4 laps\ntest result: unclear\n"), Tally::default());
    }
}
