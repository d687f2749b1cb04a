//! Tables of forces on bodies: by source, and of water on their faces.

use std::collections::BTreeMap;
use std::path::Path;

use super::table::{Table, figure, heads, name_of, scaled, table_of};
use crate::files::table::TableData;
use crate::files::vtk::{PolyData, Values};
use crate::output::run_folder::{self, RunScene};
use crate::picture::render::recording::{collection, read};

/// Sources in `forces.csv`, and their names for a reader. Weight does not change.
const SOURCES: [(&str, &str); 7] = [
    ("pressure", "pressure of water"),
    ("shear", "friction of water"),
    ("joint_water", "water in joints"),
    ("pushed_back", "particles put back"),
    ("contact", "contacts"),
    ("attached", "attachments"),
    ("restrained", "what holds it"),
];
/// Bodies in a table, at most: those with the largest forces.
const MOST_BODIES: usize = 12;
/// Directions that a face may look to.
const FACING: [&str; 6] = ["−x", "+x", "−y", "+y", "down", "up"];

/// A force of largest size.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Largest {
    size: f64,
    /// s.
    time: f64,
    /// Components then.
    parts: [f64; 3],
}

impl Largest {
    fn join(&mut self, time: f64, parts: [f64; 3]) {
        let size = norm(parts);
        if self.size < size {
            *self = Self { size, time, parts };
        }
    }
}

fn norm(parts: [f64; 3]) -> f64 {
    parts.iter().map(|part| part * part).sum::<f64>().sqrt()
}

/// Largest forces on each body by source; `None` where they were not recorded.
pub(super) fn by_source(folder: &Path, names: &[String]) -> Option<Table> {
    let table = table_of(folder, run_folder::FORCES)?;
    let (ids, times) = (table.column("block").ok()?, table.column("time").ok()?);
    let mut bodies = BTreeMap::<i32, BTreeMap<usize, [Largest; 2]>>::new();
    for (place, (source, _)) in SOURCES.iter().enumerate() {
        let (Some(force), Some(moment)) = (three(&table, source, "f"), three(&table, source, "m"))
        else {
            continue;
        };
        for k in 0..ids.len() {
            let found = bodies.entry(ids[k] as i32).or_default().entry(place);
            let [f, m] = found.or_default();
            f.join(times[k], force.map(|part| part[k]));
            m.join(times[k], moment.map(|part| part[k]));
        }
    }
    let size = |sources: &BTreeMap<usize, [Largest; 2]>| {
        sources.values().map(|[f, _]| f.size).fold(0.0, f64::max)
    };
    let mut order: Vec<(i32, BTreeMap<usize, [Largest; 2]>)> = bodies.into_iter().collect();
    order.sort_by(|a, b| size(&b.1).total_cmp(&size(&a.1)).then(a.0.cmp(&b.0)));
    let n = order.len();
    order.truncate(MOST_BODIES);
    let all = || order.iter().flat_map(|(_, sources)| sources.values());
    let (force, newton) = scaled(all().map(|[f, _]| f.size), "N");
    let (moment, newton_meter) = scaled(all().map(|[_, m]| m.size), "N m");
    let mut rows = Vec::new();
    for (id, sources) in &order {
        for (place, [f, m]) in sources.iter().filter(|(_, [f, _])| 0.0 < f.size) {
            let mut row = vec![name_of(names, *id), SOURCES[*place].1.to_owned()];
            row.extend([figure(f.size / force), figure(f.time)]);
            row.extend(f.parts.map(|part| figure(part / force)));
            row.extend([figure(m.size / moment), figure(m.time)]);
            rows.push(row);
        }
    }
    let interval = times.windows(2).map(|pair| pair[1] - pair[0]);
    let interval = interval.fold(0.0, f64::max);
    let kept = match MOST_BODIES < n {
        true => format!(" The {MOST_BODIES} of {n} bodies with the largest forces are shown."),
        false => String::new(),
    };
    Some(Table {
        title: "Forces on bodies",
        head: heads(&[
            "body",
            "from",
            &format!("largest force, {newton}"),
            "at, s",
            "x then",
            "y then",
            "z then",
            &format!("largest moment, {newton_meter}"),
            "at, s",
        ]),
        rows,
        note: format!(
            "Means over {} s; moments about the centroid. All of them are in forces.csv.{kept}",
            figure(interval)
        ),
    })
}

fn three<'t>(table: &'t TableData, source: &str, kind: &str) -> Option<[&'t [f64]; 3]> {
    let part = |axis: &str| table.column(&format!("{source}_{kind}{axis}")).ok();
    let [x, y, z] = ["x", "y", "z"].map(part);
    Some([x?, y?, z?])
}

/// Water on the side of a body that looks in one direction.
#[derive(Clone, Copy, Debug, Default)]
struct Side {
    force: Largest,
    /// At the time of the largest force; m².
    wet: f64,
    /// Largest pressure on a tile (Pa) and its time (s).
    pressure: (f64, f64),
}

/// Largest forces of water on the sides of bodies; `None` where pressures on faces were not recorded.
pub(super) fn on_faces(folder: &Path, scene: &RunScene) -> Option<Table> {
    let frames = collection(&folder.join(format!("{}.pvd", run_folder::FACE_FRAMES))).ok()?;
    let mut sides = BTreeMap::<(i32, usize), Side>::new();
    for frame in &frames {
        join(&mut sides, &read(&frame.path).ok()?, frame.time, scene)?;
    }
    let mut order: Vec<((i32, usize), Side)> = sides.into_iter().collect();
    order.retain(|(_, side)| 0.0 < side.force.size);
    order.sort_by(|a, b| {
        b.1.force
            .size
            .total_cmp(&a.1.force.size)
            .then(a.0.cmp(&b.0))
    });
    let mut bodies: Vec<i32> = Vec::new();
    for ((id, _), _) in &order {
        if !bodies.contains(id) && bodies.len() < MOST_BODIES {
            bodies.push(*id);
        }
    }
    let (force, newton) = scaled(order.iter().map(|(_, side)| side.force.size), "N");
    let (pressure, pascal) = scaled(order.iter().map(|(_, side)| side.pressure.0), "Pa");
    let row = |((id, facing), side): &((i32, usize), Side)| {
        vec![
            name_of(&scene.block_names, *id),
            FACING[*facing].to_owned(),
            figure(side.force.size / force),
            figure(side.force.time),
            figure(side.wet),
            figure(side.force.size / side.wet.max(f64::MIN_POSITIVE) / pressure),
            figure(side.pressure.0 / pressure),
            figure(side.pressure.1),
        ]
    };
    let shown = |body: &i32| {
        let own = order.iter().filter(|((id, _), _)| id == body);
        own.map(row).collect::<Vec<_>>()
    };
    Some(Table {
        title: "Water on faces",
        head: heads(&[
            "body",
            "facing",
            &format!("largest force, {newton}"),
            "at, s",
            "wetted area then, m²",
            &format!("mean pressure then, {pascal}"),
            &format!("largest pressure, {pascal}"),
            "at, s",
        ]),
        rows: bodies.iter().flat_map(shown).collect(),
        note: "From the frames of pressures on faces; peaks between two frames are not in them. Faces are those that look in a direction at the time."
            .to_owned(),
    })
}

/// Adds a frame of tiles; `None` for arrays that are none of tiles.
fn join(
    sides: &mut BTreeMap<(i32, usize), Side>,
    data: &PolyData,
    time: f64,
    scene: &RunScene,
) -> Option<()> {
    let find = |name: &str| data.cell_data.iter().find(|array| array.name == name);
    let (Values::I32(ids), Values::F32(pressures)) =
        (&find("BlockId")?.values, &find("Pressure")?.values)
    else {
        return None;
    };
    let mut now = BTreeMap::<(i32, usize), ([f64; 3], f64)>::new();
    for ((corners, &id), &pressure) in data.polygons.iter().zip(ids).zip(pressures) {
        let block = usize::try_from(id).ok();
        if block.is_some_and(|b| scene.is_terrain.get(b) == Some(&true)) {
            continue;
        }
        let area = area_of(data, corners)?;
        let Some(facing) = facing(area) else { continue };
        let pressure = f64::from(pressure);
        let (force, wet) = now.entry((id, facing)).or_default();
        for (force, area) in force.iter_mut().zip(area) {
            *force -= pressure * area;
        }
        *wet += norm(area);
        let side = sides.entry((id, facing)).or_default();
        if side.pressure.0 < pressure {
            side.pressure = (pressure, time);
        }
    }
    for (key, (force, wet)) in now {
        let side = sides.entry(key).or_default();
        side.force.join(time, force);
        if side.force.time == time {
            side.wet = wet;
        }
    }
    Some(())
}

/// Area of a polygon times its normal; m².
fn area_of(data: &PolyData, corners: &[i32]) -> Option<[f64; 3]> {
    let place = |&k: &i32| data.points.get(k as usize).map(|x| x.map(f64::from));
    let places: Vec<[f64; 3]> = corners.iter().map(place).collect::<Option<_>>()?;
    let first = places.first()?;
    let less = |a: &[f64; 3]| [0, 1, 2].map(|k| a[k] - first[k]);
    let mut area = [0.0; 3];
    for pair in places.windows(2) {
        let (a, b) = (less(&pair[0]), less(&pair[1]));
        for (k, area) in area.iter_mut().enumerate() {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            *area += 0.5 * (a[i] * b[j] - a[j] * b[i]);
        }
    }
    Some(area)
}

/// Direction of the largest part of a normal.
fn facing(normal: [f64; 3]) -> Option<usize> {
    let axis = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs()))?;
    (normal[axis] != 0.0).then(|| 2 * axis + usize::from(0.0 < normal[axis]))
}
