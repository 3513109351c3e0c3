//! A simulation that a page steps, changes and draws.

use muslin_core::colliders::Form;
use muslin_core::diagnostics::StateHash;
use muslin_core::geometry::normals::write_normals;
use muslin_core::real::Vec3;
use muslin_core::scene::{Content, Resource, SceneDesc, memory, texture};
use muslin_core::simulation::{MaterialError, Simulation as Cloth, State, StepError};
use muslin_core::warning::Warning;
use muslin_gpu::Gpu;
use muslin_gpu::device::Ask;
use muslin_gpu::step::StepDetector;
use wasm_bindgen::prelude::{JsError, JsValue, wasm_bindgen};

use crate::clock::{Clock, PARTS};
use crate::surface::{Surface, write_strains};
use crate::watch::Watch;

/// A simulation. It gives its columns as addresses and lengths in the memory of the module, where a page reads them.
#[wasm_bindgen]
pub struct Simulation {
    pub(crate) own: Cloth,
    clock: Clock,
    pub(crate) scene: SceneDesc,
    meshes: Vec<Resource>,
    /// The largest number of vertices.
    most: f64,
    watch: Watch,
    pub(crate) chain: StateHash,
    /// Positions in the world, of a cloth that is far from its origin, m.
    places: Vec<[f32; 3]>,
    normals: Vec<Vec3>,
    strains: Vec<f32>,
}

pub(crate) fn error(why: impl std::fmt::Display) -> JsError {
    JsError::new(&why.to_string())
}

/// Builds a scene, unless its cloths and the meshes of its colliders have more vertices than `most`.
#[cfg_attr(small, optimize(size))]
fn build(desc: &SceneDesc, meshes: &[Resource], most: f64) -> Result<Cloth, JsError> {
    let of_colliders = desc.collider.iter().filter_map(|collider| collider.file.as_ref()).map(|file| {
        let mesh = meshes.iter().find(|(name, _)| name == file);
        mesh.map_or(0, |(_, content)| if let Content::Mesh(mesh) = content { mesh.positions.len() as u64 } else { 0 })
    });
    let vertices = memory(desc, meshes).map_err(error)?.vertices + of_colliders.sum::<u64>();
    if vertices as f64 > most {
        return Err(error(format!(
            "the scene has {vertices} vertices, more than {most}; take fewer cells, or allow more by the option mostVertices"
        )));
    }
    Cloth::new(desc, meshes).map_err(error)
}

#[wasm_bindgen]
impl Simulation {
    /// Builds the simulation of a scene, which is given as an object, with the meshes that it names. It has at most this
    /// number of vertices.
    #[wasm_bindgen(constructor)]
    pub fn new(scene: JsValue, meshes: JsValue, most: f64) -> Result<Self, JsError> {
        let desc = muslin_wasm_scene::read(scene).map_err(error)?;
        let meshes = muslin_wasm_scene::meshes(&meshes).map_err(error)?;
        let mut own = build(&desc, &meshes, most)?;
        let clock = Clock::default();
        let watch = Watch::begin(&mut own, &desc, &clock);
        let count = own.positions().len();
        let mut chain = StateHash::default();
        chain.add(own.positions(), own.velocities());
        Ok(Self {
            own,
            clock,
            watch,
            scene: desc,
            meshes,
            most,
            chain,
            places: Vec::new(),
            normals: vec![Vec3::ZERO; count],
            strains: vec![0.0; count],
        })
    }

    /// Takes one step on this thread. It is refused once it has taken `longest` milliseconds.
    pub fn step(&mut self, longest: f64) -> Result<(), JsError> {
        self.clock.stay_here(true);
        self.clock.allow(longest);
        let taken = self.own.step(&self.clock);
        self.stepped(taken)
    }

    /// Takes one step; if a device is open, it finds the candidates.
    #[wasm_bindgen(js_name = awaitStep)]
    pub async fn await_step(&mut self) -> Result<(), JsError> {
        self.clock.stay_here(false);
        self.clock.allow(f64::INFINITY);
        let taken = self.own.await_step(&self.clock).await;
        self.stepped(taken)
    }

    fn stepped(&mut self, taken: Result<(), StepError>) -> Result<(), JsError> {
        self.clock.pause();
        taken.map_err(error)?;
        self.chain.add(self.own.positions(), self.own.velocities());
        self.watch.step(&self.own);
        Ok(())
    }

    /// Opens a device for the candidates of [`await_step`](Self::await_step) and returns its name.
    #[wasm_bindgen(js_name = openDevice)]
    pub async fn open_device(&mut self) -> Result<String, JsError> {
        let gpu = Gpu::open(Ask::Most).await.map_err(error)?;
        let name = gpu.name.clone();
        self.clock.ask(Some(StepDetector::new(gpu)));
        Ok(name)
    }

    /// Whether a device finds the candidates of awaited steps.
    #[wasm_bindgen(getter, js_name = hasDevice)]
    pub fn has_device(&self) -> bool {
        self.clock.has_device()
    }

    /// The last message about a failure of the device. It is returned only once.
    #[wasm_bindgen(js_name = takeNote)]
    pub fn take_note(&self) -> Option<String> {
        self.clock.note()
    }

    /// Takes the numbers of another scene with the same meshes, force terms, pins, colliders and method. Returns false,
    /// and changes nothing, if the force terms are others.
    #[wasm_bindgen(js_name = setMaterials)]
    #[cfg_attr(small, optimize(size))]
    pub fn set_materials(&mut self, scene: JsValue) -> Result<bool, JsError> {
        let desc = muslin_wasm_scene::read(scene).map_err(error)?;
        match self.own.set_materials(&desc, &self.meshes) {
            Ok(()) => {}
            Err(MaterialError::Live(_)) => return Ok(false),
            Err(why) => return Err(error(why)),
        }
        self.clock.forget();
        self.scene = desc;
        self.observe();
        Ok(true)
    }

    /// Observes the run from now on.
    pub(crate) fn observe(&mut self) {
        self.watch = Watch::begin(&mut self.own, &self.scene, &self.clock);
    }

    /// Continues with another scene. If the number of vertices stays the same, the cloth keeps its state, and the pins and
    /// forces of the host. The colliders keep their poses and motions if the host says so.
    #[wasm_bindgen(js_name = goOnAs)]
    #[cfg_attr(small, optimize(size))]
    pub fn go_on_as(&mut self, scene: JsValue, keep_colliders: bool) -> Result<(), JsError> {
        let desc = muslin_wasm_scene::read(scene).map_err(error)?;
        let mut next = build(&desc, &self.meshes, self.most)?;
        let state = self.own.state();
        let steps = (self.own.time() / f64::from(next.step_length())).round() as u64;
        // The previous state, the substeps and the contacts may belong to another method, step length or collider, so
        // they are dropped.
        let state = State { steps, previous: [&[]; 2], last_step: 0.0, halvings: 0, multipliers: &[], ..state };
        if next.restore(&state, self.own.statistics(), self.own.contact_statistics()) {
            if keep_colliders {
                next.keep_colliders(&self.own).map_err(error)?;
            }
            next.keep_pins(&self.own).map_err(error)?;
            if self.own.reactions().is_some() {
                next.measure_reactions();
            }
        }
        self.clock.forget();
        let count = next.positions().len();
        self.normals.resize(count, Vec3::ZERO);
        self.strains.resize(count, 0.0);
        self.watch = Watch::begin(&mut next, &desc, &self.clock);
        (self.own, self.scene) = (next, desc);
        Ok(())
    }

    /// The held vertices.
    pub fn pins(&self) -> Vec<u32> {
        self.own.pins().held().collect()
    }

    /// The colliders, one after the other. Each has its shape (0 plane, 1 sphere, 2 capsule, 3 box, 4 mesh), radius, m,
    /// normal, number of points, and the current positions of its points, m.
    pub fn bodies(&self) -> Vec<f32> {
        let Some(contact) = self.own.contact() else { return Vec::new() };
        let places: Vec<_> = self.own.colliders_in_world().map(|place| place.map(|x| x as f32)).collect();
        let mut out = Vec::new();
        for body in contact.colliders.view().bodies {
            let (shape, normal) = match body.form() {
                Form::Plane(normal) => (0.0, normal),
                Form::Sphere => (1.0, Vec3::ZERO),
                Form::Capsule => (2.0, Vec3::ZERO),
                Form::Box => (3.0, Vec3::ZERO),
                Form::Mesh => (4.0, Vec3::ZERO),
            };
            let points = &places[body.range()];
            out.extend([shape, body.radius]);
            out.extend(normal.to_array());
            out.push(points.len() as f32);
            points.iter().for_each(|point| out.extend(point));
        }
        out
    }

    /// Number of vertices.
    #[wasm_bindgen(getter, js_name = vertexCount)]
    pub fn vertex_count(&self) -> usize {
        self.own.positions().len()
    }

    /// Number of triangles.
    #[wasm_bindgen(getter, js_name = triangleCount)]
    pub fn triangle_count(&self) -> usize {
        self.own.triangles().len()
    }

    /// Three vertices per triangle.
    pub fn triangles(&self) -> *const u32 {
        self.own.triangles().as_ptr().cast()
    }

    /// The mesh for drawing with a texture: the vertex of the cloth and the texture coordinates of each of its vertices, and
    /// three vertices per triangle.
    #[cfg_attr(small, optimize(size))]
    pub fn surface(&self) -> Result<Surface, JsError> {
        texture(&self.scene, &self.meshes).map(Surface).map_err(error)
    }

    /// Positions: three coordinates per vertex, m.
    pub fn positions(&mut self) -> *const f32 {
        if self.own.origin() == [0.0; 3] {
            return self.own.positions().as_ptr().cast();
        }
        self.places.clear();
        self.places.extend(self.own.places_in_world().map(|place| place.map(|x| x as f32)));
        self.places.as_ptr().cast()
    }

    /// Velocities: three coordinates per vertex, m/s.
    pub fn velocities(&self) -> *const f32 {
        self.own.velocities().as_ptr().cast()
    }

    /// Unit normals at the current positions: three coordinates per vertex.
    pub fn normals(&mut self) -> *const f32 {
        write_normals(self.own.positions(), self.own.triangles(), &mut self.normals);
        self.normals.as_ptr().cast()
    }

    /// For each vertex, the current strain of largest magnitude among its edges.
    pub fn strains(&mut self) -> *const f32 {
        let scene = self.own.scene();
        write_strains(self.own.positions(), &scene.edges, &scene.rest_lengths, &mut self.strains);
        self.strains.as_ptr()
    }

    /// Steps taken.
    #[wasm_bindgen(getter)]
    pub fn steps(&self) -> f64 {
        self.own.state().steps as f64
    }

    /// Simulated time, s.
    #[wasm_bindgen(getter)]
    pub fn time(&self) -> f64 {
        self.own.time()
    }

    /// Length of a step, s.
    #[wasm_bindgen(getter, js_name = stepLength)]
    pub fn step_length(&self) -> f64 {
        self.own.step_length().into()
    }

    /// The largest error of a step, m; none if all steps have the same length.
    #[wasm_bindgen(getter, js_name = stepError)]
    pub fn step_error(&self) -> Option<f64> {
        self.scene.integrator.error()
    }

    /// Frames of the scene per simulated second.
    #[wasm_bindgen(getter, js_name = frameRate)]
    pub fn frame_rate(&self) -> f64 {
        self.scene.frame_rate
    }

    /// Duration of the scene, s.
    #[wasm_bindgen(getter)]
    pub fn duration(&self) -> f64 {
        self.scene.duration
    }

    /// The largest ratio of the length of an edge to its rest length.
    pub fn stretch(&self) -> f64 {
        self.own.stretch().max
    }

    /// The warnings of the run up to now. Each has a code, a value, the number that it is compared with, and whether it
    /// makes the result doubtful.
    #[cfg_attr(small, optimize(size))]
    pub fn warnings(&self) -> Vec<JsValue> {
        let mut words = Vec::new();
        for Warning { code, value, beside, is_doubtful } in self.watch.warnings(&self.own, &self.scene, &self.clock) {
            words.extend([code.name().into(), value.into(), beside.into(), JsValue::from(is_doubtful)]);
        }
        words
    }

    /// The hash chain over the states of all steps, as `muslin run` prints it.
    #[wasm_bindgen(js_name = stateHash)]
    pub fn state_hash(&self) -> String {
        format!("fnv1a:{:016x}", self.chain.0)
    }

    /// Time in predict, broad phase, narrow phase and response since the last call, ms.
    #[wasm_bindgen(js_name = takeTimes)]
    pub fn take_times(&self) -> Vec<f64> {
        let times: [f64; PARTS] = self.clock.take();
        times.to_vec()
    }

    /// Diagnostics, in this order: largest and mean stretch; kinetic, stretch, shear, bend, seam and gravity energy, J;
    /// totals of candidates, proximity contacts, impacts, impact zones, halved steps, force evaluations and iterations
    /// of conjugate gradients.
    pub fn numbers(&self) -> Vec<f64> {
        let (stretch, e) = (self.own.stretch(), self.own.energy());
        let (contact_statistics, work) = (self.own.contact_statistics(), self.own.statistics());
        let counts = [
            contact_statistics.candidates,
            contact_statistics.proximity,
            contact_statistics.impacts,
            contact_statistics.zones,
            contact_statistics.rejected,
            work.force_evaluations,
        ];
        [stretch.max, stretch.mean, e.kinetic, e.stretch, e.shear, e.bend, e.seam, e.gravity]
            .into_iter()
            .chain(counts.into_iter().chain([work.cg_iterations]).map(|count| count as f64))
            .collect()
    }
}
