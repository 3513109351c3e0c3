//! The series of a run: a row of measurements for each frame, as comma-separated values. An interrupted series can be
//! continued.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use glam::DVec3;
use muslin_core::work_done::WorkDone;

use super::course::Course;
use crate::engine::Engine;
use crate::export::whole::{Partial, WriteError};
use crate::warning::Warning;

/// The columns before the reactions.
const COLUMNS: &str = "frame,time_s,kinetic_J,stretch_J,shear_J,bend_J,seam_J,gravity_J,work_pins_J,work_colliders_J,\
                       work_wind_J,work_gravity_J,work_separation_J,work_contacts_J,work_damping_J,method_J,\
                       momentum_x_kg_m_per_s,momentum_y_kg_m_per_s,momentum_z_kg_m_per_s,\
                       angular_momentum_x_kg_m2_per_s,angular_momentum_y_kg_m2_per_s,angular_momentum_z_kg_m2_per_s,\
                       largest_stretch";

/// Writes the series.
pub struct TimeSeries {
    partial: Partial,
    /// The number of its first frame.
    begins: u64,
}

impl TimeSeries {
    /// Begins the file, or continues that of an interrupted or shorter run if it has all frames before the first one.
    pub fn begin(path: &Path, course: &Course, first_frame: u64) -> Result<Self, WriteError> {
        let header = header(course.engine.as_ref());
        if first_frame > 0
            && let Some(mut partial) = Partial::reopen(path)?
            && let Some(begins) = partial.with(|file| rewind(file, &header, first_frame))?
        {
            return Ok(Self { partial, begins });
        }
        let mut partial = Partial::create(path.into())?;
        partial.with(|file| writeln!(file, "{header}"))?;
        Ok(Self { partial, begins: first_frame })
    }

    /// Writes the row of a frame.
    pub fn frame(&mut self, course: &Course) -> Result<(), WriteError> {
        let row = row(course);
        self.partial.with(|file| writeln!(file, "{row}"))
    }

    /// Writes buffered data to disk, for a later run to continue.
    pub fn flush(&mut self) -> Result<(), WriteError> {
        self.partial.sync()
    }

    /// Completes the file; returns its path.
    pub fn finish(self) -> Result<PathBuf, WriteError> {
        self.partial.finish()
    }

    /// A warning if the rows before a resumed run are missing.
    pub fn missing(&self) -> Option<Warning> {
        let (path, frame) = (self.partial.path().display(), self.begins);
        let text =
            format!("--series: {path} begins with frame {frame}; the folder does not contain the rows before it");
        (frame > 0).then(|| Warning::new("frames-missing", text))
    }
}

/// The names of all columns.
fn header(engine: &dyn Engine) -> String {
    let groups = engine.pin_groups();
    let colliders = engine.impulses().len() - groups.len();
    let pins = groups.iter().map(|group| format!("pin_{}_{}", group.cloth, group.number));
    let mut header = COLUMNS.to_owned();
    let mut add = |of: &str, quantity: &str, unit: &str| {
        ["x", "y", "z"].iter().for_each(|axis| header.extend([",", of, "_", quantity, "_", axis, "_", unit]));
    };
    for of in pins.chain((0..colliders).map(|number| format!("collider_{number}"))) {
        add(&of, "force", "N");
        add(&of, "moment", "N_m");
    }
    let all = [("pins", groups.len()), ("colliders", colliders)];
    all.iter().filter(|(_, count)| *count > 1).for_each(|(of, _)| add(of, "force", "N"));
    header
}

/// The row of the present frame. The first frame has no forces, because they are means over the time before it.
fn row(course: &Course) -> String {
    let Course { engine, timing, steps, .. } = course;
    let (report, balance) = (engine.report(), course.record().balance);
    let WorkDone { pins, colliders, wind, gravity, separation, contacts, damping, .. } = balance.work;
    let works = [pins, colliders, wind, gravity, separation, contacts, damping];
    let frame = steps / timing.steps_per_frame;
    let mut row = frame.to_string();
    let mut add = |value: f64| {
        // Writing to a string does not fail. Zero has no sign.
        let _ = write!(row, ",{:?}", value + 0.0);
    };
    [course.time()].iter().chain(&report.energy).chain(&works).for_each(|&value| add(value));
    add(balance.by_method(&report.energy));
    report.momentum.iter().chain(&engine.angular_momentum()).for_each(|&value| add(value));
    add(report.stretch[0]);
    let impulses = engine.impulses();
    let (pins, colliders) = impulses.split_at(engine.pin_groups().len());
    let several = [pins, colliders].into_iter().filter(|parts| parts.len() > 1);
    let sums = |parts: &[[f64; 6]]| [0, 1, 2].map(|axis| parts.iter().map(|part| part[axis]).sum::<f64>());
    let totals: Vec<_> = several.flat_map(sums).collect();
    if frame == 0 {
        row.extend(impulses.as_flattened().iter().chain(&totals).map(|_| ','));
        return row;
    }
    let period = timing.steps_per_frame as f64 * timing.step;
    // Moments are about the first vertex of a group, and about the world's origin for a collider.
    let anchors = engine.pin_groups().into_iter().map(|group| DVec3::from(group.anchor));
    let points = anchors.chain(std::iter::repeat(-DVec3::from(engine.origin())));
    for ([x, y, z, angular @ ..], point) in impulses.into_iter().zip(points) {
        let linear = DVec3::new(x, y, z);
        let moment = DVec3::from(angular) - point.cross(linear);
        linear.to_array().iter().chain(&moment.to_array()).for_each(|&value| add(value / period));
    }
    totals.iter().for_each(|&value| add(value / period));
    row
}

/// Truncates an older series to the rows before the first frame. Returns the number of its first frame; `None` if it
/// cannot be continued.
fn rewind(file: &mut BufWriter<File>, header: &str, first_frame: u64) -> io::Result<Option<u64>> {
    let mut reader = BufReader::new(file.get_ref());
    let mut line = String::new();
    let mut length = reader.read_line(&mut line)? as u64;
    if line.strip_suffix('\n') != Some(header) {
        return Ok(None);
    }
    let (mut begins, mut next) = (None, None);
    while next != Some(first_frame) {
        line.clear();
        length += reader.read_line(&mut line)? as u64;
        let frame: Option<u64> = line.split(',').next().and_then(|frame| frame.parse().ok());
        if !line.ends_with('\n') || frame.is_none() || (next.is_some() && frame != next) {
            return Ok(None);
        }
        begins = begins.or(frame);
        next = frame.map(|frame| frame + 1);
    }
    file.get_ref().set_len(length)?;
    file.seek(SeekFrom::End(0))?;
    Ok(begins)
}
