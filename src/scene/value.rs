//! Values of scene keys that are given by a program.

use std::collections::{BTreeMap, HashMap};

use ndarray::{ArrayBase, Data, Ix1, Ix2};
use toml::value::Datetime;
use toml::{Table, Value};

use crate::material::{Curve, Material};

/// Conversion into the value of a key: numbers (in SI units), strings (which may contain a unit), lists of values, pairs, tables, one- and
/// two-dimensional arrays, materials and curves, and references to all of these.
///
/// ```
/// use barwave::ndarray::Array1;
/// use barwave::scene::IntoValue;
/// use barwave::toml::Value;
///
/// let rows: Value = "[[0.0, 1.0], [1e-4, 0.5]]".parse()?;
/// let (time, velocity) = (Array1::from(vec![0.0, 1e-4]), [1.0, 0.5]);
/// assert_eq!([[0.0, 1.0], [1e-4, 0.5]].into_value(), rows);
/// assert_eq!(time.iter().copied().zip(velocity).collect::<Vec<_>>().into_value(), rows);
/// assert_eq!(time.into_value(), [0.0, 1e-4].into_value());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait IntoValue {
    /// Returns the value as it would be written in a scene file.
    fn into_value(self) -> Value;
}

/// Implements [`IntoValue`] for types with this conversion.
macro_rules! convertible {
    ($($own:ty),* => $convert:expr) => {$(
        impl IntoValue for $own {
            fn into_value(self) -> Value {
                $convert(self)
            }
        }
    )*};
}

convertible!(Value, Table, Datetime, String, &str, bool, i8, i32, i64, u8, u32, f32, f64 => Value::from);
convertible!(i16, u16 => |number| Value::Integer(i64::from(number)));
// Integers beyond the range of TOML become floats, so that the error message shows their value.
convertible!(u64, usize, isize => |number: Self| i64::try_from(number).map_or(Value::Float(number as f64), Value::Integer));

impl IntoValue for Material {
    fn into_value(self) -> Value {
        (&self).into()
    }
}

impl IntoValue for Curve {
    fn into_value(self) -> Value {
        (&self).into()
    }
}

fn list<T: IntoValue>(items: impl IntoIterator<Item = T>) -> Value {
    Value::Array(items.into_iter().map(T::into_value).collect())
}

fn table<V: IntoValue>(entries: impl IntoIterator<Item = (impl Into<String>, V)>) -> Value {
    Value::Table(entries.into_iter().map(|(key, value)| (key.into(), value.into_value())).collect())
}

impl<T: IntoValue> IntoValue for Vec<T> {
    fn into_value(self) -> Value {
        list(self)
    }
}

impl<T: IntoValue, const N: usize> IntoValue for [T; N] {
    fn into_value(self) -> Value {
        list(self)
    }
}

impl<T: IntoValue + Clone> IntoValue for &[T] {
    fn into_value(self) -> Value {
        list(self.iter().cloned())
    }
}

impl<T: IntoValue + Clone> IntoValue for &T {
    fn into_value(self) -> Value {
        self.clone().into_value()
    }
}

/// Row with two columns, such as a time and a velocity.
impl<A: IntoValue, B: IntoValue> IntoValue for (A, B) {
    fn into_value(self) -> Value {
        Value::Array(vec![self.0.into_value(), self.1.into_value()])
    }
}

impl<T: IntoValue + Clone, S: Data<Elem = T>> IntoValue for ArrayBase<S, Ix1> {
    fn into_value(self) -> Value {
        list(self.iter().cloned())
    }
}

/// Converts an array into a list of rows.
impl<T: IntoValue + Clone, S: Data<Elem = T>> IntoValue for ArrayBase<S, Ix2> {
    fn into_value(self) -> Value {
        list(self.rows())
    }
}

impl<K: Into<String>, V: IntoValue> IntoValue for BTreeMap<K, V> {
    fn into_value(self) -> Value {
        table(self)
    }
}

impl<K: Into<String>, V: IntoValue, H> IntoValue for HashMap<K, V, H> {
    fn into_value(self) -> Value {
        table(self)
    }
}
