//! Scratch memory of the fluid.

use crate::Vec3;
use crate::fluid::advance::Compression;
use crate::fluid::rates::Rates;
use crate::fluid::viscous_unknowns::ViscousUnknowns;
use crate::neighbors::sweep::AnyPoints;
use crate::terms::concentration::Concentration;
use crate::terms::continuity::Rate;
use crate::terms::gradient::StrainSums;
use crate::terms::momentum::ForceDensity;

/// Rates of density of a particle by the flow of the water alone, between grains.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct WaterAlone {
    /// 1/s.
    pub compression: f64,
    /// The part that walls make; kg/(m³ s).
    pub by_walls: f64,
}

/// Memory that is written before it is read in every step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    /// Cells of a sort, then ids in their new order; and numbers of neighbors, see [`Fluid::open_rates`](crate::Fluid::open_rates).
    pub(super) cell: Vec<u32>,
    pub(super) order: Vec<u32>,
    pub(crate) points: AnyPoints,
    /// Packed points for the sums of rates, if water may sleep: kept from step to step, apart from those for forces.
    pub(crate) flow: AnyPoints,
    pub(crate) rates: Rates,
    /// Rates of density of a part of the particles.
    pub(crate) rate_sums: Vec<Rate>,
    /// Densities of the water itself, where grains share its volume; kg/m³.
    pub(crate) water_densities: Vec<f64>,
    /// Fluxes of water and these grains together; m/s.
    pub(crate) fluxes: Vec<Vec3>,
    /// Rates of density by the flow of the water alone, between such grains.
    pub(crate) water_alone: Vec<WaterAlone>,
    pub(crate) forces: Vec<ForceDensity>,
    pub(crate) gradients: Vec<[f64; 3]>,
    pub(crate) strains: Vec<StrainSums>,
    pub(crate) concentrations: Vec<Concentration>,
    pub(crate) extra: AnyPoints,
    /// Apparent viscosities, where they vary.
    pub(crate) viscosities: AnyPoints,
    /// Unknowns of implicit viscous steps.
    pub(crate) viscous_step: ViscousUnknowns,
    pub(crate) partial: Vec<f64>,
    pub(super) changes: Vec<Compression>,
    /// Accelerations by the pressure of walls, of the particles that have any; m/s².
    pub(crate) pushes: Vec<(u32, Vec3)>,
    pub(super) keep: Vec<bool>,
    /// Tiles that wake or fall asleep.
    pub(crate) changing: Vec<bool>,
}
