//! FLIP against values of its authors' program, and properties that it must have.

use super::*;

const WIDTH: usize = 48;
const HEIGHT: usize = 32;

fn picture(width: usize, height: usize, pixel: impl Fn(usize, usize) -> [u8; 3]) -> Picture {
    let pixels = (0..width * height).map(|index| pixel(index % width, index / width));
    Picture {
        width,
        pixels: pixels.collect(),
    }
}

fn uniform(color: [u8; 3]) -> Picture {
    picture(WIDTH, HEIGHT, |_, _| color)
}

fn difference(pixels_per_degree: f64, reference: &Picture, test: &Picture) -> ErrorMap {
    let flip = Flip::new(pixels_per_degree);
    flip.see(reference).difference(&flip.see(test))
}

/// A whole number from 0 to 255 (the finaliser of `SplitMix64`).
fn noise(index: u64) -> u64 {
    let value = index.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let value = (value ^ value >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let value = (value ^ value >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    value >> 56
}

/// Red grows to the right, green downwards, and blue along hyperbolas, with steps.
fn gradient() -> Picture {
    noisy_gradient(0)
}

/// Each channel is off by at most `amplitude`.
fn noisy_gradient(amplitude: u8) -> Picture {
    let amplitude = i64::from(amplitude);
    picture(WIDTH, HEIGHT, |x, y| {
        let exact = [5 * x, 8 * y, x * y % 256];
        [0, 1, 2].map(|channel| {
            let noise = noise((3 * (y * WIDTH + x) + channel) as u64).cast_signed();
            let value =
                i64::try_from(exact[channel]).unwrap() + noise % (2 * amplitude + 1) - amplitude;
            u8::try_from(value.clamp(0, 255)).unwrap()
        })
    })
}

/// A steep edge between light and dark gray.
fn edge(at: usize) -> Picture {
    picture(WIDTH, HEIGHT, |x, y| {
        [if x < at + y / 4 { 200 } else { 40 }; 3]
    })
}

/// A yellow dot of nine pixels on gray.
fn dot() -> Picture {
    picture(WIDTH, HEIGHT, |x, y| {
        let inside = (19..=21).contains(&x) && (11..=13).contains(&y);
        if inside { [250, 240, 40] } else { [128; 3] }
    })
}

/// Red and cyan squares: blurred, some channels leave the range of the screen.
fn checks(shift: usize) -> Picture {
    picture(WIDTH, HEIGHT, |x, y| {
        if ((x + shift) / 3 + y / 3) % 2 == 1 {
            [255, 0, 0]
        } else {
            [0, 255, 255]
        }
    })
}

/// Smaller than every filter, so that the border matters everywhere.
fn tiny(blue: u8) -> Picture {
    picture(5, 3, |x, y| {
        [50 * x, 80 * y, usize::from(blue)].map(|value| u8::try_from(value).unwrap())
    })
}

/// What the authors' program finds.
struct Published {
    name: &'static str,
    pictures: [Picture; 2],
    pixels_per_degree: f64,
    mean: f64,
    /// Column, row and error.
    pixels: [(usize, usize, f64); 3],
    /// How far the mean and the error of a pixel may be off.
    tolerances: [f64; 2],
}

/// What the rounding of the program to f32 does. Where features of both pictures should be equal, a rounding of 1e-7 makes a difference, whose square root, about
/// 3e-4, is in the exponent of the error. The same formulas in f32 differ from f64 by as much: by 1.5e-5 in means, and 1.5e-4 in a pixel.
const ROUNDED_FEATURES: [f64; 2] = [2e-5, 2e-4];

/// Where features differ clearly, only the rounding of the values is left: 7e-8 in means and 4e-6 in a pixel.
const DIFFERENT_FEATURES: [f64; 2] = [2e-7, 1e-5];

/// The package `flip-evaluator` 1.7 of the paper's authors, with `applyMagma=False`; means are of its map, summed in f64.
fn published() -> Vec<Published> {
    let mut cases = with_different_features();
    cases.extend(with_equal_features());
    cases
}

fn with_different_features() -> Vec<Published> {
    let case = |name, pictures, mean, pixels| Published {
        name,
        pictures,
        pixels_per_degree: PIXELS_PER_DEGREE,
        mean,
        pixels,
        tolerances: DIFFERENT_FEATURES,
    };
    vec![
        case(
            "noise",
            [gradient(), noisy_gradient(16)],
            0.082_224_85,
            [
                (0, 0, 0.076_621_7),
                (24, 16, 0.146_076_34),
                (47, 31, 0.261_375_96),
            ],
        ),
        Published {
            pixels_per_degree: 30.0,
            ..case(
                "noise from near",
                [gradient(), noisy_gradient(16)],
                0.164_686_01,
                [
                    (0, 0, 0.103_072_73),
                    (24, 16, 0.225_374_24),
                    (47, 31, 0.403_582_39),
                ],
            )
        },
        case(
            "missing dot",
            [dot(), uniform([128; 3])],
            0.032_411_45,
            [
                (20, 12, 0.912_521_3),
                (24, 16, 0.154_493_66),
                (24, 12, 0.308_135_96),
            ],
        ),
    ]
}

fn with_equal_features() -> Vec<Published> {
    let case = |name, pictures, mean, pixels| Published {
        name,
        pictures,
        pixels_per_degree: PIXELS_PER_DEGREE,
        mean,
        pixels,
        tolerances: ROUNDED_FEATURES,
    };
    let uniform = |name, colors: [[u8; 3]; 2], error| {
        let pixels = [(0, 0, error), (24, 16, error), (47, 31, error)];
        case(name, colors.map(uniform), error, pixels)
    };
    vec![
        case(
            "shifted edge",
            [edge(20), edge(21)],
            0.051_302_55,
            [
                (21, 0, 0.619_313_3),
                (24, 16, 0.567_062_91),
                (31, 31, 0.029_275_75),
            ],
        ),
        case(
            "checks",
            [checks(0), checks(1)],
            0.391_107_9,
            [
                (0, 0, 0.329_549_49),
                (24, 16, 0.415_862_71),
                (47, 31, 0.967_874_17),
            ],
        ),
        case(
            "tiny",
            [tiny(200), tiny(20)],
            0.898_042_13,
            [
                (0, 0, 0.807_271_12),
                (2, 1, 0.921_259_52),
                (4, 2, 0.887_208_34),
            ],
        ),
        uniform("green and blue", [[0, 255, 0], [0, 0, 255]], 1.0),
        uniform("black and white", [[0; 3], [255; 3]], 0.967_392_33),
        uniform("dark", [[3; 3], [9, 6, 3]], 0.056_071_65),
    ]
}

#[test]
fn errors_are_those_of_the_authors_program() {
    for case in published() {
        let [reference, test] = &case.pictures;
        let [of_mean, of_pixel] = case.tolerances;
        let map = difference(case.pixels_per_degree, reference, test);
        let off = (map.mean() - case.mean).abs();
        assert!(
            off < of_mean,
            "{}: mean {} is off by {off:e}",
            case.name,
            map.mean()
        );
        for (x, y, published) in case.pixels {
            let error = map.errors[y * map.width + x];
            let off = (error - published).abs();
            assert!(
                off < of_pixel,
                "{} ({x}, {y}): {error} is off by {off:e}",
                case.name
            );
        }
    }
}

#[test]
fn equal_pictures_have_no_error() {
    for picture in [gradient(), dot(), checks(0), tiny(7), uniform([255; 3])] {
        let map = difference(PIXELS_PER_DEGREE, &picture, &picture);
        assert!(map.errors.iter().all(|error| *error == 0.0), "{map:?}");
        assert_eq!(map.mean(), 0.0);
    }
}

#[test]
fn the_order_of_the_pictures_does_not_matter_and_errors_are_between_0_and_1() {
    for Published {
        pictures: [a, b],
        name,
        ..
    } in published()
    {
        let there = difference(PIXELS_PER_DEGREE, &a, &b);
        assert_eq!(there, difference(PIXELS_PER_DEGREE, &b, &a), "{name}");
        let inside = |error: &f64| (0.0..=1.0 + 1e-12).contains(error);
        assert!(there.errors.iter().all(inside), "{name}");
    }
}

#[test]
fn mirrored_pictures_have_the_mirrored_map() {
    let mirrored = |picture: &Picture| Picture {
        width: picture.width,
        pixels: picture.pixels.iter().rev().copied().collect(),
    };
    let (a, b) = (gradient(), noisy_gradient(20));
    let map = difference(PIXELS_PER_DEGREE, &a, &b);
    let other = difference(PIXELS_PER_DEGREE, &mirrored(&a), &mirrored(&b));
    for (error, other) in map.errors.iter().zip(other.errors.iter().rev()) {
        // Sums in another order.
        assert!((error - other).abs() < 1e-9, "{error} and {other}");
    }
}

#[test]
fn the_mean_grows_with_noise_with_brightness_and_with_the_length_of_a_shift() {
    let growing = |name: &str, reference: &Picture, tests: &[Picture]| {
        let means: Vec<f64> = tests
            .iter()
            .map(|test| difference(PIXELS_PER_DEGREE, reference, test).mean())
            .collect();
        assert!(means[0] > 0.0, "{name}: {means:?}");
        assert!(means.is_sorted_by(|a, b| a < b), "{name}: {means:?}");
    };
    growing(
        "noise",
        &gradient(),
        &[2, 4, 8, 16, 32, 64].map(noisy_gradient),
    );
    growing(
        "brightness",
        &uniform([60; 3]),
        &[61, 64, 80, 120, 200, 255].map(|gray| uniform([gray; 3])),
    );
    growing("shift", &edge(16), &[17, 18, 20, 24].map(edge));
}

#[test]
fn from_farther_away_noise_is_less_visible() {
    let [near, far] =
        [30.0, 120.0].map(|ppd| difference(ppd, &gradient(), &noisy_gradient(16)).mean());
    assert!(far < near, "{far} from far, {near} from near");
}
