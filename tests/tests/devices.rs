//! Runs in real time, on every device that needs no hardware, with bounds wide enough for a busy machine.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail")]

use std::sync::Mutex;

use pliant_tests::programs::{self, root};
use serde_json::Value;

/// One at a time: on two cores, two runs in real time would measure each other.
static REAL_TIME: Mutex<()> = Mutex::new(());

fn timed(device: &str) -> Value {
    let _alone = REAL_TIME.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let folder = std::env::temp_dir();
    let scene = root().join("scenes/sbend-foam.toml");
    let arguments = ["run", scene.to_str().unwrap(), "--device", device, "--headless", "--json"];
    let ended = programs::run(&folder, arguments).unwrap();
    assert_eq!(ended.code, Some(0), "{device}: {}{}", ended.stdout, ended.stderr);
    let report = ended.json();
    assert_eq!(report["reached"], true);
    assert!(report["min_gamma"].as_f64().unwrap() > 1.0, "{report}");
    assert!(report["missed"].is_u64() && report["time_to_goal_s"].is_f64(), "{report}");
    for percentile in ["p50", "p99", "max"] {
        assert!(report["rtt_us"][percentile].as_f64().unwrap() > 0.0, "{report}");
    }
    println!("{device}: {report:#}");
    report
}

#[test]
fn virtual_device_at_1_khz() {
    let report = timed("virtual");
    assert!(report["ticks"].as_u64().unwrap() > 1000, "{report}");
}

#[test]
fn qemu_over_udp_at_1_khz() {
    let report = timed("qemu");
    let stack = report["device_since_start"]["stack_used"].as_u64().unwrap();
    assert!(stack > 1000 && stack < 65_536, "{stack} bytes of stack");
    assert_eq!(report["board"], "mps2-an386");
    assert!(report["ticks"].as_u64().unwrap() > 1000, "{report}");
}

#[test]
fn qemu_over_its_uart() {
    let report = timed("qemu-serial");
    assert_eq!(report["board"], "mps2-an386");
}

#[test]
fn stepped_over_the_uart_has_the_bits_of_the_virtual_device() {
    let folder = std::env::temp_dir();
    let scene = root().join("scenes/reach-spatial.toml");
    let run = |device: &str| {
        let scene = scene.to_str().unwrap();
        // Half a second of it: the emulated UART is slow.
        let arguments = ["run", scene, "--device", device, "--stepped", "--headless", "--json", "--duration", "0.3"];
        let ended = programs::run(&folder, arguments).unwrap();
        assert_eq!(ended.code, Some(1), "too short to arrive: {}", ended.stderr);
        ended.json()
    };
    assert_eq!(run("virtual")["runs"], run("qemu-serial")["runs"]);
}

/// The processes named qemu-system-arm whose parent this is.
fn emulators_of(parent: u32) -> Vec<u32> {
    let all = std::fs::read_dir("/proc").unwrap().filter_map(|e| e.ok()?.file_name().to_str()?.parse::<u32>().ok());
    all.filter(|pid| {
        // pid (name) state parent ...; the name is cut at 15 bytes
        let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
        let after = stat.rsplit_once(')').map_or("", |(_, after)| after);
        stat.contains("(qemu-system-ar") && after.split_whitespace().nth(1) == Some(&parent.to_string())
    })
    .collect()
}

#[test]
fn no_emulator_outlives_its_run() {
    let folder = std::env::temp_dir();
    let scene = root().join("scenes/sbend-foam.toml");
    let mut child = std::process::Command::new(programs::pliant().unwrap())
        .current_dir(&folder)
        .args(["run", scene.to_str().unwrap(), "--device", "qemu", "--headless"])
        .spawn()
        .unwrap();
    let deadline = std::time::Instant::now() + std::time::Duration::from_secs(300);
    let pids = loop {
        let pids = emulators_of(child.id());
        if !pids.is_empty() {
            break pids;
        }
        assert!(std::time::Instant::now() < deadline && child.try_wait().unwrap().is_none(), "QEMU never started");
        std::thread::sleep(std::time::Duration::from_millis(20));
    };
    child.kill().unwrap();
    child.wait().unwrap();
    let alive = |pid: &u32| std::path::Path::new(&format!("/proc/{pid}")).exists();
    for _ in 0..100 {
        if !pids.iter().any(alive) {
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    panic!("QEMU {pids:?} is still there");
}

/// The report of the only run of a scene in lock-step.
fn stepped(name: &str, scene: &str) -> Value {
    let folder = std::env::temp_dir();
    let path = folder.join(format!("pliant-{name}-{}.toml", std::process::id()));
    std::fs::write(&path, scene).unwrap();
    let ended = programs::run(&folder, ["run", path.to_str().unwrap(), "--stepped", "--headless", "--json"]).unwrap();
    std::fs::remove_file(&path).unwrap();
    ended.json()["runs"][0].clone()
}

#[test]
fn the_report_has_what_the_status_said() {
    const GOAL: &str = "ds.linear = { attractor = [0.5, 0.0], gain = 1.0 }\ngoal.timeout = 3.0\n";
    let says = |run: &Value, flag: &str| run["status"].as_array().unwrap().iter().any(|f| f == flag);

    let alone = stepped("alone", &format!("{GOAL}[[start]]\nposition = [0.4, 0.0]\n"));
    assert!(alone["infeasible"] == 0 && !says(&alone, "infeasible") && !says(&alone, "cluster"), "{alone}");

    let pocket = "[[start]]\nposition = [-0.05, 0.0]\n\
        [[obstacle]]\nname = \"top\"\nshape = { box = [0.15, 0.03] }\ncenter = [0.1, 0.15]\n\
        [[obstacle]]\nname = \"bottom\"\nshape = { box = [0.15, 0.03] }\ncenter = [0.1, -0.15]\n\
        [[obstacle]]\nname = \"back\"\nshape = { box = [0.03, 0.16] }\ncenter = [0.23, 0.0]\n";
    let pocket = stepped("pocket", &format!("{GOAL}{pocket}"));
    assert!(pocket["reached"] == false && pocket["infeasible"] == 0 && says(&pocket, "cluster"), "{pocket}");

    let squeezed = "[[start]]\nposition = [-0.3, 0.01]\n\
        [[obstacle]]\nname = \"piston\"\nshape = { box = [0.05, 0.3] }\ncenter = [0.2, 0.0]\nvelocity = [-0.2, 0.0]\n\
        [[obstacle]]\nname = \"room\"\nwall = true\nshape = { box = [0.6, 0.29] }\ncenter = [0.0, 0.0]\n";
    let squeezed = stepped("squeezed", &format!("{GOAL}{squeezed}"));
    assert!(squeezed["infeasible"].as_u64().unwrap() > 0 && says(&squeezed, "infeasible"), "{squeezed}");
}
