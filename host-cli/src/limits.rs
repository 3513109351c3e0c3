//! Limits on the length of a run, on its memory and on the size of input files. Larger ones are refused with a message.
//!
//! This module only refuses values that are too large; the core refuses invalid ones (NaN, negative).

use std::fs::File;
use std::hint::black_box;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

use muslin_core::scene::SceneDesc;
use sysinfo::System;

/// Largest size of the text of a scene or a sweep, bytes. The parsed values take about a hundred times as much memory.
pub const TEXT: u64 = 1 << 20;

/// Largest size of a file with data, such as a mesh, bytes.
pub const DATA: u64 = 4 << 30;

/// Largest size of data from a device or a pipe, which may have no end, bytes.
const STREAM: u64 = 64 << 20;

/// Largest number of steps of a run, and of a frame. These steps take more than a week at a microsecond each,
/// and their number is exact in a double.
const MOST_STEPS: f64 = 1e12;

/// Largest number of frames: file formats count them in 31 bits.
const MOST_FRAMES: f64 = 2_147_483_647.0;

/// Memory that is not asked for, bytes.
const SMALL: u64 = 100_000_000;

/// Checks the numbers of frames and steps of a scene; the message says which values to change.
pub fn check(scene: &SceneDesc) -> Result<(), String> {
    let (duration, rate, step) = (scene.duration, scene.frame_rate, scene.integrator.step());
    let frames = duration * rate;
    if frames > MOST_FRAMES {
        return Err(format!(
            "duration = {duration:?} and frame_rate = {rate:?} make too many frames; at most 2^31 are possible: \
             take a shorter duration or a lower frame_rate"
        ));
    }
    if step > 0.0 && rate > 0.0 && frames.max(1.0) * (1.0 / rate / step).max(1.0) > MOST_STEPS {
        return Err(format!(
            "duration = {duration:?}, frame_rate = {rate:?} and integrator.step = {step:?} make too many steps; \
             at most {MOST_STEPS:e} are possible: take a shorter duration or a longer step"
        ));
    }
    Ok(())
}

/// Reads an input file of at most `most` bytes. Every input is read by this function.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let file = File::open(path)?;
    let found = file.metadata()?;
    let most = if found.is_file() { most } else { most.min(STREAM) };
    let mut bytes = Vec::new();
    // A file that is too large is not read at all.
    if !found.is_file() || found.len() <= most {
        file.take(most + 1).read_to_end(&mut bytes)?;
        if bytes.len() as u64 <= most {
            return Ok(bytes);
        }
    }
    let why = format!("it is larger than {} MiB, the limit for such a file", most >> 20);
    Err(io::Error::new(ErrorKind::FileTooLarge, why))
}

/// Reads the text of a scene or a sweep.
pub fn read_text(path: &Path) -> io::Result<String> {
    let bytes = read(path, TEXT).map_err(|error| match error.kind() {
        ErrorKind::FileTooLarge => {
            io::Error::other(format!("{error}; put meshes, start positions and seams into files of their own"))
        }
        _ => error,
    })?;
    String::from_utf8(bytes).map_err(|_| io::Error::other("it is not text in UTF-8"))
}

/// Whether the process may have so many bytes, and they are free on the machine, or in the container. The system itself
/// may grant more than there is, and end the process later.
pub fn has_memory(needed: u64) -> bool {
    let mut trial: Vec<u8> = Vec::new();
    let is_granted = usize::try_from(needed).is_ok_and(|bytes| trial.try_reserve_exact(bytes).is_ok());
    // Without this, the compiler may leave the reservation out.
    black_box(trial);
    is_granted && is_free(needed)
}

fn is_free(needed: u64) -> bool {
    // The question takes longer than to build a small scene.
    if needed < SMALL {
        return true;
    }
    let free = shared().iter().map(|limit| limit.free).min();
    // 0: the system does not tell the free memory.
    free.is_none_or(|free| free == 0 || needed <= free)
}

/// The limit that leaves the process the least memory, for a message about too little memory.
pub fn memory_in_words() -> String {
    let least = shared().into_iter().chain(address_space()).min_by_key(|limit| limit.free);
    least.map_or_else(String::new, |limit| {
        let [all, used] = [limit.all, limit.all.saturating_sub(limit.free)].map(|bytes| bytes / 1_000_000);
        format!("; {used} MB of the {all} MB that {} are in use", limit.whose)
    })
}

/// A limit on memory.
struct Limit {
    /// Who has so much, or allows it: the end of `the 40 MB that ...`.
    whose: &'static str,
    /// The limit, bytes.
    all: u64,
    /// Memory that is not in use, bytes.
    free: u64,
}

/// The memory of the machine and of the container, which processes share.
fn shared() -> Vec<Limit> {
    let Ok(mut system) = System::new() else { return Vec::new() };
    system.refresh_memory();
    let machine = Limit {
        whose: "the machine has",
        all: system.total_memory() + system.total_swap(),
        free: system.available_memory() + system.free_swap(),
    };
    let container = system.cgroup_limits().map(|limits| Limit {
        whose: "the container may have",
        all: limits.total_memory,
        // The cache of files does not count as used: the system frees it.
        free: limits.total_memory.saturating_sub(limits.rss) + limits.free_swap,
    });
    [machine].into_iter().chain(container).collect()
}

/// The address space of the process, where Linux tells its limit.
fn address_space() -> Option<Limit> {
    let number = |file, key| {
        let text = std::fs::read_to_string(file).ok()?;
        let rest = text.lines().find_map(|line| line.strip_prefix(key))?;
        rest.split_whitespace().next()?.parse::<u64>().ok()
    };
    let all = number("/proc/self/limits", "Max address space")?;
    let used = 1024 * number("/proc/self/status", "VmSize:")?;
    Some(Limit { whose: "ulimit -v allows", all, free: all.saturating_sub(used) })
}
