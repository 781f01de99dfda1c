//! The colour spaces of FLIP: from sRGB to opponent channels, and to the one in which distances are measured.

use std::sync::LazyLock;

use tahko_tracer::geometry::glam::{DMat3, DVec3};

/// Chromaticities of the primaries of sRGB (ITU-R BT.709).
const PRIMARIES: [[f64; 2]; 3] = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]];

/// Chromaticity of the illuminant D65 for the observer of 1931.
const D65: [f64; 2] = [0.312_71, 0.329_02];

/// The colour spaces' common data.
pub(super) struct Spaces {
    xyz_of_rgb: DMat3,
    rgb_of_xyz: DMat3,
    /// XYZ of white.
    white: DVec3,
}

pub(super) static SPACES: LazyLock<Spaces> = LazyLock::new(Spaces::new);

/// XYZ of a chromaticity, with `Y` = 1.
fn xyz([x, y]: [f64; 2]) -> DVec3 {
    DVec3::new(x / y, 1.0, (1.0 - x - y) / y)
}

impl Spaces {
    /// Primaries are as bright as makes their sum white.
    fn new() -> Self {
        let [red, green, blue] = PRIMARIES.map(xyz);
        let unscaled = DMat3::from_cols(red, green, blue);
        let white = xyz(D65);
        let xyz_of_rgb = unscaled * DMat3::from_diagonal(unscaled.inverse() * white);
        Self {
            xyz_of_rgb,
            rgb_of_xyz: xyz_of_rgb.inverse(),
            white,
        }
    }

    /// `Y`, `Cx` (red-green) and `Cz` (blue-yellow) of linear RGB: L\*a\*b\* without the cube root.
    pub(super) fn opponents(&self, rgb: DVec3) -> DVec3 {
        let [x, y, z] = (self.xyz_of_rgb * rgb / self.white).to_array();
        DVec3::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
    }

    /// Linear RGB of opponent channels.
    pub(super) fn rgb(&self, opponents: DVec3) -> DVec3 {
        let y = luminance(opponents.x);
        let relative = DVec3::new(y + opponents.y / 500.0, y, y - opponents.z / 200.0);
        self.rgb_of_xyz * (relative * self.white)
    }

    /// L\*a\*b\* of linear RGB, with the adjustment of Hunt: colours are less colourful where it is dark.
    pub(super) fn hunt_lab(&self, rgb: DVec3) -> DVec3 {
        let [x, y, z] = (self.xyz_of_rgb * rgb / self.white)
            .to_array()
            .map(cube_root);
        let lightness = 116.0 * y - 16.0;
        let adjustment = 0.01 * lightness;
        DVec3::new(
            lightness,
            adjustment * 500.0 * (x - y),
            adjustment * 200.0 * (y - z),
        )
    }
}

/// The luminance, 0 to 1, of the first opponent channel.
pub(super) fn luminance(first: f64) -> f64 {
    (first + 16.0) / 116.0
}

/// The cube root with the linear piece of L\*a\*b\* near black.
fn cube_root(value: f64) -> f64 {
    const KNEE: f64 = 6.0 / 29.0;
    if value > KNEE.powi(3) {
        value.cbrt()
    } else {
        value / (3.0 * KNEE * KNEE) + 4.0 / 29.0
    }
}

/// Linear values of the 8-bit values of sRGB (IEC 61966-2-1).
pub(super) fn linear_values() -> [f64; 256] {
    std::array::from_fn(|value| {
        let value = value as f64 / 255.0;
        if value <= 0.040_45 {
            value / 12.92
        } else {
            ((value + 0.055) / 1.055).powf(2.4)
        }
    })
}

/// The distance for large differences of colour: lightness apart from the rest.
///
/// Source: Abasi, Tehran, Fairchild, "Distance metrics for very large color differences", 2020.
pub(super) fn hyab(a: DVec3, b: DVec3) -> f64 {
    let difference = a - b;
    difference.x.abs() + difference.y.hypot(difference.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_has_lightness_100_and_no_colour() {
        let white = SPACES.hunt_lab(DVec3::ONE);
        assert!(
            (white - DVec3::new(100.0, 0.0, 0.0)).length() < 1e-11,
            "{white}"
        );
        assert!(
            SPACES.hunt_lab(DVec3::ZERO).length() < 1e-11,
            "black is the origin"
        );
    }

    #[test]
    fn opponent_channels_lead_back_to_rgb() {
        let rgb = DVec3::new(0.1, 0.9, 0.4);
        let back = SPACES.rgb(SPACES.opponents(rgb));
        assert!((back - rgb).length() < 1e-14, "{back}");
    }

    #[test]
    fn the_cube_root_and_its_linear_piece_meet() {
        let knee = (6.0f64 / 29.0).powi(3);
        let step = cube_root(knee * (1.0 + 1e-12)) - cube_root(knee);
        assert!((0.0..1e-11).contains(&step), "{step}");
    }
}
