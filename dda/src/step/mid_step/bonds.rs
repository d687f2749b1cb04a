//! Bonds: parts that lay against each other at the start move as one until their bond breaks.
//!
//! ```text
//! U = −c/dt,   ω_j − ω_i = −θ/dt          c, θ: gap and turn between them at mid-step                  [m/s], [rad/s]
//! ```
//! at the middle of the patch: two fixed rows. What they carry within the step, as a mean force and its moment, is held against the
//! strength of the bond, see [`crate::contact::bond`]. Bonds that do not bear it are gone for good, and the step is solved again with contacts in
//! their place.
//!
//! Blocks that deform keep the middle of the patch and their rotations together; their faces may strain apart around it.
//!
//! Rigid bodies that hit each other break their bonds by forces that go with `1/dt`. Of several bonds between the same blocks the shares are not
//! unique.

use super::closing::Closing;
use crate::contact::dynamics::bodies::Point;
use crate::contact::dynamics::kept::{KeptBond, KeptImpulse};
use crate::contact::report::ContactState;
use crate::{Blocks, Vec3};

/// Rows of a bond: a force, a torque.
const ROWS: usize = 2;

/// Where a bond is.
struct Placed {
    position: Vec3,
    /// Unit, from the first to the second.
    normal: Vec3,
    /// Way of the second from its place on the first; m.
    gap: Vec3,
    /// Its turn from there; rad.
    turn: Vec3,
}

impl Blocks {
    fn place_bond(&self, bond: &KeptBond) -> Placed {
        let [i, j] = [bond.blocks.0, bond.blocks.1].map(|b| b as usize);
        let [q, r] = [i, j].map(|b| self.state.attitude[b]);
        let x = self.anchor(i, &bond.anchors[0]);
        let y = self.anchor(j, &bond.anchors[1]);
        Placed {
            position: (x + y) * 0.5,
            normal: q * bond.normal,
            gap: y - x,
            turn: (r * (q * bond.attitude).inverse()).scaled_axis(),
        }
    }

    /// Place of a material point, given from the centroid in principal axes at the start (m), in the world; m.
    fn anchor(&self, b: usize, anchor: &Vec3) -> Vec3 {
        let from_centroid = match self.is_deformable(b) {
            false => self.state.attitude[b] * anchor,
            true => self.placement_gradient(b) * (self.constants.principal[b] * anchor),
        };
        self.state.centroid[b] + from_centroid
    }

    /// Bonds of blocks that move; those between blocks asleep keep what they carry.
    fn solved_bonds(&self) -> impl Iterator<Item = &KeptBond> {
        let bonds = self.state.bonds.iter();
        bonds.filter(|bond| self.is_solved(bond.blocks))
    }

    /// Rows of the bonds, after all others.
    pub(super) fn add_bonds(&self, closing: &mut Closing, dt: f64) {
        for bond in self.solved_bonds() {
            let placed = self.place_bond(bond);
            let blocks = [bond.blocks.0, bond.blocks.1];
            let arms = blocks.map(|b| self.arm(b, &placed.position));
            let force = Point::new(placed.normal, arms);
            let torque = Point::turning(&force, bond.bond.area.sqrt());
            let [a, b] = blocks.map(|b| &self.state.kinematics[b as usize]);
            let rate = b.velocity_at(&placed.position) - a.velocity_at(&placed.position);
            let rows = [
                (force, rate, placed.gap),
                (torque, b.spin - a.spin, placed.turn),
            ];
            for (point, rate, error) in rows {
                let now = point.frame.tr_mul(&rate);
                let more = closing.bodies.relative(&point, &closing.gains);
                closing.before.push(now);
                closing.gained.push(more);
                closing
                    .free
                    .push(now + more + point.frame.tr_mul(&error) / dt);
                closing.points.push(point);
            }
        }
    }

    /// Impulses of the bonds in the last step for this one.
    pub(super) fn recall_bonds(&self, closing: &Closing, impulses: &mut [Vec3], dt: f64) {
        let points = &closing.points;
        let first = closing.touches.len() + closing.rolling.len();
        for (k, bond) in self.solved_bonds().enumerate() {
            let kept = &self.state.impulses;
            let at = kept.partition_point(|kept| kept.parts < bond.parts);
            if let Some(kept) = kept.get(at).filter(|kept| kept.parts == bond.parts) {
                let row = first + ROWS * k;
                let longer = dt / kept.dt;
                impulses[row] = points[row].frame.tr_mul(&kept.impulse) * longer;
                let torque = points[row + 1].frame.tr_mul(&kept.torque);
                impulses[row + 1] = torque * (longer / bond.bond.area);
            }
        }
    }

    /// What the bonds carry within the step; their rows begin at `first`.
    pub(super) fn carried(
        &self,
        (points, impulses): (&[Point], &[Vec3]),
        first: usize,
        dt: f64,
    ) -> Vec<KeptImpulse> {
        let rows = points[first..].iter().zip(&impulses[first..]);
        let given: Vec<Vec3> = rows.map(|(point, impulse)| point.frame * impulse).collect();
        (self.solved_bonds().zip(given.chunks_exact(ROWS)))
            .map(|(bond, given)| {
                let placed = self.place_bond(bond);
                KeptImpulse {
                    parts: bond.parts,
                    blocks: bond.blocks,
                    position: placed.position,
                    normal: placed.normal,
                    gap: placed.gap.dot(&placed.normal),
                    impulse: given[0],
                    torque: given[1],
                    dt,
                    state: ContactState::Stick,
                    has_slipped: false,
                }
            })
            .collect()
    }

    /// Keeps what bonds carried for the next step, beside the impulses of contacts.
    pub(super) fn keep_carried(&mut self, carried: &[KeptImpulse]) {
        if !carried.is_empty() {
            self.state.impulses.extend_from_slice(carried);
            self.state.impulses.sort_by_key(|kept| kept.parts);
        }
    }

    /// Breaks the bonds that do not bear what they carry; false if all do.
    pub(super) fn break_bonds(&mut self, carried: &[KeptImpulse]) -> bool {
        let mut bonds = std::mem::take(&mut self.state.bonds);
        let n_before = bonds.len();
        let mut carried = carried.iter();
        bonds.retain(|bond| {
            let load = self.is_solved(bond.blocks).then(|| carried.next());
            let bears = load.flatten().is_none_or(|load| self.bears(bond, load));
            if !bears {
                self.break_bond(bond);
            }
            bears
        });
        self.state.bonds = bonds;
        self.state.bonds.len() < n_before
    }

    fn bears(&self, bond: &KeptBond, load: &KeptImpulse) -> bool {
        let to_world = self.state.attitude[bond.blocks.0 as usize];
        let outline: Vec<Vec3> = bond.outline.iter().map(|x| to_world * x).collect();
        let (force, moment) = (load.impulse / load.dt, load.torque / load.dt);
        let joint = self.joint_between(bond.parts);
        let (bond, n) = (&bond.bond, &load.normal);
        !bond.is_rigidly_overloaded(joint, (&force, &moment), n, &outline)
    }

    fn break_bond(&mut self, bond: &KeptBond) {
        let pairs = &mut self.contacts.pairs;
        if let Ok(k) = pairs.binary_search_by_key(&bond.parts, |pair| pair.parts) {
            let history = &mut pairs[k].history;
            history.bond = None;
            history.is_broken = true;
        }
        self.state.totals.n_broken_bonds += 1;
    }
}
