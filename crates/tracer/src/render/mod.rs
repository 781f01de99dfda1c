//! Renders a scene in parallel tiles: the same picture for every number of threads.

mod caster;
mod integrator;
mod sampling;
mod surface;

pub use integrator::{DEFAULT_DEPTH, Integrator};

use std::ops::AddAssign;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use glam::Vec3;
use rayon::prelude::*;
use tahko_geometry::{QueryCounts, Ray, RayQuery};
use thiserror::Error;

use crate::film::Film;
use crate::scene::Scene;
use caster::RayCaster;

/// How to render.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderOptions {
    /// Width of the picture in pixels, at least 1.
    pub width: u32,
    /// Height of the picture in pixels, at least 1.
    pub height: u32,
    /// Samples per pixel, at least 1. One sample goes through the middle of the pixel.
    pub samples: u32,
    /// Where the samples of a pixel lie when there are several.
    pub seed: u64,
    /// How the radiance along a ray is found.
    pub integrator: Integrator,
    /// Whether node visits and tests are counted, which costs time.
    pub count: bool,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            width: 640,
            height: 480,
            samples: 1,
            seed: 0,
            integrator: Integrator::default(),
            count: false,
        }
    }
}

/// Why nothing was rendered.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The picture has no pixels or too many.
    #[error(
        "a picture of {width} x {height} pixels cannot be made; both sides must be 1 to {MAX_SIDE}"
    )]
    Size {
        /// Width asked for.
        width: u32,
        /// Height asked for.
        height: u32,
    },
    /// No samples.
    #[error("at least one sample per pixel is needed")]
    NoSamples,
    /// [`RenderControl::cancel`] was called.
    #[error("rendering was cancelled")]
    Cancelled,
}

/// The largest width or height of a picture.
pub const MAX_SIDE: u32 = 1 << 14;

/// Lets another thread watch a rendering and stop it.
#[derive(Debug, Default)]
pub struct RenderControl {
    cancelled: AtomicBool,
    finished_pixels: AtomicU64,
}

impl RenderControl {
    /// Asks the rendering to stop; it does so after the tiles at hand.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// How many pixels are finished.
    #[must_use]
    pub fn finished_pixels(&self) -> u64 {
        self.finished_pixels.load(Ordering::Relaxed)
    }
}

/// The rays that a rendering traced and, if they were counted, what they cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RenderStatistics {
    /// Rays from the camera.
    pub camera_rays: u64,
    /// Rays towards lights.
    pub shadow_rays: u64,
    /// Reflected and refracted rays.
    pub secondary_rays: u64,
    /// Node visits and tests of all rays; zero unless [`RenderOptions::count`] was set.
    pub counts: QueryCounts,
}

impl RenderStatistics {
    /// All rays.
    #[must_use]
    pub const fn rays(&self) -> u64 {
        self.camera_rays + self.shadow_rays + self.secondary_rays
    }
}

impl AddAssign for RenderStatistics {
    fn add_assign(&mut self, other: Self) {
        self.camera_rays += other.camera_rays;
        self.shadow_rays += other.shadow_rays;
        self.secondary_rays += other.secondary_rays;
        self.counts += other.counts;
    }
}

/// Renders a scene with the current thread pool of rayon.
///
/// Tiles are independent of each other and of the order in which they are rendered.
///
/// # Errors
/// If the size or the number of samples is zero or too large, or the rendering was cancelled.
pub fn render(
    scene: &Scene,
    query: &dyn RayQuery,
    options: &RenderOptions,
    control: &RenderControl,
) -> Result<(Film, RenderStatistics), RenderError> {
    let (width, height) = (options.width, options.height);
    if !(1..=MAX_SIDE).contains(&width) || !(1..=MAX_SIDE).contains(&height) {
        return Err(RenderError::Size { width, height });
    }
    if options.samples == 0 {
        return Err(RenderError::NoSamples);
    }
    let rendered: Option<Vec<_>> = tiles(width, height)
        .into_par_iter()
        .map(|tile| {
            if control.cancelled.load(Ordering::Relaxed) {
                return None;
            }
            let rendered = render_tile(scene, query, options, tile);
            control
                .finished_pixels
                .fetch_add(tile.pixel_count() as u64, Ordering::Relaxed);
            Some((tile, rendered))
        })
        .collect();
    let mut film = Film::new(width, height);
    let mut statistics = RenderStatistics::default();
    for (tile, (pixels, tile_statistics)) in rendered.ok_or(RenderError::Cancelled)? {
        for (y, row) in (tile.y..).zip(pixels.chunks(tile.width as usize)) {
            film.row_mut(y)[tile.x as usize..][..row.len()].copy_from_slice(row);
        }
        statistics += tile_statistics;
    }
    Ok((film, statistics))
}

const TILE_SIDE: u32 = 16;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug)]
struct Tile {
    x: u32,
    y: u32,
    width: u32,
    height: u32,
}

impl Tile {
    const fn pixel_count(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// The pixels, row by row.
    fn pixels(self) -> impl Iterator<Item = (u32, u32)> {
        (self.y..self.y + self.height)
            .flat_map(move |y| (self.x..self.x + self.width).map(move |x| (x, y)))
    }
}

fn tiles(width: u32, height: u32) -> Vec<Tile> {
    let starts = |size: u32| (0..size).step_by(TILE_SIDE as usize);
    starts(height)
        .flat_map(|y| {
            starts(width).map(move |x| Tile {
                x,
                y,
                width: TILE_SIDE.min(width - x),
                height: TILE_SIDE.min(height - y),
            })
        })
        .collect()
}

/// The camera rays of a tile are one batch per sample: they are coherent, and structures may use that.
fn render_tile(
    scene: &Scene,
    query: &dyn RayQuery,
    options: &RenderOptions,
    tile: Tile,
) -> (Vec<Vec3>, RenderStatistics) {
    let mut caster = RayCaster::new(query, options.count);
    let mut pixels = vec![Vec3::ZERO; tile.pixel_count()];
    let mut hits = vec![None; tile.pixel_count()];
    for sample in 0..options.samples {
        let rays: Vec<Ray> = tile
            .pixels()
            .map(|(x, y)| {
                let [dx, dy] = sampling::position_in_pixel(x, y, sample, options);
                let (x, y) = (f64::from(x) + dx, f64::from(y) + dy);
                scene.camera().ray(x, y, options.width, options.height)
            })
            .collect();
        caster.camera_hits(&rays, &mut hits);
        for ((pixel, ray), hit) in pixels.iter_mut().zip(&rays).zip(&hits) {
            *pixel += options
                .integrator
                .radiance(scene, &mut caster, ray, hit.as_ref());
        }
    }
    for pixel in &mut pixels {
        *pixel /= options.samples as f32;
    }
    (pixels, caster.statistics())
}

#[cfg(test)]
mod tests;
