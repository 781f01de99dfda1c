//! Numbers that a file should not have.

use std::ops::Range;
use std::path::Path;

use crate::load::Import;
use crate::load::gltf::fault::Fault;
use crate::load::gltf::read_bytes;

/// A file with most of what is read and checked.
const RICH: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
    "extensionsUsed":["KHR_lights_punctual"],"extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","range":2}]}},
    "buffers":[{"byteLength":64,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAACAPwAAgD8AAAAAAAABAAIAAwAAAAAAAAAAAA=="}],
    "bufferViews":[{"buffer":0,"byteLength":48,"byteStride":12},{"buffer":0,"byteOffset":48,"byteLength":8},
        {"buffer":0,"byteOffset":56,"byteLength":2},{"buffer":0,"byteLength":12}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
        {"bufferView":1,"componentType":5123,"count":4,"type":"SCALAR"},
        {"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":1,
            "indices":{"bufferView":2,"componentType":5121},"values":{"bufferView":3}}},
        {"componentType":5126,"count":2,"type":"SCALAR"},{"bufferView":3,"componentType":5126,"count":1,"type":"VEC3"}],
    "cameras":[{"type":"perspective","perspective":{"yfov":1.2,"znear":0.1,"zfar":9}}],
    "materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,0.5,0,1],"roughnessFactor":0.1}}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":2},"indices":1,"material":0,"mode":5,
        "targets":[{"NORMAL":2}]}],"weights":[0.5]}],
    "skins":[{"joints":[1],"skeleton":1}],
    "animations":[{"channels":[{"sampler":0,"target":{"node":1,"path":"scale"}}],
        "samplers":[{"input":3,"output":4,"interpolation":"LINEAR"}]}],
    "nodes":[{"mesh":0,"skin":0,"children":[1],"scale":[1,2,1],"rotation":[0,0,0,1]},
        {"camera":0,"translation":[0,0,4],"extensions":{"KHR_lights_punctual":{"light":0}}}]}"#;

/// The runs of digits in a text, outside of base64 data.
fn numbers(text: &str) -> Vec<Range<usize>> {
    let bytes = text.as_bytes();
    let is_start = |at: usize| bytes[at].is_ascii_digit() && b":[,".contains(&bytes[at - 1]);
    (1..bytes.len())
        .filter(|at| is_start(*at))
        .map(|start| {
            let rest = bytes[start..].iter();
            let length = rest.take_while(|byte| byte.is_ascii_digit() || **byte == b'.');
            start..start + length.count()
        })
        .collect()
}

fn read_text(text: &str, path: &Path) -> Result<Import, Fault> {
    let mut import = Import::default();
    read_bytes(text.as_bytes(), false, path, &mut import)?;
    Ok(import)
}

#[test]
fn no_hostile_number_makes_the_loader_panic() {
    const HOSTILE: [&str; 12] = [
        "0",
        "1",
        "2",
        "3",
        "7",
        "-1",
        "255",
        "65536",
        "4294967295",
        "18446744073709551615",
        "1e38",
        "null",
    ];
    let path = Path::new("rich.gltf");
    let fault = read_text(RICH, path).map(|import| import.builder.triangle_count());
    // The animation has two key frames and one value.
    assert!(matches!(fault, Err(Fault::Invalid { .. })), "{fault:?}");
    let sound = RICH.replace(
        r#""count":1,"type":"VEC3"}]"#,
        r#""count":2,"type":"VEC3"}]"#,
    );
    let sound = sound.replace(
        r#"{"buffer":0,"byteLength":12}"#,
        r#"{"buffer":0,"byteLength":24}"#,
    );
    assert_eq!(read_text(&sound, path).unwrap().builder.triangle_count(), 2);
    let mut refused = 0;
    for range in numbers(&sound) {
        for number in HOSTILE {
            let mut text = sound.clone();
            text.replace_range(range.clone(), number);
            refused += usize::from(read_text(&text, path).is_err());
        }
    }
    assert!(refused > 100, "{refused}");
}
