//! Assembles the text of a shader from imports and conditions, see the module above.

use super::constants;
use super::files::{ShaderError, ShaderFiles};
use crate::gpu::scopes::{ErrorScope, resolved};

/// WGSL as the driver gets it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ShaderText {
    /// The lines of the shader.
    pub text: String,
    /// For each line, the file below `shaders/` that it comes from, and its line number there, from 1.
    pub origins: Vec<(&'static str, usize)>,
}

type Conditions<'a> = &'a [(&'static str, bool)];

impl ShaderText {
    /// The text of a file and its imports, from [`ShaderFiles::chosen`]. `conditions` are the only ones that `@if` may use; others are errors.
    pub fn assemble(entry: &str, conditions: Conditions<'_>) -> Result<Self, ShaderError> {
        Self::assemble_from(&ShaderFiles::chosen(), entry, conditions)
    }

    /// As [`Self::assemble`], from these files.
    fn assemble_from(
        files: &ShaderFiles,
        entry: &str,
        conditions: Conditions<'_>,
    ) -> Result<Self, ShaderError> {
        let mut out = Self::default();
        let is_there = out.import(files, entry, conditions, &mut Vec::new())?;
        is_there.then_some(out).ok_or_else(|| ShaderError {
            file: entry.to_owned(),
            line: 0,
            problem: "no such shader file".into(),
        })
    }

    /// Returns false if there is no such file. `done` lists the files and constants that are already in the text.
    fn import(
        &mut self,
        files: &ShaderFiles,
        file: &str,
        conditions: Conditions<'_>,
        done: &mut Vec<&'static str>,
    ) -> Result<bool, ShaderError> {
        let Some((file, text)) = files.file(file)? else {
            return Ok(false);
        };
        if done.contains(&file) {
            return Ok(true);
        }
        done.push(file);
        self.push(&format!("// {file}"), (file, 1));
        let error = |line, problem| ShaderError {
            file: file.to_owned(),
            line,
            problem,
        };
        let mut branches = Branches::new(conditions);
        for (number, line) in (1..).zip(text.lines()) {
            let error = |problem| error(number, problem);
            let Some(line) = branches.kept(line).map_err(error)? else {
                continue;
            };
            let Some(imported) = line.strip_prefix("import ") else {
                self.push(line, (file, number));
                continue;
            };
            let imported = imported.trim_end_matches(';').trim();
            match imported.strip_prefix("rust::") {
                Some(names) => {
                    for name in names.trim_matches(['{', '}']).split(',').map(str::trim) {
                        let (name, value) = constants::shared(name)
                            .ok_or_else(|| error(format!("no constant {name} in Rust")))?;
                        if !done.contains(&name) {
                            done.push(name);
                            self.push(&value.declaration(name), (file, number));
                        }
                    }
                }
                None if self.import(files, imported, conditions, done)? => {}
                None => return Err(error(format!("no shader file {imported}"))),
            }
        }
        match branches.open.last() {
            None => Ok(true),
            Some(branch) => Err(error(branch.line, "what @if keeps does not end".into())),
        }
    }

    /// Compiles it for a device.
    ///
    /// # Errors
    /// The compiler's first error, with its file and line.
    pub fn compile(
        &self,
        device: &wgpu::Device,
        label: &str,
    ) -> Result<wgpu::ShaderModule, ShaderError> {
        let scope = ErrorScope::open(device, wgpu::ErrorFilter::Validation);
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(label),
            source: wgpu::ShaderSource::Wgsl(self.text.as_str().into()),
        });
        let Some(error) = scope.error() else {
            return Ok(module);
        };
        let messages = resolved(module.get_compilation_info());
        let first = messages.and_then(|info| info.messages.into_iter().next());
        let line = first.as_ref().and_then(|message| message.location);
        let line = line.map_or(0, |location| {
            (location.line_number as usize).saturating_sub(1)
        });
        let (file, line) = self.origins.get(line).copied().unwrap_or_default();
        Err(ShaderError {
            file: file.to_owned(),
            line,
            problem: first.map_or_else(|| error.to_string(), |message| message.message),
        })
    }

    fn push(&mut self, line: &str, origin: (&'static str, usize)) {
        self.text += line;
        self.text.push('\n');
        self.origins.push(origin);
    }
}

/// Reads a file line by line and leaves out the parts whose condition does not hold.
struct Branches<'a> {
    conditions: Conditions<'a>,
    /// Lines that were read.
    lines: usize,
    /// Depth of open brackets.
    depth: usize,
    /// Open declarations, members and statements under conditions, outermost first.
    open: Vec<Branch>,
    /// For a following `@else`: whether the condition held for the declaration, member or statement that has just ended.
    ended: Option<bool>,
}

/// A construct under an `@if` or `@else`.
struct Branch {
    is_kept: bool,
    /// Depth of brackets at its start, and at its end.
    depth: usize,
    /// Line of its start.
    line: usize,
    has_else: bool,
}

impl<'a> Branches<'a> {
    fn new(conditions: Conditions<'a>) -> Self {
        Self {
            conditions,
            lines: 0,
            depth: 0,
            open: Vec::new(),
            ended: None,
        }
    }

    /// The text of the next line that is kept. Comments are dropped: the driver need not read them.
    fn kept<'t>(&mut self, line: &'t str) -> Result<Option<&'t str>, String> {
        self.lines += 1;
        let trimmed = line.trim_start();
        if trimmed.is_empty() || trimmed.starts_with("//") {
            return Ok(None);
        }
        let ended = self.ended.take();
        let (condition, rest) = if let Some(rest) = trimmed.strip_prefix("@if(") {
            let (all, rest) = rest.split_once(')').ok_or("@if( without )")?;
            (Some((self.hold(all)?, true)), rest.trim())
        } else if let Some(rest) = trimmed.strip_prefix("@else") {
            let held = ended.ok_or("@else stands directly after what @if keeps")?;
            (Some((!held, false)), rest.trim())
        } else {
            (None, line)
        };
        if ["@if", "@elif", "@else"]
            .iter()
            .any(|word| rest.contains(word))
        {
            return Err("@if and @else stand first in their line, and there is no @elif".into());
        }
        self.open
            .extend(condition.map(|(is_kept, has_else)| Branch {
                is_kept,
                depth: self.depth,
                line: self.lines,
                has_else,
            }));
        let is_kept = self.open.iter().all(|branch| branch.is_kept);
        let code = rest.split("//").next().unwrap_or_default().trim_end();
        for bracket in code.chars() {
            match bracket {
                '(' | '[' | '{' => self.depth += 1,
                ')' | ']' | '}' => self.depth = self.depth.saturating_sub(1),
                _ => {}
            }
        }
        let is_end =
            |branch: &mut Branch| branch.depth == self.depth && code.ends_with([';', ',', '}']);
        if let Some(branch) = self.open.pop_if(is_end) {
            self.ended = branch.has_else.then_some(branch.is_kept);
        }
        Ok((is_kept && !code.is_empty()).then_some(rest))
    }

    /// Whether all of these conditions hold.
    fn hold(&self, all: &str) -> Result<bool, String> {
        let mut hold = true;
        for wanted in all.split("&&").map(str::trim) {
            let name = wanted.trim_start_matches('!');
            let mut known = self.conditions.iter();
            let (_, holds) = known
                .find(|(known, _)| *known == name)
                .ok_or_else(|| format!("unknown condition {name}"))?;
            hold &= *holds == (name == wanted);
        }
        Ok(hold)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lines that are kept if `a` holds and `b` does not.
    fn kept(text: &str) -> Result<Vec<&str>, String> {
        let mut branches = Branches::new(&[("a", true), ("b", false)]);
        let lines = text.lines().map(|line| branches.kept(line));
        lines.filter_map(Result::transpose).collect()
    }

    #[test]
    fn a_condition_keeps_a_line() {
        let kept = |line| kept(line).unwrap();
        assert_eq!(kept("    let x = 1;"), ["    let x = 1;"]);
        assert_eq!(
            kept("    @if(a) let x = 1; // Why."),
            ["let x = 1; // Why."]
        );
        assert_eq!(kept("@if(a && !b) block: u32,"), ["block: u32,"]);
        assert!(kept("@if(a && b) block: u32,").is_empty());
        assert!(kept("@if(!a) import x.wgsl;").is_empty());
    }

    #[test]
    fn a_condition_keeps_a_whole_declaration_or_its_alternative() {
        let text = "@if(CONDITION)
@fragment
fn f(
    x: f32, // A member.
) -> f32 {
    @if(b) return 0.0;
    // Why.
    @else return 1.0;
}
// The other.
@else
fn f() -> f32 { return 2.0; }
struct After {}";
        let first = [
            "@fragment",
            "fn f(",
            "    x: f32, // A member.",
            ") -> f32 {",
            "return 1.0;",
            "}",
        ];
        let of_a = text.replace("CONDITION", "a");
        assert_eq!(
            kept(&of_a).unwrap(),
            [&first[..], &["struct After {}"]].concat()
        );
        let of_b = text.replace("CONDITION", "b");
        assert_eq!(
            kept(&of_b).unwrap(),
            ["fn f() -> f32 { return 2.0; }", "struct After {}"]
        );
    }

    #[test]
    fn misuse_is_rejected() {
        let problem = |text| kept(text).unwrap_err();
        assert_eq!(problem("@if(c) x,"), "unknown condition c");
        assert_eq!(
            problem("@if(b) fn f() {\n@if(c) x;\n}"),
            "unknown condition c"
        );
        assert_eq!(problem("@if(a x,"), "@if( without )");
        let place = "@if and @else stand first in their line, and there is no @elif";
        for text in [
            "x = 1; @if(a) y = 2;",
            "@if(a) x;\n@else @if(b) y;",
            "@if(b) x;\n@elif(a) y;",
        ] {
            assert_eq!(problem(text), place);
        }
        let alone = "@else stands directly after what @if keeps";
        for text in [
            "@else x;",
            "@if(a) x;\ny;\n@else z;",
            "@if(a) x;\n@else y;\n@else z;",
        ] {
            assert_eq!(problem(text), alone);
        }
    }

    #[test]
    fn a_declaration_without_end_is_rejected() {
        let mut branches = Branches::new(&[("a", true)]);
        for line in ["", "@if(a) fn f() {", "    x();"] {
            branches.kept(line).unwrap();
        }
        assert_eq!(branches.open.last().map(|branch| branch.line), Some(2));
    }

    #[test]
    fn lines_know_where_they_come_from() {
        let shader = ShaderText::assemble("common/air/coordinates.wgsl", &[]).unwrap();
        let at = shader
            .text
            .lines()
            .position(|line| line.contains("fn sun_coordinate"));
        let (file, number) = shader.origins[at.unwrap()];
        let (_, text) = ShaderFiles::Embedded.file(file).unwrap().unwrap();
        assert!(
            text.lines()
                .nth(number - 1)
                .unwrap()
                .contains("fn sun_coordinate")
        );
        assert_eq!(shader.text.lines().count(), shader.origins.len());
        assert!(shader.text.contains("const LOWEST_SUN: f32 = -0."));
    }

    #[test]
    fn files_of_a_folder_stand_in_for_those_compiled_in() {
        let folder = tempfile::tempdir().unwrap();
        let files = ShaderFiles::Folder(folder.path().to_owned());
        let assembled = || ShaderText::assemble_from(&files, "earth/varying.wgsl", &[("a", true)]);
        let path = folder.path().join("earth/varying.wgsl");
        let problem = || assembled().unwrap_err().to_string();
        let missing = problem();
        assert!(missing.starts_with("shaders/earth/varying.wgsl:0: cannot be read from "));
        std::fs::create_dir(path.parent().unwrap()).unwrap();
        let before = files.written();
        std::fs::write(&path, "@if(!a) x;\n@else y;").unwrap();
        assert_eq!(assembled().unwrap().text, "// earth/varying.wgsl\ny;\n");
        assert_ne!(files.written(), before);
        std::fs::write(&path, "y;\n@if(b) x;").unwrap();
        let wanted = "shaders/earth/varying.wgsl:2: unknown condition b";
        assert_eq!(problem(), wanted);
        std::fs::write(&path, " ".repeat(1 << 20) + ";").unwrap();
        let wanted = "shaders/earth/varying.wgsl:0: more than 1048576 bytes";
        assert_eq!(problem(), wanted);
    }

    #[test]
    fn a_missing_file_is_named() {
        let error = ShaderText::assemble("none.wgsl", &[]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "shaders/none.wgsl:0: no such shader file"
        );
    }
}
