//! Pointers that C gives, checked as far as that can be, and turned into references for the time of a call.

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

/// What the pointer points to.
///
/// # Safety
/// If it is not null it points to a value of this type that nobody changes during the call.
pub unsafe fn read<'a, T>(pointer: *const T, name: &str) -> Result<&'a T, Failure> {
    check(pointer, name)?;
    // SAFETY: not null and aligned; the rest is the caller's promise.
    Ok(unsafe { &*pointer })
}

/// Writes to where the pointer points.
///
/// # Safety
/// If it is not null there is room for a value of this type, which nobody else uses during the call.
pub unsafe fn write<T>(pointer: *mut T, name: &str, value: T) -> Result<(), Failure> {
    check(pointer, name)?;
    // SAFETY: not null and aligned; that there is room is the caller's promise. What was there is of C and needs no drop.
    unsafe { pointer.write(value) };
    Ok(())
}

/// Whether something can be written there.
pub fn check_out<T>(pointer: *mut T, name: &str) -> Result<(), Failure> {
    check(pointer.cast_const(), name)
}

/// A buffer of so many values.
///
/// # Safety
/// If it is not null it points to so many values that are initialized, and nobody else uses them during the call.
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

/// A row of values that are only read; none is needed where there are none.
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

/// A text in UTF-8; `None` for null.
///
/// # Safety
/// If it is not null it points to bytes that end with a zero byte and that nobody changes during the call.
pub unsafe fn text_if_any<'a>(
    pointer: *const c_char,
    name: &str,
) -> Result<Option<&'a str>, Failure> {
    if pointer.is_null() {
        return Ok(None);
    }
    // SAFETY: not null; that a zero byte ends it is the caller's promise.
    let text = unsafe { CStr::from_ptr(pointer) };
    match text.to_str() {
        Ok(text) => Ok(Some(text)),
        Err(error) => Err(Failure::argument(format!("{name} is not UTF-8: {error}"))),
    }
}

/// The same where null is rejected.
///
/// # Safety
/// As [`text_if_any`].
pub unsafe fn text<'a>(pointer: *const c_char, name: &str) -> Result<&'a str, Failure> {
    // SAFETY: the caller's promise is the same.
    unsafe { text_if_any(pointer, name) }?.ok_or_else(|| null(name))
}
