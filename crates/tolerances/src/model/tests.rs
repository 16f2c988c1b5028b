use super::*;

/// Functions of three variables, in any number type: each with its values.
fn functions<N: Arithmetic<Angle = N>>([x, y, z]: [N; 3]) -> [N; 10] {
    let (sin, cos) = N::sin_cos(x * y);
    let unit = x * x + y * y;
    [
        x * y - z,
        (x + y) * (x - y) * z,
        x.div(y),
        N::ONE.div(z),
        unit.sqrt(),
        sin * cos + z,
        N::atan2(y, x),
        (x - y * z).abs(),
        x.div(unit.sqrt()) - y.div(unit.sqrt()) * sin,
        N::ab_minus_cd(x, x, y, y) * N::HALF,
    ]
}

const MIDDLES: [[f64; 3]; 4] = [
    [1.2, 0.7, -2.0],
    [-0.3, 2.5, 0.4],
    [3.0, -1.0, 1.0],
    [-2.0, -0.6, 5.0],
];

fn models(middle: [f64; 3], half_width: f64) -> [BoxModel; 10] {
    functions([0, 1, 2].map(|k| BoxModel::variable(middle[k], 7 * k, half_width)))
}

#[test]
fn a_model_holds_every_value_in_its_box() {
    for middle in MIDDLES {
        for half_width in [0.0, 1e-12, 1e-6, 1e-3, 0.1, 0.25] {
            let models = models(middle, half_width);
            // A grid with the corners.
            for point in 0..11usize.pow(3) {
                let v = [1, 11, 121].map(|step| (point / step % 11) as f64 / 5.0 - 1.0);
                let values = functions([0, 1, 2].map(|k| middle[k] + half_width * v[k]));
                for (index, (model, value)) in models.iter().zip(values).enumerate() {
                    let linear: f64 = (0..3).map(|k| model.linear[7 * k] * v[k]).sum();
                    let off = (value - model.constant - linear).abs();
                    // The value itself is rounded.
                    let slack = 1e-15 * (1.0 + value.abs());
                    assert!(
                        off <= model.error + slack,
                        "{index} at {middle:?} {v:?}: {off:e} {model:?}"
                    );
                    let [least, greatest] = model.range();
                    assert!(least - slack <= value && value <= greatest + slack);
                }
            }
        }
    }
}

#[test]
fn the_remainder_is_of_second_order() {
    for middle in MIDDLES {
        let (wide, narrow) = (models(middle, 1e-3), models(middle, 1e-4));
        for (wide, narrow) in wide.iter().zip(&narrow) {
            assert!(narrow.error <= 0.0102 * wide.error + 1e-12, "{wide:?}");
            assert!(wide.error <= 1e-4, "{wide:?}");
        }
    }
}

#[test]
fn nothing_is_known_where_a_function_has_no_value() {
    let straddling = BoxModel::variable(0.1, 3, 0.2);
    for lost in [
        BoxModel::ONE.div(straddling),
        straddling.sqrt(),
        BoxModel::atan2(straddling, straddling),
        BoxModel::ONE.div(BoxModel::ZERO),
        (-BoxModel::ONE).sqrt(),
    ] {
        assert!(!lost.is_finite(), "{lost:?}");
        assert!(!lost.error.is_nan() && !lost.constant.is_nan());
    }
}

#[test]
fn a_comparison_is_true_only_where_it_is_certain() {
    let model = |middle| BoxModel::variable(middle, 2, 0.5);
    assert!(model(1.0) > BoxModel::ZERO && model(-1.0) < BoxModel::ZERO);
    for middle in [-0.5, 0.0, 0.4] {
        assert_eq!(model(middle).partial_cmp(&BoxModel::ZERO), None);
    }
    // What two quantities have in common cancels.
    assert!(model(1.0) + BoxModel::ONE > model(1.0));
    assert_eq!(
        BoxModel::ONE.partial_cmp(&BoxModel::ONE),
        Some(Ordering::Equal)
    );
}
