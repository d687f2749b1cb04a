//! The lists of pairs of parts that may touch, with their history.

use super::{Contacts, NOWHERE};
use crate::contact::context::ContactContext;
use crate::contact::detection::broad_phase;
use crate::contact::detection::broad_phase::Bounds;
use crate::contact::penalty::polyhedra::{Pair, Workspace};
use crate::contact::penalty::spheres::{
    PairRates, Rolling, Scales, SphereContact, SphereLoads, SphereMark, SpherePair,
};
use crate::contact::penalty::terrain::SurfacePair;
use crate::contact::tally::PAIR_CHUNK;
use crate::geometry::parts::Part;
use crate::{Blocks, Motion, NormalLaw};

/// Steps that a sphere takes to cross its margin, unless that is more than so many times that at rest: a few fast ones would have all pairs
/// listed anew in each of their steps, or steps as short as a share of the margin at rest.
const STEPS_PER_MARGIN: f64 = 16.0;
const LARGEST_MARGIN: f64 = 5.0;
/// Largest share of a margin above that at rest that a step may use up.
const SHARE_OF_STEP: f64 = 0.25;
/// Relative difference of margins that are equal.
const ROUND_OFF: f64 = 1e-6;

impl Blocks {
    /// Lists the pairs of parts whose fat boxes overlap, after a step (s); pairs that stay keep their history.
    pub(crate) fn find_candidates(&mut self, dt: f64) {
        self.note_margins(dt);
        for part in 0..self.derived.parts.len() {
            self.state.fat_boxes[part] =
                if self.state.is_removed[self.constants.block_of_part[part] as usize] {
                    NOWHERE
                } else {
                    broad_phase::grown(&self.state.boxes[part], self.margin_of(part))
                };
        }
        let mut candidates = std::mem::take(&mut self.scratch.candidates);
        let (block_of, motion) = (&self.constants.block_of_part, &self.constants.motion);
        let parts = &self.derived.parts;
        // The boxes of spheres overlap at their corners long before the spheres touch, which move by their margin in any direction.
        let may_meet = |i: usize, j: usize| match (&parts[i], &parts[j]) {
            (
                Part::Sphere {
                    center: a,
                    radius: r,
                },
                Part::Sphere {
                    center: b,
                    radius: s,
                },
            ) => {
                let reach = r + s + self.margin_of(i) + self.margin_of(j);
                (b - a).norm_squared() < reach * reach
            }
            _ => true,
        };
        broad_phase::candidates(
            &self.state.fat_boxes,
            &self.derived.can_move,
            |i, j| {
                let (a, b) = (block_of[i as usize] as usize, block_of[j as usize] as usize);
                let is_free = |block: usize| matches!(motion[block], Motion::Free);
                a != b && (is_free(a) || is_free(b)) && may_meet(i as usize, j as usize)
            },
            &mut candidates,
        );
        self.scratch.candidates = candidates;
        self.keep_pairs();
        self.keep_sphere_pairs();
        self.keep_surface_pairs();
        self.link_pairs();
    }

    /// Margin of the fat box of a part, with its reach in this step; m.
    fn margin_of(&self, part: usize) -> f64 {
        self.scratch.margin[part] + self.scratch.reach_of(part)
    }

    /// Margins until pairs are listed next. That of a sphere follows its speed; bodies that may be thin keep theirs, which is a share of their
    /// thickness.
    fn note_margins(&mut self, dt: f64) {
        let mut margin = std::mem::take(&mut self.scratch.margin);
        margin.clone_from(&self.constants.margin);
        for b in (0..self.n_blocks()).filter(|&b| self.is_free(b)) {
            if let Some(part) = self.only_sphere(b) {
                let way = STEPS_PER_MARGIN * dt * self.state.velocity[b].norm();
                margin[part] = way.clamp(margin[part], LARGEST_MARGIN * margin[part]);
            }
        }
        self.scratch.margin = margin;
    }

    /// Margin of a part that moves when pairs were last listed; m.
    fn listed_margin(&self, part: usize) -> f64 {
        let side = |(low, high): &Bounds| high.x - low.x;
        0.5 * (side(&self.state.fat_boxes[part]) - side(&self.state.boxes[part]))
    }

    /// Longest way of a sphere in a step if its margin is larger than at rest: pairs are then listed anew a step before it may have crossed that. Zero
    /// of others, and in contact dynamics, where a step has a reach; m.
    pub(crate) fn lead_of(&self, part: usize) -> f64 {
        if !(self.derived.parts[part].is_sphere() && self.scratch.reach.is_empty()) {
            return 0.0;
        }
        let margin = self.listed_margin(part);
        let is_fast = margin > (1.0 + ROUND_OFF) * self.constants.margin[part];
        if is_fast { SHARE_OF_STEP * margin } else { 0.0 }
    }

    /// Has a part that moves used up its margin?
    pub(crate) fn has_left(&self, part: usize) -> bool {
        let (fat, bounds) = (&self.state.fat_boxes[part], &self.state.boxes[part]);
        let reach = self.scratch.reach_of(part);
        if let Part::Sphere { center, .. } = &self.derived.parts[part] {
            let way = (center - 0.5 * (fat.0 + fat.1)).norm();
            return !(way + reach + self.lead_of(part) <= self.listed_margin(part));
        }
        !broad_phase::holds(fat, &broad_phase::grown(bounds, reach))
    }

    /// Part of a block that is a single sphere.
    pub(crate) fn only_sphere(&self, b: usize) -> Option<usize> {
        let parts = self.parts_of(b);
        (parts.len() == 1 && self.derived.parts[parts.start].is_sphere()).then_some(parts.start)
    }

    /// List of a pair of parts.
    fn kind_of(&self, parts: (u32, u32)) -> PairKind {
        let (i, j) = (
            &self.derived.parts[parts.0 as usize],
            &self.derived.parts[parts.1 as usize],
        );
        if i.is_surface() || j.is_surface() {
            PairKind::Surface
        } else if i.is_sphere() || j.is_sphere() {
            PairKind::Sphere
        } else {
            PairKind::Polyhedra
        }
    }

    fn blocks_of(&self, parts: (u32, u32)) -> (u32, u32) {
        let block = |part: u32| self.constants.block_of_part[part as usize];
        (block(parts.0), block(parts.1))
    }

    fn keep_pairs(&mut self) {
        std::mem::swap(&mut self.contacts.pairs, &mut self.scratch.pairs_before);
        let mut old = std::mem::take(&mut self.scratch.pairs_before);
        let mut rest = old.drain(..).peekable();
        for k in 0..self.scratch.candidates.len() {
            let parts = self.scratch.candidates[k];
            if self.kind_of(parts) != PairKind::Polyhedra {
                continue;
            }
            while rest.next_if(|pair| pair.parts < parts).is_some() {}
            let pair = rest
                .next_if(|pair| pair.parts == parts)
                .unwrap_or_else(|| Pair::new(parts, self.blocks_of(parts)));
            self.contacts.pairs.push(pair);
        }
        drop(rest);
        self.scratch.pairs_before = old;
        let n_chunks = self.contacts.pairs.len().div_ceil(PAIR_CHUNK);
        if self.scratch.workspaces.len() < n_chunks {
            self.scratch
                .workspaces
                .resize_with(n_chunks, Workspace::default);
        }
    }

    fn scales_of(&self, parts: (u32, u32)) -> Scales {
        let (i, j) = (parts.0 as usize, parts.1 as usize);
        Scales::of(
            (&self.derived.parts[i], &self.derived.parts[j]),
            self.constants.overlap_limits().of(parts),
            self.constants.overlap_limits().size_of(parts),
        )
    }

    fn keep_sphere_pairs(&mut self) {
        let mut before = std::mem::take(&mut self.scratch.spheres_before);
        let mut former = std::mem::take(&mut self.scratch.former);
        before.swap_spheres(&mut self.contacts);
        self.contacts.sphere_pairs.clear();
        former.clear();
        let mut rest = (0..).zip(&before.sphere_pairs).peekable();
        for k in 0..self.scratch.candidates.len() {
            let parts = self.scratch.candidates[k];
            if self.kind_of(parts) != PairKind::Sphere {
                continue;
            }
            while rest.next_if(|(_, old)| old.parts < parts).is_some() {}
            let old = rest.next_if(|(_, old)| old.parts == parts);
            former.push(old.map_or(NEW, |(k, _)| k));
            let blocks = self.blocks_of(parts);
            self.contacts
                .sphere_pairs
                .push(SpherePair { parts, blocks });
        }
        let mut now = std::mem::take(&mut self.contacts);
        let Contacts {
            sphere_pairs,
            sphere_marks,
            sphere_contacts,
            sphere_loads,
            sphere_rates,
            sphere_rolling,
            ..
        } = &mut now;
        let apart = |k: usize| SphereContact::apart(self.scales_of(sphere_pairs[k].parts));
        rayon::join(
            || {
                follow(sphere_contacts, &before.sphere_contacts, &former, apart);
                let new = |_| SphereMark::default();
                follow(sphere_marks, &before.sphere_marks, &former, new);
            },
            || {
                let new = |_| SphereLoads::default();
                follow(sphere_loads, &before.sphere_loads, &former, new);
                let new = |_| PairRates::default();
                follow(sphere_rates, &before.sphere_rates, &former, new);
                if self.constants.has_rolling {
                    let new = |_| Rolling::default();
                    follow(sphere_rolling, &before.sphere_rolling, &former, new);
                }
            },
        );
        self.contacts = now;
        self.scratch.spheres_before = before;
        self.scratch.former = former;
    }

    /// Surfaces are few: the pairs are sorted by candidates, whichever of the two the body is.
    fn keep_surface_pairs(&mut self) {
        std::mem::swap(
            &mut self.contacts.surface_pairs,
            &mut self.scratch.surface_pairs_before,
        );
        let mut old = std::mem::take(&mut self.scratch.surface_pairs_before);
        let sorted = |pair: &SurfacePair| {
            (
                pair.parts.0.min(pair.parts.1),
                pair.parts.0.max(pair.parts.1),
            )
        };
        let mut rest = old.drain(..).peekable();
        for k in 0..self.scratch.candidates.len() {
            let parts = self.scratch.candidates[k];
            if self.kind_of(parts) != PairKind::Surface {
                continue;
            }
            while rest.next_if(|pair| sorted(pair) < parts).is_some() {}
            let mut pair = rest
                .next_if(|pair| sorted(pair) == parts)
                .unwrap_or_else(|| {
                    let (body, surface) = if self.derived.parts[parts.0 as usize].is_surface() {
                        (parts.1, parts.0)
                    } else {
                        parts
                    };
                    let ordered = (body, surface);
                    SurfacePair::new(
                        ordered,
                        self.blocks_of(ordered),
                        &self.derived.parts[body as usize],
                    )
                });
            if let Part::Surface(surface) = &self.derived.parts[pair.parts.1 as usize] {
                let body = pair.parts.0 as usize;
                pair.reach = self.constants.margin[body];
                let within = broad_phase::grown(&self.state.fat_boxes[body], pair.reach);
                surface.near(&within, &mut pair.triangles);
            }
            self.contacts.surface_pairs.push(pair);
        }
        drop(rest);
        self.scratch.surface_pairs_before = old;
    }

    pub(super) fn link_pairs(&mut self) {
        let n = self.n_blocks();
        self.derived.has_new_links = true;
        self.derived.surface_links.set(
            n,
            self.contacts.surface_pairs.iter().map(|pair| pair.blocks),
        );
        self.derived
            .links
            .set(n, self.contacts.pairs.iter().map(|pair| pair.blocks));
        self.derived
            .sphere_links
            .set(n, self.contacts.sphere_pairs.iter().map(|pair| pair.blocks));
    }

    pub(crate) fn split_pairs(&mut self) -> (Lists<'_>, ContactContext<'_>, &[Bounds]) {
        let context = ContactContext {
            parts: &self.derived.parts,
            kinematics: &self.state.kinematics,
            update: &self.derived.update,
            motion: &self.constants.motion,
            joints: &self.state.joints,
            material_of_part: &self.constants.material_of_part,
            n_materials: self.constants.n_materials,
            rolling_law: self.constants.settings.rolling_law,
            radius: &self.constants.radius,
            travel: &self.state.travel,
            lever_arm: &self.constants.lever_arm,
            contact_detection: self.constants.settings.contact_detection,
            step_bound: self.constants.settings.step_bound,
            gravity: self.constants.settings.gravity,
            is_hertz: self.constants.settings.normal_law == NormalLaw::Hertz,
            overlap_limits: self.constants.overlap_limits(),
        };
        let lists = Lists {
            pairs: &mut self.contacts.pairs,
            workspaces: &mut self.scratch.workspaces,
            sphere_pairs: &self.contacts.sphere_pairs,
            surface_pairs: &mut self.contacts.surface_pairs,
            sphere_marks: &mut self.contacts.sphere_marks,
            sphere_contacts: &mut self.contacts.sphere_contacts,
            sphere_loads: &mut self.contacts.sphere_loads,
            sphere_rates: &mut self.contacts.sphere_rates,
            sphere_rolling: &mut self.contacts.sphere_rolling,
        };
        (lists, context, &self.state.boxes)
    }

    pub(super) fn bond_pairs(&mut self) {
        let (lists, context, _) = self.split_pairs();
        lists.pairs.iter_mut().for_each(|pair| pair.bond(&context));
    }
}

/// Of a pair that was not on the list before.
const NEW: u32 = u32::MAX;

/// Fills a column of pairs with what they had before, or with that of new ones.
fn follow<T: Copy>(column: &mut Vec<T>, before: &[T], former: &[u32], new: impl Fn(usize) -> T) {
    column.clear();
    let rows = former.iter().enumerate();
    column.extend(rows.map(|(k, &old)| match old {
        NEW => new(k),
        old => before[old as usize],
    }));
}

/// List of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PairKind {
    Polyhedra,
    Sphere,
    Surface,
}

/// The lists of pairs, borrowed together.
pub(crate) struct Lists<'a> {
    pub pairs: &'a mut Vec<Pair>,
    pub workspaces: &'a mut Vec<Workspace>,
    pub sphere_pairs: &'a Vec<SpherePair>,
    pub surface_pairs: &'a mut Vec<SurfacePair>,
    pub sphere_marks: &'a mut Vec<SphereMark>,
    pub sphere_contacts: &'a mut Vec<SphereContact>,
    pub sphere_loads: &'a mut Vec<SphereLoads>,
    pub sphere_rates: &'a mut Vec<PairRates>,
    pub sphere_rolling: &'a mut Vec<Rolling>,
}
