//! Handles: numbers in a table of what is alive. What C holds is the number, in the shape of a pointer: nothing is ever read through it,
//! so that one that is freed or was never one is found out.

use crate::failure::{Failure, TerrellaStatus};
use std::any::Any;
use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex, MutexGuard};

/// What a handle stands for: used by one thread at a time, in the process that made it.
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

/// Between two numbers, so that they look like no small whole numbers that a program might hold by mistake.
const STEP: usize = 0x10;

fn table() -> MutexGuard<'static, Table> {
    // What it holds is whole between any two statements: a panic leaves nothing half done.
    TABLE.lock().unwrap_or_else(|broken| broken.into_inner())
}

/// A new handle.
pub fn insert<H, T: Send + 'static>(kind: &'static str, value: T) -> *mut H {
    let mut table = table();
    // Never given twice: there is no end of them.
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
                false => format!("{name} is no handle of this library"),
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

/// Does something with what a handle stands for. Other threads that want the same wait.
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
        return Err(wrong(format!("{name} is no handle of {kind}")));
    };
    match value.lock() {
        Ok(mut value) => work(&mut value),
        Err(_) => Err(Failure::new(
            TerrellaStatus::TERRELLA_BROKEN,
            format!("{name} broke down in an earlier call; free it and make a new one"),
        )),
    }
}

/// Takes a handle back. What it stands for goes away when no other thread uses it any more.
pub fn remove<H>(handle: *const H, kind: &'static str, name: &str) -> Result<(), Failure> {
    let mut table = table();
    let here = check(&table, handle.addr(), kind, name)?.process == std::process::id();
    let entry = table.entries.remove(&handle.addr());
    drop(table);
    match here {
        true => drop(entry),
        // In a fork its driver would wait for threads that are not there.
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
        assert!(stray.1.contains("no handle of this library"), "{}", stray.1);
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
