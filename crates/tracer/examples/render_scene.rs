//! Renders a scene file through a BVH: `cargo run --release --example render_scene -- SCENE OUT.png`.

use std::error::Error;
use std::path::PathBuf;

use tahko_tracer::accelerator::{Accelerator, StructureKind};
use tahko_tracer::geometry::Precision;
use tahko_tracer::load::load_scene;
use tahko_tracer::render::{DEFAULT_DEPTH, Integrator, RenderControl, RenderOptions, render};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let (Some(input), Some(output)) = (arguments.next(), arguments.next()) else {
        return Err("usage: render_scene SCENE OUT.png".into());
    };
    let (scene, _) = load_scene(&input)?;
    let accelerator = Accelerator::build(StructureKind::Bvh, Precision::default(), scene.mesh())?;
    let options = RenderOptions {
        samples: 4,
        integrator: Integrator::Whitted {
            max_depth: DEFAULT_DEPTH,
        },
        ..RenderOptions::default()
    };
    let (film, _) = render(
        &scene,
        accelerator.query(),
        &options,
        &RenderControl::default(),
    )?;
    film.save(&output, scene.exposure())?;
    Ok(())
}
