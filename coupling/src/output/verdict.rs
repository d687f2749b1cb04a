//! Verdict of a run in three lines: whether its account of energy closes, how well it resolves what it shows, and what to look at.

use serde_json::Value;

use crate::messages::Code;

/// Grade of an account of energy that does not close.
const POOR: &str = "poor: refine, or take smaller steps, before you use its numbers";
/// Beginning of the line of doubts.
const TO_LOOK_AT: &str = "to look at: ";
/// Its words without a doubt.
const NOTHING: &str = "nothing stands out";

/// Share of the energy exchanged, unexplained, introduced at walls or lost by particles put back, up to which an account is good, and
/// up to which it is fair: chosen, so that speeds and run-up, which go with the root of an energy, are within 1 and 5 %.
const GOOD: f64 = 0.02;
const FAIR: f64 = 0.1;
/// Energy exchanged, over what is stored, below which hardly anything moved: that of waves of 0.3 % of the depth.
const STILL: f64 = 1e-5;
/// Energy unexplained, introduced at walls or lost, over what is stored, below which water at rest is taken to be so: that by which its
/// level is known to 0.005 %.
const AT_REST: f64 = 1e-4;
/// By height in spacings, with the default: loss per wave length of a train of waves in a plane, percent; share of the height that
/// standing waves keep over eight periods, in a plane and in space (smoothing length 1.3 times the spacing). Measured,
/// `benches/RESULTS.md`. In a plane standing waves leave most particles on their lattice, which trains do not.
const KEPT: [(f64, f64, f64, f64); 3] = [
    (10.0, 1.4, 0.95, 0.61),
    (5.0, 2.7, 0.90, 0.52),
    (3.0, 4.3, 0.70, 0.45),
];
/// Mach number of a particle above which pressures of impacts are those of sound.
pub const LARGEST_MACH: f64 = 0.3;
/// Particles pushed back over those there are, above which bodies close water in, or move too fast for it.
const MANY_PUSHED_BACK: f64 = 0.05;

/// A finding in words, with its code where it is a doubt.
type Finding = (Option<Code>, String);

/// The three lines of a run's `summary.json`.
pub fn verdict(summary: &Value) -> [String; 3] {
    [
        account(summary).1,
        resolution(summary).1,
        to_look_at(&points(summary)),
    ]
}

/// Whether a line of a verdict asks for a look at the run before its numbers are used.
pub fn is_doubt(line: &str) -> bool {
    let doubts = line.strip_prefix(TO_LOOK_AT);
    doubts.is_some_and(|words| !words.starts_with(NOTHING)) || line.contains(POOR)
}

/// Codes of the doubts in the three lines.
pub fn doubts(summary: &Value) -> Vec<Code> {
    [account(summary), resolution(summary)]
        .into_iter()
        .chain(points(summary))
        .filter_map(|(code, _)| code)
        .collect()
}

fn number(value: &Value, path: &[&str]) -> f64 {
    let found = path.iter().try_fold(value, |value, name| value.get(name));
    found.and_then(Value::as_f64).unwrap_or(0.0)
}

fn account(summary: &Value) -> Finding {
    let term = |name: &str| number(summary, &["energy", name]);
    // all that moved from one kind of energy to another
    let exchanged: f64 = [
        "kinetic",
        "friction",
        "viscous",
        "bulk",
        "drag",
        "diffusive",
        "damping",
        "strain_damping",
        "static_damping",
        "plastic",
        "removed",
        "absorbed",
        "external_work",
    ]
    .iter()
    .map(|name| term(name).abs())
    .sum();
    let (unexplained, at_walls, at_grains) =
        (term("residual"), term("at_walls"), term("at_grains"));
    let wrong = unexplained.abs() + at_walls.abs() + at_grains.abs() + term("pushed_back").abs();
    let stored = term("potential").abs() + term("internal").abs();
    // densities that even out are no motion
    let moved = exchanged - term("diffusive").abs();
    if moved <= STILL * stored && wrong <= AT_REST * stored {
        let words = format!(
            "energy: nothing moved to speak of, {wrong:.2e} J unexplained or introduced at walls"
        );
        return (None, words);
    }
    let share = wrong / exchanged.max(f64::MIN_POSITIVE);
    let grade = match share {
        share if share <= GOOD => "good",
        share if share <= FAIR => "fair: speeds and run-up may be off by half of that share",
        _ => POOR,
    };
    let of_grains = match at_grains == 0.0 {
        true => String::new(),
        false => format!(", {:.1} % at grains", 100.0 * at_grains.abs() / exchanged),
    };
    let words = format!(
        "energy: of {} exchanged {:.1} % are unexplained, {:.1} % introduced at walls{of_grains}, {:.1} % lost by particles put back: {grade}",
        joules(exchanged),
        100.0 * unexplained.abs() / exchanged,
        100.0 * at_walls.abs() / exchanged,
        100.0 * term("pushed_back").abs() / exchanged,
    );
    ((GOOD < share).then_some(Code::EnergyAccount), words)
}

/// An energy (J) with the prefix that suits it.
fn joules(energy: f64) -> String {
    let prefixes = [
        (1e12, "TJ"),
        (1e9, "GJ"),
        (1e6, "MJ"),
        (1e3, "kJ"),
        (1.0, "J"),
        (1e-3, "mJ"),
    ];
    match prefixes.iter().find(|(unit, _)| *unit <= energy) {
        Some((unit, name)) => format!("{:.3} {name}", energy / unit),
        None => format!("{energy:.1e} J"),
    }
}

fn resolution(summary: &Value) -> Finding {
    let spacing = number(summary, &["particle_spacing"]);
    if number(summary, &["fluid_particles"]) == 0.0 || spacing <= 0.0 {
        let is_solved = summary
            .get("contact_solution")
            .is_some_and(Value::is_object);
        let step = match is_solved {
            true => "`time_step` of numerics.blocks",
            false => "numerics.block_time_step_factor",
        };
        let words =
            format!("resolution: blocks without water; halve {step} to see what the step changes");
        return (None, words);
    }
    let gauges = summary.get("gauges").and_then(Value::as_array);
    let rises = gauges.into_iter().flatten().filter_map(|gauge| {
        let is_surface = gauge.get("unit")? == "m";
        let rise = gauge.get("largest")?.as_f64()? - gauge.get("start")?.as_f64()?;
        is_surface.then_some((rise / spacing, gauge.get("name")?.as_str()?))
    });
    let Some((rise, name)) = rises.max_by(|a, b| a.0.total_cmp(&b.0)) else {
        let words = format!(
            "resolution: spacing {spacing:.4} m, no gauge of the surface to compare it with; compare with a run of 0.7 times the spacing"
        );
        return (None, words);
    };
    let kept = KEPT.iter().find(|(height, ..)| *height <= rise);
    let words = match kept {
        Some((height, lost, plane, space)) => format!(
            "with the default, waves {height:.0} spacings high lose {lost:.1} % of their height per wave length in a plane; standing, they keep {plane:.2} of it over eight periods, {space:.2} in space"
        ),
        None => {
            "a wave below three spacings is an indication only; refine to use its height".to_owned()
        }
    };
    let words =
        format!("resolution: the largest rise, at `{name}`, is {rise:.1} spacings; {words}");
    (kept.is_none().then_some(Code::WaveUnresolved), words)
}

/// What stands out in a run.
fn points(summary: &Value) -> Vec<Finding> {
    let count = |name: &str| number(summary, &[name]);
    let mut points = Vec::new();
    if summary.get("completed").and_then(Value::as_bool) == Some(false) {
        let reason = summary
            .get("stop_reason")
            .and_then(Value::as_str)
            .unwrap_or("it was stopped");
        let first = reason.lines().next().unwrap_or(reason);
        points.push((None, format!("the run did not reach its end ({first})")));
    }
    let particles = count("fluid_particles");
    for (code, n, one, many) in [
        (
            Code::StepRepeated,
            count("fell_back"),
            "step failed and was repeated with half its length",
            "steps failed and were repeated with half their length",
        ),
        (
            Code::LeftDomain,
            count("particles_escaped"),
            "particle left the domain",
            "particles left the domain",
        ),
        (
            Code::LeftDomain,
            count("blocks_escaped"),
            "block left the domain",
            "blocks left the domain",
        ),
        (
            Code::ParticlesCrushed,
            count("reliefs"),
            "particle was crushed between solids and let go",
            "times particles were crushed between solids and let go",
        ),
    ] {
        if 0.0 < n {
            let words = format!("{n} {}", if n == 1.0 { one } else { many });
            points.push((Some(code), words));
        }
    }
    if MANY_PUSHED_BACK * particles < count("particles_pushed_back") {
        let words = format!(
            "{} times particles were put back in front of a wall",
            count("particles_pushed_back")
        );
        points.push((Some(Code::ParticlesCrushed), words));
    }
    if LARGEST_MACH < count("max_mach") {
        let words = format!(
            "the fastest particle reached Mach {:.2}: peak pressures are those of sound",
            count("max_mach")
        );
        points.push((Some(Code::WaterNearSoundSpeed), words));
    }
    let ambiguous = number(summary, &["contact_solution", "most_above_painleve"]);
    if 0.0 < ambiguous {
        let words = format!(
            "up to {ambiguous} contacts in a step bore with a friction above Painlevé's limit, where more than one impulse may obey the laws"
        );
        points.push((Some(Code::FrictionAbovePainleve), words));
    }
    points
}

fn to_look_at(points: &[Finding]) -> String {
    let words: Vec<&str> = points.iter().map(|(_, words)| words.as_str()).collect();
    match points.is_empty() {
        true => format!("{TO_LOOK_AT}{NOTHING}; overview.svg and gauges.csv"),
        false => format!("{TO_LOOK_AT}{}", words.join("; ")),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_good_run_is_called_good_and_a_bad_one_bad() {
        let run = |residual: f64, rise: f64, escaped: u64| {
            verdict(&json!({
                "completed": true, "fluid_particles": 1000, "particle_spacing": 0.1, "particles_escaped": escaped,
                "energy": {"kinetic": 40.0, "viscous": 60.0, "potential": 1e4, "residual": residual, "at_walls": -0.5},
                "gauges": [{"name": "far", "unit": "m", "start": 1.0, "largest": 1.0 + rise},
                           {"name": "load", "unit": "N", "start": 0.0, "largest": 1e6}],
            }))
        };
        let good = run(0.5, 0.6, 0);
        assert!(
            good[0].ends_with("0.5 % introduced at walls, 0.0 % lost by particles put back: good"),
            "{}",
            good[0]
        );
        assert!(
            good[1].contains(
                "`far`, is 6.0 spacings; with the default, waves 5 spacings high lose 2.7 % of their height per wave length in a plane; standing, they keep 0.90"
            ),
            "{}",
            good[1]
        );
        assert!(good[2].contains("nothing stands out"), "{}", good[2]);
        let bad = run(-30.0, 0.1, 1);
        assert!(
            bad[0].contains("30.0 % are unexplained") && bad[0].contains("poor"),
            "{}",
            bad[0]
        );
        assert!(bad[1].contains("an indication only"), "{}", bad[1]);
        assert!(
            bad[2].ends_with("to look at: 1 particle left the domain"),
            "{}",
            bad[2]
        );
        let rough = verdict(&json!({"contact_solution": {"most_above_painleve": 2}}));
        assert!(
            rough[2].contains("up to 2 contacts in a step bore with a friction above Painlevé's"),
            "{}",
            rough[2]
        );
        let still = verdict(
            &json!({"fluid_particles": 9, "particle_spacing": 0.1, "energy": {"potential": 1e6, "kinetic": 0.1}}),
        );
        assert!(still[0].contains("nothing moved"), "{}", still[0]);
        // 0.2 s of a still tank
        let settling = json!({"potential": 18240.2, "internal": 84.5, "kinetic": 0.0161, "diffusive": -0.2197, "at_walls": -0.1905});
        let settling =
            verdict(&json!({"fluid_particles": 9, "particle_spacing": 0.1, "energy": settling}));
        assert!(
            settling[0].contains("nothing moved") && settling[0].contains("1.91e-1 J"),
            "{}",
            settling[0]
        );
    }
}
