//! Output of a run: observers, their files, the summary and the checkpoint.

pub mod bodies;
pub mod checkpoint_file;
pub mod observe;
pub mod peaks;
pub mod progress_file;
pub mod run_folder;
pub mod summary;
pub mod verdict;
