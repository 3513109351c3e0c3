//! A cloth's pins into columns.

use glam::DVec3;

use super::build::{Parts, Sheet};
use super::{MotionDesc, PinDesc, TurnDesc, select};
use crate::error::SceneError;
use crate::integrate::pins::{AT_REST, Key, Motion, Turn};
use crate::real::{Real, vec3};

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
        let motion = match &pin.motion {
            Some(motion) => self.add_motion(motion, centre).map_err(|error| match error {
                MotionError::Keys => SceneError::MotionKeys { cloth, pin: number },
                MotionError::Turn => SceneError::MotionTurn { cloth, pin: number },
            })?,
            None => AT_REST,
        };
        for vertex in selected {
            self.pins.vertices.push(sheet.first + vertex);
            self.pins.axes.push(axes);
            self.pins.anchors.push(vec3(placed[vertex as usize].into()));
            self.pins.motions.push(motion);
        }
        Ok(())
    }

    fn add_motion(&mut self, motion: &MotionDesc, centre: DVec3) -> Result<u32, MotionError> {
        let times_increase = motion.keys.windows(2).all(|k| k[0][0] < k[1][0]);
        if !times_increase || motion.keys.as_flattened().iter().any(|&x| !(x as Real).is_finite()) {
            return Err(MotionError::Keys);
        }
        let turn = motion.turn.as_ref().map(|turn| read_turn(turn, centre).ok_or(MotionError::Turn)).transpose()?;
        let first = self.pins.keys.len() as u32;
        self.pins.keys.extend(motion.keys.iter().map(|&[time, x, y, z]| Key { time, offset: vec3([x, y, z]) }));
        self.pins.table.push(Motion { keys: [first, motion.keys.len() as u32], turn });
        Ok(self.pins.table.len() as u32 - 1)
    }
}

/// What of a motion is not usable; the scene adds where it stands.
enum MotionError {
    Keys,
    Turn,
}

/// None where the axis has no direction or a number is none.
fn read_turn(turn: &TurnDesc, centre: DVec3) -> Option<Turn> {
    let until = turn.until.unwrap_or(f64::INFINITY);
    let axis = DVec3::from(turn.axis).try_normalize().filter(|_| turn.rate.is_finite() && !until.is_nan())?;
    Some(Turn { axis: vec3(axis.into()), centre: vec3(centre.into()), rate: turn.rate, until })
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
