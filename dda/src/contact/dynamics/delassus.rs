//! The Delassus operator `W = H M⁻¹ Hᵀ`, from impulses to velocities: of bodies, without a matrix, or of a matrix in blocks.

use super::ROWS_AT_A_TIME;
use super::bodies::{Bodies, BodyVelocities, Point, first_moment};
use crate::{Vec3, chunks};
use nalgebra::Matrix3;

/// Bodies that one thread takes at a time.
const BODIES_AT_A_TIME: usize = 64;

/// From impulses at contacts to velocities there, in local frames (n, t1, t2).
pub trait Delassus: Sync {
    /// Velocities that impulses give, as they are summed: of bodies, or of contacts.
    type Velocities: Clone + Send + Sync;

    /// Number of contacts.
    fn n_contacts(&self) -> usize;

    /// `W_aa`; 1/kg.
    fn diagonal(&self, a: usize) -> &Matrix3<f64>;

    /// Velocities without impulses.
    fn at_rest(&self) -> Self::Velocities;

    /// `(W R)_a` of the impulses summed; m/s.
    fn velocity(&self, velocities: &Self::Velocities, a: usize) -> Vec3;

    /// Adds an impulse (N s) at a contact.
    fn add(&self, velocities: &mut Self::Velocities, a: usize, impulse: &Vec3);

    /// Contacts in colors: those of a color do not act on each other directly. Greedy, in the order of the contacts.
    fn colors(&self) -> Vec<Vec<u32>>;

    /// Velocities of all impulses (N s).
    fn product(&self, impulses: &[Vec3]) -> Self::Velocities {
        let mut velocities = self.at_rest();
        for (a, impulse) in impulses.iter().enumerate() {
            self.add(&mut velocities, a, impulse);
        }
        velocities
    }
}

/// Sorts contacts into the first color that none of their partners has.
fn greedy(n: usize, mut color_of: impl FnMut(usize) -> u32) -> Vec<Vec<u32>> {
    let mut colors: Vec<Vec<u32>> = Vec::new();
    for a in 0..n {
        let color = color_of(a) as usize;
        if colors.len() <= color {
            colors.resize(color + 1, Vec::new());
        }
        colors[color].push(a as u32);
    }
    colors
}

/// First bit that is not set.
fn first_free(taken: &[u64]) -> u32 {
    let word = taken.iter().position(|&word| word != u64::MAX);
    let word = word.unwrap_or(taken.len());
    64 * word as u32 + taken.get(word).map_or(0, |bits| bits.trailing_ones())
}

fn mark(taken: &mut Vec<u64>, color: u32) {
    let word = color as usize / 64;
    if taken.len() <= word {
        taken.resize(word + 1, 0);
    }
    taken[word] |= 1 << (color % 64);
}

/// Contacts of rigid bodies, and of bodies that strain.
///
/// ```text
/// W_aa = Σ_bodies Nᵀ (1/m P − [r]× J⁻¹ [r]×) N,   or Nᵀ (1/m P + r·M⁻¹·r) N               [1/kg]
/// ```
#[derive(Clone, Debug, Default)]
pub struct BodyContacts {
    bodies: Bodies,
    points: Vec<Point>,
    diagonal: Vec<Matrix3<f64>>,
    /// Where there are many points.
    of_bodies: Option<PointsOfBodies>,
}

/// Points of each body, in their order.
#[derive(Clone, Debug)]
struct PointsOfBodies {
    /// First of each body, and the number of all.
    first: Vec<u32>,
    sides: Vec<Side>,
}

/// A point as one of its bodies has it.
#[derive(Clone, Copy, Debug, Default)]
struct Side {
    point: u32,
    /// Whether the body is B.
    is_b: bool,
    is_torque: bool,
    /// From the centroid; m.
    arm: Vec3,
}

impl Side {
    /// Impulse and moment on the body by an impulse on B.
    fn load(&self, on_b: &Vec3) -> [Vec3; 2] {
        let on_body = if self.is_b { *on_b } else { -on_b };
        match self.is_torque {
            true => [Vec3::zeros(), on_body],
            false => [on_body, self.arm.cross(&on_body)],
        }
    }

    /// First moment `Σ f ⊗ r` on the body by an impulse on B.
    fn first_moment(&self, on_b: &Vec3) -> Matrix3<f64> {
        let on_body = if self.is_b { *on_b } else { -on_b };
        first_moment(&on_body, &self.arm, self.is_torque)
    }
}

impl PointsOfBodies {
    fn new(n_bodies: usize, points: &[Point]) -> Self {
        let mut first = vec![0_u32; n_bodies + 1];
        for (body, _) in points.iter().flat_map(|point| point.arms).flatten() {
            first[body as usize + 1] += 1;
        }
        for body in 0..n_bodies {
            first[body + 1] += first[body];
        }
        let mut next = first.clone();
        let mut sides = vec![Side::default(); first[n_bodies] as usize];
        for (number, point) in (0..).zip(points) {
            for (arm, is_b) in point.arms.into_iter().zip([false, true]) {
                if let Some((body, arm)) = arm {
                    let next = &mut next[body as usize];
                    sides[*next as usize] = Side {
                        point: number,
                        is_b,
                        is_torque: point.is_torque,
                        arm,
                    };
                    *next += 1;
                }
            }
        }
        Self { first, sides }
    }

    fn of(&self, body: usize) -> &[Side] {
        &self.sides[self.first[body] as usize..self.first[body + 1] as usize]
    }
}

impl BodyContacts {
    /// Points between bodies; those of `points` are numbers in `bodies`.
    pub fn new(bodies: impl Into<Bodies>, points: Vec<Point>) -> Self {
        let bodies = bodies.into();
        let block = |point: &Point| {
            let sum: Matrix3<f64> = (point.arms.iter().flatten())
                .map(|(body, arm)| bodies.compliance(*body, arm, point.is_torque))
                .sum();
            point.frame.tr_mul(&(sum * point.frame))
        };
        let diagonal = points.iter().map(block).collect();
        let is_large = ROWS_AT_A_TIME < points.len();
        Self {
            of_bodies: is_large.then(|| PointsOfBodies::new(bodies.rigid.len(), &points)),
            bodies,
            points,
            diagonal,
        }
    }

    /// Velocity of B seen from A at each point, from velocity and spin of every body without strain (m/s, rad/s); m/s.
    pub fn relative_velocities(&self, of_bodies: &[[Vec3; 2]]) -> Vec<Vec3> {
        let of = |point: &Point| point.relative(of_bodies);
        self.points.iter().map(of).collect()
    }
}

impl Delassus for BodyContacts {
    /// Of the bodies.
    type Velocities = BodyVelocities;

    fn n_contacts(&self) -> usize {
        self.points.len()
    }

    fn diagonal(&self, a: usize) -> &Matrix3<f64> {
        &self.diagonal[a]
    }

    fn at_rest(&self) -> Self::Velocities {
        self.bodies.at_rest()
    }

    #[inline]
    fn velocity(&self, velocities: &Self::Velocities, a: usize) -> Vec3 {
        self.bodies.relative(&self.points[a], velocities)
    }

    fn add(&self, velocities: &mut Self::Velocities, a: usize, impulse: &Vec3) {
        let Point {
            frame,
            arms,
            is_torque,
        } = &self.points[a];
        let on_b = frame * impulse;
        for (arm, impulse) in arms.iter().zip([-on_b, on_b]) {
            if let Some((body, arm)) = arm {
                if let Some(k) = self.bodies.straining_number(*body) {
                    let push = (&impulse, arm, *is_torque);
                    self.bodies.push_straining((*body, k), velocities, push);
                    continue;
                }
                let (impulse, moment) = match is_torque {
                    true => (Vec3::zeros(), impulse),
                    false => (impulse, arm.cross(&impulse)),
                };
                let given = self.bodies.rigid[*body as usize].kicked(&impulse, &moment);
                let [velocity, spin] = &mut velocities.rigid[*body as usize];
                *velocity += given[0];
                *spin += given[1];
            }
        }
    }

    /// By bodies where there are many points, each with its own in their order.
    fn product(&self, impulses: &[Vec3]) -> Self::Velocities {
        let mut velocities = self.at_rest();
        let Some(of_bodies) = &self.of_bodies else {
            for (a, impulse) in impulses.iter().enumerate() {
                self.add(&mut velocities, a, impulse);
            }
            return velocities;
        };
        let mut on_b = vec![Vec3::zeros(); impulses.len()];
        let turn = |_, (on_b, points, impulses): (&mut [Vec3], &[Point], &[Vec3])| {
            for ((on_b, point), impulse) in on_b.iter_mut().zip(points).zip(impulses) {
                *on_b = point.frame * impulse;
            }
        };
        let rows = (on_b.as_mut_slice(), self.points.as_slice(), impulses);
        chunks::for_each(rows, ROWS_AT_A_TIME, &turn);
        let sum = |first: usize, velocities: &mut [[Vec3; 2]]| {
            for (body, velocity) in (first..).zip(velocities) {
                let [mut impulse, mut moment] = [Vec3::zeros(); 2];
                for side in of_bodies.of(body) {
                    let load = side.load(&on_b[side.point as usize]);
                    impulse += load[0];
                    moment += load[1];
                }
                *velocity = self.bodies.rigid[body].kicked(&impulse, &moment);
            }
        };
        chunks::for_each(velocities.rigid.as_mut_slice(), BODIES_AT_A_TIME, &sum);
        let strain = |first: usize, rates: &mut [Matrix3<f64>]| {
            for (body, rate) in self.bodies.straining[first..].iter().zip(rates) {
                let sides = of_bodies.of(body.body as usize).iter();
                let moment = sides.map(|side| side.first_moment(&on_b[side.point as usize]));
                *rate = body.gradient(&moment.sum());
            }
        };
        chunks::for_each(
            velocities.strain_rate.as_mut_slice(),
            BODIES_AT_A_TIME,
            &strain,
        );
        self.bodies.part_gradients(&mut velocities);
        velocities
    }

    fn colors(&self) -> Vec<Vec<u32>> {
        let mut taken_at = vec![Vec::new(); self.bodies.rigid.len()];
        let mut taken: Vec<u64> = Vec::new();
        greedy(self.points.len(), |a| {
            taken.clear();
            let bodies = self.points[a].arms.iter().flatten();
            for (body, _) in bodies.clone() {
                let of_body: &Vec<u64> = &taken_at[*body as usize];
                taken.resize(taken.len().max(of_body.len()), 0);
                for (bits, more) in taken.iter_mut().zip(of_body) {
                    *bits |= more;
                }
            }
            let color = first_free(&taken);
            for (body, _) in bodies {
                mark(&mut taken_at[*body as usize], color);
            }
            color
        })
    }
}

/// A matrix in blocks of 3 x 3, which need not be symmetric: a problem from elsewhere.
#[derive(Clone, Debug, Default)]
pub struct BlockMatrix {
    diagonal: Vec<Matrix3<f64>>,
    /// Rows that a column has beside the diagonal, with their blocks.
    columns: Vec<Vec<(u32, Matrix3<f64>)>>,
}

impl BlockMatrix {
    /// From (row, column, block) for `n` contacts; blocks of one place are added. `None` if a number is not below `n`.
    pub fn new(
        n: usize,
        blocks: impl IntoIterator<Item = (usize, usize, Matrix3<f64>)>,
    ) -> Option<Self> {
        let mut found = Self {
            diagonal: vec![Matrix3::zeros(); n],
            columns: vec![Vec::new(); n],
        };
        for (row, column, block) in blocks {
            if n <= row || n <= column {
                return None;
            }
            if row == column {
                found.diagonal[row] += block;
                continue;
            }
            let rows = &mut found.columns[column];
            match rows.iter_mut().find(|(r, _)| *r as usize == row) {
                Some((_, sum)) => *sum += block,
                None => rows.push((row as u32, block)),
            }
        }
        Some(found)
    }
}

impl Delassus for BlockMatrix {
    /// Of the contacts.
    type Velocities = Vec<Vec3>;

    fn n_contacts(&self) -> usize {
        self.diagonal.len()
    }

    fn diagonal(&self, a: usize) -> &Matrix3<f64> {
        &self.diagonal[a]
    }

    fn at_rest(&self) -> Self::Velocities {
        vec![Vec3::zeros(); self.diagonal.len()]
    }

    fn velocity(&self, velocities: &Self::Velocities, a: usize) -> Vec3 {
        velocities[a]
    }

    fn add(&self, velocities: &mut Self::Velocities, a: usize, impulse: &Vec3) {
        velocities[a] += self.diagonal[a] * impulse;
        for (row, block) in &self.columns[a] {
            velocities[*row as usize] += block * impulse;
        }
    }

    fn colors(&self) -> Vec<Vec<u32>> {
        let n = self.diagonal.len();
        let mut partners = vec![Vec::new(); n];
        for (column, rows) in self.columns.iter().enumerate() {
            for (row, _) in rows {
                partners[column].push(*row as usize);
                partners[*row as usize].push(column);
            }
        }
        let mut color_of = vec![None; n];
        greedy(n, |a| {
            let mut taken = Vec::new();
            for color in partners[a].iter().filter_map(|&b| color_of[b]) {
                mark(&mut taken, color);
            }
            let color = first_free(&taken);
            color_of[a] = Some(color);
            color
        })
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::super::bodies::{Body, StrainingBody};
    use super::*;
    use crate::Random;
    use crate::motion::deformation::MomentCompliance;

    /// A body that strains, by some symmetric, positive compliance.
    fn straining(body: u32, random: &mut Random) -> StrainingBody {
        let root = MomentCompliance::from_fn(|_, _| random.uniform() - 0.5);
        StrainingBody {
            body,
            compliance: root * root.transpose() + MomentCompliance::identity() * 0.1,
        }
    }

    /// Two bodies, one of which strains, on a third and on what does not move.
    fn contacts() -> BodyContacts {
        let mut random = Random::new(3);
        let bodies = (0..3)
            .map(|k| Body {
                inverse_mass: 0.5 + f64::from(k),
                freedom: (k == 1).then(|| Matrix3::from_diagonal(&Vec3::new(1.0, 0.0, 1.0))),
                inverse_inertia: Matrix3::from_diagonal(&Vec3::new(1.0, 2.0, 3.0)),
            })
            .collect();
        let mut vector = || Vec3::from_fn(|_, _| random.uniform() - 0.5);
        let points = [
            (None, Some(0)),
            (Some(0), Some(1)),
            (Some(0), Some(2)),
            (Some(1), None),
        ]
        .map(|(a, b): (Option<u32>, Option<u32>)| {
            let normal = vector().normalize();
            Point::new(normal, [a, b].map(|body| body.map(|body| (body, vector()))))
        });
        let strains = straining(2, &mut random);
        BodyContacts::new(Bodies::new(bodies, vec![strains]), points.to_vec())
    }

    /// The operator of bodies is symmetric, and its diagonal is what it does to a contact's own impulse.
    #[test]
    fn the_operator_of_bodies_is_symmetric() {
        let contacts = contacts();
        let block = |a: usize, b: usize| {
            let columns = [0, 1, 2].map(|axis| {
                let mut velocities = contacts.at_rest();
                contacts.add(&mut velocities, b, &Vec3::ith(axis, 1.0));
                contacts.velocity(&velocities, a)
            });
            Matrix3::from_columns(&columns)
        };
        for a in 0..4 {
            assert!((block(a, a) - contacts.diagonal(a)).norm() < 1e-14);
            for b in 0..4 {
                assert!(
                    (block(a, b) - block(b, a).transpose()).norm() < 1e-14,
                    "{a} {b}"
                );
            }
        }
        assert_eq!(block(2, 3), Matrix3::zeros(), "no body in common");
    }

    /// The sum by bodies, where there are many points, is that of the points one by one, torques included.
    #[test]
    fn a_large_product_is_the_sum_of_its_impulses() {
        let mut random = Random::new(5);
        let n_bodies = 300_u32;
        let mut vector = || Vec3::from_fn(|_, _| random.uniform() - 0.5);
        let bodies = (0..n_bodies).map(|k| Body {
            inverse_mass: 0.5 + f64::from(k % 3),
            freedom: (k % 5 == 0).then(|| Matrix3::from_diagonal(&Vec3::new(1.0, 0.0, 1.0))),
            inverse_inertia: Matrix3::from_diagonal(&Vec3::new(1.0, 2.0, 3.0)),
        });
        let bodies: Vec<Body> = bodies.collect();
        let points = (0..ROWS_AT_A_TIME as u32 + 500).map(|k| {
            let arms = [k % n_bodies, (7 * k + 1) % n_bodies].map(|body| (body, vector()));
            let arms = [(k % 11 != 0).then_some(arms[0]), Some(arms[1])];
            let contact = Point::new(vector().normalize(), arms);
            match k % 4 == 0 {
                true => Point::rolling(&contact, 0.3),
                false => contact,
            }
        });
        let points = points.collect();
        let strain: Vec<_> = (0..n_bodies).filter(|b| b % 7 == 3).collect();
        let strain = strain.into_iter().map(|b| straining(b, &mut random));
        let contacts = BodyContacts::new(Bodies::new(bodies, strain.collect()), points);
        assert!(contacts.of_bodies.is_some());
        let mut vector = || Vec3::from_fn(|_, _| random.uniform() - 0.5);
        let impulses: Vec<Vec3> = (0..contacts.n_contacts()).map(|_| vector()).collect();
        let mut sum = contacts.at_rest();
        for (a, impulse) in impulses.iter().enumerate() {
            contacts.add(&mut sum, a, impulse);
        }
        let product = contacts.product(&impulses);
        for (found, expected) in product.rigid.iter().zip(&sum.rigid) {
            let off = (found[0] - expected[0]).norm() + (found[1] - expected[1]).norm();
            // some ten terms of size 1
            assert!(off < 1e-13, "{off}");
        }
        let rates = product.strain_rate.iter().zip(&sum.strain_rate);
        for (found, expected) in rates {
            let off = (found - expected).norm();
            assert!(off < 1e-13 * (1.0 + expected.norm()), "{off}");
        }
    }

    /// The same blocks as a matrix do the same, in the same colors.
    #[test]
    fn a_matrix_of_its_blocks_is_the_same_operator() {
        let contacts = contacts();
        let blocks = (0..4).flat_map(|b| {
            let columns = [0, 1, 2].map(|axis| {
                let mut velocities = contacts.at_rest();
                contacts.add(&mut velocities, b, &Vec3::ith(axis, 1.0));
                [0, 1, 2, 3].map(|a| contacts.velocity(&velocities, a))
            });
            (0..4).map(move |a| {
                (
                    a,
                    b,
                    Matrix3::from_columns(&columns.map(|column| column[a])),
                )
            })
        });
        let blocks: Vec<_> = blocks.filter(|(.., block)| block.norm() > 0.0).collect();
        let matrix = BlockMatrix::new(4, blocks).unwrap();
        let impulses = [1.0, 2.0, -1.0, 0.5].map(|s| Vec3::new(s, 1.0 - s, s * s));
        let (of_bodies, of_matrix) = (contacts.product(&impulses), matrix.product(&impulses));
        for a in 0..4 {
            let off = contacts.velocity(&of_bodies, a) - matrix.velocity(&of_matrix, a);
            assert!(off.norm() < 1e-14);
        }
        assert_eq!(contacts.colors(), matrix.colors());
        assert_eq!(contacts.colors(), [vec![0, 3], vec![1], vec![2]]);
        assert!(BlockMatrix::new(1, [(0, 1, Matrix3::zeros())]).is_none());
    }
}
