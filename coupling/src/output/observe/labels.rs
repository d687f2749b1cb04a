//! Numbers of blocks, groups, materials and joint sets on faces, and the names that they stand for.

use super::arrays::integers;
use crate::files::vtk::{Names, PolyData};
use crate::scene::resolve::Scene;
use crate::scene::resolved::register::Register;

/// Number of a face without a group or a joint set.
const NONE: i32 = -1;

/// Names of the blocks of a run, for its frames.
#[derive(Clone, Debug)]
pub(super) struct Labels {
    register: Register,
    /// Lists of names, by whose positions the arrays are numbered. They go into every frame, because a viewer has one at a time.
    names: Vec<Names>,
}

impl Labels {
    pub(super) fn of(scene: &Scene) -> Self {
        let register = &scene.register;
        let lists = [
            ("BlockNames", &scene.block_names),
            ("GroupNames", &register.groups),
            ("MaterialNames", &register.materials),
            ("JointSetNames", &register.joint_sets),
        ];
        let filled = lists.into_iter().filter(|(_, list)| !list.is_empty());
        let named = |(name, list): (&str, &Vec<String>)| Names {
            name: name.to_owned(),
            list: list.clone(),
        };
        Self {
            register: register.clone(),
            names: filled.map(named).collect(),
        }
    }

    /// Adds the labels of faces, each with its block and its number in it. Arrays that would be empty of meaning are left out.
    pub(super) fn add_to(&self, data: &mut PolyData, owner: &[usize], faces: &[usize]) {
        let register = &self.register;
        let number = |found: Option<usize>| found.map_or(NONE, |k| k as i32);
        let per_face = |name: &str, of: &dyn Fn(usize) -> i32| {
            integers(name, owner.iter().map(|&block| of(block)).collect())
        };
        let arrays = &mut data.cell_data;
        arrays.push(per_face("BlockId", &|b| b as i32));
        if !register.groups.is_empty() {
            arrays.push(per_face("GroupId", &|b| number(register.group(b))));
        }
        arrays.push(per_face("MaterialId", &|b| number(register.material(b))));
        if !register.joint_sets.is_empty() {
            let of = |(&block, &face)| number(register.joint_set_of_face(block, face));
            let sets = owner.iter().zip(faces).map(of);
            arrays.push(integers("JointSet", sets.collect()));
        }
        data.names.clone_from(&self.names);
    }
}
