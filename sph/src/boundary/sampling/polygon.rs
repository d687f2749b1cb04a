//! Convex planar polygons: clipping, moments, cells.

use nalgebra::Vector2;

type Point = Vector2<f64>;

/// A convex polygon; corners counter-clockwise.
#[derive(Clone, Debug)]
pub(super) struct Polygon {
    corners: Vec<Point>,
}

/// A part of a polygon.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    /// m².
    pub(super) area: f64,
    pub(super) centroid: Point,
}

/// A rectangle of cells that covers a polygon.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cells {
    /// Lowest corner; m.
    pub(super) origin: Point,
    /// m.
    pub(super) size: Point,
    pub(super) n: [usize; 2],
}

impl Polygon {
    pub(super) fn new(corners: Vec<Point>) -> Self {
        Self { corners }
    }

    /// Lowest and highest coordinates; m.
    pub(super) fn extent(&self) -> (Point, Point) {
        self.corners.iter().fold(
            (Point::repeat(f64::INFINITY), Point::repeat(-f64::INFINITY)),
            |(low, high), p| (low.inf(p), high.sup(p)),
        )
    }

    /// The part where `normal · p ≤ offset` (Sutherland & Hodgman 1974).
    pub(super) fn clipped(&self, normal: Point, offset: f64) -> Self {
        let mut corners = Vec::with_capacity(self.corners.len() + 1);
        let next = self.corners.iter().cycle().skip(1);
        for (p, q) in self.corners.iter().zip(next) {
            let (beyond_p, beyond_q) = (normal.dot(p) - offset, normal.dot(q) - offset);
            if beyond_p <= 0.0 {
                corners.push(*p);
            }
            if (beyond_p <= 0.0) != (beyond_q <= 0.0) {
                corners.push(p + (q - p) * (beyond_p / (beyond_p - beyond_q)));
            }
        }
        Self { corners }
    }

    /// Area and centroid; `None` without an area.
    pub(super) fn piece(&self) -> Option<Piece> {
        let first = self.corners.first()?;
        let (mut area, mut moment) = (0.0, Point::zeros());
        for pair in self.corners.windows(2) {
            let (p, q) = (pair[0] - first, pair[1] - first);
            let triangle = 0.5 * p.perp(&q);
            area += triangle;
            moment += (p + q) * (triangle / 3.0);
        }
        (0.0 < area).then(|| Piece {
            area,
            centroid: first + moment / area,
        })
    }

    /// m².
    pub(super) fn area(&self) -> f64 {
        self.piece().map_or(0.0, |piece| piece.area)
    }

    /// The part of the polygon in each cell, row after row; some may be without an area.
    pub(super) fn in_cells(&self, cells: Cells) -> impl Iterator<Item = Self> {
        let Cells { origin, size, n } = cells;
        (0..n[1]).flat_map(move |j| {
            let low = origin.y + j as f64 * size.y;
            let row = self
                .clipped(-Point::y(), -low)
                .clipped(Point::y(), low + size.y);
            (0..n[0]).map(move |i| {
                let low = origin.x + i as f64 * size.x;
                row.clipped(-Point::x(), -low)
                    .clipped(Point::x(), low + size.x)
            })
        })
    }

    /// Parts of the polygon in each cell; parts below `least_area` join the largest beside them.
    pub(super) fn pieces(&self, cells: &Cells, least_area: f64) -> Vec<Piece> {
        let mut pieces: Vec<Option<Piece>> =
            self.in_cells(*cells).map(|cell| cell.piece()).collect();
        join_slivers(&mut pieces, cells.n, least_area);
        pieces.into_iter().flatten().collect()
    }

    /// Counter-clockwise; m.
    pub(super) fn corners(&self) -> &[Point] {
        &self.corners
    }
}

/// Joins small pieces to their largest neighbor, smallest first.
fn join_slivers(pieces: &mut [Option<Piece>], n: [usize; 2], least_area: f64) {
    let area = |piece: &Option<Piece>| piece.map_or(0.0, |p| p.area);
    let mut slivers: Vec<usize> = (0..pieces.len())
        .filter(|&k| pieces[k].is_some_and(|p| p.area < least_area))
        .collect();
    slivers.sort_by(|&p, &q| area(&pieces[p]).total_cmp(&area(&pieces[q])));
    for k in slivers {
        let Some(sliver) = pieces[k].filter(|p| p.area < least_area) else {
            continue;
        };
        let largest = beside(k, n).max_by(|&p, &q| area(&pieces[p]).total_cmp(&area(&pieces[q])));
        if let Some(target) = largest
            && let Some(piece) = &mut pieces[target]
        {
            let sum = piece.area + sliver.area;
            piece.centroid = (piece.centroid * piece.area + sliver.centroid * sliver.area) / sum;
            piece.area = sum;
            pieces[k] = None;
        }
    }
}

/// The cells that share a side or a corner with cell `k`.
fn beside(k: usize, n: [usize; 2]) -> impl Iterator<Item = usize> {
    let (i, j) = (k % n[0], k / n[0]);
    let (rows, columns) = (
        j.saturating_sub(1)..(j + 2).min(n[1]),
        i.saturating_sub(1)..(i + 2).min(n[0]),
    );
    rows.flat_map(move |row| columns.clone().map(move |column| row * n[0] + column))
        .filter(move |&other| other != k)
}
