//! Pictures of the cloth in motion: a looping GIF and a contact sheet (PNG).

mod camera;
#[cfg(test)]
mod decode;
mod image;
mod palette;
mod picture;
mod raster;
mod shade;
mod shadow;
mod solids;
mod view;

use std::io::Write;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::export::whole::{self, WriteError};
use image::{Animation, Image};
use palette::Palette;
use picture::Things;
pub use solids::Solid;
use solids::Solids;
use view::Views;

/// Picture size, pixels.
const SIZE: [usize; 2] = [480, 360];
/// Columns and rows of the contact sheet.
const SHEET: [usize; 2] = [3, 2];
/// White gap between the pictures of the sheet, pixels.
const GAP: usize = 4;
/// The shortest time for which viewers show a picture, hundredths of a second.
const SHORTEST_DELAY: f64 = 3.0;
/// How long the last picture is shown, hundredths of a second.
const LAST_DELAY: u16 = 80;
/// Number of pictures from which the palette is chosen.
const PALETTE_PICTURES: usize = 8;
/// Number of pictures drawn at once.
const BATCH: usize = 16;

/// Memory that one thread takes for the samples and pixels of its picture and its shadows, bytes: 20 MB and a margin.
const PER_PICTURE: usize = 25_000_000;
/// Memory for a batch of drawn pictures, 12 MB, the search for a palette and the file, with a wide margin, bytes.
const SHARED: usize = 64_000_000;
/// Memory that one thread takes per vertex and per triangle of cloth and colliders, bytes: vectors, and lists that grow.
const PER_VERTEX: usize = 50;
const PER_TRIANGLE: usize = 80;

/// Why a picture could not be made.
#[derive(Debug, thiserror::Error)]
pub enum PreviewError {
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// There is nothing to show.
    #[error("there is no frame to make a picture of; simulate one step or more")]
    Empty,
    /// The user interrupted the drawing.
    #[error("interrupted while the picture was drawn")]
    Interrupted,
}

/// Cloth and colliders at one instant.
struct Snapshot {
    /// Vertices of the cloth, m.
    cloth: Vec<Vec3>,
    /// Vertices of the colliders, m.
    places: Vec<[f32; 3]>,
    /// Vertices that pins hold.
    pins: Vec<u32>,
}

/// Collects snapshots of a run and draws them.
pub struct Preview {
    triangles: Vec<[u32; 3]>,
    solids: Solids,
    frame_rate: f64,
    most_frames: usize,
    snapshots: Vec<Snapshot>,
    /// Frames from one snapshot to the next.
    stride: usize,
    frames: usize,
}

impl Preview {
    /// A preview of cloth with these triangles and of these colliders, at `frame_rate` frames per second. It stores at
    /// most `most_frames` snapshots, and at least two.
    pub fn new(triangles: &[[u32; 3]], solids: Vec<Solid>, frame_rate: f64, most_frames: usize) -> Preview {
        Preview {
            triangles: triangles.into(),
            solids: Solids::new(solids),
            frame_rate,
            most_frames: most_frames.max(2),
            snapshots: Vec::new(),
            stride: 1,
            frames: 0,
        }
    }

    /// Takes the next frame: the positions of all vertices of the cloth, in the world, and of the colliders, from
    /// `origin`, metres, and the vertices that pins hold, which are asked for if the frame is kept. All is drawn from
    /// there: single precision would round a scene far from the world's origin. When there are too many snapshots,
    /// every second one is dropped, so that they span the whole run.
    pub fn frame(
        &mut self,
        positions: &[[f64; 3]],
        places: &[[f32; 3]],
        pins: impl FnOnce() -> Vec<u32>,
        origin: [f64; 3],
    ) {
        if self.frames.is_multiple_of(self.stride) {
            if self.snapshots.len() == self.most_frames {
                self.thin_out();
            }
            if self.frames.is_multiple_of(self.stride) {
                let cloth = positions.iter().map(|&x| (DVec3::from(x) - DVec3::from(origin)).as_vec3()).collect();
                self.snapshots.push(Snapshot { cloth, places: places.into(), pins: pins() });
            }
        }
        self.frames += 1;
    }

    /// Memory that the threads of the current pool need for the drawing, bytes; the snapshots are not counted.
    pub fn memory_to_draw(&self) -> u64 {
        let cloth = self.snapshots.first().map_or(0, |first| first.cloth.len());
        let solids = self.solids.point_count();
        let triangles = self.triangles.len() + self.solids.triangles.len();
        let picture = PER_PICTURE + PER_VERTEX * (cloth + solids) + PER_TRIANGLE * triangles;
        // Lists that grow have up to twice the room that they need.
        let of_all_snapshots = 2 * size_of::<Vec3>() * solids * self.snapshots.len();
        (SHARED + of_all_snapshots + picture * rayon::current_num_threads().min(BATCH)) as u64
    }

    fn thin_out(&mut self) {
        let mut place = 0;
        self.snapshots.retain(|_| {
            place += 1;
            place % 2 == 1
        });
        self.stride *= 2;
    }

    /// Writes an animation that loops and runs in real time.
    pub fn write_gif(&self, path: &Path, stop: &AtomicBool) -> Result<(), PreviewError> {
        let views = self.views()?;
        let shown = self.shown();
        let sample: Vec<usize> = spread(shown.len(), PALETTE_PICTURES).map(|k| shown[k]).collect();
        let palette = Palette::of(&self.draw(&views, &sample, stop)?);
        let delays = self.delays(&shown);
        let failed = |cause| WriteError { path: path.into(), cause };
        let mut bytes = Vec::new();
        let mut animation = Animation::new(&mut bytes, SIZE, &palette.colours).map_err(failed)?;
        for (batch, delays) in shown.chunks(BATCH).zip(delays.chunks(BATCH)) {
            let pictures = self.draw(&views, batch, stop)?;
            let indexed: Vec<_> = pictures.par_iter().map(|picture| palette.indices(picture)).collect();
            for (pixels, &delay) in indexed.into_iter().zip(delays) {
                animation.add(pixels, delay).map_err(failed)?;
            }
        }
        drop(animation);
        whole::write(path.into(), |file| file.write_all(&bytes))?;
        Ok(())
    }

    /// Writes one picture of six instants over the run.
    pub fn write_png(&self, path: &Path, stop: &AtomicBool) -> Result<(), PreviewError> {
        let views = self.views()?;
        let instants: Vec<usize> = spread(self.snapshots.len(), SHEET[0] * SHEET[1]).collect();
        let size = [0, 1].map(|k| SHEET[k] * (SIZE[k] + GAP) - GAP);
        let mut sheet = Image::filled(size, [255; 3]);
        for (k, tile) in self.draw(&views, &instants, stop)?.iter().enumerate() {
            sheet.put(tile, [k % SHEET[0] * (SIZE[0] + GAP), k / SHEET[0] * (SIZE[1] + GAP)]);
        }
        whole::write(path.into(), |file| sheet.write_png(file))?;
        Ok(())
    }

    fn views(&self) -> Result<Views, PreviewError> {
        let first = self.snapshots.first().ok_or(PreviewError::Empty)?;
        let solids: Vec<_> = self.snapshots.iter().map(|snapshot| self.solids.points(&snapshot.places)).collect();
        let cloth = self.snapshots.iter().map(|snapshot| snapshot.cloth.as_slice());
        Ok(Views::around(cloth, &solids, self.solids.floor(&first.places), SIZE))
    }

    fn draw(&self, views: &Views, snapshots: &[usize], stop: &AtomicBool) -> Result<Vec<Image>, PreviewError> {
        let last = (self.snapshots.len() - 1).max(1) as f32;
        let draw = |&k: &usize| {
            if stop.load(Ordering::Relaxed) {
                return Err(PreviewError::Interrupted);
            }
            let Snapshot { cloth, places, pins } = &self.snapshots[k];
            let solids = self.solids.points(places);
            let things = Things { cloth, triangles: &self.triangles, solids: &solids, others: &self.solids.triangles };
            Ok(picture::draw(&views.at(k), &things, pins, k as f32 / last))
        };
        snapshots.par_iter().map(draw).collect()
    }

    /// Time of a snapshot, hundredths of a second.
    fn time(&self, snapshot: usize) -> f64 {
        (snapshot * self.stride) as f64 / self.frame_rate * 100.0
    }

    /// The snapshots of the animation: all of them, or fewer if viewers could not keep up.
    fn shown(&self) -> Vec<usize> {
        let step = (SHORTEST_DELAY / self.time(1)).ceil().max(1.0) as usize;
        (0..self.snapshots.len()).step_by(step).collect()
    }

    /// How long each snapshot is shown, hundredths of a second. Rounding errors do not add up.
    fn delays(&self, shown: &[usize]) -> Vec<u16> {
        let delay = |pair: &[usize]| (self.time(pair[1]).round() - self.time(pair[0]).round()) as u16;
        shown.windows(2).map(delay).chain([LAST_DELAY]).collect()
    }
}

/// Places of `instants` snapshots, spread evenly from the first to the last of `count` >= 1 snapshots.
fn spread(count: usize, instants: usize) -> impl Iterator<Item = usize> {
    let steps = instants - 1;
    (0..instants).map(move |k| (2 * k * (count - 1) + steps) / (2 * steps))
}

#[cfg(test)]
mod tests {
    use super::decode::Decoded;
    use super::*;
    use std::collections::HashSet;
    use std::fs;

    const SIDE: usize = 12;

    /// No interrupt.
    static GO: AtomicBool = AtomicBool::new(false);

    /// A grid of squares with `SIDE` vertices along each side, two triangles per square.
    fn grid() -> Vec<[u32; 3]> {
        let corner = |i: usize, j: usize| (j * SIDE + i) as u32;
        let squares = (1..SIDE).flat_map(|j| (1..SIDE).map(move |i| [i - 1, i, j - 1, j]));
        squares
            .flat_map(|[i, k, j, l]| {
                [[corner(i, j), corner(i, l), corner(k, j)], [corner(k, j), corner(i, l), corner(k, l)]]
            })
            .collect()
    }

    /// A horizontal cloth of one metre with moving waves; flat in frame 0.
    fn waves(frame: usize) -> Vec<[f64; 3]> {
        let across = |k: usize| k as f64 / (SIDE - 1) as f64;
        let height = |x: f64| 0.1 * frame.min(1) as f64 * (6.0 * x + 0.5 * frame as f64).sin();
        (0..SIDE * SIDE).map(|k| (across(k % SIDE), across(k / SIDE))).map(|(x, z)| [x, height(x), z]).collect()
    }

    fn preview(frames: usize) -> Preview {
        let floor = Solid::Plane { vertex: 0, normal: [0.0, 1.0, 0.0] };
        let mut preview = Preview::new(&grid(), vec![floor], 30.0, 16);
        let places = [[0.0, -0.2, 0.0]];
        (0..frames).for_each(|frame| preview.frame(&waves(frame), &places, || vec![0, 11], [0.0; 3]));
        preview
    }

    fn gif(preview: &Preview) -> Vec<Decoded> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.gif");
        preview.write_gif(&path, &GO).unwrap();
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
        decode::gif(&fs::read(path).unwrap())
    }

    fn sheet(preview: &Preview) -> Decoded {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sheet.png");
        preview.write_png(&path, &GO).unwrap();
        decode::png(&fs::read(path).unwrap())
    }

    /// Number of pixels of fabric: red and blue differ more in them than in any pixel of wall and floor.
    fn fabric(picture: &Decoded) -> usize {
        picture.pixels.iter().filter(|p| p[0].abs_diff(p[2]) > 24).count()
    }

    #[test]
    fn the_animation_shows_moving_cloth() {
        let pictures = gif(&preview(8));
        assert_eq!(pictures.len(), 8);
        for picture in &pictures {
            assert_eq!(picture.size, [480, 360]);
            assert!(fabric(picture) > 10_000, "{}", fabric(picture));
            assert!(picture.pixels.iter().collect::<HashSet<_>>().len() > 60);
        }
        for pair in pictures.windows(2) {
            let changed = pair[0].pixels.iter().zip(&pair[1].pixels).filter(|(a, b)| a != b).count();
            assert!(changed > 1000, "{changed}");
        }
    }

    #[test]
    fn the_animation_keeps_real_time() {
        let time = |rate: f64| {
            let mut preview = preview(13);
            preview.frame_rate = rate;
            let pictures = gif(&preview);
            assert!(pictures.iter().all(|picture| picture.delay >= 3));
            pictures.iter().rev().skip(1).map(|picture| picture.delay).sum::<u16>()
        };
        assert_eq!(time(30.0), 40);
        assert_eq!(time(60.0), 20);
        assert_eq!(time(120.0), 10);
    }

    #[test]
    fn the_sheet_shows_six_instants() {
        let sheet = sheet(&preview(3));
        assert_eq!(sheet.size, [1448, 724]);
        assert!(fabric(&sheet) > 60_000);
        assert!(sheet.pixels.iter().collect::<HashSet<_>>().len() > 1000);
    }

    #[test]
    fn snapshots_span_the_run() {
        for frames in [1, 16, 17, 100, 1000] {
            let preview = preview(frames);
            assert!(preview.snapshots.len() <= 16 && preview.snapshots.len() * 2 >= frames.min(16));
            for (k, snapshot) in preview.snapshots.iter().enumerate() {
                assert_eq!(snapshot.cloth[5], DVec3::from(waves(k * preview.stride)[5]).as_vec3());
            }
            let last = (preview.snapshots.len() - 1) * preview.stride;
            assert!(last < frames && frames - last <= preview.stride);
        }
    }

    #[test]
    fn diverged_cloth_does_no_harm() {
        let mut preview = preview(3);
        let whole = fabric(&sheet(&preview));
        for bad in [f64::NAN, f64::INFINITY, 1e30, -3e38] {
            let mut frame = waves(3);
            frame[40] = [bad, 0.0, bad];
            preview.frame(&frame, &[], Vec::new, [0.0; 3]);
            preview.frame(&[[bad; 3]; SIDE * SIDE], &[], || vec![3], [0.0; 3]);
        }
        let left = fabric(&sheet(&preview));
        assert!(whole / 4 < left && left < whole, "{left} of {whole}");
        assert_eq!(gif(&preview).len(), 11);
    }

    #[test]
    fn odd_input_does_no_harm() {
        let mut preview = Preview::new(&[[0, 1, 7]], Vec::new(), f64::NAN, 0);
        assert!(matches!(preview.write_gif(Path::new("never.gif"), &GO), Err(PreviewError::Empty)));
        preview.frame(&[], &[], || vec![9], [0.0; 3]);
        preview.frame(&[[0.0; 3]; 2], &[], || vec![9], [0.0; 3]);
        preview.frame(&[[1.0; 3]; 8], &[], || vec![9], [0.0; 3]);
        for rate in [f64::NAN, 0.0, -1.0, f64::INFINITY, 1e-9] {
            preview.frame_rate = rate;
            assert!(!gif(&preview).is_empty());
        }
    }

    #[test]
    fn pins_are_asked_for_in_the_snapshots_only() {
        let (mut preview, mut asked) = (preview(0), 0);
        for frame in 0..64 {
            let count = || {
                asked += 1;
                Vec::new()
            };
            preview.frame(&waves(frame), &[], count, [0.0; 3]);
        }
        // Every frame up to 16, every second one up to 32, every fourth one up to 64.
        assert_eq!((asked, preview.snapshots.len()), (16 + 8 + 8, 16));
    }

    #[test]
    fn names_the_file_that_cannot_be_written() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("file"), "").unwrap();
        let failed = preview(1).write_png(&folder.path().join("file/a.png"), &GO);
        assert!(failed.unwrap_err().to_string().contains("a.png: "));
    }

    #[test]
    fn an_interrupted_picture_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let (path, stop) = (folder.path().join("a"), AtomicBool::new(true));
        let drawn = [preview(3).write_gif(&path, &stop), preview(3).write_png(&path, &stop)];
        assert!(drawn.iter().all(|drawn| matches!(drawn, Err(PreviewError::Interrupted))), "{drawn:?}");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
    }
}
