//! Codes of the errors of the solvers, which know nothing of guides.

use riprap_dda::{BlockError, StepError};
use riprap_sph::FluidError;

use super::{Code, Coded};

impl Coded for BlockError {
    fn code(&self) -> Code {
        match self {
            Self::NoSuchMaterial { .. } => Code::UnknownName,
            Self::Material { .. } | Self::Joint { .. } | Self::Setting { .. } => {
                Code::ValueOutOfRange
            }
            Self::JointPair { .. } => Code::WrittenTwice,
            Self::Empty { .. } => Code::InvalidShape,
            Self::Surface { .. } => Code::IncompatibleOptions,
            Self::NotFinite { .. } => Code::NumberNotFinite,
            Self::Deformability { .. } => Code::UnusableDeformable,
            Self::Hold { .. } => Code::NeedsFreeBlock,
            Self::Attachment { .. } => Code::UnusableAttachment,
            Self::Motion { .. } => Code::UnusablePath,
        }
    }
}

impl Coded for StepError {
    fn code(&self) -> Code {
        match self {
            Self::NotFinite { .. } => Code::BlockNan,
            Self::Overlap { .. } => Code::PenetrationTooDeep,
            Self::Crushed { .. } => Code::BlockCrushed,
            Self::Unsolved { .. } => Code::ContactsUnsolved,
            Self::TimeStep { .. } => Code::TimeStepCollapsed,
        }
    }
}

impl Coded for FluidError {
    fn code(&self) -> Code {
        match self {
            Self::Setting { .. } => Code::ValueOutOfRange,
            Self::NarrowPeriod { .. } => Code::UnusablePeriod,
            Self::Symmetry { .. } => Code::UnusableSymmetryPlane,
            Self::TooManyParticles { .. } => Code::NotEnoughMemory,
            Self::GrowingSound => Code::GrowingSound,
            Self::ExplicitViscosity { .. } => Code::IncompatibleOptions,
            Self::ViscousStep { .. } => Code::ViscousStepUnsolved,
            Self::Sleepless { .. } => Code::WaterCannotSleep,
            Self::NonFinite { .. } => Code::ParticleNan,
            Self::Compressed { .. } => Code::WaterCompressed,
        }
    }
}
