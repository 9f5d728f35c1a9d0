//! `cargo xtask numbers`: generates the numbers on the pages from the runs recorded in `docs/recorded/`.
//!
//! To add a figure: a line in a [`recordings::Found::Figures`]. To add a table: an entry in [`tables::TABLES`] (and one in
//! [`recordings::RECORDINGS`] if its run is not recorded yet), the lines `<!-- numbers NAME -->` and `<!-- end numbers -->` on a page, then `cargo
//! xtask numbers --measure RECORDING`.
//!
//! | file | what |
//! |---|---|
//! | `recordings` | which runs are recorded, and the command of each |
//! | `tables` | which text is made of which run; the functions stand in files by subject |
//! | `record` | the recorded file: where it was measured, and what |
//! | `markers` | pages and the text between their markers |
//! | `measure`, `printed`, `whereabouts` | running the command, what of its output is recorded, and on what machine |

mod air;
mod bench;
mod markdown;
mod markers;
mod measure;
mod orbits;
mod peers;
mod printed;
mod record;
mod recordings;
mod report;
mod stability;
mod surfaces;
mod tables;
mod terrain;
mod whereabouts;

use crate::files::write_bytes;
use crate::process::{repository_root, say};
use anyhow::{Context, bail};
use record::Recorded;
use recordings::RECORDINGS;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use tables::{TABLES, Table};

/// Rewrites the pages, after the requested measurements: `None` for no measurement, an empty list for all.
pub fn run(wanted: Option<&[String]>) -> anyhow::Result<()> {
    let root = repository_root();
    if let Some(names) = wanted {
        measure::all(&root, names)?;
    }
    for page in pages(&root)? {
        if page.now == page.made {
            continue;
        }
        fs::write(&page.path, &page.made)
            .with_context(|| format!("cannot write {}", page.path.display()))?;
        say(format_args!("rewrote {}", page.name(&root)));
    }
    Ok(())
}

/// Stores a run that a command outside this module has measured, rewrites the pages, and returns the table of the run's name. `head` has the
/// metadata that the machine does not tell.
///
/// # Errors
/// A name that no recording has, and a run that the pages cannot read.
pub fn store(name: &str, head: &[(&'static str, String)], body: &str) -> anyhow::Result<String> {
    let root = repository_root();
    let recording = RECORDINGS.iter().find(|recording| recording.name == name);
    let recording = recording.with_context(|| format!("there is no recording {name:?}"))?;
    let head: Vec<_> = head
        .iter()
        .cloned()
        .chain(whereabouts::of_this_run())
        .collect();
    let text = record::written(recording.file, &head, body)?;
    let path = root.join(record::FOLDER).join(recording.file);
    write_bytes(&path, text.as_bytes())?;
    say(format_args!("recorded {}", path.display()));
    run(None)?;
    let table = texts(&root)?.remove(name);
    table.with_context(|| format!("no table of tables.rs is called {name:?}"))
}

/// A page with markers.
struct Page {
    path: PathBuf,
    /// The current text.
    now: String,
    /// The text generated from the recorded runs.
    made: String,
}

impl Page {
    /// The page's path from the root.
    fn name(&self, root: &Path) -> String {
        let path = self.path.strip_prefix(root).unwrap_or(&self.path);
        path.display().to_string()
    }
}

/// All pages with markers, with the text generated from the recorded runs.
///
/// Returns an error for a marker without a table and for a table without a marker.
fn pages(root: &Path) -> anyhow::Result<Vec<Page>> {
    let mut paths = vec![root.join("README.md")];
    let docs = root.join("docs");
    let entries = fs::read_dir(&docs).with_context(|| format!("cannot read {}", docs.display()))?;
    for entry in entries {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "md") {
            paths.push(path);
        }
    }
    paths.sort();
    let mut texts = texts(root)?;
    let mut used = BTreeSet::new();
    let mut pages = Vec::new();
    for path in paths {
        let now =
            fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?;
        let made = markers::rewritten(&now, &mut |name| {
            let Some(text) = texts.get(name) else {
                bail!("no table of xtask/src/numbers/tables.rs and no recorded figure is called {name:?}");
            };
            used.insert(name.to_owned());
            Ok(text.clone())
        })
        .with_context(|| path.display().to_string())?;
        pages.push(Page { path, now, made });
    }
    texts.retain(|name, _| !used.contains(name));
    if let Some(name) = texts.keys().next() {
        bail!(
            "no page has {name:?}: put `<!-- numbers {name} -->` and `<!-- end numbers -->` on one, or take \
             it out of xtask/src/numbers/tables.rs or, a figure, of its recording"
        );
    }
    Ok(pages)
}

/// The text of each table by its name, and of each figure by its recording's name and its own.
fn texts(root: &Path) -> anyhow::Result<BTreeMap<String, String>> {
    let mut recorded = BTreeMap::new();
    for recording in RECORDINGS {
        recorded.insert(recording.name, Recorded::load(root, recording)?);
    }
    let mut texts = BTreeMap::new();
    for Table {
        name,
        recording,
        text,
    } in TABLES
    {
        let Some(run) = recorded.get(recording) else {
            bail!(
                "the table {name:?} is of a recording {recording:?}, which recordings.rs does not have"
            );
        };
        let text = text(run).with_context(|| format!("the table {name:?} of {}", run.file()))?;
        if texts.insert((*name).to_owned(), text).is_some() {
            bail!("tables.rs has two tables called {name:?}");
        }
    }
    for (recording, run) in &recorded {
        if run.has_figures() {
            for row in run.rows()? {
                let name = format!("{recording} {}", row.text("name")?);
                if texts.insert(name, row.text("value")?.to_owned()).is_some() {
                    bail!(
                        "{}: two figures are called {:?}",
                        run.file(),
                        row.text("name")?
                    );
                }
            }
        } else if TABLES.iter().all(|table| table.recording != *recording) {
            bail!("no table of tables.rs is made of the recording {recording:?}");
        }
    }
    Ok(texts)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rule that this module is for.
    #[test]
    fn pages_say_what_the_recorded_runs_give() {
        let root = repository_root();
        let pages = pages(&root).unwrap_or_else(|error| panic!("{error:#}"));
        let differ: Vec<_> = pages
            .iter()
            .filter(|page| page.now != page.made)
            .map(|page| {
                let lines = page.now.lines().zip(page.made.lines());
                let first = lines.enumerate().find(|(_, (now, made))| now != made);
                let first = first.map(|(n, (now, made))| {
                    format!("line {}:\n  it says  {now}\n  recorded {made}", n + 1)
                });
                format!("{}: {}", page.name(&root), first.unwrap_or_default())
            })
            .collect();
        assert!(
            differ.is_empty(),
            "numbers differ from the recorded runs; `cargo xtask numbers` rewrites them:\n{}",
            differ.join("\n")
        );
    }

    #[test]
    fn every_recorded_file_is_of_a_recording() {
        let folder = repository_root().join(record::FOLDER);
        for entry in fs::read_dir(folder).unwrap() {
            let file = entry.unwrap().file_name().into_string().unwrap();
            assert!(
                RECORDINGS.iter().any(|recording| recording.file == file),
                "docs/recorded/{file} belongs to no recording"
            );
        }
    }
}
