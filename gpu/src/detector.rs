//! Detection on a device: boxes and positions go up, candidates and their distances come back.

use muslin_core::broad_phase::Surface;
use muslin_core::geometry::aabb::Aabb;
use muslin_core::real::Vec3;

use crate::buffer::{Failed, buffer, column, wait};
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
    staging: Vec<f32>,
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
        let words: usize = self.answers().iter().map(|&(_, words)| words).sum();
        self.answer = buffer(gpu, "answer", 4 * words, wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST)?;
        Ok(())
    }

    /// What is read back, and how many words.
    fn answers(&self) -> Vec<(Slot, usize)> {
        let times = [Slot::VertexTriangleTimes, Slot::EdgeEdgeTimes];
        let always =
            [Slot::Plan, Slot::VertexTriangle, Slot::EdgeEdge, Slot::VertexTriangleDistances, Slot::EdgeEdgeDistances];
        let slots = always.into_iter().chain(times.into_iter().filter(|_| self.continuous));
        slots.map(|slot| (slot, slot.words(&self.sizes, &self.capacities))).collect()
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
    pub fn detect(
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
        loop {
            self.submit(gpu);
            wait(gpu, &self.answer)?;
            let needed = self.collect(found)?;
            self.answer.unmap();
            match needed {
                None => return Ok(()),
                Some(capacities) => self.grow(gpu, capacities)?,
            }
        }
    }

    /// Records all dispatches and hands them in.
    fn submit(&self, gpu: &Gpu) {
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(&self.fresh, 0, self.buffer(Slot::Plan), 0, None);
        encoder.clear_buffer(self.buffer(Slot::Histogram), 0, None);
        self.work.record(gpu, &mut encoder);
        let mut at = 0;
        for (slot, words) in self.answers() {
            encoder.copy_buffer_to_buffer(self.buffer(slot), 0, &self.answer, at, Some(4 * words as u64));
            at += 4 * words as u64;
        }
        gpu.queue.submit([encoder.finish()]);
    }

    /// Reads the answer, or what more room it needs.
    fn collect(&self, found: &mut Found) -> Result<Option<Capacities>, Failed> {
        let view = self.answer.slice(..).get_mapped_range().map_err(|error| Failed::Lost(error.to_string()))?;
        let words: &[u32] = bytemuck::cast_slice(&view);
        let (told, mut rest) = words.split_at(PLAN_WORDS);
        if told[plan::STATUS] != 0 {
            return Ok(Some(self.capacities.grown(told)));
        }
        let counts = [plan::VERTEX_TRIANGLE, plan::EDGE_EDGE].map(|at| told[at] as usize);
        let mut next = |capacity: usize| {
            let part;
            (part, rest) = rest.split_at(capacity);
            part
        };
        let Capacities { vertex_triangle, edge_edge, .. } = self.capacities;
        let rooms = [vertex_triangle, edge_edge];
        for (pairs, k) in [(&mut found.vertex_triangle, 0), (&mut found.edge_edge, 1)] {
            pairs.clear();
            pairs.extend_from_slice(bytemuck::cast_slice(&next(2 * rooms[k])[..2 * counts[k]]));
        }
        for (numbers, k) in [(&mut found.vertex_triangle_distances, 0), (&mut found.edge_edge_distances, 1)] {
            numbers.clear();
            numbers.extend_from_slice(bytemuck::cast_slice(&next(rooms[k])[..counts[k]]));
        }
        if self.continuous {
            for (numbers, k) in [(&mut found.vertex_triangle_times, 0), (&mut found.edge_edge_times, 1)] {
                numbers.clear();
                numbers.extend_from_slice(bytemuck::cast_slice(&next(rooms[k])[..counts[k]]));
            }
        }
        Ok(None)
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
        Self {
            levels: self.levels.max(told[plan::GRADED] as usize),
            entries: room(self.entries, plan::MOST_ENTRIES),
            pairs: room(self.pairs, plan::PAIRS),
            vertex_triangle: room(self.vertex_triangle, plan::VERTEX_TRIANGLE),
            edge_edge: room(self.edge_edge, plan::EDGE_EDGE),
        }
    }
}

/// A box in finite numbers; one that is not valid has its corners exchanged.
fn finite(b: &Aabb) -> [f32; 6] {
    let ordered = b.min.cmple(b.max).all();
    let [low, high] = if ordered { [b.min, b.max] } else { [Vec3::MAX, Vec3::MIN] };
    let [low, high] = [low, high].map(|corner| corner.clamp(Vec3::MIN, Vec3::MAX).to_array());
    [low[0], low[1], low[2], high[0], high[1], high[2]]
}
