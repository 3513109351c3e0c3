//! The 256 colours of an animation: median cut [Heckbert 1982], each cut where the colours vary most.

use std::collections::HashMap;

use super::image::Image;

/// Colours that a GIF can hold.
const SIZE: usize = 256;

/// Colours that represent all others.
pub struct Palette {
    /// At most 256 colours.
    pub colours: Vec<[u8; 3]>,
}

type Weighted = ([u8; 3], f32);

impl Palette {
    /// Chooses the colours that represent these pictures.
    pub fn of(pictures: &[Image]) -> Palette {
        let mut counts: HashMap<[u8; 3], f32> = HashMap::new();
        for &pixel in pictures.iter().flat_map(|picture| &picture.pixels) {
            *counts.entry(pixel).or_default() += 1.0;
        }
        // Sorted, so that equal pictures give equal palettes.
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

    /// Index of the nearest colour for each pixel.
    pub fn indices(&self, picture: &Image) -> Vec<u8> {
        let mut known = HashMap::new();
        picture.pixels.iter().map(|&pixel| *known.entry(pixel).or_insert_with(|| self.nearest(pixel))).collect()
    }

    fn nearest(&self, colour: [u8; 3]) -> u8 {
        let distance = |c: &[u8; 3]| (0..3).map(|k| u32::from(c[k].abs_diff(colour[k])).pow(2)).sum::<u32>();
        (0..=u8::MAX).zip(&self.colours).min_by_key(|(_, c)| distance(c)).map_or(0, |(index, _)| index)
    }
}

/// A group of colours that may become one colour of the palette.
struct Group {
    colours: Vec<Weighted>,
    /// The channel in which the colours vary most, and its variation.
    channel: usize,
    spread: f32,
}

impl Group {
    fn of(colours: Vec<Weighted>) -> Group {
        let spreads = [0, 1, 2].map(|k| variance(&colours, k));
        let channel = (0..3).max_by(|&a, &b| spreads[a].total_cmp(&spreads[b])).unwrap_or(0);
        Group { channel, spread: spreads[channel], colours }
    }

    /// Splits the group at the mean of the channel that varies most. Neither half is empty if there is any spread.
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

    fn picture(side: usize, colour: impl Fn(usize, usize) -> [u8; 3]) -> Image {
        Image { size: [side; 2], pixels: (0..side * side).map(|k| colour(k % side, k / side)).collect() }
    }

    fn mapped(picture: &Image) -> Vec<[u8; 3]> {
        let palette = Palette::of(std::slice::from_ref(picture));
        palette.indices(picture).iter().map(|&index| palette.colours[usize::from(index)]).collect()
    }

    #[test]
    fn few_colours_are_kept() {
        let picture = picture(16, |x, y| [x as u8 * 17, y as u8 * 17, 9]);
        assert_eq!(mapped(&picture), picture.pixels);
    }

    #[test]
    fn many_colours_come_close() {
        let picture = picture(128, |x, y| [x as u8 * 2, y as u8 * 2, (x + y) as u8]);
        let mapped = mapped(&picture);
        let mut colours = mapped.clone();
        colours.sort_unstable();
        colours.dedup();
        assert!((200..=256).contains(&colours.len()));
        let off = picture.pixels.as_flattened().iter().zip(mapped.as_flattened()).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(off.unwrap() < 24, "{off:?}");
    }
}
