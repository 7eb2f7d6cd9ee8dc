use nalgebra::{Point2, Vector2, center};

/// A rectangle of the image plane with sides along its axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangle {
    /// The corner of the smallest coordinates.
    pub low: Point2<f64>,
    /// The corner of the largest coordinates.
    pub high: Point2<f64>,
}

impl Rectangle {
    /// The smallest that holds all points; `None` for no points.
    pub fn around<'a>(mut points: impl Iterator<Item = &'a Point2<f64>>) -> Option<Self> {
        let first = *points.next()?;
        Some(Self { low: first, high: first }.extended(points))
    }

    /// The smallest that holds it and all points.
    #[must_use]
    pub fn extended<'a>(self, points: impl IntoIterator<Item = &'a Point2<f64>>) -> Self {
        let both = |Self { low, high }: Self, p: &Point2<f64>| Self { low: low.inf(p), high: high.sup(p) };
        points.into_iter().fold(self, both)
    }

    /// Width and height.
    #[must_use]
    pub fn size(&self) -> Vector2<f64> {
        self.high - self.low
    }

    /// Its middle.
    #[must_use]
    pub fn centre(&self) -> Point2<f64> {
        center(&self.low, &self.high)
    }

    /// Whether a point lies in it or on its sides.
    #[must_use]
    pub fn contains(&self, p: &Point2<f64>) -> bool {
        p >= &self.low && p <= &self.high
    }

    /// The smallest square about the same centre that holds it.
    #[must_use]
    pub fn square(&self) -> Self {
        let half = Vector2::repeat(0.5 * self.size().max());
        let centre = self.centre();
        Self { low: centre - half, high: centre + half }
    }

    /// Wider on all sides by a share of the longer side.
    #[must_use]
    pub fn widened(&self, share: f64) -> Self {
        let margin = Vector2::repeat(share * self.size().max());
        Self { low: self.low - margin, high: self.high + margin }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rectangle_around_points_holds_them_and_nothing_smaller_does() {
        let points = [Point2::new(1.0, 5.0), Point2::new(-2.0, 3.0), Point2::new(0.0, 4.0)];
        let around = Rectangle::around(points.iter()).expect("points");
        assert_eq!(around, Rectangle { low: Point2::new(-2.0, 3.0), high: Point2::new(1.0, 5.0) });
        assert!(points.iter().all(|p| around.contains(p)));
        assert!(!around.contains(&Point2::new(-2.1, 4.0)) && !around.contains(&Point2::new(0.0, 5.1)));
        assert_eq!(Rectangle::around(points[..2].iter()).map(|two| two.extended(&points[2..])), Some(around));
        assert_eq!(Rectangle::around([].iter()), None);
    }

    #[test]
    fn squares_and_margins_go_by_the_longer_side() {
        let flat = Rectangle { low: Point2::new(0.0, 1.0), high: Point2::new(4.0, 2.0) };
        assert_eq!(flat.square(), Rectangle { low: Point2::new(0.0, -0.5), high: Point2::new(4.0, 3.5) });
        assert_eq!(flat.widened(0.25), Rectangle { low: Point2::new(-1.0, 0.0), high: Point2::new(5.0, 3.0) });
    }
}
