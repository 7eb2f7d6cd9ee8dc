//! Null directions: directions of the pose that an outline does not show, such as the turning of a circle about its centre.
use freeform_riccati::{MotionModel, ParameterKind, ParameterVector, turn_rate};
use nalgebra::{Matrix2, Matrix3, Point2, Vector2};

use super::{
    OutlineMap,
    centring::{Centring, NormalByNeighbours, Stretch},
    first_cells::OfFirstCells,
    levers::{Levers, SumOfSquares},
    local_fit::direction_variance,
    null_directions::NullDirections,
    rest::{Rest, eigen_of_block},
    to_image::ToImage,
    turn_evidence::{TurnEvent, TurnEvidence},
};
use crate::{
    belief::KnownOffsets,
    tuning::{
        contour::{NO_DIRECTION, NORMAL_NOISE},
        null_space as tuning,
    },
};

/// Generator of a turn about the origin by 1 rad, clockwise where y points up.
pub(crate) const CLOCKWISE: Matrix3<f64> = Matrix3::new(0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0);

/// A linear map with the shift that takes one point to another.
pub(crate) fn map_between(linear: &Matrix2<f64>, from: &Vector2<f64>, to: &Vector2<f64>) -> Matrix3<f64> {
    let shift = to - linear * from;
    let mut map = linear.to_homogeneous();
    (map[(0, 2)], map[(1, 2)]) = (shift.x, shift.y);
    map
}

/// The null directions of an outline in the body frame.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct NullSpace {
    pub(super) in_body: Vec<ParameterVector>,
    /// What the cells which the map began with do not show.
    pub(super) of_first_cells: Vec<OfFirstCells>,
    /// Deviation of the noise that they were found with.
    pub(super) sigma: f64,
    /// From centred coordinates of unit RMS radius to the body frame.
    pub(super) frame: Matrix3<f64>,
    pub(super) centroid: Point2<f64>,
    /// What makes the outline as long as wide, where its shape may be stretched.
    pub(super) stretch: Option<Stretch>,
    pub(super) turn: TurnEvidence,
    /// Smallest eigenvalue of the levers of a turn that may be shown, less what errors of the normals make of it.
    pub(super) weakest_turn: f64,
    /// As that, of the cells that are left where a frame disagrees with those that tell most of the turn.
    pub(super) turn_without_most: f64,
    /// The turn that these cells show least, in the body frame, and its centre.
    pub(super) turn_of_rest: Option<(ParameterVector, Point2<f64>)>,
}

impl Default for NullSpace {
    fn default() -> Self {
        Self {
            in_body: Vec::new(),
            of_first_cells: Vec::new(),
            sigma: 0.0,
            frame: Matrix3::identity(),
            centroid: Point2::origin(),
            stretch: None,
            turn: TurnEvidence::default(),
            weakest_turn: f64::INFINITY,
            turn_without_most: f64::INFINITY,
            turn_of_rest: None,
        }
    }
}

impl OutlineMap {
    /// The object's centroid in the body frame: the centroid of the area that the outline encloses, which a body of even thickness turns
    /// about where nothing holds it; the centre of the cells where the outline is not closed; of an outline that does not show how these move,
    /// the point that it does show, if there is one nearby.
    pub(crate) fn centroid(&self) -> Point2<f64> {
        self.null_space.centroid
    }

    /// What frames have said of the turn.
    pub(crate) fn turn_evidence(&self) -> TurnEvidence {
        self.null_space.turn
    }

    /// Records what a frame or new cells say of the turn. What makes it a null direction or none is recorded by [`hide_turn`](Self::hide_turn)
    /// and [`show_turn`](Self::show_turn).
    pub(crate) fn record_turn(&mut self, event: TurnEvent) {
        self.null_space.turn = self.null_space.turn.after(event);
    }

    /// After a frame that has not shown the turn about the object's centroid: marks it as not observable.
    pub(crate) fn hide_turn(&mut self, model: MotionModel, offsets: KnownOffsets<'_>) {
        let space = &mut self.null_space;
        if !space.holds_turn(model) && space.frame.try_inverse().is_some() {
            space.turn = space.turn.after(TurnEvent::NotSeen);
            // What tells the turn is not to be trusted: the rest of the outline says what it cannot be told from. Its centre is what moves as is
            // seen.
            if let Some((turn, centre)) =
                space.turn_of_rest.filter(|_| space.turn == TurnEvidence::Refuted && space.in_body.is_empty())
            {
                space.in_body.push(turn);
                space.centroid = centre;
                return;
            }
            let (mut frame, is_alone) = (space.frame, space.in_body.is_empty());
            // Beside other directions its part that is a shift would be one of theirs.
            if is_alone {
                (frame.m13, frame.m23) = (space.centroid.x, space.centroid.y);
            }
            let Some(inverse) = frame.try_inverse() else { return };
            space.in_body.push(model.parameters_of(&(frame * space.unit_turn(model) * inverse)));
            if !is_alone {
                self.place_centroid(model, offsets);
            }
        }
    }

    /// The turn of the body by an angle about its centroid, rad, anticlockwise where y points up. Where the model may stretch an outline, that of one
    /// which is stretched until it is as long as wide: only such turns may leave it as it is. `None` where it may not.
    pub(crate) fn stretched_turn(&self, angle: f64) -> Option<Matrix3<f64>> {
        let turn = self.null_space.stretch?.turn(angle);
        let centroid = &self.null_space.centroid.coords;
        Some(map_between(&turn, centroid, centroid))
    }

    /// How many times as long as wide an outline is, in a pose, that may be stretched; 1 where it may not.
    pub(crate) fn stretch_ratio(&self, pose: &Matrix3<f64>) -> f64 {
        let linear = pose.fixed_view::<2, 2>(0, 0).into_owned();
        self.null_space.stretch.map_or(1.0, |stretch| stretch.ratio_after(&linear))
    }

    /// The linear part of a map of the body as one of the outline stretched until it is as long as wide. Where it may not be stretched the map is not
    /// asked for.
    pub(crate) fn stretched(&self, map: impl FnOnce() -> Option<Matrix3<f64>>) -> Option<Matrix2<f64>> {
        let stretch = self.null_space.stretch?;
        Some(stretch.stretched(&map()?.fixed_view::<2, 2>(0, 0).into_owned()))
    }

    /// The generator of a clockwise turn by 1 rad of the outline stretched so, in the body frame, where it may be stretched.
    pub(crate) fn stretched_turn_generator(&self) -> Option<Matrix3<f64>> {
        Some(self.null_space.stretch?.unstretched(&CLOCKWISE))
    }

    /// Whether the outline may be stretched.
    pub(crate) fn may_be_stretched(&self) -> bool {
        self.null_space.stretch.is_some()
    }

    /// Undoes [`hide_turn`](Self::hide_turn), so that it can be asked anew whether the turn is seen.
    pub(crate) fn show_turn(&mut self, model: MotionModel, offsets: KnownOffsets<'_>) {
        let space = &mut self.null_space;
        if space.turn.is_hidden() && space.turn != TurnEvidence::Refuted {
            space.turn = space.turn.after(TurnEvent::AskedAnew);
            space.in_body.pop();
            self.place_centroid(model, offsets);
        }
    }

    /// Whether a null direction holds a turn.
    pub(crate) fn turn_is_unseen(&self, model: MotionModel) -> bool {
        self.null_space.holds_turn(model)
    }

    /// Variance of the direction of the normals by the noise of the points that they come from, rad squared.
    pub(crate) fn variance_of_normals(&self) -> f64 {
        direction_variance(self.null_space.sigma / self.step, self.half_window)
    }

    /// Finds the null directions from the lever arms of the cells about their mean; `sigma` is the deviation of the noise.
    pub(crate) fn find_null_directions(&mut self, model: MotionModel, sigma: f64, offsets: KnownOffsets<'_>) {
        let k = model.parameter_count();
        let count = self.cells.len() as f64;
        let contours = self.closed_contours();
        let centring = Centring::of(&self.cells, model, sigma, Self::area_covariance(&contours));
        let all = self.levers_about(model, centring, sigma);
        // A cell counts for the length of the outline that it stands for.
        let sum = SumOfSquares::of(all.of_cells.iter().map(|lever| (lever, lever.length / count)), k);
        let of_cells: Vec<_> = all.of_cells.iter().map(|lever| (lever.across.into(), count / lever.length)).collect();
        let of_places = self.levers_of_places(&contours, centring.spread());
        let noise = sigma / centring.spread();
        // Where the outline may be stretched, light that moves a hole looks like a stretch as well as like a turn.
        let places_show_turn = centring.stretch().is_none()
            && of_places >= tuning::SHOWN_BY_PLACES.max(tuning::PLACES_PER_NOISE * noise * noise);
        self.null_space.sigma = sigma;
        let needed = tuning::HARDLY_SHOWN.min(tuning::LEAST_LEVER_PER_NOISE * self.variance_of_normals());
        let to_body = centring.to_body();
        self.levers = Some(all);
        let space = &mut self.null_space;
        space.in_body.clear();
        (space.weakest_turn, space.turn_without_most, space.turn_of_rest) = (f64::INFINITY, f64::INFINITY, None);
        let mut unseen: Vec<ParameterVector> = Vec::new();
        for (value, vector) in eigen_of_block(&sum.levers, k) {
            let of_noise = (vector.transpose() * sum.of_noise * vector)[(0, 0)];
            let told = value - of_noise;
            let generator = model.generator(&vector.as_slice()[..k]);
            let mut is_shown = value >= tuning::DEGENERATE.max(tuning::EXPLAINED * of_noise);
            let is_turn = turn_rate(&generator).abs() > tuning::HOLDS_TURN;
            if is_turn && places_show_turn {
                space.weakest_turn = space.weakest_turn.min(told.max(of_places));
                is_shown = true;
            } else if is_shown && is_turn {
                space.weakest_turn = space.weakest_turn.min(told);
                // Where the outline may be stretched, frames are not asked whether they tell a turn (`turn_profile`).
                if centring.stretch().is_none() {
                    let rest = Rest::of(&of_cells, &vector, k);
                    // A long bar without its ends does not show where it is along itself, which is no turn.
                    if let Some(turn) = rest.turn(model, &to_body)
                        && rest.lever - of_noise < space.turn_without_most
                    {
                        (space.turn_without_most, space.turn_of_rest) = (rest.lever - of_noise, Some(turn));
                    }
                }
                is_shown = told >= needed;
            }
            if !is_shown {
                let Some(inverse) = to_body.try_inverse() else { continue };
                let mut direction = model.parameters_of(&centring.unstretched(&generator));
                if centring.stretch().is_some() {
                    direction = orthonormal(direction, &unseen);
                }
                unseen.push(direction);
                let generator = model.generator(&direction[..k]);
                space.in_body.push(model.parameters_of(&(to_body * generator * inverse)));
            }
        }
        (space.frame, space.stretch) = (to_body, centring.stretch());
        space.turn = space.turn.after(TurnEvent::AskedAnew);
        self.place_centroid(model, offsets);
        if self.null_space.turn == TurnEvidence::Refuted {
            self.hide_turn(model, offsets);
        }
    }

    /// The lever arms of all cells in centred coordinates; `sigma` is the deviation of their noise.
    pub(super) fn levers_about(&self, model: MotionModel, centring: Centring, sigma: f64) -> Levers {
        let cells = self.cells.iter().enumerate();
        let cells = cells.map(|(number, cell)| (cell.centre, self.normal_by_neighbours(number, sigma)));
        Levers::of(model, centring, cells, &self.null_space.of_first_cells)
    }

    /// Whether a turn is shown, but hardly.
    pub(crate) fn shows_turn_weakly(&self) -> bool {
        self.null_space.weakest_turn < tuning::WEAKLY_SHOWN
    }

    /// Whether few of the cells tell nearly all of the turn, so that a pose that misses them passes for one that shows it.
    pub(crate) fn turn_hangs_on_few(&self) -> bool {
        self.null_space.turn_without_most < tuning::TOLD_BY_REST * self.null_space.weakest_turn
    }

    /// Whether the outline shows its turn hardly, or not without few of its cells: a disc with a slot, a ring with a gap, a shaft with a flat.
    pub(crate) fn is_all_but_round(&self) -> bool {
        self.shows_turn_weakly() || self.null_space.turn_without_most < tuning::DEGENERATE
    }

    /// Deviation that directions of normals may have at most, in rad. Points slide along an outline that errs in its normals, and the
    /// levers that these errors make say that they do not: the less an outline shows of its turn, the better its normals must be.
    pub(crate) fn normal_noise(&self) -> f64 {
        if !self.shows_turn_weakly() {
            return NORMAL_NOISE;
        }
        NORMAL_NOISE.min((self.null_space.weakest_turn / tuning::LEVER_PER_NOISE).sqrt())
    }

    /// Normal of the outline at a cell by the cells some way before and after it. Where cells err together this does not, as their own normals
    /// do: a circle would have its centroid beside where it is.
    fn normal_by_neighbours(&self, number: usize, sigma: f64) -> NormalByNeighbours {
        // Of the value of a quadratic in the middle of its window.
        let window = (2 * self.half_window + 1) as f64;
        let noise = sigma * (tuning::QUADRATIC / window).sqrt();
        let steps = (noise / (std::f64::consts::SQRT_2 * tuning::CHORD_NOISE * self.spacing)).ceil() as usize;
        let steps = steps.clamp(1, (self.cells.len() / tuning::FEWEST_PARTS).max(1));
        let [before, after] = [0, 1].map(|side| {
            let (mut last, mut here) = (number, self.cells[number].neighbours[side]);
            for _ in 1..steps {
                let cell = &self.cells[here];
                if cell.neighbours.contains(&here) {
                    break;
                }
                (last, here) = (here, cell.beyond(last));
            }
            self.cells[here].centre
        });
        let here = self.cells[number].centre;
        let bend = (here - before).angle(&(after - here));
        let of_bend = bend * bend / tuning::BETWEEN_CHORDS;
        let chord = after - before;
        match chord.try_normalize(NO_DIRECTION) {
            Some(along) => {
                let of_noise = (2.0 * noise * noise / chord.norm_squared()).min(tuning::ANY_DIRECTION);
                NormalByNeighbours { direction: Vector2::new(along.y, -along.x), of_noise, of_bend }
            }
            None => {
                NormalByNeighbours { direction: self.cells[number].normal, of_noise: tuning::ANY_DIRECTION, of_bend }
            }
        }
    }

    /// The null directions in the image, for a pose.
    pub(crate) fn null_directions(&self, model: MotionModel, pose: &Matrix3<f64>) -> NullDirections {
        let space = &self.null_space;
        let mut list = NullDirections::default();
        if space.in_body.is_empty() {
            return list;
        }
        // Duals in centred coordinates, where the directions are orthonormal. What is taken off along a turn is all of the turn: noise of the
        // normals gives its centre a place of its own, and the object would be taken to turn as it travels.
        let Some(to_image) = ToImage::of(model, pose, &space.frame) else { return list };
        for u in &space.in_body {
            let mut centred = to_image.centred(u);
            if space.in_body.len() == 1 {
                centred = of_its_rates(model, centred);
            }
            list.push(to_image.direction(u, &centred));
        }
        list
    }

    /// Of all poses that differ from `pose` by null directions, the one that moves the object the least from `from`.
    pub(crate) fn least_moved(&self, model: MotionModel, from: &Matrix3<f64>, pose: &Matrix3<f64>) -> Matrix3<f64> {
        let k = model.parameter_count();
        let mut pose = *pose;
        let frame = &self.null_space.frame;
        let (Some(to_body), Some(to_centred)) = (from.try_inverse(), frame.try_inverse()) else { return pose };
        for direction in &self.null_space.in_body {
            let generator = model.generator(&direction[..k]);
            let centred = model.parameters_of(&(to_centred * generator * frame));
            // A turn about another point than the middle of the cells is longer than 1.
            let length: f64 = centred.iter().map(|c| c * c).sum();
            for _ in 0..tuning::LEAST_STEPS {
                let change = to_centred * to_body * pose * frame;
                let Some(step) = model.motion_between(&change, 1.0) else { break };
                let along = step.iter().zip(&centred).map(|(a, b)| a * b).sum::<f64>() / length;
                pose *= model.flow(&direction[..k], -along).into_inner();
            }
        }
        pose
    }
}

/// The dual of a unit direction that leaves nothing of its rates, where they are most of it; the direction itself otherwise.
fn of_its_rates(model: MotionModel, direction: ParameterVector) -> ParameterVector {
    let mut rates = direction;
    let kinds = rates.iter_mut().zip(model.parameter_kinds());
    kinds.filter(|(_, kind)| **kind != ParameterKind::Rate).for_each(|(rate, _)| *rate = 0.0);
    let squared: f64 = rates.iter().map(|rate| rate * rate).sum();
    if squared > tuning::MOSTLY_RATES { rates.map(|rate| rate / squared) } else { direction }
}

/// A direction without its parts along others of length 1, with this length.
fn orthonormal(mut direction: ParameterVector, others: &[ParameterVector]) -> ParameterVector {
    let product = |a: &ParameterVector, b: &ParameterVector| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    for other in others {
        let along = product(&direction, other);
        direction.iter_mut().zip(other).for_each(|(c, d)| *c -= along * *d);
    }
    let length = product(&direction, &direction).sqrt();
    direction.map(|c| c / length)
}

impl NullSpace {
    /// The generator of a clockwise turn in centred coordinates whose parameters are a vector of length 1.
    fn unit_turn(&self, model: MotionModel) -> Matrix3<f64> {
        let turn = self.stretch.map_or(CLOCKWISE, |stretch| stretch.unstretched(&CLOCKWISE));
        let parameters = model.parameters_of(&turn);
        turn / parameters[..model.parameter_count()].iter().map(|c| c * c).sum::<f64>().sqrt()
    }

    fn holds_turn(&self, model: MotionModel) -> bool {
        let Some(inverse) = self.frame.try_inverse() else { return false };
        self.in_body.iter().any(|direction| {
            let generator = model.generator(&direction[..model.parameter_count()]);
            let centred = inverse * generator * self.frame;
            turn_rate(&centred).abs() > tuning::HOLDS_TURN
        })
    }
}
