//! Checks of loads, supports and rock bolts.

use super::checks::Checks;
use crate::messages::Code;
use crate::scene::file::{AttachmentFile, SceneFile};

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
                if from == to {
                    self.refuse(
                        Code::UnusableAttachment,
                        path("to"),
                        format!("rock bolt: both ends are in `{to}`; it needs two blocks"),
                    );
                }
                if from_point == to_point {
                    self.refuse(
                        Code::UnusableAttachment,
                        path("to_point"),
                        "rock bolt: its ends must be apart".to_owned(),
                    );
                }
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
        }
    }
}
