//! The finished runs of a study, kept on disk until it is complete: after an interrupt, or if the process is killed,
//! the same command goes on from them.
//!
//! Each outcome is a file in a folder `NAME.kept` beside the results: a checksum, then the question and the outcome. A
//! question says everything that the outcome depends on, and for a run that is repeated to time it, the number of the
//! repeat. A file that is damaged or of another question counts as absent.

use std::collections::HashMap;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::export::whole;
use crate::failure::print_note;
use crate::limits;

/// The kept outcomes of a study.
pub struct Kept {
    folder: PathBuf,
    /// How often each question was asked.
    asked: Mutex<HashMap<String, u32>>,
    known: AtomicUsize,
    fails: AtomicBool,
}

/// A question and the file of its outcome.
pub struct Entry {
    question: String,
    file: PathBuf,
}

impl Kept {
    /// The outcomes of the study `name` in a folder. Nothing is read or written yet.
    pub fn of(folder: &Path, name: &str) -> Self {
        Self {
            folder: folder.join(format!("{name}.kept")),
            asked: Mutex::default(),
            known: AtomicUsize::new(0),
            fails: AtomicBool::new(false),
        }
    }

    /// The entry of a question that is asked now. The question need not name the version of the tool.
    pub fn entry(&self, question: &str) -> Entry {
        let mut asked = self.asked.lock().unwrap_or_else(PoisonError::into_inner);
        let times = asked.entry(question.into()).or_default();
        *times += 1;
        let question = format!("muslin {}, {question}, time {times}", env!("CARGO_PKG_VERSION"));
        let file = self.folder.join(format!("{:08x}", crc32fast::hash(question.as_bytes())));
        Entry { question, file }
    }

    /// The outcome of an earlier call, if there is one that `serves`.
    pub fn find<T: DeserializeOwned>(&self, entry: &Entry, serves: impl FnOnce(&T) -> bool) -> Option<T> {
        let bytes = limits::read(&entry.file, limits::DATA).ok()?;
        let (crc, rest) = bytes.split_first_chunk()?;
        if crc32fast::hash(rest) != u32::from_le_bytes(*crc) {
            return None;
        }
        let (question, outcome): (String, T) = postcard::from_bytes(rest).ok()?;
        let found = (question == entry.question && serves(&outcome)).then_some(outcome);
        self.known.fetch_add(usize::from(found.is_some()), Ordering::Relaxed);
        found
    }

    /// Keeps an outcome. Where it cannot be written, the study goes on, and a note says so once.
    pub fn keep<T: Serialize>(&self, entry: &Entry, outcome: &T) {
        let written = postcard::to_allocvec(&(&entry.question, outcome)).map_err(|error| error.to_string());
        let written = written.and_then(|bytes| {
            let crc = crc32fast::hash(&bytes).to_le_bytes();
            let fill =
                |file: &mut std::io::BufWriter<fs::File>| file.write_all(&crc).and_then(|()| file.write_all(&bytes));
            whole::write(entry.file.clone(), fill).map_err(|error| error.to_string())
        });
        if let Err(why) = written
            && !self.fails.swap(true, Ordering::Relaxed)
        {
            print_note(&format!("{why}; an interrupt will lose finished runs"));
        }
    }

    /// Number of outcomes that were known from an earlier call.
    pub fn known(&self) -> usize {
        self.known.load(Ordering::Relaxed)
    }

    /// Removes all kept outcomes: the study is complete.
    pub fn forget(&self) {
        // They only save time, so an error of the removal is ignored.
        let _ = fs::remove_dir_all(&self.folder);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(folder: &tempfile::TempDir) -> Kept {
        Kept::of(folder.path(), "chart")
    }

    #[test]
    fn an_outcome_is_found_by_its_question_and_the_number_of_the_repeat() {
        let folder = tempfile::tempdir().unwrap();
        let first = kept(&folder);
        let outcomes = [f64::NAN, f64::INFINITY, 0.1 + 0.2].map(Some);
        outcomes.iter().for_each(|outcome| first.keep(&first.entry("a run"), outcome));
        let next = kept(&folder);
        let found = outcomes.map(|_| next.find::<Option<f64>>(&next.entry("a run"), |_| true).unwrap());
        assert_eq!(found.map(|x| x.unwrap().to_bits()), outcomes.map(|x| x.unwrap().to_bits()));
        assert_eq!(next.find::<Option<f64>>(&next.entry("a run"), |_| true), None, "it was asked a fourth time");
        assert_eq!(next.find::<Option<f64>>(&next.entry("another run"), |_| true), None);
        assert_eq!(next.known(), 3);
        let strict = kept(&folder);
        assert_eq!(strict.find::<Option<f64>>(&strict.entry("a run"), |_| false), None);
        next.forget();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn every_truncation_and_every_flipped_bit_counts_as_absent() {
        let folder = tempfile::tempdir().unwrap();
        let kept = kept(&folder);
        let entry = kept.entry("a run");
        kept.keep(&entry, &vec![1.0_f64, 2.0]);
        let good = fs::read(&entry.file).unwrap();
        let is_found = |bytes: &[u8]| {
            fs::write(&entry.file, bytes).unwrap();
            kept.find::<Vec<f64>>(&entry, |_| true).is_some()
        };
        assert!(is_found(&good));
        assert!((0..good.len()).all(|length| !is_found(&good[..length])));
        for bit in 0..8 * good.len() {
            let mut bad = good.clone();
            bad[bit / 8] ^= 1 << (bit % 8);
            assert!(!is_found(&bad), "bit {bit}");
        }
    }
}
