//! How often outlines are recognised under random affine maps, beside Hu's and affine moment invariants: the tables of docs/recognition.md.
//!
//! ```text
//! cargo run --release -p freeform-recognise --example confusion -- [key=value ...] [mask.png ...]
//! ```
//!
//! Keys: `noise` (of points of unit-size objects), `frames` (of one object), `trials` (per outline), `seed`, `points`. Every frame is
//! seen under a map of its own: I + U(-0.35, 0.35), any turn, a reflection in half of the trials. The known outlines are the built-in
//! shapes and the masks given, without noise. For the unknown, the outline shown and those that are affinely the same are taken
//! from the known ones. Below the table: how far different outlines are from each other, brought onto each other without noise.
mod moments;

use std::{collections::BTreeMap, error::Error, path::Path};

use freeform_curve_fit::Outline;
use freeform_outline_io::read_shape;
use freeform_recognise::{Comparison, Evidence, RecogniseSettings, Recogniser};
use freeform_sim_camera::{BuiltInShape, Shape};
use nalgebra::{Matrix2, Point2, Rotation2, Vector2};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// Outlines that an affine map takes to each other.
const SAME: [&[&str]; 2] = [&["circle", "ellipse"], &["cd_box", "square"]];

struct Study {
    noise: f64,
    frames: usize,
    trials: usize,
    points: usize,
    seed: u64,
    shapes: Vec<Shape>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut study = Study { noise: 0.001, frames: 1, trials: 20, points: 400, seed: 1, shapes: Vec::new() };
    study.shapes = BuiltInShape::ALL.into_iter().map(BuiltInShape::shape).collect();
    for argument in std::env::args().skip(1) {
        match argument.split_once('=') {
            Some(("noise", value)) => study.noise = value.parse()?,
            Some(("frames", value)) => study.frames = value.parse()?,
            Some(("trials", value)) => study.trials = value.parse()?,
            Some(("points", value)) => study.points = value.parse()?,
            Some(("seed", value)) => study.seed = value.parse()?,
            Some((key, _)) => return Err(format!("no setting {key:?}").into()),
            None => study.shapes.push(mask(Path::new(&argument))?),
        }
    }
    study.run()
}

/// What became of the trials of one outline.
#[derive(Default)]
struct Row {
    trials: usize,
    right: usize,
    none: usize,
    /// Named though it was not among the known.
    unknown_named: usize,
    by_hu: usize,
    by_affine_moments: usize,
    /// Names that were wrong: by this crate, by Hu's invariants, by affine moments.
    wrong: [BTreeMap<String, usize>; 3],
}

impl Study {
    fn run(&self) -> Result<(), Box<dyn Error>> {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        let mut recogniser = Recogniser::new(RecogniseSettings::default())?;
        let (mut hu, mut affine) = (Vec::new(), Vec::new());
        for shape in &self.shapes {
            let points = shape.sample(self.points, 0.0);
            hu.push(moments::hu(&points));
            affine.push(moments::affine(&points));
            recogniser.learn(shape.name(), &Outline::closed(points)?)?;
        }
        println!("| outline | right | none | wrong | named though unknown | Hu right | affine moments right |");
        println!("|---|---|---|---|---|---|---|");
        let mut total = Row::default();
        for (index, shape) in self.shapes.iter().enumerate() {
            let mut row = Row::default();
            for _ in 0..self.trials {
                let (mut evidence, mut without) = (Evidence::new(), Evidence::new());
                let mirrored = rng.random::<bool>();
                let mut last = Vec::new();
                for _ in 0..self.frames {
                    last = self.seen(shape, mirrored, &mut rng);
                    let comparisons = recogniser.compare(&Outline::closed(last.clone())?)?;
                    evidence.add(&comparisons);
                    without.add(&self.without(index, &comparisons));
                }
                row.trials += 1;
                let named = |evidence: &Evidence| evidence.recognition(recogniser.settings()).and_then(|r| r.known);
                match named(&evidence) {
                    Some(known) => row.count(0, self.is_same(known, index), self.shapes[known].name()),
                    None => row.none += 1,
                }
                row.unknown_named += usize::from(named(&without).is_some());
                let by_hu = moments::nearest(&hu, &moments::hu(&last));
                row.count(1, self.is_same(by_hu, index), self.shapes[by_hu].name());
                let by_affine = moments::nearest(&affine, &moments::affine(&last));
                row.count(2, self.is_same(by_affine, index), self.shapes[by_affine].name());
            }
            row.print(shape.name());
            total.add(&row);
        }
        total.print("all");
        let distances = self.distances()?;
        let share = |percent: usize| distances[(distances.len() - 1) * percent / 100];
        println!();
        println!(
            "Distances of different outlines brought onto each other, in disc radii: {:.3} at least, 5, 50 and 95 % below \
             {:.3}, {:.3} and {:.3}",
            share(0),
            share(5),
            share(50),
            share(95)
        );
        Ok(())
    }

    /// Root mean square distances of every two different outlines, without noise, the smallest first.
    fn distances(&self) -> Result<Vec<f64>, Box<dyn Error>> {
        let sampled = |shape: &Shape| Outline::closed(shape.sample(self.points, 0.0));
        let mut distances = Vec::new();
        for (a, known) in self.shapes.iter().enumerate() {
            // The only one that is known is always brought onto the outline seen, whatever the invariants say.
            let mut recogniser = Recogniser::new(RecogniseSettings::default())?;
            recogniser.learn(known.name(), &sampled(known)?)?;
            for seen in (0..self.shapes.len()).filter(|b| !self.is_same(a, *b)) {
                let comparisons = recogniser.compare(&sampled(&self.shapes[seen])?)?;
                distances.extend(comparisons.iter().filter_map(|comparison| Some(comparison.fit?.distance)));
            }
        }
        distances.sort_by(f64::total_cmp);
        Ok(distances)
    }

    /// A frame: points drawn from any place on, moved by a random map, and noise.
    fn seen(&self, shape: &Shape, mirrored: bool, rng: &mut ChaCha8Rng) -> Vec<Point2<f64>> {
        let mut uniform = |limit: f64| limit * (2.0 * rng.random::<f64>() - 1.0);
        let stretch = Matrix2::identity() + Matrix2::from_fn(|_, _| uniform(0.35));
        let mirror = Matrix2::new(if mirrored { -1.0 } else { 1.0 }, 0.0, 0.0, 1.0);
        let linear = stretch * Rotation2::new(uniform(std::f64::consts::PI)) * mirror;
        let shift = Vector2::new(uniform(5.0), uniform(5.0));
        let points = shape.sample(self.points, 0.5 + uniform(0.5));
        points.into_iter().map(|p| Point2::from(linear * p.coords + shift) + self.noise * normal(rng)).collect()
    }

    /// The comparisons less those with an outline and what is affinely the same.
    fn without(&self, index: usize, comparisons: &[Comparison]) -> Vec<Comparison> {
        let strip = |c: &Comparison| match self.is_same(c.known, index) {
            true => Comparison { invariant_distance: None, fit: None, ..*c },
            false => *c,
        };
        comparisons.iter().map(strip).collect()
    }

    fn is_same(&self, a: usize, b: usize) -> bool {
        let [a, b] = [a, b].map(|index| self.shapes[index].name());
        a == b || SAME.iter().any(|group| group.contains(&a) && group.contains(&b))
    }
}

impl Row {
    fn count(&mut self, method: usize, is_right: bool, name: &str) {
        if is_right {
            *[&mut self.right, &mut self.by_hu, &mut self.by_affine_moments][method] += 1;
        } else {
            *self.wrong[method].entry(name.to_owned()).or_default() += 1;
        }
    }

    fn add(&mut self, other: &Self) {
        self.trials += other.trials;
        self.right += other.right;
        self.none += other.none;
        self.unknown_named += other.unknown_named;
        self.by_hu += other.by_hu;
        self.by_affine_moments += other.by_affine_moments;
        for (wrong, others) in self.wrong.iter_mut().zip(&other.wrong) {
            *wrong.entry("in all".to_owned()).or_default() += others.values().sum::<usize>();
        }
    }

    fn print(&self, name: &str) {
        let percent = |count: usize| format!("{:.1}", 100.0 * count as f64 / self.trials as f64);
        let wrong = |method: usize| {
            let names: Vec<String> = self.wrong[method].iter().map(|(name, count)| format!("{name} {count}")).collect();
            names.join(", ")
        };
        println!(
            "| {name} | {} | {} | {} | {} | {} ({}) | {} ({}) |",
            percent(self.right),
            percent(self.none),
            wrong(0),
            percent(self.unknown_named),
            percent(self.by_hu),
            wrong(1),
            percent(self.by_affine_moments),
            wrong(2),
        );
    }
}

/// A pair of independent standard normal numbers (G. Box, M. Muller, 1958).
fn normal(rng: &mut ChaCha8Rng) -> Vector2<f64> {
    let radius = (-2.0 * (1.0 - rng.random::<f64>()).ln()).sqrt();
    let angle = std::f64::consts::TAU * rng.random::<f64>();
    Vector2::new(radius * angle.cos(), radius * angle.sin())
}

/// The outline of the object in a mask, at unit size; its name with a star.
fn mask(path: &Path) -> Result<Shape, Box<dyn Error>> {
    let points: Vec<_> = read_shape(path)?.points().copied().collect();
    let name = path.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
    Ok(Shape::from_polygon(&points)?.normalised().with_name(format!("{name}*")))
}
