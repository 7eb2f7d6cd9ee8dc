//! The drawings, in any unit and place; y is up. `S(x, y)` is a smooth vertex, `C(x, y, cut)` a rounded corner.
use crate::curve::Vertex::{self, Corner as C, Smooth as S};

pub(super) const BIRD: [Vertex; 24] = [
    C(1.15, 2.75, 0.15),
    S(0.75, 2.0),
    S(1.6, 1.75),
    S(2.9, 1.95),
    S(3.9, 1.35),
    C(4.6, -0.1, 0.25),
    S(3.4, 0.15),
    S(2.2, -0.25),
    S(1.05, -0.7),
    S(0.75, -1.6),
    C(1.25, -3.1, 0.25),
    S(0.2, -3.45),
    C(-0.75, -3.3, 0.25),
    S(-0.45, -1.7),
    S(-0.9, -0.75),
    S(-2.3, -0.15),
    S(-3.9, 0.1),
    C(-5.6, -0.6, 0.25),
    S(-4.9, 1.2),
    S(-3.6, 2.0),
    S(-2.0, 1.75),
    S(-0.7, 1.75),
    S(-0.35, 2.3),
    S(0.25, 3.05),
];

pub(super) const GLIDER: [Vertex; 18] = [
    S(0.0, 3.3),
    S(0.5, 2.5),
    C(0.6, 1.4, 0.25),
    C(4.2, 1.0, 0.3),
    C(4.2, 0.4, 0.2),
    C(0.6, 0.0, 0.3),
    C(0.3, -2.3, 0.3),
    C(1.5, -2.65, 0.2),
    C(1.5, -3.2, 0.2),
    S(0.0, -3.4),
    C(-1.4, -3.2, 0.2),
    C(-1.4, -2.65, 0.2),
    C(-0.3, -2.3, 0.3),
    C(-0.6, 0.0, 0.3),
    C(-5.2, 0.7, 0.2),
    C(-5.2, 1.3, 0.3),
    C(-0.6, 1.4, 0.25),
    S(-0.5, 2.5),
];

pub(super) const PHONE: [Vertex; 8] = [
    C(-1.0, -2.6, 0.5),
    C(1.0, -2.6, 0.5),
    C(1.2, 0.4, 0.5),
    C(1.2, 3.7, 0.24),
    C(0.65, 3.7, 0.24),
    C(0.65, 2.5, 0.2),
    C(-1.2, 2.3, 0.5),
    C(-1.2, 0.4, 0.5),
];

pub(super) const SQUARE: [Vertex; 4] = [C(-1.0, -1.0, 0.0), C(1.0, -1.0, 0.0), C(1.0, 1.0, 0.0), C(-1.0, 1.0, 0.0)];

pub(super) const PLANE: [Vertex; 4] = SQUARE;

pub(super) const VAN: [Vertex; 4] = SQUARE;

pub(super) const GLASS_VASE: [Vertex; 4] = SQUARE;

pub(super) const CD_BOX: [Vertex; 4] = SQUARE;

pub(super) const SHOE: [Vertex; 4] = SQUARE;

pub(super) const CAR: [Vertex; 4] = SQUARE;

pub(super) const VASE: [Vertex; 4] = SQUARE;

pub(super) const HAT: [Vertex; 4] = SQUARE;

pub(super) const BOOMERANG: [Vertex; 4] = SQUARE;
