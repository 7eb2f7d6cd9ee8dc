//! How grey values stand for light, by what edges say: of the sizes of bodies that move, and by whether edges are alike on both sides.
use std::panic::resume_unwind;
use std::thread;

use super::trial::{OBJECTS, Trial};
use super::tuning::light as tuning;
use super::{PictureSample, Tracing};
use crate::edges::median;
use crate::identity::affine_moment_invariants::SecondMoments;
use crate::picture_file::channel::Channel;
use crate::picture_outlines::PictureSettings;
use crate::tracing::settings::{Contours, Edges, TraceSettings};
use crate::tracing::trace::TracedOutline;
use crate::tracing::transfer::Transfer;

/// Logarithms of lengths that stay the same however a body turns and travels: the root of its area, its longest and its shortest radius of gyration.
type Sizes = [f64; 3];

/// What was seen of one body, or of several that are alike.
struct Body {
    /// The pictures that it was seen in, in order, with its sizes by the grey values as they are and by the light of sRGB.
    seen: Vec<(usize, [Sizes; 2])>,
}

/// What the sizes of bodies say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum OfSizes {
    /// They change less by the light of sRGB.
    Steadier,
    /// They change more by it.
    LessSteady,
    /// They hardly change, or by as much.
    Untold,
}

/// What the edges of the first object are like, in the median picture.
struct OfEdges {
    /// Pictures with such edges.
    pictures: usize,
    /// How far they may lie off together, in pixels: how much of one-sided light they show, for the most part.
    systematic: f64,
    /// Their width, in pixels.
    blur: f64,
}

/// What grey values stand for, where the pictures tell it. A body that its motion blurs seems to change its size with its speed where they are taken
/// for something else; and its edges, which are as wide in the light on their darker side as on their lighter one, seem to have more light on one.
/// The sizes are what counts, and where they do not tell it, wide edges do. Else grey values are taken as they are.
pub(super) fn transfer_of(sample: &PictureSample, base: &PictureSettings, tracing: &Tracing) -> Transfer {
    let has_light = !sample.is_two_valued() && !tracing.way.is_ring() && tracing.channel != Channel::Saturation;
    if !has_light || base.trace.transfer != Transfer::Linear {
        return base.trace.transfer;
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
    let [Some(of_linear), Some(of_srgb)] = [&linear, &srgb].map(|seen| OfEdges::of(seen)) else {
        return Transfer::Linear;
    };
    let are_seen = of_srgb.pictures as f64 >= tuning::SEEN_AS_WELL * of_linear.pictures as f64;
    let is_told = match sizes_told(&linear, &srgb) {
        OfSizes::Steadier => true,
        OfSizes::Untold => of_srgb.are_more_even_than(&of_linear),
        OfSizes::LessSteady => false,
    };
    if are_seen && is_told { Transfer::Srgb } else { Transfer::Linear }
}

/// What sizes say that both transfer functions give, picture for picture.
fn sizes_told(linear: &[Vec<TracedOutline>], srgb: &[Vec<TracedOutline>]) -> OfSizes {
    let mut bodies: Vec<Body> = Vec::new();
    for (picture, (linear, srgb)) in linear.iter().zip(srgb).enumerate() {
        for (of_linear, of_srgb) in linear.iter().zip(srgb) {
            // One after the other they are the same objects, unless one of them has no outline.
            if of_linear.pixel_count == of_srgb.pixel_count && !of_linear.touches_border {
                let sizes = [of_linear, of_srgb].map(sizes_of);
                match bodies.iter_mut().find(|body| body.is_like(&sizes)) {
                    Some(body) => body.seen.push((picture, sizes)),
                    None => bodies.push(Body { seen: vec![(picture, sizes)] }),
                }
            }
        }
    }
    bodies.retain(|body| body.pictures() >= tuning::FEWEST);
    let [as_they_are, as_light] =
        [0, 1].map(|of| bodies.iter().flat_map(|body| body.deviations(of)).collect::<Vec<f64>>());
    let mut ordered = as_they_are.clone();
    ordered.sort_by(f64::total_cmp);
    let Some(most) = ordered.get((tuning::USUAL * ordered.len() as f64) as usize) else { return OfSizes::Untold };
    let spread = |deviations: &[f64]| {
        let squares = deviations.iter().map(|deviation| deviation.min(*most).powi(2));
        (squares.sum::<f64>() / deviations.len() as f64).sqrt()
    };
    let (of_linear, of_light) = (spread(&as_they_are), spread(&as_light));
    match of_light / of_linear {
        _ if of_linear <= tuning::LEAST_SPREAD => OfSizes::Untold,
        ratio if ratio < tuning::LESS => OfSizes::Steadier,
        ratio if ratio > tuning::MORE => OfSizes::LessSteady,
        _ => OfSizes::Untold,
    }
}

impl OfEdges {
    /// Those of the first object of each picture; `None` where none has edges.
    fn of(seen: &[Vec<TracedOutline>]) -> Option<Self> {
        let edges = || seen.iter().filter_map(|objects| objects.first()?.edges.as_ref());
        let pictures = edges().count();
        let systematic = median(edges().map(|edges| edges.systematic))?;
        Some(Self { pictures, systematic, blur: median(edges().map(|edges| edges.blur))? })
    }

    /// Whether wide edges that are one-sided by another transfer function are far less so by this one.
    fn are_more_even_than(&self, other: &Self) -> bool {
        other.blur >= tuning::WIDE
            && other.systematic > tuning::LEAST_SYSTEMATIC
            && self.systematic < tuning::LESS_SYSTEMATIC * other.systematic
    }
}

impl Body {
    /// Number of the pictures that it was seen in.
    fn pictures(&self) -> usize {
        self.seen.chunk_by(|(one, _), (next, _)| one == next).count()
    }

    /// Whether sizes may be those of this body: by what the grey values stand for they hardly change.
    fn is_like(&self, sizes: &[Sizes; 2]) -> bool {
        let is_alike = |(a, b): (&Sizes, &Sizes)| a.iter().zip(b).all(|(a, b)| (a - b).abs() < tuning::ALIKE);
        self.seen.first().is_some_and(|(_, first)| first.iter().zip(sizes).any(is_alike))
    }

    /// How far each of its sizes is from its median, by one of the transfer functions, in pixels where it has the size of the first picture.
    fn deviations(&self, of: usize) -> impl Iterator<Item = f64> {
        let length = self.seen.first().map_or(0.0, |(_, [[root_of_area, ..], _])| root_of_area.exp());
        (0..3).flat_map(move |k| {
            let values = || self.seen.iter().map(move |(_, sizes)| sizes[of][k]);
            let middle = median(values()).unwrap_or_default();
            values().map(move |value| length * (value - middle).abs())
        })
    }
}

fn sizes_of(traced: &TracedOutline) -> Sizes {
    let boundary = traced.outline.pieces().next().map_or(&[][..], |piece| piece.points);
    let [longest, shortest] = SecondMoments::of(&boundary.iter().copied()).principal();
    [traced.area, longest, shortest].map(|square| 0.5 * square.ln())
}
