//! Walls at the longest stable step: nothing passes them, however fast it comes or however long it tries.

use std::collections::{HashMap, VecDeque};

use super::plates::column;
use super::*;

/// The whole stable step, and a smoothing length that differs in its last digits: another draw of the same chaos.
fn at_the_whole_step(mut case: Case, draw: u32) -> Case {
    let more = 10_f64.powf(-8.0 + 4.0 * f64::from(draw) / 200.0);
    case.more[2] = format!(
        "time_step_factor: 1.0, smoothing_length_ratio: {:?}",
        1.3 * (1.0 + more)
    );
    case
}

/// Particles that a floor with a crack lets through in 0.3 s.
fn through_a_crack(walls: &'static str, draw: u32) -> usize {
    let case = at_the_whole_step(column(walls, 4.0, 50), draw);
    let dp = case.spacing;
    let mut world = case.world();
    let trace = std::env::var("TRACE").is_ok();
    let mut past: HashMap<u32, VecDeque<String>> = HashMap::new();
    let mut told: Vec<u32> = Vec::new();
    while world.time() < 0.3 {
        let step = world.next_step(0.3).unwrap();
        world.step(step).unwrap();
        if trace {
            let fluid = &world.water.as_ref().unwrap().fluid;
            let p = fluid.particles();
            for a in 0..p.len() {
                let x = p.position[a];
                let off = (x.x - 3.0 * dp) / dp;
                if off.abs() < 1.0 && x.z < 1.2 * dp {
                    let id = u32::from(p.id[a]);
                    let lines = past.entry(id).or_default();
                    lines.push_back(format!(
                        "  step {} dt {:.3e} off middle {off:+.4} y {:.3} z {:+.4} dp | v {:+.4?} m/s = {:+.4} dp a step | a {:+.3e} g | p {:.0} Pa | to one {:+.4} to two {:+.4} dp",
                        world.clock().steps, step.dt, x.y / dp, x.z / dp,
                        p.velocity[a].as_slice(), p.velocity[a].z * step.dt / dp,
                        p.acceleration[a].z / G, p.pressure[a],
                        world.blocks.surface_point_within(0, &x, 1.0).unwrap().distance / dp,
                        world.blocks.surface_point_within(1, &x, 1.0).unwrap().distance / dp,
                    ));
                    if 30 < lines.len() {
                        lines.pop_front();
                    }
                    if x.z < -0.5 * dp && !told.contains(&id) {
                        told.push(id);
                        println!("draw {draw} {walls} particle {id}");
                        lines.iter().for_each(|line| println!("{line}"));
                    }
                }
            }
        }
    }
    let fluid = &world.water.as_ref().unwrap().fluid;
    let positions = &fluid.particles().position;
    let below = positions.iter().filter(|x| x.z < -0.5 * dp).count();
    let count = below + fluid.removed().count as usize;
    println!(
        "crack {walls:9} draw {draw:3}: {count} through, put back {} in {} steps",
        world.extremes().particles_pushed_back,
        world.clock().steps
    );
    count
}

#[test]
#[ignore = "a report"]
fn report_of_draws() {
    let number =
        |name: &str, other: u32| std::env::var(name).map_or(other, |text| text.parse().unwrap());
    let (from, to, by) = (number("FROM", 0), number("TO", 200), number("BY", 1));
    let walls = if std::env::var("WALLS").is_ok_and(|w| w == "Integral") {
        "Integral"
    } else {
        "Particles"
    };
    let mut leaky = 0;
    let mut n = 0;
    for draw in (from..to).step_by(by as usize) {
        n += 1;
        leaky += u32::from(0 < through_a_crack(walls, draw));
    }
    println!("{walls}: {leaky} of {n} draws leak");
}
