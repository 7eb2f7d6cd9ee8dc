//! Whether the outlines move in ways that the family of motions does not have.
use super::{centred::CentredVector, innovations::InnovationSeries};
use crate::{
    tuning::family as tuning,
    update::{LEFT_OUT, Misfit},
};

/// What outlines do that their family of motions does not have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WrongFamily {
    /// They grow or shrink.
    Growth,
    /// They are stretched or sheared: an affine motion, or a camera that looks from aside, or pixels that are not square.
    Shear,
    /// They change as in perspective.
    Perspective,
    /// They are slanted by their own motion, as rows of a picture are that are read one after the other.
    RollingShutter,
    /// They change their shape in other ways: bending, a lens, edges that light or shadow moves.
    Shape,
}

/// Tests of what a family of motions leaves out, over frames.
#[derive(Debug, Clone, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct FamilyTests {
    series: InnovationSeries,
    /// Sum of squared displacements.
    squares: CentredVector,
    /// Means in their deviations, signs left out, as the last frame has left them.
    evidence: [f64; LEFT_OUT],
    /// Of what changes slowly, in deviations of what is white.
    slow: [f64; LEFT_OUT],
}

impl FamilyTests {
    /// Takes what a frame says.
    pub(crate) fn take(&mut self, misfit: &Misfit) {
        let long =
            |v: &nalgebra::SVector<f64, LEFT_OUT>| CentredVector::from_fn(|i, _| if i < LEFT_OUT { v[i] } else { 0.0 });
        let displacement = long(&misfit.displacement);
        self.series.take(&long(&misfit.standardised), LEFT_OUT);
        self.evidence = std::array::from_fn(|i| self.series.drift(i, LEFT_OUT).abs());
        self.slow = std::array::from_fn(|i| self.series.slow_part(i));
        self.squares += displacement.component_mul(&displacement);
    }

    /// What the outlines do beside their motion, beyond doubt, and the displacement that it makes of them, root mean square, normalised;
    /// `sigma` is the deviation of the noise.
    pub(crate) fn found(&self, sigma: f64) -> Option<(WrongFamily, f64)> {
        if self.series.frames() < tuning::FEWEST_FRAMES {
            return None;
        }
        let n = self.series.frames() as f64;
        let least = tuning::MATTERS * sigma + tuning::OF_NOISE * sigma * sigma;
        let mut clearest: Option<(usize, f64)> = None;
        let mut displacement = 0.0;
        for i in 0..LEFT_OUT {
            let evidence = self.evidence[i];
            let size = (self.squares[i] / n).sqrt();
            if evidence > tuning::SIGNIFICANT && size > least {
                displacement += size * size;
                if clearest.is_none_or(|(_, most)| evidence > most) {
                    clearest = Some((i, evidence));
                }
            }
        }
        if let Some((i, _)) = clearest {
            let family = match i {
                0 => WrongFamily::Growth,
                1 | 2 => WrongFamily::Shear,
                3 | 4 => WrongFamily::Perspective,
                _ => WrongFamily::RollingShutter,
            };
            return Some((family, displacement.sqrt()));
        }
        // Changes to and fro: of a mean square that noise does not have, or slow.
        let most = (1.0 + tuning::SIGNIFICANT * (2.0 / n).sqrt()).max(tuning::SHAPE_CHANGES);
        let changes =
            (0..LEFT_OUT).filter(|i| self.series.mean_square(*i) > most || self.slow[*i] > tuning::SIGNIFICANT);
        let size = changes.map(|i| (self.squares[i] / n).sqrt()).max_by(f64::total_cmp)?;
        (size > least).then_some((WrongFamily::Shape, size))
    }
}

#[cfg(feature = "serde")]
impl FamilyTests {
    /// Whether more can be taken; numbers that are not finite say nothing.
    pub(crate) fn is_sound(&self) -> bool {
        self.series.is_sound()
    }
}
