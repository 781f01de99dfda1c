//! The classes of rays in words.

use super::super::RayClass;

pub(super) const fn meaning(class: RayClass) -> &'static str {
    match class {
        RayClass::Primary => "through the pixels of a picture, tile by tile; closest hit",
        RayClass::Shadow => "from the primary hits to the first light; any hit",
        RayClass::Diffuse => {
            "from the primary hits in random directions and random order, as light bounces off a diffuse surface; closest hit"
        }
        RayClass::Random => "through two random points of the scene’s bounds; closest hit",
        RayClass::Edge => "from random points through the middles of edges; closest hit",
        RayClass::Vertex => "from random points through vertices; closest hit",
    }
}

/// With a capital letter at the beginning.
pub(super) fn capital(text: &str) -> String {
    let mut characters = text.chars();
    let first = characters.next().map(|first| first.to_ascii_uppercase());
    first.into_iter().chain(characters).collect()
}
