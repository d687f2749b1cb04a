//! Checks of numerical parameters, times and intervals.

use riprap_sph::scheme::LARGEST_BULK_VISCOSITY;

use super::checks::Checks;
use crate::messages::Code;
use crate::scene::file::{
    BlockIntegratorFile, FramesFile, NumericsFile, OutputFile, SceneFile, SettlingFile,
    StaticDampingFile,
};
use riprap_dda::contact_dynamics::UNSOLVED;

impl Checks {
    pub(super) fn numbers(&mut self, scene: &SceneFile) {
        let (numerics, time, output) = (&scene.numerics, &scene.time, &scene.output);
        for (path, what, value) in [
            (
                "interface.penalty_stiffness",
                "penalty stiffness",
                scene.interface.penalty_stiffness,
            ),
            ("numerics.sound_speed", "sound speed", numerics.sound_speed),
            (
                "numerics.expected_speed",
                "expected speed",
                numerics.expected_speed,
            ),
            (
                "output.frame_interval",
                "frame interval",
                output.frame_interval,
            ),
            (
                "output.gauge_interval",
                "gauge interval",
                output.gauge_interval,
            ),
            (
                "output.ledger_interval",
                "ledger interval",
                output.ledger_interval,
            ),
            ("time.duration", "duration", Some(time.duration)),
            ("time.wall_limit", "wall limit", time.wall_limit),
            (
                "time.stop_at_rest.speed",
                "speed at rest",
                time.stop_at_rest.map(|rest| rest.speed),
            ),
            (
                "time.stop_at_rest.time",
                "time at rest",
                time.stop_at_rest.map(|rest| rest.time),
            ),
            (
                "output.block_table.interval",
                "interval of the table of blocks",
                output.block_table.interval,
            ),
        ] {
            self.positive(path, what, value);
        }
        if let Some(settling) = &time.settle_blocks {
            self.settling(settling);
        }
        self.rare_outputs(scene);
        self.frames(output);
        self.sleep(numerics);
        self.not_negative(
            "interface.penalty_damping",
            "penalty damping",
            scene.interface.penalty_damping,
        );
        self.not_negative("time.settle", "settling time", time.settle);
        self.share(
            "numerics.time_step_factor",
            "time-step factor",
            numerics.time_step_factor,
        );
        self.share(
            "numerics.block_time_step_factor",
            "block time-step factor",
            numerics.block_time_step_factor,
        );
        if let Some(damping) = numerics.static_damping {
            self.static_damping(damping);
        }
        self.block_integrator(numerics.blocks);
        if let Some(alpha) = numerics.bulk_viscosity
            && !(0.0..=LARGEST_BULK_VISCOSITY).contains(&alpha)
        {
            self.refuse(
                Code::ValueOutOfRange,
                "numerics.bulk_viscosity",
                format!(
                    "bulk viscosity must be in [0, {LARGEST_BULK_VISCOSITY}], found {alpha}: customary is 0.05 to 0.2, \
                     and the step falls as its inverse above"
                ),
            );
        }
        if let Some(ratio) = numerics.smoothing_length_ratio
            && !(1.0..=3.0).contains(&ratio)
        {
            self.refuse(
                Code::ValueOutOfRange,
                "numerics.smoothing_length_ratio",
                format!("smoothing length over spacing must be in [1, 3], found {ratio}: fewer neighbors than 30 or more than 900"),
            );
        }
    }

    fn settling(&mut self, settling: &SettlingFile) {
        let path = |field: &str| format!("time.settle_blocks.{field}");
        for (field, what, value) in [
            ("speed", "speed at rest", settling.speed),
            ("time", "time at rest", settling.time),
            ("at_most", "longest settling", settling.at_most),
        ] {
            self.positive(path(field), what, Some(value));
        }
        if settling.at_most < settling.time {
            self.refuse(
                Code::ValuesOutOfOrder,
                path("at_most"),
                format!(
                    "longest settling must be at least the time at rest of {} s, found {} s",
                    settling.time, settling.at_most
                ),
            );
        }
    }

    /// Intervals of output that are longer than the run.
    fn rare_outputs(&mut self, scene: &SceneFile) {
        let (duration, output) = (scene.time.duration, &scene.output);
        for (field, value) in [
            ("frame_interval", output.frame_interval),
            ("gauge_interval", output.gauge_interval),
            ("ledger_interval", output.ledger_interval),
            ("block_table.interval", output.block_table.interval),
            ("water.interval", output.water.interval),
            ("blocks.interval", output.blocks.interval),
            ("contact_frames.interval", output.contact_frames.interval),
            ("face_frames.interval", output.face_frames.interval),
        ] {
            if let Some(value) = value
                && 0.0 < duration
                && duration < value
            {
                self.warn(
                    Code::OptionWithoutEffect,
                    format!("output.{field}"),
                    format!(
                        "{} is {value} s, longer than the run of {duration} s",
                        field.replace(['_', '.'], " ")
                    ),
                );
            }
        }
    }

    /// Frames of each kind.
    fn frames(&mut self, output: &OutputFile) {
        let (water, blocks) = (&output.water, &output.blocks);
        let (contacts, faces) = (&output.contact_frames, &output.face_frames);
        for (kind, interval, corners) in [
            ("water", water.interval, water.r#box),
            ("blocks", blocks.interval, blocks.r#box),
            ("contact_frames", contacts.interval, contacts.r#box),
            ("face_frames", faces.interval, faces.r#box),
        ] {
            let path = format!("output.{kind}");
            self.positive(format!("{path}.interval"), "interval of frames", interval);
            if let Some(corners) = corners {
                let path = format!("{path}.box");
                self.extent(&path, "box of frames", (corners.min, corners.max));
            }
        }
        if water.stride == Some(0) {
            let message = "stride must be 1 or more, found 0".to_owned();
            self.refuse(Code::ValueOutOfRange, "output.water.stride", message);
        }
        for (kind, switch, is_on, frames) in [
            ("contact_frames", "contacts", output.contacts, contacts),
            (
                "face_frames",
                "face_pressures",
                output.face_pressures,
                faces,
            ),
        ] {
            if !is_on && *frames != FramesFile::default() {
                self.warn(
                    Code::OptionWithoutEffect,
                    format!("output.{kind}"),
                    format!("nothing is written without `output.{switch}: true`"),
                );
            }
        }
    }

    /// Parameters of sleeping water and blocks.
    fn sleep(&mut self, numerics: &NumericsFile) {
        let sleeping = numerics.sleeping.unwrap_or_default();
        let resting = numerics.resting.unwrap_or_default();
        for (path, what, value) in [
            (
                "numerics.sleeping.displacement",
                "displacement of sleeping water",
                sleeping.displacement,
            ),
            (
                "numerics.sleeping.speed",
                "speed of sleeping water",
                sleeping.speed,
            ),
            (
                "numerics.sleeping.time",
                "time of sleeping water",
                sleeping.time,
            ),
            (
                "numerics.resting.displacement",
                "displacement of resting blocks",
                resting.displacement,
            ),
            (
                "numerics.resting.time",
                "time of resting blocks",
                resting.time,
            ),
            (
                "numerics.resting.load",
                "change of load of resting blocks",
                resting.load,
            ),
        ] {
            self.positive(path, what, value);
        }
    }

    fn block_integrator(&mut self, blocks: BlockIntegratorFile) {
        let BlockIntegratorFile::ContactDynamics {
            time_step,
            tolerance,
            sweeps,
            solver: _,
        } = blocks
        else {
            return;
        };
        self.positive("numerics.blocks.time_step", "step of the blocks", time_step);
        self.positive("numerics.blocks.tolerance", "tolerance", tolerance);
        if let Some(tolerance) = tolerance
            && UNSOLVED <= tolerance
        {
            self.refuse(
                Code::ValueOutOfRange,
                "numerics.blocks.tolerance",
                format!(
                    "tolerance must be below {UNSOLVED}, at which a step counts as unsolved, found {tolerance}: customary is 1e-3 to 1e-6"
                ),
            );
        }
        if sweeps == Some(0) {
            self.refuse(
                Code::ValueOutOfRange,
                "numerics.blocks.sweeps",
                "sweeps must be 1 or more, found 0".to_owned(),
            );
        }
    }

    fn static_damping(&mut self, damping: StaticDampingFile) {
        let path = "numerics.static_damping";
        match damping {
            StaticDampingFile::MassProportional(value) => {
                self.not_negative(path, "mass-proportional damping", value);
            }
            StaticDampingFile::Local(value) => {
                if !(0.0..1.0).contains(&value) {
                    self.refuse(
                        Code::ValueOutOfRange,
                        path,
                        format!("local damping must be in [0, 1), found {value}"),
                    );
                }
            }
            StaticDampingFile::Kinetic(value) => self.share(path, "kinetic damping", value),
        }
        self.warn(
            Code::DampedForRest,
            path,
            "blocks are damped for a search for rest: their motion means nothing".to_owned(),
        );
    }
}
