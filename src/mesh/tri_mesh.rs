//! The mesh type: two flat arrays.

/// A triangle mesh: vertex positions in model units, and triangles as triples of vertex numbers,
/// counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriMesh {
    /// Vertex positions (x, y, z).
    pub vertices: Vec<[f64; 3]>,
    /// Vertex numbers of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl TriMesh {
    /// Returns the positions of the corners of triangle `t`.
    ///
    /// # Panics
    /// When `t` or one of its vertex numbers is out of range.
    pub fn corners(&self, t: usize) -> [[f64; 3]; 3] {
        self.triangles[t].map(|v| self.vertices[v as usize])
    }

    /// Drops vertices from number `first` on that no triangle has.
    pub(crate) fn drop_unreferenced_vertices(&mut self, first: usize) {
        let mut used = vec![false; self.vertices.len()];
        self.triangles.as_flattened().iter().for_each(|&v| used[v as usize] = true);
        let mut numbers: Vec<u32> = (0..self.vertices.len() as u32).collect();
        let mut next = first;
        for v in first..self.vertices.len() {
            numbers[v] = next as u32;
            if used[v] {
                self.vertices[next] = self.vertices[v];
                next += 1;
            }
        }
        self.vertices.truncate(next);
        self.triangles.as_flattened_mut().iter_mut().for_each(|v| *v = numbers[*v as usize]);
    }

    /// Returns the smallest and largest coordinates of all vertices; `None` without vertices.
    pub fn bounding_box(&self) -> Option<[[f64; 3]; 2]> {
        let first = *self.vertices.first()?;
        Some(self.vertices.iter().fold([first, first], |[lo, hi], v| {
            [std::array::from_fn(|a| lo[a].min(v[a])), std::array::from_fn(|a| hi[a].max(v[a]))]
        }))
    }
}
