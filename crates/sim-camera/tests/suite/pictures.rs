use freeform_sim_camera::{PictureScene, Rendering, SimulatedPictures};

/// Without noise or shading, bodies 100 lighter than a ground of 50.
fn clean(scene: PictureScene) -> SimulatedPictures {
    let rendering = Rendering { ground: 50.0, contrast: 100.0, blur: 0.0, noise: 0.0, ..Rendering::default() };
    let pictures = SimulatedPictures::new(scene, 3, 30.0, 1.0).expect("a sequence");
    pictures.with_rendering(rendering).expect("a rendering")
}

/// Area in pixels and middle, y upwards, of what is lighter than the ground.
fn light(grey: &[u8]) -> (f64, [f64; 2]) {
    let shares = grey.iter().map(|grey| (f64::from(*grey) - 50.0) / 100.0);
    let (mut area, mut x, mut y) = (0.0, 0.0, 0.0);
    for (index, share) in shares.enumerate() {
        area += share;
        x += share * ((index % 640) as f64 + 0.5);
        y += share * (480.0 - (index / 640) as f64 - 0.5);
    }
    (area, [x / area, y / area])
}

#[test]
fn the_middle_of_what_is_seen_is_that_of_the_truth() {
    for scene in [PictureScene::Coin, PictureScene::AcceleratingL] {
        for picture in clean(scene).iter().step_by(7) {
            let (_, middle) = light(&picture.grey);
            let truth = picture.bodies[0].middle;
            for axis in [0, 1] {
                assert!((middle[axis] - truth[axis]).abs() < 0.02, "{scene:?}: {middle:?} {truth:?}");
            }
        }
    }
}

#[test]
fn holes_show_the_ground_and_take_their_area_away() {
    let area = |scene| light(&clean(scene).iter().next().expect("a picture").grey).0;
    let (marked, plain) = (area(PictureScene::MarkedDiscs), area(PictureScene::Discs));
    let share = 1.0 - 0.24_f64.powi(2) - 0.15_f64.powi(2);
    assert!((marked / plain - share).abs() < 1e-3, "{marked} {plain}");
}

#[test]
fn a_disc_rolls_without_slipping_and_a_step_of_the_path_is_its_velocity() {
    let pictures: Vec<_> = clean(PictureScene::Discs).iter().collect();
    for body in 0..2 {
        let [first, second] = [&pictures[0].bodies[body], &pictures[1].bodies[body]];
        let radius = [62.0, 48.0][body];
        assert!((first.velocity[0] - first.omega * radius).abs() < 1e-9);
        assert!((second.middle[0] - first.middle[0] - first.velocity[0] / 30.0).abs() < 1e-9);
        assert!((second.angle - first.angle - first.omega / 30.0).abs() < 1e-9);
    }
}

#[test]
fn noise_blur_shading_shadow_and_line_do_what_they_say() {
    let first = |rendering: Rendering| {
        let pictures = SimulatedPictures::new(PictureScene::AcceleratingL, 3, 30.0, 0.1).expect("a sequence");
        pictures.with_rendering(rendering).expect("a rendering").iter().next().expect("a picture").grey
    };
    let plain = Rendering { ground: 100.0, contrast: 80.0, blur: 0.0, noise: 0.0, ..Rendering::default() };
    let is_between = |grey: &[u8]| grey.iter().filter(|grey| (101..180).contains(*grey)).count();
    let sharp = is_between(&first(plain));
    assert!(is_between(&first(Rendering { blur: 2.0, ..plain })) > 3 * sharp);
    // The upper left corner is ground.
    let corner = |grey: &[u8]| {
        let values = (0..40).flat_map(|row| &grey[row * 640..row * 640 + 40]).map(|grey| f64::from(*grey));
        let values: Vec<f64> = values.collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        (mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt())
    };
    let (_, spread) = corner(&first(Rendering { noise: 4.0, ..plain }));
    assert!((spread - 4.0).abs() < 0.4, "{spread}");
    let shaded = first(Rendering { shading: 0.5, ..plain });
    assert!((f64::from(shaded[0]) - f64::from(shaded[639]) - 40.0).abs() <= 1.0);
    assert!(first(Rendering { shadow: 0.4, ..plain }).iter().any(|grey| *grey < 70));
    let outlined = first(Rendering { line: 4.0, contrast: -80.0, ..plain });
    let filled = first(Rendering { contrast: -80.0, ..plain });
    let dark = |grey: &[u8]| grey.iter().filter(|grey| **grey < 60).count();
    assert!(dark(&outlined) > 500 && 4 * dark(&outlined) < dark(&filled), "{} {}", dark(&outlined), dark(&filled));
}

#[test]
fn what_moves_while_the_shutter_is_open_is_a_mean_of_its_light_and_no_more_of_it() {
    let picture = |rendering: Rendering, rate: f64, index: usize| {
        let pictures = SimulatedPictures::new(PictureScene::AcceleratingL, 3, rate, 3.0 / rate).expect("a sequence");
        pictures.with_rendering(rendering).expect("a rendering").iter().nth(index).expect("a picture").grey
    };
    let first = |rendering: Rendering| picture(rendering, 10.0, 2);
    let plain = Rendering { ground: 100.0, contrast: 80.0, blur: 0.0, noise: 0.0, ..Rendering::default() };
    let (sharp, blurred) = (first(plain), first(Rendering { exposure: 0.1, ..plain }));
    let between = |grey: &[u8]| grey.iter().filter(|grey| (105..175).contains(*grey)).count();
    assert!(between(&blurred) > 2 * between(&sharp), "{} {}", between(&blurred), between(&sharp));
    // Of a turn with acceleration the middle of the exposure is not quite where the mean is.
    let light = |grey: &[u8]| grey.iter().map(|grey| f64::from(*grey) - 100.0).sum::<f64>();
    assert!((light(&blurred) / light(&sharp) - 1.0).abs() < 2e-3, "{} {}", light(&blurred), light(&sharp));
    let as_cameras_do = first(Rendering { exposure: 0.1, gamma: 2.2, ..plain });
    let [least, most] = [as_cameras_do.iter().min(), as_cameras_do.iter().max()];
    assert_eq!((least, most), (Some(&100), Some(&180)));
    let decoded: Vec<f64> = as_cameras_do.iter().map(|grey| (f64::from(*grey) / 255.0).powf(2.2)).collect();
    let [ground, body] = [100.0_f64, 180.0].map(|grey| (grey / 255.0).powf(2.2));
    let share = |shares: &[f64]| shares.iter().sum::<f64>();
    let of_light: Vec<f64> = decoded.iter().map(|light| (light - ground) / (body - ground)).collect();
    let of_grey: Vec<f64> = blurred.iter().map(|grey| (f64::from(*grey) - 100.0) / 80.0).collect();
    assert!((share(&of_light) / share(&of_grey) - 1.0).abs() < 2e-3, "{} {}", share(&of_light), share(&of_grey));
    assert!(light(&as_cameras_do) > 1.01 * light(&blurred), "it seems to be larger");
    // In some turns the L comes back to where it began, or near, and is blurred all the same.
    let turned = picture(Rendering { exposure: 10.0, ..plain }, 0.1, 0);
    let faint = |grey: &[u8]| grey.iter().filter(|grey| (102..150).contains(*grey)).count();
    assert!(faint(&turned) > 10 * faint(&sharp), "{} {}", faint(&turned), faint(&sharp));
    let refused = |rendering: Rendering| {
        let pictures = SimulatedPictures::new(PictureScene::Gear, 3, 30.0, 0.1).expect("a sequence");
        pictures.with_rendering(rendering).expect_err("out of range").to_string()
    };
    for exposure in [-0.1, 0.034, f64::NAN, f64::INFINITY] {
        assert!(refused(Rendering { exposure, ..plain }).contains("exposure"));
    }
    for gamma in [0.0, -1.0, f64::NAN] {
        assert!(refused(Rendering { gamma, ..plain }).contains("gamma"));
    }
}

#[test]
fn the_same_seed_gives_the_same_pictures_and_names_read_back() {
    for scene in PictureScene::ALL {
        assert_eq!(scene.name().parse(), Ok(scene));
        let of = |seed| {
            let pictures = SimulatedPictures::new(scene, seed, 30.0, 0.1).expect("a sequence");
            pictures.iter().last().expect("a picture")
        };
        assert_eq!(of(5), of(5));
        assert_ne!(of(5).grey, of(6).grey);
    }
    assert!("pentagon".parse::<PictureScene>().expect_err("no scene").to_string().contains("accelerating-l"));
}
