use crate::column::Column;

/// The element corners at each vertex, as CSR. The order of the corners is fixed, so that every
/// gathered sum is repeatable. A slot is `element * corners + corner`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Incidence<'a> {
    /// Start of each vertex's slots; one entry more than vertices.
    pub offsets: &'a [u32],
    /// Slots of each vertex, in the order of the elements.
    pub slots: &'a [u32],
}

impl<'a> Incidence<'a> {
    /// Range of a vertex's entries in `slots`.
    #[inline]
    pub fn range(&self, vertex: usize) -> core::ops::Range<usize> {
        self.offsets.at(vertex) as usize..self.offsets.at(vertex + 1) as usize
    }

    /// Bytes of the columns.
    pub fn bytes(&self) -> usize {
        size_of_val(self.offsets) + size_of_val(self.slots)
    }

    /// The slots of a vertex.
    #[inline]
    pub fn at(&self, vertex: usize) -> &'a [u32] {
        self.slots.part(self.range(vertex))
    }
}

/// The owned columns of an [`Incidence`].
#[cfg(feature = "alloc")]
#[derive(Clone, Debug, Default)]
pub struct IncidenceColumns {
    offsets: alloc::vec::Vec<u32>,
    slots: alloc::vec::Vec<u32>,
}

#[cfg(feature = "alloc")]
impl IncidenceColumns {
    /// Incidence of elements with `K` corners over `vertices` vertices.
    #[cfg_attr(small, optimize(size))]
    pub fn build<const K: usize>(vertices: usize, elements: &[[u32; K]]) -> Self {
        let mut offsets = alloc::vec![0u32; vertices + 1];
        for &v in elements.as_flattened() {
            offsets[v as usize + 1] += 1;
        }
        for v in 0..vertices {
            offsets[v + 1] += offsets[v];
        }
        let mut next = offsets.clone();
        let mut slots = alloc::vec![0u32; elements.len() * K];
        for (slot, &v) in elements.as_flattened().iter().enumerate() {
            slots[next[v as usize] as usize] = slot as u32;
            next[v as usize] += 1;
        }
        Self { offsets, slots }
    }

    /// The borrowed view that kernels take.
    pub fn view(&self) -> Incidence<'_> {
        Incidence { offsets: &self.offsets, slots: &self.slots }
    }
}
