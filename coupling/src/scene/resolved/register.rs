//! Who is who among the blocks: groups, materials and joint sets by name.

use crate::scene::file::{BlockFile, SceneFile};

/// Groups, materials and joint sets, each a list of names, and what belongs to each block.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Register {
    /// Names of groups: rock masses, slides, grains, and those that the scene gives.
    pub groups: Vec<String>,
    /// Names of materials in the order of the file.
    pub materials: Vec<String>,
    /// Names of joint sets; sets of one name in two rock masses are one.
    pub joint_sets: Vec<String>,
    /// An entry per block.
    members: Vec<Member>,
}

/// What belongs to a block, by position in the lists.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Member {
    group: Option<usize>,
    material: usize,
    /// Joint sets, and the faces on their joints.
    joint_faces: Vec<(usize, Vec<u32>)>,
}

impl Register {
    /// Register of a file of single blocks.
    pub(in crate::scene) fn of(file: &SceneFile) -> Self {
        let mut register = Self {
            materials: file.materials.iter().map(|m| m.name.clone()).collect(),
            ..Self::default()
        };
        for block in &file.blocks {
            let member = register.member(block);
            register.members.push(member);
        }
        register
    }

    fn member(&mut self, block: &BlockFile) -> Member {
        let material = self.materials.iter().position(|m| *m == block.material);
        Member {
            group: (block.group.as_ref()).map(|group| number_of(group, &mut self.groups)),
            // validation has verified that the name exists
            material: material.unwrap_or(0),
            joint_faces: (block.joint_faces.iter())
                .map(|of| (number_of(&of.set, &mut self.joint_sets), of.faces.clone()))
                .collect(),
        }
    }

    /// Number of the group of a block.
    pub fn group(&self, block: usize) -> Option<usize> {
        self.members.get(block)?.group
    }

    /// Number of the material of a block.
    pub fn material(&self, block: usize) -> Option<usize> {
        Some(self.members.get(block)?.material)
    }

    /// Name of the group of a block; empty without one.
    pub fn group_name(&self, block: usize) -> &str {
        let name = self.group(block).and_then(|group| self.groups.get(group));
        name.map_or("", String::as_str)
    }

    /// Name of the material of a block.
    pub fn material_name(&self, block: usize) -> &str {
        let material = self.material(block).and_then(|m| self.materials.get(m));
        material.map_or("", String::as_str)
    }

    /// Names of the joint sets that bound a block.
    pub fn joint_set_names(&self, block: usize) -> impl Iterator<Item = &str> {
        let member = self.members.get(block);
        let sets = member.into_iter().flat_map(|member| &member.joint_faces);
        sets.filter_map(|(set, _)| Some(self.joint_sets.get(*set)?.as_str()))
    }

    /// Joint set of a face of a block, by its number from 0, part after part.
    pub fn joint_set_of_face(&self, block: usize, face: usize) -> Option<usize> {
        let member = self.members.get(block)?;
        let is_on = |(_, faces): &&(usize, Vec<u32>)| faces.contains(&(face as u32));
        (member.joint_faces.iter()).find(is_on).map(|(set, _)| *set)
    }
}

/// Position of a name in a list, at whose end it is put if it is new.
fn number_of(name: &str, names: &mut Vec<String>) -> usize {
    let found = names.iter().position(|other| other == name);
    found.unwrap_or_else(|| {
        names.push(name.to_owned());
        names.len() - 1
    })
}
