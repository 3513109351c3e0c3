//! Converts the pins of a cloth to columns.

use glam::DVec3;

use super::build::{Parts, Sheet};
use super::motion::{MotionError, read_motion};
use super::{PinDesc, select};
use crate::error::SceneError;
use crate::integrate::pins::AT_REST;
use crate::real::vec3;

impl Parts {
    pub(super) fn add_pin(
        &mut self,
        sheet: &Sheet<'_>,
        placed: &[DVec3],
        (cloth, number): (u32, u32),
        pin: &PinDesc,
    ) -> Result<(), SceneError> {
        let selected =
            select::select(&pin.select, &sheet.mesh.positions, placed).map_err(|error| error.at(cloth, number))?;
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
        for vertex in selected {
            self.pins.vertices.push(sheet.first + vertex);
            self.pins.axes.push(axes);
            self.pins.anchors.push(vec3((placed[vertex as usize] - origin).into()));
            self.pins.motions.push(motion);
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
