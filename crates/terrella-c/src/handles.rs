//! Handles: numbers that index a table of live objects. C holds the number in the type of a pointer. The library never dereferences it, so that it
//! detects a freed or invalid handle.

use crate::failure::{Failure, TerrellaStatus};
use std::any::Any;
use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex, MutexGuard};

/// The object behind a handle. One thread at a time uses it, in the process that created it.
struct Entry {
    kind: &'static str,
    process: u32,
    value: Arc<dyn Any + Send + Sync>,
}

#[derive(Default)]
struct Table {
    last: usize,
    entries: HashMap<usize, Entry>,
}

static TABLE: LazyLock<Mutex<Table>> = LazyLock::new(Mutex::default);

/// Difference between two handles. It keeps them unlike the small integers that a program might pass by mistake.
const STEP: usize = 0x10;

fn table() -> MutexGuard<'static, Table> {
    // Every statement leaves the table consistent, so a panic cannot leave a partial change.
    TABLE.lock().unwrap_or_else(|broken| broken.into_inner())
}

/// Creates a handle.
pub fn insert<H, T: Send + 'static>(kind: &'static str, value: T) -> *mut H {
    let mut table = table();
    // Numbers are never reused.
    table.last += STEP;
    let number = table.last;
    let value = Arc::new(Mutex::new(value));
    table.entries.insert(
        number,
        Entry {
            kind,
            process: std::process::id(),
            value,
        },
    );
    std::ptr::without_provenance_mut(number)
}

fn wrong(words: String) -> Failure {
    Failure::new(TerrellaStatus::TERRELLA_HANDLE, words)
}

fn check<'t>(
    table: &'t Table,
    number: usize,
    kind: &str,
    name: &str,
) -> Result<&'t Entry, Failure> {
    if number == 0 {
        let words = format!("{name} is null");
        return Err(Failure::new(TerrellaStatus::TERRELLA_NULL, words));
    }
    let Some(entry) = table.entries.get(&number) else {
        return Err(wrong(
            match number <= table.last && number.is_multiple_of(STEP) {
                true => format!("{name} is freed already"),
                false => format!("{name} is not a handle of this library"),
            },
        ));
    };
    match entry.kind == kind {
        true => Ok(entry),
        false => Err(wrong(format!(
            "{name} is a handle of {}, not of {kind}",
            entry.kind
        ))),
    }
}

/// Calls `work` with the object behind a handle. Other threads that use the same handle wait.
pub fn with<H, T: Send + 'static, R>(
    handle: *const H,
    kind: &'static str,
    name: &str,
    work: impl FnOnce(&mut T) -> Result<R, Failure>,
) -> Result<R, Failure> {
    let value = {
        let table = table();
        let entry = check(&table, handle.addr(), kind, name)?;
        if entry.process != std::process::id() {
            return Err(Failure::new(
                TerrellaStatus::TERRELLA_FORKED,
                format!(
                    "{name} was made in process {} and is used in its fork; make it in the process that draws",
                    entry.process
                ),
            ));
        }
        Arc::clone(&entry.value)
    };
    let Some(value) = value.downcast_ref::<Mutex<T>>() else {
        return Err(wrong(format!("{name} is not a handle of {kind}")));
    };
    match value.lock() {
        Ok(mut value) => work(&mut value),
        Err(_) => Err(Failure::new(
            TerrellaStatus::TERRELLA_BROKEN,
            format!("{name} broke down in an earlier call; free it and make a new one"),
        )),
    }
}

/// Frees a handle. Its object is dropped when no other thread uses it any more.
pub fn remove<H>(handle: *const H, kind: &'static str, name: &str) -> Result<(), Failure> {
    let mut table = table();
    let here = check(&table, handle.addr(), kind, name)?.process == std::process::id();
    let entry = table.entries.remove(&handle.addr());
    drop(table);
    match here {
        true => drop(entry),
        // In a forked process the driver would wait for threads that do not exist there.
        false => std::mem::forget(entry),
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Thing;

    #[test]
    fn misuse_is_seen() {
        let handle: *mut Thing = insert("a thing", 5_i32);
        with(handle, "a thing", "thing", |value: &mut i32| {
            *value += 1;
            Ok(())
        })
        .expect("alive");
        let use_it = |handle: *mut Thing, kind| {
            let result = with(handle, kind, "thing", |_: &mut i32| Ok(()));
            result.map_err(|failure| (failure.status, failure.words))
        };
        let other = use_it(handle, "a scene").expect_err("another kind");
        assert_eq!(other.0, TerrellaStatus::TERRELLA_HANDLE);
        assert!(
            other.1.contains("a handle of a thing, not of a scene"),
            "{}",
            other.1
        );
        remove(handle, "a thing", "thing").expect("freed once");
        let freed = use_it(handle, "a thing").expect_err("freed");
        assert_eq!(
            freed,
            (
                TerrellaStatus::TERRELLA_HANDLE,
                "thing is freed already".into()
            )
        );
        let twice = remove(handle, "a thing", "thing").expect_err("freed twice");
        assert_eq!(twice.status, TerrellaStatus::TERRELLA_HANDLE);
        let null = use_it(std::ptr::null_mut(), "a thing").expect_err("null");
        assert_eq!(null.0, TerrellaStatus::TERRELLA_NULL);
        let local = 0_i32;
        let stray = use_it((&raw const local).cast_mut().cast(), "a thing").expect_err("stray");
        assert!(
            stray.1.contains("not a handle of this library"),
            "{}",
            stray.1
        );
    }

    #[test]
    fn a_handle_freed_during_a_call_lives_until_its_end() {
        let handle: *mut Thing = insert("a thing", vec![1, 2, 3]);
        let number = handle.addr();
        let seen = with(handle, "a thing", "thing", |value: &mut Vec<i32>| {
            let other = std::thread::spawn(move || {
                let handle: *mut Thing = std::ptr::without_provenance_mut(number);
                remove(handle, "a thing", "thing").is_ok()
            });
            assert!(other.join().expect("a thread"));
            value.push(4);
            Ok(value.len())
        });
        assert_eq!(seen.expect("alive"), 4);
        let later = with(handle, "a thing", "thing", |_: &mut Vec<i32>| Ok(())).expect_err("freed");
        assert_eq!(later.status, TerrellaStatus::TERRELLA_HANDLE);
    }

    #[test]
    fn what_broke_down_stays_so() {
        let handle: *mut Thing = insert("a thing", 0_i32);
        let broke = crate::failure::answer(|| {
            with(handle, "a thing", "thing", |_: &mut i32| {
                panic!("deliberate")
            })
        });
        assert_eq!(broke, TerrellaStatus::TERRELLA_BROKEN);
        let again = with(handle, "a thing", "thing", |_: &mut i32| Ok(())).expect_err("broken");
        assert_eq!(again.status, TerrellaStatus::TERRELLA_BROKEN);
        remove(handle, "a thing", "thing").expect("freed");
    }
}
