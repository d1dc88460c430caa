//! A temporary folder for intermediate result files.

use std::path::{Path, PathBuf};

use crate::destination;
use crate::error::Result;

/// It is removed with the value.
pub(super) struct Scratch(PathBuf);

impl Scratch {
    /// For a command of this name.
    pub fn new(command: &str) -> Result<Self> {
        let folder = std::env::temp_dir().join(format!("barwave-{command}-{}", std::process::id()));
        destination::folder_at(&folder)?;
        Ok(Self(folder))
    }

    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // What cannot be removed stays where the system keeps such things.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
