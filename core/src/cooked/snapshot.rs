//! A copy of all that steps and the host change, in bytes that the host keeps.

use bytemuck::{Pod, Zeroable};

use super::cloth::Cloth;
use super::stored::Stored;
use super::{check, checksum};
use crate::colliders::{Body, Drive};
use crate::column::Column;
use crate::error::LiveError;
use crate::forces::load::VertexForce;
use crate::halving::most_halvings;
use crate::implicit_contact::multiplier::Multiplier;
use crate::integrate::IntegratorStatistics;
use crate::integrate::pins::NO_CARRIER;
use crate::live::{HostForces, Owner as _};
use crate::motion::Motion;
use crate::real::{Real, Sum, Vec3, to_f64, vec3};
use crate::response::ContactStatistics;
use crate::step::History;
use crate::work_done::WorkDone;

/// The numbers before the columns.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Plain {
    /// Of everything after it.
    checksum: u64,
    /// The hash of triangles and colliders, by which the cloth knows its snapshot.
    scene: u64,
    /// The point from which positions are measured, m.
    origin: [Sum; 3],
    /// The number of the method.
    method: u64,
    steps: u64,
    /// The length of a step, and of the last substep, s.
    step: Sum,
    last_step: Sum,
    /// The estimated error of the last step, m, or a negative number.
    estimate: Sum,
    /// Each a flag and a vector.
    gravity: [Sum; 4],
    wind: [Sum; 4],
    work_done: WorkDone,
    statistics: IntegratorStatistics,
    contact_statistics: ContactStatistics,
    multipliers: u64,
    history: u32,
    halvings: u32,
}

const PLAIN: usize = size_of::<Plain>();

impl Plain {
    /// The numbers that steps add to.
    fn counts(&self) -> impl Iterator<Item = u64> {
        let words = |bytes: &'_ [u8]| bytes.as_chunks::<8>().0.iter().map(|&word| u64::from_ne_bytes(word)).max();
        let integrator = words(bytemuck::bytes_of(&self.statistics));
        let contact = words(bytemuck::bytes_of(&self.contact_statistics));
        [Some(self.steps), integrator, contact].into_iter().flatten()
    }
}

impl Cloth<'_> {
    /// Size of a snapshot, bytes.
    pub fn snapshot_bytes(&self) -> usize {
        self.snapshot_bytes
    }

    /// Writes a copy of all that steps and the host change. After [`go_back`](Self::go_back) to it the same steps give the
    /// same bits. It takes the first [`snapshot_bytes`](Self::snapshot_bytes) bytes of `out`.
    pub fn snapshot(&mut self, out: &mut [u8]) -> Result<(), LiveError> {
        let mut plain = self.plain();
        let out = out.get_mut(..self.snapshot_bytes()).ok_or(LiveError::Memory)?;
        let (head, mut rest) = out.cut_mut(PLAIN);
        for column in columns(&mut self.stored) {
            let (part, after) = rest.cut_mut(column.len());
            part.copy_from(column);
            rest = after;
        }
        head.copy_from(bytemuck::bytes_of(&plain));
        plain.checksum = checksum(out.part(8..));
        out.part_mut(..8).copy_from(&plain.checksum.to_ne_bytes());
        Ok(())
    }

    /// Goes back to a snapshot of this cloth, or of another one with the same triangles, colliders, pins and room. Its
    /// materials and rest shapes may differ. The list of [`touches`](crate::live::Live::touches) is empty until the next step.
    pub fn go_back(&mut self, to: &[u8]) -> Result<(), LiveError> {
        if to.len() != self.snapshot_bytes() {
            return Err(LiveError::OtherScene);
        }
        let (head, columns_of_it) = to.cut(PLAIN);
        let plain: Plain = bytemuck::try_pod_read_unaligned(head).map_err(|_| LiveError::OtherScene)?;
        let own = self.plain();
        let fits = plain.checksum == checksum(to.part(8..))
            && (plain.scene, plain.step) == (own.scene, own.step)
            && (plain.origin, plain.method) == (own.origin, own.method)
            && plain.halvings <= most_halvings(self.stored.kept.is_some())
            && plain.counts().all(|count| count < check::MOST_STEPS)
            && self.accepts(&plain, columns_of_it);
        if !fits {
            return Err(LiveError::OtherScene);
        }
        let mut rest = columns_of_it;
        for column in columns(&mut self.stored) {
            let (part, after) = rest.cut(column.len());
            column.copy_from(part);
            rest = after;
        }
        if let Some(contact) = &mut self.stored.contact {
            contact.columns.lengths.multipliers = plain.multipliers as usize;
            contact.columns.kept.forget();
        }
        let vector = |[is_set, x, y, z]: [Sum; 4]| (is_set != 0.0).then(|| vec3([x, y, z]));
        self.host = HostForces { gravity: vector(plain.gravity), wind: vector(plain.wind) };
        self.history = match plain.history {
            0 => History::Start,
            1 => History::Smooth { step: plain.last_step as Real },
            2 => History::Cut,
            _ => History::Corrected,
        };
        self.estimate = (plain.estimate >= 0.0).then_some(plain.estimate as Real);
        (self.halvings, self.steps, self.substep) = (plain.halvings, plain.steps, 0.0);
        (self.work_done, self.statistics) = (plain.work_done, plain.statistics);
        self.contact_statistics = plain.contact_statistics;
        self.parts_mut().take_over_pins();
        Ok(())
    }

    fn plain(&self) -> Plain {
        let vector = |vector: Option<Vec3>| match vector.map(to_f64) {
            Some([x, y, z]) => [1.0, x, y, z],
            None => [0.0; 4],
        };
        let (history, last_step) = match self.history {
            History::Start => (0, 0.0),
            History::Smooth { step } => (1, step),
            History::Cut => (2, 0.0),
            History::Corrected => (3, 0.0),
        };
        let contact = self.stored.contact.as_ref();
        Plain {
            checksum: 0,
            scene: self.topology(),
            origin: self.origin().into(),
            method: self.scheme.method as u64,
            steps: self.steps,
            step: self.step.into(),
            last_step: last_step.into(),
            estimate: self.estimate.unwrap_or(-1.0).into(),
            gravity: vector(self.host.gravity),
            wind: vector(self.host.wind),
            work_done: self.work_done,
            statistics: self.statistics,
            contact_statistics: self.contact_statistics,
            multipliers: contact.map_or(0, |contact| contact.columns.lengths.multipliers) as u64,
            history,
            halvings: self.halvings,
        }
    }

    /// A hash of the triangles and of the shapes of the colliders.
    fn topology(&self) -> u64 {
        let anchors = self.stored.contact.as_ref().map_or(&[][..], |contact| contact.model.anchors);
        checksum(bytemuck::cast_slice(self.stored.triangles)) ^ checksum(bytemuck::cast_slice(anchors)).rotate_left(1)
    }

    /// Whether kernels can rely on the columns of a snapshot.
    fn accepts(&self, plain: &Plain, mut rest: &[u8]) -> bool {
        let Stored { particles, pins, contact, forces, .. } = &self.stored;
        let n = particles.positions.len() as u32;
        let (bodies, vertices, capacity) = contact.as_ref().map_or((&[][..], n, 0), |contact| {
            let model = &contact.model;
            (&*model.bodies, n + model.anchors.len() as u32, contact.columns.multipliers.len())
        });
        let is_carrier = |carrier: u32| carrier == NO_CARRIER || (carrier as usize) < bodies.len();
        // The columns that hold indices come first.
        plain.multipliers as usize <= capacity
            && all(&mut rest, pins.vertices, |vertex, _| vertex < n)
            && all(&mut rest, pins.axes, |axes, _| axes < 8)
            && all(&mut rest, pins.table, |motion: Motion, own| motion.keys == own.keys)
            && all(&mut rest, pins.carriers, |carrier, _| is_carrier(carrier))
            && all(&mut rest, forces, |force: VertexForce, _| force.vertex < n)
            && all(&mut rest, bodies, |body, own| self.accepts_body(&body, own))
            && contact.as_ref().is_none_or(|contact| {
                let is_vertex = |multiplier: Multiplier, _: &_| multiplier.vertices.iter().all(|&v| v < vertices);
                all(&mut rest, contact.columns.multipliers, is_vertex)
            })
    }

    /// Whether a collider is the own one with another motion.
    fn accepts_body(&self, body: &Body, own: &Body) -> bool {
        let Some(contact) = &self.stored.contact else { return false };
        let moves = match body.drive() {
            Drive::Rest => true,
            Drive::Host(kinematic) => kinematic.is_valid(),
            Drive::Motion(motion) => check::has_keys(&motion, contact.model.keys),
            Drive::Cache(cache) => cache.fits(body.range().len(), contact.model.frames.len()),
        };
        let mut same = *own;
        same.set_drive(body.drive());
        same.set_off(body.is_off());
        same == *body && moves
    }
}

/// Whether all entries of the next column fit.
fn all<T: Pod>(rest: &mut &[u8], own: &[T], fits: impl Fn(T, &T) -> bool) -> bool {
    let (column, after) = rest.cut(size_of_val(own));
    *rest = after;
    let entries = column.chunks_exact(size_of::<T>()).map(bytemuck::try_pod_read_unaligned);
    entries.zip(own).all(|(entry, own)| entry.is_ok_and(|entry| fits(entry, own)))
}

/// Size of a snapshot, bytes.
pub(super) fn size(stored: &mut Stored<'_>) -> usize {
    PLAIN + columns(stored).iter().map(|column| column.len()).sum::<usize>()
}

/// A column as bytes.
fn bytes<T: Pod>(column: &mut [T]) -> &mut [u8] {
    bytemuck::try_cast_slice_mut(column).unwrap_or_default()
}

/// The columns that change, as bytes.
fn columns<'b>(stored: &'b mut Stored<'_>) -> [&'b mut [u8]; 18] {
    let Stored { particles, pins, scratch, contact, forces, reactions, .. } = stored;
    let (bodies, multipliers, frames) = match contact {
        Some(contact) => {
            let (model, columns) = (&mut contact.model, &mut contact.columns);
            (&mut *model.bodies, &mut *columns.multipliers, &mut *model.frames)
        }
        None => Default::default(),
    };
    [
        bytes(pins.vertices),
        bytes(pins.axes),
        bytes(pins.table),
        bytes(pins.carriers),
        bytes(forces),
        bytes(bodies),
        bytes(multipliers),
        bytes(frames),
        bytes(pins.anchors),
        bytes(pins.keys),
        bytes(pins.holds),
        bytes(particles.positions),
        bytes(particles.velocities),
        bytes(particles.low_positions),
        bytes(particles.low_velocities),
        bytes(scratch.previous_displacements),
        bytes(scratch.previous_velocity_changes),
        reactions.as_mut().map_or(&mut [], |reactions| bytes(reactions.colliders)),
    ]
}
