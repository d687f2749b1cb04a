//! Insertion of points into a net: the largest error first, then what removes slivers.

use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashMap};

use riprap_dda::Vec3;
use spade::handles::{FixedFaceHandle, FixedVertexHandle, InnerTag};
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation as _};

use super::TrianglesError;
use super::field::{Corner, Field, Use};
use super::refine::{Remedy, remedy, square_of_smallest_sine};
use super::sides::Side;

/// Square of the sine of the smallest angle that is no sliver's, 20 degrees.
///
/// A triangle of points of the grid with a smaller angle has a circumcircle of at least 1.46 times its shortest side, so that the
/// point of the grid nearest to the center lies within it and no closer to a corner than that side: refinement ends, without shorter
/// sides than those it began with.
const SLIVER: f64 = 0.116_977_778_440_511;

/// Difference of errors that counts as none; × tolerance.
const SAME_ERROR: f64 = 1e-3;

/// A corner of triangles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// Plan view; spacings.
    pub(super) place: Point2<f64>,
    /// m.
    pub(super) x: Vec3,
    /// Whether it lies on an outline.
    pub(super) is_on_outline: bool,
}

impl HasPosition for Node {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.place
    }
}

pub(super) type Net = ConstrainedDelaunayTriangulation<Node>;
pub(super) type Face = FixedFaceHandle<InnerTag>;

/// A piece of a side between two corners of triangles.
#[derive(Clone, Copy, Debug)]
struct Piece {
    side: usize,
    from: u32,
    to: u32,
}

/// A triangle that asks for a change; the most urgent first, of equals the first of the grid.
#[derive(Clone, Copy, Debug)]
struct Wish {
    /// Error in steps, or how far an angle is from that of no sliver (squares of sines).
    urgency: f64,
    /// The point of the grid that it asks for, if it is one.
    point: usize,
    face: Face,
    /// Of the triangle when it asked.
    version: u32,
}

impl Ord for Wish {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_urgency = self.urgency.total_cmp(&other.urgency);
        by_urgency
            .then(other.point.cmp(&self.point))
            .then(other.face.index().cmp(&self.face.index()))
            .then(self.version.cmp(&other.version))
    }
}

impl PartialOrd for Wish {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Wish {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Wish {}

/// Corners of a triangle when it was last measured, and the count of its changes.
#[derive(Clone, Copy, Debug, Default)]
struct Known {
    corners: [usize; 3],
    version: u32,
}

/// A triangulation being made.
pub(super) struct Mesher<'a, B> {
    pub(super) net: Net,
    pub(super) field: Field<'a, B>,
    tolerance: f64,
    sides: Vec<Side>,
    /// By both ends, the lower first.
    pieces: HashMap<[usize; 2], Piece>,
    known: Vec<Known>,
    errors: BinaryHeap<Wish>,
    slivers: BinaryHeap<Wish>,
}

impl<'a, B: Fn(usize, [f64; 2]) -> f64> Mesher<'a, B> {
    /// The rectangle of a grid with the sides of its outlines, cut where they leave the surfaces.
    pub(super) fn new(
        field: Field<'a, B>,
        sides: Vec<Side>,
        tolerance: f64,
    ) -> Result<Self, TrianglesError> {
        let mut mesher = Self {
            net: Net::new(),
            field,
            tolerance,
            sides,
            pieces: HashMap::new(),
            known: Vec::new(),
            errors: BinaryHeap::new(),
            slivers: BinaryHeap::new(),
        };
        let grid = mesher.field.grid;
        let [east, north] = grid.n.map(|n| n - 1);
        for point in [[0, 0], [east, 0], [0, north], [east, north]] {
            let k = grid.index(point);
            mesher.field.uses[k] = Use::Corner;
            let node = mesher.node(k);
            mesher.net.insert(node)?;
        }
        for side in 0..mesher.sides.len() {
            mesher.draw(side)?;
        }
        Ok(mesher)
    }

    /// Inserts points until no error exceeds the tolerance and no sliver is left that a point would remove.
    pub(super) fn run(&mut self) -> Result<(), TrianglesError> {
        self.measure_all();
        // a plane is two triangles, whatever their angles
        if self.errors.is_empty() && self.sides.is_empty() {
            return Ok(());
        }
        loop {
            if let Some(wish) = self.errors.pop() {
                if self.is_current(&wish) {
                    self.insert_point(wish.point, wish.face)?;
                }
            } else if let Some(wish) = self.slivers.pop() {
                // what it takes away first may leave the sliver as it was
                if self.is_current(&wish) && self.mend(wish.face)? && self.is_current(&wish) {
                    self.slivers.push(wish);
                }
            } else if !self.measure_all() {
                return Ok(());
            }
        }
    }

    /// The corners of a triangle.
    pub(super) fn corners(&self, face: Face) -> [Corner; 3] {
        self.net.face(face).vertices().map(|vertex| {
            let Node { place, x, .. } = vertex.data();
            [place.x, place.y, x.z]
        })
    }

    fn is_current(&self, wish: &Wish) -> bool {
        self.known[wish.face.index()].version == wish.version
    }

    fn node(&self, k: usize) -> Node {
        let grid = self.field.grid;
        let point = self.field.point(k);
        let [x, y] = grid.place(point);
        let [i, j] = point.map(|n| n as f64);
        Node {
            place: Point2::new(i, j),
            x: Vec3::new(x, y, grid.heights[k]),
            is_on_outline: false,
        }
    }

    fn node_on_side(&self, side: usize, k: u32) -> Node {
        let at = self.sides[side].place(k);
        let [x, y] = self.field.in_spacings(at);
        let height = self.field.grid.height(at);
        Node {
            place: Point2::new(x, y),
            // a grid of terrain has no gaps
            x: Vec3::new(at[0], at[1], height.unwrap_or(f64::NAN)),
            is_on_outline: true,
        }
    }

    /// Makes a side edges of triangles.
    fn draw(&mut self, side: usize) -> Result<(), TrianglesError> {
        let Side { outline, .. } = self.sides[side];
        let grid = self.field.grid;
        let ground = |at| grid.height(at).unwrap_or(f64::NAN);
        let beneath = |at| (self.field.beneath)(outline, at);
        let cuts = self.sides[side].cuts([&ground, &beneath], self.tolerance);
        let mut last: Option<(u32, FixedVertexHandle)> = None;
        for to in cuts {
            let end = self.net.insert(self.node_on_side(side, to))?;
            if let Some((from, start)) = last {
                self.constrain([start, end], Piece { side, from, to })?;
            }
            last = Some((to, end));
        }
        Ok(())
    }

    fn constrain(
        &mut self,
        [start, end]: [FixedVertexHandle; 2],
        piece: Piece,
    ) -> Result<(), TrianglesError> {
        let Piece { side, from, to } = piece;
        if self.net.try_add_constraint(start, end).is_empty() {
            let side = &self.sides[side];
            return Err(TrianglesError::Crossing {
                outline: side.outline,
                from: side.place(from),
                to: side.place(to),
            });
        }
        self.pieces.insert(key([start, end]), piece);
        Ok(())
    }

    /// Makes a point of the grid that lies in a triangle, or close to it, a corner.
    fn insert_point(&mut self, k: usize, near: Face) -> Result<(), TrianglesError> {
        let [hint, ..] = self.net.face(near).vertices().map(|v| v.fix());
        self.field.uses[k] = Use::Corner;
        let new = self.net.insert_with_hint(self.node(k), hint)?;
        self.measure_around(new);
        Ok(())
    }

    /// Inserts a point against a sliver; false where none is of use.
    fn mend(&mut self, face: Face) -> Result<bool, TrianglesError> {
        let can_be_cut = |ends| self.middle(ends).is_some();
        match remedy(&self.net, &self.field, face, can_be_cut) {
            Some(Remedy::Point(k)) => self.insert_point(k, face)?,
            Some(Remedy::Cut(ends)) => self.cut(ends)?,
            None => return Ok(false),
        }
        Ok(true)
    }

    /// Where a piece of a side may be cut.
    fn middle(&self, ends: [FixedVertexHandle; 2]) -> Option<u32> {
        let piece = self.pieces.get(&key(ends))?;
        (1 < piece.to - piece.from).then_some((piece.from + piece.to) / 2)
    }

    /// Cuts a piece of a side in two.
    fn cut(&mut self, ends: [FixedVertexHandle; 2]) -> Result<(), TrianglesError> {
        let Some((middle, piece)) = self.middle(ends).zip(self.pieces.remove(&key(ends))) else {
            return Ok(());
        };
        let edge = self.net.get_edge_from_neighbors(ends[0], ends[1]);
        if let Some(edge) = edge.map(|edge| edge.as_undirected().fix()) {
            self.net.remove_constraint_edge(edge);
        }
        let node = self.node_on_side(piece.side, middle);
        let new = self.net.insert_with_hint(node, ends[0])?;
        let at = |k: u32| self.sides[piece.side].place(k);
        let first = self.net.vertex(ends[0]).data().x;
        let is_first = [first.x, first.y] == at(piece.from);
        let [from, to] = if is_first { ends } else { [ends[1], ends[0]] };
        self.constrain(
            [from, new],
            Piece {
                to: middle,
                ..piece
            },
        )?;
        self.constrain(
            [new, to],
            Piece {
                from: middle,
                ..piece
            },
        )?;
        self.measure_around(new);
        Ok(())
    }

    /// Measures all triangles that changed; whether there were any.
    fn measure_all(&mut self) -> bool {
        let faces: Vec<Face> = self.net.fixed_inner_faces().collect();
        let mut has_changed = false;
        for face in faces {
            has_changed |= self.measure(face);
        }
        has_changed
    }

    /// Measures the triangles that changed around a new corner.
    fn measure_around(&mut self, corner: FixedVertexHandle) {
        let around = self.net.vertex(corner).out_edges();
        let mut open: Vec<Face> = around
            .filter_map(|edge| Some(edge.face().as_inner()?.fix()))
            .collect();
        while let Some(face) = open.pop() {
            if self.measure(face) {
                let sides = self.net.face(face).adjacent_edges();
                let beyond = sides.map(|edge| edge.rev().face().as_inner());
                open.extend(beyond.into_iter().flatten().map(|face| face.fix()));
            }
        }
    }

    /// Measures a triangle if it changed.
    fn measure(&mut self, face: Face) -> bool {
        let handles = self.net.face(face).vertices().map(|v| v.fix().index());
        let first = (0..3).min_by_key(|&k| handles[k]).unwrap_or(0);
        let corners = [0, 1, 2].map(|k| handles[(first + k) % 3]);
        let n = self.known.len().max(face.index() + 1);
        self.known.resize(n, Known::default());
        let known = &mut self.known[face.index()];
        if known.corners == corners {
            return false;
        }
        known.corners = corners;
        known.version += 1;
        let version = known.version;
        let corners = self.corners(face);
        let wish = |urgency: f64, point: usize| Wish {
            urgency,
            point,
            face,
            version,
        };
        let step = SAME_ERROR * self.tolerance;
        if let Some((point, error)) = self.field.worst(&corners, step)
            && 1.0 < error * SAME_ERROR
        {
            self.errors.push(wish(error, point));
        }
        let square = square_of_smallest_sine(&corners);
        if square < SLIVER {
            self.slivers.push(wish(SLIVER - square, 0));
        }
        true
    }
}

fn key(ends: [FixedVertexHandle; 2]) -> [usize; 2] {
    let [a, b] = ends.map(|end| end.index());
    [a.min(b), a.max(b)]
}
