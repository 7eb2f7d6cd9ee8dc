use freeform_riccati::{MotionModel, map_point};
use nalgebra::{Matrix3, Point2, Vector2};

use super::{
    Landmarks,
    near_symmetry::turns_of_near_symmetry,
    outlook::Outlook,
    refinement::{RegisteredPose, Steps, distances_in, few_of, middles, refined},
};
use crate::{
    track::{Track, turn_between, wrapped},
    tuning::{registration as tuning, symmetry as of_symmetry},
};

/// Where a search starts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Extent {
    /// From turns all around.
    Whole,
    /// From a part of these turns first, by the number of the frame since the object was lost; from the others only where the frame may show the
    /// object, as far as those say.
    Part(usize),
}

impl Extent {
    /// Whether the start from this one of all turns belongs to the part that is searched first.
    fn has_turn(self, number: usize) -> bool {
        match self {
            Self::Whole => true,
            // Parts that follow each other lie far apart.
            Self::Part(part) => number % tuning::PARTS == part * tuning::TO_NEXT_PART % tuning::PARTS,
        }
    }

    /// Deviation of few points, normalised, up to which the frame is searched from all turns. While an object is lost, frames that show others make
    /// more noise tolerated: what would need all of that, and more, is looked into in few of them.
    fn most_spread(self, track: &Track) -> f64 {
        let tolerated = track.most_noise_tolerated();
        match self {
            Self::Part(part) if !part.is_multiple_of(tuning::NOISY_SEARCHED) => {
                (tuning::HOPELESS * track.usual_noise_tolerated()).max(tolerated)
            }
            _ => tuning::HOPELESS * tolerated,
        }
    }
}

/// Rigid poses that bring the outline of a track onto the points of a frame, apart from those that a symmetry adds.
#[derive(Debug, Clone)]
pub(crate) struct Registration {
    rigid: Vec<RegisteredPose>,
    outlook: Outlook,
}

impl Registration {
    /// Searches with normalised points of a frame, from turns all around; `landmarks` are the related points of the track in its present pose,
    /// and those of the frame.
    pub(crate) fn search(
        track: &Track,
        points: &[Point2<f64>],
        landmarks: Option<[Landmarks; 2]>,
        extent: Extent,
    ) -> Self {
        let few = few_of(points);
        let further = |found: &RegisteredPose| refined(track, &few, MotionModel::Rigid, &found.pose, Steps::FURTHER);
        let outlook_by = |spread: f64| Outlook::of(track, points.len(), spread);
        let Starts { turns, told } = Starts::of(track, points, landmarks);
        let mut begun = Begun { track, few: &few, poses: Vec::with_capacity(turns.len() + told.len()) };
        // Asked for where it is needed: most frames of a lost object end with a part of the turns.
        let numbered = || {
            let is_promising = promising(track, &few, points.len(), &turns);
            turns.iter().enumerate().zip(is_promising).filter_map(|(start, is_promising)| is_promising.then_some(start))
        };
        match extent {
            Extent::Part(_) if turns.len() > 1 && Outlook::can_be_told(track, points.len()) => {
                told.iter().for_each(|start| begun.add(start));
                let of_part = turns.iter().enumerate().filter(|(i, _)| extent.has_turn(*i));
                of_part.for_each(|(_, start)| begun.add(start));
                if let Some(best) = begun.best_if_hopeless(extent.most_spread(track)) {
                    return Self { rigid: vec![best], outlook: Outlook::HopelessSoFar };
                }
                numbered().filter(|(i, _)| !extent.has_turn(*i)).for_each(|(_, start)| begun.add(start));
            }
            _ => numbered().map(|(_, start)| start).chain(&told).for_each(|start| begun.add(start)),
        }
        let mut begun = begun.poses;
        let least = begun.iter().map(|found| found.spread).fold(f64::INFINITY, f64::min);
        keep(&mut begun, tuning::SEARCHED_ON);
        let mut rigid = Vec::with_capacity(begun.len());
        // Where all are far off by now, it is enough that the best of them remains so.
        if outlook_by(least / tuning::MARGIN_BEFORE_LAST_STEPS) == Outlook::Hopeless {
            rigid.extend(begun.first().map(further));
            if rigid.first().is_some_and(|best: &RegisteredPose| outlook_by(best.spread) == Outlook::Hopeless) {
                return Self { rigid, outlook: Outlook::Hopeless };
            }
        }
        // Not again the one that has gone on already.
        rigid.extend(begun.iter().skip(rigid.len()).map(further));
        // Where ends are hidden, few points hardly tell how far a straight outline has gone along itself: such poses are kept apart. Those of a closed
        // outline, which shows all of its sides, lead to the same place.
        let slides = track.map().has_ends() && track.map().is_mostly_straight();
        let apart = if slides { tuning::SAME_BY_FEW } else { tuning::SAME_POSE };
        let mut rigid = distinct(rigid, apart);
        // Where it has hidden parts, few starts lead to a tooth of a gear, and those to any.
        let turns = turns_of_near_symmetry(track.model(), &rigid);
        if !turns.is_empty() {
            rigid.extend(turns.iter().map(|start| refined(track, &few, MotionModel::Rigid, start, Steps::FURTHER)));
            rigid = distinct(rigid, apart);
            // Few points have a handful on each tooth: they do not tell which of its turns a mark agrees with.
            rigid.iter_mut().for_each(|found| found.score_by(track, points));
        }
        keep(&mut rigid, tuning::REFINED);
        let outlook = rigid.first().map_or(Outlook::Open, |best| outlook_by(best.spread));
        if outlook == Outlook::Hopeless {
            rigid.truncate(1);
            return Self { rigid, outlook };
        }
        keep_near_best(&mut rigid, tuning::FAR_WORSE_BY_FEW);
        // Some come together only with all points: one taken twice would keep another out.
        let refine =
            |found: &RegisteredPose| refined(track, points, MotionModel::Rigid, &found.pose, Steps::REFINEMENT);
        rigid = distinct(rigid.iter().map(refine).collect(), tuning::SAME_POSE);
        keep(&mut rigid, tuning::KEPT);
        keep_near_best(&mut rigid, tuning::FAR_WORSE);
        Self { rigid, outlook }
    }

    /// Whether the frame shows something else, as far as a search with few of its points says. There is one pose then.
    pub(crate) fn is_hopeless(&self) -> bool {
        self.outlook != Outlook::Open
    }

    /// Whether it has gone no further than the part of the turns that were searched first. It is hopeless, and has the pose that comes nearest.
    pub(crate) fn is_of_part(&self) -> bool {
        self.outlook == Outlook::HopelessSoFar
    }

    /// Deviation of few points of the frame from the outline in the best pose, normalised; infinite where there is none.
    pub(crate) fn spread(&self) -> f64 {
        self.rigid.first().map_or(f64::INFINITY, |best| best.spread)
    }

    /// The poses of the track's model, at most four (eight with more parameters than rigid motion has), with the smallest turns either way of an
    /// outline with a symmetry of this order; the points are those of the search.
    pub(crate) fn poses(&self, track: &Track, points: &[Point2<f64>], symmetry: usize) -> Vec<RegisteredPose> {
        let (model, pose) = (track.model(), track.body_pose());
        let mut best = self.rigid.clone();
        if symmetry > 1 && self.outlook == Outlook::Open {
            add_turns_of_symmetry(&mut best, track, points, symmetry);
        }
        if model != MotionModel::Rigid {
            // More parameters start from fewer. They may also lead astray where arcs are missing, so that the rigid poses stay.
            let more = best.clone().into_iter().map(|found| {
                let models = MotionModel::ALL.into_iter().filter(|m| *m > MotionModel::Rigid && *m <= model);
                models.fold(found, |h, model| refined(track, points, model, &h.pose, Steps::REFINEMENT))
            });
            best.extend(more);
            best.retain(|h| h.score.is_finite());
        }
        for found in &mut best {
            // A start between middles slides along what the frame shows more of.
            found.pose = track.view().map.least_moved(model, pose, &found.pose);
            found.turn = track.turn_to(&found.pose);
        }
        best
    }
}

/// Searches with few points after their first steps; those that have come together are one.
struct Begun<'a> {
    track: &'a Track,
    few: &'a [Point2<f64>],
    poses: Vec<RegisteredPose>,
}

impl Begun<'_> {
    /// Begins one more, from a change of the present pose.
    fn add(&mut self, start: &Matrix3<f64>) {
        let found = refined(self.track, self.few, MotionModel::Rigid, &(start * self.track.body_pose()), Steps::FIRST);
        if !self.poses.iter().any(|other| (other.pose - found.pose).norm() < tuning::TOGETHER) {
            self.poses.push(found);
        }
    }

    /// The pose that the points deviate least from, if that is by more than a limit also where searches that come near it have gone on; `None`
    /// where one of them has come below it.
    fn best_if_hopeless(&self, limit: f64) -> Option<RegisteredPose> {
        let may_end = |found: &&RegisteredPose| found.spread <= tuning::MARGIN_BEFORE_LAST_STEPS * limit;
        let further =
            |found: &RegisteredPose| refined(self.track, self.few, MotionModel::Rigid, &found.pose, Steps::FURTHER);
        let ends: Vec<_> = self.poses.iter().filter(may_end).map(further).collect();
        let best = ends.iter().chain(&self.poses).min_by(|a, b| a.spread.total_cmp(&b.spread))?;
        (best.spread > limit).then_some(*best)
    }
}

/// Changes of the present pose that searches start from.
struct Starts {
    /// Turns about the centroids, all around.
    turns: Vec<Matrix3<f64>>,
    /// None at all, those that stretch the outline, and what related points tell.
    told: Vec<Matrix3<f64>>,
}

impl Starts {
    fn of(track: &Track, points: &[Point2<f64>], landmarks: Option<[Landmarks; 2]>) -> Self {
        let [body_centre, centre] = middles(track, points);
        // Of turns that make no difference the least is taken.
        let count = if track.turn_is_unseen() { 1 } else { tuning::TURNS };
        let turns = (0..count)
            .map(|i| turn_between(std::f64::consts::TAU * i as f64 / tuning::TURNS as f64, &body_centre, &centre))
            .collect();
        let mut told = Vec::new();
        if count > 1 {
            told.push(Matrix3::identity());
            told.extend(stretched_turns(track, &body_centre, &centre));
        }
        if let Some([before, after]) = landmarks.filter(|_| count > 1) {
            let ([a, b], [c, d]) = (before.normalised(track.reference()), after.normalised(track.reference()));
            for (c, d) in [(c, d), (d, c)] {
                let (from, to) = (b - a, d - c);
                let turn = from.perp(&to).atan2(from.dot(&to));
                let middle = |p: Point2<f64>, q: Point2<f64>| 0.5 * (p.coords + q.coords);
                told.push(turn_between(turn, &middle(a, b), &middle(c, d)));
            }
        }
        Self { turns, told }
    }
}

/// Which of some turns a search is begun from, of a frame with so many points: those by which few of its points lie nearest to the outline from
/// the beginning, and all that are hardly worse, as those of an outline are that is all but round. Of outlines with ends, and of few points,
/// nearness says too little, so that all are.
fn promising(track: &Track, few: &[Point2<f64>], points: usize, turns: &[Matrix3<f64>]) -> Vec<bool> {
    if turns.len() <= tuning::SEARCHED_FROM || points < tuning::ENOUGH_POINTS || track.map().has_ends() {
        return vec![true; turns.len()];
    }
    let distances = distances_in(track, few, turns.iter().map(|start| start * track.body_pose()));
    let mut ordered = distances.clone();
    ordered.sort_unstable_by(f64::total_cmp);
    let limit = ordered[tuning::SEARCHED_FROM - 1].max(tuning::TIE * ordered[0]);
    distances.iter().map(|distance| *distance <= limit).collect()
}

/// Of an outline whose shape may be stretched, and which is not as long as wide: turns of it as one that is, which may leave it as it is.
fn stretched_turns(track: &Track, from: &Vector2<f64>, to: &Vector2<f64>) -> Vec<Matrix3<f64>> {
    let (map, pose) = (track.view().map, track.body_pose());
    if map.stretch_ratio(pose) < tuning::STRETCHED {
        return Vec::new();
    }
    let Some(inverse) = pose.try_inverse() else { return Vec::new() };
    let turns = (1..tuning::TURNS).map(|i| std::f64::consts::TAU * i as f64 / tuning::TURNS as f64);
    let stretched = turns.filter_map(|angle| {
        let turn = pose * map.stretched_turn(angle)? * inverse;
        let shift = to - map_point(&turn, &Point2::from(*from)).coords;
        Some(Matrix3::new_translation(&shift) * turn)
    });
    stretched.collect()
}

/// Adds the smallest turns either way that look like the best of some poses.
fn add_turns_of_symmetry(best: &mut Vec<RegisteredPose>, track: &Track, points: &[Point2<f64>], symmetry: usize) {
    let Some(first) = best.first().copied() else { return };
    let symmetry_angle = std::f64::consts::TAU / symmetry as f64;
    let nearest = (first.turn / symmetry_angle).round();
    for step in -(of_symmetry::TRIED as i32)..=of_symmetry::TRIED as i32 {
        // From the turn nearest to none.
        let angle = symmetry_angle * (f64::from(step) - nearest);
        let turn = first.turn + angle;
        let is_there = |h: &RegisteredPose| wrapped(h.turn - turn).abs() < of_symmetry::SAME * symmetry_angle;
        if !best.iter().any(is_there) {
            let start = track.turned(&first.pose, angle);
            best.push(refined(track, points, MotionModel::Rigid, &start, Steps::REFINEMENT));
        }
    }
    best.retain(|h| h.score.is_finite());
}

/// The best of those that are the same, for each; those whose matrices differ by less than a distance are the same.
fn distinct(list: Vec<RegisteredPose>, distance: f64) -> Vec<RegisteredPose> {
    let mut best: Vec<RegisteredPose> = Vec::new();
    for found in list.into_iter().filter(|h| h.score.is_finite()) {
        match best.iter_mut().find(|other| same(other, &found, distance)) {
            Some(other) if other.score > found.score => *other = found,
            Some(_) => {}
            None => best.push(found),
        }
    }
    best
}

/// Keeps the best, so many, and as many of the smallest turns that are hardly worse: a symmetric outline has any number of equals.
fn keep(list: &mut Vec<RegisteredPose>, count: usize) {
    list.sort_by(|a, b| a.score.total_cmp(&b.score));
    let Some(limit) = list.first().map(|h| tuning::TIE * h.score) else { return };
    let rest = list.split_off(count.min(list.len()));
    let mut ties: Vec<_> = rest.into_iter().filter(|h| h.score <= limit).collect();
    ties.sort_by(|a, b| a.turn.abs().total_cmp(&b.turn.abs()));
    ties.truncate(count);
    list.append(&mut ties);
}

/// Keeps those, of which the best comes first, with scores of no more than so many times its own.
fn keep_near_best(list: &mut Vec<RegisteredPose>, times: f64) {
    if let Some(limit) = list.first().map(|best| times * best.score) {
        list.retain(|found| found.score <= limit);
    }
}

fn same(a: &RegisteredPose, b: &RegisteredPose, distance: f64) -> bool {
    wrapped(a.turn - b.turn).abs() < tuning::SAME_TURN && (a.pose - b.pose).norm() < distance
}

#[cfg(test)]
mod tests {
    use freeform_curve_fit::Outline;

    use super::*;
    use crate::{
        drawn_curves::{lobed, outline, polar},
        measurement::Frame,
    };

    /// A curve with three lobes, turned.
    fn shown(lobe: f64, turn: f64) -> Outline {
        outline(400, |t| polar(lobed(t, &[(3.0, [lobe, 0.0]), (2.0, [0.0, 0.1])]), t + turn))
    }

    #[test]
    fn other_outlines_are_hopeless_and_no_turn_of_its_own_is() {
        let mut frame = Frame::default();
        let track = Track::begin(MotionModel::Rigid, &shown(0.25, 0.0), 0.0, &mut frame).expect("a track");
        for step in 0..12 {
            let turn = std::f64::consts::TAU * f64::from(step) / 12.0 + 0.1;
            frame.load(&shown(0.25, turn), track.reference());
            let found = Registration::search(&track, &frame.points, None, Extent::Whole);
            assert!(!found.is_hopeless(), "{turn}");
            let best = found.rigid[0];
            assert!(wrapped(best.turn - turn).abs() < 0.01, "{turn}: {best:?}");
            frame.load(&shown(-0.1, turn), track.reference());
            let other = Registration::search(&track, &frame.points, None, Extent::Whole);
            assert!(other.is_hopeless() && other.rigid.len() == 1, "{turn}: {other:?}");
        }
    }

    #[test]
    fn parts_of_the_turns_that_follow_each_other_find_what_all_of_them_do_and_end_early_elsewhere() {
        let mut frame = Frame::default();
        let track = Track::begin(MotionModel::Rigid, &shown(0.25, 0.0), 0.0, &mut frame).expect("a track");
        let parts = || (0..tuning::PARTS).map(Extent::Part);
        for number in 0..tuning::TURNS {
            assert_eq!(parts().filter(|part| part.has_turn(number)).count(), 1, "{number}");
        }
        let mut longest = 0;
        for step in 0..12 {
            let turn = std::f64::consts::TAU * f64::from(step) / 12.0 + 0.1;
            frame.load(&shown(0.25, turn), track.reference());
            let whole = Registration::search(&track, &frame.points, None, Extent::Whole).rigid[0];
            let found: Vec<_> = parts().map(|part| Registration::search(&track, &frame.points, None, part)).collect();
            assert!(found.iter().all(|found| found.is_of_part() == found.is_hopeless()), "{turn}: {found:?}");
            for found in found.iter().filter(|found| !found.is_of_part()) {
                assert!((found.rigid[0].pose - whole.pose).norm() < 1e-6, "{turn}: {found:?} {whole:?}");
            }
            longest = found.iter().position(|found| !found.is_of_part()).expect("a part that finds it").max(longest);
            frame.load(&shown(-0.1, turn), track.reference());
            for part in parts() {
                let other = Registration::search(&track, &frame.points, None, part);
                assert!(other.is_of_part() && other.rigid.len() == 1, "{turn}: {other:?}");
            }
        }
        assert!(longest <= 3, "{longest}");
    }

    #[test]
    fn searches_begin_from_the_turns_on_either_side_of_that_of_a_frame_and_not_from_all() {
        let mut frame = Frame::default();
        let notched = |turn: f64| outline(400, |t| polar(if t < 0.3 { 0.9 } else { 1.0 }, t + turn));
        let shapes: [&dyn Fn(f64) -> Outline; 2] = [&|turn| shown(0.25, turn), &notched];
        for (shape, number) in shapes.into_iter().flat_map(|shape| (0..tuning::TURNS).map(move |i| (shape, i))) {
            let turn = std::f64::consts::TAU * number as f64 / tuning::TURNS as f64 + 0.1;
            let track = Track::begin(MotionModel::Rigid, &shape(0.0), 0.0, &mut frame).expect("a track");
            frame.load(&shape(turn), track.reference());
            let turns = Starts::of(&track, &frame.points, None).turns;
            let is_begun = promising(&track, &few_of(&frame.points), frame.points.len(), &turns);
            assert!(is_begun[number] && is_begun[(number + 1) % tuning::TURNS], "{number}: {is_begun:?}");
            let count = is_begun.iter().filter(|begun| **begun).count();
            assert!((tuning::SEARCHED_FROM..tuning::TURNS).contains(&count), "{number}: {is_begun:?}");
        }
    }
}
