//! Penalty contact: springs with Mohr-Coulomb strength on the manifolds that detection finds.
//!
//! ```text
//! normal   F_n = w K δ − w c ġ ≥ 0,     c = 2 ξ √(K_e m_e)/Σw,  1/m_e = w_A + w_B (compliances along n)    [N]
//! shear    see `friction`
//! ```
//! `w` is the point's weight, `δ` its overlap, `ġ` its opening rate, `K_e = K Σ w` the stiffness that the motion of the
//! pair as a whole feels. Forces act on j; i gets the opposite at the same point.
//! Source: Cundall (1988), Geraili Mikola & Sitar (2013); damping clamped after Schwager & Pöschel
//! (2007); shear history after Luding (2008).
//!
//! Polyhedra, spheres and bodies on a surface of triangles share all of it: `normal` and `friction` are the law, `work`
//! its account, `step_bound` its share in the stable step. Four corrections keep the energy of a step that is not small:
//!
//! 1. `feature_change`: when another face or edge takes over, its springs go on with the energy of those before.
//! 2. `normal::dashpot_share`: the dashpot acts for the time that it would in a continuous motion.
//! 3. `impact`: bodies that meet or part within a step are pushed for the time they touched.
//! 4. `feature_change::stiffen`: a contact that has become softer takes up what it loses.

mod feature_change;
pub(crate) mod friction;
pub(crate) mod history;
mod impact;
mod law;
mod normal;
pub(crate) mod polyhedra;
pub(crate) mod spheres;
mod step_bound;
pub(crate) mod terrain;
mod work;

pub(crate) use impact::PointForce;
