//! One thing done to many, on all cores, with results in order: the same whatever the number of cores.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use crate::error::Error;

/// `work` on every item; `done` is told how many are finished, now and then.
///
/// # Errors
/// The first that failed, by the order of the items.
pub fn map<T: Sync, R: Send>(
    items: &[T],
    done: &(dyn Fn(usize) + Sync),
    work: impl Fn(&T) -> Result<R, Error> + Sync,
) -> Result<Vec<R>, Error> {
    let cores = thread::available_parallelism().map_or(1, usize::from).min(items.len().max(1));
    let (next, finished) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let all: Mutex<Vec<(usize, Result<R, Error>)>> = Mutex::new(Vec::with_capacity(items.len()));
    thread::scope(|scope| {
        for _ in 0..cores {
            scope.spawn(|| {
                while let Some((i, item)) = {
                    let i = next.fetch_add(1, Ordering::Relaxed);
                    items.get(i).map(|item| (i, item))
                } {
                    let result = work(item);
                    if let Ok(mut all) = all.lock() {
                        all.push((i, result));
                    }
                    done(finished.fetch_add(1, Ordering::Relaxed) + 1);
                }
            });
        }
    });
    let mut all = all.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    all.sort_by_key(|(i, _)| *i);
    all.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_in_order_and_the_first_failure_wins() {
        let items: Vec<u64> = (0..100).collect();
        let squares = map(&items, &|_| {}, |i| Ok(i * i)).unwrap();
        assert!(squares.iter().zip(&items).all(|(s, i)| *s == i * i));
        let failed = map(&items, &|_| {}, |i| if i % 10 == 7 { Err(Error::failed(i.to_string())) } else { Ok(()) });
        assert_eq!(failed.unwrap_err().to_string(), "7");
        assert!(map(&[] as &[u8], &|_| {}, |_| Ok(())).unwrap().is_empty());
    }
}
