//! Processor time: what a piece of work takes on one core, whatever else the machine does.

/// Runs a piece of work on this thread; its processor time is in s. On systems without such a clock it is the time that passes.
pub fn timed<R>(work: impl FnOnce() -> R) -> (R, f64) {
    let begin = now();
    let result = work();
    (result, now() - begin)
}

/// s, from some time on.
#[cfg(unix)]
fn now() -> f64 {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    t.tv_sec as f64 + t.tv_nsec as f64 * 1e-9
}

#[cfg(not(unix))]
fn now() -> f64 {
    static BEGIN: std::sync::LazyLock<std::time::Instant> = std::sync::LazyLock::new(std::time::Instant::now);
    BEGIN.elapsed().as_secs_f64()
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn work_takes_time_and_sleep_takes_none() {
        let (sum, working) = timed(|| (0..3_000_000_u64).fold(0_u64, |s, i| std::hint::black_box(s ^ i)));
        let ((), asleep) = timed(|| std::thread::sleep(std::time::Duration::from_millis(200)));
        assert!(sum < 1 << 22 && working > 0.0);
        assert!(asleep < 0.1, "{asleep}");
    }
}
