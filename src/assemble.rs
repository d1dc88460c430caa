//! The one place where a scene chooses types.
