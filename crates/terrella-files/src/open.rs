//! The one way in which files from outside are opened.

use std::fs::{self, File, FileType, Metadata, OpenOptions};
use std::io::{self, Error, ErrorKind, Read, Seek};
use std::path::Path;

/// Longest path that a file from outside may name, bytes: what every system can open.
pub const MAX_PATH_BYTES: usize = 1024;

/// Opens a file for reading.
///
/// # Errors
/// Those of the system, and anything that is no file. A pipe would wait for its writer and a device may never end, so neither is
/// opened at all.
pub fn open(path: &Path) -> io::Result<File> {
    open_with(File::options().read(true), path)
}

/// Opens a file with `options`, and creates it if they allow that.
///
/// # Errors
/// Those of [`open`].
pub fn open_with(options: &OpenOptions, path: &Path) -> io::Result<File> {
    match fs::metadata(path) {
        Ok(found) => check_is_file(&found)?,
        // The options decide whether it may be created.
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        Err(error) => return Err(error),
    }
    let file = options.open(path)?;
    // Something else may have taken its place meanwhile.
    check_is_file(&file.metadata()?)?;
    Ok(file)
}

/// All bytes of a file, or `None` if it has more than `limit`.
///
/// # Errors
/// Those of [`open`].
pub fn read(path: &Path, limit: u64) -> io::Result<Option<Vec<u8>>> {
    let file = open(path)?;
    let length = file.metadata()?.len();
    if length > limit {
        return Ok(None);
    }
    // The length is not trustworthy, since the file may grow and those of /proc have none: the read is bounded too.
    let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or_default());
    file.take(limit.saturating_add(1)).read_to_end(&mut bytes)?;
    Ok((bytes.len() as u64 <= limit).then_some(bytes))
}

/// The text of a file, or `None` if it has more than `limit` bytes.
///
/// # Errors
/// Those of [`open`], and bytes that are not UTF-8.
pub fn read_text(path: &Path, limit: u64) -> io::Result<Option<String>> {
    let not_text = |_| Error::new(ErrorKind::InvalidData, "it is not UTF-8 text");
    let bytes = read(path, limit)?;
    bytes
        .map(|bytes| String::from_utf8(bytes).map_err(not_text))
        .transpose()
}

/// The first 8 bytes of a file, which identify its format; fewer if it is shorter. The reader is reset to the start of the file.
pub fn first_bytes<R: Read + Seek>(mut reader: R) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::with_capacity(8);
    (&mut reader).take(8).read_to_end(&mut bytes)?;
    reader.rewind()?;
    Ok(bytes)
}

/// The error in a path that a file names, found before a system call whose message would repeat the path.
pub fn path_complaint(path: &Path) -> Option<String> {
    let bytes = path.as_os_str().len();
    (bytes > MAX_PATH_BYTES)
        .then(|| format!("a path has at most {MAX_PATH_BYTES} bytes, and this one {bytes}"))
}

fn check_is_file(found: &Metadata) -> io::Result<()> {
    if found.is_file() {
        return Ok(());
    }
    let kind = match found.is_dir() {
        true => ErrorKind::IsADirectory,
        false => ErrorKind::InvalidInput,
    };
    let what = format!("it is {}, not a file", kind_of(found.file_type()));
    Err(Error::new(kind, what))
}

#[cfg(unix)]
fn kind_of(kind: FileType) -> &'static str {
    use std::os::unix::fs::FileTypeExt;
    match kind {
        kind if kind.is_dir() => "a folder",
        kind if kind.is_fifo() => "a pipe",
        kind if kind.is_socket() => "a socket",
        _ => "a device",
    }
}

#[cfg(not(unix))]
fn kind_of(kind: FileType) -> &'static str {
    match kind.is_dir() {
        true => "a folder",
        false => "something else",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reading_is_bounded() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        fs::write(&path, "12345").expect("writes");
        assert_eq!(
            read(&path, 5).expect("reads").as_deref(),
            Some(&b"12345"[..])
        );
        assert_eq!(read(&path, 4).expect("reads"), None);
        assert_eq!(
            read_text(&path, 5).expect("reads").as_deref(),
            Some("12345")
        );
        // Sparse: it has no blocks, and more bytes than there is memory.
        File::create(&path)
            .and_then(|file| file.set_len(1 << 40))
            .expect("grows");
        assert_eq!(read(&path, 1 << 20).expect("looks"), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_file_that_says_it_is_empty_is_read_to_its_bound() {
        let status = Path::new("/proc/self/status");
        assert!(
            read(status, 1 << 20)
                .expect("reads")
                .is_some_and(|text| !text.is_empty())
        );
        assert_eq!(read(status, 10).expect("reads"), None);
    }

    #[cfg(unix)]
    #[test]
    fn what_is_no_file_is_rejected_at_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        let made = std::process::Command::new("mkfifo")
            .arg(at("pipe"))
            .status();
        assert!(made.expect("mkfifo starts").success());
        let _socket = std::os::unix::net::UnixListener::bind(at("socket")).expect("binds");
        let said = |path: &Path| open(path).expect_err("no file").to_string();
        assert_eq!(said(&at("pipe")), "it is a pipe, not a file");
        assert_eq!(said(&at("socket")), "it is a socket, not a file");
        assert_eq!(said(folder.path()), "it is a folder, not a file");
        assert_eq!(said(Path::new("/dev/zero")), "it is a device, not a file");
        let journal = File::options().append(true).create(true).clone();
        let error = open_with(&journal, &at("pipe")).expect_err("no file");
        assert_eq!(error.to_string(), "it is a pipe, not a file");
        assert_eq!(
            open(&at("none")).expect_err("none").kind(),
            ErrorKind::NotFound
        );
        assert!(open_with(&journal, &at("new")).is_ok());
    }
}
