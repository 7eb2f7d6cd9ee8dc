//! How grey values stand for light, by what the edges of bodies that move say of their sizes.
use std::panic::resume_unwind;
use std::thread;

use super::trial::{OBJECTS, Trial};
use super::tuning::light as tuning;
use super::{PictureSample, Tracing};
use crate::affine_moment_invariants::SecondMoments;
use crate::channel::Channel;
use crate::edges::median;
use crate::picture_outlines::PictureSettings;
use crate::trace::TracedOutline;
use crate::trace_settings::{Contours, Edges, TraceSettings};
use crate::transfer::Transfer;

/// What no turn and no way of a body changes, as logarithms of lengths: the root of its area, its longest and its shortest radius of gyration.
type Sizes = [f64; 3];

/// What was seen of one body, or of several that are alike.
struct Body {
    /// The root of its area where it was seen first, in pixels.
    length: f64,
    /// Its sizes in the pictures, by the grey values as they are and by the light of sRGB.
    sizes: Vec<[Sizes; 2]>,
}

/// What grey values stand for, where the pictures tell: blurred by its motion, a body seems to grow and to change its shape with its speed where they
/// are taken for something else. Where they do not tell, they are taken as they are.
pub(super) fn transfer_of(sample: &PictureSample, base: &PictureSettings, tracing: &Tracing) -> Transfer {
    if sample.is_two_valued() || tracing.way.is_ring() || tracing.channel == Channel::Saturation {
        return Transfer::Linear;
    }
    let (settings, views) = Trial::whole(sample, base, tracing.channel).views(tracing);
    let seen_by = |transfer: Transfer| {
        let (edges, contours) = (Edges::Refined, Contours::Boundary);
        let trace = TraceSettings { edges, transfer, contours, ..settings.trace };
        let settings = PictureSettings { trace, ..settings.clone() };
        views.iter().map(|view| view.traced(&settings, OBJECTS).unwrap_or_default()).collect::<Vec<_>>()
    };
    let (linear, srgb) = thread::scope(|scope| {
        let srgb = scope.spawn(|| seen_by(Transfer::Srgb));
        (seen_by(Transfer::Linear), srgb.join().unwrap_or_else(|panic| resume_unwind(panic)))
    });
    // One after the other they are the same objects, unless one of them has no outline.
    let in_pictures = linear.iter().zip(&srgb).filter(|(linear, srgb)| linear.len() == srgb.len());
    let mut bodies: Vec<Body> = Vec::new();
    for (of_linear, of_srgb) in in_pictures.flat_map(|(linear, srgb)| linear.iter().zip(srgb)) {
        if of_linear.touches_border {
            continue;
        }
        let sizes = [of_linear, of_srgb].map(sizes_of);
        let is_same = |body: &&mut Body| {
            let [first, _] = body.sizes[0];
            first.iter().zip(&sizes[0]).all(|(a, b)| (a - b).abs() < tuning::ALIKE)
        };
        match bodies.iter_mut().find(is_same) {
            Some(body) => body.sizes.push(sizes),
            None => bodies.push(Body { length: of_linear.area.sqrt(), sizes: vec![sizes] }),
        }
    }
    bodies.retain(|body| body.sizes.len() >= tuning::FEWEST);
    let [as_they_are, as_light] =
        [0, 1].map(|of| bodies.iter().flat_map(|body| body.deviations(of)).collect::<Vec<f64>>());
    let mut ordered = as_they_are.clone();
    ordered.sort_by(f64::total_cmp);
    let Some(most) = ordered.get(ordered.len() * 9 / 10) else { return Transfer::Linear };
    let spread = |deviations: &[f64]| {
        let squares = deviations.iter().map(|deviation| deviation.min(*most).powi(2));
        (squares.sum::<f64>() / deviations.len() as f64).sqrt()
    };
    let (of_linear, of_light) = (spread(&as_they_are), spread(&as_light));
    let tells = of_linear > tuning::LEAST_SPREAD && of_light < tuning::LESS * of_linear;
    if tells { Transfer::Srgb } else { Transfer::Linear }
}

impl Body {
    /// How far each of its sizes is from its median, by one of the transfer functions, in pixels.
    fn deviations(&self, of: usize) -> impl Iterator<Item = f64> {
        (0..3).flat_map(move |k| {
            let values = || self.sizes.iter().map(move |sizes| sizes[of][k]);
            let middle = median(values()).unwrap_or_default();
            values().map(move |value| self.length * (value - middle).abs())
        })
    }
}

fn sizes_of(traced: &TracedOutline) -> Sizes {
    let boundary = traced.outline.pieces().next().map_or(&[][..], |piece| piece.points);
    let [longest, shortest] = SecondMoments::of(&boundary.iter().copied()).principal();
    [traced.area, longest, shortest].map(|square| 0.5 * square.ln())
}
