//! Building the hierarchy: top-down median splits into packed subtrees, volumes fitted bottom-up.

use super::TriangleSlot;
use super::node::{Level, Node, WIDTH};
use crate::geom::aabb::Aabb;
use crate::geom::swept::{Sphere, Swept};
use crate::geom::triangle::Triangle;
use crate::mesh::TriMesh;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// The hierarchy. Holds copies of the triangles in its own order, so a query touches nothing else.
#[derive(Clone, Debug)]
pub struct Ssvh {
    pub(super) nodes: Vec<Node>,
    pub(super) triangles: Vec<Triangle>,
    /// Number in the mesh of the triangle in each slot. Slots are the hierarchy's own order.
    pub(super) ids: Vec<u32>,
    /// Position in the hierarchy's order by mesh triangle number.
    slots: Vec<TriangleSlot>,
    pub(super) centre: DVec3,
    /// No coordinate relative to the centre is larger than this.
    pub(super) extent: f64,
}

/// The most triangles of a subtree whose volume is fitted to their corners. Volumes of larger
/// subtrees are fitted to the volumes of their children. Larger: slower to build. Smaller: looser
/// volumes where queries spend their time.
const MAX_EXACT_FIT: usize = WIDTH * WIDTH;

/// The fewest triangles of a subtree that is built in parallel. A task of fewer takes less time
/// than handing it over.
const MIN_PARALLEL: usize = 2048;

/// A triangle while it is sorted. In 16 bytes, since sorting is moving them: where exactly a
/// subtree ends matters to nobody.
#[derive(Clone, Copy)]
struct Primitive {
    /// Centroid from the centre of the mesh, in units of half its extent.
    centroid: Vec3,
    id: u32,
}

impl Ssvh {
    /// Builds the hierarchy over all triangles of `mesh`. Runs on the current rayon pool; the
    /// result does not depend on the number of threads.
    ///
    /// # Panics
    /// When the mesh has no triangle, 2^32 - 1 or more of them, or refers to a vertex that does not
    /// exist.
    pub fn new(mesh: &TriMesh) -> Self {
        let count = mesh.triangles.len();
        assert!(count > 0 && count < u32::MAX as usize, "the hierarchy needs 1 to 2^32 - 2 triangles");
        let bounds = Aabb::around(mesh.vertices.iter().map(|&v| DVec3::from(v)));
        let centre = bounds.centre();
        let extent = bounds.size().max_element() * 0.5;
        let scale = if extent > 0.0 { 1.0 / extent } else { 1.0 };
        let mut primitives: Vec<Primitive> = mesh
            .triangles
            .par_iter()
            .zip(0u32..count as u32)
            .map(|(t, id)| {
                let [a, b, c] = t.map(|v| DVec3::from(mesh.vertices[v as usize]) - centre);
                Primitive { centroid: ((a + b + c) * (scale / 3.0)).as_vec3(), id }
            })
            .collect();
        // By all threads: they are as large as the triangles.
        let mut nodes: Vec<Node> = (0..node_count(count)).into_par_iter().map(|_| Node::EMPTY).collect();
        Builder { mesh, centre }.build(&mut primitives, &mut nodes, 0, 0);

        let ids: Vec<u32> = primitives.par_iter().map(|p| p.id).collect();
        let mut slots = vec![TriangleSlot::default(); count];
        for (slot, &id) in ids.iter().enumerate() {
            slots[id as usize] = TriangleSlot(slot as u32);
        }
        let triangles = ids.par_iter().map(|&id| triangle(mesh, id)).collect();
        Ssvh { nodes, triangles, ids, slots, centre, extent }
    }

    /// Returns the triangle with mesh number `id`.
    pub fn triangle(&self, id: u32) -> &Triangle {
        self.triangle_at(self.slot(id))
    }

    /// Returns the slot of mesh triangle `id` in the hierarchy's order.
    pub(super) fn slot(&self, id: u32) -> TriangleSlot {
        self.slots[id as usize]
    }

    /// Returns the number of triangles.
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// Never: a hierarchy has at least one triangle.
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }
}

fn triangle(mesh: &TriMesh, id: u32) -> Triangle {
    Triangle::new(mesh.corners(id as usize).map(DVec3::from), mesh.triangles[id as usize])
}

/// Triangles per child: the largest power of eight below `count`, so that all subtrees but the last
/// are full. Only for `count` above [`WIDTH`].
fn child_capacity(count: usize) -> usize {
    let mut capacity = 1;
    while capacity * WIDTH < count {
        capacity *= WIDTH;
    }
    capacity
}

/// Nodes of a subtree over `count` triangles.
fn node_count(count: usize) -> usize {
    if count <= WIDTH {
        return 1;
    }
    let capacity = child_capacity(count);
    let last = count - (count - 1) / capacity * capacity;
    1 + (count - last) / capacity * node_count(capacity) + node_count(last)
}

struct Builder<'a> {
    mesh: &'a TriMesh,
    centre: DVec3,
}

impl Builder<'_> {
    /// Builds the subtree over `primitives` into `nodes`, whose first has the number `number`; the
    /// first primitive has the slot `slot`. Returns what encloses the subtree: spheres.
    fn build(
        &self,
        primitives: &mut [Primitive],
        nodes: &mut [Node],
        number: usize,
        slot: usize,
    ) -> Vec<Sphere> {
        let (node, below) = nodes.split_first_mut().expect("a subtree has a node");
        if primitives.len() <= WIDTH {
            *node = self.leaf(primitives, slot);
        } else {
            let capacity = child_capacity(primitives.len());
            split(primitives, capacity);
            let mut tasks: Vec<Subtree> = Vec::with_capacity(WIDTH);
            let mut below = below;
            let (mut child_number, mut child_slot) = (number + 1, slot);
            for child in primitives.chunks_mut(capacity) {
                let (own, rest) = below.split_at_mut(node_count(child.len()));
                below = rest;
                let next = (child_number + own.len(), child_slot + child.len());
                tasks.push(Subtree { primitives: child, nodes: own, number: child_number, slot: child_slot });
                (child_number, child_slot) = next;
            }
            let build = |s: Subtree| (s.number, self.build(s.primitives, s.nodes, s.number, s.slot));
            let children: Vec<(usize, Vec<Sphere>)> = if triangle_count(&tasks) >= MIN_PARALLEL {
                tasks.into_par_iter().map(build).collect()
            } else {
                tasks.into_iter().map(build).collect()
            };
            node.level = Level::Inner;
            for (child, spheres) in children {
                node.push(child as u32, &Swept::shape_around(&spheres), &spheres);
            }
        }
        self.enclosing(primitives, node)
    }

    fn leaf(&self, primitives: &[Primitive], slot: usize) -> Node {
        let mut node = Node::EMPTY;
        for (i, primitive) in primitives.iter().enumerate() {
            let corners = self.corners(primitive.id);
            node.push((slot + i) as u32, &Swept::shape_around_triangle(corners), &corners.map(|c| (c, 0.0)));
        }
        node
    }

    fn corners(&self, id: u32) -> [DVec3; 3] {
        self.mesh.corners(id as usize).map(|c| DVec3::from(c) - self.centre)
    }

    /// Returns spheres whose hull encloses all triangles of the subtree with the root `node`.
    fn enclosing(&self, primitives: &[Primitive], node: &Node) -> Vec<Sphere> {
        if primitives.len() <= MAX_EXACT_FIT {
            return primitives.iter().flat_map(|p| self.corners(p.id)).map(|c| (c, 0.0)).collect();
        }
        (0..node.count as usize)
            .map(|lane| node.swept(lane))
            .flat_map(|s| s.corners().map(|c| (c, s.radius)))
            .collect()
    }
}

struct Subtree<'a> {
    primitives: &'a mut [Primitive],
    nodes: &'a mut [Node],
    number: usize,
    slot: usize,
}

fn triangle_count(tasks: &[Subtree]) -> usize {
    tasks.iter().map(|t| t.primitives.len()).sum()
}

/// Orders `primitives` so that each chunk of `capacity` is compact: median splits across the widest
/// extent of the centroids, ties by triangle number.
fn split(primitives: &mut [Primitive], capacity: usize) {
    let chunks = primitives.len().div_ceil(capacity);
    if chunks <= 1 {
        return;
    }
    let ends = primitives
        .iter()
        .fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[lo, hi], p| [lo.min(p.centroid), hi.max(p.centroid)]);
    let axis = (ends[1] - ends[0]).max_position();
    let middle = chunks / 2 * capacity;
    primitives.select_nth_unstable_by(middle, |a, b| {
        a.centroid[axis].total_cmp(&b.centroid[axis]).then(a.id.cmp(&b.id))
    });
    let (left, right) = primitives.split_at_mut(middle);
    if left.len() + right.len() >= MIN_PARALLEL {
        rayon::join(|| split(left, capacity), || split(right, capacity));
    } else {
        split(left, capacity);
        split(right, capacity);
    }
}
