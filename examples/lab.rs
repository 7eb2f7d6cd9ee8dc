use freeform_motion::{
    Pipeline, PipelineSettings, identify::AdaptiveLaw,
    riccati::{AffineMotion, MotionModel},
    decompose::rotation_chart,
    sim_camera::*,
};
fn main() {
    let name = std::env::args().nth(1).unwrap();
    let noise: f64 = std::env::args().nth(2).unwrap().parse().unwrap();
    let mut s = PipelineSettings::for_model(MotionModel::Affine);
    s.identify.law = AdaptiveLaw::FilteredLeastSquares;
    let simulation = Settings { length: SequenceLength::Seconds(4.0), seed: 1, noise, ..Settings::default() };
    let scene = Scene::new(name.parse::<BuiltInShape>().unwrap(), AffineMotion { a1: 0.05, a2: 1.2, a3: -1.7, a4: -0.08, b1: -0.3, b2: 0.4 }, Camera::default());
    let mut p = Pipeline::new(s).unwrap();
    let mut order = [0, 1];
    for f in &Simulator::new(scene, simulation).unwrap() {
        match p.push(f.time, &f.outline) {
            Ok(r) => {
                let work = freeform_motion::decompose::Decomposition::of(r.fit.working()).unwrap();
                if let Some(c) = &r.correspondence { order = order.map(|o| c.permutation()[o]); }
                let pairs: Vec<_> = work.conjugate_pairs(4).map(|l| rotation_chart(l.l)).map(|w| format!("{:.3} {:6.1}", w.norm(), w.arg().to_degrees())).collect();
                let img: Vec<_> = r.decomposition.conjugate_pairs(4).map(|l| rotation_chart(l.l)).map(|w| format!("{:.3} {:6.1}", w.norm(), w.arg().to_degrees())).collect();
                let c = r.correspondence.map(|c| (c.decided_by(), c.ordering_margin(), c.continuity_cost(), c.runner_up_cost(), c.agrees()));
                println!("{:.3} {order:?} work {pairs:?} image {img:?} {c:?} act {}", f.time, r.fit.diagnostics().constraint_active);
            }
            Err(e) => println!("{e}"),
        }
    }
    println!("{:?} {:?}", p.estimate().map(|e| e.values().to_vec()), p.warnings());
}
