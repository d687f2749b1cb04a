//! Collection of the files of a run with their times.

use super::write::{escape, replace_file};
use super::{Fault, VtkError};
use std::path::{Path, PathBuf};

/// An index of frames, in both formats that ParaView opens as an animation: `<stem>.pvd` and `<stem>.vtp.series`.
///
/// Neither format can be appended to, so both are rewritten after each frame and renamed once complete: the
/// animation can be opened during the run, and after a crash.
#[derive(Clone, Debug)]
pub struct Collection {
    pvd: PathBuf,
    series: PathBuf,
    frames: Vec<(f64, String)>,
}

impl Collection {
    /// An empty collection; writes nothing before the first frame.
    pub fn new(folder: &Path, stem: &str) -> Self {
        Self {
            pvd: folder.join(format!("{stem}.pvd")),
            series: folder.join(format!("{stem}.vtp.series")),
            frames: Vec::new(),
        }
    }

    /// Adds a finished file, named relative to the folder of the collection, and rewrites both forms; `time` in s.
    ///
    /// # Errors
    /// [`VtkError::Data`] if `time` is not finite, [`VtkError::Io`] if writing fails.
    pub fn push(&mut self, time: f64, file_name: impl Into<String>) -> Result<(), VtkError> {
        self.add(time, file_name)?;
        self.write()
    }

    /// Adds a file that is yet to be written: [`Self::write`] follows once it is there.
    ///
    /// # Errors
    /// [`VtkError::Data`] if `time` is not finite.
    pub fn add(&mut self, time: f64, file_name: impl Into<String>) -> Result<(), VtkError> {
        if !time.is_finite() {
            return Err(VtkError::data(&self.pvd)(Fault::Time { time }));
        }
        self.frames.push((time, file_name.into()));
        Ok(())
    }

    /// The frames so far: time (s) and file.
    pub fn frames(&self) -> &[(f64, String)] {
        &self.frames
    }

    /// Resets the collection to these frames and rewrites both files; removes them if there are no frames.
    ///
    /// # Errors
    /// [`VtkError::Io`] if writing fails.
    pub fn go_back(&mut self, frames: Vec<(f64, String)>) -> Result<(), VtkError> {
        self.frames = frames;
        if self.frames.is_empty() {
            for path in [&self.pvd, &self.series] {
                match std::fs::remove_file(path) {
                    Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                        return Err(VtkError::io("remove", path)(error));
                    }
                    _ => {}
                }
            }
            return Ok(());
        }
        self.write()
    }

    /// Rewrites both files, once the frames exist.
    ///
    /// # Errors
    /// [`VtkError::Io`] if writing fails.
    pub fn write(&self) -> Result<(), VtkError> {
        replace_file(&self.pvd, &[self.pvd_text().as_bytes()])?;
        replace_file(&self.series, &[self.series_text().as_bytes()])
    }

    fn pvd_text(&self) -> String {
        let mut text = String::from(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n  <Collection>\n",
        );
        for (time, file) in &self.frames {
            let file = escape(file);
            text += &format!(
                "    <DataSet timestep=\"{time:?}\" group=\"\" part=\"0\" file=\"{file}\"/>\n"
            );
        }
        text + "  </Collection>\n</VTKFile>\n"
    }

    fn series_text(&self) -> String {
        let frames = self.frames.iter();
        let files: Vec<String> = frames
            .map(|(time, file)| format!("    {}", serde_json::json!({"name": file, "time": time})))
            .collect();
        format!(
            "{{\n  \"file-series-version\": \"1.0\",\n  \"files\": [\n{}\n  ]\n}}\n",
            files.join(",\n")
        )
    }
}
