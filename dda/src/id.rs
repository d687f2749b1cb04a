//! Numbers of blocks and parts as types of their own, so that they cannot be mixed with others.

use std::fmt::{self, Display, Formatter};

use serde::{Deserialize, Serialize};

/// Number of a block, in the order of their definitions.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(transparent)]
pub struct BlockId(u32);

/// Number of a convex part, sphere or surface, in the order of the blocks.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(transparent)]
pub struct PartId(u32);

macro_rules! ids {
    ($($name:ident),+) => {$(
        impl $name {
            /// The number at an index into the columns.
            pub fn new(index: usize) -> Self {
                Self(index as u32)
            }

            /// Index into the columns.
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl From<u32> for $name {
            fn from(number: u32) -> Self {
                Self(number)
            }
        }

        impl From<$name> for u32 {
            fn from(id: $name) -> Self {
                id.0
            }
        }

        impl Display for $name {
            fn fmt(&self, f: &mut Formatter) -> fmt::Result {
                self.0.fmt(f)
            }
        }
    )+};
}

ids!(BlockId, PartId);
