//! Corners, edges and faces of a lattice cell, and their incidence.
//!
//! ```text
//!        6 ------- 7        corner: bit 0 = x, bit 1 = y, bit 2 = z
//!       /|        /|        edge:   4 axis + positions on the two other axes
//!      4 ------- 5 |        face:   2 axis + position
//!   z  | |       | |
//!   |  | 2 ------| 3        Around an axis the two other axes (u, v) follow cyclically, so that
//!   | y|/        |/         (axis, u, v) is right-handed.
//!   |/ 0 ------- 1
//!   +---- x
//! ```

use crate::lattice::Axis;

/// A corner of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Corner(u8);

impl Corner {
    /// Returns the eight corners.
    pub fn all() -> impl Iterator<Item = Corner> {
        (0..8).map(Corner)
    }

    /// Returns the bit of this corner in an 8-bit mask of corners.
    pub const fn bit(self) -> u8 {
        1 << self.0
    }

    /// Returns 0 on the lower face of the cell across `axis`, 1 on the upper face.
    pub const fn position(self, axis: Axis) -> u8 {
        self.0 >> axis as u8 & 1
    }

    /// Returns the offset from the cell's lowest corner, in nodes.
    pub const fn offset(self) -> [i32; 3] {
        [(self.0 & 1) as i32, (self.0 >> 1 & 1) as i32, (self.0 >> 2 & 1) as i32]
    }

    /// Returns the neighbour along `axis`.
    pub const fn across(self, axis: Axis) -> Corner {
        Corner(self.0 ^ 1 << axis as u8)
    }

    /// Returns the edge from this corner along `axis`.
    pub const fn edge(self, axis: Axis) -> Edge {
        let (u, v) = axis.others();
        Edge::new(axis, self.position(u), self.position(v))
    }

    /// Returns the three edges at this corner.
    pub fn edges(self) -> EdgeSet {
        Axis::ALL.into_iter().map(|axis| self.edge(axis)).collect()
    }
}

/// An edge of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Edge(u8);

impl Edge {
    /// Returns the twelve edges.
    pub fn all() -> impl Iterator<Item = Edge> {
        (0..12).map(Edge)
    }

    /// Returns the edge along `axis` at positions `u` and `v`, 0 or 1, on the two other axes, in
    /// cyclic order.
    pub const fn new(axis: Axis, u: u8, v: u8) -> Edge {
        Edge(4 * axis as u8 + (u & 1) + 2 * (v & 1))
    }

    /// Returns the number of the edge, 0..12.
    #[inline]
    pub const fn index(self) -> usize {
        self.0 as usize
    }

    /// Returns the direction of the edge.
    #[inline]
    pub const fn axis(self) -> Axis {
        match self.0 >> 2 {
            0 => Axis::X,
            1 => Axis::Y,
            _ => Axis::Z,
        }
    }

    /// Returns the lower end.
    #[inline]
    pub const fn low(self) -> Corner {
        let (u, v) = self.axis().others();
        Corner((self.0 & 1) << u as u8 | (self.0 >> 1 & 1) << v as u8)
    }

    /// Returns the upper end.
    pub const fn high(self) -> Corner {
        self.low().across(self.axis())
    }

    /// Returns the four edges that share one end with this one.
    pub fn adjacent(self) -> EdgeSet {
        EdgeSet((self.low().edges().0 | self.high().edges().0) & !self.set().0)
    }

    const fn set(self) -> EdgeSet {
        EdgeSet(1 << self.0)
    }
}

/// A set of edges of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct EdgeSet(u16);

impl EdgeSet {
    /// Returns the number of edges in the set.
    pub const fn len(self) -> usize {
        self.0.count_ones() as usize
    }

    /// Whether `edge` is in the set.
    pub const fn contains(self, edge: Edge) -> bool {
        self.0 >> edge.0 & 1 == 1
    }

    /// Adds `edge`.
    pub fn insert(&mut self, edge: Edge) {
        self.0 |= edge.set().0;
    }

    /// Returns the edges of the set in ascending order.
    #[inline]
    pub fn iter(self) -> impl Iterator<Item = Edge> {
        let mut rest = self.0;
        std::iter::from_fn(move || {
            let edge = (rest != 0).then(|| Edge(rest.trailing_zeros() as u8))?;
            rest &= rest - 1;
            Some(edge)
        })
    }
}

impl FromIterator<Edge> for EdgeSet {
    fn from_iter<I: IntoIterator<Item = Edge>>(edges: I) -> Self {
        let mut set = EdgeSet::default();
        edges.into_iter().for_each(|edge| set.insert(edge));
        set
    }
}

/// A face of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Face(u8);

impl Face {
    /// Returns the six faces.
    pub fn all() -> impl Iterator<Item = Face> {
        (0..6).map(Face)
    }

    /// Returns the upper face across `axis`.
    pub const fn upper(axis: Axis) -> Face {
        Face(2 * axis as u8 + 1)
    }

    /// Returns the number of the face, 0..6.
    pub const fn index(self) -> usize {
        self.0 as usize
    }

    /// Returns the bit of this face in a mask of faces.
    pub const fn bit(self) -> u8 {
        1 << self.0
    }

    /// Returns the axis that the face is perpendicular to.
    pub const fn axis(self) -> Axis {
        match self.0 >> 1 {
            0 => Axis::X,
            1 => Axis::Y,
            _ => Axis::Z,
        }
    }

    /// Returns the corners in cyclic order from the lowest one: (0,0), (1,0), (1,1), (0,1) in (u,
    /// v).
    pub fn corners(self) -> [Corner; 4] {
        let (u, v) = self.axis().others();
        let lowest = Corner((self.0 & 1) << self.axis() as u8);
        [lowest, lowest.across(u), lowest.across(u).across(v), lowest.across(v)]
    }

    /// Returns the edges in cyclic order: edge i joins corners i and i + 1.
    pub fn edges(self) -> [Edge; 4] {
        let (u, v) = self.axis().others();
        let [a, b, _, d] = self.corners();
        [a.edge(u), b.edge(v), d.edge(u), a.edge(v)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_have_their_two_ends() {
        let mut seen = std::collections::HashSet::new();
        for edge in Edge::all() {
            assert_eq!(edge.low().edge(edge.axis()), edge);
            assert_eq!(edge.high().edge(edge.axis()), edge);
            assert_eq!((edge.low().position(edge.axis()), edge.high().position(edge.axis())), (0, 1));
            assert_eq!(edge.adjacent().len(), 4);
            assert!(seen.insert((edge.low(), edge.high())));
        }
        assert!(Corner::all().all(|c| c.edges().len() == 3));
    }

    #[test]
    fn faces_join_their_corners_in_order() {
        for face in Face::all() {
            let (corners, edges) = (face.corners(), face.edges());
            for i in 0..4 {
                let ends = [corners[i], corners[(i + 1) % 4]];
                assert!(ends.contains(&edges[i].low()) && ends.contains(&edges[i].high()));
                assert_eq!(corners[i].position(face.axis()), face.index() as u8 & 1);
            }
        }
        assert_eq!(Face::upper(Axis::Y).index(), 3);
        for edge in Edge::all() {
            assert_eq!(Face::all().filter(|f| f.edges().contains(&edge)).count(), 2);
        }
    }
}
