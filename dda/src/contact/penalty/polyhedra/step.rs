//! One evaluation of the law of two polyhedra: what was found becomes forces, and the step its account.

use super::History;
use crate::Vec3;
use crate::contact::detection::manifold::{Features, Manifold, ManifoldPoint};
use crate::contact::detection::patch::Patch;
use crate::contact::penalty::feature_change;
use crate::contact::penalty::friction::{ShearSpring, Shearing};
use crate::contact::penalty::history::PairLoads;
use crate::contact::penalty::impact;
use crate::contact::penalty::law::PairLaw;
use crate::contact::penalty::normal::{Bearing, dashpot_share};
use crate::contact::penalty::work::Acting;
use crate::contact::report::PointState;
use crate::motion::kinematics::Load;

/// One evaluation of the law of two polyhedra.
pub(super) struct Step<'a> {
    law: PairLaw<'a>,
    history: &'a mut History,
    loads: &'a mut PairLoads,
    /// The contact of the step before: points, normal, features.
    former: &'a [PointState],
    former_normal: Vec3,
    former_features: Option<Features>,
    /// The shear spring moves once in a step, whether the bond breaks in it or not.
    former_shear: ShearSpring,
    /// J.
    shear_energy: f64,
}

impl<'a> Step<'a> {
    /// Books the first half of the step and lays the former contact aside.
    pub fn begin(
        law: PairLaw<'a>,
        history: &'a mut History,
        loads: &'a mut PairLoads,
        before: &'a mut Vec<PointState>,
    ) -> Self {
        loads.clear();
        before.clear();
        std::mem::swap(before, &mut history.points);
        let step = Self {
            law,
            former: before,
            former_normal: history.normal,
            former_features: history.features.take(),
            former_shear: history.shear,
            shear_energy: 0.0,
            history,
            loads,
        };
        step.former().book_half(law.dt, &mut step.loads.losses);
        step
    }

    fn former(&self) -> Acting<'a, Vec3> {
        Acting {
            bodies: self.law.bodies,
            points: self.former,
            normals: self.former_normal,
            ago: self.law.dt,
        }
    }

    /// Forces on a manifold:
    ///
    /// 1. new features go on with the energy of the old ones;
    /// 2. normal springs and dashpots;
    /// 3. the shear spring, up to Coulomb's limit;
    /// 4. loads on the two blocks.
    pub fn press(&mut self, found: &mut Manifold<Vec<ManifoldPoint>>) {
        self.history.normal = found.normal;
        self.history.features = found.features;
        self.loads.deepest = found.depth;
        self.keep_energy(found);
        self.press_normal(found);
        self.shear(found);
        let (a, b) = self.law.bodies;
        for point in &self.history.points {
            let centroids = (&a.centroid, &b.centroid);
            self.loads.add(point, &self.history.normal, centroids);
        }
    }

    /// Scales the weights of a manifold whose features are others than before.
    fn keep_energy(&mut self, found: &mut Manifold<Vec<ManifoldPoint>>) {
        if self.former.is_empty() || self.loads.has_broken {
            self.history.stiffness_share = 1.0;
            return;
        }
        if self.history.features != self.former_features {
            let dt = self.law.dt;
            let left = feature_change::energy_left(self.history.elastic.0, &self.former(), dt);
            let springs = self.law.pressing();
            let asked = feature_change::energy_asked(&springs, &found.points, &found.normal, dt);
            let share = feature_change::share_of_new(left, asked);
            self.history.stiffness_share = share;
            self.loads.losses.damping += (left - share * asked).max(0.0);
        }
        if self.history.stiffness_share < 1.0 {
            for point in &mut found.points {
                point.weight *= self.history.stiffness_share;
            }
        }
    }

    fn press_normal(&mut self, found: &Manifold<Vec<ManifoldPoint>>) {
        let (a, b) = self.law.bodies;
        let springs = self.law.pressing();
        let dashpot = springs.dashpot(&found.points, &found.normal);
        self.loads.dashpots.0 = dashpot.per_weight;
        let meeting = (self.former.is_empty() && self.history.bond.is_none()).then(|| {
            let x = &dashpot.middle;
            let closing = (a.velocity_at(x) - b.velocity_at(x)).dot(&found.normal);
            (found.depth, closing)
        });
        let bearing = match self.history.bond {
            Some(_) => Bearing::PressureAndTension,
            None => Bearing::Pressure,
        };
        springs.press(
            &found.points,
            found.normal,
            dashpot.per_weight * dashpot_share(dashpot.rate, self.law.dt, meeting),
            bearing,
            &mut self.history.points,
        );
    }

    fn shear(&mut self, found: &Manifold<Vec<ManifoldPoint>>) {
        let sheared = Shearing {
            cohesion: if self.history.is_broken {
                self.law.joint.residual_cohesion * found.area
            } else {
                0.0
            },
            is_bonded: self.history.bond.is_some(),
            ..self.law.shearing(found, self.history.has_slipped)
        }
        .apply(&mut self.history.points, &self.history.shear);
        self.history.shear = sheared.spring;
        self.history.has_slipped |= sheared.has_slipped;
        self.shear_energy = sheared.energy;
        self.loads.dashpots.1 = sheared.damping;
    }

    /// Does the bond hold no longer, or has it slid off its patch?
    pub fn is_overloaded(&self, patch: &Patch) -> bool {
        let History {
            bond,
            points,
            normal,
            ..
        } = &*self.history;
        let outline = patch.bonded_outline();
        points.is_empty()
            || bond.is_some_and(|bond| bond.is_overloaded(self.law.joint, points, normal, outline))
    }

    /// The bond is gone: the forces are found again without it.
    pub fn break_bond(&mut self) {
        let history = &mut *self.history;
        history.bond = None;
        history.is_broken = true;
        history.has_slipped = true;
        history.shear = self.former_shear;
        history.points.clear();
        history.features = None;
        self.loads.has_broken = true;
        self.loads.on_blocks = (Load::default(), Load::default());
        self.loads.deepest = 0.0;
    }

    /// Account of the step:
    ///
    /// 1. work of its second half;
    /// 2. bodies that met or parted in it touched for a part of it only;
    /// 3. energy of the springs, and what was lost with a bond or with points that are gone;
    /// 4. a softer contact takes up what it lost.
    pub fn finish(mut self) {
        let dt = self.law.dt;
        let PairLoads {
            losses,
            half_kick_corrections,
            ..
        } = &mut *self.loads;
        let now = now(&self.law, self.history);
        now.book_half(dt, losses);
        let held = self.law.held(now.points);
        if self.former.is_empty() && self.history.bond.is_none() {
            impact::begin_contact(&now, dt, held, losses, half_kick_corrections);
        }
        self.settle(held);
        let History {
            stiffness_share,
            elastic,
            ..
        } = &mut *self.history;
        let losses = &mut self.loads.losses;
        *stiffness_share = feature_change::stiffen(*stiffness_share, &mut elastic.0, losses);
    }

    /// Books what was lost with a bond or with points that are gone; the normal springs hold some energy (J) now.
    fn settle(&mut self, held: f64) {
        let dt = self.law.dt;
        if self.history.points.is_empty() {
            self.history.shear = ShearSpring::default();
            self.shear_energy = 0.0;
        }
        let before = self.history.elastic;
        let former = self.former();
        let PairLoads {
            losses,
            half_kick_corrections,
            has_broken,
            ..
        } = &mut *self.loads;
        losses.friction += before.1 - self.shear_energy;
        if *has_broken {
            // All that the springs of the bond held and did not give to the blocks is lost with it.
            let given = now(&self.law, self.history).work_of_normal_springs(dt);
            losses.damping += feature_change::energy_left(before.0, &former, dt) - held - given;
            losses.damping += std::mem::take(&mut losses.friction);
        } else if self.history.points.is_empty() && !self.former.is_empty() {
            impact::end_contact(&former, dt, before.0, losses, half_kick_corrections);
        }
        self.history.elastic = (held, self.shear_energy);
    }
}

/// The contact as it is now.
fn now<'b>(law: &PairLaw<'b>, history: &'b History) -> Acting<'b, Vec3> {
    Acting {
        bodies: law.bodies,
        points: &history.points,
        normals: history.normal,
        ago: 0.0,
    }
}
