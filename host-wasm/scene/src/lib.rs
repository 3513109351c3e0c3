//! Reads scenes from JavaScript values: objects, arrays, numbers, strings.
//!
//! `serde-wasm-bindgen` would ignore unknown keys. Here an unknown key is an error, as in every scene.

#[path = "../../../host-cli/src/scene_file/hint.rs"]
mod hint;

use js_sys::{Array, Float64Array, Object, Reflect};
use muslin_core::mesh::TriMesh;
use muslin_core::scene::{Content, Resource, SceneDesc};
use serde::de::value::{StrDeserializer, StringDeserializer};
use serde::de::{Deserialize, VariantAccess};
use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Error as _, Expected, MapAccess, SeqAccess, Unexpected, Visitor,
};
use wasm_bindgen::{JsCast, JsValue};

/// The error message, and the keys on the path to the wrong value, the innermost first.
#[derive(Debug)]
struct Error {
    why: String,
    path: Vec<String>,
}

impl Error {
    fn at(mut self, key: impl Into<String>) -> Self {
        self.path.push(key.into());
        self
    }
}

impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.why)
    }
}

impl std::error::Error for Error {}

impl serde::de::Error for Error {
    fn custom<T: std::fmt::Display>(why: T) -> Self {
        Self { why: why.to_string(), path: Vec::new() }
    }
}

/// Reads a scene. The error message names the path to the wrong value.
pub fn read(scene: JsValue) -> Result<SceneDesc, String> {
    SceneDesc::deserialize(Value(scene)).map_err(|error| explain(&error))
}

/// Reads the meshes that a scene names: an object with `{ positions, indices, uvs }` by name. Each is a list of numbers: three
/// for a vertex, three for a triangle, two for the texture coordinates of a vertex, which may be absent.
pub fn meshes(given: &JsValue) -> Result<Vec<Resource>, String> {
    if given.is_undefined() {
        return Ok(Vec::new());
    }
    let named = given.dyn_ref::<Object>().ok_or("meshes: expected an object with a mesh by name")?;
    let read = |entry: JsValue| {
        let entry = Array::from(&entry);
        let name = entry.get(0).as_string().unwrap_or_default();
        mesh(&entry.get(1))
            .map(|mesh| (name.clone(), Content::Mesh(mesh)))
            .map_err(|why| format!("meshes.{name}.{why}"))
    };
    Object::entries(named).iter().map(read).collect()
}

fn mesh(given: &JsValue) -> Result<TriMesh, String> {
    let positions = column::<3>(given, "positions")?;
    let index = |number: f64| {
        let index = number as u32;
        if f64::from(index) == number { Ok(index) } else { Err(format!("indices: {number} is no vertex")) }
    };
    let mut triangles = Vec::new();
    for [a, b, c] in column::<3>(given, "indices")? {
        triangles.push([index(a)?, index(b)?, index(c)?]);
    }
    let uvs = column::<2>(given, "uvs")?;
    let uv_triangles = if uvs.is_empty() { Vec::new() } else { triangles.clone() };
    Ok(TriMesh { positions, triangles, uvs, uv_triangles, ..TriMesh::default() })
}

/// A list of numbers in groups of `K`; empty if it is absent.
fn column<const K: usize>(of: &JsValue, key: &str) -> Result<Vec<[f64; K]>, String> {
    let given = Reflect::get(of, &key.into()).unwrap_or_default();
    if given.is_undefined() || given.is_null() {
        return Ok(Vec::new());
    }
    let numbers = Float64Array::new(&given).to_vec();
    let (groups, rest) = numbers.as_chunks();
    if rest.is_empty() { Ok(groups.to_vec()) } else { Err(format!("{key}: expected groups of {K} numbers")) }
}

/// The error message with its path and, for an unknown key, the most similar known key.
fn explain(error: &Error) -> String {
    // Authors of scenes do not know the names of Rust types.
    let why = match error.why.split_once("expected struct ") {
        Some((before, _)) => format!("{before}expected a section of keys"),
        None => error.why.replace(", expected f64", ", expected a number"),
    };
    let path: Vec<_> = error.path.iter().rev().map(String::as_str).collect();
    let place = if path.is_empty() { String::new() } else { format!("{}: ", path.join(".")) };
    let hint = hint::known(&why).map(|known| format!("\ndid you mean `{known}`?")).unwrap_or_default();
    format!("{place}{why}{hint}")
}

struct Value(JsValue);

impl Value {
    /// The value as a list, if it is an array.
    #[inline(never)]
    fn list(&self) -> Option<Array> {
        self.0.dyn_ref::<Array>().cloned()
    }

    #[inline(never)]
    fn section(&self) -> Option<Array> {
        // Objects from a parser may have no prototype, so `instanceof` does not work.
        (self.0.is_object() && !self.0.is_array()).then(|| Object::entries(self.0.unchecked_ref()))
    }

    #[inline(never)]
    fn is_not(&self, expected: &dyn Expected) -> Error {
        // Strings are formatted here, because serde uses debug output for them, which the module is built without.
        let text = self.0.as_string().map(|text| format!("string \"{text}\""));
        let unexpected = match (&text, self.0.as_f64(), self.0.as_bool()) {
            (Some(text), ..) => Unexpected::Other(text),
            (_, Some(number), _) => Unexpected::Float(number),
            (_, _, Some(truth)) => Unexpected::Bool(truth),
            _ if self.0.is_array() => Unexpected::Seq,
            _ if self.0.is_object() => Unexpected::Map,
            _ => Unexpected::Unit,
        };
        Error::invalid_type(unexpected, expected)
    }

    /// The value as a choice: its name, or a section with the name as its only key.
    #[inline(never)]
    fn choice(&self) -> Option<Choice> {
        if let Some(name) = self.0.as_string() {
            return Some(Choice { name, value: JsValue::UNDEFINED });
        }
        let entries = self.section().filter(|entries| entries.length() == 1)?;
        let entry: Array = entries.get(0).unchecked_into();
        Some(Choice { name: entry.get(0).as_string().unwrap_or_default(), value: entry.get(1) })
    }

    #[inline(never)]
    fn whole(&self, expected: &dyn Expected) -> Result<f64, Error> {
        self.0.as_f64().filter(|number| number.fract() == 0.0).ok_or_else(|| self.is_not(expected))
    }
}

macro_rules! wholes {
    ($($name:ident $visit:ident $type:ty),*) => {
        $(fn $name<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
            let number = self.whole(&visitor)?;
            // A negative number goes to `visit_i64`, so that a visitor for a count rejects it.
            if number < 0.0 { visitor.visit_i64(number as i64) } else { visitor.$visit(number as $type) }
        })*
    };
}

// Each typed method calls one method of its visitor, so that only this one is compiled.
impl<'de> Deserializer<'de> for Value {
    type Error = Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        if let Some(number) = self.0.as_f64() {
            visitor.visit_f64(number)
        } else if let Some(truth) = self.0.as_bool() {
            visitor.visit_bool(truth)
        } else if let Some(text) = self.0.as_string() {
            visitor.visit_string(text)
        } else if self.0.is_array() {
            self.deserialize_seq(visitor)
        } else {
            self.deserialize_map(visitor)
        }
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.0.as_bool() {
            Some(truth) => visitor.visit_bool(truth),
            None => Err(self.is_not(&visitor)),
        }
    }

    wholes!(
        deserialize_u8 visit_u64 u64, deserialize_u16 visit_u64 u64, deserialize_u32 visit_u64 u64,
        deserialize_u64 visit_u64 u64, deserialize_i8 visit_i64 i64, deserialize_i16 visit_i64 i64,
        deserialize_i32 visit_i64 i64, deserialize_i64 visit_i64 i64
    );

    fn deserialize_f32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        self.deserialize_f64(visitor)
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.0.as_f64() {
            Some(number) => visitor.visit_f64(number),
            None => Err(self.is_not(&visitor)),
        }
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.0.as_string() {
            Some(text) => visitor.visit_string(text),
            None => Err(self.is_not(&visitor)),
        }
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        self.deserialize_string(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.list() {
            Some(items) => visitor.visit_seq(Items { items, next: 0 }),
            None => Err(self.is_not(&visitor)),
        }
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, count: usize, visitor: V) -> Result<V::Value, Error> {
        match self.list() {
            Some(items) if items.length() as usize != count => {
                Err(Error::invalid_length(items.length() as usize, &visitor))
            }
            _ => self.deserialize_seq(visitor),
        }
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.section() {
            Some(items) => visitor.visit_map(Entries { items, next: 0, key: String::new(), value: JsValue::UNDEFINED }),
            None => Err(self.is_not(&visitor)),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        self.deserialize_map(visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        match self.choice() {
            Some(choice) => visitor.visit_enum(choice),
            None => Err(self.is_not(&visitor)),
        }
    }

    serde::forward_to_deserialize_any! {
        i128 u128 char bytes byte_buf unit unit_struct tuple_struct identifier ignored_any
    }
}

struct Items {
    items: Array,
    next: u32,
}

impl<'de> SeqAccess<'de> for Items {
    type Error = Error;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Error> {
        let Some(item) = self.take() else { return Ok(None) };
        seed.deserialize(item).map(Some).map_err(|error| error.at((self.next - 1).to_string()))
    }
}

impl Items {
    #[inline(never)]
    fn take(&mut self) -> Option<Value> {
        let index = self.next;
        self.next += 1;
        (index < self.items.length()).then(|| Value(self.items.get(index)))
    }
}

struct Entries {
    items: Array,
    /// Index of the next entry.
    next: u32,
    key: String,
    value: JsValue,
}

impl<'de> MapAccess<'de> for Entries {
    type Error = Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, Error> {
        if self.advance() { seed.deserialize(StrDeserializer::new(&self.key)).map(Some) } else { Ok(None) }
    }

    fn next_value_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<T::Value, Error> {
        seed.deserialize(Value(self.value.clone())).map_err(|error| error.at(&self.key))
    }
}

impl Entries {
    /// Goes on to the next key whose value is not undefined. Returns false at the end.
    #[inline(never)]
    fn advance(&mut self) -> bool {
        while self.next < self.items.length() {
            let entry: Array = self.items.get(self.next).unchecked_into();
            self.next += 1;
            self.value = entry.get(1);
            if !self.value.is_undefined() {
                self.key = entry.get(0).as_string().unwrap_or_default();
                return true;
            }
        }
        false
    }
}

struct Choice {
    name: String,
    value: JsValue,
}

impl<'de> EnumAccess<'de> for Choice {
    type Error = Error;
    type Variant = Value;

    fn variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<(T::Value, Value), Error> {
        Ok((seed.deserialize(StringDeserializer::new(self.name))?, Value(self.value)))
    }
}

impl<'de> VariantAccess<'de> for Value {
    type Error = Error;

    fn unit_variant(self) -> Result<(), Error> {
        Ok(())
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Error> {
        seed.deserialize(self)
    }

    fn tuple_variant<V: Visitor<'de>>(self, count: usize, visitor: V) -> Result<V::Value, Error> {
        self.deserialize_tuple(count, visitor)
    }

    fn struct_variant<V: Visitor<'de>>(self, _: &'static [&'static str], visitor: V) -> Result<V::Value, Error> {
        self.deserialize_map(visitor)
    }
}
