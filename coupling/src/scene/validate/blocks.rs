//! Checks of single blocks: material, motion, deformability and constraints.

use super::checks::{Checks, is_zero};
use crate::messages::Code;
use crate::scene::file::{
    BlockFile, DeformableFile, HoldFile, MotionFile, SceneFile, ShapeFile, TurningFile,
};

impl Checks {
    pub(super) fn block(&mut self, index: usize, block: &BlockFile, scene: &SceneFile) {
        let at = At { index, block };
        self.material_exists(
            at.path("material"),
            &at.of("material"),
            &block.material,
            scene,
        );
        let is_surface = matches!(
            block.shape,
            ShapeFile::Surface { .. } | ShapeFile::Raster { .. } | ShapeFile::Terrain
        );
        if is_surface && !matches!(block.motion, MotionFile::Fixed) {
            self.refuse(
                Code::IncompatibleOptions,
                at.path("motion"),
                at.of("motion must be Fixed: a surface has no mass"),
            );
        }
        self.shape(&at.path("shape"), &block.shape, &block.name);
        if let Some(turn) = &block.placement.rotate {
            let what = at.of("axis of rotation");
            self.direction(at.path("placement.rotate.axis"), &what, turn.axis);
        }
        if let MotionFile::Shaking { direction, .. } = &block.motion {
            self.direction(at.path("motion.direction"), &at.of("motion"), *direction);
        }
        if let Some(deformable) = &block.deformable {
            self.deformable(&at, deformable, scene);
        }
        if let Some(hold) = &block.hold {
            self.hold(&at, hold);
        }
        if let MotionFile::Sinusoid {
            direction,
            amplitude,
            period,
            ramp,
            ..
        } = &block.motion
        {
            self.direction(at.path("motion.direction"), &at.of("motion"), *direction);
            self.not_negative(at.path("motion.amplitude"), &at.of("amplitude"), *amplitude);
            self.positive(at.path("motion.period"), &at.of("period"), *period);
            self.not_negative(at.path("motion.ramp"), &at.of("ramp"), *ramp);
        }
        if let MotionFile::Path {
            bend_radius, base, ..
        } = &block.motion
        {
            if let Some(radius) = bend_radius {
                let what = at.of("radius of its bends");
                self.positive(at.path("motion.bend_radius"), &what, *radius);
            }
            self.not_negative(at.path("motion.base"), &at.of("base"), *base);
        }
        self.labels(&at);
        let starts_at_rest = is_zero(block.velocity) && is_zero(block.angular_velocity);
        if !starts_at_rest && !at.is_free() {
            self.warn(
                Code::OptionWithoutEffect,
                at.path("velocity"),
                at.of("an initial velocity has no effect on a block that is not free"),
            );
        }
    }

    /// Checks of the group and of the faces on joints.
    fn labels(&mut self, at: &At) {
        let group = at.block.group.iter().map(|name| (at.path("group"), name));
        let sets = at.block.joint_faces.iter().enumerate();
        let sets = sets.map(|(k, of)| (at.path(&format!("joint_faces[{k}].set")), &of.set));
        for (path, name) in group.chain(sets) {
            self.label(path, name);
        }
        let n_faces = match &at.block.shape {
            ShapeFile::Polyhedron { faces, .. } => faces.len(),
            ShapeFile::Polyhedra { parts } => parts.iter().map(|part| part.faces.len()).sum(),
            _ => 0,
        };
        for (k, of) in at.block.joint_faces.iter().enumerate() {
            if let Some(face) = of.faces.iter().find(|face| n_faces <= **face as usize) {
                self.refuse(
                    Code::UnknownName,
                    at.path(&format!("joint_faces[{k}].faces")),
                    at.of(&match n_faces {
                        0 => {
                            "only the faces of a Polyhedron or of Polyhedra are numbered".to_owned()
                        }
                        _ => format!("there is no face {face}: it has {n_faces}, numbered from 0"),
                    }),
                );
            }
        }
    }

    fn deformable(&mut self, at: &At, deformable: &DeformableFile, scene: &SceneFile) {
        let name = &at.block.material;
        let material = scene.materials.iter().find(|m| m.name == *name);
        if material.is_some_and(|m| m.elastic.is_none()) {
            self.refuse(
                Code::UnusableDeformable,
                at.path("deformable"),
                format!(
                    "{} needs a material with elastic moduli; give `{name}` its `elastic`",
                    at.of("deformable")
                ),
            );
        }
        if !at.is_free() || matches!(at.block.shape, ShapeFile::Sphere { .. }) {
            self.refuse(
                Code::UnusableDeformable,
                at.path("deformable"),
                at.of("it must be a free block of polyhedra; leave deformable out"),
            );
        }
        if deformable.strain_mass_factor < 1.0 {
            self.refuse(
                Code::ValueOutOfRange,
                at.path("deformable.strain_mass_factor"),
                format!(
                    "{} must be at least 1, found {}",
                    at.of("strain mass factor"),
                    deformable.strain_mass_factor
                ),
            );
        }
    }

    fn hold(&mut self, at: &At, hold: &HoldFile) {
        if !at.is_free() {
            self.refuse(
                Code::NeedsFreeBlock,
                at.path("hold"),
                at.of("only a free block can be held; leave hold out"),
            );
        }
        if at.block.deformable.is_some() && hold.turning != TurningFile::Free {
            self.refuse(
                Code::IncompatibleOptions,
                at.path("hold.turning"),
                at.of("the turning of a deformable block cannot be held"),
            );
        }
        for (k, axis) in hold.directions.iter().enumerate() {
            let path = at.path(&format!("hold.directions[{k}]"));
            let what = format!("{} {axis:?}", at.of("hold"));
            self.listed_once(&path, what, (&hold.directions, k));
        }
    }
}

/// Block being checked.
struct At<'a> {
    index: usize,
    block: &'a BlockFile,
}

impl At<'_> {
    fn path(&self, field: &str) -> String {
        format!("blocks[{}].{field}", self.index)
    }

    fn of(&self, what: &str) -> String {
        format!("block `{}`: {what}", self.block.name)
    }

    fn is_free(&self) -> bool {
        matches!(self.block.motion, MotionFile::Free)
    }
}
