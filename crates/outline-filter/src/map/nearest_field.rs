//! The nearest place on the map for any point of the plane, in constant time.
use nalgebra::{Point2, Vector2};

use crate::tuning::map::FIELD_PIXELS;

const NONE: u32 = u32::MAX;

/// A picture of the body frame in which every pixel holds the number of a place near it.
#[derive(Debug, Clone, Default)]
pub(crate) struct NearestField {
    origin: Point2<f64>,
    per_length: f64,
    width: usize,
    height: usize,
    nearest: Vec<u32>,
}

impl NearestField {
    /// Fills the picture: places seed their pixels, then the nearest is handed on from neighbour to neighbour.
    pub(crate) fn build(&mut self, places: &[Point2<f64>], spacing: f64) {
        let Some(first) = places.first() else {
            self.nearest.clear();
            return;
        };
        let (mut low, mut high) = (*first, *first);
        for p in places {
            low = Point2::from(low.coords.inf(&p.coords));
            high = Point2::from(high.coords.sup(&p.coords));
        }
        let extent = (high - low).amax();
        let margin = 0.1 * extent + spacing;
        let pixel = ((extent + 2.0 * margin) / FIELD_PIXELS).max(0.5 * spacing);
        self.origin = low - Vector2::repeat(margin);
        self.per_length = 1.0 / pixel;
        let pixels = |length: f64| ((length + 2.0 * margin) / pixel).ceil() as usize + 1;
        (self.width, self.height) = (pixels(high.x - low.x), pixels(high.y - low.y));
        self.nearest.clear();
        self.nearest.resize(self.width * self.height, NONE);
        for (number, p) in places.iter().enumerate() {
            let pixel = self.pixel_of(p);
            self.offer(pixel, number as u32, places);
        }
        for _ in 0..2 {
            for index in 0..self.nearest.len() {
                self.take_from_neighbours(index, places, [(-1, 0), (-1, -1), (0, -1), (1, -1)]);
            }
            for index in (0..self.nearest.len()).rev() {
                self.take_from_neighbours(index, places, [(1, 0), (1, 1), (0, 1), (-1, 1)]);
            }
        }
    }

    /// Number of a place near the point, if there is any place.
    pub(crate) fn lookup(&self, p: &Point2<f64>) -> Option<usize> {
        if self.nearest.is_empty() {
            return None;
        }
        Some(self.nearest[self.pixel_of(p)] as usize)
    }

    fn pixel_of(&self, p: &Point2<f64>) -> usize {
        // Pixels of the border stand for what lies beyond; NaN becomes 0.
        let within =
            |length: f64, count: usize| (length * self.per_length).clamp(0.0, (count - 1) as f64) as u32 as usize;
        within(p.y - self.origin.y, self.height) * self.width + within(p.x - self.origin.x, self.width)
    }

    fn centre(&self, index: usize) -> Point2<f64> {
        let (row, column) = (index / self.width, index % self.width);
        self.origin + Vector2::new(column as f64 + 0.5, row as f64 + 0.5) / self.per_length
    }

    fn offer(&mut self, pixel: usize, number: u32, places: &[Point2<f64>]) {
        let centre = self.centre(pixel);
        let distance = |n: u32| (places[n as usize] - centre).norm_squared();
        let now = self.nearest[pixel];
        if now == NONE || distance(number) < distance(now) {
            self.nearest[pixel] = number;
        }
    }

    fn take_from_neighbours(&mut self, index: usize, places: &[Point2<f64>], offsets: [(isize, isize); 4]) {
        let (row, column) = ((index / self.width) as isize, (index % self.width) as isize);
        for (dx, dy) in offsets {
            let (x, y) = (column + dx, row + dy);
            if x < 0 || y < 0 || x >= self.width as isize || y >= self.height as isize {
                continue;
            }
            let number = self.nearest[y as usize * self.width + x as usize];
            if number != NONE && number != self.nearest[index] {
                self.offer(index, number, places);
            }
        }
    }
}
