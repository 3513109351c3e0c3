//! Cooks a simulation: writes its columns to a block.

use alloc::vec::Vec;

use super::sink::Sink;
use super::source::Columns;
use super::stored::{Kept, Settings, Solids, Stored, StoredContact};
use super::{HEADER, Header, MAGIC, VERSION, checksum};
use crate::contact::ContactScratchColumns;
use crate::implicit_contact::multiplier::Multiplier;
use crate::real::{Real, Vec3};
use crate::simulation::Simulation;

/// Room of a cooked scene, which cannot grow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Room {
    /// Candidates of each kind.
    pub pairs: usize,
    /// Contacts.
    pub contacts: usize,
    /// Vertices that the host holds at the same time.
    pub hands: u32,
}

/// Cooks a simulation in its present state. Steps that it has taken count, but the first step of the cooked cloth does not
/// continue the last one.
pub fn cook(simulation: &Simulation, room: Room) -> Vec<u8> {
    let mut sim = simulation.clone();
    let scheme = *sim.scheme();
    let settings = Settings::new(&scheme, sim.step_length(), sim.origin().into(), sim.state().steps);
    let (built, scratch) = sim.parts();
    scratch.remove_work(scheme.method);
    for _ in 0..room.hands {
        built.pins.add_slot();
    }
    if room.hands > 0 {
        built.pins.allow_carriers();
    }
    let mut columns = built.contact.as_ref().map(|contact| ContactScratchColumns::fit(&contact.view(), room));
    let mut held = scratch.held().to_vec();
    let divides = built.contact.is_some() || scheme.error.is_some();
    let mut copy: [Vec<Vec3>; 4] = [(); 4].map(|()| built.particles.positions.clone());
    let mut copy_before: [Vec<Vec3>; 2] = [(); 2].map(|()| scratch.previous_displacements.clone());
    let mut multipliers = alloc::vec![Multiplier::default(); if built.contact.is_some() { room.contacts } else { 0 }];
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
        }
    });
    let contact = built.contact.as_mut().zip(columns.as_mut()).map(|(model, columns)| StoredContact {
        model: Solids {
            thickness: model.thickness,
            continuous: model.continuous,
            surface: model.surface.view(),
            bodies: &mut model.colliders.bodies,
            anchors: &model.colliders.anchors,
            keys: &model.colliders.keys,
            frames: &model.colliders.frames,
            firsts: &model.firsts,
            material: &model.material,
            radii: &model.radii,
            inverse_masses: &mut model.inverse_masses,
            law_of: &model.law_of,
            laws: &model.laws,
        },
        columns: columns.view(),
    });
    let stored = Stored {
        settings,
        triangles: &built.triangles,
        particles: built.particles.view(),
        model: built.model.view(),
        pins: built.pins.slots(),
        scratch: scratch.view(),
        held: &mut held,
        contact,
        kept,
    };
    let mut sink = Sink::default();
    stored.cook(&mut sink);
    let header = Header {
        magic: MAGIC,
        version: VERSION,
        scalar: size_of::<Real>() as u32,
        length: (HEADER + sink.block.len()) as u64,
        memory: sink.memory as u64,
        checksum: checksum(&sink.block),
        reserved: [0; 3],
    };
    let mut block = bytemuck::bytes_of(&header).to_vec();
    block.append(&mut sink.block);
    block
}
