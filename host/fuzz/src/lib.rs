//! What has to hold of any bytes that a reader of the host is given. The fuzz targets and the suite's own damaged files (`host/tests/damaged.rs`)
//! share it.

use pliant::import::{Layout, Order, parse};
use pliant::learn::read::{csv, lasa, npy, npz, zip};
use pliant::learn::{Demonstration, Demonstrations, LearnError};
use pliant::model::ModelFile;

/// Demonstrations with times that rise and numbers that are finite, or an error.
fn demonstrations(read: Result<Vec<Demonstration>, LearnError>) {
    if let Ok(items) = read {
        for item in &items {
            assert!(item.t.is_sorted() && item.t.len() >= 2);
            assert!(item.x.iter().flatten().all(|c| c.is_finite()));
        }
        let _ = Demonstrations::new(items);
    }
}

/// A CSV file of demonstrations.
pub fn of_csv(bytes: &[u8]) {
    demonstrations(csv::read("fuzz.csv", bytes));
}

/// A MATLAB file of demonstrations.
pub fn of_mat(bytes: &[u8]) {
    demonstrations(lasa::read("fuzz.mat", bytes));
}

/// A NumPy archive of demonstrations; and an array of one, which a checksum guards there.
pub fn of_npz(bytes: &[u8]) {
    demonstrations(npz::read("fuzz.npz", bytes));
    if let Ok(members) = zip::read(bytes) {
        assert!(members.values().map(Vec::len).sum::<usize>() <= zip::MAX_UNPACKED);
    }
    if let Ok(array) = npy::read(bytes) {
        assert_eq!(array.shape.iter().product::<usize>(), array.data.len());
    }
}

/// Another tool's model (ds-opt's YAML, lpvds' JSON): a certified one, or an error.
pub fn of_import(bytes: &[u8]) {
    for order in [Order::Rows, Order::Columns] {
        if let Ok(found) = parse("fuzz.yml", bytes, Layout { order: Some(order), ..Layout::default() }) {
            assert!(found.model.certified::<f32>() && found.model.certified::<f64>());
        }
    }
}

/// A model file: a model that reads back the same, or an error.
pub fn of_model(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Ok(model) = ModelFile::parse("fuzz.toml", text) {
        let _ = model.skill::<f32>();
        if let Ok(written) = model.to_toml() {
            assert_eq!(ModelFile::parse("again.toml", &written).ok().as_ref(), Some(&model));
        }
    }
}
