//! Checks of loads, supports and rock bolts.

use super::checks::Checks;
use crate::messages::Code;
use crate::scene::file::{AttachmentFile, BlockIntegratorFile, MotionFile, SceneFile, Triple};

impl Checks {
    pub(super) fn attachment(
        &mut self,
        index: usize,
        attachment: &AttachmentFile,
        scene: &SceneFile,
    ) {
        let path = |field: &str| format!("attachments[{index}].{field}");
        let mut known = |field: &str, block: &str| {
            self.block_exists(path(field), "attachment", block, scene);
        };
        match attachment {
            AttachmentFile::PointLoad { block, .. } | AttachmentFile::BodyLoad { block, .. } => {
                known("block", block);
            }
            AttachmentFile::Pressure { block, face, .. } => {
                known("block", block);
                self.direction(path("face"), "attachment: the face", *face);
            }
            AttachmentFile::FixedPoint {
                block, stiffness, ..
            } => {
                known("block", block);
                self.positive(path("stiffness"), "attachment: stiffness", *stiffness);
            }
            AttachmentFile::RockBolt {
                from,
                to,
                from_point,
                to_point,
                stiffness,
                pretension,
                yield_force,
            } => {
                known("from", from);
                known("to", to);
                self.two_blocks(index, "rock bolt", (from, to));
                self.ends_apart(index, "rock bolt", (*from_point, *to_point));
                self.positive(path("stiffness"), "rock bolt: stiffness", *stiffness);
                self.positive(path("yield_force"), "rock bolt: yield force", *yield_force);
                if pretension.abs() > *yield_force {
                    self.refuse(
                        Code::UnusableAttachment,
                        path("pretension"),
                        format!(
                            "rock bolt: pretension {pretension} N exceeds its yield force {yield_force} N"
                        ),
                    );
                }
            }
            AttachmentFile::HeldPoint { block, .. } => {
                known("block", block);
                self.exact_joint(index, scene, &[block]);
            }
            AttachmentFile::BallJoint { from, to, .. } => {
                known("from", from);
                known("to", to);
                self.two_blocks(index, "ball joint", (from, to));
                self.exact_joint(index, scene, &[from, to]);
            }
            AttachmentFile::Rod {
                from,
                to,
                from_point,
                to_point,
                strength,
            } => {
                known("from", from);
                known("to", to);
                self.two_blocks(index, "rod", (from, to));
                self.ends_apart(index, "rod", (*from_point, *to_point));
                self.positive(path("strength"), "rod: strength", *strength);
                self.exact_joint(index, scene, &[from, to]);
            }
        }
    }

    fn two_blocks(&mut self, index: usize, what: &str, (from, to): (&str, &str)) {
        if from == to {
            self.refuse(
                Code::UnusableAttachment,
                format!("attachments[{index}].to"),
                format!("{what}: both ends are in `{to}`; it needs two blocks"),
            );
        }
    }

    fn ends_apart(&mut self, index: usize, what: &str, (from, to): (Triple, Triple)) {
        if from == to {
            self.refuse(
                Code::UnusableAttachment,
                format!("attachments[{index}].to_point"),
                format!("{what}: its ends must be apart"),
            );
        }
    }

    /// An exact joint, which springs do not have, between blocks of which one is free.
    fn exact_joint(&mut self, index: usize, scene: &SceneFile, names: &[&String]) {
        let path = format!("attachments[{index}]");
        if scene.numerics.blocks == BlockIntegratorFile::CentralDifference {
            let message = "an exact joint requires `numerics.blocks: ContactDynamics()`; springs have `FixedPoint` and `RockBolt`";
            self.refuse(Code::IncompatibleOptions, path.clone(), message.to_owned());
        }
        let is_free = |name: &&&String| {
            let block = scene.blocks.iter().find(|block| block.name == ***name);
            // one that is not there is told by its name
            block.is_none_or(|block| matches!(block.motion, MotionFile::Free))
        };
        if names.iter().filter(is_free).count() == 0 {
            let message = format!("joint: `{}` is not free to move", names[0]);
            self.refuse(Code::NeedsFreeBlock, path, message);
        }
    }
}
