//! Impulse wave expected of a slide, by formulas fitted to experiments: the scales that the water has to resolve.

use riprap_dda::Vec3;

use super::geometry::terrain::Rock;
use super::resolved::Scene;

/// Parameters of a slide at impact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlideImpact {
    /// Speed; m/s.
    pub speed: f64,
    /// Mean thickness above the failure surface; m.
    pub thickness: f64,
    /// Width across the direction of motion; m.
    pub width: f64,
    /// Volume; m³.
    pub volume: f64,
    /// Slope of the failure surface; rad.
    pub slope: f64,
    /// Density of the rock over that of water; –.
    pub relative_density: f64,
    /// Still-water depth; m.
    pub depth: f64,
    /// Acceleration of gravity; m/s².
    pub gravity: f64,
}

impl SlideImpact {
    /// Impact of a slide that starts from rest, descends until its center of mass is at the water level, and is slowed by its
    /// friction. `None` without water or gravity, and for slides held by friction or starting below the water.
    ///
    /// ```text
    /// v = √(2 g Δz (1 − tan δ/tan α))         Evers et al. (2019), VAW-Mitteilung 254        [m/s]
    /// ```
    pub fn of(rock: &Rock, scene: &Scene) -> Option<Self> {
        let fluid = scene.fluid.as_ref()?;
        let gravity = scene.block_settings.gravity.norm();
        let bed = rock.bed();
        let up = -bed.try_normalize(0.0)?;
        let along = rock.downhill(1e-6)?;
        let slope = up.z.clamp(-1.0, 1.0).acos();
        let across = Vec3::z().cross(&along);
        let places = rock.bodies.iter().flat_map(|body| body.vertices());
        let (least, most) = places
            .map(|x| across.dot(x))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
                (a.min(x), b.max(x))
            });
        let level = fluid.lattice.still_water_level;
        let drop = rock.center().z - level;
        let share = 1.0 - friction_below(rock, scene)? / slope.tan();
        let speed = (2.0 * gravity * drop * share).max(0.0).sqrt();
        let density = scene.materials.get(rock.material?)?.density;
        (0.0 < speed).then_some(Self {
            speed,
            thickness: rock.volume / bed.norm(),
            width: most - least,
            volume: rock.volume,
            slope,
            relative_density: density / fluid.settings.reference_density,
            depth: fluid.lattice.depth,
            gravity,
        })
    }

    /// Impulse product parameter.
    ///
    /// ```text
    /// P = F S^½ M^¼ √cos(6α/7),   F = v/√(g h),   S = s/h,   M = ρ_s V/(ρ_w b h²)       Heller & Hager (2010)   [–]
    /// ```
    pub fn impulse_product(&self) -> f64 {
        let Self { depth: h, .. } = *self;
        let froude = self.speed / (self.gravity * h).sqrt();
        let mass = self.relative_density * self.volume / (self.width * h * h);
        froude
            * (self.thickness / h).sqrt()
            * mass.powf(0.25)
            * (6.0 / 7.0 * self.slope).cos().sqrt()
    }

    /// Height of the first crest over the still water, of waves that spread out from a slide narrower than the basin; m.
    ///
    /// ```text
    /// a/h = 0.2 P^½ (b/h)^¾ cos^¼(6α/7)                  Evers et al. (2019), VAW-Mitteilung 254
    /// ```
    pub fn first_crest(&self) -> f64 {
        let turned = (6.0 / 7.0 * self.slope).cos().powf(0.25);
        let width = (self.width / self.depth).powf(0.75);
        0.2 * self.impulse_product().sqrt() * width * turned * self.depth
    }
}

impl Rock {
    /// Area vector of the surface of failure; m².
    pub fn bed(&self) -> Vec3 {
        self.bodies.iter().map(bed_area).sum()
    }

    /// Direction in plan view in which the surface of failure dips, if the sine of its slope is above a limit.
    pub fn downhill(&self, least: f64) -> Option<Vec3> {
        let up = -self.bed().try_normalize(0.0)?;
        Vec3::new(up.x, up.y, 0.0).try_normalize(least)
    }

    /// Center of mass; m.
    pub fn center(&self) -> Vec3 {
        let masses = self.bodies.iter().map(riprap_dda::mass_properties);
        let moment: Vec3 = masses.map(|m| m.volume * m.centroid).sum();
        moment / self.volume
    }
}

/// Area vector of the downward faces; m².
fn bed_area(body: &riprap_dda::Polyhedron) -> Vec3 {
    /// Faces steeper than this are walls, not bed: sine of 6 degrees.
    const WALL: f64 = 0.1;
    let areas = (0..body.n_faces()).map(|face| {
        let corners: Vec<Vec3> = body
            .face_vertices(face)
            .map(|v| body.vertices()[v as usize])
            .collect();
        let fan = corners.windows(2).map(|pair| {
            let first = corners[0];
            0.5 * (pair[0] - first).cross(&(pair[1] - first))
        });
        fan.sum::<Vec3>()
    });
    areas.filter(|area| area.z < -WALL * area.norm()).sum()
}

/// Tangent of the friction angle between a slide and the terrain, after all weakening.
fn friction_below(rock: &Rock, scene: &Scene) -> Option<f64> {
    let of_slide = rock.material?;
    let of_terrain = scene.terrain.as_ref()?.material?;
    let pair = |(a, b): (usize, usize)| {
        (a, b) == (of_slide, of_terrain) || (b, a) == (of_slide, of_terrain)
    };
    let joint = scene.joints.iter().find(|joint| pair(joint.materials));
    let own = |m: usize| scene.materials[m].friction_angle.tan();
    let tangent = joint
        .and_then(|joint| joint.friction_angle)
        .map_or_else(|| own(of_slide).min(own(of_terrain)), f64::tan);
    let weakening = scene.weakenings.iter().find(|w| pair(w.materials));
    let share = weakening.map_or(1.0, |w| w.friction.at(f64::INFINITY));
    Some(tangent * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The worked example of the manual of ETH Zurich on impulse waves: P = 0.64, first crest 14.4 m, as printed.
    #[test]
    fn the_example_of_the_manual_comes_out() {
        let slide = SlideImpact {
            speed: 58.0,
            thickness: 12.0,
            width: 100.0,
            volume: 220_000.0,
            slope: 40.0_f64.to_radians(),
            relative_density: 1.7,
            depth: 80.0,
            gravity: 9.81,
        };
        // to the digits printed
        assert!((slide.impulse_product() - 0.64).abs() < 0.005);
        assert!((slide.first_crest() - 14.4).abs() < 0.05);
    }
}
