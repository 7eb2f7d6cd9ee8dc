//! Outlines without the cells that tell most of a turn, which a frame may disagree with.
use freeform_riccati::{MAX_PARAMETERS, MotionModel, ParameterVector, turn_rate};
use nalgebra::{Matrix3, Point2, SMatrix, SVector};

use crate::tuning::null_space as tuning;

/// Adds `times v v'` to a sum; only the first `entries` of v are not zero.
fn add_square(
    sum: &mut SMatrix<f64, MAX_PARAMETERS, MAX_PARAMETERS>,
    vector: &SVector<f64, MAX_PARAMETERS>,
    times: f64,
    entries: usize,
) {
    for j in 0..entries {
        let weighted = times * vector[j];
        for i in 0..entries {
            sum[(i, j)] += weighted * vector[i];
        }
    }
}

/// Eigenvalues of the first rows and columns of a symmetric matrix, of which no others are asked for, and their vectors; as many as there are
/// entries.
pub(super) fn eigen_of_block(
    matrix: &SMatrix<f64, MAX_PARAMETERS, MAX_PARAMETERS>,
    entries: usize,
) -> impl Iterator<Item = (f64, SVector<f64, MAX_PARAMETERS>)> + use<> {
    macro_rules! of_size {
        ($k:literal) => {{
            let eigen = matrix.fixed_view::<$k, $k>(0, 0).into_owned().symmetric_eigen();
            let vector = |j: usize| SVector::from_fn(|i, _| if i < entries { eigen.eigenvectors[(i, j)] } else { 0.0 });
            let pair = |j: usize| if j < entries { (eigen.eigenvalues[j], vector(j)) } else { (0.0, SVector::zeros()) };
            std::array::from_fn::<_, MAX_PARAMETERS, _>(pair)
        }};
    }
    let pairs = match entries {
        3 => of_size!(3),
        4 => of_size!(4),
        6 => of_size!(6),
        MAX_PARAMETERS => of_size!(8),
        _ => unreachable!("no model has {entries} parameters"),
    };
    pairs.into_iter().take(entries)
}

/// What is left of an outline where a frame disagrees with the cells that tell most of a direction of the pose.
pub(super) struct Rest {
    /// Mean square of the levers that it has in the direction that it shows least, over all cells.
    pub(super) lever: f64,
    /// That direction, in centred coordinates.
    direction: SVector<f64, MAX_PARAMETERS>,
}

impl Rest {
    /// Of cells by their levers and the numbers that each is a part of; a direction has so many entries.
    pub(super) fn of(
        of_cells: &[(SVector<f64, MAX_PARAMETERS>, f64)],
        direction: &SVector<f64, MAX_PARAMETERS>,
        entries: usize,
    ) -> Self {
        let mut rest = Self { lever: 0.0, direction: *direction };
        let kept = ((1.0 - tuning::MISSED) * of_cells.len() as f64).ceil() as usize;
        let lever = |(across, count): &(SVector<f64, MAX_PARAMETERS>, f64),
                     direction: &SVector<f64, MAX_PARAMETERS>| {
            let along: f64 = (0..entries).map(|i| across[i] * direction[i]).sum();
            along * along / count
        };
        let mut ordered = Vec::with_capacity(of_cells.len());
        for _ in 0..tuning::ROUNDS_OF_REST {
            ordered.clear();
            ordered.extend(of_cells.iter().map(|cell| lever(cell, &rest.direction)).zip(0_u32..));
            // Which of them count is all that matters.
            let by_lever = |a: &(f64, u32), b: &(f64, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
            if kept < ordered.len() {
                ordered.select_nth_unstable_by(kept, by_lever);
            }
            let mut levers = SMatrix::<f64, MAX_PARAMETERS, MAX_PARAMETERS>::zeros();
            for (_, number) in &ordered[..kept.min(ordered.len())] {
                let (across, count) = &of_cells[*number as usize];
                add_square(&mut levers, across, count.recip(), entries);
            }
            let least = eigen_of_block(&levers, entries).min_by(|a, b| a.0.total_cmp(&b.0));
            (rest.lever, rest.direction) = least.unwrap_or((rest.lever, rest.direction));
        }
        rest
    }

    /// The direction in the body frame, and its centre there, if it is a turn.
    pub(super) fn turn(&self, model: MotionModel, to_body: &Matrix3<f64>) -> Option<(ParameterVector, Point2<f64>)> {
        let generator = model.generator(&self.direction.as_slice()[..model.parameter_count()]);
        if turn_rate(&generator).abs() <= tuning::HOLDS_TURN {
            return None;
        }
        let linear = generator.fixed_view::<2, 2>(0, 0).into_owned();
        let centre = -(linear.try_inverse()? * generator.fixed_view::<2, 1>(0, 2));
        let in_body = model.parameters_of(&(to_body * generator * to_body.try_inverse()?));
        Some((in_body, Point2::from_homogeneous(to_body * Point2::from(centre).to_homogeneous())?))
    }
}

#[cfg(test)]
mod tests {
    use freeform_curve_fit::Outline;
    use freeform_riccati::MotionModel;
    use nalgebra::Point2;

    use crate::{
        drawn_curves::{lobed, polar},
        measurement::Frame,
        track::Track,
    };

    /// A flat ring of radii 1 and 3/4 about (0.5, 0.2), with a gap of half a radian.
    fn ring() -> Outline {
        let arc = |radius: f64, i: u32| polar(radius, 0.25 + (std::f64::consts::TAU - 0.5) * f64::from(i) / 200.0);
        let end = |angle: f64, i: u32| polar(1.0 - 0.25 * f64::from(i) / 9.0, angle);
        let there = (0..200).map(|i| arc(1.0, i)).chain((0..9).map(|i| end(-0.25, i)));
        let back = (0..200).rev().map(|i| arc(0.75, i + 1)).chain((0..9).rev().map(|i| end(0.25, i + 1)));
        let points = there.chain(back).map(|p| Point2::new(p.x + 0.5, p.y + 0.2));
        Outline::closed(points.collect()).expect("an outline")
    }

    #[test]
    fn what_a_ring_with_a_gap_does_not_show_without_its_ends_is_a_turn_about_the_centre_of_its_circles() {
        let mut frame = Frame::default();
        let track = Track::begin(MotionModel::Rigid, &ring(), 0.0, &mut frame).expect("a track");
        let map = track.map();
        assert!(!track.turn_is_unseen() && map.turn_hangs_on_few());
        let (reference, (turn, centre)) = (track.reference(), map.null_space.turn_of_rest.expect("a turn"));
        let centre = reference.origin + reference.radius * centre.coords;
        assert!((centre - Point2::new(0.5, 0.2)).norm() < 0.003, "{centre}");
        // The centroid lies away from the gap.
        let centroid = reference.origin + reference.radius * map.centroid().coords;
        assert!(centroid.x < 0.48, "{centroid}");
        assert!(turn.iter().all(|entry| entry.is_finite()) && turn[0].abs() > 0.3, "{turn:?}");
        // Of waves all around no part tells nearly all.
        for waves in [[(2.0, [0.14, 0.0]), (3.0, [0.0, 0.1])], [(2.0, [0.1, 0.0]), (5.0, [0.0, 0.0])]] {
            let waves = crate::drawn_curves::outline(300, |t| polar(lobed(t, &waves), t));
            let track = Track::begin(MotionModel::Rigid, &waves, 0.0, &mut frame).expect("a track");
            assert!(!track.turn_is_unseen() && !track.map().turn_hangs_on_few());
        }
    }
}
