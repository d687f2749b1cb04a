//! Access of a scene: the files beside it and the memory of the machine.

pub mod fault;

use std::path::{Component, Path, PathBuf};

use fault::{Fault, LARGEST_FILE};

/// Folders of the files that a scene names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FilesFrom {
    /// In the scene's folder and those below it, links followed.
    #[default]
    SceneFolder,
    /// Anywhere.
    Anywhere,
}

// the name of 0.1, for one release
pub use Access as Reach;

/// Files and memory that a scene may use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Access<'a> {
    /// Folder of the scene, from which it names files.
    pub folder: &'a Path,
    /// Folders of those files.
    pub files: FilesFrom,
    /// Memory available to a run; `None` where the system does not tell.
    pub memory: Option<Available>,
}

impl<'a> Access<'a> {
    /// Files in the scene's folder, and the memory of this machine.
    pub fn of(folder: &'a Path) -> Self {
        Self {
            folder,
            files: FilesFrom::default(),
            memory: available(),
        }
    }

    /// Memory available to a run, infinite where the system does not tell; bytes.
    pub fn bytes(&self) -> f64 {
        self.memory
            .map_or(f64::INFINITY, |memory| memory.bytes as f64)
    }

    /// Path of a file that the scene names.
    ///
    /// # Errors
    ///
    /// [`Fault::LeavesFolder`], and [`Fault::Unreadable`] for a missing file.
    pub fn find(&self, file: &str) -> Result<PathBuf, Fault> {
        let path = self.folder.join(file);
        if self.files == FilesFrom::Anywhere {
            return Ok(path);
        }
        // what leaves by its name is refused before the file system is asked about it
        if !is_below(file) {
            return Err(Fault::LeavesFolder { to: path });
        }
        let real = path.canonicalize()?;
        // the folder of a scene in the working directory has the empty name
        let folder = Path::new(".").join(self.folder).canonicalize()?;
        if real.starts_with(folder) {
            Ok(path)
        } else {
            Err(Fault::LeavesFolder { to: real })
        }
    }

    /// Content of a file that the scene names.
    ///
    /// # Errors
    ///
    /// Those of [`find`](Self::find), [`Fault::NoFile`] and [`Fault::TooLarge`].
    pub fn read(&self, file: &str) -> Result<Vec<u8>, Fault> {
        let path = self.find(file)?;
        let found = std::fs::metadata(&path)?;
        // a device or a pipe may have no end
        if !found.is_file() {
            return Err(Fault::NoFile);
        }
        if found.len() > LARGEST_FILE {
            return Err(Fault::TooLarge { bytes: found.len() });
        }
        Ok(std::fs::read(path)?)
    }
}

/// True for a path that does not leave its folder, links aside.
pub fn is_below(file: &str) -> bool {
    Path::new(file)
        .components()
        .all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
}

/// Memory available to a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Available {
    /// Bytes.
    pub bytes: u64,
}

/// Memory that the system could give to this process: free memory, or the limit of its control group where that is
/// lower. `None` where the system does not tell.
pub fn available() -> Option<Available> {
    // second, then first version of control groups; "max" is NaN and no limit
    let limits = [
        "/sys/fs/cgroup/memory.max",
        "/sys/fs/cgroup/memory/memory.limit_in_bytes",
    ];
    let limit = limits
        .iter()
        .filter_map(|path| {
            std::fs::read_to_string(path)
                .ok()?
                .trim()
                .parse::<u64>()
                .ok()
        })
        .min();
    free()
        .into_iter()
        .chain(limit)
        .min()
        .map(|bytes| Available { bytes })
}

/// Free memory of the system; bytes.
#[cfg(target_os = "linux")]
fn free() -> Option<u64> {
    // "MemAvailable:   12345 kB"
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text
        .lines()
        .find(|line| line.starts_with("MemAvailable:"))?;
    let kib = line.split_whitespace().nth(1)?.parse::<u64>().ok()?;
    Some(kib.saturating_mul(1024))
}

/// Free memory of the system; bytes.
#[cfg(not(target_os = "linux"))]
fn free() -> Option<u64> {
    let mut system = sysinfo::System::new();
    system.refresh_memory();
    // 0 where it does not tell
    Some(system.available_memory()).filter(|bytes| 0 < *bytes)
}
