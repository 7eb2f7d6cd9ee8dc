/// Displacement, in object sizes (for a turn, in rad). A parameter is not observable if its standard deviation displaces the object by more.
/// A quarter: beyond it outlines are no longer linear in the displacement, and a normal distribution says nothing.
const WORTHLESS: f64 = 0.25;

/// Whether a rate of this standard deviation is worth stating: over the seconds of the past that it is known from, it leaves less than
/// a quarter of `displacement` in doubt. `displacement` is what one unit of the rate times one second would have to be multiplied by to
/// move the object by its own size: 1 for rates of turning and growth, the object's reach for velocities.
#[must_use]
pub fn is_worth(deviation: f64, seconds: f64, displacement: f64) -> bool {
    deviation * seconds <= WORTHLESS * displacement
}
