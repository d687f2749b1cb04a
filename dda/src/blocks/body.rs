//! Body of a block at t = 0: mass, principal axes, deformation and initial motion.

use crate::motion::deformation::{
    Affine12, AffineBody, Dda12, Deformable, elastic_constants, tensor,
};
use crate::{
    BlockDefinition, BlockError, DeformableModel, MassProperties, Material, Motion, Shape, Vec3,
};
use nalgebra::{Rotation3, SymmetricEigen, UnitQuaternion};

/// Body of a block at t = 0.
pub(super) struct Body {
    /// As given, before a prescribed displacement; m.
    pub centroid: Vec3,
    /// m³.
    pub volume: f64,
    /// kg.
    pub mass: f64,
    /// Principal moments of inertia; kg m².
    pub moments: Vec3,
    /// Rotation from the principal axes to the given placement.
    pub principal: UnitQuaternion<f64>,
    /// Strain and stress of a deformable block.
    pub deformable: Option<Deformable>,
}

impl Body {
    /// The body of a block, checked.
    pub fn of(
        block: usize,
        definition: &BlockDefinition,
        rock: &Material,
    ) -> Result<Self, BlockError> {
        let properties = definition.shape.mass_properties();
        check(block, definition, &properties)?;
        let deformable = deformable(block, definition, rock, &properties)?;
        let (moments, principal) = if matches!(definition.shape, Shape::Surface(_)) {
            // it has no mass and never moves: nonzero moments give zero spin instead of 0/0
            (Vec3::repeat(1.0), UnitQuaternion::identity())
        } else {
            principal_axes(&properties, rock.density)
        };
        Ok(Self {
            centroid: properties.centroid,
            volume: properties.volume,
            mass: rock.density * properties.volume,
            moments,
            principal,
            deformable,
        })
    }
}

/// Motion of a block at t = 0.
pub(super) struct InitialMotion {
    /// From the given placement; m.
    pub displacement: Vec3,
    /// Rotation from the given placement.
    pub turn: UnitQuaternion<f64>,
    /// m/s.
    pub velocity: Vec3,
    /// World; rad/s.
    pub spin: Vec3,
}

impl InitialMotion {
    pub fn of(definition: &BlockDefinition) -> Self {
        let (displacement, turn) = (Vec3::zeros(), UnitQuaternion::identity());
        match &definition.motion {
            Motion::Free => Self {
                displacement,
                turn,
                velocity: definition.velocity,
                spin: definition.angular_velocity,
            },
            Motion::Fixed => Self {
                displacement,
                turn,
                velocity: Vec3::zeros(),
                spin: Vec3::zeros(),
            },
            Motion::Prescribed(path) => Self {
                displacement: path.displacement(0.0),
                turn: path.turn(0.0),
                velocity: path.velocity(0.0),
                spin: path.spin(0.0),
            },
        }
    }
}

fn check(
    block: usize,
    definition: &BlockDefinition,
    properties: &MassProperties,
) -> Result<(), BlockError> {
    let is_surface = matches!(definition.shape, Shape::Surface(_));
    if is_surface && !matches!(definition.motion, Motion::Fixed) {
        return Err(BlockError::Surface { block });
    }
    let has_volume = properties.volume > 0.0 && properties.volume.is_finite();
    if !has_volume && !is_surface {
        return Err(BlockError::Empty { block });
    }
    let mut velocities = definition
        .velocity
        .iter()
        .chain(definition.angular_velocity.iter());
    if !velocities.all(|c| c.is_finite()) {
        return Err(BlockError::NotFinite { block });
    }
    match &definition.motion {
        Motion::Prescribed(path) => path.check(block),
        Motion::Free | Motion::Fixed => Ok(()),
    }
}

/// Strain and stress at t = 0 of a block that is to be deformable.
fn deformable(
    block: usize,
    definition: &BlockDefinition,
    rock: &Material,
    properties: &MassProperties,
) -> Result<Option<Deformable>, BlockError> {
    let refuse = |reason| Err(BlockError::Deformability { block, reason });
    let Some(wanted) = &definition.deformability else {
        return Ok(None);
    };
    if !matches!(definition.motion, Motion::Free) {
        return refuse("only a free block can be deformable");
    }
    if !matches!(definition.shape, Shape::Polyhedra(_)) {
        return refuse("only a block of polyhedra can be deformable");
    }
    let Some(elastic) = &rock.elastic else {
        return refuse("its material has no elastic moduli");
    };
    if !(wanted.strain_mass_factor >= 1.0 && wanted.strain_mass_factor.is_finite()) {
        return refuse("the factor on the inertia of strain must be at least 1");
    }
    if wanted.initial_stress.iter().any(|c| !c.is_finite()) {
        return refuse("the initial stress must be finite");
    }
    let second_moment = properties.second_moment * rock.density;
    let Some(body) = AffineBody::new(
        second_moment,
        properties.volume,
        &definition.angular_velocity,
        wanted.strain_mass_factor,
    ) else {
        return refuse("it is flat");
    };
    let constants = elastic_constants(elastic, &second_moment, properties.volume);
    let stress = tensor(&wanted.initial_stress);
    Ok(Some(match wanted.model {
        DeformableModel::Affine12(law) => {
            Deformable::Affine12(Affine12::new(body, law, constants, stress))
        }
        DeformableModel::Dda12 => Deformable::Dda12(Dda12::new(body, constants, stress)),
    }))
}

/// Moments of inertia and the rotation from principal axes to the given placement.
fn principal_axes(properties: &MassProperties, density: f64) -> (Vec3, UnitQuaternion<f64>) {
    let inertia = properties.inertia() * density;
    let largest = inertia.abs().max();
    let off_diagonal = inertia[(0, 1)]
        .abs()
        .max(inertia[(0, 2)].abs())
        .max(inertia[(1, 2)].abs());
    // axes that are principal already keep their digits
    if off_diagonal <= 1e-14 * largest {
        return (inertia.diagonal(), UnitQuaternion::identity());
    }
    let eigen = SymmetricEigen::new(inertia);
    let mut axes = eigen.eigenvectors;
    if axes.determinant() < 0.0 {
        axes.set_column(0, &-axes.column(0));
    }
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
    (eigen.eigenvalues, turn)
}
