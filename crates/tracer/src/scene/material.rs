//! Materials and textures.

use glam::{Vec2, Vec3};
use thiserror::Error;

use super::TextureId;

/// How a surface looks. Colours are linear RGB.
///
/// Of the light that arrives, the part `transmission` is refracted (and, by Fresnel's law, reflected), the part
/// `mirror` of the rest is reflected, and what remains is scattered by the diffuse `color`. All surfaces have
/// two sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// A name for messages.
    pub name: String,
    /// Diffuse reflectance, 0 to 1.
    pub color: Vec3,
    /// A texture that multiplies the colour.
    pub texture: Option<TextureId>,
    /// Part that is mirrored, 0 to 1. Tinted by the colour where `metallic`.
    pub mirror: f32,
    /// Whether the mirrored light takes the colour of the surface.
    pub metallic: bool,
    /// Part that is refracted, 0 to 1.
    pub transmission: f32,
    /// Index of refraction inside the surface, at least 1; used where `transmission` is above 0.
    pub ior: f32,
    /// Light that the surface emits (it does not light other surfaces).
    pub emission: Vec3,
    /// Whether the colour is shown as it is, without light.
    pub unlit: bool,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: "default".to_owned(),
            color: Vec3::splat(0.7),
            texture: None,
            mirror: 0.0,
            metallic: false,
            transmission: 0.0,
            ior: 1.5,
            emission: Vec3::ZERO,
            unlit: false,
        }
    }
}

/// What happens to texture coordinates outside `[0, 1]`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The texture repeats.
    #[default]
    Repeat,
    /// The texture repeats, every second time mirrored.
    Mirror,
    /// The border continues.
    Clamp,
}

/// A colour image, sRGB, with its origin at the upper left.
#[derive(Clone, Debug)]
pub struct Texture {
    width: u32,
    height: u32,
    texels: Vec<[u8; 3]>,
    wrap: [Wrap; 2],
    nearest: bool,
}

/// Why an image is not a texture.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{texels} texels do not make an image of {width} x {height}")]
pub struct TextureError {
    width: u32,
    height: u32,
    texels: usize,
}

impl Texture {
    /// A texture from rows of sRGB texels, the upper row first.
    ///
    /// # Errors
    /// If the size is zero or does not match the number of texels.
    pub fn new(width: u32, height: u32, texels: Vec<[u8; 3]>) -> Result<Self, TextureError> {
        let count = texels.len();
        if count == 0 || u64::from(width) * u64::from(height) != count as u64 {
            return Err(TextureError {
                width,
                height,
                texels: count,
            });
        }
        Ok(Self {
            width,
            height,
            texels,
            wrap: [Wrap::Repeat; 2],
            nearest: false,
        })
    }

    /// Sets what happens outside `[0, 1]`, horizontally and vertically.
    #[must_use]
    pub const fn with_wrap(mut self, horizontal: Wrap, vertical: Wrap) -> Self {
        self.wrap = [horizontal, vertical];
        self
    }

    /// Sets whether the nearest texel is taken instead of a bilinear mix of four.
    #[must_use]
    pub const fn with_nearest_filter(mut self, nearest: bool) -> Self {
        self.nearest = nearest;
        self
    }

    /// The linear colour at texture coordinates; (0, 0) is the upper left corner. Black where they are not finite.
    #[must_use]
    pub fn sample(&self, coordinates: Vec2) -> Vec3 {
        if !coordinates.is_finite() {
            return Vec3::ZERO;
        }
        let size = Vec2::new(self.width as f32, self.height as f32);
        // A remainder by two periods keeps large coordinates in the range of i64 for every wrap mode but clamping.
        let x = fold(coordinates.x, self.wrap[0]) * size.x;
        let y = fold(coordinates.y, self.wrap[1]) * size.y;
        if self.nearest {
            return self.texel(floor(x), floor(y));
        }
        let (x, y) = (x - 0.5, y - 0.5);
        let (left, top) = (floor(x), floor(y));
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let upper = self.texel(left, top).lerp(self.texel(left + 1, top), fx);
        let lower = self
            .texel(left, top + 1)
            .lerp(self.texel(left + 1, top + 1), fx);
        upper.lerp(lower, fy)
    }

    fn texel(&self, x: i64, y: i64) -> Vec3 {
        let x = wrapped(x, self.width, self.wrap[0]);
        let y = wrapped(y, self.height, self.wrap[1]);
        let texel = self.texels[y * self.width as usize + x];
        Vec3::from(texel.map(|channel| srgb_to_linear(f32::from(channel) / 255.0)))
    }
}

/// Brings a coordinate into two periods around zero, or next to `[0, 1]` for clamping.
fn fold(coordinate: f32, wrap: Wrap) -> f32 {
    match wrap {
        Wrap::Clamp => coordinate.clamp(-1.0, 2.0),
        Wrap::Repeat | Wrap::Mirror => coordinate % 2.0,
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "folded coordinates are small"
)]
fn floor(value: f32) -> i64 {
    value.floor() as i64
}

fn wrapped(index: i64, size: u32, wrap: Wrap) -> usize {
    let size = i64::from(size);
    let index = match wrap {
        Wrap::Clamp => index.clamp(0, size - 1),
        Wrap::Repeat => index.rem_euclid(size),
        Wrap::Mirror => {
            let index = index.rem_euclid(2 * size);
            index.min(2 * size - 1 - index)
        }
    };
    usize::try_from(index).unwrap_or(0)
}

/// The inverse of the sRGB transfer function (IEC 61966-2-1), for values in `[0, 1]`.
#[must_use]
pub fn srgb_to_linear(value: f32) -> f32 {
    if value <= 0.04045 {
        value / 12.92
    } else {
        ((value + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn black_and_white() -> Texture {
        Texture::new(2, 1, vec![[0; 3], [255; 3]]).unwrap()
    }

    fn red(texture: &Texture, x: f32) -> f32 {
        texture.sample(Vec2::new(x, 0.5)).x
    }

    #[test]
    fn texels_are_mixed_between_their_centres() {
        let texture = black_and_white().with_wrap(Wrap::Clamp, Wrap::Clamp);
        assert_eq!([0.25, 0.5, 0.75].map(|x| red(&texture, x)), [0.0, 0.5, 1.0]);
        assert_eq!([-9.0, 9.0].map(|x| red(&texture, x)), [0.0, 1.0]);
    }

    #[test]
    fn wrap_modes_differ_outside_the_unit_square() {
        let nearest = |wrap| {
            black_and_white()
                .with_nearest_filter(true)
                .with_wrap(wrap, wrap)
        };
        let xs = [-0.75, -0.25, 0.25, 0.75, 1.25, 1.75];
        assert_eq!(
            xs.map(|x| red(&nearest(Wrap::Repeat), x)),
            [0.0, 1.0, 0.0, 1.0, 0.0, 1.0]
        );
        assert_eq!(
            xs.map(|x| red(&nearest(Wrap::Mirror), x)),
            [1.0, 0.0, 0.0, 1.0, 1.0, 0.0]
        );
        assert_eq!(
            xs.map(|x| red(&nearest(Wrap::Clamp), x)),
            [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]
        );
    }

    #[test]
    fn odd_coordinates_and_sizes_do_not_panic() {
        for x in [f32::NAN, f32::INFINITY, 1e30, -1e30] {
            assert!(black_and_white().sample(Vec2::splat(x)).is_finite(), "{x}");
        }
        assert!(
            Texture::new(2, 2, vec![[0; 3]; 3]).is_err(),
            "three texels for four"
        );
        assert!(Texture::new(0, 0, Vec::new()).is_err(), "an empty image");
    }
}
