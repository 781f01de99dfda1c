//! Checks a JSON value against a description of what may stand where.
//!
//! The description is a set of static tables without cycles, so the depth of the recursion is theirs, not the file's.

use std::collections::BTreeMap;
use std::fmt;

use gltf::json::Value;

use crate::load::gltf::fault::Fault;

/// What a value has to look like.
#[derive(Debug)]
pub(super) enum Kind {
    Bool,
    String,
    /// One of some strings.
    Word(&'static [&'static str]),
    /// One of some integers.
    Code(&'static [u64]),
    /// An integer in a closed range.
    Integer(u64, u64),
    Number(Range),
    /// The number of an element of an array of the file.
    Index(&'static str),
    List(List),
    Object(&'static Shape),
    /// An object with any keys.
    Map(&'static Kind),
}

/// A range of numbers.
#[derive(Debug)]
pub(super) struct Range {
    pub(super) min: f64,
    pub(super) max: f64,
    /// Whether `min` itself is out of the range.
    pub(super) above_min: bool,
}

/// An array of a length between `min` and `max`.
#[derive(Debug)]
pub(super) struct List {
    pub(super) of: &'static Kind,
    pub(super) min: usize,
    pub(super) max: usize,
    pub(super) unique: bool,
}

/// What an object may hold. Properties that are not listed are ignored, as the specification asks.
#[derive(Debug)]
pub(super) struct Shape {
    pub(super) properties: &'static [Property],
    /// The extensions that may stand here, of those that are known at all.
    pub(super) extensions: &'static [(&'static str, &'static Shape)],
}

#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: &'static str,
    pub(super) required: bool,
    pub(super) kind: Kind,
}

/// What checks need to know about the file as a whole.
#[derive(Debug)]
pub(super) struct Schema<'a> {
    /// The lengths of the arrays that indices refer to.
    pub(super) lengths: BTreeMap<&'static str, usize>,
    /// The extensions that the file says it uses.
    pub(super) declared: Vec<String>,
    /// The extensions that have a place in some table.
    pub(super) known: &'a [&'static str],
}

/// A place in the file, as `meshes[0].primitives[1].indices`.
#[derive(Clone, Copy)]
pub(super) enum Place<'a> {
    Root,
    Field(&'a Place<'a>, &'a str),
    Element(&'a Place<'a>, usize),
}

impl fmt::Display for Place<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Root => f.write_str("top level"),
            Self::Field(Self::Root, name) => f.write_str(name),
            Self::Field(parent, name) => write!(f, "{parent}.{name}"),
            Self::Element(parent, index) => write!(f, "{parent}[{index}]"),
        }
    }
}

impl Schema<'_> {
    /// Checks a value and what is in it. Integers written with a fraction of zero become
    /// integers, and extras are removed.
    pub(super) fn check(
        &self,
        value: &mut Value,
        kind: &Kind,
        place: Place<'_>,
    ) -> Result<(), Fault> {
        match kind {
            Kind::Bool => expect(value.is_boolean(), value, "true or false", place),
            Kind::String => expect(value.is_string(), value, "a string", place),
            Kind::Word(words) => {
                let is_word = value.as_str().is_some_and(|text| words.contains(&text));
                expect(is_word, value, one_of(words), place)
            }
            Kind::Code(codes) => {
                let number = normalized_integer(value);
                let is_code = number.is_some_and(|number| codes.contains(&number));
                expect(is_code, value, one_of(codes), place)
            }
            Kind::Integer(min, max) => {
                let fits = normalized_integer(value).is_some_and(|n| (*min..=*max).contains(&n));
                expect(fits, value, integer_range(*min, *max), place)
            }
            Kind::Number(range) => {
                let fits = value.as_f64().is_some_and(|number| range.contains(number));
                expect(fits, value, range, place)
            }
            Kind::Index(array) => self.check_index(value, array, place),
            Kind::List(list) => self.check_list(value, list, place),
            Kind::Object(shape) => self.check_object(value, shape, place),
            Kind::Map(kind) => self.check_map(value, kind, place),
        }
    }

    fn check_index(&self, value: &mut Value, array: &str, place: Place<'_>) -> Result<(), Fault> {
        let Some(index) = normalized_integer(value) else {
            return expect(
                false,
                value,
                format!("a number of one of the {array}"),
                place,
            );
        };
        let length = self.lengths.get(array).copied().unwrap_or(0);
        if index < length as u64 {
            return Ok(());
        }
        let reason = format!("refers to {array}[{index}], but the number of {array} is {length}");
        Err(Fault::invalid(place, reason))
    }

    fn check_list(&self, value: &mut Value, list: &List, place: Place<'_>) -> Result<(), Fault> {
        let Some(elements) = value.as_array_mut() else {
            return expect(false, value, "an array", place);
        };
        let count = elements.len();
        if !(list.min..=list.max).contains(&count) {
            let limits = integer_range(list.min as u64, list.max as u64);
            let reason = format!("the array has {count} elements; their count must be {limits}");
            return Err(Fault::invalid(place, reason));
        }
        for (index, element) in elements.iter_mut().enumerate() {
            self.check(element, list.of, Place::Element(&place, index))?;
        }
        if list.unique {
            check_unique(elements, place)?;
        }
        Ok(())
    }

    fn check_object(
        &self,
        value: &mut Value,
        shape: &Shape,
        place: Place<'_>,
    ) -> Result<(), Fault> {
        let Some(object) = value.as_object_mut() else {
            return expect(false, value, "an object", place);
        };
        // Applications may put anything here, and nothing reads it.
        object.remove("extras");
        for property in shape.properties {
            match value.get_mut(property.name) {
                Some(inner) => {
                    self.check(inner, &property.kind, Place::Field(&place, property.name))?;
                }
                None if property.required => {
                    let reason = format!("the property '{}' is missing", property.name);
                    return Err(Fault::invalid(place, reason));
                }
                None => {}
            }
        }
        if let Some(extensions) = value.get_mut("extensions") {
            let place = Place::Field(&place, "extensions");
            self.check_extensions(extensions, shape, place)?;
        }
        Ok(())
    }

    fn check_extensions(
        &self,
        value: &mut Value,
        shape: &Shape,
        place: Place<'_>,
    ) -> Result<(), Fault> {
        let Some(extensions) = value.as_object_mut() else {
            return expect(false, value, "an object", place);
        };
        for (name, extension) in extensions {
            let place = Place::Field(&place, name);
            if !self.declared.iter().any(|declared| declared == name) {
                let reason = "the extension is not listed in extensionsUsed";
                return Err(Fault::invalid(place, reason));
            }
            match shape.extensions.iter().find(|(known, _)| known == name) {
                Some((_, shape)) => self.check_object(extension, shape, place)?,
                None if self.known.contains(&name.as_str()) => {
                    return Err(Fault::invalid(place, "the extension does not belong here"));
                }
                None => expect(extension.is_object(), extension, "an object", place)?,
            }
        }
        Ok(())
    }

    fn check_map(&self, value: &mut Value, kind: &Kind, place: Place<'_>) -> Result<(), Fault> {
        let Some(map) = value.as_object_mut() else {
            return expect(false, value, "an object", place);
        };
        for (name, inner) in map {
            self.check(inner, kind, Place::Field(&place, name))?;
        }
        Ok(())
    }
}

impl Range {
    fn contains(&self, number: f64) -> bool {
        // What a file gives is kept as f32, which must not overflow.
        let above = if self.above_min {
            number > self.min
        } else {
            number >= self.min
        };
        above && number <= self.max && number.abs() <= f64::from(f32::MAX)
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let relation = if self.above_min { "above" } else { "from" };
        match (self.min.is_finite(), self.max.is_finite()) {
            (false, false) => f.write_str("a number within the range of f32"),
            (true, false) => write!(f, "a number {relation} {}", self.min),
            (false, true) => write!(f, "a number up to {}", self.max),
            (true, true) => write!(f, "a number {relation} {} to {}", self.min, self.max),
        }
    }
}

/// The value as an integer, also where it is written as `1.0` or `1e0`, and then changed to `1`.
fn normalized_integer(value: &mut Value) -> Option<u64> {
    if let Some(integer) = value.as_u64() {
        return Some(integer);
    }
    /// Up to here every integer is an f64.
    const LIMIT: f64 = (1u64 << 53) as f64;
    let number = value.as_f64()?;
    if !(0.0..=LIMIT).contains(&number) || number.fract() != 0.0 {
        return None;
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "an integer between 0 and 2^53"
    )]
    let integer = number as u64;
    *value = Value::from(integer);
    Some(integer)
}

fn check_unique(elements: &[Value], place: Place<'_>) -> Result<(), Fault> {
    let mut seen = std::collections::HashSet::with_capacity(elements.len());
    for (index, element) in elements.iter().enumerate() {
        let key = element.as_str().map_or_else(
            || element.as_u64().map(|number| number.to_string()),
            |text| Some(text.to_owned()),
        );
        if !seen.insert(key) {
            let place = Place::Element(&place, index);
            return Err(Fault::invalid(place, format!("{element} is listed twice")));
        }
    }
    Ok(())
}

fn expect(
    holds: bool,
    found: &Value,
    expected: impl fmt::Display,
    place: Place<'_>,
) -> Result<(), Fault> {
    if holds {
        return Ok(());
    }
    let found = match found {
        Value::Null => "null".to_owned(),
        Value::Bool(value) => value.to_string(),
        Value::Number(number) => number.to_string(),
        Value::String(text) if text.chars().count() <= 40 => format!("the string '{text}'"),
        Value::String(_) => "a string".to_owned(),
        Value::Array(_) => "an array".to_owned(),
        Value::Object(_) => "an object".to_owned(),
    };
    let reason = format!("{expected} was expected, but there is {found}");
    Err(Fault::invalid(place, reason))
}

fn one_of<T: fmt::Display>(choices: &[T]) -> String {
    let choices: Vec<String> = choices.iter().map(T::to_string).collect();
    format!("one of {}", choices.join(", "))
}

fn integer_range(min: u64, max: u64) -> String {
    match (min, max) {
        (0, u64::MAX) => "an integer from 0".to_owned(),
        (min, u64::MAX) => format!("an integer of at least {min}"),
        // Lengths of arrays have the limits of usize.
        (min, max) if max == usize::MAX as u64 => format!("an integer of at least {min}"),
        (min, max) if min == max => min.to_string(),
        (min, max) => format!("an integer from {min} to {max}"),
    }
}
