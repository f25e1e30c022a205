//! Units in a scene: a number with a dimension may be text such as `"0.5 mm"` or `"8.93 g/cm3"`.
//!
//! The unit of a key stands in brackets in its description, such as `Density [kg/m3].`; keys without
//! one take numbers only. A time function takes the unit of the quantity that it gives: in pairs, the
//! first entry has the unit of the description and the second that of the quantity. Text becomes the
//! number in SI units before anything else is checked. The decimal exponent is shifted in the text,
//! so that the double is the one nearest to the decimal number: `"8.93 g/cm3"` and `8930` are the
//! same double.

use serde_json::{Map, Value};

use super::errors::{SceneFault, list};
use super::paths::{entry_key, quote, types};

/// Exponents of m, kg, s and K.
type Dimensions = [i32; 4];

/// A unit: its dimensions, and the power of ten between it and the SI unit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct ScaledUnit {
    dimensions: Dimensions,
    ten: i32,
}

/// Symbols with their dimensions and powers of ten.
const SYMBOLS: [(&str, Dimensions, i32); 11] = [
    ("m", [1, 0, 0, 0], 0),
    ("g", [0, 1, 0, 0], -3),
    ("t", [0, 1, 0, 0], 3),
    ("s", [0, 0, 1, 0], 0),
    ("K", [0, 0, 0, 1], 0),
    ("N", [1, 1, -2, 0], 0),
    ("Pa", [-1, 1, -2, 0], 0),
    ("bar", [-1, 1, -2, 0], 5),
    ("J", [2, 1, -2, 0], 0),
    ("W", [2, 1, -3, 0], 0),
    ("rad", [0, 0, 0, 0], 0),
];

/// Prefixes and their powers of ten.
const PREFIXES: [(&str, i32); 9] = [
    ("n", -9),
    ("u", -6),
    ("\u{b5}", -6),
    ("\u{3bc}", -6),
    ("m", -3),
    ("c", -2),
    ("k", 3),
    ("M", 6),
    ("G", 9),
];

/// A symbol with or without a prefix.
fn symbol(text: &str) -> Option<ScaledUnit> {
    let plain = |text: &str| SYMBOLS.iter().find(|(symbol, ..)| *symbol == text);
    let unit = |(_, dimensions, ten): &(&str, Dimensions, i32), prefix: i32| ScaledUnit {
        dimensions: *dimensions,
        ten: ten + prefix,
    };
    plain(text).map(|found| unit(found, 0)).or_else(|| {
        PREFIXES.iter().find_map(|(prefix, ten)| {
            plain(text.strip_prefix(prefix)?).map(|found| unit(found, *ten))
        })
    })
}

/// A unit such as `kg/m3`, `J/(kg K)` or `1/s`; `None` if it is unknown.
fn unit(text: &str) -> Option<ScaledUnit> {
    let mut whole = ScaledUnit::default();
    let (mut sign, mut in_parentheses) = (1, false);
    let mut rest = text.trim();
    if rest.is_empty() {
        return None;
    }
    while let Some(first) = rest.chars().next() {
        let next = &rest[first.len_utf8()..];
        match first {
            '/' if !in_parentheses => sign = -1,
            '(' if !in_parentheses => in_parentheses = true,
            ')' if in_parentheses => in_parentheses = false,
            ' ' | '*' => {}
            '1' if whole == ScaledUnit::default() && next.trim_start().starts_with('/') => {}
            _ if first.is_alphabetic() => {
                let length = rest.find(|c: char| !c.is_alphabetic()).unwrap_or(rest.len());
                let (name, after) = rest.split_at(length);
                let after = after.strip_prefix('^').unwrap_or(after);
                let digits = |c: char| c.is_ascii_digit() || c == '-';
                let length = after.find(|c: char| !digits(c)).unwrap_or(after.len());
                let (power, after) = after.split_at(length);
                let power: i32 = if power.is_empty() { 1 } else { power.parse().ok()? };
                let power = power.checked_mul(sign)?;
                let factor = symbol(name)?;
                for (sum, exponent) in whole.dimensions.iter_mut().zip(factor.dimensions) {
                    *sum = exponent.checked_mul(power).and_then(|of| sum.checked_add(of))?;
                }
                whole.ten =
                    factor.ten.checked_mul(power).and_then(|of| whole.ten.checked_add(of))?;
                rest = after;
                // a product below a fraction bar needs parentheses
                sign = if in_parentheses { sign } else { 1 };
                continue;
            }
            _ => return None,
        }
        rest = next;
    }
    (!in_parentheses).then_some(whole)
}

/// Number and unit of a text such as `0.5 mm`.
fn split(text: &str) -> Option<(&str, &str)> {
    let text = text.trim();
    let starts = text.starts_with(|c: char| c.is_ascii_digit() || c == '-' || c == '.');
    let is_number = |end: &usize| text[..*end].trim_end().parse::<f64>().is_ok();
    let ends = text.char_indices().map(|(at, _)| at).skip(1).chain([text.len()]);
    let end = ends.filter(|_| starts).filter(is_number).last()?;
    Some((text[..end].trim_end(), text[end..].trim()))
}

/// Whether a text is a number with a known unit.
pub(super) fn is_quantity(text: &str) -> bool {
    split(text).is_some_and(|(_, name)| unit(name).is_some())
}

/// The number in SI units.
fn in_si(number: &str, ten: i32) -> Option<f64> {
    let (digits, exponent) = number.split_once(['e', 'E']).unwrap_or((number, "0"));
    let exponent = exponent.parse::<i32>().ok()?.checked_add(ten)?;
    format!("{digits}e{exponent}").parse().ok().filter(|value: &f64| value.is_finite())
}

/// First unit in brackets of a description, if it is known.
fn unit_of(schema: &Value) -> Option<(&str, ScaledUnit)> {
    let text = schema["description"].as_str()?;
    let names = text.split('[').skip(1).filter_map(|rest| rest.split(']').next());
    names.filter_map(|name| Some((name, unit(name)?))).next()
}

/// Whether the description of a schema gives a unit.
pub(super) fn has_unit(schema: &Value) -> bool {
    unit_of(schema).is_some()
}

/// Replaces the quantities in a scene by numbers in SI units; `schema` is that of a scene whose method
/// is given in full. Returns a fault for each text whose unit is unknown or of other dimensions than
/// its key.
pub(super) fn convert(scene: &mut Value, schema: &Value) -> Vec<SceneFault> {
    let empty = Map::new();
    let definitions = schema["$defs"].as_object().unwrap_or(&empty);
    Converter { definitions }.convert(schema, None, scene)
}

struct Converter<'a> {
    definitions: &'a Map<String, Value>,
}

impl<'a> Converter<'a> {
    /// Schemas that `schema` stands for: itself, what it refers to, and its variants.
    fn variants(&self, schema: &'a Value) -> Vec<&'a Value> {
        let mut found = vec![schema];
        let reference = schema["$ref"].as_str().and_then(|path| path.rsplit('/').next());
        if let Some(named) = reference.and_then(|name| self.definitions.get(name)) {
            found.extend(self.variants(named));
        }
        for key in ["anyOf", "oneOf"] {
            for variant in schema[key].as_array().into_iter().flatten() {
                found.extend(self.variants(variant));
            }
        }
        found
    }

    fn convert(
        &self,
        schema: &'a Value,
        above: Option<(&'a str, ScaledUnit)>,
        value: &mut Value,
    ) -> Vec<SceneFault> {
        let variants = self.variants(schema);
        let own = |schema: &&'a Value| unit_of(schema);
        match value {
            Value::String(text) => {
                let takes_numbers = |schema: &&&Value| types(schema).contains(&"number");
                let Some(number) = variants.iter().find(takes_numbers) else { return Vec::new() };
                let Some((name, target)) = own(number).or(unit_of(schema)).or(above) else {
                    return Vec::new();
                };
                match quantity(text, name, target) {
                    Ok(Some(converted)) => *value = Value::from(converted),
                    Ok(None) => {}
                    Err(fault) => return vec![fault],
                }
                Vec::new()
            }
            Value::Array(entries) => {
                let Some(items) = variants.iter().find(|schema| schema.get("items").is_some())
                else {
                    return Vec::new();
                };
                let unit = own(items).or(unit_of(schema));
                let mut faults = Vec::new();
                for i in 0..entries.len() {
                    let found = match (&mut entries[i], unit, above) {
                        (Value::Array(pair), Some(time), Some(value)) => {
                            self.convert_pair(&items["items"]["items"], [time, value], pair)
                        }
                        // keys of an object have units of their own
                        (entry @ Value::Object(_), ..) => {
                            self.convert(&items["items"], None, entry)
                        }
                        (entry, ..) => self.convert(&items["items"], unit.or(above), entry),
                    };
                    faults.extend(found.into_iter().map(|f| f.below(&entry_key(entries, i))));
                }
                faults
            }
            Value::Object(object) => self.convert_object(&variants, above, object),
            _ => Vec::new(),
        }
    }

    /// A time and the value of a time function, whose units are `units`.
    fn convert_pair(
        &self,
        schema: &'a Value,
        units: [(&'a str, ScaledUnit); 2],
        pair: &mut [Value],
    ) -> Vec<SceneFault> {
        let mut faults = Vec::new();
        for (k, (unit, value)) in units.into_iter().zip(pair).enumerate() {
            let found = self.convert(schema, Some(unit), value).into_iter();
            faults.extend(found.map(|fault| fault.below(&format!("[{k}]"))));
        }
        faults
    }

    /// Keys of an object; `quantity` is the unit of those without one in a time function.
    fn convert_object(
        &self,
        variants: &[&'a Value],
        quantity: Option<(&'a str, ScaledUnit)>,
        object: &mut Map<String, Value>,
    ) -> Vec<SceneFault> {
        let kind = object.get("type").cloned();
        let is_of = |schema: &&&Value| {
            let named = &schema["properties"]["type"]["const"];
            named.is_null() || kind.as_ref() == Some(named)
        };
        let schemas: Vec<&Value> = variants.iter().filter(is_of).copied().collect();
        let mut faults = Vec::new();
        for (key, value) in object {
            let known = |schema: &&'a Value| {
                let others = schema.get("additionalProperties").filter(|of| of.is_object());
                schema["properties"].get(key).or(others).map(|inner| (*schema, inner))
            };
            if let Some((schema, inner)) = schemas.iter().find_map(known) {
                // a variant with a single key describes its value
                let single = schema["properties"].as_object().is_some_and(|all| all.len() == 1);
                let above = unit_of(schema).filter(|_| single).or(quantity);
                let found = self.convert(inner, above, value).into_iter();
                faults.extend(found.map(|fault| fault.below(&quote(key))));
            }
        }
        faults
    }
}

/// Allows quantities in the published schema of a scene, where its descriptions give a unit.
pub(super) fn allow_quantities(schema: &mut Value) {
    let mut functions = Vec::new();
    quantities(schema, &schema["$defs"], &mut functions);
    allow(schema, false);
    for (name, of) in schema["$defs"].as_object_mut().into_iter().flatten() {
        let is_function = functions.contains(name);
        allow(of, is_function);
        let keys = of.get_mut("properties").and_then(Value::as_object_mut);
        for value in keys.into_iter().flat_map(|keys| keys.values_mut()).filter(|_| is_function) {
            allow(value, true);
        }
    }
}

/// Appends the names of all definitions that give a quantity: those that stand for the value of a
/// variant with a single key and a unit.
fn quantities(schema: &Value, definitions: &Value, names: &mut Vec<String>) {
    let keys = schema["properties"].as_object();
    if let Some(inner) = keys.filter(|keys| keys.len() == 1 && unit_of(schema).is_some()) {
        inner.values().for_each(|value| referred(value, definitions, names));
    }
    match schema {
        Value::Object(object) => object.values().for_each(|v| quantities(v, definitions, names)),
        Value::Array(all) => all.iter().for_each(|value| quantities(value, definitions, names)),
        _ => {}
    }
}

/// Appends the names of the definitions that `schema` stands for.
fn referred(schema: &Value, definitions: &Value, names: &mut Vec<String>) {
    if let Some(name) = schema["$ref"].as_str().and_then(|path| path.rsplit('/').next())
        && !names.iter().any(|known| known == name)
    {
        names.push(name.to_string());
        referred(&definitions[name], definitions, names);
    }
    for key in ["anyOf", "oneOf"] {
        let variants = schema[key].as_array().into_iter().flatten();
        variants.for_each(|variant| referred(variant, definitions, names));
    }
}

/// Allows text in the numbers of `schema` that have a unit, or in all `above` which there is one.
fn allow(schema: &mut Value, above: bool) {
    let has_unit = unit_of(schema).is_some();
    let inner = has_unit || above;
    let Some(object) = schema.as_object_mut() else { return };
    let single = object.get("properties").and_then(Value::as_object).is_some_and(|p| p.len() == 1);
    for (key, value) in object.iter_mut() {
        match (key.as_str(), &mut *value) {
            ("properties", Value::Object(keys)) => {
                keys.values_mut().for_each(|of| allow(of, has_unit && single));
            }
            ("anyOf" | "oneOf", Value::Array(all)) => {
                all.iter_mut().for_each(|of| allow(of, inner));
            }
            ("items", items) => allow(items, inner),
            ("additionalProperties", others) => allow(others, false),
            _ => {}
        }
    }
    let mut kinds: Vec<Value> = types(schema).into_iter().map(Value::from).collect();
    let text = Value::from("string");
    if inner && kinds.contains(&Value::from("number")) && !kinds.contains(&text) {
        kinds.push(text);
        schema["type"] = kinds.into();
        schema["pattern"] = r"^\s*[-.0-9].*[A-Za-z)0-9]$".into();
    }
}

/// The number of `text` in SI units, if it is a quantity of the dimensions of `target`, whose name is
/// `name`; `None` for other text.
fn quantity(text: &str, name: &str, target: ScaledUnit) -> Result<Option<f64>, SceneFault> {
    let fault = |reason: String| SceneFault::new("", text, reason);
    let Some((number, own)) = split(text) else { return Ok(None) };
    if own.is_empty() {
        if !number.parse::<f64>().is_ok_and(f64::is_finite) {
            return Ok(None);
        }
        return Err(fault(format!("text without a unit; allowed: a number, or \"{text} {name}\"")));
    }
    if own.starts_with(',') {
        return Err(fault("a decimal comma; allowed: a decimal point".into()));
    }
    let Some(found) = unit(own) else {
        let known = list(SYMBOLS.map(|(symbol, ..)| symbol));
        return Err(fault(format!(
            "unknown unit {own:?}; allowed: a unit such as {name}, of {known}"
        )));
    };
    if found.dimensions != target.dimensions {
        return Err(fault(format!(
            "has another dimension; allowed: a number or a unit such as {name}"
        )));
    }
    in_si(number, found.ten - target.ten)
        .map(Some)
        .ok_or_else(|| fault("no number; allowed: a finite number with a unit".into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_are_the_doubles_nearest_to_their_decimals() {
        for (text, name, expected) in [
            ("0.5 mm", "m", 0.5e-3),
            ("10um", "m", 1e-5),
            ("10 \u{b5}m", "m", 1e-5),
            ("8.93 g/cm3", "kg/m3", 8930.0),
            ("1.5e-1 km/s", "m/s", 150.0),
            ("12 GPa", "Pa", 12e9),
            ("0.123 Mbar", "Pa", 12.3e9),
            ("-3 kbar", "Pa", -3e8),
            ("0.7 us", "s", 0.7e-6),
            ("386 J/(kg K)", "J/(kg K)", 386.0),
            ("0.386 J/(g K)", "J/(kg K)", 386.0),
            ("401 W/(m K)", "W/(m K)", 401.0),
            ("2 1/us", "1/s", 2e6),
            ("3 kJ/g", "J/kg", 3e6),
            ("9.81 m/s^2", "m/s2", 9.81),
        ] {
            let target = unit(name).unwrap();
            assert_eq!(quantity(text, name, target).unwrap(), Some(expected), "{text}");
        }
    }

    #[test]
    fn other_dimensions_and_unknown_units_are_refused() {
        let pascal = unit("Pa").unwrap();
        for (text, reason) in [
            ("1 mm", "another dimension"),
            ("3 psi", "unknown unit"),
            ("3 GPa/", "another dimension"),
            ("1e999 GPa", "finite"),
            ("8930", "without a unit; allowed: a number, or \"8930 Pa\""),
        ] {
            let refused = quantity(text, "Pa", pascal);
            match refused {
                Err(fault) => {
                    let message = fault.within("scene.json").to_string();
                    assert!(message.contains(reason), "{message}");
                }
                Ok(value) => assert!(text == "3 GPa/" && value == Some(3e9), "{text}: {value:?}"),
            }
        }
        for text in ["velocity.csv", "wall", "", "1", "8930", "1e5", "nan m", "inf Pa"] {
            assert_eq!(quantity(text, "Pa", pascal).ok().flatten(), None, "{text}");
            assert!(!is_quantity(text), "{text}");
        }
    }
}
