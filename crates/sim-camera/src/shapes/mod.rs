//! The shapes that are built in, by name.
mod drawings;

use std::str::FromStr;

use crate::{curve::Vertex, error::ShapeError, shape::Shape};

/// A shape drawn for this crate: the ten objects of the paper's figure 1, its flight bird (figure 3) and its boomerang
/// (figure 2), and three plain ones.
///
/// `Boomerang`, `GlassVase` and `Vase` are mirror-symmetric; `CdBox` and `Ellipse` also look the same after half a
/// turn, `Square` after a quarter, `Circle` after any. The others have no symmetry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum BuiltInShape {
    /// A jet plane seen from above, banking.
    Plane,
    /// A delivery van from the side.
    Van,
    /// A tall glass vase.
    GlassVase,
    /// The box of a compact disc, 142 by 125.
    CdBox,
    /// A shoe from the side.
    Shoe,
    /// A car from the side.
    Car,
    /// A bellied vase.
    Vase,
    /// A hang-glider seen from above, banking.
    Glider,
    /// A cellular phone with a stub of an antenna.
    Phone,
    /// A hat from the side.
    Hat,
    /// A bird in flight seen from above, banking, its head turned.
    Bird,
    /// A boomerang.
    Boomerang,
    /// A circle.
    Circle,
    /// An ellipse whose axes are as 5 to 3.
    Ellipse,
    /// A square, its corners sharp.
    Square,
}

impl BuiltInShape {
    /// All of them: the paper's figure 1 in its order, then the rest.
    pub const ALL: [Self; 15] = [
        Self::Plane,
        Self::Van,
        Self::GlassVase,
        Self::CdBox,
        Self::Shoe,
        Self::Car,
        Self::Vase,
        Self::Glider,
        Self::Phone,
        Self::Hat,
        Self::Bird,
        Self::Boomerang,
        Self::Circle,
        Self::Ellipse,
        Self::Square,
    ];

    /// The ten objects of the paper's figure 1, in its order.
    pub const FIGURE_1: [Self; 10] = [
        Self::Plane,
        Self::Van,
        Self::GlassVase,
        Self::CdBox,
        Self::Shoe,
        Self::Car,
        Self::Vase,
        Self::Glider,
        Self::Phone,
        Self::Hat,
    ];

    /// The name that [`FromStr`] reads back.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Plane => "plane",
            Self::Van => "van",
            Self::GlassVase => "glass_vase",
            Self::CdBox => "cd_box",
            Self::Shoe => "shoe",
            Self::Car => "car",
            Self::Vase => "vase",
            Self::Glider => "glider",
            Self::Phone => "phone",
            Self::Hat => "hat",
            Self::Bird => "bird",
            Self::Boomerang => "boomerang",
            Self::Circle => "circle",
            Self::Ellipse => "ellipse",
            Self::Square => "square",
        }
    }

    /// The curve, at unit size.
    #[must_use]
    pub fn shape(self) -> Shape {
        Shape::from(self)
    }
}

impl From<BuiltInShape> for Shape {
    fn from(built_in: BuiltInShape) -> Self {
        use drawings as d;
        let vertices: &[Vertex] = match built_in {
            BuiltInShape::Plane => &d::PLANE,
            BuiltInShape::Van => &d::VAN,
            BuiltInShape::GlassVase => &d::GLASS_VASE,
            BuiltInShape::CdBox => &d::CD_BOX,
            BuiltInShape::Shoe => &d::SHOE,
            BuiltInShape::Car => &d::CAR,
            BuiltInShape::Vase => &d::VASE,
            BuiltInShape::Glider => &d::GLIDER,
            BuiltInShape::Phone => &d::PHONE,
            BuiltInShape::Hat => &d::HAT,
            BuiltInShape::Bird => &d::BIRD,
            BuiltInShape::Boomerang => &d::BOOMERANG,
            BuiltInShape::Square => &d::SQUARE,
            BuiltInShape::Circle => return Self::ellipse(built_in.name(), 0.5, 0.5),
            BuiltInShape::Ellipse => return Self::ellipse(built_in.name(), 0.5, 0.3),
        };
        Self::drawn(built_in.name(), vertices)
    }
}

impl std::fmt::Display for BuiltInShape {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for BuiltInShape {
    type Err = ShapeError;

    /// Reads a name; case does not matter, and a hyphen, a blank or nothing may stand for the underscore.
    fn from_str(name: &str) -> Result<Self, ShapeError> {
        let letters = |text: &str| -> String {
            text.chars().filter(|c| !matches!(c, '_' | '-' | ' ')).flat_map(char::to_lowercase).collect()
        };
        let wanted = match letters(name).as_str() {
            "cellularphone" | "cellphone" | "mobilephone" | "cellular" => "phone".to_owned(),
            "flightbird" | "flyingbird" => "bird".to_owned(),
            "airplane" | "aeroplane" | "aircraft" => "plane".to_owned(),
            "cdcase" | "cd" => "cdbox".to_owned(),
            "hangglider" => "glider".to_owned(),
            other => other.to_owned(),
        };
        let found = Self::ALL.into_iter().find(|shape| letters(shape.name()) == wanted);
        found
            .ok_or_else(|| ShapeError::UnknownName { name: name.to_owned(), known: Self::ALL.map(Self::name).to_vec() })
    }
}
