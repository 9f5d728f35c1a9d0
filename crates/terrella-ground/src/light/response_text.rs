//! Camera response files in the format of Columbia University's database DoRF.
//!
//! Source: Grossberg and Nayar 2003, "What is the space of camera response functions?", CVPR, and the file `dorfCurves.txt` that they
//! publish. Each curve has six lines: its name, its type, `I =`, irradiances, `B =`, brightness. Both lists have 1024 numbers in 0…1.

use super::Response;

/// Maximum file size, bytes; the whole database has 5 MB.
pub const MAX_RESPONSE_BYTES: u64 = 16 << 20;
/// Maximum numbers of one list.
const MAX_NUMBERS: usize = 4096;
/// Maximum characters of a name.
const MAX_NAME: usize = 100;
/// Maximum names in a message.
const MAX_LISTED: usize = 30;
/// Name endings of the curves of one group.
const CHANNELS: [&str; 3] = ["red", "green", "blue"];

/// Why a text contains no camera response.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum ResponseError {
    /// A line that does not match the format.
    #[error(
        "line {line}: {problem}; a curve is a name, a type, \"I =\", its numbers, \"B =\" and as many numbers"
    )]
    Line { line: usize, problem: String },
    /// No curve has the given name.
    #[error("there is no response named {name:?}; the file has {known}")]
    Unknown { name: String, known: String },
    /// Several curves without a chosen name.
    #[error("the file has several responses; give the name of one: {known}")]
    Several { known: String },
}

/// A curve in the file.
struct Curve {
    name: String,
    /// Brightness at [`Response::SAMPLES`] irradiances.
    samples: Vec<f32>,
}

impl Response {
    /// The names of all curves of a text in the format of DoRF.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn names(text: &str) -> Result<Vec<String>, ResponseError> {
        Ok(curves(text)?.into_iter().map(|curve| curve.name).collect())
    }

    /// Reads a response from a text in the format of DoRF.
    ///
    /// `name` is that of a curve, which then serves all channels. Or it is the part before `Red`, `Green` and `Blue` in the names of three curves.
    /// Without a name the file must contain one curve or one such group of three. Irradiances may be unevenly spaced; the response is resampled at
    /// even ones.
    ///
    /// # Errors
    /// A text in another format, numbers that do not increase or leave 0…1, or an unknown name.
    pub fn read(text: &str, name: Option<&str>) -> Result<Self, ResponseError> {
        let curves = curves(text)?;
        let find = |name: &str| curves.iter().find(|curve| curve.name == name);
        let groups = groups(&curves);
        let of_group = |(name, [red, green, blue]): &(&str, [&Curve; 3])| {
            Self::of_curves(name, [&red.samples, &green.samples, &blue.samples])
        };
        let of_one =
            |curve: &Curve| Self::of_curves(&curve.name, [&curve.samples; 3].map(Vec::as_slice));
        let Some(name) = name else {
            return match (curves.as_slice(), groups.as_slice()) {
                ([curve], _) => Ok(of_one(curve)),
                ([_, _, _], [group]) => Ok(of_group(group)),
                _ => Err(ResponseError::Several {
                    known: listed(&curves, &groups),
                }),
            };
        };
        if let Some(curve) = find(name) {
            return Ok(of_one(curve));
        }
        match groups.iter().find(|(group, _)| *group == name) {
            Some(group) => Ok(of_group(group)),
            None => Err(ResponseError::Unknown {
                name: name.chars().take(MAX_NAME).collect(),
                known: listed(&curves, &groups),
            }),
        }
    }
}

/// Groups of curves whose names differ only in the channel, with the part before the channel.
fn groups(curves: &[Curve]) -> Vec<(&str, [&Curve; 3])> {
    let first = curves.iter().filter_map(|red| {
        let base = base(&red.name, CHANNELS[0])?;
        let of = |channel| {
            let mut found = curves.iter();
            found.find(|curve| self::base(&curve.name, channel) == Some(base))
        };
        Some((base, [red, of(CHANNELS[1])?, of(CHANNELS[2])?]))
    });
    first.collect()
}

/// The part of a name before this channel ending.
fn base<'n>(name: &'n str, channel: &str) -> Option<&'n str> {
    let at = name.len().checked_sub(channel.len())?;
    let (base, end) = name.split_at_checked(at)?;
    let base = base.trim_end_matches([' ', '-', '_']);
    (end.eq_ignore_ascii_case(channel) && !base.is_empty()).then_some(base)
}

/// Names for a message; a group's name replaces its curves.
fn listed(curves: &[Curve], groups: &[(&str, [&Curve; 3])]) -> String {
    let is_grouped = |curve: &Curve| {
        let mut members = groups.iter().flat_map(|(_, members)| members);
        members.any(|member| member.name == curve.name)
    };
    let alone = curves.iter().filter(|curve| !is_grouped(curve));
    let groups = groups.iter().map(|(name, _)| *name);
    let names: Vec<_> = groups
        .chain(alone.map(|curve| curve.name.as_str()))
        .map(|name| format!("{name:?}"))
        .collect();
    let more = match names.len().saturating_sub(MAX_LISTED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    names[..names.len().min(MAX_LISTED)].join(", ") + &more
}

/// All curves of a text, at least one.
fn curves(text: &str) -> Result<Vec<Curve>, ResponseError> {
    let lines = (1..).zip(text.lines().map(str::trim));
    let mut lines = lines.filter(|(_, line)| !line.is_empty()).peekable();
    let mut curves = Vec::<Curve>::new();
    let last = text.lines().count().max(1);
    while let Some((line, name)) = lines.next() {
        let error = |line, problem: String| ResponseError::Line { line, problem };
        let is_name = name.chars().count() <= MAX_NAME && !name.chars().any(char::is_control);
        if !is_name || is_number(name) {
            return Err(error(line, "no name of a curve".to_owned()));
        }
        if curves.iter().any(|curve| curve.name == name) {
            return Err(error(line, format!("a second curve {name:?}")));
        }
        let ended = || error(last, format!("the curve {name:?} ends"));
        // The database calls this the type of the graph.
        lines.next().ok_or_else(ended)?;
        let mut list = |letter: char| -> Result<(usize, Vec<f64>), ResponseError> {
            let (line, head) = lines.next().ok_or_else(ended)?;
            let rest = head.strip_prefix(letter).map(str::trim_start);
            let rest = rest.and_then(|rest| rest.strip_prefix('='));
            let rest = rest.ok_or_else(|| error(line, format!("no \"{letter} =\"")))?;
            let mut numbers = Vec::new();
            read_numbers(line, rest, &mut numbers)?;
            while let Some((line, words)) = lines.next_if(|(_, words)| is_number(words)) {
                read_numbers(line, words, &mut numbers)?;
            }
            Ok((line, numbers))
        };
        let (line_i, irradiance) = list('I')?;
        let (line_b, brightness) = list('B')?;
        let counts = (irradiance.len(), brightness.len());
        if counts.0 != counts.1 || counts.0 < 2 {
            let problem = format!("{} irradiances and {} of brightness", counts.0, counts.1);
            return Err(error(line_b, problem));
        }
        if let Some(n) = irradiance.windows(2).position(|pair| pair[0] >= pair[1]) {
            let problem = format!("irradiance {} of {name:?} does not rise", n + 2);
            return Err(error(line_i, problem));
        }
        if let Some(n) = brightness.windows(2).position(|pair| pair[0] > pair[1]) {
            let problem = format!("brightness {} of {name:?} falls", n + 2);
            return Err(error(line_b, problem));
        }
        curves.push(Curve {
            name: name.to_owned(),
            samples: resampled(&irradiance, &brightness),
        });
    }
    match curves.is_empty() {
        true => Err(ResponseError::Line {
            line: last,
            problem: "no curve".to_owned(),
        }),
        false => Ok(curves),
    }
}

/// Whether a line begins with a number.
fn is_number(line: &str) -> bool {
    let word = line.split([' ', '\t', ',']).next().unwrap_or_default();
    word.parse::<f64>().is_ok()
}

/// Appends the numbers of a line.
fn read_numbers(line: usize, words: &str, numbers: &mut Vec<f64>) -> Result<(), ResponseError> {
    let words = words.split([' ', '\t', ',']);
    for word in words.filter(|word| !word.is_empty()) {
        let number = word.parse::<f64>().ok();
        let number = number.filter(|number| (0.0..=1.0).contains(number));
        let excerpt: String = word.chars().take(20).collect();
        let number = number.ok_or_else(|| ResponseError::Line {
            line,
            problem: format!("{excerpt:?} is no number from 0 to 1"),
        })?;
        if numbers.len() == MAX_NUMBERS {
            return Err(ResponseError::Line {
                line,
                problem: format!("more than {MAX_NUMBERS} numbers"),
            });
        }
        numbers.push(number);
    }
    Ok(())
}

/// Brightness at even irradiances, linear between the given points and constant beyond them.
fn resampled(irradiance: &[f64], brightness: &[f64]) -> Vec<f32> {
    let last = (Response::SAMPLES - 1) as f64;
    let at = |sample: usize| {
        let wanted = sample as f64 / last;
        let high = irradiance.partition_point(|i| *i < wanted);
        let high = high.clamp(1, irradiance.len() - 1);
        let (low_i, high_i) = (irradiance[high - 1], irradiance[high]);
        let part = ((wanted - low_i) / (high_i - low_i)).clamp(0.0, 1.0);
        (brightness[high - 1] + (brightness[high] - brightness[high - 1]) * part) as f32
    };
    (0..Response::SAMPLES).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn curve(name: &str, brightness: impl Fn(f64) -> f64) -> String {
        let irradiance = (0..1024).map(|n| f64::from(n) / 1023.0);
        let list = |numbers: Vec<f64>| {
            let words: Vec<_> = numbers.iter().map(|n| format!("{n:.6}")).collect();
            words.join(" ")
        };
        format!(
            "{name}\nB=f(I)\nI =\n{}\nB =\n{}\n",
            list(irradiance.clone().collect()),
            list(irradiance.map(brightness).collect())
        )
    }

    fn at(response: Response, light: f64) -> DVec3 {
        response.brightness(DVec3::splat(light))
    }

    #[test]
    fn a_curve_is_found_by_its_name_and_three_by_what_they_share() {
        let text = curve("gamma", |x| x.powf(1.0 / 2.2))
            + &curve("someFilmRed", |x| x)
            + &curve("someFilmGreen", |x| x * x)
            + &curve("someFilmBlue", |x| x.sqrt());
        let gamma = Response::read(&text, Some("gamma")).expect("a curve");
        assert_eq!(gamma.name(), "gamma");
        assert!((at(gamma, 0.5) - DVec3::splat(0.5_f64.powf(1.0 / 2.2))).length() < 1e-5);
        let film = Response::read(&text, Some("someFilm")).expect("three curves");
        assert!((at(film, 0.5) - DVec3::new(0.5, 0.25, 0.5_f64.sqrt())).length() < 1e-5);
        let green = Response::read(&text, Some("someFilmGreen")).expect("one of them");
        assert!((at(green, 0.5) - DVec3::splat(0.25)).length() < 1e-5);
        let error = Response::read(&text, None).expect_err("which?").to_string();
        assert!(error.contains("\"someFilm\", \"gamma\""), "{error}");
        assert_eq!(
            Response::names(&text).expect("curves"),
            ["gamma", "someFilmRed", "someFilmGreen", "someFilmBlue"]
        );
        let error = Response::read(&text, Some("Film")).expect_err("none");
        assert!(
            error
                .to_string()
                .contains("there is no response named \"Film\"")
        );
        // A single curve needs no name.
        let alone = curve("gamma", |x| x);
        Response::read(&alone, None).expect("the only one");
        let three = &text[text.find("someFilmRed").expect("there")..];
        assert_eq!(Response::read(three, None), Ok(film));
    }

    #[test]
    fn uneven_irradiances_are_sampled_again() {
        let text = "few\ntype\nI = 0 0.25\n1\nB = 0.1, 0.6\n0.9";
        let response = Response::read(text, None).expect("three samples in two lines");
        for (light, wanted) in [
            (0.0, 0.1),
            (0.125, 0.35),
            (0.25, 0.6),
            (0.625, 0.75),
            (1.0, 0.9),
        ] {
            assert!((at(response, light).x - wanted).abs() < 1e-3, "{light}");
        }
    }

    #[test]
    fn what_is_no_response_is_rejected_with_its_line() {
        for (text, words) in [
            ("", "line 1: no curve"),
            ("0.5 0.6", "line 1: no name"),
            ("a", "line 1: the curve \"a\" ends"),
            ("a\ntype\nI =\n0 1\n", "line 4: the curve \"a\" ends"),
            ("a\ntype\nB =\n0 1\n", "line 3: no \"I =\""),
            (
                "a\ntype\nI =\n0 1\nB =\n0\n",
                "line 5: 2 irradiances and 1 of",
            ),
            (
                "a\ntype\nI =\n0 0.5 0.5 1\nB =\n0 0 0 1\n",
                "line 3: irradiance 3 of \"a\" does not rise",
            ),
            (
                "a\ntype\nI =\n0 0.5 1\nB =\n0 0.7 0.6\n",
                "line 5: brightness 3 of \"a\" falls",
            ),
            (
                "a\ntype\nI =\n0 1.5\nB =\n0 1\n",
                "line 4: \"1.5\" is no number from 0 to 1",
            ),
            (
                "a\ntype\nI =\n0 nan\nB =\n0 1\n",
                "line 4: \"nan\" is no number",
            ),
            (
                "a\ntype\nI =\n0 1\nB =\n0 1\na\ntype\nI =\n0 1\nB =\n0 1\n",
                "line 7: a second curve",
            ),
        ] {
            let error = Response::read(text, None).expect_err(text).to_string();
            assert!(error.contains(words), "{text:?}: {error}");
        }
        let many = vec!["0.5"; MAX_NUMBERS + 1].join(" ");
        let error = Response::read(&format!("a\ntype\nI =\n{many}"), None);
        assert!(
            error
                .expect_err("too many")
                .to_string()
                .contains("more than 4096")
        );
    }
}
