//! Cooks a simulation: writes its columns to a block.

use alloc::vec::Vec;

use super::sink::Sink;
use super::source::Columns;
use super::stored::{Kept, NO_FRAMES, Settings, Stored, StoredContact};
use super::{HEADER, Header, MAGIC, VERSION};
use crate::colliders::Form;
use crate::contact::ContactScratchColumns;
use crate::forces::load::VertexForce;
use crate::implicit_contact::multiplier::Multiplier;
use crate::live::Owner as _;
use crate::reactions::{Impulse, Reactions};
use crate::real::{Real, Vec3};
use crate::simulation::Simulation;

/// Room of a cooked scene, which cannot grow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Room {
    /// Candidates of each kind.
    pub pairs: usize,
    /// Contacts.
    pub contacts: usize,
    /// Vertices that the host holds at the same time.
    pub hands: u32,
    /// Vertices on which the host sets forces at the same time.
    pub forces: u32,
    /// Whether the host may deform meshes.
    pub deforms: bool,
    /// Whether impulses on colliders are measured.
    pub impulses: bool,
    /// Whether to save memory: forces of elements are computed for each of their vertices, and all triangles that may
    /// touch are compared. With contact of the cloth with itself, that takes more time. The steps are the same; a few
    /// candidates more need room.
    pub is_lean: bool,
}

/// Cooks a simulation in its present state. Steps that it has taken count, but the first step of the cooked cloth does not
/// continue the last one.
pub fn cook(simulation: &Simulation, room: Room) -> Vec<u8> {
    let mut sim = simulation.clone();
    let scheme = *sim.scheme();
    let settings = Settings::new(&scheme, sim.step_length(), sim.origin().into(), sim.state().steps);
    let own_frames = if room.deforms { frames(&mut sim) } else { Vec::new() };
    let (host, mut forces) = sim.host_forces();
    forces.resize(forces.len() + room.forces as usize, VertexForce::default());
    let (built, scratch) = sim.columns();
    for _ in 0..room.hands {
        built.pins.add_slot();
    }
    if room.hands > 0 {
        built.pins.allow_carriers();
    }
    if room.impulses {
        scratch.add_work(built.pins.vertices.len());
    } else {
        scratch.remove_work(scheme.method);
    }
    if room.is_lean {
        scratch.remove_spare();
    }
    let is_implicit = scheme.method.is_implicit();
    let bodies = built.contact.as_ref().map_or(0, |contact| contact.colliders.bodies.len());
    let impulses = alloc::vec![Impulse::default(); if room.impulses { bodies } else { 0 }];
    let (mut measured, mut kept_impulses) = (impulses.clone(), impulses);
    let mut columns =
        built.contact.as_ref().map(|contact| ContactScratchColumns::fit(&contact.view(), room, is_implicit));
    let divides = built.divides(scheme.error);
    let mut copy: [Vec<Vec3>; 4] = [(); 4].map(|()| built.particles.positions.clone());
    let mut copy_before: [Vec<Vec3>; 2] = [(); 2].map(|()| scratch.previous_displacements.clone());
    let mut multipliers =
        alloc::vec![Multiplier::default(); if is_implicit && built.contact.is_some() { room.contacts } else { 0 }];
    let kept = divides.then(|| {
        let [positions, velocities, low_positions, low_velocities] = copy.each_mut().map(Vec::as_mut_slice);
        let [previous_displacements, previous_velocity_changes] = copy_before.each_mut().map(Vec::as_mut_slice);
        Kept {
            positions,
            velocities,
            low_positions,
            low_velocities,
            previous_displacements,
            previous_velocity_changes,
            multipliers: &mut multipliers,
            reactions: &mut kept_impulses,
        }
    });
    let contact = built.contact.as_mut().zip(columns.as_mut()).map(|(model, columns)| StoredContact {
        model: model.solids(),
        columns: columns.view(),
        own_frames: &own_frames,
    });
    let mut held = scratch.of_pins().0.to_vec();
    let mut model = built.model.view();
    host.add_to(&mut model, &[]);
    let stored = Stored {
        settings,
        triangles: &built.triangles,
        particles: built.particles.view(),
        model,
        pins: built.pins.slots(),
        scratch: scratch.view(),
        held: &mut held,
        contact,
        forces: &mut forces,
        reactions: room.impulses.then(|| Reactions { groups: &[], pins: &mut [], colliders: &mut measured }),
        kept,
    };
    let mut sink = Sink::default();
    stored.cook(&mut sink);
    let mut header = Header {
        magic: MAGIC,
        version: VERSION,
        scalar: size_of::<Real>() as u32,
        length: (HEADER + sink.block.len()) as u64,
        memory: sink.memory as u64,
        checksum: 0,
        vertices: simulation.positions().len() as u64,
        reserved: [0; 2],
    };
    header.checksum = header.checksum_with(&sink.block);
    let mut block = bytemuck::bytes_of(&header).to_vec();
    block.append(&mut sink.block);
    block
}

/// Adds frames for all meshes. Returns the index of the first of each collider.
fn frames(sim: &mut Simulation) -> Vec<u32> {
    let is_mesh: Vec<bool> = sim.colliders().bodies.iter().map(|body| body.form() == Form::Mesh).collect();
    let mut first = |body| sim.make_frames(body).map_or(NO_FRAMES, |first| first as u32);
    is_mesh.iter().enumerate().map(|(body, &is_mesh)| if is_mesh { first(body) } else { NO_FRAMES }).collect()
}
