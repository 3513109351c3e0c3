//! The 256 colours of an animation: median cut (P. Heckbert 1982), each cut where the colours vary most.

use std::collections::HashMap;

use image::RgbImage;

/// Colours that a GIF can hold.
const SIZE: usize = 256;

/// A palette and the colours already looked up in it.
pub struct Palette {
    colours: Vec<[u8; 3]>,
}

type Weighted = ([u8; 3], f32);

impl Palette {
    /// The colours that serve these pictures best.
    pub fn of(pictures: &[RgbImage]) -> Palette {
        let mut counts: HashMap<[u8; 3], f32> = HashMap::new();
        for pixel in pictures.iter().flat_map(|picture| picture.pixels()) {
            *counts.entry(pixel.0).or_default() += 1.0;
        }
        // In a fixed order, so that the same pictures give the same palette.
        let mut colours: Vec<Weighted> = counts.into_iter().map(|(colour, count)| (colour, count.sqrt())).collect();
        colours.sort_unstable_by_key(|(colour, _)| *colour);

        let mut groups = vec![Group::of(colours)];
        while groups.len() < SIZE
            && let Some(widest) = (0..groups.len()).max_by(|&a, &b| groups[a].spread.total_cmp(&groups[b].spread))
            && groups[widest].spread > 0.0
        {
            let halves = groups.swap_remove(widest).split();
            groups.extend(halves);
        }
        Palette { colours: groups.iter().map(Group::mean).collect() }
    }

    /// Replaces every colour by the nearest of the palette.
    pub fn apply(&self, picture: &mut RgbImage) {
        let mut known = HashMap::new();
        for pixel in picture.pixels_mut() {
            pixel.0 = *known.entry(pixel.0).or_insert_with(|| self.nearest(pixel.0));
        }
    }

    fn nearest(&self, colour: [u8; 3]) -> [u8; 3] {
        let distance = |c: &&[u8; 3]| (0..3).map(|k| u32::from(c[k].abs_diff(colour[k])).pow(2)).sum::<u32>();
        self.colours.iter().min_by_key(distance).copied().unwrap_or(colour)
    }
}

/// Colours that may share one of the palette.
struct Group {
    colours: Vec<Weighted>,
    /// The channel in which they vary most, and how much.
    channel: usize,
    spread: f32,
}

impl Group {
    fn of(colours: Vec<Weighted>) -> Group {
        let spreads = [0, 1, 2].map(|k| variance(&colours, k));
        let channel = (0..3).max_by(|&a, &b| spreads[a].total_cmp(&spreads[b])).unwrap_or(0);
        Group { channel, spread: spreads[channel], colours }
    }

    /// Two groups at the mean of the widest channel; neither is empty if there is any spread.
    fn split(self) -> [Group; 2] {
        let (mean, _) = moments(&self.colours, self.channel);
        let (low, high) = self.colours.into_iter().partition(|(colour, _)| f32::from(colour[self.channel]) < mean);
        [Group::of(low), Group::of(high)]
    }

    fn mean(&self) -> [u8; 3] {
        [0, 1, 2].map(|k| moments(&self.colours, k).0.round() as u8)
    }
}

/// Weighted mean of a channel, and total weight.
fn moments(colours: &[Weighted], channel: usize) -> (f32, f32) {
    let weight: f32 = colours.iter().map(|(_, weight)| weight).sum();
    let sum: f32 = colours.iter().map(|(colour, weight)| f32::from(colour[channel]) * weight).sum();
    (sum / weight.max(f32::MIN_POSITIVE), weight)
}

/// Weighted sum of squares about the mean of a channel.
fn variance(colours: &[Weighted], channel: usize) -> f32 {
    let (mean, _) = moments(colours, channel);
    colours.iter().map(|(colour, weight)| (f32::from(colour[channel]) - mean).powi(2) * weight).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn few_colours_are_kept() {
        let picture = RgbImage::from_fn(16, 16, |x, y| Rgb([x as u8 * 17, y as u8 * 17, 9]));
        let mut same = picture.clone();
        Palette::of(std::slice::from_ref(&picture)).apply(&mut same);
        assert_eq!(same, picture);
    }

    #[test]
    fn many_colours_come_close() {
        let picture = RgbImage::from_fn(128, 128, |x, y| Rgb([x as u8 * 2, y as u8 * 2, (x + y) as u8]));
        let mut mapped = picture.clone();
        Palette::of(std::slice::from_ref(&picture)).apply(&mut mapped);
        let mut colours: Vec<[u8; 3]> = mapped.pixels().map(|p| p.0).collect();
        colours.sort_unstable();
        colours.dedup();
        assert!((200..=256).contains(&colours.len()));
        let off = picture.as_raw().iter().zip(mapped.as_raw()).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(off.unwrap() < 24, "{off:?}");
    }
}
