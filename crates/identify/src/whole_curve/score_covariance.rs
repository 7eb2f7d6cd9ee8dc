//! How certain pose and motion are: the covariance of the scores that the frames really had, beside the information that the
//! least-squares problem takes itself to have.
use nalgebra::{SMatrix, SVector};

use crate::{
    estimate::MAX_PARAMETERS,
    motion_algebra::{CoordinateMatrix, Coordinates},
};

const STATE: usize = 2 * MAX_PARAMETERS;
/// Covariance of pose and motion; rows and columns beyond twice the number of parameters are zero.
pub(super) type PoseMotionCovariance = [[f64; STATE]; STATE];

/// Frames that the noise along the normals counts for as a source of the score covariance.
const PRIOR_FRAMES: f64 = 4.0;

/// Pose and motion with the curve given, whose error is that of the pose in the first frame. Two matrices go along with the motion:
/// `L = sum H' S H`, the information if residuals were independent noise, and `O = sum H' C H`, the covariance of the scores; the
/// covariance of the estimate is `L^-1 O L^-1` (the sandwich of Huber 1967). C per frame is taken from the scores after the
/// update and what the update took from them, so that the misfit of the curve, which is the same in every frame and adds nothing to
/// the scores, is not taken for noise.
#[derive(Debug, Clone)]
pub(super) struct ScoreCovariance {
    k: usize,
    information: PoseMotionCovariance,
    scores: PoseMotionCovariance,
    /// Sum of the products of scores per point, and the frames it came from.
    products: CoordinateMatrix,
    frames: f64,
    /// Mean square of the noise along the normals, body lengths, and the frames it came from.
    noise: f64,
    noise_frames: f64,
    offset: f64,
    /// Information on pose and motion before any frame: next to nothing.
    prior: f64,
    /// Covariance of a score over its information, on the whole.
    pub(super) ratio: f64,
}

impl ScoreCovariance {
    pub(super) fn new(k: usize, offset: f64, prior: f64) -> Self {
        let mut new = Self {
            k,
            information: [[0.0; STATE]; STATE],
            scores: [[0.0; STATE]; STATE],
            products: [[0.0; MAX_PARAMETERS]; MAX_PARAMETERS],
            frames: 0.0,
            noise: 0.0,
            noise_frames: 0.0,
            offset,
            prior,
            ratio: 0.0,
        };
        new.forget_motion();
        new
    }

    /// Forgets pose and motion, keeps what is known of the noise.
    pub(super) fn forget_motion(&mut self) {
        self.information = [[0.0; STATE]; STATE];
        self.scores = [[0.0; STATE]; STATE];
        for i in 0..2 * self.k {
            self.information[i][i] = self.prior;
            self.scores[i][i] = self.prior * self.ratio;
        }
    }

    /// Takes in one frame's standard deviation of the noise along the normals, body lengths.
    pub(super) fn take_noise(&mut self, sigma: f64) {
        self.noise_frames += 1.0;
        self.noise += (sigma * sigma - self.noise) / self.noise_frames;
    }

    /// Frames that the noise along the normals is known from.
    pub(super) fn noise_frames(&self) -> f64 {
        self.noise_frames
    }

    /// Standard deviation of the noise along the normals, body lengths.
    pub(super) fn noise(&self) -> f64 {
        self.noise.sqrt()
    }

    /// Covariance of the score of a frame with pose information `s`. Noise moves the three levels of a point together: f changes by
    /// noise / c in each, so that their sum has nine times the variance where S has three.
    fn score_covariance(&self, s: &CoordinateMatrix, points: f64) -> CoordinateMatrix {
        let by_noise = 3.0 * self.noise / (self.offset * self.offset);
        let weight = 1.0 / (PRIOR_FRAMES + self.frames);
        let mut c = [[0.0; MAX_PARAMETERS]; MAX_PARAMETERS];
        for i in 0..self.k {
            for j in 0..self.k {
                c[i][j] = weight * (PRIOR_FRAMES * by_noise * s[i][j] + points * self.products[i][j]);
            }
        }
        c
    }

    /// Moves on: an error of the motion becomes one of the pose, `pose <- pose + C motion`; variances of the motion in the units of
    /// its square are added.
    pub(super) fn predict(&mut self, by_motion: &CoordinateMatrix, added: Option<&Coordinates>) {
        match self.k {
            3 => self.predict_sized::<3, 6>(by_motion, added),
            4 => self.predict_sized::<4, 8>(by_motion, added),
            6 => self.predict_sized::<6, 12>(by_motion, added),
            _ => self.predict_sized::<8, 16>(by_motion, added),
        }
    }

    fn predict_sized<const K: usize, const D: usize>(
        &mut self,
        by_motion: &CoordinateMatrix,
        added: Option<&Coordinates>,
    ) {
        let mut back = SMatrix::<f64, D, D>::identity();
        for i in 0..K {
            (0..K).for_each(|j| back[(i, K + j)] = -by_motion[i][j]);
        }
        let (mut l, mut o) = (sized::<D>(&self.information), sized::<D>(&self.scores));
        l = back.transpose() * l * back;
        o = back.transpose() * o * back;
        if let Some(added) = added
            && self.ratio > 0.0
            && let Some(inverse) = inverse(&l)
        {
            let mut noise = SMatrix::<f64, D, D>::zeros();
            (0..K).for_each(|i| noise[(K + i, K + i)] = added[i]);
            if let Some(wider) = self::inverse(&(inverse + noise / self.ratio)) {
                o = wider * (inverse * o * inverse + noise) * wider;
                l = wider;
            }
        }
        store(&l, &mut self.information);
        store(&o, &mut self.scores);
    }

    /// Covariance of pose and motion as they are known now; `None` where it cannot be computed.
    pub(super) fn covariance(&self) -> Option<PoseMotionCovariance> {
        match self.k {
            3 => self.covariance_sized::<6>(),
            4 => self.covariance_sized::<8>(),
            6 => self.covariance_sized::<12>(),
            _ => self.covariance_sized::<16>(),
        }
    }

    fn covariance_sized<const D: usize>(&self) -> Option<PoseMotionCovariance> {
        let inverse = inverse(&sized::<D>(&self.information))?;
        let mut covariance = [[0.0; STATE]; STATE];
        store(&(inverse * sized::<D>(&self.scores) * inverse), &mut covariance);
        Some(covariance)
    }

    /// Squared innovation of a score in units of the covariance predicted for it.
    pub(super) fn innovation(&self, s: &CoordinateMatrix, points: f64, score: &Coordinates) -> f64 {
        match self.k {
            3 => self.innovation_sized::<3, 6>(s, points, score),
            4 => self.innovation_sized::<4, 8>(s, points, score),
            6 => self.innovation_sized::<6, 12>(s, points, score),
            _ => self.innovation_sized::<8, 16>(s, points, score),
        }
    }

    fn innovation_sized<const K: usize, const D: usize>(
        &self,
        s: &CoordinateMatrix,
        points: f64,
        score: &Coordinates,
    ) -> f64 {
        let Some(inverse) = inverse(&sized::<D>(&self.information)) else { return 0.0 };
        let covariance = inverse * sized::<D>(&self.scores) * inverse;
        let pose = SMatrix::<f64, K, K>::from_fn(|i, j| covariance[(i, j)]);
        let s_matrix = SMatrix::<f64, K, K>::from_fn(|i, j| s[i][j]);
        let own = self.score_covariance(s, points);
        let whole = SMatrix::<f64, K, K>::from_fn(|i, j| own[i][j]) + s_matrix * pose * s_matrix;
        let score = SVector::<f64, K>::from_fn(|i, _| score[i]);
        self::inverse(&whole).map_or(0.0, |inverse| (score.transpose() * inverse * score).x)
    }

    /// Takes a frame with pose information `s`. `left` is its score after the update where it should be learnt from.
    pub(super) fn update(&mut self, s: &CoordinateMatrix, points: f64, left: Option<&Coordinates>) {
        let c = self.score_covariance(s, points);
        for i in 0..self.k {
            for j in 0..self.k {
                self.information[i][j] += s[i][j];
                self.scores[i][j] += c[i][j];
            }
        }
        if let Some(left) = left {
            self.learn(s, points, left);
        }
        let trace = |m: &CoordinateMatrix| (0..self.k).map(|i| m[i][i]).sum::<f64>();
        let (before, now) = (trace(&c), trace(&self.score_covariance(s, points)));
        if self.ratio == 0.0 {
            (0..2 * self.k).for_each(|i| self.scores[i][i] += self.prior * before / trace(s));
        }
        self.ratio = now / trace(s);
        // The size that is known now goes for the frames before as well.
        if before > 0.0 && now.is_finite() {
            self.scores.iter_mut().flatten().for_each(|e| *e *= now / before);
        }
    }

    /// A score after the update has the covariance C - S P S, P being the covariance of the pose.
    fn learn(&mut self, s: &CoordinateMatrix, points: f64, left: &Coordinates) {
        let Some(covariance) = self.covariance() else { return };
        self.frames += 1.0;
        for i in 0..self.k {
            for j in 0..self.k {
                let taken: f64 =
                    (0..self.k).map(|m| (0..self.k).map(|n| s[i][m] * covariance[m][n] * s[n][j]).sum::<f64>()).sum();
                self.products[i][j] += (left[i] * left[j] + taken) / points;
            }
        }
    }
}

fn sized<const D: usize>(m: &PoseMotionCovariance) -> SMatrix<f64, D, D> {
    SMatrix::from_fn(|i, j| m[i][j])
}

fn store<const D: usize>(m: &SMatrix<f64, D, D>, to: &mut PoseMotionCovariance) {
    for i in 0..D {
        (0..D).for_each(|j| to[i][j] = 0.5 * (m[(i, j)] + m[(j, i)]));
    }
}

/// Inverse of a positive definite matrix, scaled to unit diagonal on the way.
fn inverse<const D: usize>(m: &SMatrix<f64, D, D>) -> Option<SMatrix<f64, D, D>> {
    let scale = SVector::<f64, D>::from_fn(|i, _| if m[(i, i)] > 0.0 { 1.0 / m[(i, i)].sqrt() } else { 1.0 });
    let scaled = SMatrix::<f64, D, D>::from_fn(|i, j| m[(i, j)] * scale[i] * scale[j]);
    let inverse = (scaled + SMatrix::identity() * 1e-14).cholesky()?.inverse();
    Some(SMatrix::from_fn(|i, j| inverse[(i, j)] * scale[i] * scale[j]))
}
