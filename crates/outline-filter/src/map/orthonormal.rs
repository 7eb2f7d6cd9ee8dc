//! Orthonormal directions of the pose.
use freeform_riccati::{MAX_PARAMETERS, ParameterVector};
use nalgebra::SVector;

use crate::tuning::null_space::BESIDE;

/// Orthonormal directions in centred coordinates, no more than a pose has parameters.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Orthonormal {
    directions: [SVector<f64, MAX_PARAMETERS>; MAX_PARAMETERS],
    count: usize,
}

impl Orthonormal {
    /// Those that span some directions.
    pub(super) fn spanning(directions: impl Iterator<Item = ParameterVector>) -> Self {
        let mut basis = Self::default();
        for direction in directions {
            basis.add(&direction);
        }
        basis
    }

    /// Adds what a direction has beside these, with length 1, which is returned; `None`, and nothing changes, where that is next to nothing.
    pub(super) fn add(&mut self, direction: &ParameterVector) -> Option<ParameterVector> {
        let unit = self.beside(direction)?;
        *self.directions.get_mut(self.count)? = unit.into();
        self.count += 1;
        Some(unit)
    }

    /// What a direction has beside these, with length 1; `None` where that is next to nothing.
    pub(super) fn beside(&self, direction: &ParameterVector) -> Option<ParameterVector> {
        let direction = SVector::from(*direction);
        let mut left = direction;
        for other in &self.directions[..self.count] {
            left -= other.dot(&left) * other;
        }
        (left.norm_squared() > BESIDE * direction.norm_squared()).then(|| left.normalize().into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn direction(entries: [f64; 3]) -> ParameterVector {
        let mut direction = [0.0; MAX_PARAMETERS];
        direction[..3].copy_from_slice(&entries);
        direction
    }

    #[test]
    fn what_a_direction_has_beside_others_is_orthogonal_to_them_and_of_length_one() {
        let mut basis = Orthonormal::spanning([direction([2.0, 0.0, 0.0]), direction([3.0, 4.0, 0.0])].into_iter());
        assert_eq!(basis.count, 2);
        assert_eq!(basis.beside(&direction([1.0, -7.0, 0.1])), None);
        let unit = basis.add(&direction([5.0, 1.0, -3.0])).expect("a third direction");
        assert!((unit[2] + 1.0).abs() < 1e-12 && unit[..2].iter().all(|entry| entry.abs() < 1e-12), "{unit:?}");
        assert_eq!(basis.add(&unit), None);
        assert_eq!(basis.beside(&direction([0.0; 3])), None);
    }
}
