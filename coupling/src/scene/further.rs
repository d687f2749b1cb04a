//! What may change in a scene whose run is taken further: a longer duration, more gauges, intervals of output, the camera.

use super::file::SceneFile;
use super::parse;

/// The text of a scene with all that may change in a run taken from the scene of the run so far.
///
/// Two scenes differ in nothing else if this is the text of the scene before. `None` where a text is no scene.
pub(crate) fn as_before(before: &str, now: &str) -> Option<String> {
    let (before, mut now) = (parse::read(before).ok()?, parse::read(now).ok()?);
    keep_changes(&before, &mut now);
    parse::write(&now).ok()
}

fn keep_changes(before: &SceneFile, now: &mut SceneFile) {
    if before.time.duration < now.time.duration {
        now.time.duration = before.time.duration;
    }
    // records of a gauge that is left out or moved would be lost
    if before.gauges.iter().all(|gauge| now.gauges.contains(gauge)) {
        now.gauges.clone_from(&before.gauges);
    }
    now.camera.clone_from(&before.camera);
    let (output, other) = (&mut now.output, &before.output);
    output.frame_interval = other.frame_interval;
    output.gauge_interval = other.gauge_interval;
    output.ledger_interval = other.ledger_interval;
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
