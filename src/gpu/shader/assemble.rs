//! Puts the text of a shader together: imports and conditions, see the module above.

use super::constants;
use super::files::FILES;

/// What is wrong with a shader file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("shaders/{file}:{line}: {problem}")]
pub struct ShaderError {
    /// The file, below `shaders/`.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// What is wrong there.
    pub problem: String,
}

/// WGSL as the driver gets it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ShaderText {
    /// The lines of the shader.
    pub text: String,
    /// For each of its lines the file below `shaders/` that it comes from, and its number there, from 1.
    pub origins: Vec<(&'static str, usize)>,
}

type Conditions<'a> = &'a [(&'static str, bool)];

impl ShaderText {
    /// The text of a file and of all that it imports. `conditions` are those that `@if` may ask for; others are errors.
    pub fn assemble(entry: &str, conditions: Conditions<'_>) -> Result<Self, ShaderError> {
        let mut out = Self::default();
        let is_there = out.import(entry, conditions, &mut Vec::new())?;
        is_there.then_some(out).ok_or_else(|| ShaderError {
            file: entry.to_owned(),
            line: 0,
            problem: "no such shader file".into(),
        })
    }

    /// False if there is no such file. `done` are files and constants that are in the text already.
    fn import(
        &mut self,
        file: &str,
        conditions: Conditions<'_>,
        done: &mut Vec<&'static str>,
    ) -> Result<bool, ShaderError> {
        let Some((file, text)) = FILES.iter().find(|(name, _)| *name == file) else {
            return Ok(false);
        };
        if done.contains(file) {
            return Ok(true);
        }
        done.push(file);
        self.push(&format!("// {file}"), (file, 1));
        for (number, line) in (1..).zip(text.lines()) {
            let error = |problem| ShaderError {
                file: (*file).to_owned(),
                line: number,
                problem,
            };
            // Comments are for people; the driver need not read them.
            if line.trim().is_empty() || line.trim_start().starts_with("//") {
                continue;
            }
            let Some(line) = kept(line, conditions).map_err(error)? else {
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
                None if self.import(imported, conditions, done)? => {}
                None => return Err(error(format!("no shader file {imported}"))),
            }
        }
        Ok(true)
    }

    fn push(&mut self, line: &str, origin: (&'static str, usize)) {
        self.text += line;
        self.text.push('\n');
        self.origins.push(origin);
    }
}

/// What a line gives to the text: itself without its `@if`, or nothing where that does not hold.
fn kept<'a>(line: &'a str, conditions: Conditions<'_>) -> Result<Option<&'a str>, String> {
    let Some(rest) = line.trim_start().strip_prefix("@if(") else {
        return match line.contains("@if") {
            true => Err("@if stands first in its line".into()),
            false => Ok(Some(line)),
        };
    };
    let (all, rest) = rest.split_once(')').ok_or("@if( without )")?;
    let rest = rest.trim();
    let code = rest.split("//").next().unwrap_or_default().trim_end();
    let is_whole = code.ends_with([';', ',']) || code.ends_with('}') && code.contains('{');
    if !is_whole {
        return Err("what @if keeps ends in its line".into());
    }
    let mut keeps = true;
    for wanted in all.split("&&").map(str::trim) {
        let name = wanted.trim_start_matches('!');
        let (_, holds) = conditions
            .iter()
            .find(|(known, _)| *known == name)
            .ok_or_else(|| format!("unknown condition {name}"))?;
        keeps &= *holds == (name == wanted);
    }
    Ok(keeps.then_some(rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_condition_keeps_its_line() {
        let conditions = [("a", true), ("b", false)];
        let kept = |line| kept(line, &conditions);
        assert_eq!(kept("    let x = 1;"), Ok(Some("    let x = 1;")));
        assert_eq!(
            kept("    @if(a) let x = 1; // Why."),
            Ok(Some("let x = 1; // Why."))
        );
        assert_eq!(kept("@if(a && !b) block: u32,"), Ok(Some("block: u32,")));
        assert_eq!(kept("@if(a && b) block: u32,"), Ok(None));
        assert_eq!(kept("@if(!a) import x.wgsl;"), Ok(None));
    }

    #[test]
    fn misuse_is_refused() {
        let problem = |line| kept(line, &[("a", true)]).unwrap_err();
        assert_eq!(problem("@if(c) x,"), "unknown condition c");
        assert_eq!(problem("@if(a x,"), "@if( without )");
        assert_eq!(problem("@if(a) if x {"), "what @if keeps ends in its line");
        assert_eq!(
            problem("@if(a) x = max("),
            "what @if keeps ends in its line"
        );
        assert_eq!(
            problem("x = 1; @if(a) y = 2;"),
            "@if stands first in its line"
        );
    }

    #[test]
    fn lines_know_where_they_come_from() {
        let shader = ShaderText::assemble("common/air/coordinates.wgsl", &[]).unwrap();
        let at = shader
            .text
            .lines()
            .position(|line| line.contains("fn sun_coordinate"));
        let (file, number) = shader.origins[at.unwrap()];
        let (_, text) = FILES.iter().find(|(name, _)| *name == file).unwrap();
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
    fn a_missing_file_is_named() {
        let error = ShaderText::assemble("none.wgsl", &[]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "shaders/none.wgsl:0: no such shader file"
        );
    }
}
