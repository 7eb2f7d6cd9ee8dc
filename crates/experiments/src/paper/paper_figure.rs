use freeform_sim_camera::PaperExperiment;

/// RMS radius of an object in the identifier where nothing else is said; the paper does not give it.
pub(super) const SIZE: f64 = 0.6;

/// The phone is larger there: as slender as it is, the gains of the paper are slow for it at the size of the others.
pub(super) const SIZE_OF_PHONE: f64 = 1.5;

/// One of the paper's experiments and its two figures.
pub(super) struct PaperFigure {
    pub(super) poses: &'static str,
    pub(super) parameters: &'static str,
    pub(super) poses_heading: &'static str,
    pub(super) parameters_heading: &'static str,
    pub(super) experiment: PaperExperiment,
    /// What a caption says of how the paper is read; may be empty.
    pub(super) reading: &'static str,
    /// What the paper says of the estimates.
    pub(super) paper_says: &'static str,
    /// RMS radius of the object in the identifier.
    pub(super) size: f64,
    /// Stream of random numbers that its initial values come from.
    pub(super) stream: u64,
}

impl PaperFigure {
    /// Number of the figure of its parameters in the paper.
    pub(super) fn number(&self) -> &str {
        number_in(self.parameters)
    }

    /// Number of the figure of its poses in the paper.
    pub(super) fn poses_number(&self) -> &str {
        number_in(self.poses)
    }
}

/// The number in `fig6-text`.
fn number_in(name: &str) -> &str {
    name.trim_start_matches("fig").split('-').next().unwrap_or(name)
}

pub(super) const BIRD: [PaperFigure; 1] = [PaperFigure {
    poses: "fig3",
    parameters: "fig4",
    poses_heading: "Fig. 3: a flight bird and its rigid motion",
    parameters_heading: "Fig. 4: the parameters of the flight bird",
    experiment: PaperExperiment::FLIGHT_BIRD,
    reading: "",
    paper_says: "Note that estimated parameters converge to their true values with reasonably small estimation error.",
    size: SIZE,
    stream: 0,
}];

pub(super) const GLIDER: [PaperFigure; 2] = [
    GLIDER_OF_TEXT,
    PaperFigure {
        poses: "fig5-caption",
        parameters: "fig6-caption",
        experiment: PaperExperiment::GLIDER_OF_CAPTION,
        reading: " The paper gives the glider's b as (0, 4) in the text and as (4, 0) in the caption of Fig. 6, and \
                  nothing decides between them: this is the caption's.",
        stream: 2,
        ..GLIDER_OF_TEXT
    },
];

const GLIDER_OF_TEXT: PaperFigure = PaperFigure {
    poses: "fig5-text",
    parameters: "fig6-text",
    poses_heading: "Fig. 5: a glider and its rigid motion, by the text and by the caption of Fig. 6",
    parameters_heading: "Fig. 6: the parameters of the glider, by the text and by the caption",
    experiment: PaperExperiment::GLIDER_OF_TEXT,
    reading: " The paper gives the glider's b as (0, 4) in the text and as (4, 0) in the caption of Fig. 6, and \
              nothing decides between them: this is the text's.",
    paper_says: "Note again that estimates converge to their true values in a relatively short time interval with a \
                 relatively small estimation error.",
    size: SIZE,
    stream: 1,
};

pub(super) const PHONE: [PaperFigure; 1] = [PaperFigure {
    poses: "fig7",
    parameters: "fig8",
    poses_heading: "Fig. 7: a cellular phone and its rigid motion",
    parameters_heading: "Fig. 8: the parameters of the cellular phone",
    experiment: PaperExperiment::CELLULAR_PHONE,
    reading: "",
    paper_says: "Notice the quick convergence and small estimation errors.",
    size: SIZE_OF_PHONE,
    stream: 3,
}];
