//! Queries of the blocks; read-only.

use crate::geometry::parts::Part;
use crate::material::{Joint, SphereJoint};
use crate::motion::deformation::{axial, voigt};
use crate::motion::holds::Hold;
use crate::{
    Blocks, Contact, Energies, Isometry, Load, Motion, Settings, SurfacePoint, Vec3, Voigt,
};
use nalgebra::{Matrix3, UnitQuaternion};

impl Blocks {
    // Counts.

    /// Number of blocks, removed ones included.
    pub fn n_blocks(&self) -> usize {
        self.state.centroid.len()
    }

    /// Number of blocks that forces move.
    pub fn n_free(&self) -> usize {
        (0..self.n_blocks()).filter(|&b| self.is_free(b)).count()
    }

    /// Number of blocks that never move.
    pub fn n_fixed(&self) -> usize {
        self.count(|motion| matches!(motion, Motion::Fixed))
    }

    /// Number of blocks that follow a path.
    pub fn n_prescribed(&self) -> usize {
        self.count(|motion| matches!(motion, Motion::Prescribed(_)))
    }

    fn count(&self, is_wanted: impl Fn(&Motion) -> bool) -> usize {
        (0..self.n_blocks())
            .filter(|&b| !self.state.is_removed[b] && is_wanted(&self.constants.motion[b]))
            .count()
    }

    /// Number of blocks taken out with [`remove`](Self::remove).
    pub fn n_removed(&self) -> usize {
        self.state
            .is_removed
            .iter()
            .filter(|&&is_removed| is_removed)
            .count()
    }

    /// Number of convex parts.
    pub fn n_parts(&self) -> usize {
        self.derived.parts.len()
    }

    /// The block that a part belongs to.
    pub fn block_of_part(&self, part: usize) -> usize {
        self.constants.block_of_part[part] as usize
    }

    /// The parts of a block.
    pub fn parts_of(&self, b: usize) -> std::ops::Range<usize> {
        self.constants.part_start[b] as usize..self.constants.part_start[b + 1] as usize
    }

    // One block.

    /// Motion.
    pub fn motion(&self, b: usize) -> &Motion {
        &self.constants.motion[b]
    }

    /// Do forces move it?
    pub fn is_free(&self, b: usize) -> bool {
        matches!(self.constants.motion[b], Motion::Free) && !self.state.is_removed[b]
    }

    /// Has it been taken out?
    pub fn is_removed(&self, b: usize) -> bool {
        self.state.is_removed[b]
    }

    /// Centroid, world; m.
    pub fn centroid(&self, b: usize) -> Vec3 {
        self.state.centroid[b]
    }

    /// Rotation since the initial placement.
    pub fn orientation(&self, b: usize) -> UnitQuaternion<f64> {
        self.state.attitude[b] * self.constants.principal[b].inverse()
    }

    /// World from the axes of the start: rotation, with the deformation gradient of a block that deforms.
    pub fn gradient(&self, b: usize) -> Matrix3<f64> {
        self.placement_gradient(b)
    }

    /// Projections of the velocity of the centroid and of the rotation of a free block on the free directions of its
    /// hold; identities without one.
    pub fn freedom(&self, b: usize) -> [Matrix3<f64>; 2] {
        let free = Matrix3::identity();
        self.hold_of(b).map_or([free; 2], Hold::freedom)
    }

    /// Present from initial placement.
    pub fn pose(&self, b: usize) -> Isometry {
        let turn = self.orientation(b);
        let shift = self.state.centroid[b] - turn * self.constants.initial_centroid[b];
        Isometry::from_parts(shift.into(), turn)
    }

    /// Velocity of the centroid; m/s.
    pub fn velocity(&self, b: usize) -> Vec3 {
        self.state.velocity[b]
    }

    /// Angular velocity, world; rad/s.
    pub fn angular_velocity(&self, b: usize) -> Vec3 {
        match self.constants.deformable_of[b] {
            None => {
                self.state.attitude[b]
                    * self.state.angular_momentum[b].component_div(&self.constants.inertia[b])
            }
            Some(k) => axial(
                &self.state.deformables[k as usize]
                    .body()
                    .velocity_gradient(),
            ),
        }
    }

    /// Does it deform?
    pub fn is_deformable(&self, b: usize) -> bool {
        self.constants.deformable_of[b].is_some()
    }

    /// Mean Cauchy stress in a deformable block, tension positive; `None` for a rigid one; Pa.
    pub fn stress(&self, b: usize) -> Option<Voigt> {
        self.constants.deformable_of[b].map(|k| voigt(&self.state.deformables[k as usize].stress()))
    }

    /// Green's strain of a deformable block, in the initial axes; `None` for a rigid one; –.
    pub fn strain(&self, b: usize) -> Option<Voigt> {
        self.constants.deformable_of[b].map(|k| voigt(&self.state.deformables[k as usize].strain()))
    }

    /// Volume over initial volume: 1 for a rigid block; –.
    pub fn volume_ratio(&self, b: usize) -> f64 {
        self.constants.deformable_of[b].map_or(1.0, |k| {
            self.state.deformables[k as usize]
                .body()
                .gradient
                .determinant()
        })
    }

    /// Tension and yielded length of each rock bolt, in the order they were attached; N, m.
    pub fn bolts(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.state.attachments.bolts()
    }

    /// Kinetic energy of a free block, without mass scaling; J.
    pub fn kinetic_energy(&self, b: usize) -> f64 {
        let p = self.state.angular_momentum[b];
        0.5 * self.constants.mass[b] * self.state.velocity[b].norm_squared()
            + match self.constants.deformable_of[b] {
                None => 0.5 * p.dot(&p.component_div(&self.constants.inertia[b])),
                Some(k) => self.state.deformables[k as usize].kinetic_energy(),
            }
    }

    /// Angular momentum about the centroid, world; N m s.
    pub fn spin_momentum(&self, b: usize) -> Vec3 {
        self.state.attitude[b] * self.state.angular_momentum[b]
    }

    /// Mass; kg.
    pub fn mass(&self, b: usize) -> f64 {
        self.constants.mass[b]
    }

    /// Volume; m³.
    pub fn volume(&self, b: usize) -> f64 {
        self.constants.volume[b]
    }

    /// Inertia tensor about the centroid, world; kg m².
    pub fn inertia(&self, b: usize) -> Matrix3<f64> {
        let turn = self.state.attitude[b].to_rotation_matrix();
        turn.matrix()
            * Matrix3::from_diagonal(&self.constants.inertia[b])
            * turn.matrix().transpose()
    }

    /// Farthest point of the block from its centroid; m.
    pub fn radius(&self, b: usize) -> f64 {
        self.constants.radius[b]
    }

    /// Velocity of the block's material at a world point; m/s.
    pub fn velocity_at(&self, b: usize, point: &Vec3) -> Vec3 {
        self.state.kinematics[b].velocity_at(point)
    }

    /// Gradient of the velocity in the block: `ω×` of a rigid one; 1/s.
    pub fn velocity_gradient(&self, b: usize) -> Matrix3<f64> {
        match self.constants.deformable_of[b] {
            None => self.angular_velocity(b).cross_matrix(),
            Some(k) => self.state.deformables[k as usize]
                .body()
                .velocity_gradient(),
        }
    }

    /// `n·M⁻¹n` at a world point, rotation included: the acceleration along the unit vector `n`
    /// under a unit force along it; 0 for fixed and prescribed blocks; 1/kg.
    pub fn compliance(&self, b: usize, point: &Vec3, n: &Vec3) -> f64 {
        self.state.kinematics[b].compliance(point, n)
    }

    /// Contact forces on a block at the end of the last step.
    pub fn contact_force(&self, b: usize) -> Load {
        self.state.contact_load[b]
    }

    /// Corners and faces at the current position, for output; faces counter-clockwise from outside. A
    /// sphere becomes a grid of 16 × 8 facets.
    pub fn world_polygons(&self, b: usize) -> (Vec<Vec3>, Vec<Vec<u32>>) {
        let (mut vertices, mut faces) = (Vec::new(), Vec::new());
        for part in self.parts_of(b) {
            match &self.derived.parts[part] {
                Part::Polyhedron(body) => {
                    let first = vertices.len() as u32;
                    vertices.extend_from_slice(body.vertices());
                    faces.extend(
                        (0..body.n_faces())
                            .map(|f| body.face_vertices(f).map(|v| first + v).collect::<Vec<_>>()),
                    );
                }
                Part::Sphere { center, radius } => {
                    let turn = self.orientation(b);
                    push_ball(&mut vertices, &mut faces, |unit| {
                        center + turn * unit * *radius
                    });
                }
                Part::Surface(surface) => {
                    let first = vertices.len() as u32;
                    vertices.extend_from_slice(surface.vertices());
                    let corners = |t: &[u32; 3]| t.iter().map(|v| first + v).collect::<Vec<_>>();
                    faces.extend(surface.triangles().iter().map(corners));
                }
            }
        }
        (vertices, faces)
    }

    // One part.

    /// Whether a part is a surface of triangles, whose interior is defined to a given depth only.
    pub fn is_surface(&self, part: usize) -> bool {
        matches!(self.derived.parts[part], Part::Surface(_))
    }

    /// Corners of a part at its current position, for output; of a sphere, points all over it.
    pub fn part_points(&self, part: usize) -> Vec<Vec3> {
        match &self.derived.parts[part] {
            Part::Polyhedron(body) => body.vertices().to_vec(),
            Part::Surface(surface) => surface.vertices().to_vec(),
            Part::Sphere { center, radius } => {
                let (mut vertices, mut faces) = (Vec::new(), Vec::new());
                push_ball(&mut vertices, &mut faces, |unit| center + unit * *radius);
                vertices
            }
        }
    }

    /// Box around a part, world; m. Lower above upper if its block was removed.
    pub fn part_aabb(&self, part: usize) -> (Vec3, Vec3) {
        self.state.boxes[part]
    }

    /// Closest point of a part's surface at its current position, or `None` if it is farther outside
    /// than `cutoff` (m) or its block was removed. See [`Polyhedron::surface_point_within`].
    ///
    /// [`Polyhedron::surface_point_within`]: crate::Polyhedron::surface_point_within
    pub fn surface_point_within(&self, part: usize, x: &Vec3, cutoff: f64) -> Option<SurfacePoint> {
        if self.state.is_removed[self.constants.block_of_part[part] as usize] {
            return None;
        }
        self.derived.parts[part].surface_point_within(x, cutoff)
    }

    /// Exits from a part for a point inside: the foot on the plane of each face, nearest first. The first is
    /// [`Self::surface_point_within`]; a sphere or a surface has no other, and a point outside has none.
    pub fn ways_out(&self, part: usize, x: &Vec3) -> Vec<SurfacePoint> {
        // behind triangles the search is limited in distance, in a polyhedron it is not
        let farthest = if self.is_surface(part) {
            f64::INFINITY
        } else {
            0.0
        };
        let Some(nearest) = self
            .surface_point_within(part, x, farthest)
            .filter(|surface| surface.distance < 0.0)
        else {
            return Vec::new();
        };
        let Part::Polyhedron(body) = &self.derived.parts[part] else {
            return vec![nearest];
        };
        let mut ways: Vec<SurfacePoint> = (0..body.n_faces())
            .map(|face| {
                let (normal, distance) = (body.face_normal(face), body.plane_distance(face, x));
                SurfacePoint {
                    distance,
                    normal,
                    point: x - normal * distance,
                }
            })
            .collect();
        ways.sort_by(|a, b| b.distance.total_cmp(&a.distance));
        ways
    }

    /// Outward normals of the faces of a part whose planes are within a distance (m) of a point, with its height above
    /// each (m), negative inside. For a sphere or a surface of triangles the one at the nearest point.
    pub fn planes_within(&self, part: usize, x: &Vec3, distance: f64) -> Vec<(Vec3, f64)> {
        match &self.derived.parts[part] {
            Part::Polyhedron(body) => (0..body.n_faces())
                .map(|face| (body.face_normal(face), body.plane_distance(face, x)))
                .filter(|(_, height)| height.abs() < distance)
                .collect(),
            Part::Sphere { .. } | Part::Surface(_) => {
                let nearest = self.surface_point_within(part, x, distance);
                nearest
                    .map(|at| (at.normal, at.distance))
                    .into_iter()
                    .collect()
            }
        }
    }

    // Sums and records.

    /// Contact points of the last step, sorted by parts; those of spheres after the others,
    /// those on surfaces last, the surface second.
    pub fn contacts(&self) -> Vec<Contact> {
        let blocks = |pair: (u32, u32)| (pair.0 as usize, pair.1 as usize);
        let of_pairs = self.contacts.pairs.iter().flat_map(|pair| {
            pair.points.iter().map(move |point| Contact {
                blocks: blocks(pair.blocks),
                parts: blocks(pair.parts),
                key: point.patch.key,
                point: point.patch.position,
                normal: pair.normal,
                normal_force: point.normal_force,
                shear_force: point.shear_force,
                overlap: point.patch.overlap,
                state: point.state,
            })
        });
        let of_spheres = self.touching_spheres().map(|k| {
            let (pair, loads) = (
                &self.contacts.sphere_pairs[k],
                &self.contacts.sphere_loads[k],
            );
            let contact = &self.contacts.sphere_contacts[k];
            Contact {
                blocks: blocks(pair.blocks),
                parts: blocks(pair.parts),
                key: 0,
                point: loads.point,
                normal: contact.normal,
                normal_force: contact.normal_force,
                shear_force: loads.force - contact.normal * contact.normal_force,
                overlap: contact.overlap,
                state: contact.state(),
            }
        });
        let mut contacts: Vec<Contact> = of_pairs.chain(of_spheres).collect();
        for pair in &self.contacts.surface_pairs {
            pair.for_each_contact(&mut |contact| contacts.push(contact));
        }
        contacts
    }

    /// Number of contact points of the last step, without making their list.
    pub fn n_contacts(&self) -> usize {
        let of_pairs: usize = self
            .contacts
            .pairs
            .iter()
            .map(|pair| pair.points.len())
            .sum();
        let of_surfaces = self
            .contacts
            .surface_pairs
            .iter()
            .map(|pair| pair.n_contacts());
        of_pairs + self.touching_spheres().count() + of_surfaces.sum::<usize>()
    }

    /// Force evaluations of pairs of parts so far.
    pub fn contact_updates(&self) -> u64 {
        self.state.totals.n_contact_updates
    }

    /// Full separating-axis tests so far: the rest of the contact updates went on with the common plane of
    /// the step before.
    pub fn axis_searches(&self) -> u64 {
        self.state.totals.n_axis_searches
    }

    /// Bonds broken so far.
    pub fn broken_bonds(&self) -> u64 {
        self.state.totals.n_broken_bonds
    }

    /// Deepest overlap so far, × size of the smaller part (cube root of its volume).
    pub fn max_overlap_over_size(&self) -> f64 {
        self.state.totals.max_overlap_over_size
    }

    /// Energies and works; J.
    pub fn energies(&self) -> Energies {
        let mut energies = Energies {
            elastic: self
                .contacts
                .pairs
                .iter()
                .map(|pair| pair.elastic.0 + pair.elastic.1)
                .sum::<f64>()
                + self.sphere_energy()
                + self.surface_energy()
                + self.state.attachments.elastic,
            strain_damping: self.state.totals.strain_damping.total(),
            static_damping: self.state.totals.static_damping.total(),
            laid_to_rest: self.state.totals.laid_to_rest.total(),
            plastic: self.state.attachments.plastic.total(),
            friction: self.state.totals.friction.total(),
            damping: self.state.totals.damping.total(),
            external_work: self.state.totals.external_work.total()
                + self.state.attachments.work.total(),
            ..Energies::default()
        };
        for b in (0..self.n_blocks()).filter(|&b| self.is_free(b)) {
            energies.kinetic += self.kinetic_energy(b);
            energies.potential -= self.constants.mass[b]
                * self.constants.settings.gravity.dot(&self.state.centroid[b]);
        }
        for deformable in &self.state.deformables {
            let added = deformable.body().added_kinetic_energy();
            energies.kinetic += added;
            energies.added_kinetic += added;
            energies.strain += deformable.strain_energy();
        }
        energies
    }

    fn sphere_energy(&self) -> f64 {
        self.touching_spheres()
            .map(|k| {
                let joint = self.sphere_joint(self.contacts.sphere_pairs[k].parts);
                self.contacts.sphere_contacts[k].energy(joint, self.contacts.sphere_rolling.get(k))
            })
            .sum()
    }

    /// Indices in the list of pairs with a sphere.
    pub(crate) fn touching_spheres(&self) -> impl Iterator<Item = usize> + '_ {
        let marks = self.contacts.sphere_marks.iter().enumerate();
        marks.filter(|(_, mark)| mark.is_touching).map(|(k, _)| k)
    }

    fn surface_energy(&self) -> f64 {
        self.contacts
            .surface_pairs
            .iter()
            .map(|pair| {
                let radius = self.constants.radius[pair.blocks.0 as usize];
                pair.energy(self.sphere_joint(pair.parts), radius)
            })
            .sum()
    }

    pub(crate) fn joint_between(&self, parts: (u32, u32)) -> &Joint {
        let material = |part: u32| self.constants.material_of_part[part as usize] as usize;
        &self.state.joints[material(parts.0) * self.constants.n_materials + material(parts.1)]
    }

    fn sphere_joint(&self, parts: (u32, u32)) -> &SphereJoint {
        &self.joint_between(parts).spheres
    }

    /// Momentum of the free blocks; N s.
    pub fn momentum(&self) -> Vec3 {
        (0..self.n_blocks())
            .filter(|&b| self.is_free(b))
            .map(|b| self.state.velocity[b] * self.constants.mass[b])
            .sum()
    }

    /// Impulse that gravity, fixed and prescribed blocks, loads, holds and damping for statics gave to
    /// free blocks so far; N s.
    pub fn support_impulse(&self) -> Vec3 {
        self.state.totals.support_impulse
    }

    /// Sum of the magnitudes of the impulses of gravity and of the supports, the scale of a momentum
    /// residual; N s.
    pub fn impulse_exchanged(&self) -> f64 {
        self.state.totals.impulse_exchanged
    }

    /// Angular impulse by [`RollingLaw::OwnSpin`](crate::RollingLaw::OwnSpin) on spheres so far, without reaction on another
    /// body: the defect of the angular momentum balance; zero with the other law; N m s.
    pub fn rolling_impulse(&self) -> Vec3 {
        self.state.totals.rolling_impulse
    }

    /// Numbers of the solver.
    pub fn settings(&self) -> &Settings {
        &self.constants.settings
    }

    /// Visits every number of the state in a fixed order: the content of a restart and of the state
    /// hash.
    pub fn for_each_state_f64(&self, f: &mut dyn FnMut(f64)) {
        for b in 0..self.n_blocks() {
            self.state.centroid[b].iter().for_each(|&c| f(c));
            self.state.velocity[b].iter().for_each(|&c| f(c));
            self.state.attitude[b].coords.iter().for_each(|&c| f(c));
            self.state.angular_momentum[b].iter().for_each(|&c| f(c));
            f(f64::from(u8::from(self.state.is_removed[b])));
        }
        for pair in &self.contacts.pairs {
            f(f64::from(pair.parts.0));
            f(f64::from(pair.parts.1));
            f(pair.elastic.0);
            f(pair.elastic.1);
            pair.shear.shift.iter().for_each(|&c| f(c));
            pair.shear.center.iter().for_each(|&c| f(c));
            f(pair.shear.twist);
            f(pair.shear.weight);
            f(f64::from(u8::from(pair.has_slipped)));
            f(pair.bond.map_or(-1.0, |bond| bond.area));
            f(f64::from(u8::from(pair.is_broken)));
            f(pair.stiffness_share);
            if let Some(axis) = pair.axis.axis {
                axis.normal.iter().for_each(|&c| f(c));
                f(axis.gap);
            }
            f(pair.axis.verified_gap);
            f(f64::from(pair.axis.trust));
            f(f64::from(pair.axis.trusted));
            for point in &pair.points {
                f(f64::from(point.patch.key));
                f(point.normal_force);
                f(point.normal_viscous);
                point.shear_force.iter().for_each(|&c| f(c));
                point.shear_viscous.iter().for_each(|&c| f(c));
            }
        }
        for (k, pair) in self.contacts.sphere_pairs.iter().enumerate() {
            let contact = &self.contacts.sphere_contacts[k];
            f(f64::from(pair.parts.0));
            f(f64::from(pair.parts.1));
            f(f64::from(u8::from(contact.is_slipping)));
            self.contacts.sphere_loads[k]
                .force
                .iter()
                .for_each(|&c| f(c));
            contact.shear.iter().for_each(|&c| f(c));
            f(contact.normal_force);
            if let Some(rolling) = self.contacts.sphere_rolling.get(k) {
                rolling.for_each_state_f64(f);
            }
        }
        for pair in &self.contacts.surface_pairs {
            f(f64::from(pair.parts.0));
            f(f64::from(pair.parts.1));
            pair.for_each_state_f64(f);
        }
        for deformable in &self.state.deformables {
            deformable.for_each_state_f64(f);
        }
        self.state.attachments.for_each_state_f64(f);
        f(self.state.totals.strain_damping.total());
        f(self.state.totals.static_damping.total());
        f(self.state.totals.friction.total());
        f(self.state.totals.damping.total());
        f(self.state.totals.external_work.total());
        self.state.totals.support_impulse.iter().for_each(|&c| f(c));
        self.state.totals.rolling_impulse.iter().for_each(|&c| f(c));
        f(self.state.totals.impulse_exchanged);
        f(self.state.totals.max_overlap_over_size);
    }
}

/// Corners and facets of a sphere, `place` takes unit vectors to the surface.
fn push_ball(vertices: &mut Vec<Vec3>, faces: &mut Vec<Vec<u32>>, place: impl Fn(Vec3) -> Vec3) {
    const AROUND: u32 = 16;
    const ALONG: u32 = 8;
    let south = vertices.len() as u32;
    vertices.push(place(-Vec3::z()));
    for ring in 1..ALONG {
        let (sin, cos) = (std::f64::consts::PI * f64::from(ring) / f64::from(ALONG)).sin_cos();
        for k in 0..AROUND {
            let (y, x) = (std::f64::consts::TAU * f64::from(k) / f64::from(AROUND)).sin_cos();
            vertices.push(place(Vec3::new(sin * x, sin * y, -cos)));
        }
    }
    let north = vertices.len() as u32;
    vertices.push(place(Vec3::z()));
    let at = |ring: u32, k: u32| south + 1 + (ring - 1) * AROUND + k % AROUND;
    for k in 0..AROUND {
        faces.push(vec![south, at(1, k + 1), at(1, k)]);
        faces.push(vec![north, at(ALONG - 1, k), at(ALONG - 1, k + 1)]);
        for ring in 1..ALONG - 1 {
            faces.push(vec![
                at(ring, k),
                at(ring, k + 1),
                at(ring + 1, k + 1),
                at(ring + 1, k),
            ]);
        }
    }
}
