//! Published packages: names, versions and addresses are in the manifests, and all other places must agree.

use crate::repository::{Page, Repository};

/// The page that PyPI shows.
pub const PYPI_PAGE: &str = "crates/terrella-py/README.md";
/// The name of the module, which on PyPI belongs to another distribution.
const MODULE: &str = "terrella";
/// Features that change nothing in the public items of the library.
const NOT_DOCUMENTED: &[&str] = &[
    "default", "dx12", "gles", "maps", "metal", "vulkan", "webgl", "webgpu",
];

/// The value of a key in a table of a TOML file, as it is written there; lists may take several lines.
pub fn value<'t>(toml: &'t str, table: &str, key: &str) -> Option<&'t str> {
    let body = toml.split_once(&format!("\n[{table}]\n"))?.1;
    let body = body.split("\n[").next().unwrap_or(body);
    let after = match body.strip_prefix(&format!("{key} = ")) {
        Some(after) => after,
        None => body.split_once(&format!("\n{key} = "))?.1,
    };
    let end = match after.starts_with('[') {
        true => after.find(']')? + 1,
        false => after.find('\n').unwrap_or(after.len()),
    };
    after.get(..end)
}

fn strings(value: &str) -> impl Iterator<Item = &str> {
    value.split('"').skip(1).step_by(2)
}

/// The one string of a value that must be there.
#[track_caller]
pub fn string<'t>(toml: &'t str, table: &str, key: &str) -> &'t str {
    let found = value(toml, table, key).and_then(|value| strings(value).next());
    found.unwrap_or_else(|| panic!("[{table}] has no {key}"))
}

/// Places where a distribution other than this one would be installed: `pip install terrella`, `terrella[farm]`.
pub fn other_distributions(page: &Page, distribution: &str) -> Vec<String> {
    let is_name = |c: char| c.is_ascii_alphanumeric() || "-_".contains(c);
    let mut faults = Vec::new();
    for (number, line) in page.text.lines().enumerate() {
        let installs = line.split_once("pip install ").map_or("", |(_, rest)| rest);
        for (start, _) in line.match_indices(MODULE) {
            let word = line.get(start..).unwrap_or_default();
            let end = word.find(|c| !is_name(c)).unwrap_or(word.len());
            let (name, rest) = word.split_at(end);
            let before = line.get(..start).unwrap_or_default();
            let is_path = before.ends_with(['/', '.', '_']) || before.ends_with(is_name);
            let is_installed =
                start >= line.len() - installs.len() && !rest.starts_with(['.', ':']);
            let has_extra = rest
                .strip_prefix('[')
                .is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_lowercase()));
            if !is_path
                && (has_extra || is_installed && before.ends_with([' ', '\'']))
                && name != distribution
            {
                let number = number + 1;
                faults.push(format!(
                    "{}:{number}: {name} is not ours on PyPI, {distribution} is",
                    page.path
                ));
            }
        }
    }
    faults
}

/// Addresses of the source that differ from that of the workspace, or refer to missing files.
pub fn other_sources(page: &Page, address: &str, repository: &Repository) -> Vec<String> {
    let starts = page.text.match_indices("https://github.com/");
    let links = starts.filter_map(|(start, _)| {
        let rest = page.text.get(start..)?;
        rest.split([')', '"', '>', ' ', '\n']).next()
    });
    let ours = links.filter(|link| link.contains(MODULE));
    ours.filter_map(|link| {
        let Some(path) = link.strip_prefix(address) else {
            return Some(format!("{}: {link} is not below {address}", page.path));
        };
        let file = ["/blob/HEAD/", "/raw/HEAD/"]
            .iter()
            .find_map(|kind| path.strip_prefix(kind));
        let is_there = path.is_empty()
            || file.is_some_and(|file| !file.starts_with('/') && repository.exists(file));
        (!is_there).then(|| format!("{}: {link} leads to no file", page.path))
    })
    .collect()
}

/// Features that docs.rs would leave out of the documentation, by the manifest's list for it.
pub fn undocumented_features(manifest: &str) -> Vec<String> {
    let body = manifest
        .split_once("\n[features]\n")
        .map_or("", |(_, rest)| rest);
    let body = body.split("\n[").next().unwrap_or(body);
    let names = body.lines().filter_map(|line| {
        let name = line.split_once(" = ")?.0;
        name.starts_with(|c: char| c.is_ascii_lowercase())
            .then_some(name)
    });
    let listed = value(manifest, "package.metadata.docs.rs", "features").unwrap_or_default();
    let mut covered: Vec<&str> = strings(listed).collect();
    let mut at = 0;
    while let Some(feature) = covered.get(at).copied() {
        let brings = value(manifest, "features", feature).unwrap_or_default();
        let new: Vec<_> = strings(brings)
            .filter(|one| !covered.contains(one))
            .collect();
        covered.extend(new);
        at += 1;
    }
    names
        .filter(|name| !covered.contains(name) && !NOT_DOCUMENTED.contains(name))
        .map(str::to_owned)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page(text: &str) -> Page {
        Page {
            path: "README.md".into(),
            text: text.into(),
        }
    }

    #[test]
    fn values_are_read_from_their_tables() {
        let toml = "a = 0\n[x]\na = \"1\"\nlong = [\n  \"b\",\n  \"c\",\n]\n\n[y]\nname = \"2\"\na = \"3\"\n";
        assert_eq!(string(toml, "x", "a"), "1");
        assert_eq!(string(toml, "y", "a"), "3");
        assert_eq!(value(toml, "x", "name"), None);
        let list = value(toml, "x", "long").expect("a list");
        assert_eq!(strings(list).collect::<Vec<_>>(), ["b", "c"]);
    }

    #[test]
    fn a_strangers_distribution_is_found() {
        let faults = |text| other_distributions(&page(text), "terrella-earth").len();
        assert_eq!(faults("`pip install 'terrella[farm]'` brings Dask"), 1);
        assert_eq!(faults("pip install terrella    # compiles"), 1);
        assert_eq!(faults("the extra ``terrella[notebook]``"), 1);
        assert_eq!(faults("pip install terrella-c"), 1);
        assert_eq!(
            faults("pip install 'terrella-earth[farm]'  # the module is terrella.farm"),
            0
        );
        assert_eq!(
            faults("pip install numpy\nterrella play a.toml\n/usr/terrella[0]"),
            0
        );
    }

    #[test]
    fn an_address_elsewhere_is_found() {
        let home = "https://github.com/a/terrella";
        let faults = |text: &str| other_sources(&page(text), home, &Repository::open()).len();
        assert_eq!(
            faults(
                "[x](https://github.com/a/terrella/blob/HEAD/README.md) https://github.com/a/terrella"
            ),
            0
        );
        assert_eq!(
            faults("[x](https://github.com/b/terrella/blob/HEAD/README.md)"),
            1
        );
        assert_eq!(
            faults("![x](https://github.com/a/terrella/raw/HEAD/docs/gone.png)"),
            1
        );
        assert_eq!(
            faults("![x](https://github.com/a/terrella/docs/earth.png)"),
            1
        );
        assert_eq!(faults("<https://github.com/b/other>"), 0);
    }

    #[test]
    fn a_feature_without_documentation_is_found() {
        let manifest = "\n[package.metadata.docs.rs]\nfeatures = [\"b\"]\n\n[features]\n# A word.\na = []\nb = [\n  \"c\", \"dep:x\"\n]\nc = [\"a\"]\nd = []\nmaps = [\"d\"]\n\n[lib]\n";
        assert_eq!(undocumented_features(manifest), ["d"]);
    }
}
