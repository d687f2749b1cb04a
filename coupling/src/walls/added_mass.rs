//! The kernel's added mass: how walls that continue the pressure resist the acceleration of a free block.
//!
//! The pressure in a wall falls by `L·a` where the wall accelerates, and the acceleration of a free block follows
//! from that very pressure. Taking `a` from the step before is a fixed-point iteration, `M a' = F₀ − M_k a`, which
//! grows without bound where the block is lighter than `M_k`, about half the water within one spacing of its wetted
//! faces. It is solved instead:
//!
//! ```text
//! M_k = −∂F/∂q̈,   (M + M_k) q̈ = F₀ + M q̈_dry,   q̈_dry of contacts, gravity and supports over the last step
//! ```
//! The resulting forces are recomputed from `q̈` and applied to both sides, so that a first-order `M_k`
//! conserves momentum. Deformable blocks respond as rigid ones. In a slab, which takes transverse loads,
//! there is no transverse acceleration.

use nalgebra::{Matrix3, Matrix6, Vector6};
use riprap_dda::{Blocks, Load};
use riprap_sph::Vec3;
use serde::{Deserialize, Serialize};

/// Acceleration of a block's centroid, and its angular acceleration; m/s², rad/s².
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Acceleration {
    /// m/s².
    pub linear: Vec3,
    /// rad/s².
    pub angular: Vec3,
}

impl Acceleration {
    /// Acceleration at a point relative to the centroid (m), without the part due to the current spin.
    pub fn at(&self, arm: &Vec3) -> Vec3 {
        self.linear + self.angular.cross(arm)
    }
}

/// Free blocks, and their acceleration without the fluid.
#[derive(Clone, Copy, Debug)]
pub struct Movers<'a> {
    /// The blocks.
    pub blocks: &'a Blocks,
    /// Acceleration of each block by contacts, gravity and supports, over the last step.
    pub dry: &'a [Acceleration],
    /// The one direction in which a slab repeats.
    pub slab_axis: Option<usize>,
}

/// Added mass of a block from its wall; six unknowns: translation of the centroid, then rotation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct AddedMass(Matrix6<f64>);

impl AddedMass {
    /// Adds a force that grows by `slope` times `lever·a` with the acceleration of a point; kg/m², m², and m from the
    /// centroid.
    pub(super) fn add_point(&mut self, arm: &Vec3, lever: &Vec3, slope: &Vec3) {
        let generalized = |v: &Vec3| {
            let turning = arm.cross(v);
            Vector6::new(v.x, v.y, v.z, turning.x, turning.y, turning.z)
        };
        self.0 -= generalized(slope) * generalized(lever).transpose();
    }

    /// Adds a force `−inertia a` of a point; kg, and m from the centroid.
    pub(super) fn add_inertia(&mut self, arm: &Vec3, inertia: &Matrix3<f64>) {
        let turning = -arm.cross_matrix();
        let crossed = arm.cross_matrix() * inertia;
        let mut add = |row: usize, column: usize, block: Matrix3<f64>| {
            let mut view = self.0.fixed_view_mut::<3, 3>(row, column);
            view += block;
        };
        add(0, 0, *inertia);
        add(0, 3, inertia * turning);
        add(3, 0, crossed);
        add(3, 3, crossed * turning);
    }

    /// Largest inertia added to the motion along any direction; kg.
    pub(super) fn largest(&self) -> f64 {
        let linear: Matrix3<f64> = self.0.fixed_view::<3, 3>(0, 0).into();
        (0.5 * (linear + linear.transpose()))
            .symmetric_eigenvalues()
            .max()
    }
}

impl Movers<'_> {
    /// Acceleration of a block under the fluid load at zero acceleration, with the added mass of its walls.
    pub(super) fn solve(&self, block: usize, load: &Load, added: &AddedMass) -> Acceleration {
        let dry = self.dry[block];
        let mut inertia = Matrix6::zeros();
        let mass = self.blocks.mass(block);
        inertia
            .fixed_view_mut::<3, 3>(0, 0)
            .copy_from(&(Matrix3::identity() * mass));
        inertia
            .fixed_view_mut::<3, 3>(3, 3)
            .copy_from(&self.blocks.inertia(block));
        let pushed = Vector6::new(
            load.force.x,
            load.force.y,
            load.force.z,
            load.torque.x,
            load.torque.y,
            load.torque.z,
        );
        let (a, b) = (dry.linear, dry.angular);
        let pushed = pushed + inertia * Vector6::new(a.x, a.y, a.z, b.x, b.y, b.z);
        // the integrals leave it symmetric to first order only
        let added = (added.0 + added.0.transpose()) * 0.5;
        let free = self.freedom(block);
        // held degrees of freedom keep their own inertia, without load
        let held = Matrix6::identity() - free;
        let whole = free * (inertia + added) * free + held * inertia * held;
        let solution = whole.lu().solve(&(free * pushed));
        solution.map_or(dry, |q| Acceleration {
            linear: Vec3::new(q[0], q[1], q[2]),
            angular: Vec3::new(q[3], q[4], q[5]),
        })
    }

    /// Projection on the free degrees of freedom of a block.
    fn freedom(&self, block: usize) -> Matrix6<f64> {
        let [mut linear, mut turning] = self.blocks.freedom(block);
        if let Some(axis) = self.slab_axis {
            let mut across = Matrix3::zeros();
            across[(axis, axis)] = 1.0;
            let within = Matrix3::identity() - across;
            linear = within * linear * within;
            turning = across * turning * across;
        }
        let mut free = Matrix6::zeros();
        free.fixed_view_mut::<3, 3>(0, 0).copy_from(&linear);
        free.fixed_view_mut::<3, 3>(3, 3).copy_from(&turning);
        free
    }
}

/// Largest ratio of the inertia that its wall adds to a block that forces move to its own mass.
pub(super) fn largest_ratio(added: &[AddedMass], blocks: &Blocks) -> f64 {
    added
        .iter()
        .enumerate()
        .filter(|(b, _)| blocks.is_free(*b))
        .map(|(b, added)| added.largest() / blocks.mass(b))
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    #![expect(
        clippy::unwrap_used,
        reason = "a test stops at the first thing that is wrong"
    )]

    use riprap_sph::Vec3;

    use super::{Acceleration, Movers};
    use crate::run::world_of;
    use crate::walls::Walls;
    use crate::world::World;

    /// A box of six spacings, far lighter than the water that it is under, in a basin or a slice of one.
    fn light_box(walls: &str, slice: Option<&str>) -> World {
        let (domain, body) = match slice {
            Some(_) => ((0.0, 0.4), (0.0, 0.4)),
            None => ((-0.4, 2.0), (0.5, 1.1)),
        };
        let cuboid = |name: &str, motion: &str, [x0, y0, z0, x1, y1, z1]: [f64; 6]| {
            format!(
                "(name: \"{name}\", material: \"m\", motion: {motion}, \
                 shape: Box(min: ({x0:?}, {y0:?}, {z0:?}), max: ({x1:?}, {y1:?}, {z1:?}))),"
            )
        };
        let mut blocks = vec![
            cuboid("body", "Free", [0.7, body.0, 0.5, 1.3, body.1, 1.1]),
            cuboid("floor", "Fixed", [-0.4, -1.0, -0.4, 2.4, 3.0, 0.0]),
            cuboid("left", "Fixed", [-0.4, -1.0, 0.0, 0.0, 3.0, 2.0]),
            cuboid("right", "Fixed", [2.0, -1.0, 0.0, 2.4, 3.0, 2.0]),
        ];
        if slice.is_none() {
            blocks.push(cuboid("front", "Fixed", [0.0, -1.0, 0.0, 2.0, 0.0, 2.0]));
            blocks.push(cuboid("back", "Fixed", [0.0, 1.6, 0.0, 2.0, 3.0, 2.0]));
        }
        let text = format!(
            "(title: \"light\", domain: (min: (-0.4, {:?}, -0.4), max: (2.4, {:?}, 2.0), {}),\n\
             materials: [(name: \"m\", density: 30, friction_angle_deg: 0)], blocks: [{}],\n\
             fluid: (resolution: Spacing(0.1), \
             regions: [(name: \"water\", shape: Below(level: 1.6, seed: (0.3, 0.2, 0.2)))]),\n\
             interface: (walls: {walls}), time: (duration: 1))",
            domain.0,
            domain.1,
            slice.unwrap_or_default(),
            blocks.concat(),
        );
        world_of(&text)
    }

    /// The acceleration of the body that follows from walls that take it to be `assumed`.
    fn answer(world: &mut World, body: usize, assumed: Acceleration) -> Vec3 {
        let blocks = &world.blocks;
        let water = world.water.as_mut().unwrap();
        let movers = Movers {
            blocks,
            dry: &world.bodies.dry,
            slab_axis: water.interface.slab_axis(),
        };
        let walls = water.walls.as_mut().unwrap();
        walls.place_at_end(blocks, Some(0.0));
        walls.find(&mut water.fluid);
        match walls {
            Walls::Particles(walls) => {
                // only then walls keep what a second acceleration needs
                walls.extrapolate(&water.fluid, Some(movers));
                walls.accelerate_all(&water.fluid, blocks, &assumed);
            }
            Walls::Integral(walls) => walls.accelerate_all(&water.fluid, blocks, &assumed),
        }
        let force = walls.loads()[body].total().force;
        force / blocks.mass(body) + Vec3::new(0.0, 0.0, -9.81)
    }

    /// C09: with a kernel's mass far above the block's own the acceleration of the step before makes the next one
    /// worse each time; that which is solved for follows from itself.
    fn lagging_grows_and_solving_does_not(walls: &str, slice: Option<&str>) {
        let mut world = light_box(walls, slice);
        let body = 0;
        let water = world.water.as_mut().unwrap();
        let movers = Movers {
            blocks: &world.blocks,
            dry: &world.bodies.dry,
            slab_axis: water.interface.slab_axis(),
        };
        let found = {
            let walls = water.walls.as_mut().unwrap();
            walls.place_at_end(&world.blocks, Some(0.0));
            walls.find(&mut water.fluid);
            walls.extrapolate(&water.fluid, Some(movers));
            walls.solve_added_mass(&water.fluid, movers);
            walls.acceleration(body)
        };
        let ratio = water
            .walls
            .as_ref()
            .unwrap()
            .largest_added_mass_ratio(&world.blocks);
        assert!(4.0 < ratio && ratio < 12.0, "{walls}: M_k/M is {ratio}");

        let follows = answer(&mut world, body, found);
        // M_k is of first order: pairs of unequal density, points that lose all pressure
        let off = (follows - found.linear).norm() / (ratio * found.linear.norm());
        assert!(off < 0.02, "{walls}: {off}");

        let mut lagged = Acceleration::default();
        let mut sizes = Vec::new();
        for _ in 0..4 {
            lagged.linear = answer(&mut world, body, lagged);
            sizes.push((lagged.linear - found.linear).norm());
        }
        for pair in sizes.windows(2) {
            // walls that do not pull lose some of it once pressures fall to zero
            assert!(2.0 < pair[1] / pair[0], "{walls}: {sizes:?}");
        }
    }

    #[test]
    fn light_block_between_particles() {
        lagging_grows_and_solving_does_not("Particles", Some("dimensions: Two"));
    }

    #[test]
    fn light_block_between_particles_in_space() {
        lagging_grows_and_solving_does_not("Particles", Some("periodic: [Y]"));
    }

    #[test]
    fn light_block_of_integrals() {
        lagging_grows_and_solving_does_not("Integral", None);
    }
}
