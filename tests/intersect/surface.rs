//! The columns of a surface, built in the simplest way.

use std::collections::BTreeMap;

use muslin_core::broad_phase::IS_FACE;

/// The arrays that [`Surface`](muslin_core::broad_phase::Surface) borrows.
#[derive(Debug, Default)]
pub struct Columns {
    pub triangles: Vec<[u32; 3]>,
    pub triangle_edges: Vec<[u32; 3]>,
    pub owned: Vec<u8>,
    pub edges: Vec<[u32; 2]>,
    /// Row offsets of the sewn vertices; empty if nothing is sewn.
    pub offsets: Vec<u32>,
    pub others: Vec<u32>,
    pub first_passive: u32,
}

impl Columns {
    /// All triangles are faces; none is passive, and nothing is sewn.
    pub fn new(triangles: &[[u32; 3]]) -> Self {
        let mut numbers = BTreeMap::new();
        let mut columns = Self { triangles: triangles.to_vec(), ..Self::default() };
        for &[a, b, c] in triangles {
            let number = [[a, b], [b, c], [c, a]].map(|[a, b]| {
                let ends = [a.min(b), a.max(b)];
                *numbers.entry(ends).or_insert_with(|| {
                    columns.edges.push(ends);
                    columns.edges.len() as u32 - 1
                })
            });
            columns.triangle_edges.push(number);
        }
        columns.owned = vec![IS_FACE; triangles.len()];
        columns.first_passive = triangles.len() as u32;
        columns
    }

    /// Adds pairs of sewn vertices.
    pub fn sewn(mut self, pairs: &[[u32; 2]], vertices: usize) -> Self {
        let mut rows = vec![Vec::new(); vertices];
        for &[a, b] in pairs {
            rows[a as usize].push(b);
            rows[b as usize].push(a);
        }
        let ends = rows.iter().scan(0, |end, row| {
            *end += row.len() as u32;
            Some(*end)
        });
        self.offsets = std::iter::once(0).chain(ends).collect();
        self.others = rows.concat();
        self
    }
}

/// The columns as a surface of one of the two cores.
macro_rules! surface {
    ($muslin:ident, $columns:expr) => {
        $muslin::broad_phase::Surface {
            triangles: &$columns.triangles,
            triangle_edges: &$columns.triangle_edges,
            owned: &$columns.owned,
            edges: &$columns.edges,
            incidence: $muslin::mesh::Incidence { offsets: &[], slots: &[] },
            sewn: $muslin::broad_phase::Sewn { offsets: &$columns.offsets, others: &$columns.others },
            first_passive: $columns.first_passive,
            own_contact: true,
        }
    };
}
pub(crate) use surface;
