//! The lists of pairs of parts that may touch, with their history.

use super::NOWHERE;
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

impl Blocks {
    /// Lists the pairs of parts whose fat boxes overlap; pairs that stay keep their history.
    pub(crate) fn find_candidates(&mut self) {
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
        // The boxes of spheres overlap at their corners long before the spheres touch.
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
                // Inside its fat box a sphere moves by the margin along each axis.
                let reach = r + s + 3.0_f64.sqrt() * (self.margin_of(i) + self.margin_of(j));
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
        self.constants.margin[part] + self.scratch.reach_of(part)
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
        let mut old = std::mem::take(&mut self.scratch.sphere_pairs_before);
        old.clear();
        old.extend((0..self.contacts.sphere_pairs.len()).map(|k| {
            SpherePairBefore {
                pair: self.contacts.sphere_pairs[k],
                mark: self.contacts.sphere_marks[k],
                contact: self.contacts.sphere_contacts[k],
                loads: self.contacts.sphere_loads[k],
                rates: self.contacts.sphere_rates[k],
                rolling: self
                    .contacts
                    .sphere_rolling
                    .get(k)
                    .copied()
                    .unwrap_or_default(),
            }
        }));
        self.contacts.sphere_pairs.clear();
        self.contacts.sphere_marks.clear();
        self.contacts.sphere_contacts.clear();
        self.contacts.sphere_loads.clear();
        self.contacts.sphere_rates.clear();
        self.contacts.sphere_rolling.clear();
        let mut rest = old.drain(..).peekable();
        for k in 0..self.scratch.candidates.len() {
            let parts = self.scratch.candidates[k];
            if self.kind_of(parts) != PairKind::Sphere {
                continue;
            }
            while rest.next_if(|old| old.pair.parts < parts).is_some() {}
            let row = rest
                .next_if(|old| old.pair.parts == parts)
                .unwrap_or_else(|| SpherePairBefore {
                    pair: SpherePair {
                        parts,
                        blocks: self.blocks_of(parts),
                    },
                    mark: SphereMark::default(),
                    contact: SphereContact::apart(self.scales_of(parts)),
                    loads: SphereLoads::default(),
                    rates: PairRates::default(),
                    rolling: Rolling::default(),
                });
            self.contacts.sphere_pairs.push(row.pair);
            self.contacts.sphere_marks.push(row.mark);
            self.contacts.sphere_contacts.push(row.contact);
            self.contacts.sphere_loads.push(row.loads);
            self.contacts.sphere_rates.push(row.rates);
            if self.constants.has_rolling {
                self.contacts.sphere_rolling.push(row.rolling);
            }
        }
        drop(rest);
        self.scratch.sphere_pairs_before = old;
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

/// A row of all columns of the pairs with a sphere, while their list is rebuilt.
#[derive(Clone, Debug)]
pub(crate) struct SpherePairBefore {
    pair: SpherePair,
    mark: SphereMark,
    contact: SphereContact,
    loads: SphereLoads,
    rates: PairRates,
    rolling: Rolling,
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
