//! Names of the keys of a table.

use serde::de::Deserializer;

/// Returns the names of the keys of a table, in the order of their declaration.
pub fn keys_of<T: serde::de::DeserializeOwned>() -> &'static [&'static str] {
    let names = Names::default();
    // Only the names are needed; the deserialization itself fails.
    let _ = T::deserialize(&names);
    names.0.get()
}

/// Deserializer that stores the names of the requested fields and returns no value.
#[derive(Default)]
struct Names(std::cell::Cell<&'static [&'static str]>);

impl<'de> Deserializer<'de> for &Names {
    type Error = serde::de::value::Error;

    fn deserialize_any<V: serde::de::Visitor<'de>>(self, _: V) -> Result<V::Value, Self::Error> {
        Err(serde::de::Error::custom("no value"))
    }

    fn deserialize_struct<V: serde::de::Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Self::Error> {
        self.0.set(fields);
        self.deserialize_any(visitor)
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 u8 u16 u32 u64 f32 f64 char str string bytes byte_buf option unit unit_struct newtype_struct seq tuple
        tuple_struct map enum identifier ignored_any
    }
}
