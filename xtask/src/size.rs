//! The task `size`: what the firmware takes, and how deep its stack went.
//!
//! The stack figure is measured, not computed: the device paints its stack before it starts, and reports
//! in its statistics how much paint is gone after a run in QEMU.

use std::process::Stdio;

use serde_json::{Value, json};

use crate::failure::Failure;
use crate::image::Image;
use crate::workspace::{Workspace, cannot_start, written};

/// How the figures are printed.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// For people.
    Table,
    /// One JSON object.
    Json,
}

/// Builds, measures, prints.
pub fn run(workspace: &Workspace, format: Format) -> Result<(), Failure> {
    workspace.build_firmware()?;
    let path = workspace.firmware();
    let bytes =
        std::fs::read(&path).map_err(|error| Failure::new(format!("cannot read {}: {error}", path.display())))?;
    let image =
        Image::read(&bytes).map_err(|clause| Failure::new(format!("cannot measure {}: {clause}", path.display())))?;
    // The other figures are good whether or not the device could be asked.
    let stack_used = stack_used(workspace);
    let reported = *stack_used.as_ref().unwrap_or(&None);
    match format {
        Format::Table => print!("{}", table(&image, reported)),
        Format::Json => println!("{}", object(&image, reported)),
    }
    stack_used.map(|_| ())
}

/// The high-water mark the device reports after two seconds of the built-in scene, if it reports one.
///
/// In real time, so that the tick interrupts the links as it does in use.
fn stack_used(workspace: &Workspace) -> Result<Option<u64>, Failure> {
    workspace.build_pliant()?;
    let mut command = workspace.command(workspace.pliant());
    command
        .args(["run", "--device", "qemu", "--headless", "--duration", "2", "--json"])
        .env("PLIANT_FIRMWARE", workspace.firmware())
        .stderr(Stdio::inherit());
    // Its exit code says whether the goal was reached, which is not asked here.
    let output = command.output().map_err(|error| cannot_start(&command, &error))?;
    let report: Value = serde_json::from_slice(&output.stdout).map_err(|_| {
        Failure::new(format!("the stack could not be measured: `{}` gave no report", written(&command)))
    })?;
    Ok(find(&report, "stack_used").and_then(Value::as_u64))
}

/// The first member of that name, however deep.
fn find<'a>(value: &'a Value, name: &str) -> Option<&'a Value> {
    match value {
        Value::Object(members) => members.get(name).or_else(|| members.values().find_map(|member| find(member, name))),
        Value::Array(items) => items.iter().find_map(|item| find(item, name)),
        _ => None,
    }
}

fn table(image: &Image, stack_used: Option<u64>) -> String {
    let Image { text, data, bss, stack_reserved } = image;
    let used = stack_used.map_or("not reported".to_owned(), |bytes| bytes.to_string());
    [
        ("text", text.to_string(), "code and constants, in flash"),
        ("data", data.to_string(), "set variables, in flash and RAM"),
        ("bss", bss.to_string(), "zeroed variables, in RAM"),
        ("stack used", used, "deepest, measured in QEMU"),
        ("stack reserved", stack_reserved.to_string(), "all other RAM"),
    ]
    .map(|(name, bytes, what)| format!("{name:<16}{bytes:>12}  {what}\n"))
    .concat()
}

fn object(image: &Image, stack_used: Option<u64>) -> Value {
    json!({
        "text": image.text,
        "data": image.data,
        "bss": image.bss,
        "stack_used": stack_used,
        "stack_reserved": image.stack_reserved,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const IMAGE: Image = Image { text: 41_800, data: 12, bss: 6_200, stack_reserved: 4_188_000 };

    #[test]
    fn a_mark_is_found_however_deep() {
        let report = json!({"ticks": 2000, "device": [{"statistics": {"stack_used": 1832}}]});
        assert_eq!(find(&report, "stack_used"), Some(&json!(1832)));
        assert_eq!(find(&report, "heap_used"), None);
    }

    #[test]
    fn an_unmeasured_stack_is_not_given_a_number() {
        assert!(table(&IMAGE, None).contains("not reported"));
        assert_eq!(object(&IMAGE, None)["stack_used"], Value::Null);
        assert_eq!(object(&IMAGE, Some(1832))["stack_used"], 1832);
    }
}
