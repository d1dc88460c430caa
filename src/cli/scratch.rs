//! A temporary folder for intermediate result files.

use std::path::{Path, PathBuf};

use crate::destination;
use crate::error::Result;

/// Temporary folder, which is removed when this value is dropped.
pub(super) struct Scratch(PathBuf);

impl Scratch {
    /// Creates a folder for a command of this name.
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
        // A folder that cannot be removed remains in the temporary folder of the system.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
