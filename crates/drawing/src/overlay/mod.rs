//! What was found, drawn on the pictures.
mod canvas;
mod colours;
mod drawing;
mod gif_animation;
mod lettering;
mod marked_png;
mod observed;
mod palette;
mod y4m_video;

pub(crate) use canvas::Canvas;
pub use drawing::{Drawn, DrawnPicture, Overlay};
pub use gif_animation::GifAnimation;
pub(crate) use lettering::Label;
pub use marked_png::{is_marked_png, marked_png};
pub use observed::ObservedOverlay;
pub use y4m_video::Y4mVideo;
