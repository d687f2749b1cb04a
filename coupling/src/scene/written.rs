//! A resolved scene as a file: every choice written out, so that it runs again to the same bits.

use riprap_dda::{ContactSolver, Integrator, StepBound};
use riprap_sph::scheme::{Viscosity, ViscousStep};

use super::crs::Crs;
use super::file::{
    AbsorberFile, BlockIntegratorFile, BlockTableFile, ContactSolverFile, FluidFile, ForcesFile,
    GrainExchangeFile, HandoffFile, InterfaceFile, MapsFile, NumericsFile, OutputFile, RestingFile,
    SceneFile, SleepingFile, StepBoundFile, TerrainFile, TrajectoriesFile, ViscosityFile,
    ViscousStepFile,
};
use super::fluid::chosen_viscosity;
use super::parse;
use super::resolved::recording::{BlockTable, Maps, Output};
use super::resolved::{FluidScene, Scene};
use crate::walls::WallMethod;

impl Scene {
    /// The scene as text that leaves nothing open.
    ///
    /// # Errors
    ///
    /// Those of [`parse::write`].
    pub fn to_text(&self) -> Result<String, ron::Error> {
        parse::write_noted(&self.to_file(), &self.note())
    }

    /// Comment under the title of the text: the blocks that follow from it, so that a run is not taken further with others, as
    /// another version of riprap may make.
    pub fn note(&self) -> String {
        self.made.as_ref().map_or_else(String::new, |made| {
            format!(
                "// {} blocks follow from slides, rock_masses and grains; BLAKE3 of all blocks: {}\n",
                made.n_blocks, made.hash
            )
        })
    }

    /// Files that the scene names, relative to its folder.
    pub fn referenced_files(&self) -> Vec<String> {
        self.source.referenced_files()
    }

    /// The scene as a file that leaves nothing open.
    pub fn to_file(&self) -> SceneFile {
        let source = &self.source;
        let mut materials = source.materials.clone();
        for (written, material) in materials.iter_mut().zip(&self.materials) {
            written.contact_stiffness = Some(material.contact_stiffness);
        }
        let fluid = self.fluid.as_ref();
        SceneFile {
            materials,
            terrain: self.written_terrain(),
            absorbers: fluid.map_or_else(
                || source.absorbers.clone(),
                |fluid| written_absorbers(&source.absorbers, fluid),
            ),
            fluid: source.fluid.clone().map(|file| FluidFile {
                dynamic_viscosity: fluid
                    .map(|fluid| chosen_viscosity(&file, &fluid.settings.scheme)),
                grains: GrainExchangeFile {
                    kernel_radius: (fluid.and_then(|fluid| fluid.averaged.as_ref()))
                        .map_or(file.grains.kernel_radius, |chosen| {
                            Some(chosen.settings.kernel_radius)
                        }),
                    ..file.grains
                },
                ..file
            }),
            interface: fluid.map_or_else(
                || source.interface.clone(),
                |fluid| written_interface(&source.interface, fluid),
            ),
            numerics: self.written_numerics(),
            forces: source.forces.clone().map(|forces| ForcesFile {
                interval: self.forces.as_ref().map(|chosen| chosen.interval),
                ..forces
            }),
            trajectories: source.trajectories.clone().map(|tracked| TrajectoriesFile {
                interval: self.trajectories.as_ref().map(|chosen| chosen.interval),
                ..tracked
            }),
            maps: source
                .maps
                .clone()
                .map(|maps| written_maps(maps, self.maps)),
            handoff: source.handoff.clone().map(|handoff| HandoffFile {
                cell: self.handoff.as_ref().map(|chosen| chosen.cell),
                level: self.handoff.as_ref().map(|chosen| chosen.level),
                ..handoff
            }),
            output: written_output(&source.output, (&self.output, &self.block_table), fluid),
            ..source.clone()
        }
    }

    fn written_terrain(&self) -> Option<TerrainFile> {
        let file = self.source.terrain.clone()?;
        let terrain = self.terrain.as_ref()?;
        Some(TerrainFile {
            spacing: Some(terrain.grid.spacing),
            tolerance: Some(terrain.tolerance),
            crs: terrain.crs.as_ref().map(Crs::written),
            ..file
        })
    }

    fn written_numerics(&self) -> NumericsFile {
        let file = self.source.numerics.clone();
        let file = NumericsFile {
            expected_speed: Some(self.expected_speed),
            blocks: match self.block_settings.integrator {
                Integrator::CentralDifference => BlockIntegratorFile::CentralDifference,
                Integrator::ContactDynamics(dynamics) => BlockIntegratorFile::ContactDynamics {
                    time_step: Some(dynamics.time_step),
                    tolerance: Some(dynamics.tolerance),
                    sweeps: u32::try_from(dynamics.n_iterations).ok(),
                    solver: match dynamics.solver {
                        ContactSolver::Chosen => ContactSolverFile::Chosen,
                        ContactSolver::GaussSeidel => ContactSolverFile::GaussSeidel,
                        ContactSolver::Gradient => ContactSolverFile::Gradient,
                    },
                },
            },
            block_time_step_factor: Some(self.block_settings.time_step_factor),
            block_step_bound: Some(match self.block_settings.step_bound {
                StepBound::Compliances => StepBoundFile::Compliances,
                StepBound::Eigenvalues => StepBoundFile::Eigenvalues,
            }),
            resting: self.block_settings.resting.map(|resting| RestingFile {
                displacement: Some(resting.displacement),
                time: Some(resting.time),
                load: Some(resting.load),
            }),
            ..file
        };
        match &self.fluid {
            None => file,
            Some(fluid) => fluid_numerics(file, fluid),
        }
    }
}

fn fluid_numerics(file: NumericsFile, fluid: &FluidScene) -> NumericsFile {
    let settings = &fluid.settings;
    let scheme = &settings.scheme;
    NumericsFile {
        kernel: Some(scheme.kernel.into()),
        density: Some(scheme.density.into()),
        state_equation: Some(scheme.state_equation.into()),
        density_diffusion: Some(scheme.diffusion.into()),
        viscosity: Some(match scheme.viscosity {
            Viscosity::None => ViscosityFile::Off,
            Viscosity::Published { .. } => ViscosityFile::Published,
            Viscosity::Artificial { alpha } => ViscosityFile::Artificial(alpha),
            Viscosity::Laminar { .. } => ViscosityFile::Laminar,
            Viscosity::Morris { .. } => ViscosityFile::Morris,
            Viscosity::Rheological { .. } => ViscosityFile::Rheological,
            Viscosity::SubParticleScale { smagorinsky, .. } => {
                ViscosityFile::SubParticleScale(smagorinsky)
            }
        }),
        viscous_step: match scheme.viscous_step {
            ViscousStep::Explicit => ViscousStepFile::Explicit,
            ViscousStep::Implicit => ViscousStepFile::Implicit,
        },
        bulk_viscosity: Some(scheme.bulk_viscosity),
        shifting: Some(scheme.shifting.into()),
        stepping: Some(scheme.stepping.into()),
        precision: Some(scheme.precision.into()),
        smoothing_length_ratio: Some(fluid.smoothing_length_ratio),
        sound_speed: Some(settings.sound_speed),
        time_step_factor: Some(settings.time_step_factor),
        negative_pressure: Some(scheme.negative_pressure.into()),
        sleeping: fluid.sleeping.map(|sleeping| SleepingFile {
            displacement: Some(sleeping.displacement),
            speed: Some(sleeping.speed),
            time: Some(sleeping.time),
        }),
        ..file
    }
}

fn written_interface(file: &InterfaceFile, fluid: &FluidScene) -> InterfaceFile {
    let springs = match fluid.wall_method {
        WallMethod::Penalty => (Some(fluid.walls.stiffness), Some(fluid.walls.damping)),
        // springs of their own, which the file does not set
        WallMethod::Particles | WallMethod::Integral => {
            (file.penalty_stiffness, file.penalty_damping)
        }
    };
    InterfaceFile {
        walls: Some(fluid.wall_method.into()),
        slip: file.slip,
        penalty_stiffness: springs.0,
        penalty_damping: springs.1,
    }
}

fn written_absorbers(files: &[AbsorberFile], fluid: &FluidScene) -> Vec<AbsorberFile> {
    let layers = files.iter().zip(&fluid.absorbers);
    layers
        .map(|(file, layer)| AbsorberFile {
            rate: Some(layer.rate),
            ..file.clone()
        })
        .collect()
}

fn written_maps(file: MapsFile, chosen: Option<Maps>) -> MapsFile {
    match chosen {
        None => file,
        Some(maps) => MapsFile {
            spacing: Some(maps.spacing),
            interval: Some(maps.interval),
            arrival_threshold: Some(maps.arrival_threshold),
        },
    }
}

fn written_output(
    file: &OutputFile,
    (output, table): (&Output, &BlockTable),
    fluid: Option<&FluidScene>,
) -> OutputFile {
    OutputFile {
        block_table: BlockTableFile {
            interval: Some(table.interval),
            ..file.block_table.clone()
        },
        frame_interval: Some(output.frame_interval),
        gauge_interval: Some(output.gauge_interval),
        ledger_interval: Some(output.ledger_interval),
        water_fields: match fluid {
            None => file.water_fields.clone(),
            Some(_) => Some(output.water_fields.clone()),
        },
        ..file.clone()
    }
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test may stop where a library may not"
)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::scene::file::{DensityDiffusionFile, ShiftingFile};

    fn scene(numerics: &str, rest: &str) -> Scene {
        let text = format!(
            r#"(title: "a tank", domain: (min: (0, 0, 0), max: (2, 1, 2)),
                materials: [(name: "rock", density: 2500, friction_angle_deg: 30)],
                blocks: [(name: "bed", material: "rock", motion: Fixed, shape: Box(min: (0, 0, 0), max: (2, 1, 0.2))),
                         (name: "cube", material: "rock", shape: Box(min: (0.2, 0.2, 1.5), max: (0.4, 0.4, 1.7)))],
                fluid: (resolution: Spacing(0.1), regions: [(name: "sea", shape: Box(min: (0, 0, 0.2), max: (2, 1, 1)))]),
                numerics: ({numerics}), {rest} time: (duration: 1))"#
        );
        Scene::resolve(parse::read(&text).unwrap(), Path::new(".")).unwrap()
    }

    /// Chosen numbers are written so that they read back the same, and leave nothing to choose.
    #[test]
    fn a_scene_as_it_ran_reads_back_the_same() {
        let rest = r#"absorbers: [(name: "end", min: (1.5, 0, 0), max: (2, 1, 2), towards: XMax)],
            maps: (), forces: (), trajectories: (), gauges: [BlockForce(name: "f", block: "cube")],"#;
        for numerics in [
            "sleeping: (), resting: ()",
            "preset: Reference",
            "preset: Mueller2003",
            "viscosity: SubParticleScale(0.12), shifting: Fickian(2)",
            "viscosity: Laminar, bulk_viscosity: 0.1",
        ] {
            let before = scene(numerics, rest);
            let file = before.to_file();
            let text = before.to_text().unwrap();
            let after = Scene::resolve(parse::read(&text).unwrap(), Path::new(".")).unwrap();
            assert_eq!(after.source, file, "{numerics}");
            assert_eq!(after.to_file(), file, "{numerics}");
            assert_eq!(after.output, before.output);
            let (a, b) = (after.fluid.unwrap(), before.fluid.unwrap());
            assert_eq!(format!("{:?}", a.settings), format!("{:?}", b.settings));
            assert_eq!(
                (a.walls, a.sleeping, a.pressures),
                (b.walls, b.sleeping, b.pressures)
            );
        }
    }

    /// `Off`, and the old ways to write it.
    #[test]
    fn what_is_off_stays_off() {
        for off in ["Off", "Some(Off)", "Some(None)"] {
            let numerics = format!("density_diffusion: {off}, viscosity: {off}, shifting: {off}");
            let file = scene(&numerics, "").to_file().numerics;
            assert_eq!(file.density_diffusion, Some(DensityDiffusionFile::Off));
            assert_eq!(file.viscosity, Some(ViscosityFile::Off));
            assert_eq!(file.shifting, Some(ShiftingFile::Off));
        }
        let file = scene("density_diffusion: None, viscosity: None", "").to_file();
        assert_eq!(
            file.numerics.density_diffusion,
            Some(DensityDiffusionFile::Fourtakas(0.1))
        );
        assert_eq!(file.numerics.viscosity, Some(ViscosityFile::Laminar));
    }
}
