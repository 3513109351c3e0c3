//! Pins: vertices whose held axes follow a prescribed motion, whatever the forces. Pins overwrite
//! the stages of explicit methods and filter implicit solves [Baraff 1998, Tamstorf 2015].

pub use crate::motion::{JumpSide, Key, Motion, Turn};
use glam::DVec3;

use crate::colliders::{Body, Colliders};
use crate::column::Column;
use crate::particles::Particles;
use crate::real::{Mat3, Real, Sum, Vec3, to_f64, vec3};

/// A velocity change at a key larger than this fraction of the larger speed is a jump. A smaller
/// change approximates a curve, and a two-step method may use the step before it.
const JUMP: Real = 0.25;

/// Value in [`Pins::motions`] of a pin that does not move.
pub const AT_REST: u32 = u32::MAX;

/// Value in [`Pins::carriers`] of a pin that no collider carries.
pub const NO_CARRIER: u32 = u32::MAX;

/// The time in which a pin holds its axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Hold {
    /// The axes: bits 0, 1, 2 for x, y, z.
    axes: u64,
    /// Time from which it holds, s. A pin holds from the start if this is 0.
    pub from: Sum,
    /// Time until which it holds, s.
    pub until: Sum,
}

impl Hold {
    /// Holds axes between two times, s.
    pub fn new(axes: u8, from: Sum, until: Sum) -> Self {
        Self { axes: axes.into(), from, until }
    }

    /// The axes that are held just after `time`.
    pub fn axes_after(&self, time: Sum) -> u8 {
        let has_passed = |change| JumpSide::After.has_passed(change, time);
        if has_passed(self.from) && !has_passed(self.until) { self.axes as u8 } else { 0 }
    }

    /// The axes that it holds just after `time`, or will hold later.
    pub fn axes_from(&self, time: Sum) -> u8 {
        if JumpSide::After.has_passed(self.until, time) { 0 } else { self.axes as u8 }
    }

    /// Whether it holds no axes but three. A damaged scene may say otherwise.
    pub(crate) fn is_valid(&self) -> bool {
        self.axes < 8
    }

    /// Whether both hold an axis at the same time.
    #[cfg(feature = "alloc")]
    pub(crate) fn meets(&self, other: &Self) -> bool {
        self.axes & other.axes != 0 && self.from < other.until && other.from < self.until
    }

    /// Whether the pin holds in the whole run.
    pub fn is_always(&self) -> bool {
        self.from == 0.0 && self.until == Sum::INFINITY
    }
}

/// Pinned vertices, borrowed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pins<'a> {
    /// The vertices.
    pub vertices: &'a [u32],
    /// Held axes of each pin: bits 0, 1, 2 for x, y, z; 0 while the pin does not hold.
    pub axes: &'a [u8],
    /// Position of each pin before any motion, m.
    pub anchors: &'a [Vec3],
    /// Index of each pin's motion in `table`, or [`AT_REST`].
    pub motions: &'a [u32],
    /// The motions.
    pub table: &'a [Motion],
    /// The keys of all motions.
    pub keys: &'a [Key],
    /// Index of the collider that each pin moves with, instead of a motion of its own, or [`NO_CARRIER`]; empty: no
    /// collider carries a pin.
    pub carriers: &'a [u32],
    /// The colliders.
    pub colliders: Colliders<'a>,
}

impl Pins<'_> {
    /// The pins: the number of each, its vertex, and its held axes, 0..3.
    pub fn iter(&self) -> impl Iterator<Item = (usize, usize, impl Iterator<Item = usize> + use<>)> {
        let pins = self.vertices.iter().zip(self.axes).enumerate();
        pins.map(|(pin, (&vertex, &axes))| (pin, vertex as usize, held(axes)))
    }

    /// Prescribed position of a pin at `time`, m, and its velocity on the given side of that time, m/s.
    #[cfg_attr(small, inline(never))]
    pub fn target(&self, pin: usize, time: Sum, side: JumpSide) -> (DVec3, Vec3) {
        let anchor = self.anchors.at(pin);
        if let Some(body) = self.body(pin) {
            return body.drive().at(self.colliders.keys, anchor, time, side);
        }
        match self.table.get(self.motions.at(pin) as usize) {
            Some(motion) => motion.at(self.keys, anchor, time, side),
            None => (to_f64(anchor).into(), Vec3::ZERO),
        }
    }

    /// Index of the collider that carries a pin.
    pub fn carrier(&self, pin: usize) -> Option<usize> {
        self.carriers.get(pin).filter(|&&carrier| carrier != NO_CARRIER).map(|&carrier| carrier as usize)
    }

    /// The collider that carries a pin.
    fn body(&self, pin: usize) -> Option<&Body> {
        self.carrier(pin).and_then(|carrier| self.colliders.bodies.element(carrier))
    }

    /// Whether a pin may move.
    pub fn moves(&self, pin: usize) -> bool {
        self.axes.at(pin) != 0 && (self.motions.at(pin) != AT_REST || self.carrier(pin).is_some())
    }

    /// The vertices that are held, in the order of their pins.
    pub fn held(&self) -> impl Iterator<Item = u32> {
        self.vertices.iter().zip(self.axes).filter(|(_, axes)| **axes != 0).map(|(&vertex, _)| vertex)
    }

    /// The velocity just before `time` of a vertex that is held along all axes, m/s.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn held_velocity(&self, vertex: u32, time: Sum) -> Option<DVec3> {
        let mut own = self.vertices.iter().zip(self.axes);
        let pin = own.position(|(&held, &axes)| held == vertex && axes == 0b111)?;
        Some(to_f64(self.target(pin, time, JumpSide::Before).1).into())
    }

    /// The pins that have moved a vertex until their motion ended at `time`: the number of each, its held axes, and the
    /// velocity before, m/s. There, the vertex stands still.
    pub fn ended(
        &self,
        vertex: u32,
        time: Sum,
    ) -> impl Iterator<Item = (usize, impl Iterator<Item = usize> + use<>, Vec3)> {
        self.iter().filter(move |(_, held, _)| *held == vertex as usize).filter_map(move |(pin, _, axes)| {
            let [before, after] = [JumpSide::Before, JumpSide::After].map(|side| self.target(pin, time, side).1);
            (after == Vec3::ZERO && before != Vec3::ZERO).then_some((pin, axes, before))
        })
    }

    /// Gives a vertex back the velocity of the pins that have [moved](Self::ended) it until `time`.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn let_fly(&self, vertex: u32, time: Sum, particles: &mut Particles<'_>) {
        for (_, axes, velocity) in self.ended(vertex, time) {
            for axis in axes {
                set_axis(particles.velocities, vertex as usize, axis, velocity);
                set_axis(particles.low_velocities, vertex as usize, axis, Vec3::ZERO);
            }
        }
    }

    /// How far any pin moves, between two times, from the straight and even way, m.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn deviation(&self, times: [Sum; 2]) -> Sum {
        let of = |(pin, ..): (usize, usize, _)| {
            let own = self.anchors.part(pin..=pin);
            if let Some(body) = self.body(pin) {
                return Some(body.drive().deviation(self.colliders.keys, own, 0.0, None, times));
            }
            let (motion, axes) = (self.table.get(self.motions.at(pin) as usize)?, self.axes.at(pin));
            let radius = motion.reach(own, DVec3::ZERO);
            let mask = [0, 1, 2].map(|axis| Sum::from(axes >> axis & 1));
            (axes != 0).then(|| motion.deviation(self.keys, radius, mask.into(), times))
        };
        self.iter().filter_map(of).fold(0.0, Sum::max)
    }

    /// Whether the velocity of any pin jumps at `time`, by more than a quarter of the larger speed.
    pub fn jump(&self, time: Sum) -> bool {
        (0..self.vertices.len()).filter(|&pin| self.moves(pin)).any(|pin| {
            let [before, after] = [JumpSide::Before, JumpSide::After].map(|side| self.target(pin, time, side).1);
            let fastest = before.length_squared().max(after.length_squared());
            (after - before).length_squared() > JUMP * JUMP * fastest
        })
    }

    /// Sets the velocities of the held axes to their prescribed values just after `time`.
    pub fn set_out(&self, time: Sum, v: &mut [Vec3]) {
        for (pin, vertex, axes) in self.iter() {
            let (_, velocity) = self.target(pin, time, JumpSide::After);
            for axis in axes {
                set_axis(v, vertex, axis, velocity);
            }
        }
    }

    /// Sets the positions and velocities of the held axes to their prescribed values at `time`. `side`
    /// is `Before` in a stage, `After` in a state that the next step starts from.
    pub fn impose(&self, time: Sum, side: JumpSide, x: &mut [Vec3], v: &mut [Vec3]) {
        for (pin, vertex, axes) in self.iter() {
            let (position, velocity) = self.target(pin, time, side);
            for axis in axes {
                set_axis(x, vertex, axis, vec3(position.into()));
                set_axis(v, vertex, axis, velocity);
            }
        }
    }

    /// Sets the held axes of the changes from the state `from` so that they end in the prescribed positions, m, and
    /// velocities just after `time`, m/s.
    pub fn impose_changes(&self, time: Sum, from: &Particles<'_>, x: &mut [Vec3], v: &mut [Vec3]) {
        for (pin, vertex, axes) in self.iter() {
            let (position, velocity) = self.target(pin, time, JumpSide::After);
            let displacement = displacement(from, vertex, position);
            let change = velocity - from.velocities.at(vertex) - from.low_velocities.at(vertex);
            for axis in axes {
                set_axis(x, vertex, axis, displacement);
                set_axis(v, vertex, axis, change);
            }
        }
    }

    /// Sets the held axes of `v` so that a motion from the state `from` ends in the prescribed positions at `time`:
    /// first by an `offset` of each vertex, m, then with the velocity `v` for the time `length`, s.
    pub fn prescribe(
        &self,
        time: Sum,
        from: &Particles<'_>,
        offset: impl Fn(usize) -> Vec3,
        length: Real,
        v: &mut [Vec3],
    ) {
        for (pin, vertex, axes) in self.iter() {
            let (position, _) = self.target(pin, time, JumpSide::Before);
            let velocity = (displacement(from, vertex, position) - offset(vertex)) / length;
            for axis in axes {
                set_axis(v, vertex, axis, velocity);
            }
        }
    }

    /// Clears the held axes of a column.
    pub fn filter(&self, column: &mut [Vec3]) {
        for (_, vertex, axes) in self.iter() {
            for axis in axes {
                set_axis(column, vertex, axis, Vec3::ZERO);
            }
        }
    }

    /// Writes the held axes of each vertex.
    pub fn write_held(&self, out: &mut [u8]) {
        out.fill(0);
        for (&vertex, &axes) in self.vertices.iter().zip(self.axes) {
            if let Some(held) = out.get_mut(vertex as usize) {
                *held |= axes;
            }
        }
    }

    /// Replaces the held axes of the diagonal blocks by the identity, `S A S + I - S`.
    pub fn filter_diagonal(&self, blocks: &mut [Mat3]) {
        for (&vertex, &axes) in self.vertices.iter().zip(self.axes) {
            if let Some(block) = blocks.element_mut(vertex as usize) {
                filter_block(block, axes);
            }
        }
    }
}

/// Sets one axis of a vertex in a column to that of a vector.
pub(super) fn set_axis(column: &mut [Vec3], vertex: usize, axis: usize, to: Vec3) {
    if let Some(own) = column.element_mut(vertex) {
        own.as_mut().set(axis, to.to_array().at(axis));
    }
}

/// The displacement of a vertex to a position, m.
fn displacement(from: &Particles<'_>, vertex: usize, to: DVec3) -> Vec3 {
    let [high, low] = [&*from.positions, &*from.low_positions].map(|of| DVec3::from(to_f64(of.at(vertex))));
    vec3((to - high - low).into())
}

/// `S A S + I - S` for one block.
pub fn filter_block(block: &mut Mat3, axes: u8) {
    let mut columns = block.to_cols_array_2d();
    for (j, column) in columns.iter_mut().enumerate() {
        for (i, value) in column.iter_mut().enumerate() {
            if (axes >> i | axes >> j) & 1 == 1 {
                *value = if i == j { 1.0 } else { 0.0 };
            }
        }
    }
    *block = Mat3::from_cols_array_2d(&columns);
}

/// The held axes, 0..3.
fn held(axes: u8) -> impl Iterator<Item = usize> + use<> {
    (0..3).filter(move |axis| axes >> axis & 1 == 1)
}

/// Pins that change, borrowed. Those of the scene come first, then slots for those of the host. A pin that is let go keeps
/// its place: it holds no axes. Each slot of the host has a motion with three keys of its own.
#[derive(Debug)]
pub struct PinSlots<'a> {
    /// The vertices.
    pub vertices: &'a mut [u32],
    /// Held axes of each pin.
    pub axes: &'a mut [u8],
    /// Position of each pin before any motion, m.
    pub anchors: &'a mut [Vec3],
    /// Index of each pin's motion in `table`, or [`AT_REST`].
    pub motions: &'a mut [u32],
    /// The motions.
    pub table: &'a mut [Motion],
    /// The keys of all motions.
    pub keys: &'a mut [Key],
    /// When the first of the pins hold; those after them always do.
    pub holds: &'a mut [Hold],
    /// Collider that carries each pin, or [`NO_CARRIER`]; empty: no collider carries one.
    pub carriers: &'a mut [u32],
    /// Index of the first slot of the host.
    pub of_scene: u32,
}

impl PinSlots<'_> {
    /// The same columns for a shorter time.
    pub fn reborrow(&mut self) -> PinSlots<'_> {
        let Self { vertices, axes, anchors, motions, table, keys, holds, carriers, of_scene } = self;
        PinSlots { vertices, axes, anchors, motions, table, keys, holds, carriers, of_scene: *of_scene }
    }

    /// The pins, to read.
    pub fn carried_by<'b>(&'b self, colliders: Colliders<'b>) -> Pins<'b> {
        let Self { vertices, axes, anchors, motions, table, keys, carriers, .. } = self;
        Pins { vertices, axes, anchors, motions, table, keys, carriers, colliders }
    }

    /// Sets the held axes to those just after `time`, s. A pin that begins holds its vertex where it is; pins that begin
    /// turn about the mean of these places. Returns whether any axes changed.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn change(&mut self, time: Sum, positions: &[Vec3]) -> bool {
        let Self { vertices, axes, anchors, motions, table, keys, holds, .. } = self;
        let changes = |pin: usize| holds.at(pin).axes_after(time) != axes.at(pin);
        if !(0..holds.len()).any(changes) {
            return false;
        }
        let begun = || (0..holds.len()).filter(|&pin| changes(pin) && holds.at(pin).axes_after(time) != 0);
        for pin in begun() {
            anchors.set(pin, positions.at(vertices.at(pin) as usize));
        }
        for (motion, described) in table.iter_mut().enumerate() {
            let own = || begun().filter(|&pin| motions.at(pin) as usize == motion);
            let (offset, _) = described.offset(keys, time, JumpSide::After);
            described.set_centre(own().map(|pin| DVec3::from(to_f64(anchors.at(pin))) - offset));
            for pin in own() {
                let place = to_f64(anchors.at(pin)).into();
                anchors.set(pin, vec3(described.undo(keys, place, time).into()));
            }
            described.set_centre(own().map(|pin| to_f64(anchors.at(pin)).into()));
        }
        for (axes, hold) in axes.iter_mut().zip(&**holds) {
            *axes = hold.axes_after(time);
        }
        true
    }

    /// Sets the held axes to those just after `time`, s, and takes over the `anchors` of pins that begin late, if there
    /// are as many as [`Self::holds`].
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn restore(&mut self, time: Sum, anchors: &[Vec3]) {
        for (pin, hold) in self.holds.iter().enumerate() {
            self.axes.set(pin, hold.axes_after(time));
            if hold.from > 0.0 && anchors.len() == self.holds.len() {
                self.anchors.set(pin, anchors.at(pin));
            }
        }
        let late = || (0..self.holds.len()).filter(|&pin| self.holds.at(pin).from > 0.0);
        for (motion, described) in self.table.iter_mut().enumerate() {
            let own = late().filter(|&pin| self.motions.at(pin) as usize == motion);
            described.set_centre(own.map(|pin| to_f64(self.anchors.at(pin)).into()));
        }
    }

    /// Pins all axes of a vertex and moves it at constant velocity from one position to another, m, between two
    /// times, s. Just before, it had the velocity `before`, m/s. Replaces earlier pins of the vertex. Returns false, and
    /// does nothing, if there is no [free slot](Self::free).
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn move_to(&mut self, vertex: u32, [start, end]: [Sum; 2], from: Vec3, to: DVec3, before: DVec3) -> bool {
        let Some(pin) = self.take(vertex, from) else { return false };
        let Some(motion) = self.table.element(self.motions.at(pin) as usize) else { return false };
        let first = motion.keys[0] as usize;
        let value = to - DVec3::from(to_f64(from));
        self.keys.part_mut(first..first + 3).copy_from(&[
            // It gives the velocity just before the start.
            Key { time: start - 1.0, value: -before },
            Key { time: start, value: DVec3::ZERO },
            Key { time: end, value },
        ]);
        true
    }

    /// Pins all axes of a vertex to a collider. `anchor` is the place of the vertex before any motion of the collider, m.
    /// Replaces earlier pins of the vertex. Returns false, and does nothing, if there is no [free slot](Self::free) that a
    /// collider can carry.
    pub fn attach(&mut self, vertex: u32, anchor: Vec3, collider: u32) -> bool {
        if self.carriers.is_empty() {
            return false;
        }
        let pin = self.take(vertex, anchor);
        if let Some(pin) = pin {
            self.carriers.set(pin, collider);
        }
        pin.is_some()
    }

    /// Lets a vertex go. Returns whether it was held just after `time`, s, or would have been later.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn release(&mut self, vertex: u32, time: Sum) -> bool {
        let mut any = false;
        let pins = self.vertices.iter().zip(&mut *self.axes).enumerate();
        for (pin, (_, axes)) in pins.filter(|(_, (held, _))| **held == vertex) {
            any |= core::mem::take(axes) != 0;
            if let Some(hold) = self.holds.get_mut(pin) {
                any |= hold.axes_from(time) != 0;
                hold.axes = 0;
            }
        }
        any
    }

    /// A slot of the host that is free once the vertex has been let go.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn free(&self, vertex: u32) -> Option<usize> {
        let mut slots = self.of_scene as usize..self.vertices.len();
        slots.find(|&pin| self.axes.at(pin) == 0 || self.vertices.at(pin) == vertex)
    }

    /// Lets a vertex go, and holds it in a free slot, without a carrier. Returns the number of the pin.
    #[cfg_attr(small, optimize(size), inline(never))]
    fn take(&mut self, vertex: u32, anchor: Vec3) -> Option<usize> {
        let pin = self.free(vertex)?;
        // The time is for the answer, which nobody asks for here.
        self.release(vertex, 0.0);
        self.vertices.set(pin, vertex);
        self.axes.set(pin, 0b111);
        self.anchors.set(pin, anchor);
        if let Some(carrier) = self.carriers.get_mut(pin) {
            *carrier = NO_CARRIER;
        }
        Some(pin)
    }
}

/// The owned columns of [`Pins`] and [`PinSlots`].
#[cfg(feature = "alloc")]
#[derive(Clone, Debug, Default)]
pub struct PinColumns {
    /// The vertices.
    pub vertices: alloc::vec::Vec<u32>,
    /// Held axes of each pin.
    pub axes: alloc::vec::Vec<u8>,
    /// Position of each pin before any motion, m.
    pub anchors: alloc::vec::Vec<Vec3>,
    /// Index of each pin's motion in `table`, or [`AT_REST`].
    pub motions: alloc::vec::Vec<u32>,
    /// The motions.
    pub table: alloc::vec::Vec<Motion>,
    /// The keys of all motions.
    pub keys: alloc::vec::Vec<Key>,
    /// When the first of the pins hold; those after them always do.
    pub holds: alloc::vec::Vec<Hold>,
    /// Collider that carries each pin, or [`NO_CARRIER`]; empty until a collider carries one.
    pub carriers: alloc::vec::Vec<u32>,
    /// Index of the first slot of the host.
    pub of_scene: u32,
}

#[cfg(feature = "alloc")]
impl PinColumns {
    /// The borrowed view that kernels take, of pins that no collider carries.
    pub fn view(&self) -> Pins<'_> {
        self.carried_by(Colliders::default())
    }

    /// The borrowed view that kernels take.
    pub fn carried_by<'a>(&'a self, colliders: Colliders<'a>) -> Pins<'a> {
        let Self { vertices, axes, anchors, motions, table, keys, carriers, .. } = self;
        Pins { vertices, axes, anchors, motions, table, keys, carriers, colliders }
    }

    /// The borrowed pins, to change them.
    pub fn slots(&mut self) -> PinSlots<'_> {
        let Self { vertices, axes, anchors, motions, table, keys, holds, carriers, of_scene } = self;
        PinSlots { vertices, axes, anchors, motions, table, keys, holds, carriers, of_scene: *of_scene }
    }

    /// Whether two pins of a vertex move it alike.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub(crate) fn move_alike(&self, a: usize, b: usize) -> bool {
        let of = |pin: usize| self.table.get(self.motions[pin] as usize);
        let motion = |pin: usize| of(pin).map(|motion| (motion.turn(), motion.own(&self.keys)));
        self.motions[a] == self.motions[b] || motion(a) == motion(b)
    }

    /// Adds a slot of the host, which holds nothing.
    #[cfg_attr(small, optimize(size), inline(never))]
    pub fn add_slot(&mut self) {
        self.motions.push(self.table.len() as u32);
        self.table.push(Motion::new([self.keys.len() as u32, 3], None));
        self.keys.extend([Key { time: 0.0, value: DVec3::ZERO }; 3]);
        self.vertices.push(0);
        self.axes.push(0);
        self.anchors.push(Vec3::ZERO);
        if !self.carriers.is_empty() {
            self.carriers.push(NO_CARRIER);
        }
    }

    /// The pins that a host holds.
    pub(crate) fn of_host(&self) -> impl Iterator<Item = usize> + use<'_> {
        (self.of_scene as usize..self.vertices.len()).filter(|&pin| self.axes[pin] != 0)
    }

    /// The vertices that a host let go from pins of its scene, which `other` has, too.
    pub(crate) fn let_go_by_host(&self, other: &Self) -> alloc::vec::Vec<u32> {
        let count = self.of_scene as usize;
        let of_scene = |pins: &Self| pins.of_scene == self.of_scene && pins.vertices[..count] == self.vertices[..count];
        let is_let_go = |pin: &usize| self.axes[*pin] == 0 && self.holds.get(*pin).is_none_or(|hold| hold.axes == 0);
        let pins = (0..count).filter(|_| of_scene(other)).filter(is_let_go);
        pins.map(|pin| self.vertices[pin]).collect()
    }

    /// The collider that carries a pin.
    pub(crate) fn carrier(&self, pin: usize) -> Option<u32> {
        self.carriers.get(pin).copied().filter(|&body| body != NO_CARRIER)
    }

    /// Copies a pin of another scene into a free slot. With a place, m, the vertex rests there instead.
    pub(crate) fn copy_slot(&mut self, of: &Self, pin: usize, place: Option<Vec3>) {
        let mut slots = self.slots();
        let anchor = place.unwrap_or(of.anchors[pin]);
        let Some(slot) = slots.take(of.vertices[pin], anchor) else { return };
        if let (Some(carrier), None) = (of.carrier(pin), place) {
            slots.carriers.set(slot, carrier);
        }
        let motion = |table: &[Motion], motions: &[u32], pin: usize| table[motions[pin] as usize].keys[0] as usize;
        let (to, from) = (motion(slots.table, slots.motions, slot), motion(&of.table, &of.motions, pin));
        slots.keys[to..to + 3].copy_from_slice(&of.keys[from..from + 3]);
        if place.is_some() {
            slots.keys[to..to + 3].iter_mut().for_each(|key| key.value = DVec3::ZERO);
        }
    }

    /// Lets colliders carry pins.
    pub fn allow_carriers(&mut self) {
        self.carriers.resize(self.vertices.len(), NO_CARRIER);
    }
}
