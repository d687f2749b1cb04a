//! From rock masses to blocks: joint sets cut, slivers merge.

pub(crate) mod joint_sets;
