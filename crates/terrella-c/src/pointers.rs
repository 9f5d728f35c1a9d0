//! Checks pointers from C as far as possible, and turns them into references for the duration of a call.

use crate::failure::{Failure, TerrellaStatus};
use std::ffi::{CStr, c_char};

fn null(name: &str) -> Failure {
    Failure::new(TerrellaStatus::TERRELLA_NULL, format!("{name} is null"))
}

fn check<T>(pointer: *const T, name: &str) -> Result<(), Failure> {
    if pointer.is_null() {
        return Err(null(name));
    }
    match pointer.is_aligned() {
        true => Ok(()),
        false => Err(Failure::argument(format!(
            "{name} is not aligned to {} bytes",
            align_of::<T>()
        ))),
    }
}

/// The value that the pointer points to.
///
/// # Safety
/// A pointer that is not null points to a value of this type that nobody changes during the call.
pub unsafe fn read<'a, T>(pointer: *const T, name: &str) -> Result<&'a T, Failure> {
    check(pointer, name)?;
    // SAFETY: not null and aligned; the rest is the caller's promise.
    Ok(unsafe { &*pointer })
}

/// Writes a value through the pointer.
///
/// # Safety
/// A pointer that is not null points to memory for a value of this type, which nobody else uses during the call.
pub unsafe fn write<T>(pointer: *mut T, name: &str, value: T) -> Result<(), Failure> {
    check(pointer, name)?;
    // SAFETY: not null and aligned; the caller promises the memory. The old value belongs to C and needs no drop.
    unsafe { pointer.write(value) };
    Ok(())
}

/// Checks that the pointer is aligned and not null.
pub fn check_out<T>(pointer: *mut T, name: &str) -> Result<(), Failure> {
    check(pointer.cast_const(), name)
}

/// A buffer of `count` values.
///
/// # Safety
/// A pointer that is not null points to `count` initialized values, and nobody else uses them during the call.
pub unsafe fn buffer<'a, T: Copy>(
    pointer: *mut T,
    count: usize,
    name: &str,
) -> Result<&'a mut [T], Failure> {
    check(pointer, name)?;
    if count
        .checked_mul(size_of::<T>())
        .is_none_or(|bytes| bytes > isize::MAX as usize)
    {
        return Err(Failure::argument(format!(
            "{name}: {count} values are more than a buffer can hold"
        )));
    }
    // SAFETY: not null, aligned and no larger than an allocation can be; the rest is the caller's promise.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, count) })
}

/// A read-only slice of `count` values. The pointer is not read if `count` is 0.
///
/// # Safety
/// As [`buffer`], but others may read them.
pub unsafe fn row<'a, T>(pointer: *const T, count: usize, name: &str) -> Result<&'a [T], Failure> {
    if count == 0 {
        return Ok(&[]);
    }
    check(pointer, name)?;
    if count
        .checked_mul(size_of::<T>())
        .is_none_or(|bytes| bytes > isize::MAX as usize)
    {
        return Err(Failure::argument(format!(
            "{name}: {count} values are more than a row can hold"
        )));
    }
    // SAFETY: as in `buffer`.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// A UTF-8 text; `None` for null.
///
/// # Safety
/// A pointer that is not null points to bytes that end with a zero byte and that nobody changes during the call.
pub unsafe fn text_if_any<'a>(
    pointer: *const c_char,
    name: &str,
) -> Result<Option<&'a str>, Failure> {
    if pointer.is_null() {
        return Ok(None);
    }
    // SAFETY: not null; the caller promises the final zero byte.
    let text = unsafe { CStr::from_ptr(pointer) };
    match text.to_str() {
        Ok(text) => Ok(Some(text)),
        Err(error) => Err(Failure::argument(format!("{name} is not UTF-8: {error}"))),
    }
}

/// Same as [`text_if_any`], but rejects null.
///
/// # Safety
/// As [`text_if_any`].
pub unsafe fn text<'a>(pointer: *const c_char, name: &str) -> Result<&'a str, Failure> {
    // SAFETY: the caller's promise is the same.
    unsafe { text_if_any(pointer, name) }?.ok_or_else(|| null(name))
}
