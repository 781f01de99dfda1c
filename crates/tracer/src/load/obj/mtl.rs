//! The statements of a material library (MTL).

use std::collections::{BTreeMap, HashMap};

use glam::Vec3;

use crate::load::text::{finite_number, numbered_lines, quoted};

/// A material as a library defines it; what is `None` was not given.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Definition {
    /// `Kd`.
    pub(super) diffuse: Option<Vec3>,
    /// `Ks`.
    pub(super) specular: Option<Vec3>,
    /// `Ke`.
    pub(super) emission: Option<Vec3>,
    /// `Tf`: the part of the light that passes.
    pub(super) filter: Option<Vec3>,
    /// 1 for opaque: `d`, or `1 - Tr`.
    pub(super) opacity: Option<f32>,
    /// `Ni`.
    pub(super) ior: Option<f32>,
    /// `illum`.
    pub(super) illumination: Option<u32>,
    /// What follows `map_Kd`: options and a file name.
    pub(super) diffuse_map: Option<String>,
}

#[derive(Clone, Debug, Default)]
pub(super) struct Library {
    pub(super) definitions: HashMap<String, Definition>,
    /// What was left out.
    pub(super) notes: Vec<String>,
}

/// Reads a library.
///
/// # Errors
/// A line number, and what is wrong there.
pub(super) fn parse(text: &str) -> Result<Library, (usize, String)> {
    let mut definitions: HashMap<String, Definition> = HashMap::new();
    let mut current: Option<(String, Definition)> = None;
    let mut left_out = BTreeMap::new();
    let mut notes = Vec::new();
    for (number, line) in numbered_lines(text) {
        let line = line.trim();
        let (keyword, rest) = line
            .split_once(char::is_whitespace)
            .map_or((line, ""), |(keyword, rest)| (keyword, rest.trim()));
        match (keyword, &mut current) {
            ("newmtl", _) => {
                definitions.extend(current.take());
                if definitions.contains_key(rest) {
                    notes.push(format!(
                        "the material {} is defined twice: the last one counts",
                        quoted(rest)
                    ));
                }
                current = Some((rest.to_owned(), Definition::default()));
            }
            _ if keyword.is_empty() || keyword.starts_with('#') => {}
            (_, None) => {
                let reason = format!("{} stands before the first 'newmtl'", quoted(keyword));
                return Err((number, reason));
            }
            (_, Some((_, definition))) => {
                let known = definition
                    .statement(keyword, rest)
                    .map_err(|reason| (number, reason))?;
                if !known {
                    left_out.entry(keyword.to_owned()).or_insert(number);
                }
            }
        }
    }
    definitions.extend(current);
    const LIMIT: usize = 20;
    notes.extend(left_out.iter().take(LIMIT).map(|(keyword, line)| {
        format!(
            "{} statements are left out (the first in line {line})",
            quoted(keyword)
        )
    }));
    Ok(Library { definitions, notes })
}

impl Definition {
    /// Takes a statement in; returns whether it is one that is known.
    fn statement(&mut self, keyword: &str, rest: &str) -> Result<bool, String> {
        let values = rest.split('#').next().unwrap_or("").trim();
        match keyword {
            "Kd" => self.diffuse = Some(color(values)?),
            "Ks" => self.specular = Some(color(values)?),
            "Ke" => self.emission = Some(color(values)?),
            "Tf" => self.filter = Some(color(values)?),
            "d" => {
                // A halo makes the edges of a surface more transparent than its middle.
                let value = values.strip_prefix("-halo").unwrap_or(values);
                self.opacity = Some(one_number(value)?);
            }
            // Where both stand, `d` counts: some programs write it into `Tr` too.
            "Tr" => self.opacity = Some(self.opacity.unwrap_or(1.0 - one_number(values)?)),
            "Ni" => self.ior = Some(one_number(values)?),
            "illum" => {
                let value = values
                    .parse()
                    .map_err(|_| format!("{} is no illumination model", quoted(values)))?;
                self.illumination = Some(value);
            }
            "map_Kd" => self.diffuse_map = (!rest.is_empty()).then(|| rest.to_owned()),
            // Of no effect: there is no light for `Ka` alone, and highlights are left out as a whole.
            "Ka" | "map_Ka" | "Ns" | "map_Ns" | "map_Ks" | "sharpness" => {}
            _ => return Ok(false),
        }
        Ok(true)
    }
}

fn one_number(values: &str) -> Result<f32, String> {
    finite_number(values.trim())
}

/// Red, green and blue; one number stands for all three.
fn color(values: &str) -> Result<Vec3, String> {
    let mut numbers = Vec::with_capacity(3);
    for token in values.split_whitespace().take(4) {
        if matches!(token, "xyz" | "spectral") {
            return Err(format!(
                "colours as '{token}' are not supported, only red, green and blue"
            ));
        }
        numbers.push(finite_number(token)?);
    }
    match numbers.as_slice() {
        [grey] => Ok(Vec3::splat(*grey)),
        [red, green, blue] => Ok(Vec3::new(*red, *green, *blue)),
        _ => Err("a colour needs 1 or 3 numbers".to_owned()),
    }
}
