//! The mechanisms of `docs/gallery`: each against its closed form, through positions at which other programs fail. The
//! committed films agree with `cargo fmu demo --gallery`.
#![allow(clippy::unwrap_used)]

use fmu_build::workspace::Workspace;
use fmu_studies::gallery;
use linkage_fmu::simulation::Simulation;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::Path;
use std::{env, fs, process};

type Point = [f64; 2];

/// Rounding of positions [m] and angles [rad]: the tables have errors of 1e-13 of the size.
const ROUNDING: f64 = 1e-12;
/// Largest size of a film [bytes].
const LARGEST: usize = 150_000;

/// Run a mechanism of the gallery for ten times its experiment, in steps that reach no position twice. `look` checks
/// each step.
fn run(name: &str, mut look: impl FnMut(&mut Simulation)) {
    let path = Workspace::locate().gallery().join(format!("{name}.json"));
    let mut simulation = Simulation::open(&fs::read_to_string(path).unwrap()).unwrap();
    simulation.initialize().unwrap();
    let span = 10.0 * simulation.model().experiment().stop_time;
    let kinetic = get(&mut simulation, "energy.kinetic").max(1.0);
    look(&mut simulation);
    while simulation.time() < span {
        simulation.step(span / 3141.6).unwrap();
        look(&mut simulation);
        assert!(get(&mut simulation, "energy.drift").abs() < 1e-9 * kinetic);
    }
}

fn get(simulation: &mut Simulation, name: &str) -> f64 {
    simulation.get(name).unwrap()
}

fn polar(length: f64, angle: f64) -> Point {
    [length * angle.cos(), length * angle.sin()]
}

fn plus([a, b]: Point, [c, d]: Point) -> Point {
    [a + c, b + d]
}

fn apart([a, b]: Point, [c, d]: Point) -> f64 {
    (a - c).hypot(b - d)
}

/// Difference of two angles without whole turns.
fn turned(a: f64, b: f64) -> f64 {
    let difference = (a - b).rem_euclid(TAU);
    difference.min(TAU - difference)
}

/// The two points with these distances from two other points: left and right of the line from the first to the second
/// point.
fn intersections(a: Point, from_a: f64, b: Point, from_b: f64) -> [Point; 2] {
    let d = apart(a, b);
    let along = (d * d + from_a * from_a - from_b * from_b) / (2.0 * d);
    let up = (from_a * from_a - along * along).max(0.0).sqrt();
    let [x, y] = [(b[0] - a[0]) / d, (b[1] - a[1]) / d];
    [up, -up].map(|up| [a[0] + along * x - up * y, a[1] + along * y + up * x])
}

/// Crank and rod have the length r: the slider is at 2 r cos(theta), on either side of the bearing.
#[test]
fn a_slider_crank_with_a_rod_as_long_as_the_crank() {
    const R: f64 = 0.2;
    // Reduced inertia: crank and rod of 1 kg, slider of 0.5 kg.
    let inertia = |theta: f64| {
        let (sin, cos) = theta.sin_cos();
        R * R * (1.0 / 3.0 + 1.0 / 12.0 + 2.25 * sin * sin + 0.25 * cos * cos + 0.5 * 4.0 * sin * sin)
    };
    let (mut first, mut flat, mut side) = (None, 0, 1.0);
    run("flat_slider_crank", |gear| {
        let [theta, rod, x] = ["crank.angle", "rod.angle", "guide.position"].map(|name| get(gear, name));
        let scale = 1.0 + theta.abs();
        assert!((x - 2.0 * R * theta.cos()).abs() < ROUNDING * scale, "{theta} {x}");
        assert!((rod + theta).abs() < ROUNDING * scale, "{theta} {rod}");
        let energy = 0.5 * inertia(theta) * get(gear, "crank.speed").powi(2);
        let start = *first.get_or_insert(energy);
        assert!((energy / start - 1.0).abs() < 1e-9);
        flat += i32::from(x * side < 0.0);
        side = x.signum();
    });
    // Two flat positions per turn, over ten turns.
    assert_eq!(flat, 20);
}

/// Three parallel cranks with their pins on one line: all have the same angle, which increases uniformly, and the rod
/// translates.
#[test]
fn three_cranks_on_a_rod_with_its_joints_in_line() {
    run("coupled_cranks", |cranks| {
        let exact = 1.0 + FRAC_PI_2 * cranks.time();
        for name in ["front.angle", "middle.angle", "rear.angle"] {
            let angle = get(cranks, name);
            assert!((angle - exact).abs() < ROUNDING * (1.0 + exact), "{name} = {angle}, {exact}");
        }
        assert!(get(cranks, "rod.angle").abs() < ROUNDING);
        let pin = [get(cranks, "pin.x"), get(cranks, "pin.y")];
        assert!(apart(pin, plus([0.6, 0.0], polar(0.25, exact))) < ROUNDING * exact);
    });
}

/// The knee connects three bodies. Its position follows from circles about the crank pin and the top joint. The ram is
/// below it.
#[test]
fn a_press_with_three_bodies_at_the_knee() {
    let mut straight = 0;
    let mut side = 1.0;
    run("toggle_press", |press| {
        let theta = get(press, "crank.angle");
        let [_, knee] = intersections(plus([-0.4, 0.3], polar(0.1, theta)), 0.41, [0.0, 0.6], 0.3);
        let actual = [get(press, "knee.x"), get(press, "knee.y")];
        // The circles intersect at an angle of at least 0.8 rad.
        assert!(apart(actual, knee) < 4.0 * ROUNDING * (1.0 + theta.abs()), "{actual:?} {knee:?}");
        let ram = knee[1] - (0.3 * 0.3 - knee[0] * knee[0]).sqrt();
        assert!((get(press, "guide.position") - ram).abs() < 4.0 * ROUNDING * (1.0 + theta.abs()));
        straight += i32::from(knee[0] * side < 0.0);
        side = knee[0].signum();
    });
    assert_eq!(straight, 20);
}

/// Crossing parallelogram with bars r and g: (g - r) sin(phi/2) cos(theta/2) + (g + r) cos(phi/2) sin(theta/2) = 0.
#[test]
fn a_crossing_parallelogram_stays_crossed() {
    const G: f64 = 0.4;
    const R: f64 = 0.2;
    let mut last = 0.0;
    run("antiparallelogram", |bars| {
        let [theta, phi] = ["crank.angle", "rocker.angle"].map(|name| get(bars, name));
        let (a, b) = (0.5 * theta, 0.5 * phi);
        let residual = (G - R) * b.sin() * a.cos() + (G + R) * b.cos() * a.sin();
        assert!(residual.abs() < ROUNDING * (1.0 + theta), "{theta} {phi} {residual:e}");
        // The bars turn in opposite directions, with equal numbers of turns.
        assert!(turned(theta, 0.0) + turned(phi, 0.0) > 0.0 && (theta + phi).abs() < PI, "{theta} {phi}");
        last = theta;
    });
    assert!(last > 9.5 * TAU, "{last}");
}

/// No bar rotates fully: crank or rocker has its extreme position when the other two bars are in line. The pin is at
/// one of two points, which change each time the coupler passes 180 degrees.
#[test]
fn a_four_bar_passes_180_degrees() {
    let (mut passed, mut side) = (0, 0.0);
    let mut both = [false; 2];
    run("through_180", |bars| {
        let [theta, phi] = ["crank.angle", "rocker.angle"].map(|name| get(bars, name));
        let (b, d) = (polar(0.3, theta), [0.5, 0.0]);
        let c = plus(d, polar(0.35, phi));
        // From either side: where one pair of circles touches, the other pair intersects.
        let by_crank = intersections(b, 0.25, d, 0.35).map(|point| apart(point, c));
        let by_rocker = intersections(c, 0.25, [0.0, 0.0], 0.3).map(|point| apart(point, b));
        let best = |of: [f64; 2]| of[0].min(of[1]);
        assert!(best(by_crank).min(best(by_rocker)) < 10.0 * ROUNDING, "{theta} {phi}");
        both[usize::from(by_crank[1] < by_crank[0])] = true;
        let coupler = get(bars, "coupler.angle");
        assert!(apart(plus(b, polar(0.25, coupler)), c) < ROUNDING);
        let now = (coupler - phi).sin();
        passed += i32::from(now * side < 0.0);
        side = now;
        assert!((FRAC_PI_2..3.0 * FRAC_PI_2).contains(&phi), "{phi}");
    });
    assert_eq!(both, [true; 2]);
    assert_eq!(passed, 20);
}

/// Peaucellier's inversor: the foot is the inverse of the crank's pin, y = -(L^2 - s^2) / (2 a).
#[test]
fn the_foot_of_peaucelliers_inversor_moves_straight() {
    let (a, power) = (0.2, 0.5 * 0.5 - 0.2 * 0.2);
    let mut reach: [f64; 2] = [0.0; 2];
    run("peaucellier", |inversor| {
        let pin = plus([0.0, -a], polar(a, get(inversor, "crank.angle")));
        let inverse = power / (pin[0] * pin[0] + pin[1] * pin[1]);
        let foot = [get(inversor, "foot.x"), get(inversor, "foot.y")];
        assert!((foot[1] + power / (2.0 * a)).abs() < ROUNDING, "{foot:?}");
        assert!(apart(foot, pin.map(|part| inverse * part)) < 4.0 * ROUNDING, "{foot:?}");
        reach = [reach[0].min(foot[0]), reach[1].max(foot[0])];
    });
    assert!(reach[0] < -0.27 && reach[1] > 0.27, "{reach:?}");
}

/// All pictures of a film, with their durations.
fn film(path: &Path) -> Vec<(u16, Vec<u8>)> {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::Indexed);
    let mut decoder = options.read_info(fs::File::open(path).unwrap()).unwrap();
    let width = usize::from(decoder.width());
    let palette = decoder.global_palette().unwrap().to_vec();
    let mut picture = vec![0; 3 * width * usize::from(decoder.height())];
    let mut pictures = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        for (k, &index) in frame.buffer.iter().enumerate() {
            let (row, column) = (k / usize::from(frame.width), k % usize::from(frame.width));
            if Some(index) != frame.transparent {
                let at = 3 * ((row + usize::from(frame.top)) * width + column + usize::from(frame.left));
                picture[at..at + 3].copy_from_slice(&palette[3 * usize::from(index)..3 * usize::from(index) + 3]);
            }
        }
        pictures.push((frame.delay, picture.clone()));
    }
    pictures
}

/// The test compares pictures, not bytes: the sine of another machine may differ in its last bit, and move a pixel.
#[test]
fn committed_films_are_what_is_drawn() {
    let workspace = Workspace::locate();
    let out = env::temp_dir().join(format!("fmu-build-gallery-{}", process::id()));
    gallery::run(&workspace, Some(&out)).unwrap();
    let page = fs::read_to_string(workspace.gallery().with_extension("md")).unwrap();
    let definitions = gallery::definitions(&workspace).unwrap();
    assert_eq!(definitions.len(), 6);
    for path in definitions {
        let committed = path.with_extension("gif");
        let name = committed.file_name().unwrap().to_str().unwrap();
        let advice = format!("{name}: run `cargo fmu demo --gallery` and commit what it writes");
        let bytes = fs::read(&committed).unwrap();
        assert!(bytes.len() <= LARGEST, "{name} has {} bytes", bytes.len());
        assert!(page.contains(&format!("(gallery/{name})")), "docs/gallery.md does not show {name}");
        let (here, there) = (film(&out.join(name)), film(&committed));
        assert_eq!(here.len(), there.len(), "{advice}");
        assert!(here.len() >= 30);
        let mut shown: Vec<&[u8]> = Vec::new();
        for ((delay, a), (other_delay, b)) in here.iter().zip(&there) {
            let differ = a.iter().zip(b).filter(|(a, b)| a != b).count();
            assert!(delay == other_delay && differ <= a.len() / 2000, "{advice}: {differ} of {}", a.len());
            assert!(!shown.contains(&a.as_slice()), "{name}: a picture stands twice");
            shown.push(a);
        }
    }
    fs::remove_dir_all(out).unwrap();
}
