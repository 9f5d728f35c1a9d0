//! The repository's files.

use crate::source::File;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A page of documentation.
pub struct Page {
    /// Path from the root, with `/`.
    pub path: String,
    pub text: String,
}

/// The repository that this test was compiled in.
pub struct Repository {
    root: PathBuf,
}

impl Repository {
    /// The repository at the package's folder.
    pub fn open() -> Self {
        let root = std::env::var_os("CARGO_MANIFEST_DIR")
            .unwrap_or_else(|| env!("CARGO_MANIFEST_DIR").into());
        Self { root: root.into() }
    }

    /// The text of a file that must be there.
    pub fn text(&self, path: &str) -> String {
        match fs::read_to_string(self.root.join(path)) {
            Ok(text) => text,
            Err(error) => panic!("{path} cannot be read: {error}"),
        }
    }

    /// The text of a file that may be there.
    pub fn text_if_there(&self, path: &str) -> Option<String> {
        self.exists(path).then(|| self.text(path))
    }

    /// Whether the file or folder exists.
    pub fn exists(&self, path: &str) -> bool {
        self.root.join(path).exists()
    }

    /// One source file.
    pub fn rust_file(&self, path: &str) -> File {
        File::new(path, &self.text(path))
    }

    /// All source files below a folder, in the order of their paths.
    pub fn rust_files(&self, folder: &str) -> Vec<File> {
        let mut paths = Vec::new();
        self.collect(Path::new(folder), &mut paths);
        paths.retain(|path| path.ends_with(".rs"));
        paths.sort();
        paths.iter().map(|path| self.rust_file(path)).collect()
    }

    fn collect(&self, folder: &Path, paths: &mut Vec<String>) {
        let entries = fs::read_dir(self.root.join(folder));
        let entries = entries.unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        for entry in entries {
            let entry = entry.unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
            let path = folder.join(entry.file_name());
            if entry.file_name() == "target" {
                // Build output in a package that is a separate workspace.
                continue;
            }
            if entry.path().is_dir() {
                self.collect(&path, paths);
            } else {
                paths.push(path.to_string_lossy().replace('\\', "/"));
            }
        }
    }

    /// The texts of all files below a folder with this extension, as pages.
    pub fn texts(&self, folder: &str, extension: &str) -> Vec<Page> {
        let mut paths = Vec::new();
        self.collect(Path::new(folder), &mut paths);
        paths.retain(|path| Path::new(path).extension().is_some_and(|e| e == extension));
        let pages = paths.into_iter().map(|path| Page {
            text: self.text(&path),
            path,
        });
        pages.collect()
    }

    /// Names of the files directly in a folder that end so. At least one must be there.
    pub fn file_names(&self, folder: &str, extension: &str) -> Vec<String> {
        let entries = fs::read_dir(self.root.join(folder));
        let entries = entries.unwrap_or_else(|error| panic!("{folder}: {error}"));
        let mut names: Vec<_> = entries
            .flatten()
            .filter(|entry| entry.path().extension().is_some_and(|e| e == extension))
            .map(|entry| entry.file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        assert!(!names.is_empty(), "{folder} holds no .{extension}");
        names
    }

    /// The pages at the root, those of `docs/` and of the folders below it, and the page of each other folder that has one.
    pub fn pages(&self) -> Vec<Page> {
        let top = self.file_names(".", "md");
        let docs = ["docs", "docs/embedding", "docs/reference", "docs/start"];
        let docs = docs.into_iter().flat_map(|folder| {
            let names = self.file_names(folder, "md").into_iter();
            names.map(move |name| format!("{folder}/{name}"))
        });
        let folders = [
            ".github/CODE_OF_CONDUCT.md",
            ".github/SECURITY.md",
            ".github/SUPPORT.md",
            "config/README.md",
            "crates/terrella-py/README.md",
            "fuzz/README.md",
            "textures/SOURCES.md",
            "tests/goldens/README.md",
        ];
        let folders = folders.iter().map(|path| (*path).to_string());
        top.into_iter()
            .chain(docs)
            .chain(folders.filter(|path| self.exists(path)))
            .map(|path| Page {
                text: self.text(&path),
                path,
            })
            .collect()
    }

    /// Path and size in bytes of every tracked file; `None` outside a git checkout.
    pub fn tracked_sizes(&self) -> Option<Vec<(String, u64)>> {
        if !self.exists(".git") {
            return None;
        }
        let git = Command::new("git")
            .arg("-C")
            .arg(&self.root)
            .args(["ls-files", "-z"])
            .output();
        let output = git.unwrap_or_else(|error| panic!("git cannot be started: {error}"));
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "git ls-files failed: {said}");
        let paths = String::from_utf8_lossy(&output.stdout).into_owned();
        let sizes: Vec<_> = paths
            .split('\0')
            .filter(|path| !path.is_empty())
            // A tracked file may be deleted in the working tree: then it has no size any more. A link is as long as its path.
            .filter_map(|path| {
                Some((
                    path.to_string(),
                    fs::symlink_metadata(self.root.join(path)).ok()?.len(),
                ))
            })
            .collect();
        assert!(!sizes.is_empty(), "git names no tracked file");
        Some(sizes)
    }
}
