use super::*;

fn grid(borders: &[f64]) -> Grid {
    Grid { borders: borders.to_vec(), centers: Vec::new(), noise: NOISE }
}

fn build(grid: &Grid, sizes: &[f64], exact: &mut dyn FnMut(f64, &mut [f64]) -> f64) -> Result<Table, Unresolved> {
    Table::build_all(grid, &[sizes.to_vec()], exact).remove(0)
}

#[test]
fn resolves_a_peak_to_the_stated_accuracy() {
    let f = |s: f64| 1.0 / (1e-3 + s * s);
    let table = build(&grid(&[-1.0, 0.3, 2.0]), &[1.0, 1.0], &mut |s, v| {
        v.copy_from_slice(&[f(s), s.sin()]);
        1.0
    })
    .unwrap();
    for i in 0..=3000 {
        let s = -1.0 + f64::from(i) / 1000.0;
        let at = table.position(s);
        assert!((table.value(at, 0) - f(s)).abs() < ACCURACY * 1e3, "{s}");
        assert!((table.value(at, 1) - s.sin()).abs() < ACCURACY, "{s}");
    }
    assert!(table.panels() > 4);
}

#[test]
fn a_jump_gives_an_error_with_its_position() {
    let error = build(&grid(&[0.0, 1.0]), &[1.0], &mut |s, v| {
        v[0] = (s - 0.7).signum();
        1.0
    })
    .unwrap_err();
    assert!((error.sigma - 0.7).abs() < 1e-3, "{error}");
}

#[test]
fn a_pole_is_a_gap_and_the_rest_is_resolved() {
    let pole = 0.3;
    let f = |s: f64| [1.0 / (s - pole), s.cos()];
    let grid = Grid { borders: vec![-1.0, 0.0, 0.6, 2.0], centers: vec![pole], noise: NOISE };
    let mut exact = |s: f64, v: &mut [f64]| {
        v.copy_from_slice(&f(s));
        1.0
    };
    let table = Table::build_with_gaps(&grid, vec![1.0, 1.0], &mut exact).unwrap();
    let gaps: Vec<_> = table.gaps().collect();
    let (first, last) = (gaps[0].0, gaps[gaps.len() - 1].1);
    assert!(gaps.windows(2).all(|pair| pair[0].1 == pair[1].0), "{gaps:?}");
    assert!(first < pole && pole < last && last - first < 1e-4, "{gaps:?}");
    for i in 0..=3000 {
        let s = -1.0 + f64::from(i) / 1000.0 + 1e-5;
        let at = table.position(s);
        assert!((table.value(at, 1) - f(s)[1]).abs() < 2.0 * ACCURACY);
        if !table.is_gap(at.panel) {
            let [exact, _] = f(s);
            assert!((table.value(at, 0) - exact).abs() < 1e-11 * exact.abs().max(10.0), "{s}");
        }
    }
    assert!(Table::build_all(&grid, &[vec![1.0, 1.0]], &mut exact)[0].is_err());
}

/// A function that is nowhere smooth gives only gaps, with limited work.
#[test]
fn a_rough_function_has_bounded_work() {
    let mut calls = 0;
    let table = Table::build_with_gaps(&grid(&[0.0, 1.0]), vec![1.0], &mut |s, v| {
        calls += 1;
        v[0] = (s * 1e9).sin();
        1.0
    });
    let table = table.unwrap();
    assert!(calls < 100_000 && (0..table.panels()).all(|panel| table.is_gap(panel)), "{calls}");
}

#[test]
fn noise_of_rounding_is_accepted() {
    let mut seed = 1u64;
    let mut noise = move || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    let mut noisy = |size: f64, level: f64| {
        build(&grid(&[0.0, 1.0]), &[1.0], &mut |s, v| {
            v[0] = size * s.cos() + level * noise();
            1.0
        })
    };
    assert!(noisy(1.0, 1e-12).is_ok());
    assert!(noisy(0.0, 1e-15).is_ok(), "rounding only, relative to the natural size");
    assert!(noisy(1.0, 1e-6).is_err());
}
