//! Collision detection on a device: uploads boxes and positions, reads back candidates and their distances.

use std::ops::Range;

use muslin_core::broad_phase::Surface;
use muslin_core::geometry::aabb::Aabb;
use muslin_core::real::Vec3;

use crate::buffer::{DetectionError, buffer, bytes_of, column, mapped};
use crate::command_list::CommandList;
use crate::device::Gpu;
use crate::params::{COUNTER_WORDS, Capacities, Params, ROUND, counters, initial_counters};
use crate::readback::{DetectionQuery, DetectionResult, ReadbackLayout};
use crate::schedule::{self, Order};
use crate::slots::{Slot, SurfaceSizes};

/// The columns and dispatches of one surface on a device.
#[derive(Debug)]
pub struct Detector {
    sizes: SurfaceSizes,
    params: Params,
    capacities: Capacities,
    buffers: Vec<wgpu::Buffer>,
    commands: CommandList,
    fresh: wgpu::Buffer,
    /// Layout of the next readback.
    layout: ReadbackLayout,
    /// The readback buffer. `None` while it is mapped, so that a detection that fails or is dropped meanwhile does
    /// not leave a mapped buffer here.
    readback: Option<wgpu::Buffer>,
    /// Ticks of each stage in the last detection.
    ticks: Vec<(&'static str, u64)>,
    staging: Vec<f32>,
}

/// Result of reading the readback buffer.
enum Verdict {
    Whole,
    /// The readback buffer must hold this many pairs of each kind.
    Expect([usize; 2]),
    /// The columns must have these capacities.
    Grow(Capacities),
}

impl Detector {
    /// Allocates the columns and uploads the data that does not change.
    pub fn new(gpu: &Gpu, surface: &Surface<'_>, radii: &[f32], query: DetectionQuery) -> Result<Self, DetectionError> {
        let sizes = SurfaceSizes::of(surface, radii.len());
        let triangles = sizes.triangles;
        let capacities = Capacities::guess(triangles, gpu.largest_buffer);
        let params = Params {
            vertices: sizes.vertices as u32,
            triangles: triangles as u32,
            first_passive: surface.first_passive,
            own_contact: surface.own_contact.into(),
            sewn: u32::from(!surface.sewn.offsets.is_empty()),
            ..Params::default()
        };
        let fresh =
            buffer(gpu, "fresh", 4 * COUNTER_WORDS, wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST)?;
        gpu.queue.write_buffer(&fresh, 0, bytemuck::cast_slice(&initial_counters()));
        let mut detector = Self {
            sizes,
            params,
            capacities,
            buffers: Vec::new(),
            commands: CommandList::default(),
            fresh,
            layout: ReadbackLayout { query, pairs: [0; 2] },
            readback: None,
            ticks: Vec::new(),
            staging: Vec::new(),
        };
        // Drops errors of earlier calls and of other users of the device.
        let _ = gpu.error();
        detector.grow(gpu, capacities)?;
        detector.send(gpu, Slot::Triangles, bytemuck::cast_slice(surface.triangles));
        detector.send(gpu, Slot::TriangleEdges, bytemuck::cast_slice(surface.triangle_edges));
        detector.send(gpu, Slot::Edges, bytemuck::cast_slice(surface.edges));
        detector.send(gpu, Slot::Radii, bytemuck::cast_slice(radii));
        let given: Vec<u32> = surface.owned.iter().map(|&owned| owned.into()).collect();
        detector.send(gpu, Slot::Given, bytemuck::cast_slice(&given));
        let sewn = [surface.sewn.offsets, surface.sewn.others].concat();
        detector.send(gpu, Slot::Sewn, bytemuck::cast_slice(&sewn));
        Ok(detector)
    }

    fn buffer(&self, slot: Slot) -> &wgpu::Buffer {
        &self.buffers[slot as usize]
    }

    fn send(&self, gpu: &Gpu, slot: Slot, bytes: &[u8]) {
        if !bytes.is_empty() && slot.serves(self.layout.query) {
            gpu.queue.write_buffer(self.buffer(slot), 0, bytes);
        }
    }

    /// Allocates columns for new capacities, plans the dispatches and binds them. If this fails, nothing
    /// changes.
    fn grow(&mut self, gpu: &Gpu, capacities: Capacities) -> Result<(), DetectionError> {
        let (sizes, query) = (self.sizes, self.layout.query);
        let buffers = Slot::ALL.iter().map(|&slot| {
            let words = if slot.serves(query) { slot.words(&sizes, &capacities) } else { 0 };
            match self.buffers.get(slot as usize) {
                Some(kept) if kept.size() == bytes_of(words) => Ok(kept.clone()),
                _ => column(gpu, slot, words),
            }
        });
        let buffers = buffers.collect::<Result<Vec<_>, _>>()?;
        let order = Order { params: self.params, sizes, capacities, query };
        let commands = CommandList::new(gpu, schedule::of(&order), &buffers)?;
        if let Some(why) = gpu.error() {
            return Err(DetectionError::Lost(why));
        }
        (self.capacities, self.buffers, self.commands) = (capacities, buffers, commands);
        let none = ReadbackLayout { query, pairs: [0; 2] };
        self.expect(gpu, [ReadbackLayout::most(query, &capacities), self.layout, none])
    }

    /// Selects the first of these layouts whose readback buffer is not too large for the device.
    fn expect<const N: usize>(&mut self, gpu: &Gpu, layouts: [ReadbackLayout; N]) -> Result<(), DetectionError> {
        let bytes = |layout: &ReadbackLayout| bytes_of(layout.words() + self.commands.tick_words());
        let fitting = layouts.iter().find(|layout| bytes(layout) <= gpu.largest_readback);
        self.layout = *fitting.ok_or_else(|| DetectionError::TooLarge(layouts.last().map_or(0, bytes)))?;
        Ok(())
    }

    /// Selects a layout for `pairs` pairs of each kind and some spare, or without the spare if that is too large.
    fn expect_about(&mut self, gpu: &Gpu, pairs: [usize; 2]) -> Result<(), DetectionError> {
        let exactly = ReadbackLayout { pairs, ..self.layout };
        self.expect(gpu, [self.layout.expecting(pairs, &self.capacities), exactly])
    }

    /// Takes the readback buffer, or makes a new one if it is too small for the current layout.
    fn readback(&mut self, gpu: &Gpu) -> Result<wgpu::Buffer, DetectionError> {
        let words = self.ticks_at().end;
        match self.readback.take() {
            Some(readback) if readback.size() >= bytes_of(words) => Ok(readback),
            _ => buffer(gpu, "readback", 4 * words, wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST),
        }
    }

    /// Words of the timestamps in the readback buffer, behind the columns.
    fn ticks_at(&self) -> Range<usize> {
        let start = self.layout.words();
        start..start + self.commands.tick_words()
    }

    /// Sets two distances in metres. If the boxes of a pair are farther apart than `reach`, the result is a lower bound
    /// of the distance. `separation` is the distance that moving features must keep from one another.
    pub fn set_distances(&mut self, gpu: &Gpu, reach: f32, separation: f32) {
        if (self.params.reach, self.params.separation) != (reach, separation) {
            (self.params.reach, self.params.separation) = (reach, separation);
            self.commands.write_uniforms(gpu, |params| (params.reach, params.separation) = (reach, separation));
        }
    }

    /// Takes one box per vertex. Finds the candidates; for the other queries, also the distance of each at `start`, and
    /// for `DetectionQuery::Times` when each collides on the way to `end`. Fails if the lengths of the slices are not
    /// the number of vertices, or if the device fails.
    pub async fn detect(
        &mut self,
        gpu: &Gpu,
        boxes: &[Aabb],
        start: &[Vec3],
        end: &[Vec3],
        found: &mut DetectionResult,
    ) -> Result<(), DetectionError> {
        let own = self.sizes.vertices;
        if boxes.len() != own || start.len() != own || end.len() != own {
            return Err(DetectionError::Lengths { needed: own });
        }
        // Drops errors of earlier calls and of other users of the device.
        let _ = gpu.error();
        self.staging.clear();
        self.staging.extend(boxes.iter().flat_map(finite));
        self.send(gpu, Slot::Boxes, bytemuck::cast_slice(&self.staging));
        self.send(gpu, Slot::Start, bytemuck::cast_slice(start));
        self.send(gpu, Slot::End, bytemuck::cast_slice(end));
        self.ticks.clear();
        // Whether the columns on the device are complete, so that only the copy must be repeated.
        let mut is_found = false;
        loop {
            let readback = self.readback(gpu)?;
            self.submit(gpu, &readback, is_found);
            mapped(gpu, &readback, bytes_of(self.ticks_at().end)).await?;
            let verdict = self.collect(gpu, &readback, is_found, found)?;
            readback.unmap();
            self.readback = Some(readback);
            match verdict {
                Verdict::Whole => return Ok(()),
                Verdict::Expect(counted) => {
                    self.expect_about(gpu, counted)?;
                    is_found = true;
                }
                Verdict::Grow(capacities) if capacities == self.capacities => {
                    return Err(DetectionError::Lost("the device reports more candidates than it wrote".into()));
                }
                Verdict::Grow(capacities) => self.grow(gpu, capacities)?,
            }
        }
    }

    /// Device time of each stage in the last detection, ms; empty if the device has no timestamps. If a
    /// stage was repeated because a column was too short, all its runs count.
    pub fn stage_ms(&self, gpu: &Gpu) -> impl Iterator<Item = (&'static str, f64)> {
        let tick = gpu.tick.unwrap_or_default();
        self.ticks.iter().map(move |&(stage, ticks)| (stage, tick * ticks as f64))
    }

    /// Submits all dispatches and then the copies to the readback buffer; only the copies if the columns are already
    /// complete.
    fn submit(&self, gpu: &Gpu, readback: &wgpu::Buffer, is_found: bool) {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        if !is_found {
            encoder.copy_buffer_to_buffer(&self.fresh, 0, self.buffer(Slot::Counters), 0, None);
            encoder.clear_buffer(self.buffer(Slot::Histogram), 0, None);
            self.commands.record(gpu, &mut encoder);
            self.commands.copy_ticks(&mut encoder, readback, self.ticks_at());
        }
        for (slot, words) in self.layout.parts().filter(|(_, words)| !words.is_empty()) {
            let [at, bytes] = [words.start, words.len()].map(|words| 4 * words as u64);
            encoder.copy_buffer_to_buffer(self.buffer(slot), 0, readback, at, Some(bytes));
        }
        gpu.queue.submit([encoder.finish()]);
    }

    /// Reads the counters and, if they show that the readback is complete, the results.
    fn collect(
        &mut self,
        gpu: &Gpu,
        readback: &wgpu::Buffer,
        is_found: bool,
        found: &mut DetectionResult,
    ) -> Result<Verdict, DetectionError> {
        let bytes = bytes_of(self.ticks_at().end);
        let view =
            readback.slice(..bytes).get_mapped_range().map_err(|error| DetectionError::Lost(error.to_string()))?;
        let all: &[u32] = bytemuck::cast_slice(&view);
        if !is_found {
            self.commands.add_ticks(&all[self.ticks_at()], &mut self.ticks);
        }
        let words = &all[..COUNTER_WORDS];
        if words[counters::STATUS] != 0 {
            return self.capacities.grown(words, gpu.largest_buffer).map(Verdict::Grow);
        }
        let counted = self.layout.counted(words);
        if counted[0] > self.layout.pairs[0] || counted[1] > self.layout.pairs[1] {
            return Ok(Verdict::Expect(counted));
        }
        self.layout.read(all, found);
        drop(view);
        self.expect_about(gpu, counted)?;
        Ok(Verdict::Whole)
    }
}

impl Capacities {
    /// Initial capacities: enough for flat cloth, limited by the size of a buffer.
    fn guess(triangles: usize, largest_buffer: u64) -> Self {
        let room = |each: usize| (each * triangles.max(64)).min(most_pairs(largest_buffer));
        Self {
            levels: 1,
            entries: room(3),
            tiles: room(1) / 4,
            rounds: 1,
            pairs: room(8),
            vertex_triangle: room(4),
            edge_edge: room(8),
            contacts: room(4),
        }
    }

    /// Capacities for the counted sizes and a quarter more, limited by the size of a buffer. A stage that
    /// overflows keeps later stages from counting, so that more than one round may be needed.
    fn grown(&self, words: &[u32], largest_buffer: u64) -> Result<Self, DetectionError> {
        let most = most_pairs(largest_buffer);
        let room_for = |now: usize, needed: u32| {
            let (bytes, needed) = (PAIR * u64::from(needed), needed as usize);
            match needed > now {
                true if bytes > largest_buffer => Err(DetectionError::TooLarge(bytes)),
                true => Ok(needed.max((needed + needed / 4).min(most))),
                false => Ok(now),
            }
        };
        let room = |now, at: usize| room_for(now, words[at]);
        // Candidates are not counted until the pairs of triangles fit. When the capacity for pairs of triangles grows,
        // those for candidates grow too. This saves a round in dense scenes.
        let pairs = room(self.pairs, counters::PAIRS)?;
        let dense = if pairs > self.pairs { pairs.min(most) } else { 0 };
        Ok(Self {
            levels: self.levels.max(words[counters::GRADED] as usize),
            entries: room(self.entries, counters::MOST_ENTRIES)?,
            tiles: room(self.tiles, counters::MOST_TILES)?,
            rounds: self.rounds.max((words[counters::SINGLE] as usize).div_ceil(ROUND)),
            pairs,
            vertex_triangle: room(self.vertex_triangle, counters::VERTEX_TRIANGLE)?.max(dense / 2),
            edge_edge: room(self.edge_edge, counters::EDGE_EDGE)?.max(dense),
            contacts: room_for(self.contacts, words[counters::CONTACTS].saturating_add(words[counters::CONTACTS + 1]))?,
        })
    }
}

/// Size of a pair, bytes.
const PAIR: u64 = 8;

/// The largest n for which one buffer holds n pairs of each of the two kinds. The same n limits the entries: the box of
/// an entry is as large as two pairs.
fn most_pairs(largest_buffer: u64) -> usize {
    usize::try_from(largest_buffer / (2 * PAIR)).unwrap_or(usize::MAX)
}

/// Minimum and maximum of a box, limited to finite numbers. An invalid box gets f32::MAX as its minimum and f32::MIN as
/// its maximum.
fn finite(b: &Aabb) -> [f32; 6] {
    let ordered = b.min.cmple(b.max).all();
    let [low, high] = if ordered { [b.min, b.max] } else { [Vec3::MAX, Vec3::MIN] };
    let [low, high] = [low, high].map(|corner| corner.clamp(Vec3::MIN, Vec3::MAX).to_array());
    [low[0], low[1], low[2], high[0], high[1], high[2]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn room_grows_as_far_as_a_buffer_does() {
        let largest_buffer = 16 * 1000;
        let now = Capacities::guess(0, largest_buffer);
        let with = |pairs: u32| {
            let mut words = initial_counters();
            words[counters::PAIRS] = pairs;
            now.grown(&words, largest_buffer).map(|grown| grown.pairs)
        };
        // The capacity is the needed number plus a quarter. It is smaller if a buffer could not hold that many pairs of
        // both kinds, but never below the needed number.
        for (needed, expected) in [(0, now.pairs), (600, 750), (900, 1000), (1000, 1000), (1001, 1001), (2000, 2000)] {
            assert_eq!(with(needed), Ok(expected), "{needed} pairs");
        }
        assert_eq!(with(2001), Err(DetectionError::TooLarge(16_008)));
        assert!(matches!(with(u32::MAX), Err(DetectionError::TooLarge(_))));
    }
}
