//! Validation of a scene's JSON text against the schema of its structs.
//!
//! Errors of type, name and bounds are found here rather than by serde, whose messages lose the
//! path inside tagged enums. The schema in an editor, the output of `schema` and the input that a
//! run accepts can therefore not differ. A preset of the method is expanded before. Only those JSON
//! schema keywords are supported that the structs of the scene produce.

use std::cell::RefCell;

use serde_json::{Map, Value};

use super::errors::{SceneFault, list, nearest, suggest};
use super::paths::{entry_key, quote, types};
use super::schema::{GREATEST, LEAST};
use super::units::has_unit;

/// Validates `scene` against the schema; returns all faults.
pub(super) fn conform(scene: &Value) -> Vec<SceneFault> {
    let root = super::schema::full_schema();
    let empty = Map::new();
    let definitions = root.get("$defs").and_then(Value::as_object).unwrap_or(&empty);
    Conform { definitions, open: RefCell::default() }.check(root, scene)
}

struct Conform<'a> {
    definitions: &'a Map<String, Value>,
    /// Definitions that are being described; a recursive one is referred to by its name.
    open: RefCell<Vec<String>>,
}

impl Conform<'_> {
    fn resolve<'s>(&'s self, schema: &'s Value) -> &'s Value {
        let name = schema.get("$ref").and_then(Value::as_str).and_then(|r| r.rsplit('/').next());
        name.and_then(|name| self.definitions.get(name)).unwrap_or(schema)
    }

    fn check(&self, schema: &Value, value: &Value) -> Vec<SceneFault> {
        let schema = self.resolve(schema);
        if let Some(options) = schema.get("anyOf").and_then(Value::as_array) {
            let option = options.iter().find(|o| has_type(self.resolve(o), value));
            return match option {
                Some(option) => self.check(option, value),
                None => vec![self.wrong(schema, value)],
            };
        }
        if let Some(variants) = schema.get("oneOf").and_then(Value::as_array) {
            return self.check_variants(schema, variants, value);
        }
        if !has_type(schema, value) {
            return vec![self.wrong(schema, value)];
        }
        match value {
            Value::Number(_) if !within_bounds(schema, value) => vec![self.wrong(schema, value)],
            Value::Array(entries) => self.check_array(schema, entries, value),
            Value::Object(object) => self.check_object(schema, object),
            _ => Vec::new(),
        }
    }

    /// Fault of `value`, with a description of the allowed values.
    fn wrong(&self, schema: &Value, value: &Value) -> SceneFault {
        if let Some(number) = value.as_f64().filter(|_| types(schema).contains(&"number")) {
            let is = |key: &str, bound: f64| {
                schema.get(key).and_then(Value::as_f64).is_some_and(|known| known == bound)
            };
            let beyond = (number > GREATEST && is("maximum", GREATEST))
                || (number < -GREATEST && is("minimum", -GREATEST));
            if beyond {
                let reason = format!(
                    "too great for a computation; allowed: a magnitude of at most {GREATEST:e}"
                );
                return SceneFault::new("", value, reason);
            }
            if number > 0.0 && number < LEAST && is("minimum", LEAST) {
                let reason = format!("too small for a computation; allowed: at least {LEAST:e}");
                return SceneFault::new("", value, reason);
            }
        }
        let or_quantity = match has_unit(schema) && value.is_string() {
            true => ", or text of a number and a unit",
            false => "",
        };
        let allowed = self.allowed(schema);
        SceneFault::new("", value, format!("not allowed; allowed: {allowed}{or_quantity}"))
    }

    fn check_array(&self, schema: &Value, entries: &[Value], value: &Value) -> Vec<SceneFault> {
        let least = schema.get("minItems").and_then(Value::as_u64).unwrap_or(0);
        let most = schema.get("maxItems").and_then(Value::as_u64).unwrap_or(u64::MAX);
        if !(least..=most).contains(&(entries.len() as u64)) {
            return vec![self.wrong(schema, value)];
        }
        let Some(items) = schema.get("items") else { return Vec::new() };
        let mut faults = Vec::new();
        for (i, entry) in entries.iter().enumerate() {
            let found = self.check(items, entry).into_iter();
            faults.extend(found.map(|fault| fault.below(&entry_key(entries, i))));
        }
        faults
    }

    /// A missing key of which an unknown one is a misspelling is no fault of its own.
    fn check_object(&self, schema: &Value, object: &Map<String, Value>) -> Vec<SceneFault> {
        let empty = Map::new();
        let known = schema.get("properties").and_then(Value::as_object).unwrap_or(&empty);
        let others = schema.get("additionalProperties").filter(|others| others.is_object());
        let mut faults = Vec::new();
        let mut misspelt = Vec::new();
        for (key, value) in object {
            let names = known.keys().map(String::as_str);
            match known.get(key).or(others) {
                Some(schema) => {
                    let found = self.check(schema, value).into_iter();
                    faults.extend(found.map(|fault| fault.below(&quote(key))));
                }
                None => {
                    let meant = nearest(key, names.clone());
                    misspelt.extend(meant);
                    let reason = format!("unknown key{}", suggest(key, names));
                    let fault = SceneFault::new(quote(key), value, reason);
                    // without a similar name, no other key is in doubt
                    faults.push(fault.invalidates(meant.map(quote).unwrap_or_default()));
                }
            }
        }
        let required = schema.get("required").and_then(Value::as_array);
        for key in required.into_iter().flatten().filter_map(Value::as_str) {
            if !object.contains_key(key) && !misspelt.contains(&key) {
                let allowed = self.allowed(&known[key]);
                let reason = format!("missing key; allowed: {allowed}");
                faults.push(SceneFault::missing(key, reason));
            }
        }
        faults
    }

    /// An enum: plain names, objects with one key, or objects with a `type`.
    fn check_variants(&self, schema: &Value, variants: &[Value], value: &Value) -> Vec<SceneFault> {
        if variants.iter().any(|variant| constant(variant) == Some(value)) {
            return Vec::new();
        }
        let Value::Object(object) = value else {
            return vec![self.no_variant(schema, variants, value)];
        };
        if variants.iter().any(|variant| tag(variant).is_some()) {
            return self.check_tagged(variants, object);
        }
        let (1, Some((key, inner))) = (object.len(), object.iter().next()) else {
            return vec![self.wrong(schema, value)];
        };
        let has_key = |v: &&Value| constant(v).is_none() && variant_name(v) == Some(key);
        match variants.iter().find(has_key) {
            Some(variant) => self.check_object(variant, object),
            None => {
                let known: Vec<_> = variants.iter().filter_map(variant_name).collect();
                let reason = format!("unknown name{}", suggest(key, known));
                vec![SceneFault::new(quote(key), inner, reason)]
            }
        }
    }

    /// An object whose `type` selects the variant.
    fn check_tagged(&self, variants: &[Value], object: &Map<String, Value>) -> Vec<SceneFault> {
        let known: Vec<_> = variants.iter().filter_map(tag).collect();
        let Some(value) = object.get("type") else {
            let reason = format!("missing key; allowed: {}", list(known));
            return vec![SceneFault::missing("type", reason)];
        };
        let name = value.as_str().unwrap_or("");
        match variants.iter().find(|variant| tag(variant) == Some(name)) {
            Some(variant) => self.check_object(variant, object),
            None => {
                let reason = format!("unknown type{}", suggest(name, known));
                vec![SceneFault::new("type", value, reason)]
            }
        }
    }

    /// Fault of a value that is none of the variants; suggests a similar name.
    fn no_variant(&self, schema: &Value, variants: &[Value], value: &Value) -> SceneFault {
        let name = value.as_str().unwrap_or("");
        let near = nearest(name, variants.iter().filter_map(variant_name));
        let near = variants.iter().find(|v| near.is_some() && variant_name(v) == near);
        let Some(near) = near else { return self.wrong(schema, value) };
        let (near, allowed) = (self.allowed(near), self.allowed(schema));
        SceneFault::new("", value, format!("not allowed; did you mean {near}? allowed: {allowed}"))
    }

    /// Description of the values that a schema allows.
    fn allowed(&self, schema: &Value) -> String {
        let name = schema.get("$ref").and_then(Value::as_str).and_then(|r| r.rsplit('/').next());
        let Some(name) = name else { return self.allowed_inside(schema) };
        if self.open.borrow().iter().any(|open| open == name) {
            return format!("a {}", name.to_lowercase());
        }
        self.open.borrow_mut().push(name.to_string());
        let text = self.allowed_inside(self.resolve(schema));
        self.open.borrow_mut().pop();
        text
    }

    fn allowed_inside(&self, schema: &Value) -> String {
        if let Some(options) = schema.get("anyOf").and_then(Value::as_array) {
            let texts: Vec<_> = options.iter().map(|option| self.allowed(option)).collect();
            return texts.join(", or ");
        }
        if let Some(variants) = schema.get("oneOf").and_then(Value::as_array) {
            // the keys of each type would be too many for a line
            let types: Vec<_> = variants.iter().filter_map(tag).collect();
            let rest = variants.iter().filter(|variant| tag(variant).is_none());
            let mut texts: Vec<_> = rest.map(|variant| self.allowed(variant)).collect();
            if !types.is_empty() {
                texts.push(format!("an object whose \"type\" is one of {}", types.join(", ")));
            }
            return texts.join(", ");
        }
        if let Some(constant) = constant(schema) {
            return constant.to_string();
        }
        let mut texts: Vec<_> =
            types(schema).into_iter().map(|name| self.allowed_type(schema, name)).collect();
        texts.dedup();
        texts.join(", or ")
    }

    fn allowed_type(&self, schema: &Value, name: &str) -> String {
        match name {
            "number" => format!("a number{}", bounds(schema)),
            "integer" => format!("a whole number{}", bounds(schema)),
            "boolean" => "true or false".to_string(),
            "string" => "a string".to_string(),
            "array" => {
                let entry = schema.get("items").map(|items| self.allowed(items));
                let entry = entry.unwrap_or_else(|| "any value".to_string());
                let least = schema.get("minItems").and_then(Value::as_u64).unwrap_or(0);
                let most = schema.get("maxItems").and_then(Value::as_u64);
                match (least, most) {
                    (0, _) => format!("an array, each entry {entry}"),
                    (_, Some(most)) if most == least => {
                        format!("an array of {least} entries, each {entry}")
                    }
                    _ => format!("an array, not empty, each entry {entry}"),
                }
            }
            "object" => match schema.get("properties").and_then(Value::as_object) {
                Some(keys) if keys.len() == 1 => {
                    let texts =
                        keys.iter().map(|(k, s)| format!("{{\"{k}\": {}}}", self.allowed(s)));
                    texts.collect::<String>()
                }
                Some(keys) => {
                    let names: Vec<_> = keys.keys().map(String::as_str).collect();
                    format!("an object with the keys {}", names.join(", "))
                }
                None => "an object of names".to_string(),
            },
            other => other.to_string(),
        }
    }
}

/// The constant value of a variant, if it has one.
fn constant(variant: &Value) -> Option<&Value> {
    variant.get("const")
}

/// The `type` of a tagged variant.
fn tag(variant: &Value) -> Option<&str> {
    variant.get("properties")?.get("type")?.get("const")?.as_str()
}

/// Name of a variant: the constant itself, or the only key of its object.
fn variant_name(variant: &Value) -> Option<&str> {
    match constant(variant) {
        Some(name) => name.as_str(),
        None => variant.get("required")?.get(0)?.as_str(),
    }
}

/// Whether `value` is of a type that the schema allows; variants are distinguished later.
fn has_type(schema: &Value, value: &Value) -> bool {
    if schema.get("oneOf").is_some() {
        return !value.is_null();
    }
    if let Some(options) = schema.get("anyOf").and_then(Value::as_array) {
        return options.iter().any(|option| has_type(option, value));
    }
    types(schema).into_iter().any(|name| match name {
        "number" => value.is_number(),
        "integer" => value.is_u64() || value.is_i64(),
        "boolean" => value.is_boolean(),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        "null" => value.is_null(),
        _ => false,
    })
}

fn within_bounds(schema: &Value, value: &Value) -> bool {
    let Some(number) = value.as_f64() else { return false };
    let bound = |key: &str| schema.get(key).and_then(Value::as_f64);
    let widest = match schema.get("format").and_then(Value::as_str) {
        Some("uint32") => f64::from(u32::MAX),
        _ => f64::INFINITY,
    };
    bound("minimum").is_none_or(|b| number >= b)
        && bound("maximum").is_none_or(|b| number <= b)
        && bound("exclusiveMinimum").is_none_or(|b| number > b)
        && bound("exclusiveMaximum").is_none_or(|b| number < b)
        && number <= widest
}

/// Description of the bounds of a number, with a leading space.
fn bounds(schema: &Value) -> String {
    let mut texts = Vec::new();
    for (key, words) in [
        ("exclusiveMinimum", "above"),
        ("minimum", "at least"),
        ("exclusiveMaximum", "below"),
        ("maximum", "at most"),
    ] {
        if let Some(bound) = schema.get(key).and_then(Value::as_f64)
            // the general bounds are not shown, nor a bound that another one implies
            && ![GREATEST, -GREATEST, LEAST, f64::MAX].contains(&bound)
            && !(key == "minimum" && schema.get("exclusiveMinimum").is_some())
        {
            texts.push(format!("{words} {bound}"));
        }
    }
    if texts.is_empty() { String::new() } else { format!(" {}", texts.join(" and ")) }
}
