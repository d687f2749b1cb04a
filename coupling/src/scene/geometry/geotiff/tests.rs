//! Files made byte by byte from the TIFF 6.0 and GeoTIFF 1.1 specifications.
#![expect(clippy::unwrap_used, reason = "a test may fail")]

use super::keys::{
    LINEAR_UNITS, MODEL_TYPE, PIXEL_IS_AREA, PIXEL_IS_POINT, PROJECTED, PROJECTED_SYSTEM,
    RASTER_TYPE,
};
use super::*;
use crate::scene::geometry::crs::Crs;

/// Order of bytes.
#[derive(Clone, Copy, PartialEq)]
enum Order {
    Little,
    Big,
}

impl Order {
    fn u16(self, value: u16) -> [u8; 2] {
        match self {
            Self::Little => value.to_le_bytes(),
            Self::Big => value.to_be_bytes(),
        }
    }

    fn u32(self, value: u32) -> [u8; 4] {
        match self {
            Self::Little => value.to_le_bytes(),
            Self::Big => value.to_be_bytes(),
        }
    }

    fn f64(self, value: f64) -> [u8; 8] {
        match self {
            Self::Little => value.to_le_bytes(),
            Self::Big => value.to_be_bytes(),
        }
    }
}

/// A field of a directory: number, type of TIFF 6.0 and its values as bytes.
struct Field(u16, u16, Vec<u8>);

/// Size of a value of a type: text, 16 bits, 32 bits, double.
fn size(kind: u16) -> usize {
    match kind {
        2 => 1,
        3 => 2,
        4 => 4,
        _ => 8,
    }
}

/// An image of one band, in one strip or in tiles.
struct Image {
    order: Order,
    /// Columns and rows.
    n: [u16; 2],
    bits: u16,
    /// 1 unsigned, 2 signed, 3 float.
    format: u16,
    tile: Option<u16>,
    /// Bytes of the strip or of each tile.
    chunks: Vec<Vec<u8>>,
    fields: Vec<Field>,
}

impl Image {
    fn shorts(&self, number: u16, values: &[u16]) -> Field {
        let bytes = values.iter().flat_map(|v| self.order.u16(*v)).collect();
        Field(number, 3, bytes)
    }

    fn doubles(&self, number: u16, values: &[f64]) -> Field {
        let bytes = values.iter().flat_map(|v| self.order.f64(*v)).collect();
        Field(number, 12, bytes)
    }

    fn longs(&self, number: u16, values: impl Iterator<Item = u32>) -> Field {
        Field(number, 4, values.flat_map(|v| self.order.u32(v)).collect())
    }

    fn placed(mut self, scale: [f64; 2], at: [f64; 2]) -> Self {
        let scale = self.doubles(33_550, &[scale[0], scale[1], 0.0]);
        let tie = self.doubles(33_922, &[0.0, 0.0, 0.0, at[0], at[1], 0.0]);
        self.fields.extend([scale, tie]);
        self
    }

    fn with_keys(mut self, keys: &[[u16; 2]]) -> Self {
        let mut entries = vec![1, 1, 0, keys.len() as u16];
        entries.extend(keys.iter().flat_map(|[key, value]| [*key, 0, 1, *value]));
        let field = self.shorts(34_735, &entries);
        self.fields.push(field);
        self
    }

    fn with_no_data(mut self, text: &str) -> Self {
        self.fields
            .push(Field(42_113, 2, format!("{text}\0").into_bytes()));
        self
    }

    /// Header, chunks, then the directory with its longer values.
    fn bytes(mut self) -> Vec<u8> {
        let order = self.order;
        let sizes: Vec<u32> = self.chunks.iter().map(|c| c.len() as u32).collect();
        let starts: Vec<u32> = (0..sizes.len())
            .map(|k| 8 + sizes[..k].iter().sum::<u32>())
            .collect();
        let (start_tag, size_tag) = if self.tile.is_some() {
            (324, 325)
        } else {
            (273, 279)
        };
        let mut fields = vec![
            self.shorts(256, &self.n[..1]),
            self.shorts(257, &self.n[1..]),
            self.shorts(258, &[self.bits]),
            self.shorts(259, &[1]),
            self.shorts(262, &[1]),
            self.shorts(277, &[1]),
            self.shorts(339, &[self.format]),
            self.longs(start_tag, starts.into_iter()),
            self.longs(size_tag, sizes.into_iter()),
        ];
        match self.tile {
            Some(side) => {
                fields.extend([self.shorts(322, &[side]), self.shorts(323, &[side])]);
            }
            None => fields.push(self.shorts(278, &self.n[1..])),
        }
        fields.append(&mut self.fields);
        fields.sort_by_key(|field| field.0);
        let mut file = match order {
            Order::Little => b"II".to_vec(),
            Order::Big => b"MM".to_vec(),
        };
        file.extend(order.u16(42));
        let directory = 8 + self.chunks.iter().map(Vec::len).sum::<usize>();
        file.extend(order.u32(directory as u32));
        file.extend(self.chunks.concat());
        let mut beyond = directory + 2 + 12 * fields.len() + 4;
        let mut longer: Vec<u8> = Vec::new();
        file.extend(order.u16(fields.len() as u16));
        for Field(number, kind, values) in &fields {
            file.extend(order.u16(*number));
            file.extend(order.u16(*kind));
            file.extend(order.u32((values.len() / size(*kind)) as u32));
            if values.len() <= 4 {
                file.extend(values);
                file.extend(vec![0; 4 - values.len()]);
            } else {
                file.extend(order.u32(beyond as u32));
                beyond += values.len();
                longer.extend(values);
            }
        }
        file.extend([0; 4]);
        file.extend(longer);
        file
    }
}

/// Three columns and two rows: 5 6 −9999 in the north, 1 2 3 in the south.
const ROWS: [i16; 6] = [5, 6, -9999, 1, 2, 3];

fn image(bits: u16, format: u16, strip: Vec<u8>) -> Image {
    Image {
        order: Order::Little,
        n: [3, 2],
        bits,
        format,
        tile: None,
        chunks: vec![strip],
        fields: Vec::new(),
    }
}

fn floats() -> Image {
    let strip = ROWS.iter().flat_map(|z| f32::from(*z).to_le_bytes());
    image(32, 3, strip.collect()).with_no_data("-9999")
}

/// Pixels of 10 m, the first at (100, 220).
fn on_the_map() -> Image {
    floats().placed([10.0, 10.0], [100.0, 220.0])
}

fn check(content: &[u8], corner: [f64; 2]) {
    let grid = grid_from(content).unwrap();
    assert_eq!((grid.n, grid.corner, grid.spacing), ([3, 2], corner, 10.0));
    assert_eq!(grid.heights[..5], [1.0, 2.0, 3.0, 5.0, 6.0]);
    assert!(grid.heights[5].is_nan());
}

#[test]
fn pixels_are_areas_or_points() {
    check(&on_the_map().bytes(), [105.0, 205.0]);
    let area = on_the_map().with_keys(&[[RASTER_TYPE, PIXEL_IS_AREA]]);
    check(&area.bytes(), [105.0, 205.0]);
    let point = on_the_map().with_keys(&[[RASTER_TYPE, PIXEL_IS_POINT]]);
    check(&point.bytes(), [100.0, 210.0]);
}

#[test]
fn a_matrix_places_pixels_too() {
    let matrix = |c: f64, d: f64, y: f64| {
        let mut image = floats();
        let rows = [
            [10.0, 0.0, 0.0, 100.0],
            [c, d, 0.0, y],
            [0.0; 4],
            [0.0, 0.0, 0.0, 1.0],
        ];
        let field = image.doubles(34_264, rows.as_flattened());
        image.fields.push(field);
        image.bytes()
    };
    check(&matrix(0.0, -10.0, 220.0), [105.0, 205.0]);
    // rows from south to north
    let grid = grid_from(&matrix(0.0, 10.0, 200.0)).unwrap();
    assert_eq!(grid.corner, [105.0, 205.0]);
    assert_eq!(grid.heights[3..], [1.0, 2.0, 3.0]);
    let turned = grid_from(&matrix(3.0, -10.0, 220.0)).unwrap_err();
    assert!(turned.to_string().starts_with("is rotated against the map"));
}

/// All types of samples, both orders of bytes.
#[test]
fn samples_are_whole_numbers_and_floats() {
    fn strip<const N: usize>(bytes: impl Fn(i16) -> [u8; N]) -> Vec<u8> {
        ROWS.into_iter().flat_map(bytes).collect()
    }
    let placed = |image: Image, no_data: &str| {
        let image = image.placed([10.0, 10.0], [100.0, 220.0]);
        check(&image.with_no_data(no_data).bytes(), [105.0, 205.0]);
    };
    placed(image(16, 2, strip(i16::to_le_bytes)), "-9999");
    placed(image(32, 2, strip(|z| i32::from(z).to_le_bytes())), "-9999");
    placed(image(64, 3, strip(|z| f64::from(z).to_le_bytes())), "-9999");
    // −9999 as unsigned 16 bits is 55537
    placed(image(16, 1, strip(i16::to_le_bytes)), "55537");
    let big = Image {
        order: Order::Big,
        ..image(16, 2, strip(i16::to_be_bytes))
    };
    placed(big, "-9999");
    // the lowest float in the six digits of some programs
    let lowest = |z: i16| if z < 0 { f32::MIN } else { f32::from(z) };
    placed(
        image(32, 3, strip(|z| lowest(z).to_le_bytes())),
        "-3.4028234663852886e+38",
    );
}

/// Tiles of 16 x 16 pixels, two by one, the rest of them zero.
#[test]
fn tiles_are_put_together() {
    let n = [18_u16, 3];
    let height = |i: u16, j: u16| if i < n[0] && j < n[1] { 100 * j + i } else { 0 };
    let tile = |first: u16| -> Vec<u8> {
        let pixels = (0..16).flat_map(|j| (0..16).map(move |i| (first + i, j)));
        pixels
            .flat_map(|(i, j)| f32::from(height(i, j)).to_le_bytes())
            .collect()
    };
    let image = Image {
        order: Order::Little,
        n,
        bits: 32,
        format: 3,
        tile: Some(16),
        chunks: vec![tile(0), tile(16)],
        fields: Vec::new(),
    };
    let grid = grid_from(&image.placed([2.0, 2.0], [0.0, 6.0]).bytes()).unwrap();
    for [i, j] in grid.points() {
        let expected = height(i as u16, 2 - j as u16);
        assert_eq!(grid.heights[grid.index([i, j])], f64::from(expected));
    }
}

#[test]
fn the_system_is_that_of_the_keys() {
    let keys = [[MODEL_TYPE, PROJECTED], [PROJECTED_SYSTEM, 25_833]];
    let raster = raster_from(&on_the_map().with_keys(&keys).bytes()).unwrap();
    assert_eq!(raster.crs, Some(Crs::of_epsg(25_833).unwrap()));
    assert_eq!(raster_from(&on_the_map().bytes()).unwrap().crs, None);
}

#[test]
fn what_is_no_map_in_meters_is_refused() {
    let refused = |content: &[u8]| grid_from(content).unwrap_err().to_string();
    // pixels that are not square on purpose: degrees are the first thing to tell
    let degrees = floats().placed([2e-4, 1e-4], [7.0, 62.0]);
    let degrees = degrees.with_keys(&[[MODEL_TYPE, 2], [2048, 4258]]).bytes();
    assert_eq!(
        refused(&degrees),
        "is in degrees of EPSG:4258 (ETRS89), terrain is in meters; project it: gdalwarp -t_srs EPSG:32632 in out.tif"
    );
    let feet = on_the_map().with_keys(&[[LINEAR_UNITS, 9003]]).bytes();
    assert!(refused(&feet).starts_with("has a plan in units of EPSG 9003"));
    let feet = on_the_map().with_keys(&[[MODEL_TYPE, 1], [PROJECTED_SYSTEM, 2230]]);
    assert!(refused(&feet.bytes()).starts_with("has a plan in units of 0.304801 m, EPSG:2230"));
    assert!(refused(&floats().bytes()).starts_with("has no place on the map"));
    let oblong = floats().placed([10.0, 20.0], [0.0, 0.0]).bytes();
    assert!(refused(&oblong).starts_with("has pixels of 10 x 20 m"));
    assert!(refused(b"II*\0").starts_with("is not a readable GeoTIFF"));
}

/// What is written reads back, with the system by code or by text.
#[test]
fn a_map_reads_back() {
    let local = r#"PROJCS["mine",GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137.0,298.257223563]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["Central_Meridian",7.5],UNIT["Meter",1.0]]"#;
    let grid = Grid {
        n: [3, 2],
        corner: [412_105.25, 6_904_205.5],
        spacing: 2.5,
        heights: vec![1.5, -2.0, f64::NAN, 0.0, 1e3, 0.1],
    };
    for crs in [
        None,
        Some(Crs::of_epsg(25_832).unwrap()),
        Some(Crs::of_wkt(local).unwrap()),
    ] {
        let map = MapGrid {
            grid: grid.clone(),
            crs,
        };
        let back = raster_from(&written(&map).unwrap()).unwrap();
        assert_eq!(back.crs, map.crs);
        assert_eq!((back.grid.n, back.grid.spacing), (grid.n, grid.spacing));
        assert_eq!(back.grid.corner, grid.corner);
        for (found, wrote) in back.grid.heights.iter().zip(&grid.heights) {
            let stored = f64::from(*wrote as f32);
            assert!(*found == stored || found.is_nan() && wrote.is_nan());
        }
    }
}
