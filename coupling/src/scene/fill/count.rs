//! Spacing for a wanted number of particles.

use std::cell::Cell;

use super::{Lattice, Room};
use crate::messages::Code;
use crate::scene::error::Problem;
use crate::scene::file::vec3;
use crate::scene::file::{DomainFile, FluidFile, RegionShapeFile};

/// Largest accepted deviation from the wanted count, which whole rows may not allow; –.
const TOLERANCE: f64 = 0.1;
/// Deviation at which the search ends; –.
const GOOD: f64 = 0.005;
/// Trial fills of the search by bisection.
const ATTEMPTS: usize = 20;
/// Spacings tried on either side of the best one, and their distance: rows come and go one by one, in different
/// directions at different spacings, so that bisection misses spacings that a comb finds.
const NEIGHBORS: i32 = 30;
const COMB: f64 = 0.0017;
/// Refinement where the first guess finds no room; × first guess, three times.
const REFINEMENT: f64 = 0.7;

/// Spacing whose fill has the wanted number of particles; m.
pub(super) fn spacing(
    fluid: &FluidFile,
    domain: &DomainFile,
    (count, room): (u32, Room),
    fill: impl Fn(f64) -> Result<Lattice, Vec<Problem>>,
) -> Result<f64, Vec<Problem>> {
    let wanted = f64::from(count);
    let n_of = |lattice: &Lattice| lattice.positions.len() as f64;
    let miss = |lattice: &Lattice| (n_of(lattice) / wanted - 1.0).abs();
    room.holds(wanted).map_err(|error| {
        vec![Problem::error(
            error.code(),
            "fluid.resolution",
            format!("fluid {error}"),
        )]
    })?;
    let volume = largest_volume(fluid, domain);
    let guess = (volume / wanted).cbrt();
    // all fills together look at no more nodes than one may
    let looked = Cell::new(0.0);
    let fill = |spacing: f64| {
        let particle: f64 = super::spacings(fluid, domain, spacing).iter().product();
        looked.set(looked.get() + volume / particle);
        fill(spacing)
    };
    let may_look = || looked.get() < room.nodes();
    let (mut spacing, mut best) = first_fill(guess, fill)?;
    let (mut coarse, mut fine) = (f64::INFINITY, 0.0);
    let (mut found, mut center) = (n_of(&best), spacing);
    for _ in 0..ATTEMPTS {
        if miss(&best) <= GOOD || !may_look() {
            break;
        }
        if found < wanted {
            coarse = spacing;
        } else {
            fine = spacing;
        }
        // the count falls with the cube of the spacing; where that leaves the bracket, halve it
        let next = spacing * (found.max(1.0) / wanted).cbrt();
        let is_bracketed = coarse.is_finite() && fine > 0.0;
        let margin = 0.1 * (coarse - fine);
        spacing = if !is_bracketed || (next > fine + margin && next < coarse - margin) {
            next
        } else {
            0.5 * (fine + coarse)
        };
        // what has no room at this spacing holds no particles
        found = match fill(spacing) {
            Ok(lattice) => {
                let n = n_of(&lattice);
                if miss(&lattice) < miss(&best) {
                    (best, center) = (lattice, spacing);
                }
                n
            }
            Err(_) => 0.0,
        };
    }
    let mut chosen = center;
    for k in (1..=NEIGHBORS).flat_map(|k| [-k, k]) {
        if miss(&best) <= GOOD || !may_look() {
            break;
        }
        let near = center * (1.0 + f64::from(k) * COMB);
        if let Some(lattice) = fill(near).ok().filter(|found| miss(found) < miss(&best)) {
            (best, chosen) = (lattice, near);
        }
    }
    if miss(&best) <= TOLERANCE {
        return Ok(chosen);
    }
    let message = format!(
        "no spacing gives {count} particles within 10 %; the nearest is {}; ask for that, or give a spacing",
        best.positions.len()
    );
    Err(vec![Problem::error(
        Code::SpacingMisfit,
        "fluid.resolution",
        message,
    )])
}

/// First successful fill, from the guess downward; m.
fn first_fill(
    guess: f64,
    fill: impl Fn(f64) -> Result<Lattice, Vec<Problem>>,
) -> Result<(f64, Lattice), Vec<Problem>> {
    let first = match fill(guess) {
        Ok(lattice) => return Ok((guess, lattice)),
        Err(problems) => problems,
    };
    (1..=3)
        .map(|k| guess * REFINEMENT.powi(k))
        .find_map(|spacing| fill(spacing).ok().map(|lattice| (spacing, lattice)))
        .ok_or(first)
}

/// Upper bound of the volume of the regions; m³.
fn largest_volume(fluid: &FluidFile, domain: &DomainFile) -> f64 {
    let (low, high) = (vec3(domain.min), vec3(domain.max));
    let of_region = |shape: &RegionShapeFile| match shape {
        RegionShapeFile::Box { min, max } => (vec3(*max) - vec3(*min)).product(),
        RegionShapeFile::Below { level, .. } => {
            (high.x - low.x) * (high.y - low.y) * (level - low.z)
        }
    };
    fluid.regions.iter().map(|r| of_region(&r.shape)).sum()
}
