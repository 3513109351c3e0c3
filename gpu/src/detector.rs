//! Detection on a device: boxes and positions go up, candidates and their distances come back.

use std::ops::Range;

use muslin_core::broad_phase::Surface;
use muslin_core::geometry::aabb::Aabb;
use muslin_core::real::Vec3;

use crate::buffer::{Failed, buffer, column, mapped};
use crate::device::Gpu;
use crate::params::{Capacities, PLAN_WORDS, Params, fresh_plan, plan};
use crate::schedule::{self, Order};
use crate::slots::{Sizes, Slot};
use crate::work::Work;

/// What is on a device for one surface.
#[derive(Debug)]
pub struct Detector {
    sizes: Sizes,
    params: Params,
    capacities: Capacities,
    continuous: bool,
    buffers: Vec<wgpu::Buffer>,
    work: Work,
    fresh: wgpu::Buffer,
    answer: wgpu::Buffer,
    /// Candidates of each kind that are read back.
    expected: [usize; 2],
    /// Of the last detection, by stage.
    ticks: Vec<(&'static str, u64)>,
    staging: Vec<f32>,
}

/// Candidates more than last time that are read back.
const SPARE: usize = 1024;

/// What is read back; the last two where motion is tested.
const ANSWERS: [Slot; 7] = [
    Slot::Plan,
    Slot::VertexTriangle,
    Slot::EdgeEdge,
    Slot::VertexTriangleDistances,
    Slot::EdgeEdgeDistances,
    Slot::VertexTriangleTimes,
    Slot::EdgeEdgeTimes,
];

/// What comes of an answer.
enum Verdict {
    Whole,
    /// So many of each kind are to be read back.
    Expect([usize; 2]),
    /// It takes more room.
    Grow(Capacities),
}

/// What was found; as the core's, in another order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Found {
    /// Vertex and triangle.
    pub vertex_triangle: Vec<[u32; 2]>,
    /// Two edges, the lesser first.
    pub edge_edge: Vec<[u32; 2]>,
    /// m.
    pub vertex_triangle_distances: Vec<f32>,
    /// m.
    pub edge_edge_distances: Vec<f32>,
    /// Parts of the step, where motion is tested.
    pub vertex_triangle_times: Vec<f32>,
    /// Likewise.
    pub edge_edge_times: Vec<f32>,
}

impl Detector {
    /// Makes room and sends what does not change.
    pub fn new(gpu: &Gpu, surface: &Surface<'_>, radii: &[f32], continuous: bool) -> Result<Self, Failed> {
        let sizes = Sizes::of(surface, radii.len());
        let triangles = sizes.triangles;
        let capacities = Capacities {
            levels: 1,
            entries: 4 * triangles.max(64),
            pairs: 16 * triangles.max(64),
            vertex_triangle: 4 * triangles.max(64),
            edge_edge: 8 * triangles.max(64),
        };
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
        let column = |slot: &Slot| column(gpu, *slot, slot.words(&sizes, &capacities));
        let buffers = Slot::ALL.iter().map(column).collect::<Result<Vec<_>, _>>()?;
        let mut detector = Self {
            sizes,
            params,
            capacities,
            continuous,
            buffers,
            work: Work::default(),
            fresh,
            answer: buffer(gpu, "answer", 0, wgpu::BufferUsages::MAP_READ)?,
            expected: [0; 2],
            ticks: Vec::new(),
            staging: Vec::new(),
        };
        detector.send(gpu, Slot::Triangles, bytemuck::cast_slice(surface.triangles));
        detector.send(gpu, Slot::TriangleEdges, bytemuck::cast_slice(surface.triangle_edges));
        detector.send(gpu, Slot::Edges, bytemuck::cast_slice(surface.edges));
        detector.send(gpu, Slot::Radii, bytemuck::cast_slice(radii));
        let given: Vec<u32> = surface.owned.iter().map(|&owned| owned.into()).collect();
        detector.send(gpu, Slot::Given, bytemuck::cast_slice(&given));
        let sewn = [surface.sewn.offsets, surface.sewn.others].concat();
        detector.send(gpu, Slot::Sewn, bytemuck::cast_slice(&sewn));
        detector.lay_out(gpu)?;
        Ok(detector)
    }

    fn buffer(&self, slot: Slot) -> &wgpu::Buffer {
        &self.buffers[slot as usize]
    }

    fn send(&self, gpu: &Gpu, slot: Slot, bytes: &[u8]) {
        if !bytes.is_empty() {
            gpu.queue.write_buffer(self.buffer(slot), 0, bytes);
        }
    }

    /// Plans the dispatches and binds the columns, for the capacities that there are.
    fn lay_out(&mut self, gpu: &Gpu) -> Result<(), Failed> {
        let Self { params, sizes, capacities, continuous, .. } = *self;
        let params = Params {
            entries: capacities.entries as u32,
            pairs: capacities.pairs as u32,
            vertex_triangle: capacities.vertex_triangle as u32,
            edge_edge: capacities.edge_edge as u32,
            ..params
        };
        let dispatches = schedule::of(&Order { params, sizes, capacities, continuous });
        self.work = Work::new(gpu, dispatches, &self.buffers)?;
        self.expected = [capacities.vertex_triangle, capacities.edge_edge];
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        self.answer = buffer(gpu, "answer", 4 * self.answer_words(), usage)?;
        Ok(())
    }

    /// What is read back, and to which words.
    fn answers(&self) -> impl Iterator<Item = (Slot, Range<usize>)> {
        let [vertex_triangle, edge_edge] = self.expected;
        let count = if self.continuous { ANSWERS.len() } else { ANSWERS.len() - 2 };
        let words = move |slot| match slot {
            Slot::VertexTriangle => 2 * vertex_triangle,
            Slot::EdgeEdge => 2 * edge_edge,
            Slot::VertexTriangleDistances | Slot::VertexTriangleTimes => vertex_triangle,
            Slot::EdgeEdgeDistances | Slot::EdgeEdgeTimes => edge_edge,
            _ => PLAN_WORDS,
        };
        ANSWERS.into_iter().take(count).scan(0, move |at, slot| {
            let start = core::mem::replace(at, *at + words(slot));
            Some((slot, start..*at))
        })
    }

    /// Words of an answer, the ticks behind the rest.
    fn answer_words(&self) -> usize {
        self.ticks_at().end
    }

    fn ticks_at(&self) -> Range<usize> {
        let start = self.answers().last().map_or(0, |(_, words)| words.end);
        start..start + self.work.tick_words()
    }

    /// How far is looked, and what moving features keep, m.
    pub fn set_distances(&mut self, gpu: &Gpu, reach: f32, separation: f32) {
        if (self.params.reach, self.params.separation) != (reach, separation) {
            (self.params.reach, self.params.separation) = (reach, separation);
            self.work.tell(gpu, |params| (params.reach, params.separation) = (reach, separation));
        }
    }

    /// Finds the candidates of a surface from one box a vertex, and their distances at the start; with
    /// `end` also when they meet.
    pub async fn detect(
        &mut self,
        gpu: &Gpu,
        boxes: &[Aabb],
        start: &[Vec3],
        end: &[Vec3],
        found: &mut Found,
    ) -> Result<(), Failed> {
        self.staging.clear();
        self.staging.extend(boxes.iter().flat_map(finite));
        self.send(gpu, Slot::Boxes, bytemuck::cast_slice(&self.staging));
        self.send(gpu, Slot::Start, bytemuck::cast_slice(start));
        self.send(gpu, Slot::End, bytemuck::cast_slice(end));
        self.ticks.clear();
        loop {
            self.submit(gpu);
            mapped(gpu, &self.answer, 4 * self.answer_words() as u64).await?;
            let verdict = self.collect(found)?;
            self.answer.unmap();
            match verdict {
                Verdict::Whole => return Ok(()),
                Verdict::Expect(counts) => self.expect(counts),
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

    /// Records all dispatches and hands them in.
    fn submit(&self, gpu: &Gpu) {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(&self.fresh, 0, self.buffer(Slot::Plan), 0, None);
        encoder.clear_buffer(self.buffer(Slot::Histogram), 0, None);
        self.work.record(gpu, &mut encoder);
        for (slot, words) in self.answers().filter(|(_, words)| !words.is_empty()) {
            let [at, bytes] = [words.start, words.len()].map(|words| 4 * words as u64);
            encoder.copy_buffer_to_buffer(self.buffer(slot), 0, &self.answer, at, Some(bytes));
        }
        self.work.copy_ticks(&mut encoder, &self.answer, self.ticks_at());
        gpu.queue.submit([encoder.finish()]);
    }

    /// Reads the answer, as far as it is one.
    fn collect(&mut self, found: &mut Found) -> Result<Verdict, Failed> {
        let bytes = 4 * self.answer_words() as u64;
        let view = self.answer.slice(..bytes).get_mapped_range().map_err(|error| Failed::Lost(error.to_string()))?;
        let all: &[u32] = bytemuck::cast_slice(&view);
        self.work.add_ticks(&all[self.ticks_at()], &mut self.ticks);
        let told = &all[..PLAN_WORDS];
        if told[plan::STATUS] != 0 {
            return Ok(Verdict::Grow(self.capacities.grown(told)));
        }
        let counts = [plan::VERTEX_TRIANGLE, plan::EDGE_EDGE].map(|at| told[at] as usize);
        if counts[0] > self.expected[0] || counts[1] > self.expected[1] {
            return Ok(Verdict::Expect(counts));
        }
        for (slot, words) in self.answers() {
            let words = &all[words];
            match slot {
                Slot::VertexTriangle => take(words, counts[0], &mut found.vertex_triangle),
                Slot::EdgeEdge => take(words, counts[1], &mut found.edge_edge),
                Slot::VertexTriangleDistances => take(words, counts[0], &mut found.vertex_triangle_distances),
                Slot::EdgeEdgeDistances => take(words, counts[1], &mut found.edge_edge_distances),
                Slot::VertexTriangleTimes => take(words, counts[0], &mut found.vertex_triangle_times),
                Slot::EdgeEdgeTimes => take(words, counts[1], &mut found.edge_edge_times),
                _ => {}
            }
        }
        drop(view);
        self.expect(counts);
        Ok(Verdict::Whole)
    }

    /// Reads back so many of each kind next time and some more.
    fn expect(&mut self, counts: [usize; 2]) {
        let rooms = [self.capacities.vertex_triangle, self.capacities.edge_edge];
        self.expected = [0, 1].map(|k| (counts[k] + counts[k] / 4 + SPARE).min(rooms[k]));
    }

    fn grow(&mut self, gpu: &Gpu, capacities: Capacities) -> Result<(), Failed> {
        let before = core::mem::replace(&mut self.capacities, capacities);
        for slot in Slot::ALL {
            if slot.words(&self.sizes, &capacities) != slot.words(&self.sizes, &before) {
                self.buffers[slot as usize] = column(gpu, slot, slot.words(&self.sizes, &capacities))?;
            }
        }
        self.lay_out(gpu)
    }
}

impl Capacities {
    /// Room for what was counted and a quarter more. A stage that ran short leaves later ones without
    /// all they would count, so that more than one round may be needed.
    fn grown(&self, told: &[u32]) -> Self {
        let room = |now: usize, at: usize| {
            let needed = told[at] as usize;
            if needed > now { needed + needed / 4 } else { now }
        };
        // Candidates are counted when pairs have room: what pairs have in dense scenes saves a round.
        let pairs = room(self.pairs, plan::PAIRS);
        let dense = if pairs > self.pairs { pairs } else { 0 };
        Self {
            levels: self.levels.max(told[plan::GRADED] as usize),
            entries: room(self.entries, plan::MOST_ENTRIES),
            pairs,
            vertex_triangle: room(self.vertex_triangle, plan::VERTEX_TRIANGLE).max(dense / 2),
            edge_edge: room(self.edge_edge, plan::EDGE_EDGE).max(dense),
        }
    }
}

/// Takes the first things out of words.
fn take<T: bytemuck::Pod>(words: &[u32], count: usize, to: &mut Vec<T>) {
    to.clear();
    to.extend_from_slice(&bytemuck::cast_slice(words)[..count]);
}

/// A box in finite numbers; one that is not valid has its corners exchanged.
fn finite(b: &Aabb) -> [f32; 6] {
    let ordered = b.min.cmple(b.max).all();
    let [low, high] = if ordered { [b.min, b.max] } else { [Vec3::MAX, Vec3::MIN] };
    let [low, high] = [low, high].map(|corner| corner.clamp(Vec3::MIN, Vec3::MAX).to_array());
    [low[0], low[1], low[2], high[0], high[1], high[2]]
}
