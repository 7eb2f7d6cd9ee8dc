//! Which of several ways is taken that do equally well.
use super::evidence::TracingEvidence;
use super::trial::Trial;
use super::tuning::ties as tuning;
use super::{PictureSample, worth};
use crate::picture_file::channel::Channel;
use crate::picture_outlines::PictureSettings;

/// Puts a way in front of the best where it does as well and its contours are known better: the score tells that both show one body, and not how well
/// they show it. The candidates are sorted.
pub(super) fn settle_ties(sample: &PictureSample, base: &PictureSettings, candidates: &mut [TracingEvidence]) {
    let Some(best) = candidates.first() else { return };
    if sample.is_two_valued() {
        return;
    }
    let shows_the_same = |other: &TracingEvidence| {
        let is_as_large = (other.area_share / best.area_share - 1.0).abs() < tuning::AREA;
        is_as_large && other.objects == best.objects && other.rests == best.rests
    };
    let ties = candidates.iter().take_while(|other| worth(other) >= (1.0 - tuning::TIE) * worth(best)).count();
    if ties < 2 {
        return;
    }
    let mut trials: Vec<(Channel, Trial)> = Vec::new();
    let mut deviation = |of: &TracingEvidence| {
        let channel = of.tracing.channel;
        if !trials.iter().any(|(known, _)| *known == channel) {
            trials.push((channel, Trial::fine(sample, base, channel)));
        }
        let (_, trial) = trials.iter().find(|(known, _)| *known == channel)?;
        trial.deviation_of_contour(&of.tracing)
    };
    let Some(of_best) = deviation(best) else { return };
    let alike = (1..ties).filter(|k| shows_the_same(&candidates[*k]));
    let others = alike.filter_map(|k| Some((k, deviation(&candidates[k])?)));
    let least = others.min_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, least)| tuning::CLEARLY * least < of_best);
    if let Some((k, _)) = least {
        candidates[..=k].rotate_right(1);
    }
}
