use image::Rgb;

use super::canvas::Canvas;

/// Columns and rows of a letter.
const SIZE: [usize; 2] = [5, 7];

/// Heights of a letter in the height of a picture.
const LINES: u32 = 24;

/// The letters of the words that are written, row by row, the leftmost column in the highest of five bits.
const LETTERS: [(char, [u8; 7]); 9] = [
    ('b', [0x10, 0x10, 0x1e, 0x11, 0x11, 0x11, 0x1e]),
    ('c', [0x00, 0x00, 0x0e, 0x11, 0x10, 0x11, 0x0e]),
    ('d', [0x01, 0x01, 0x0f, 0x11, 0x11, 0x11, 0x0f]),
    ('e', [0x00, 0x00, 0x0e, 0x11, 0x1f, 0x10, 0x0e]),
    ('j', [0x02, 0x00, 0x06, 0x02, 0x02, 0x12, 0x0c]),
    ('n', [0x00, 0x00, 0x1e, 0x11, 0x11, 0x11, 0x11]),
    ('o', [0x00, 0x00, 0x0e, 0x11, 0x11, 0x11, 0x0e]),
    ('r', [0x00, 0x00, 0x16, 0x19, 0x10, 0x10, 0x10]),
    ('t', [0x08, 0x08, 0x1e, 0x08, 0x08, 0x09, 0x06]),
];

/// Writes a word above a position, or as near to it as the picture allows. What is no letter of [`LETTERS`] is a space.
pub(super) fn write_word(canvas: &mut Canvas, [column, row]: [f64; 2], word: &str, colour: Rgb<u8>) {
    let (width, height) = canvas.size();
    // Whole pixels to a dot, so that letters stay sharp.
    let dot = (height / (LINES * SIZE[1] as u32)).max(1);
    let length = word.chars().count() as u32 * (SIZE[0] as u32 + 1) * dot;
    let within = |wanted: f64, size: u32, needed: u32| wanted.clamp(0.0, f64::from(size.saturating_sub(needed))) as u32;
    let left = within(column, width, length) + dot;
    let top = within(row - f64::from((SIZE[1] as u32 + 3) * dot), height, (SIZE[1] as u32 + 2) * dot) + dot;
    for (index, letter) in word.chars().enumerate() {
        let Some((_, rows)) = LETTERS.iter().find(|(known, _)| *known == letter) else { continue };
        for (y, bits) in rows.iter().enumerate() {
            for x in (0..SIZE[0]).filter(|x| bits & (0x10 >> x) != 0) {
                let x = left + (index * (SIZE[0] + 1) + x) as u32 * dot;
                canvas.fill([x, top + y as u32 * dot], dot, colour);
            }
        }
    }
}
