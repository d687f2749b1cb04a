//! Checks of absorbers, inflows and outflows.

use super::checks::Checks;
use crate::messages::Code;
use crate::scene::file::{DimensionsFile, SceneFile, SideFile, Triple};

/// Common fields of absorbers, inflows and outflows.
struct Opening {
    path: String,
    what: String,
    extent: (Triple, Triple),
    towards: SideFile,
    /// Directions: an absorber may face the top or the bed, an inflow or outflow may not.
    is_absorber: bool,
}

impl Checks {
    pub(super) fn openings(&mut self, scene: &SceneFile) {
        for opening in all_openings(scene) {
            self.opening(&opening, scene);
        }
        for (index, absorber) in scene.absorbers.iter().enumerate() {
            let what = format!("absorber `{}`: rate", absorber.name);
            self.positive(format!("absorbers[{index}].rate"), &what, absorber.rate);
        }
        for (index, inflow) in scene.inflows.iter().enumerate() {
            let path = format!("inflows[{index}]");
            let what = format!("inflow `{}`", inflow.name);
            if inflow.velocity.is_empty() == inflow.discharge.is_empty() {
                self.refuse(
                    Code::IncompatibleOptions,
                    &path,
                    format!("{what}: give either velocity or discharge, as [(time, value), ...]"),
                );
            }
            let any = f64::INFINITY;
            let height = inflow.max.2 - inflow.min.2;
            for (column, rows, most) in [
                ("velocity", &inflow.velocity, any),
                ("discharge", &inflow.discharge, any),
                ("depth", &inflow.depth, height),
            ] {
                self.series(&format!("{path}.{column}"), &what, rows, most);
            }
        }
        for (index, outflow) in scene.outflows.iter().enumerate() {
            let path = format!("outflows[{index}].depth");
            let what = format!("outflow `{}`", outflow.name);
            let height = outflow.max.2 - outflow.min.2;
            self.series(&path, &what, &outflow.depth, height);
        }
        self.unique("absorbers", scene.absorbers.iter().map(|a| a.name.as_str()));
        self.unique("inflows", scene.inflows.iter().map(|i| i.name.as_str()));
        self.unique("outflows", scene.outflows.iter().map(|o| o.name.as_str()));
        if 0.0 < scene.time.settle && !(scene.inflows.is_empty() && scene.outflows.is_empty()) {
            self.refuse(
                Code::IncompatibleOptions,
                "time.settle",
                "time: water that flows in or out does not settle; leave settle out".to_owned(),
            );
        }
    }

    fn opening(&mut self, opening: &Opening, scene: &SceneFile) {
        let Opening {
            path,
            what,
            extent,
            towards,
            is_absorber,
        } = opening;
        self.extent(path, what, *extent);
        if scene.fluid.is_none() {
            self.refuse(
                Code::NeedsWater,
                path,
                format!("{what} needs water; add `fluid` or leave it out"),
            );
        }
        let is_plane = scene.domain.dimensions == DimensionsFile::Two;
        let (axis, _) = towards.axis();
        if axis == 2 && !is_absorber || axis == 1 && is_plane {
            self.refuse(
                Code::UnusableOpening,
                format!("{path}.towards"),
                format!("{what}: water cannot go to {towards:?} here; choose XMin or XMax, or in space YMin or YMax"),
            );
        }
    }

    /// Check of rows of time and value: times increase, values are from 0 to `most`.
    fn series(&mut self, path: &str, what: &str, rows: &[(f64, f64)], most: f64) {
        for (k, &(time, value)) in rows.iter().enumerate() {
            if k > 0 && !(rows[k - 1].0 < time) {
                self.refuse(
                    Code::ValuesOutOfOrder,
                    format!("{path}[{k}]"),
                    format!(
                        "{what}: times must increase, found {time} s after {} s",
                        rows[k - 1].0
                    ),
                );
            }
            if !(0.0..=most).contains(&value) {
                self.refuse(
                    Code::ValueOutOfRange,
                    format!("{path}[{k}]"),
                    format!("{what}: must be in [0, {most}], found {value}"),
                );
            }
        }
    }
}

fn all_openings(scene: &SceneFile) -> Vec<Opening> {
    let absorbers = scene.absorbers.iter().enumerate().map(|(k, a)| Opening {
        path: format!("absorbers[{k}]"),
        what: format!("absorber `{}`", a.name),
        extent: (a.min, a.max),
        towards: a.towards,
        is_absorber: true,
    });
    let inflows = scene.inflows.iter().enumerate().map(|(k, i)| Opening {
        path: format!("inflows[{k}]"),
        what: format!("inflow `{}`", i.name),
        extent: (i.min, i.max),
        towards: i.towards,
        is_absorber: false,
    });
    let outflows = scene.outflows.iter().enumerate().map(|(k, o)| Opening {
        path: format!("outflows[{k}]"),
        what: format!("outflow `{}`", o.name),
        extent: (o.min, o.max),
        towards: o.towards,
        is_absorber: false,
    });
    absorbers.chain(inflows).chain(outflows).collect()
}
