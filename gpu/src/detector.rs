//! Detection on a device: boxes and positions go up, candidates and their distances come back.

use std::ops::Range;

use muslin_core::broad_phase::Surface;
use muslin_core::geometry::aabb::Aabb;
use muslin_core::real::Vec3;

use crate::answer::{Answer, Found, Wanted};
use crate::buffer::{Failed, buffer, bytes_of, column, mapped};
use crate::device::Gpu;
use crate::params::{Capacities, PLAN_WORDS, Params, ROUND, fresh_plan, plan};
use crate::schedule::{self, Order};
use crate::slots::{Sizes, Slot};
use crate::work::Work;

/// What is on a device for one surface.
#[derive(Debug)]
pub struct Detector {
    sizes: Sizes,
    params: Params,
    capacities: Capacities,
    buffers: Vec<wgpu::Buffer>,
    work: Work,
    fresh: wgpu::Buffer,
    /// What comes back, and where it comes to.
    answer: Answer,
    /// None while it is mapped: what fails or is given up meanwhile leaves none behind.
    landing: Option<wgpu::Buffer>,
    /// Of the last detection, by stage.
    ticks: Vec<(&'static str, u64)>,
    staging: Vec<f32>,
}

/// What comes of an answer.
enum Verdict {
    Whole,
    /// So much is to be read back.
    Expect([usize; 2]),
    /// It takes more room.
    Grow(Capacities),
}

impl Detector {
    /// Makes room and sends what does not change.
    pub fn new(gpu: &Gpu, surface: &Surface<'_>, radii: &[f32], wanted: Wanted) -> Result<Self, Failed> {
        let sizes = Sizes::of(surface, radii.len());
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
        let fresh = buffer(gpu, "fresh", 4 * PLAN_WORDS, wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST)?;
        gpu.queue.write_buffer(&fresh, 0, bytemuck::cast_slice(&fresh_plan()));
        let mut detector = Self {
            sizes,
            params,
            capacities,
            buffers: Vec::new(),
            work: Work::default(),
            fresh,
            answer: Answer { wanted, pairs: [0; 2] },
            landing: None,
            ticks: Vec::new(),
            staging: Vec::new(),
        };
        // What was refused before, or to others.
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
        if !bytes.is_empty() && slot.serves(self.answer.wanted) {
            gpu.queue.write_buffer(self.buffer(slot), 0, bytes);
        }
    }

    /// Makes room: columns of the new lengths, dispatches planned and bound to them. Where that fails
    /// nothing is changed.
    fn grow(&mut self, gpu: &Gpu, capacities: Capacities) -> Result<(), Failed> {
        let (sizes, wanted) = (self.sizes, self.answer.wanted);
        let buffers = Slot::ALL.iter().map(|&slot| {
            let words = if slot.serves(wanted) { slot.words(&sizes, &capacities) } else { 0 };
            match self.buffers.get(slot as usize) {
                Some(kept) if kept.size() == bytes_of(words) => Ok(kept.clone()),
                _ => column(gpu, slot, words),
            }
        });
        let buffers = buffers.collect::<Result<Vec<_>, _>>()?;
        let order = Order { params: self.params, sizes, capacities, wanted };
        let work = Work::new(gpu, schedule::of(&order), &buffers)?;
        if let Some(why) = gpu.error() {
            return Err(Failed::Lost(why));
        }
        (self.capacities, self.buffers, self.work) = (capacities, buffers, work);
        let none = Answer { wanted, pairs: [0; 2] };
        self.expect(gpu, [Answer::most(wanted, &capacities), self.answer, none])
    }

    /// Reads back the first of these from now on whose landing is not too large.
    fn expect<const N: usize>(&mut self, gpu: &Gpu, answers: [Answer; N]) -> Result<(), Failed> {
        let bytes = |answer: &Answer| bytes_of(answer.words() + self.work.tick_words());
        let fitting = answers.iter().find(|answer| bytes(answer) <= gpu.largest_landing);
        self.answer = *fitting.ok_or_else(|| Failed::TooLarge(answers.last().map_or(0, bytes)))?;
        Ok(())
    }

    /// Reads back so much next time, and if there may be some more.
    fn expect_about(&mut self, gpu: &Gpu, pairs: [usize; 2]) -> Result<(), Failed> {
        let exactly = Answer { pairs, ..self.answer };
        self.expect(gpu, [self.answer.expecting(pairs, &self.capacities), exactly])
    }

    /// Takes what answers land in, as large as the next one.
    fn landing(&mut self, gpu: &Gpu) -> Result<wgpu::Buffer, Failed> {
        let words = self.ticks_at().end;
        match self.landing.take() {
            Some(landing) if landing.size() >= bytes_of(words) => Ok(landing),
            _ => buffer(gpu, "landing", 4 * words, wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST),
        }
    }

    /// Words of the ticks, behind the answer.
    fn ticks_at(&self) -> Range<usize> {
        let start = self.answer.words();
        start..start + self.work.tick_words()
    }

    /// How far is looked, and what moving features keep, m.
    pub fn set_distances(&mut self, gpu: &Gpu, reach: f32, separation: f32) {
        if (self.params.reach, self.params.separation) != (reach, separation) {
            (self.params.reach, self.params.separation) = (reach, separation);
            self.work.tell(gpu, |params| (params.reach, params.separation) = (reach, separation));
        }
    }

    /// Finds the candidates of a surface from one box a vertex, and of what is wanted their distances at
    /// the start and when they meet on the way to the end.
    pub async fn detect(
        &mut self,
        gpu: &Gpu,
        boxes: &[Aabb],
        start: &[Vec3],
        end: &[Vec3],
        found: &mut Found,
    ) -> Result<(), Failed> {
        let own = self.sizes.vertices;
        if boxes.len() != own || start.len() != own || end.len() != own {
            return Err(Failed::Lengths { needed: own });
        }
        // What was refused before, or to others.
        let _ = gpu.error();
        self.staging.clear();
        self.staging.extend(boxes.iter().flat_map(finite));
        self.send(gpu, Slot::Boxes, bytemuck::cast_slice(&self.staging));
        self.send(gpu, Slot::Start, bytemuck::cast_slice(start));
        self.send(gpu, Slot::End, bytemuck::cast_slice(end));
        self.ticks.clear();
        // Whether the columns are whole on the device, so that they need only be copied.
        let mut is_found = false;
        loop {
            let landing = self.landing(gpu)?;
            self.submit(gpu, &landing, is_found);
            mapped(gpu, &landing, bytes_of(self.ticks_at().end)).await?;
            let verdict = self.collect(gpu, &landing, is_found, found)?;
            landing.unmap();
            self.landing = Some(landing);
            match verdict {
                Verdict::Whole => return Ok(()),
                Verdict::Expect(counted) => {
                    self.expect_about(gpu, counted)?;
                    is_found = true;
                }
                Verdict::Grow(capacities) if capacities == self.capacities => {
                    return Err(Failed::Lost("it asks for more room than it fills".into()));
                }
                Verdict::Grow(capacities) => self.grow(gpu, capacities)?,
            }
        }
    }

    /// What the device took for each stage of the last detection, ms; empty where it has no clocks. A
    /// stage that was repeated for want of room counts as often.
    pub fn stage_ms(&self, gpu: &Gpu) -> impl Iterator<Item = (&'static str, f64)> {
        let tick = gpu.tick.unwrap_or_default();
        self.ticks.iter().map(move |&(stage, ticks)| (stage, tick * ticks as f64))
    }

    /// Records all dispatches, unless all is found, and the copies of the answer, and hands them in.
    fn submit(&self, gpu: &Gpu, landing: &wgpu::Buffer, is_found: bool) {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        if !is_found {
            encoder.copy_buffer_to_buffer(&self.fresh, 0, self.buffer(Slot::Plan), 0, None);
            encoder.clear_buffer(self.buffer(Slot::Histogram), 0, None);
            self.work.record(gpu, &mut encoder);
            self.work.copy_ticks(&mut encoder, landing, self.ticks_at());
        }
        for (slot, words) in self.answer.parts().filter(|(_, words)| !words.is_empty()) {
            let [at, bytes] = [words.start, words.len()].map(|words| 4 * words as u64);
            encoder.copy_buffer_to_buffer(self.buffer(slot), 0, landing, at, Some(bytes));
        }
        gpu.queue.submit([encoder.finish()]);
    }

    /// Reads the answer, as far as it is one.
    fn collect(
        &mut self,
        gpu: &Gpu,
        landing: &wgpu::Buffer,
        is_found: bool,
        found: &mut Found,
    ) -> Result<Verdict, Failed> {
        let bytes = bytes_of(self.ticks_at().end);
        let view = landing.slice(..bytes).get_mapped_range().map_err(|error| Failed::Lost(error.to_string()))?;
        let all: &[u32] = bytemuck::cast_slice(&view);
        if !is_found {
            self.work.add_ticks(&all[self.ticks_at()], &mut self.ticks);
        }
        let told = &all[..PLAN_WORDS];
        if told[plan::STATUS] != 0 {
            return self.capacities.grown(told, gpu.largest_buffer).map(Verdict::Grow);
        }
        let counted = self.answer.counted(told);
        if counted[0] > self.answer.pairs[0] || counted[1] > self.answer.pairs[1] {
            return Ok(Verdict::Expect(counted));
        }
        self.answer.read(all, found);
        drop(view);
        self.expect_about(gpu, counted)?;
        Ok(Verdict::Whole)
    }
}

impl Capacities {
    /// Room in flat cloth, as far as a buffer may be large.
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

    /// Room for what was counted and a quarter more, as far as a buffer may be large. A stage that ran
    /// short leaves later ones without all they would count, so that more than one round may be needed.
    fn grown(&self, told: &[u32], largest_buffer: u64) -> Result<Self, Failed> {
        let most = most_pairs(largest_buffer);
        let room_for = |now: usize, needed: u32| {
            let (bytes, needed) = (PAIR * u64::from(needed), needed as usize);
            match needed > now {
                true if bytes > largest_buffer => Err(Failed::TooLarge(bytes)),
                true => Ok(needed.max((needed + needed / 4).min(most))),
                false => Ok(now),
            }
        };
        let room = |now, at: usize| room_for(now, told[at]);
        // Candidates are counted when pairs have room: what pairs have in dense scenes saves a round.
        let pairs = room(self.pairs, plan::PAIRS)?;
        let dense = if pairs > self.pairs { pairs.min(most) } else { 0 };
        Ok(Self {
            levels: self.levels.max(told[plan::GRADED] as usize),
            entries: room(self.entries, plan::MOST_ENTRIES)?,
            tiles: room(self.tiles, plan::MOST_TILES)?,
            rounds: self.rounds.max((told[plan::SINGLE] as usize).div_ceil(ROUND)),
            pairs,
            vertex_triangle: room(self.vertex_triangle, plan::VERTEX_TRIANGLE)?.max(dense / 2),
            edge_edge: room(self.edge_edge, plan::EDGE_EDGE)?.max(dense),
            contacts: room_for(self.contacts, told[plan::CONTACTS].saturating_add(told[plan::CONTACTS + 1]))?,
        })
    }
}

/// Bytes of a pair.
const PAIR: u64 = 8;

/// How many pairs of one kind, or entries with their boxes, a buffer may hold beside as many of another.
fn most_pairs(largest_buffer: u64) -> usize {
    usize::try_from(largest_buffer / (2 * PAIR)).unwrap_or(usize::MAX)
}

/// A box in finite numbers; one that is not valid has its corners exchanged.
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
            let mut told = fresh_plan();
            told[plan::PAIRS] = pairs;
            now.grown(&told, largest_buffer).map(|grown| grown.pairs)
        };
        // A quarter more, less where two buffers would not both fit, and no less than needed.
        for (needed, expected) in [(0, now.pairs), (600, 750), (900, 1000), (1000, 1000), (1001, 1001), (2000, 2000)] {
            assert_eq!(with(needed), Ok(expected), "{needed} pairs");
        }
        assert_eq!(with(2001), Err(Failed::TooLarge(16_008)));
        assert!(matches!(with(u32::MAX), Err(Failed::TooLarge(_))));
    }
}
