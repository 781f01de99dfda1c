//! Separable filters, and those of FLIP: contrast sensitivity, edges and points.

use std::f64::consts::PI;

/// The values of one channel, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Plane {
    pub(super) width: usize,
    pub(super) values: Vec<f64>,
}

impl Plane {
    /// Filters along rows, then along columns. The border pixels go on beyond the border.
    pub(super) fn filtered(&self, along_rows: &Kernel, along_columns: &Kernel) -> Self {
        self.along_rows(along_rows).along_columns(along_columns)
    }

    pub(super) fn along_rows(&self, kernel: &Kernel) -> Self {
        let mut values = vec![0.0; self.values.len()];
        let mut padded = Vec::with_capacity(self.width + kernel.weights.len());
        for (row, sums) in self
            .values
            .chunks(self.width)
            .zip(values.chunks_mut(self.width))
        {
            padded.clear();
            padded.resize(kernel.radius(), row[0]);
            padded.extend_from_slice(row);
            padded.resize(self.width + 2 * kernel.radius(), row[self.width - 1]);
            for (weight, shifted) in kernel.weights.iter().zip(padded.windows(self.width)) {
                add_scaled(sums, *weight, shifted);
            }
        }
        Self { values, ..*self }
    }

    pub(super) fn along_columns(&self, kernel: &Kernel) -> Self {
        let rows: Vec<&[f64]> = self.values.chunks(self.width).collect();
        let mut values = vec![0.0; self.values.len()];
        for (y, sums) in values.chunks_mut(self.width).enumerate() {
            for (shift, weight) in kernel.weights.iter().enumerate() {
                let y = (y + shift)
                    .saturating_sub(kernel.radius())
                    .min(rows.len() - 1);
                add_scaled(sums, *weight, rows[y]);
            }
        }
        Self { values, ..*self }
    }
}

/// Adds a multiple of values: a loop over neighbours, so that it becomes vector instructions.
fn add_scaled(sums: &mut [f64], weight: f64, values: &[f64]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += weight * value;
    }
}

/// An odd number of weights around the middle.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Kernel {
    weights: Vec<f64>,
}

impl Kernel {
    /// The values of a function at the whole numbers from `-radius` to `radius`.
    fn sampled(radius: u16, value: impl Fn(f64) -> f64) -> Self {
        let radius = i32::from(radius);
        Self {
            weights: (-radius..=radius).map(|x| value(f64::from(x))).collect(),
        }
    }

    fn radius(&self) -> usize {
        self.weights.len() / 2
    }

    fn sum(&self) -> f64 {
        self.weights.iter().sum()
    }

    /// Scales the positive weights so that their sum is 1 and the negative ones so that it is -1.
    fn normalized(mut self) -> Self {
        let sum_of = |sign: f64| -> f64 {
            let weights = self.weights.iter().filter(|weight| **weight * sign > 0.0);
            weights.map(|weight| weight.abs()).sum()
        };
        let (positive, negative) = (sum_of(1.0), sum_of(-1.0));
        for weight in &mut self.weights {
            *weight /= if *weight < 0.0 { negative } else { positive };
        }
        self
    }
}

/// A radius that leaves out less than 0.3 % of a Gaussian.
fn three_deviations(deviation: f64) -> u16 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a positive number of pixels; the cast saturates"
    )]
    let radius = (3.0 * deviation).ceil() as u16;
    radius
}

/// A Gaussian of the contrast sensitivity functions (table 1 of the paper): in the frequency domain `amplitude * exp(-spread * f^2)`.
#[derive(Clone, Copy, Debug)]
struct Gaussian {
    amplitude: f64,
    spread: f64,
}

impl Gaussian {
    const fn new(amplitude: f64, spread: f64) -> Self {
        Self { amplitude, spread }
    }
}

const LUMINANCE: &[Gaussian] = &[Gaussian::new(1.0, 0.0047)];
const RED_GREEN: &[Gaussian] = &[Gaussian::new(1.0, 0.0053)];
const BLUE_YELLOW: &[Gaussian] = &[Gaussian::new(34.1, 0.04), Gaussian::new(13.5, 0.025)];

/// The widest of them sets the radius of all.
const WIDEST: f64 = 0.04;

/// What the eye makes of a channel of `YCxCz` from a distance: a weighted sum of Gaussian filters.
#[derive(Clone, Debug)]
pub(super) struct Sensitivity {
    /// Weights with sum 1, each with a kernel of sum 1 that filters along rows and columns.
    parts: Vec<(f64, Kernel)>,
}

impl Sensitivity {
    /// The filters of luminance, red-green and blue-yellow.
    pub(super) fn of_channels(pixels_per_degree: f64) -> [Self; 3] {
        [LUMINANCE, RED_GREEN, BLUE_YELLOW]
            .map(|gaussians| Self::sum_of(gaussians, pixels_per_degree))
    }

    /// The sum in space of `a sqrt(pi / b) exp(-pi^2 (x^2 + y^2) / b)`, with `x` and `y` in degrees, scaled to sum 1.
    fn sum_of(gaussians: &[Gaussian], pixels_per_degree: f64) -> Self {
        let radius = three_deviations((WIDEST / (2.0 * PI * PI)).sqrt() * pixels_per_degree);
        let mut parts: Vec<(f64, Kernel)> = gaussians
            .iter()
            .map(|Gaussian { amplitude, spread }| {
                let kernel = Kernel::sampled(radius, |x| {
                    (-(PI * x / pixels_per_degree).powi(2) / spread).exp()
                });
                // The sum over the plane is the square of the sum over a line.
                let weight = amplitude * (PI / spread).sqrt() * kernel.sum().powi(2);
                (weight, kernel.normalized())
            })
            .collect();
        let sum: f64 = parts.iter().map(|(weight, _)| weight).sum();
        for (weight, _) in &mut parts {
            *weight /= sum;
        }
        Self { parts }
    }

    pub(super) fn filter(&self, plane: &Plane) -> Plane {
        let mut values = vec![0.0; plane.values.len()];
        for (weight, kernel) in &self.parts {
            add_scaled(&mut values, *weight, &plane.filtered(kernel, kernel).values);
        }
        Plane { values, ..*plane }
    }
}

/// The width of the features that are looked for, in degrees.
const FEATURE_WIDTH: f64 = 0.082;

/// Finds edges and points: first and second derivatives of a Gaussian.
#[derive(Clone, Debug)]
pub(super) struct FeatureDetector {
    smooth: Kernel,
    edge: Kernel,
    point: Kernel,
}

impl FeatureDetector {
    pub(super) fn new(pixels_per_degree: f64) -> Self {
        let deviation = 0.5 * FEATURE_WIDTH * pixels_per_degree;
        let radius = three_deviations(deviation);
        let gaussian = |x: f64| (-0.5 * (x / deviation).powi(2)).exp();
        // The kernels over the plane are products of these and the Gaussian, so scaling these scales them.
        Self {
            smooth: Kernel::sampled(radius, gaussian).normalized(),
            edge: Kernel::sampled(radius, |x| -x * gaussian(x)).normalized(),
            point: Kernel::sampled(radius, |x| ((x / deviation).powi(2) - 1.0) * gaussian(x))
                .normalized(),
        }
    }

    /// How much of an edge and of a point there is at each pixel.
    pub(super) fn edges_and_points(&self, plane: &Plane) -> [Vec<f64>; 2] {
        let smooth_columns = plane.along_columns(&self.smooth);
        let smooth_rows = plane.along_rows(&self.smooth);
        [&self.edge, &self.point].map(|kernel| {
            let along_rows = smooth_columns.along_rows(kernel).values;
            let along_columns = smooth_rows.along_columns(kernel).values;
            let pairs = along_rows.into_iter().zip(along_columns);
            pairs.map(|(x, y)| x.hypot(y)).collect()
        })
    }
}
