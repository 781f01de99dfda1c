//! Builds a tree over a small wavy terrain, looks at it from above and tells what the tree costs.
#![expect(clippy::print_stdout, reason = "an example shows its results")]

use std::error::Error;

use tahko_bsp::{BspOptions, BspTree};
use tahko_geometry::{QueryCounts, Ray, RayQuery, TriangleMesh, glam::Vec3};

const SIZE: u16 = 100;

fn terrain() -> Result<TriangleMesh, Box<dyn Error>> {
    let vertices = (0..=SIZE).flat_map(|y| {
        (0..=SIZE).map(move |x| {
            let (x, y) = (f32::from(x), f32::from(y));
            Vec3::new(x, y, 3.0 * (0.2 * x).sin() * (0.3 * y).cos())
        })
    });
    let squares = (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| (u32::from(x), u32::from(y))));
    let row = u32::from(SIZE) + 1;
    let triangles = squares.flat_map(|(x, y)| {
        let corner = y * row + x;
        let (right, above) = (corner + 1, corner + row);
        [[corner, right, above], [right, above + 1, above]]
    });
    Ok(TriangleMesh::new(vertices.collect(), triangles.collect())?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mesh = terrain()?;
    let tree = BspTree::build(&mesh, &BspOptions::default())?;
    println!("{:#?}\n{:#?}", tree.statistics(), tree.bsp_statistics());

    let ray = Ray::new(Vec3::new(30.0, -20.0, 40.0), Vec3::new(0.1, 0.7, -0.6));
    let mut counts = QueryCounts::default();
    match tree.closest_hit_counted(&ray, &mut counts) {
        Some(hit) => println!("{hit:?} at {}", ray.at(hit.t)),
        None => println!("nothing is hit"),
    }
    println!("{counts:?}");
    Ok(())
}
