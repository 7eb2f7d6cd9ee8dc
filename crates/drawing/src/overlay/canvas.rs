use image::{GrayImage, Rgb, RgbImage};

use super::colours::OUTLINE;

/// A picture to draw on. Positions are in columns and rows, pixel centres at half numbers.
#[derive(Debug)]
pub(crate) struct Canvas {
    picture: RgbImage,
}

impl Canvas {
    /// The picture, a little darker, so that lines stand out on light ones.
    pub(crate) fn of(picture: &GrayImage) -> Self {
        let dimmed = |value: u8| (u16::from(value) * 3 / 4) as u8;
        let picture = RgbImage::from_fn(picture.width(), picture.height(), |column, row| {
            Rgb([dimmed(picture.get_pixel(column, row).0[0]); 3])
        });
        Self { picture }
    }

    pub(crate) fn into_picture(self) -> RgbImage {
        self.picture
    }

    /// Columns and rows.
    pub(crate) fn size(&self) -> (u32, u32) {
        self.picture.dimensions()
    }

    /// Fills a square of pixels from its upper left one, as far as the picture goes.
    pub(crate) fn fill(&mut self, [column, row]: [u32; 2], size: u32, colour: Rgb<u8>) {
        for (dx, dy) in (0..size).flat_map(|dy| (0..size).map(move |dx| (dx, dy))) {
            if let Some(pixel) = self.picture.get_pixel_mut_checked(column + dx, row + dy) {
                *pixel = colour;
            }
        }
    }

    /// Mixes a colour into the pixels around a position, in proportion to what they cover of it.
    fn blend(&mut self, [column, row]: [f64; 2], colour: Rgb<u8>) {
        let (x, y) = (column - 0.5, row - 0.5);
        if !(x.is_finite() && y.is_finite() && x.abs() < 1e6 && y.abs() < 1e6) {
            return;
        }
        let (left, top) = (x.floor(), y.floor());
        for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let (px, py) = (left + dx, top + dy);
            let weight = (1.0 - (x - px).abs()) * (1.0 - (y - py).abs());
            let inside = px >= 0.0 && py >= 0.0;
            let Some(pixel) = inside.then(|| self.picture.get_pixel_mut_checked(px as u32, py as u32)).flatten() else {
                continue;
            };
            for (value, new) in pixel.0.iter_mut().zip(colour.0) {
                *value = (f64::from(*value) + weight * (f64::from(new) - f64::from(*value))).round() as u8;
            }
        }
    }

    /// A line between two positions; what is beyond the picture is left out.
    pub(crate) fn line(&mut self, from: [f64; 2], to: [f64; 2], colour: Rgb<u8>) {
        let Some((from, to)) = self.clipped(from, to) else { return };
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let steps = (2.0 * dx.abs().max(dy.abs())).ceil().max(1.0);
        for step in 0..=steps as u64 {
            let share = step as f64 / steps;
            self.blend([from[0] + share * dx, from[1] + share * dy], colour);
        }
    }

    /// The part of a line within the picture (Liang and Barsky, A new concept and method for line clipping, 1984).
    fn clipped(&self, from: [f64; 2], to: [f64; 2]) -> Option<([f64; 2], [f64; 2])> {
        let limits = [f64::from(self.picture.width()), f64::from(self.picture.height())];
        let (mut first, mut last) = (0.0_f64, 1.0_f64);
        for axis in 0..2 {
            let change = to[axis] - from[axis];
            if !change.is_finite() {
                return None;
            }
            for (edge, inwards) in [(0.0, 1.0), (limits[axis], -1.0)] {
                let (distance, speed) = (inwards * (from[axis] - edge), inwards * change);
                if speed == 0.0 && distance < 0.0 {
                    return None;
                }
                match speed {
                    s if s > 0.0 => first = first.max(-distance / s),
                    s if s < 0.0 => last = last.min(-distance / s),
                    _ => {}
                }
            }
        }
        let at = |share: f64| [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])];
        (first <= last).then(|| (at(first), at(last)))
    }

    pub(crate) fn polyline(&mut self, mut points: impl Iterator<Item = [f64; 2]>, colour: Rgb<u8>) {
        let Some(mut last) = points.next() else { return };
        for point in points {
            self.line(last, point, colour);
            last = point;
        }
    }

    /// A line along an outline.
    pub(crate) fn outline(&mut self, points: impl Iterator<Item = [f64; 2]>) {
        self.polyline(points, OUTLINE);
    }

    /// A cross about a position.
    pub(crate) fn cross(&mut self, [x, y]: [f64; 2], size: f64, colour: Rgb<u8>) {
        for offset in [-0.5, 0.5] {
            self.line([x - size + offset, y - size], [x + size + offset, y + size], colour);
            self.line([x - size + offset, y + size], [x + size + offset, y - size], colour);
        }
    }

    /// An arrow; a dot where it is shorter than a pixel.
    pub(crate) fn arrow(&mut self, from: [f64; 2], to: [f64; 2], colour: Rgb<u8>) {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let length = dx.hypot(dy);
        self.line(from, to, colour);
        if length >= 3.0 {
            let head = 4.0_f64.min(0.4 * length) / length;
            for side in [-0.6, 0.6] {
                self.line(to, [to[0] - head * (dx - side * dy), to[1] - head * (dy + side * dx)], colour);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_far_beyond_the_picture_are_cut_off_at_its_edge() {
        let mut canvas = Canvas::of(&GrayImage::new(10, 8));
        canvas.line([-1e300, 4.0], [1e300, 4.0], Rgb([255, 0, 0]));
        canvas.line([-1e9, 2.5], [1e9, 2.5], Rgb([255, 0, 0]));
        canvas.line([f64::NAN, 4.0], [5.0, f64::INFINITY], Rgb([255, 0, 0]));
        canvas.line([20.0, -5.0], [20.0, 50.0], Rgb([0, 255, 0]));
        let picture = canvas.into_picture();
        assert_eq!(picture.get_pixel(4, 2), &Rgb([255, 0, 0]));
        assert!(picture.pixels().all(|pixel| pixel.0[1] == 0));
    }
}
