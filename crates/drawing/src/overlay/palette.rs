//! The colours of an animation: those that drawings have.
use std::collections::HashMap;

use image::Rgb;

use super::colours::COLOURS;

/// What shows the picture before.
pub(super) const TRANSPARENT: u8 = 0;

/// Grey values from level to level.
const GREY_STEP: u8 = 3;

/// Levels of grey of pictures that drawings are on, which are darker than white.
const GREYS: u8 = 64;

/// Levels of grey that colours are mixed with, in how many quarters of them.
const MIXED_GREYS: u8 = 9;
const QUARTERS: u16 = 4;

/// One set of colours for all pictures of an animation: grey values, and the colours of drawings, by themselves and mixed with some of
/// these. Nothing is dithered.
pub(super) struct Palette {
    colours: Vec<Rgb<u8>>,
    /// Numbers of colours that were looked for.
    found: HashMap<Rgb<u8>, u8>,
}

impl Palette {
    pub(super) fn new() -> Self {
        let mut colours = vec![Rgb([0; 3])];
        colours.extend((0..GREYS).map(|level| Rgb([level * GREY_STEP; 3])));
        for colour in COLOURS {
            colours.push(colour);
            let greys =
                (0..MIXED_GREYS).map(|k| u16::from(k) * u16::from(GREYS * GREY_STEP - 1) / u16::from(MIXED_GREYS - 1));
            for (grey, quarters) in greys.flat_map(|grey| (1..QUARTERS).map(move |quarters| (grey, quarters))) {
                let mixed = |value: u8| ((u16::from(value) * quarters + grey * (QUARTERS - quarters)) / QUARTERS) as u8;
                colours.push(Rgb(colour.0.map(mixed)));
            }
        }
        Self { colours, found: HashMap::new() }
    }

    /// Red, green and blue of every colour.
    pub(super) fn bytes(&self) -> Vec<u8> {
        self.colours.iter().flat_map(|colour| colour.0).collect()
    }

    /// Number of the colour nearest to one.
    pub(super) fn nearest(&mut self, colour: Rgb<u8>) -> u8 {
        let Rgb([red, green, blue]) = colour;
        if red == green && green == blue {
            return 1 + ((red + GREY_STEP / 2) / GREY_STEP).min(GREYS - 1);
        }
        let colours = &self.colours;
        *self.found.entry(colour).or_insert_with(|| {
            let distance = |other: &Rgb<u8>| -> u32 {
                colour.0.iter().zip(other.0).map(|(a, b)| u32::from(a.abs_diff(b)).pow(2)).sum()
            };
            let nearest = (1..colours.len()).min_by_key(|number| distance(&colours[*number]));
            nearest.map_or(1, |number| number as u8)
        })
    }

    /// Levels between two colours, if both are grey.
    pub(super) fn levels_between(a: u8, b: u8) -> Option<u8> {
        let is_grey = |number: u8| (1..=GREYS).contains(&number);
        (is_grey(a) && is_grey(b)).then(|| a.abs_diff(b))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn greys_and_the_colours_of_drawings_keep_what_they_are() {
        let mut palette = Palette::new();
        assert!(palette.colours.len() <= 256, "{}", palette.colours.len());
        for colour in COLOURS.into_iter().chain([0, 30, 189].map(|grey| Rgb([grey; 3]))) {
            let number = palette.nearest(colour);
            assert!(number != TRANSPARENT && palette.colours[usize::from(number)] == colour, "{colour:?}");
        }
        assert!((0..=191_u8).all(|grey| {
            let number = usize::from(palette.nearest(Rgb([grey; 3])));
            palette.colours[number].0[0].abs_diff(grey) <= 2
        }));
    }
}
