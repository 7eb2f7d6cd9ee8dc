//! What is told of motions that a family leaves out.
use super::{to_and_fro::ChangeOfShape, wrong_family::WrongFamily};
use crate::update::UnmodelledMatrix;

/// What the outlines do beside their motion, as far as it is told.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct UnmodelledEstimate {
    /// What is there, by the noise of the points.
    pub(crate) family: Option<WrongFamily>,
    /// Whether that is beyond doubt: it is there also by what frames scatter, and in more than one stretch of them.
    pub(crate) is_beyond_doubt: bool,
    /// Displacement of the outlines that is seen of that, root mean square, normalised.
    pub(crate) displacement: f64,
    /// How far the outline has changed its shape since the map became known, whatever explains it, root mean square, normalised.
    pub(crate) change_of_shape: f64,
    /// Second moments of the sizes of the motions that may be there.
    pub(crate) moments: UnmodelledMatrix,
}

impl UnmodelledEstimate {
    /// The most that points of a frame may be displaced by: an outline that is learnt anew from frame to frame hides most of a change of its shape.
    pub(crate) fn displacement_of_points(&self) -> f64 {
        self.displacement.max(self.change_of_shape)
    }

    /// What poses may err by: an outline that is learnt anew takes a part of a change of its shape for a turn. Growth turns and shifts nothing.
    pub(crate) fn displacement_of_poses(&self) -> f64 {
        if self.family == Some(WrongFamily::Growth) { self.displacement } else { self.displacement_of_points() }
    }

    /// The shape changes as well, which is said where nothing else is beyond doubt. A larger displacement that is known already counts.
    pub(crate) fn add_change_of_shape(&mut self, (displacement, is_beyond_doubt): ChangeOfShape) {
        if is_beyond_doubt || self.family.is_none() {
            (self.family, self.is_beyond_doubt) = (Some(WrongFamily::Shape), is_beyond_doubt);
            self.displacement = self.displacement.max(displacement);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_of_shape_that_is_beyond_doubt_beside_something_else_counts_by_the_larger_displacement() {
        let before = UnmodelledEstimate { family: Some(WrongFamily::Growth), displacement: 0.01, ..Default::default() };
        let after = [(0.02, true), (0.005, true), (0.02, false)].map(|change| {
            let mut estimate = before;
            estimate.add_change_of_shape(change);
            (estimate.family, estimate.is_beyond_doubt, estimate.displacement)
        });
        let (shape, growth) = (Some(WrongFamily::Shape), Some(WrongFamily::Growth));
        assert_eq!(after, [(shape, true, 0.02), (shape, true, 0.01), (growth, false, 0.01)]);
    }

    #[test]
    fn points_are_displaced_by_a_change_of_shape_whatever_explains_it_and_poses_unless_it_is_growth() {
        let displacements = [WrongFamily::Shear, WrongFamily::Growth].map(|family| {
            let family = Some(family);
            let estimate =
                UnmodelledEstimate { family, displacement: 0.001, change_of_shape: 0.09, ..Default::default() };
            [estimate.displacement_of_points(), estimate.displacement_of_poses()]
        });
        assert_eq!(displacements, [[0.09, 0.09], [0.09, 0.001]]);
    }
}
