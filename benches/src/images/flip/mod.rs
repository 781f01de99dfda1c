//! FLIP: how different two pictures look when one flips between them.
//!
//! Both pictures are blurred as the eye does at the distance of the viewer, and the colours are compared; where edges or points come or go, the
//! difference of colour counts for more. Pictures are what a screen shows (LDR-FLIP).
//!
//! A picture costs about 280 multiplications and additions a pixel at 67 pixels per degree, for fourteen passes along rows or columns with 19 or 21
//! weights, besides three cube roots; comparing two that are prepared costs three powers a pixel. Arithmetic is f64.
//!
//! Source: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, "FLIP: A difference evaluator for alternating images", Proceedings of the
//! ACM on Computer Graphics and Interactive Techniques 3 (2), 2020. The tests hold it against values of the authors' program.

mod color;
mod filter;

use std::f64::consts::FRAC_1_SQRT_2;

use rayon::prelude::*;
use tahko_tracer::geometry::glam::DVec3;

use super::picture::Picture;
use color::{SPACES, hyab, linear_values, luminance};
use filter::{FeatureDetector, Plane, Sensitivity};

/// Pixels per degree of the visual field when a screen 0.7 m wide with 3840 pixels is watched from 0.7 m, as the paper suggests.
pub(crate) const PIXELS_PER_DEGREE: f64 = 67.02;

/// Exponent that takes distances of colours to a scale on which they look even.
const COLOR_EXPONENT: f64 = 0.7;

/// Differences of colour below this part of the largest are spread over most of the scale, ...
const COLOR_KNEE: f64 = 0.4;

/// ... up to here; larger ones share the rest.
const ERROR_AT_KNEE: f64 = 0.95;

/// Exponent of the difference of features.
const FEATURE_EXPONENT: f64 = 0.5;

/// An eye at some distance from the screen.
#[derive(Clone, Debug)]
pub(crate) struct Flip {
    sensitivities: [Sensitivity; 3],
    features: FeatureDetector,
    linear: [f64; 256],
}

/// What an eye sees of a picture.
#[derive(Clone, Debug)]
pub(crate) struct Seen {
    width: usize,
    /// Blurred colours.
    colors: Vec<DVec3>,
    edges: Vec<f64>,
    points: Vec<f64>,
}

/// How visible the difference of two pictures is at each pixel, from 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ErrorMap {
    pub(crate) width: usize,
    pub(crate) errors: Vec<f64>,
}

impl ErrorMap {
    pub(crate) fn mean(&self) -> f64 {
        self.errors.iter().sum::<f64>() / self.errors.len().max(1) as f64
    }
}

impl Flip {
    pub(crate) fn new(pixels_per_degree: f64) -> Self {
        Self {
            sensitivities: Sensitivity::of_channels(pixels_per_degree),
            features: FeatureDetector::new(pixels_per_degree),
            linear: linear_values(),
        }
    }

    /// Prepares a picture for comparisons.
    pub(crate) fn see(&self, picture: &Picture) -> Seen {
        let width = picture.width;
        let opponents: Vec<DVec3> = picture
            .pixels
            .iter()
            .map(|pixel| {
                let linear = pixel.map(|value| self.linear[usize::from(value)]);
                SPACES.opponents(DVec3::from(linear))
            })
            .collect();
        let plane = |value: &dyn Fn(&DVec3) -> f64| Plane {
            width,
            values: opponents.iter().map(value).collect(),
        };
        let [y, cx, cz] = [0, 1, 2].map(|channel| {
            self.sensitivities[channel]
                .filter(&plane(&|color| color[channel]))
                .values
        });
        let colors = (0..opponents.len())
            .map(|pixel| {
                let rgb = SPACES.rgb(DVec3::new(y[pixel], cx[pixel], cz[pixel]));
                SPACES.hunt_lab(rgb.clamp(DVec3::ZERO, DVec3::ONE))
            })
            .collect();
        let [edges, points] = self
            .features
            .edges_and_points(&plane(&|color| luminance(color.x)));
        Seen {
            width,
            colors,
            edges,
            points,
        }
    }
}

impl Seen {
    /// The visible difference; the same whichever of the two is asked.
    ///
    /// # Panics
    /// If the pictures have different sizes.
    pub(crate) fn difference(&self, other: &Self) -> ErrorMap {
        assert_eq!(
            (self.width, self.colors.len()),
            (other.width, other.colors.len()),
            "pictures of one size"
        );
        let largest = largest_color_difference();
        let errors = (0..self.colors.len())
            .into_par_iter()
            .map(|pixel| {
                let distance = hyab(self.colors[pixel], other.colors[pixel]);
                let color = redistributed(distance.powf(COLOR_EXPONENT), largest);
                let edge = (self.edges[pixel] - other.edges[pixel]).abs();
                let point = (self.points[pixel] - other.points[pixel]).abs();
                let feature = (FRAC_1_SQRT_2 * edge.max(point)).powf(FEATURE_EXPONENT);
                color.powf(1.0 - feature.min(1.0))
            })
            .collect();
        ErrorMap {
            width: self.width,
            errors,
        }
    }
}

/// That of green and blue, which are farthest apart of all colours of sRGB.
fn largest_color_difference() -> f64 {
    let [green, blue] = [DVec3::Y, DVec3::Z].map(|rgb| SPACES.hunt_lab(rgb));
    hyab(green, blue).powf(COLOR_EXPONENT)
}

/// Maps 0 to the largest difference onto 0 to 1, in two straight pieces.
fn redistributed(difference: f64, largest: f64) -> f64 {
    let knee = COLOR_KNEE * largest;
    if difference < knee {
        difference * ERROR_AT_KNEE / knee
    } else {
        ERROR_AT_KNEE + (difference - knee) / (largest - knee) * (1.0 - ERROR_AT_KNEE)
    }
}

#[cfg(test)]
mod tests;
