#[cfg(feature = "serde")]
use freeform_riccati::MotionModel;
use nalgebra::{Matrix2, Point2, Vector2};

#[cfg(feature = "serde")]
use super::centring::Stretch;
use super::{Contour, association::Bisectors, levers::Levers, nearest_field::NearestField, null_space::NullSpace};
use crate::tuning::map as tuning;

/// A stretch of the outline in the body frame.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Cell {
    pub(crate) centre: Point2<f64>,
    pub(crate) normal: Vector2<f64>,
    /// The cells before and after it; its own number where none is known.
    pub(crate) neighbours: [usize; 2],
}

impl Cell {
    /// The neighbour on the other side of one of them: links may point either way. At an end it is the cell itself.
    pub(super) fn beyond(&self, neighbour: usize) -> usize {
        let [one, other] = self.neighbours;
        if one == neighbour { other } else { one }
    }
}

/// Geometry of an outline: cells along it in the body frame, in normalised coordinates.
///
/// Where the outline lies on the normal of a cell is not geometry but belief: `Belief::offsets`.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct OutlineMap {
    pub(super) cells: Vec<Cell>,
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) field: NearestField,
    /// Of each cell.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) bisectors: Vec<Bisectors>,
    /// Whether any cell is an end.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) has_ends: bool,
    /// Length of a cell.
    pub(super) spacing: f64,
    /// Of the regression that places and normals come from, in points.
    pub(super) half_window: usize,
    /// Mean distance of the points of that regression, normalised.
    pub(super) step: f64,
    /// Most places that a frame has shown at once.
    pub(super) most_seen: usize,
    pub(super) null_space: NullSpace,
    /// Since null directions were found last.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) levers: Option<Levers>,
}

impl OutlineMap {
    /// One without cells, for contours with noise of deviation `sigma`, of which `points` will be measured. `None` where their length
    /// is none.
    pub(crate) fn for_contours(resolution: Resolution) -> Option<Self> {
        let Resolution { spacing, half_window, step } = resolution;
        let map = Self {
            cells: Vec::new(),
            field: NearestField::default(),
            bisectors: Vec::new(),
            has_ends: false,
            spacing,
            half_window,
            step,
            most_seen: 0,
            null_space: NullSpace::default(),
            levers: None,
        };
        (spacing > 0.0 && step > 0.0).then_some(map)
    }

    pub(crate) fn cells(&self) -> &[Cell] {
        &self.cells
    }

    /// Whether cells look to two opposite sides nearly all: few of them show how far the outline has gone along itself.
    pub(crate) fn is_mostly_straight(&self) -> bool {
        let count = self.cells.len() as f64;
        let squares = self.cells.iter().map(|cell| cell.normal * cell.normal.transpose()).sum::<Matrix2<f64>>();
        squares.symmetric_eigenvalues().min() < tuning::MOSTLY_STRAIGHT * count
    }

    pub(crate) fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Length of the outline that is known.
    pub(crate) fn length(&self) -> f64 {
        self.spacing * self.cells.len() as f64
    }

    /// Number of a cell near a body point, if there is any cell.
    #[inline(always)]
    pub(crate) fn near(&self, q: &Point2<f64>) -> Option<usize> {
        self.field.lookup(q)
    }

    /// Number of the cell nearest to a body point.
    pub(crate) fn nearest(&self, q: &Point2<f64>) -> Option<usize> {
        self.field.lookup(q).map(|near| self.nearest_from(near, q))
    }

    /// Whether a body point lies beyond a known end of the outline, its nearest cell given.
    #[inline(always)]
    pub(crate) fn is_beyond_end(&self, number: usize, q: &Point2<f64>) -> bool {
        let [a, b] = self.cells[number].neighbours;
        (a == number || b == number) && self.is_beyond(number, q)
    }

    /// Whether a body point lies beyond a cell that is an end.
    #[cold]
    fn is_beyond(&self, number: usize, q: &Point2<f64>) -> bool {
        let cell = &self.cells[number];
        let [a, b] = cell.neighbours;
        let tangent = Vector2::new(-cell.normal.y, cell.normal.x);
        let along = tangent.dot(&(q - cell.centre));
        let known = if a == number { b } else { a };
        let to_known = tangent.dot(&(self.cells[known].centre - cell.centre));
        along.abs() > tuning::BEYOND_END * self.spacing && (known == number || along * to_known < 0.0)
    }

    /// Whether the normals of neighbouring cells differ by so much, in the median, that the cells are too few to show the outline.
    pub(crate) fn bends_from_cell_to_cell(&self) -> bool {
        let of_cell = |cell: &Cell| {
            let turns = cell.neighbours.map(|n| cell.normal.angle(&self.cells[n].normal));
            0.5 * (turns[0] + turns[1])
        };
        let turn = super::medians::median(&mut self.cells.iter().map(of_cell).collect::<Vec<_>>());
        turn.is_some_and(|turn| turn > tuning::BENT)
    }

    /// How far a bent outline lies from the straight cells, in the median: what is left to be noise where the points have none.
    pub(crate) fn sagitta(&self) -> f64 {
        let bends = self.cells.iter().map(|cell| {
            let [a, b] = cell.neighbours.map(|n| self.cells[n].centre);
            cell.normal.dot(&(nalgebra::center(&a, &b) - cell.centre)).abs()
        });
        // Over a chord of two cells: a quarter of it is left at the ends of one.
        super::medians::median(&mut bends.collect::<Vec<_>>()).unwrap_or(0.0)
    }
}

/// How finely an outline is cut.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Resolution {
    spacing: f64,
    half_window: usize,
    /// Mean distance of the points.
    step: f64,
}

/// Contours with the deviation of the noise of each, if they tell it.
#[derive(Debug)]
pub(crate) struct ContourNoise(Vec<(Contour, Option<f64>)>);

impl ContourNoise {
    pub(crate) fn of(contours: &[Contour]) -> Self {
        let with_noise = |contour: &Contour| {
            let mut contour = contour.clone();
            let noise = contour.noise();
            (contour, noise)
        };
        Self(contours.iter().map(with_noise).collect())
    }

    /// Hands on to the contours what has been worked out of them.
    pub(crate) fn hand_on_regressions(&self, contours: &mut [Contour]) {
        for (contour, (known, _)) in contours.iter_mut().zip(&self.0) {
            contour.adopt_regressions(known);
        }
    }
}

/// Whether the frames that a map is cut from must have cells in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum CellsInCommon {
    /// Not where there is one alone, or a constant motion relates them: each may show cells of its own.
    NotNeeded,
    /// They tell how the motion changes: a pose that has no cells in common with those before is where it was expected. Every frame shows most of
    /// them, and nearly all where its points are evenly spaced.
    InEveryFrame,
    /// As that, of an outline that so few cells do not show: they are more, of which every frame shows some.
    InSomeFrames,
}

impl Resolution {
    /// For contours, and the deviation of their noise, which is no less than `least_noise`; `points` of one frame will be measured on the
    /// cells, whose normals have directions with deviations of no more than `normal_noise`, in rad.
    pub(crate) fn of(
        contours: &mut ContourNoise,
        least_noise: f64,
        (points, in_common): (usize, CellsInCommon),
        normal_noise: f64,
    ) -> (Self, f64) {
        let (mut variance, mut count, mut length, mut window) = (0.0, 0.0, 0.0, 2);
        for (contour, noise) in &mut contours.0 {
            let Some(noise) = *noise else { continue };
            let (weight, sigma) = (contour.len() as f64, noise.max(least_noise));
            window = contour.half_window(sigma, normal_noise).max(window);
            variance += weight * sigma * sigma;
            count += weight;
            length += contour.smooth_length(window);
        }
        // Exact points have no noise; the floor keeps weights finite and is far below what any number can tell.
        let sigma = (variance / f64::max(count, 1.0)).sqrt().max(crate::tuning::noise::SMALLEST);
        let in_every_frame = f64::min(count, points as f64) / tuning::POINTS_PER_COMMON_CELL;
        let most = match in_common {
            CellsInCommon::NotNeeded => count / tuning::POINTS_PER_CELL,
            CellsInCommon::InEveryFrame => in_every_frame,
            CellsInCommon::InSomeFrames => f64::max(count / tuning::POINTS_PER_FINER_CELL, in_every_frame),
        };
        let finest = most.clamp(tuning::FEWEST_OF_FINEST, tuning::MOST_CELLS);
        let plenty = (tuning::LEAST_NOISE_PER_CELL * sigma).max(tuning::PLENTY_PER_CELL * length / points as f64);
        let spacing =
            plenty.min(tuning::NOISE_PER_CELL * sigma).max(length / finest).min(length / tuning::CELLS_PER_LENGTH);
        (Self { spacing, half_window: window, step: length / f64::max(count, 1.0) }, sigma)
    }
}

#[cfg(feature = "serde")]
impl OutlineMap {
    /// Builds what is not saved; false where the map is none. Coordinates are normalised.
    pub(crate) fn restore(&mut self, model: MotionModel) -> bool {
        let count = self.cells.len();
        let within = |value: &f64| value.abs() <= tuning::FARTHEST;
        let is_cell = |cell: &Cell| {
            cell.centre.iter().all(within)
                && (cell.normal.norm_squared() - 1.0).abs() < tuning::UNIT_NORMAL
                && cell.neighbours.iter().all(|number| *number < count)
        };
        let NullSpace {
            in_body,
            of_first_cells,
            sigma,
            frame,
            centroid,
            stretch,
            weakest_turn,
            turn_without_most,
            turn_of_rest,
            turn: _,
        } = &self.null_space;
        let is_valid = (tuning::FEWEST_CELLS..=tuning::MOST_SAVED).contains(&count)
            && self.cells.iter().all(is_cell)
            && (1.0 / tuning::FARTHEST..=tuning::FARTHEST).contains(&self.spacing)
            && super::contour::is_half_window(self.half_window)
            && (1.0 / tuning::FARTHEST..=tuning::FARTHEST).contains(&self.step)
            && self.most_seen <= tuning::MOST_SAVED
            && in_body.len() <= freeform_riccati::MAX_PARAMETERS
            && stretch.as_ref().is_none_or(Stretch::is_valid)
            && of_first_cells.len() <= freeform_riccati::MAX_PARAMETERS
            && of_first_cells
                .iter()
                .all(|of| of.count <= count && of.null.direction.iter().chain(&of.null.dual).all(within))
            && (0.0..=tuning::FARTHEST).contains(sigma)
            && !weakest_turn.is_nan()
            && !turn_without_most.is_nan()
            && turn_of_rest.as_ref().is_none_or(|(turn, centre)| turn.iter().chain(&centre.coords).all(within))
            && in_body.iter().flatten().chain(frame).all(within)
            && centroid.iter().all(|coordinate| coordinate.is_finite());
        if is_valid {
            self.prepare_association();
            self.find_levers(model);
        }
        is_valid
    }
}
