//! Converts the pins of a cloth to columns.

use alloc::vec;

use glam::DVec3;

use super::build::{Parts, Sheet};
use super::check::not_negative;
use super::motion::{MotionError, read_motion};
use super::{PinDesc, select};
use crate::error::SceneError;
use crate::integrate::pins::{AT_REST, Hold, PinColumns};
use crate::mesh::edges::NONE;
use crate::reactions::PinGroup;
use crate::real::vec3;

impl Parts {
    pub(super) fn add_pin(
        &mut self,
        sheet: &Sheet<'_>,
        placed: &[DVec3],
        (cloth, number): (u32, u32),
        pin: &PinDesc,
    ) -> Result<(), SceneError> {
        let selected = select::select(&pin.select, sheet, placed, (cloth, "pin", number))?;
        let axes = axes(&pin.axes).ok_or(SceneError::PinAxes { cloth, pin: number })?;
        let centre = selected.iter().map(|&v| placed[v as usize]).sum::<DVec3>() / selected.len() as f64;
        let origin = self.origin.unwrap_or_default();
        let motion = match &pin.motion {
            Some(motion) => {
                let motion =
                    read_motion(motion, centre - origin, &mut self.pins.keys).map_err(|error| match error {
                        MotionError::Keys => SceneError::MotionKeys { cloth, pin: number },
                        MotionError::Turn => SceneError::MotionTurn { cloth, pin: number },
                    })?;
                self.pins.table.push(motion);
                self.pins.table.len() as u32 - 1
            }
            None => AT_REST,
        };
        let from = not_negative("cloth.pin.from", pin.from)?;
        let until = pin.until.unwrap_or(f64::INFINITY);
        if !(until > from && (until.is_finite() || pin.until.is_none())) {
            return Err(SceneError::PinEnds { cloth, pin: number });
        }
        let first = self.pins.vertices.len();
        for vertex in selected {
            self.pins.holds.push(Hold::new(axes, from, until));
            self.pins.vertices.push(sheet.first + vertex);
            self.pins.axes.push(if from > 0.0 { 0 } else { axes });
            self.pins.anchors.push(vec3((placed[vertex as usize] - origin).into()));
            self.pins.motions.push(motion);
        }
        self.pin_groups.push(PinGroup { cloth, number, pins: first..self.pins.vertices.len() });
        Ok(())
    }

    /// Refuses a cloth, the vertices of which begin at `first`, if its pins have different motions for a vertex at the
    /// same time.
    #[cfg_attr(small, optimize(size))]
    pub(super) fn check_pins(&self, first: u32) -> Result<(), SceneError> {
        let PinColumns { vertices, holds, .. } = &self.pins;
        let own = self.pin_groups.iter().rev().take_while(|group| vertices[group.pins.start] >= first);
        for (later, group) in own.enumerate().skip(1) {
            let mut of_vertex = vec![NONE; self.positions.len() - first as usize];
            for pin in group.pins.clone() {
                of_vertex[(vertices[pin] - first) as usize] = pin as u32;
            }
            for other in self.pin_groups.iter().rev().take(later) {
                for pin in other.pins.clone() {
                    let vertex = vertices[pin] - first;
                    let held = of_vertex[vertex as usize] as usize;
                    let meets = holds.get(held).is_some_and(|hold| hold.meets(&holds[pin]));
                    if meets && !self.pins.move_alike(held, pin) {
                        let pins = [group.number, other.number];
                        return Err(SceneError::PinsDisagree { cloth: group.cloth, pins, vertex });
                    }
                }
            }
        }
        Ok(())
    }
}

fn axes(text: &str) -> Option<u8> {
    let mut axes = 0;
    for letter in text.chars() {
        let bit = 1 << "xyz".find(letter)?;
        if axes & bit != 0 {
            return None;
        }
        axes |= bit;
    }
    (axes != 0).then_some(axes)
}
