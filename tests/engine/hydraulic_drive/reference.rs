//! Retraction and vibration of the gear with its circuit against reference values.
use super::*;

/// Retraction from rest at 0.8 rad, with air in the oil, cushions and friction of the seals.
pub const RETRACTION: [Row; 10] = [
    [
        0.05,
        0.793138133418578,
        -0.30656593282579,
        6478303.0431435,
        10242897.040518,
        -1232.161703436,
        0.419368208289008,
        0.03931911701544,
    ],
    [
        0.1,
        0.769550975553854,
        -0.62936026011088,
        5314686.2927837,
        8882913.3390496,
        -1605.896803131,
        0.422427798448481,
        0.08253354851197,
    ],
    [
        0.2,
        0.703967315179619,
        -0.63957809999443,
        4528002.6282655,
        8108837.6838444,
        -2008.847879986,
        0.431266906578840,
        0.08838437107865,
    ],
    [
        0.5,
        0.523620580328936,
        -0.57112729970867,
        4992624.9595796,
        7792790.9883118,
        -921.6257163131,
        0.457543749407357,
        0.08686280564332,
    ],
    [
        1.0,
        0.253250298772210,
        -0.51714629239523,
        5650165.2371706,
        7478162.7666305,
        471.0857748807,
        0.500463040756372,
        0.08488866941389,
    ],
    [
        2.0,
        -0.242429680769236,
        -0.48958400813701,
        6710031.2547232,
        6976165.2514557,
        2710.350675763,
        0.583686458596709,
        0.08159718420969,
    ],
    [
        3.0,
        -0.759970553164200,
        -0.56384947054374,
        7925280.8916266,
        6394619.7477901,
        5284.562808813,
        0.663409516325448,
        0.07760027956620,
    ],
    [
        3.5,
        -1.05718309261089,
        -0.61663470775208,
        8499458.3878426,
        6153891.6257826,
        6463.272957934,
        0.701696028722270,
        0.07594839563223,
    ],
    [
        3.8,
        -1.22821155571711,
        -0.42282793782688,
        10448976.118609,
        10069665.023005,
        5265.166473185,
        0.723809771775691,
        0.06205425498973,
    ],
    [
        4.0,
        -1.28835660508442,
        -0.2011150324088,
        16102738.794319,
        19701448.784114,
        3674.566628157,
        0.734039211753613,
        0.04227773657469,
    ],
];
/// State at the time at which the gear is up.
const RETRACTED: Row = [
    4.065842490726519,
    -1.3,
    -0.15426735502447,
    17169593.192164,
    21756413.637998,
    3111.606916986,
    0.736680967661896,
    0.03812432397111,
];
/// Energies at that time [J].
const RETRACTED_ENERGIES: [(&str, f64); 6] = [
    ("energy.supplied", 10553.184673943),
    ("energy.returned", 121.85059253553),
    ("energy.piston", 792.0166110596),
    ("energy.seal_friction", 92.320992189462),
    ("energy.compression", 51.226522536153),
    ("energy.throttling", 9495.7699556221),
];
/// Vibration about 0 rad under a sinusoidal command, without air, cushions and friction.
const VIBRATION: [Row; 6] = [
    [
        0.05,
        -0.00484058453060504,
        -0.18964739813228,
        7694446.0343801,
        9181394.9806646,
        2142.016604783,
        0.543627270657388,
        0.03209148619912,
    ],
    [
        0.1,
        -0.0194469102739466,
        -0.36680255596499,
        6834536.0027661,
        8010099.4782638,
        2062.295462696,
        0.546099430456955,
        0.06209389623443,
    ],
    [
        0.25,
        -0.0609683061521160,
        -0.02591728495605,
        5965047.2227448,
        7359758.2546644,
        1394.520832211,
        0.553129984017170,
        0.004388445703471,
    ],
    [
        0.5,
        -0.0162693739682587,
        0.01301409192789,
        12574129.767437,
        16200006.250218,
        2185.452093646,
        0.545561542968947,
        -0.002202919358068,
    ],
    [
        0.75,
        -0.0777416580266453,
        -0.02263019283161,
        6117506.9857873,
        7520596.8855059,
        1460.146297057,
        0.555969774812941,
        0.003830747751046,
    ],
    [
        1.0,
        -0.0328997584464874,
        0.01323211495211,
        12609944.246502,
        16192507.707920,
        2250.657639348,
        0.548377068274000,
        -0.002240492606440,
    ],
];
/// Energies at 1 s [J].
const VIBRATION_ENERGIES: [(&str, f64); 5] = [
    ("energy.supplied", 1073.1215403971),
    ("energy.returned", 16.250674971876),
    ("energy.piston", 9.522155866394),
    ("energy.compression", 24.869964377357),
    ("energy.throttling", 1022.4787451814),
];

#[track_caller]
fn meets(gear: &mut Run, row: &Row, digits: f64) {
    for ((name, expected), size) in NAMES.iter().zip(&row[1..]).zip(SIZES) {
        let value = gear.get(name);
        let error = (value - expected).abs() / size.max(expected.abs());
        assert!(error <= digits, "{} s {name} = {value}: {expected}, off by {error:e}", row[0]);
    }
}

/// Step to these times, in communication steps of `h`.
fn follow(gear: &mut Run, rows: &[Row], h: f64, digits: f64) {
    let mut steps = 0;
    for row in rows {
        let end = (row[0] / h).round() as u64;
        while steps < end {
            gear.step((steps + 1) as f64 * h - steps as f64 * h);
            steps += 1;
        }
        meets(gear, row, digits);
    }
}

#[test]
fn the_retraction_follows_the_reference() {
    let mut gear = retraction(1e-12);
    follow(&mut gear, &RETRACTION, 0.05, 1e-11);
    assert!((gear.get("valve.position") - 0.65).abs() < 1e-11);
    let mut gear = retraction(1e-12);
    follow(&mut gear, &RETRACTION[..1], 0.05, 1e-11);
    assert!((gear.get("valve.position") - 0.29741314344).abs() < 1e-10);
}

#[test]
fn the_gear_is_up_at_the_reference_time_with_the_reference_energies() {
    let mut gear = retraction(1e-12);
    gear.set("upstop.enabled", false);
    gear.initialize();
    gear.step(RETRACTED[0]);
    let time = (gear.get("crank.angle") + 1.3) / -gear.get("crank.speed");
    assert!(time.abs() < 1e-10, "{time:e}");
    for (name, expected) in RETRACTED_ENERGIES {
        let error = gear.get(name) / expected - 1.0;
        assert!(error.abs() < 1e-10, "{name}: off by {error:e}");
    }
}

#[test]
fn the_vibration_follows_the_reference() {
    let mut gear = vibration(1e-12);
    follow(&mut gear, &VIBRATION, 0.05, 1e-11);
    for (name, expected) in VIBRATION_ENERGIES {
        let error = gear.get(name) / expected - 1.0;
        assert!(error.abs() < 1e-10, "{name}: off by {error:e}");
    }
}
