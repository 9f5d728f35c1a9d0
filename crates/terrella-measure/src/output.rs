//! Where measurements are written: a folder of tables, charts, pictures and a page.

use std::path::{Path, PathBuf};
use terrella_files as files;
use terrella_play::{OutputError, PendingFile};

/// Largest table that is read back, bytes.
const MAX_READ: u64 = 64 << 20;

/// Lines of fields as CSV (RFC 4180, lines ended by \n): fields with a comma, a quotation mark or a line's end are quoted.
///
/// The first line names the columns.
pub(super) fn csv_text<Line, Field>(lines: impl IntoIterator<Item = Line>) -> String
where
    Line: IntoIterator<Item = Field>,
    Field: AsRef<[u8]>,
{
    // Flexible: all lines have as many fields by their types, so the writer need not count.
    let mut writer = csv::WriterBuilder::new()
        .flexible(true)
        .from_writer(Vec::new());
    for line in lines {
        // Writing to memory cannot fail.
        let _ = writer.write_record(line);
    }
    let bytes = writer.into_inner().unwrap_or_default();
    String::from_utf8_lossy(&bytes).into_owned()
}

/// The folder of a report.
pub(super) struct OutputFolder {
    path: PathBuf,
}

impl OutputFolder {
    /// Makes the folders and sees whether files can be made in each.
    ///
    /// # Errors
    /// A file in a folder's place, a folder that cannot be made or written to.
    pub fn open(path: &Path) -> Result<Self, OutputError> {
        for folder in [
            path.to_path_buf(),
            path.join("plots"),
            path.join("pictures"),
        ] {
            if folder.exists() && !folder.is_dir() {
                return Err(OutputError::InTheWay {
                    path: folder,
                    found: "a file",
                });
            }
            std::fs::create_dir_all(&folder).map_err(|source| OutputError::Write {
                path: folder.clone(),
                source,
            })?;
        }
        let opened = Self { path: path.into() };
        for name in [
            "index.html",
            "measurements.csv",
            "plots/try.svg",
            "pictures/try.png",
        ] {
            opened.pending(name)?;
        }
        Ok(opened)
    }

    /// Begins a file of that name, with any extension.
    ///
    /// # Errors
    /// A file that cannot be created.
    pub fn pending(&self, name: &str) -> Result<PendingFile, OutputError> {
        let (what, extension) = match name.rsplit_once('.') {
            Some((_, "csv")) => ("tables", "csv"),
            Some((_, "json")) => ("numbers", "json"),
            Some((_, "svg")) => ("charts", "svg"),
            Some((_, "png")) => ("pictures", "png"),
            _ => ("pages", "html"),
        };
        PendingFile::create(&self.path.join(name), what, extension)
    }

    /// A file's text; `None` if there is none.
    ///
    /// # Errors
    /// A file that cannot be read, or exceeds the limit of 64 MB.
    pub fn read(&self, name: &str) -> Result<Option<String>, OutputError> {
        let path = self.path.join(name);
        let failed = |source| OutputError::Read {
            path: path.clone(),
            source,
        };
        let large = || std::io::Error::other(format!("larger than {} MB", MAX_READ >> 20));
        match files::read_text(&path, MAX_READ) {
            Ok(text) => text.ok_or_else(|| failed(large())).map(Some),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(failed(error)),
        }
    }

    /// Writes a file, or leaves the one that is there.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, name: &str, contents: &[u8]) -> Result<(), OutputError> {
        self.pending(name)?.write_whole(contents)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_quoted_where_they_must_be() {
        let lines = [
            ["name", "value"],
            ["plain", "1"],
            ["a, b", "say \"x\""],
            ["two\nlines", ""],
        ];
        assert_eq!(
            csv_text(lines),
            "name,value\nplain,1\n\"a, b\",\"say \"\"x\"\"\"\n\"two\nlines\",\n"
        );
    }
}
