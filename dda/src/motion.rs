//! Kinematics of bodies: rigid, deforming, prescribed and held.

pub(crate) mod deformation;
pub(crate) mod holds;
pub(crate) mod kinematics;
pub(crate) mod path;
pub(crate) mod prescribed;
pub(crate) mod rigid;
mod table;
pub(crate) mod update;
