use nalgebra::{Point2, Vector2};
use rand::Rng;
use rand_distr::{Distribution as _, StandardNormal};

use super::body::Body;
use crate::raster::covered_shares;

/// How far a shadow lies from its body, in pixels, y upwards.
const SHADOW_SHIFT: [f64; 2] = [9.0, -6.0];

/// Standard deviation of the edge of a shadow beyond the blur of the picture, in pixels.
const SHADOW_BLUR: f64 = 2.5;

/// Most instants that an exposure is a mean of: a way of as many pixels, which crosses most pictures.
const MOST_INSTANTS: f64 = 512.0;

/// What a camera makes of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Rendering {
    /// Columns and rows.
    pub size: [usize; 2],
    /// Grey value of the ground where it is not shaded.
    pub ground: f64,
    /// Grey values that a body is lighter than the ground; negative: darker.
    pub contrast: f64,
    /// Standard deviation of the Gaussian that the camera blurs with, in pixels; the square of the pixel comes on top.
    pub blur: f64,
    /// How much darker the right edge of the picture is than the left one, in grey values, as a share of the contrast.
    pub shading: f64,
    /// Standard deviation of the noise of the sensor, in grey values.
    pub noise: f64,
    /// How much of the light a shadow takes away, 0 to 1; 0: there is none.
    pub shadow: f64,
    /// Width of a dark line around a body that has the grey value of the ground, in pixels; 0: bodies are filled.
    pub line: f64,
    /// How long the shutter is open, in seconds, half of it before the time of the picture: what moves is blurred. 0, an instant, to the time between two
    /// pictures.
    #[cfg_attr(feature = "serde", serde(default))]
    pub exposure: f64,
    /// The grey value of a light from 0 to 255 is `255 (light / 255)^(1 / gamma)`, 0.1 to 10: 1 is in proportion to light, of which blurred edges are a
    /// mean, and 2.2 as those of most cameras are.
    #[cfg_attr(feature = "serde", serde(default = "proportional"))]
    pub gamma: f64,
}

#[cfg(feature = "serde")]
fn proportional() -> f64 {
    1.0
}

impl Default for Rendering {
    /// 640 x 480 pixels, ground 60, bodies 140 lighter, blur of 1 pixel, no shading, noise of 3 grey values, no shadow, no line, an instant, grey
    /// values in proportion to the light.
    fn default() -> Self {
        let (size, ground, contrast) = ([640, 480], 60.0, 140.0);
        let (shadow, line, exposure, gamma) = (0.0, 0.0, 0.0, 1.0);
        Self { size, ground, contrast, blur: 1.0, shading: 0.0, noise: 3.0, shadow, line, exposure, gamma }
    }
}

impl Rendering {
    /// The grey values of a picture at a time, row by row from the top.
    pub(super) fn picture(&self, bodies: &[Body], time: f64, noise: &mut impl Rng) -> Vec<u8> {
        let mut light = self.exposed(bodies, time);
        let width = self.size[0];
        let step = self.shading * self.contrast.abs() / width as f64;
        for row in light.chunks_exact_mut(width) {
            let shaded = |column: usize, light: f64| self.light_of(self.grey_of(light) - step * (column as f64 + 0.5));
            row.iter_mut().enumerate().for_each(|(column, light)| *light = shaded(column, *light));
        }
        blur(&mut light, width, self.blur);
        let noisy = |light: f64| {
            let error: f64 = StandardNormal.sample(noise);
            (self.grey_of(light) + self.noise * error).round().clamp(0.0, 255.0) as u8
        };
        light.into_iter().map(noisy).collect()
    }

    /// The grey value of a light; both are 0 to 255 in a picture.
    fn grey_of(&self, light: f64) -> f64 {
        if self.gamma == 1.0 { light } else { 255.0 * (light.max(0.0) / 255.0).powf(self.gamma.recip()) }
    }

    /// The light of a grey value.
    fn light_of(&self, grey: f64) -> f64 {
        if self.gamma == 1.0 { grey } else { 255.0 * (grey.max(0.0) / 255.0).powf(self.gamma) }
    }

    /// The mean of the light while the shutter is open.
    fn exposed(&self, bodies: &[Body], time: f64) -> Vec<f64> {
        let count = instants(bodies, time, self.exposure);
        let at = |k: usize| self.light(bodies, time + ((k as f64 + 0.5) / count as f64 - 0.5) * self.exposure);
        let mut sum = at(0);
        for k in 1..count {
            sum.iter_mut().zip(at(k)).for_each(|(sum, light)| *sum += light);
        }
        if count > 1 {
            sum.iter_mut().for_each(|sum| *sum /= count as f64);
        }
        sum
    }

    /// The light at a time.
    fn light(&self, bodies: &[Body], time: f64) -> Vec<f64> {
        let [width, height] = self.size;
        let rows = height as f64;
        let cover = |contours: &[Vec<Point2<f64>>]| covered_shares(contours.iter().map(Vec::as_slice), self.size);
        let mut all = vec![self.light_of(self.ground); width * height];
        if self.shadow > 0.0 {
            let mut shades = vec![1.0; width * height];
            for body in bodies {
                let shade = cover(&body.in_picture(time, Vector2::from(SHADOW_SHIFT), rows));
                shades.iter_mut().zip(shade).for_each(|(shade, share)| *shade *= 1.0 - self.shadow * share);
            }
            blur(&mut shades, width, SHADOW_BLUR);
            all.iter_mut().zip(shades).for_each(|(light, shade)| *light *= shade);
        }
        let value = self.light_of(self.ground + self.contrast);
        for body in bodies {
            let contours = body.in_picture(time, Vector2::zeros(), rows);
            let mut share = cover(&contours);
            if self.line > 0.0 {
                let within: Vec<_> = contours.iter().map(|contour| inset(contour, self.line)).collect();
                share.iter_mut().zip(cover(&within)).for_each(|(share, within)| *share -= within);
            }
            all.iter_mut().zip(share).for_each(|(light, share)| *light += share * (value - *light));
        }
        all
    }
}

/// How many instants stand for the time that a shutter is open: no point goes farther than a pixel from one to the next, unless there are as many as there
/// may be.
fn instants(bodies: &[Body], time: f64, exposure: f64) -> usize {
    let way = |body: &Body| exposure * body.fastest([time - 0.5 * exposure, time + 0.5 * exposure]);
    bodies.iter().map(way).fold(1.0, f64::max).ceil().min(MOST_INSTANTS) as usize
}

/// A contour moved inwards by a distance; that of a hole, which runs the other way round, outwards.
fn inset(contour: &[Point2<f64>], distance: f64) -> Vec<Point2<f64>> {
    let count = contour.len();
    let direction = |k: usize| (contour[(k + 1) % count] - contour[k % count]).normalize();
    (0..count)
        .map(|k| {
            let (before, after) = (direction(k + count - 1), direction(k));
            // Contours run clockwise in the picture's own coordinates, whose rows run downwards.
            let normal = |d: Vector2<f64>| Vector2::new(d.y, -d.x);
            let sum = normal(before) + normal(after);
            contour[k] + sum * (2.0 * distance / sum.norm_squared().max(0.5))
        })
        .collect()
}

/// Blurs rows and columns with a Gaussian, cut at 4 standard deviations; beyond the picture its edge goes on.
fn blur(grey: &mut [f64], width: usize, sigma: f64) {
    if sigma <= 0.0 {
        return;
    }
    let reach = (4.0 * sigma).ceil() as isize;
    let weights: Vec<f64> = (-reach..=reach).map(|d| (-0.5 * (d as f64 / sigma).powi(2)).exp()).collect();
    let total: f64 = weights.iter().sum();
    let height = grey.len() / width;
    let within = |place: isize, count: usize| place.clamp(0, count as isize - 1) as usize;
    let mut rows = vec![0.0; grey.len()];
    for (row, from) in rows.chunks_exact_mut(width).zip(grey.chunks_exact(width)) {
        for (column, value) in row.iter_mut().enumerate() {
            let taps = (-reach..=reach).zip(&weights);
            *value = taps.map(|(d, weight)| weight * from[within(column as isize + d, width)]).sum::<f64>() / total;
        }
    }
    for (row, into) in grey.chunks_exact_mut(width).enumerate() {
        into.fill(0.0);
        for (d, weight) in (-reach..=reach).zip(&weights) {
            let from = within(row as isize + d, height) * width;
            into.iter_mut().zip(&rows[from..from + width]).for_each(|(value, other)| *value += weight / total * other);
        }
    }
}
