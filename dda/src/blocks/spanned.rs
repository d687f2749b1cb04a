//! Place of the blocks among their own steps, where these do not end with those of the caller.

use crate::Load;
use serde::{Deserialize, Serialize};

/// Time between kicks of contact dynamics.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Spanned {
    /// Time passed that no kick has covered yet, below 0 where one has covered time to come; s.
    pub owed: f64,
    /// Period of the last kick, 0 before the first; s.
    pub period: f64,
    /// Impulses from outside that the last kick gave in advance; one per block, empty before the first; N s, N m s.
    pub ahead: Vec<Load>,
}
