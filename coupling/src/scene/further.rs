//! What may change in a scene whose run is taken further: a longer duration, more gauges, intervals of output, the camera; in
//! another folder also numerics that the state does not carry.

use super::file::{SceneFile, ViscosityFile};
use super::parse;

/// Changes of a scene that its run may be continued with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Changes {
    /// Of what is recorded, and how long.
    Records,
    /// Of numerics, too: steps, viscosity, damping.
    Numerics,
}

/// What [`Changes::Numerics`] allows beside the records, for messages.
pub(crate) const NUMERICS: &str = "`time_step_factor`, `block_time_step_factor`, `block_step_bound`, `viscosity`, \
    `bulk_viscosity`, `density_diffusion` and `static_damping` of `numerics`, `fluid.dynamic_viscosity`, \
    `interface.penalty_damping`, `domain.leaving` and `restitution`";

/// Reason why a field, named at the start of a line, cannot change under a state.
pub(crate) fn reason_to_stay(line: &str) -> &'static str {
    match line.split(':').next().unwrap_or_default().trim() {
        "sound_speed" | "state_equation" => {
            "densities carry the pressures by it, and all of them would jump"
        }
        "contact_stiffness" | "joint_stiffness" | "shear_stiffness_ratio" | "penalty_stiffness" => {
            "contacts carry their loads by it, and all of them would jump"
        }
        "kernel"
        | "smoothing_length_ratio"
        | "density"
        | "stepping"
        | "preset"
        | "precision"
        | "walls" => "densities, masses and forces of the state were made with it",
        _ => "the state is of these bodies and of this water",
    }
}

/// The text of a scene with all that may change in a run taken from the scene of the run so far.
///
/// Two scenes differ in nothing else if this is the text of the scene before. `None` where a text is no scene.
pub(crate) fn as_before(before: &str, now: &str, changes: Changes) -> Option<String> {
    let note = parse::note(now);
    let (before, mut now) = (parse::read(before).ok()?, parse::read(now).ok()?);
    keep_records(&before, &mut now);
    if changes == Changes::Numerics {
        keep_numerics(&before, &mut now);
    }
    parse::write_noted(&now, &note).ok()
}

fn keep_records(before: &SceneFile, now: &mut SceneFile) {
    if before.time.duration < now.time.duration {
        now.time.duration = before.time.duration;
    }
    now.time.wall_limit = before.time.wall_limit;
    // records of a gauge that is left out or moved would be lost
    if before.gauges.iter().all(|gauge| now.gauges.contains(gauge)) {
        now.gauges.clone_from(&before.gauges);
    }
    now.camera.clone_from(&before.camera);
    // labels, which runs of earlier versions lack; the shapes are compared by themselves
    for (now, before) in now.blocks.iter_mut().zip(&before.blocks) {
        now.group.clone_from(&before.group);
        now.joint_faces.clone_from(&before.joint_faces);
    }
    let (output, other) = (&mut now.output, &before.output);
    output.frame_interval = other.frame_interval;
    output.gauge_interval = other.gauge_interval;
    output.ledger_interval = other.ledger_interval;
    output.block_table.interval = other.block_table.interval;
    output.water.clone_from(&other.water);
    output.blocks.clone_from(&other.blocks);
    output.contact_frames.clone_from(&other.contact_frames);
    output.face_frames.clone_from(&other.face_frames);
    if let (Some(now), Some(before)) = (&mut now.forces, &before.forces) {
        now.interval = before.interval;
    }
    if let (Some(now), Some(before)) = (&mut now.trajectories, &before.trajectories) {
        now.interval = before.interval;
    }
    if let (Some(now), Some(before)) = (&mut now.maps, &before.maps) {
        now.interval = before.interval;
    }
}

fn keep_numerics(before: &SceneFile, now: &mut SceneFile) {
    let (numerics, other) = (&mut now.numerics, &before.numerics);
    // all that they choose is written out, and compared by itself
    numerics.preset = other.preset;
    numerics.expected_speed = other.expected_speed;
    numerics.time_step_factor = other.time_step_factor;
    numerics.block_time_step_factor = other.block_time_step_factor;
    numerics.block_step_bound = other.block_step_bound;
    numerics.bulk_viscosity = other.bulk_viscosity;
    numerics.density_diffusion = other.density_diffusion;
    numerics.static_damping = other.static_damping;
    if has_no_state(numerics.viscosity) && has_no_state(other.viscosity) {
        numerics.viscosity = other.viscosity;
    }
    if let (Some(now), Some(before)) = (&mut now.fluid, &before.fluid) {
        now.dynamic_viscosity = before.dynamic_viscosity;
    }
    now.interface.penalty_damping = before.interface.penalty_damping;
    now.domain.leaving = before.domain.leaving;
    for (now, before) in now.materials.iter_mut().zip(&before.materials) {
        now.restitution = before.restitution;
    }
    for (now, before) in now.joints.iter_mut().zip(&before.joints) {
        now.restitution = before.restitution;
    }
}

/// Whether the viscosity follows from velocities alone, without numbers of its own in the state.
fn has_no_state(viscosity: Option<ViscosityFile>) -> bool {
    !matches!(
        viscosity,
        Some(ViscosityFile::Rheological | ViscosityFile::SubParticleScale(_))
    )
}
