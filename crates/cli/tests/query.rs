//! `tahko query`, as its users see it.

mod common;

use common::{Sandbox, hills, two_triangles};

const HEADER: &str = "ox,oy,oz,dx,dy,dz,tmin,tmax\n";

/// Rays against the two triangles, with their hits worked out by hand.
const RAYS: &str = "\
ox,oy,oz,dx,dy,dz,tmin,tmax
0.25,0.5,-1,0,0,1,0,inf
0.25,0.5,-1,0,0,2,0,inf
0.25,0.5,4,0,0,-0.5,0,inf
0.25,0.5,-1,0,0,1,0,1
0.25,0.5,-1,0,0,1,0,0.99999994
0.25,0.5,-1,0,0,1,1,1
0.25,0.5,-1,0,0,1,1.0000001,inf
0.25,0.5,-1,0,0,1,1.0000001,2.5
2,2,-1,0,0,1,0,inf
0.25,0.5,1,0,0,1,-1,0
0.25,0.5,1,1,0,0,-inf,inf
0.25,0.5,1,0,0,1,-inf,inf
";

const HITS: &str = "\
ray,hit,t,triangle,u,v
0,1,1,0,0.25,0.5
1,1,0.5,0,0.25,0.5
2,1,4,1,0.25,0.5
3,1,1,0,0.25,0.5
4,0,,,,
5,1,1,0,0.25,0.5
6,1,3,1,0.25,0.5
7,0,,,,
8,0,,,,
9,1,-1,0,0.25,0.5
10,0,,,,
11,1,-1,0,0.25,0.5
";

#[test]
fn hits_are_those_worked_out_by_hand() {
    let sandbox = Sandbox::new();
    sandbox.write("mesh.ply", two_triangles());
    sandbox.write("rays.csv", RAYS);
    for structure in ["brute", "bsp", "kdtree", "bvh"] {
        for precision in ["fast", "watertight", "exact"] {
            let options = format!("--accel {structure} --precision {precision}");
            let line = format!("query mesh.ply --rays rays.csv --out hits.csv {options}");
            let run = sandbox.run(&line).succeeds();
            assert_eq!(run.stdout, "");
            assert!(run.stderr.contains("8 of 12 rays hit"), "{}", run.stderr);
            assert_eq!(sandbox.read_text("hits.csv"), HITS, "{options}");
        }
    }
    assert_eq!(sandbox.files(), ["hits.csv", "mesh.ply", "rays.csv"]);
}

#[test]
fn standard_input_and_output_work_like_files() {
    let sandbox = Sandbox::new();
    sandbox.write("mesh.ply", two_triangles());
    let run = sandbox.run_with_input("query mesh.ply --rays - --out -", RAYS);
    assert_eq!(run.succeeds().stdout, HITS);
    let run = sandbox.run_with_input("query mesh.ply --rays - --out -", HEADER);
    assert_eq!(run.succeeds().stdout, "ray,hit,t,triangle,u,v\n");
}

#[test]
fn order_is_kept_over_many_chunks_and_threads() {
    let sandbox = Sandbox::new();
    sandbox.write("hills.ply", hills(10));
    let mut rays = HEADER.to_owned();
    let count = 150_000;
    for ray in 0..count {
        let (x, z) = ((ray % 1200) as f32 / 100.0, (ray / 1200) as f32 / 12.0);
        rays += &format!("{x},5,{z},0.01,-1,0.02,0,inf\n");
    }
    sandbox.write("rays.csv", rays);
    for (name, options) in [
        ("a", "--threads 1"),
        ("b", "--threads 2"),
        ("c", "--threads 2 --accel bsp"),
        ("d", "--threads 2 --accel kdtree"),
    ] {
        sandbox
            .run(&format!(
                "query hills.ply --rays rays.csv --out {name} {options}"
            ))
            .succeeds();
        assert!(sandbox.read("a") == sandbox.read(name), "{name} differs");
    }
    let text = sandbox.read_text("a");
    let mut numbers = text.lines().skip(1).map(|line| line.split(',').next());
    for ray in 0..count {
        assert_eq!(numbers.next(), Some(Some(ray.to_string().as_str())));
    }
    assert_eq!(numbers.next(), None);
    let hits = text
        .lines()
        .filter(|line| line.split(',').nth(1) == Some("1"));
    assert!((90_000..count).contains(&hits.count()), "most rays hit");
}

#[test]
fn bad_input_is_named_and_leaves_the_old_hits() {
    let sandbox = Sandbox::new();
    sandbox.write("mesh.ply", two_triangles());
    sandbox.write("nan.ply", two_triangles().replace("0 1 0", "0 nan 0"));
    sandbox.write("rays.csv", RAYS);
    sandbox.write("old.csv", "old");
    let bad_rays = |name: &str, line: &str| sandbox.write(name, format!("{RAYS}{line}\n"));
    bad_rays("nan.csv", "0,0,0,1,nan,0,0,1");
    bad_rays("word.csv", "0,0,zero,1,0,0,0,1");
    bad_rays("few.csv", "0,0,0,1,0,0");
    bad_rays("huge.csv", "0,0,0,1e39,0,0,0,1");
    bad_rays("zero.csv", "0,0,0,0,0,0,0,1");
    bad_rays("swapped.csv", "0,0,0,1,0,0,1,0");
    sandbox.write("header.csv", "x,y,z\n");
    // Beyond the first chunk, when hits have been written already.
    let ray = "0.25,0.5,-1,0,0,1,0,inf\n";
    sandbox.write("late.csv", format!("{HEADER}{}oops\n", ray.repeat(100_000)));
    let files = sandbox.files();
    for (rays, parts) in [
        ("none.csv", vec!["none.csv", "No such file"]),
        (
            "header.csv",
            vec!["header.csv", "line 1", "ox,oy,oz,dx,dy,dz,tmin,tmax"],
        ),
        ("nan.csv", vec!["nan.csv", "line 14", "dy is NaN"]),
        ("word.csv", vec!["word.csv", "line 14", "'zero'"]),
        ("few.csv", vec!["few.csv", "line 14", "8 fields"]),
        ("huge.csv", vec!["huge.csv", "line 14", "'1e39'"]),
        ("zero.csv", vec!["zero.csv", "line 14", "direction is zero"]),
        (
            "swapped.csv",
            vec!["swapped.csv", "line 14", "tmin 1 is above tmax 0"],
        ),
        ("late.csv", vec!["late.csv", "line 100002", "'oops'"]),
    ] {
        let line = format!("query mesh.ply --rays {rays} --out old.csv");
        sandbox.run(&line).fails(1, &parts);
        assert_eq!(sandbox.files(), files, "after {rays}");
        assert_eq!(sandbox.read("old.csv"), b"old", "after {rays}");
    }
    for (arguments, code, parts) in [
        ("nan.ply --rays rays.csv --out old.csv", 1, vec!["nan.ply"]),
        (
            "none.ply --rays rays.csv --out old.csv",
            1,
            vec!["none.ply"],
        ),
        (
            "mesh.ply --rays rays.csv --out rays.csv",
            1,
            vec!["two purposes"],
        ),
        (
            "mesh.ply --rays rays.csv --out none/a.csv",
            1,
            vec!["none/a.csv"],
        ),
        ("mesh.ply --rays rays.csv", 2, vec!["--out"]),
        (
            "mesh.ply --rays rays.csv --out old.csv --precision exakt",
            2,
            vec!["exakt"],
        ),
    ] {
        sandbox
            .run(&format!("query {arguments}"))
            .fails(code, &parts);
        assert_eq!(sandbox.files(), files, "after {arguments}");
        assert_eq!(sandbox.read("old.csv"), b"old", "after {arguments}");
    }
}

#[cfg(unix)]
#[test]
fn a_reader_that_leaves_early_is_no_error() {
    use std::io::{BufRead, BufReader};
    use std::process::Stdio;
    let sandbox = Sandbox::new();
    sandbox.write("mesh.ply", two_triangles());
    let ray = "0.25,0.5,-1,0,0,1,0,inf\n";
    sandbox.write("rays.csv", format!("{HEADER}{}", ray.repeat(200_000)));
    let mut child = sandbox
        .command("query mesh.ply --rays rays.csv --out -")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    let mut stdout = BufReader::new(child.stdout.take().unwrap());
    stdout.read_line(&mut line).unwrap();
    assert_eq!(line, "ray,hit,t,triangle,u,v\n");
    drop(stdout);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
}

/// A triangle of denormal size over one that is as large as numbers go.
const EXTREMES: &str = "\
v 0 0 0
v 1e-44 0 0
v 0 1e-44 0
v -3e38 -3e38 -5
v 3e38 -3e38 -5
v 0 3e38 -5
f 1 2 3
f 4 5 6
";

#[test]
fn answers_are_exact_from_denormals_to_the_largest_numbers() {
    // 1e-44 is seven steps of f32, 1.4e-45 is one.
    let rays = format!(
        "{HEADER}\
        2.8e-45,2.8e-45,1,0,0,-1,0,inf\n\
        9.8e-45,0,1,0,0,-1,0,inf\n\
        9.8e-45,1.4e-45,1,0,0,-1,0,inf\n\
        0,0,3e38,0,0,-1e38,0,inf\n\
        2.8e-45,2.8e-45,1,0,0,-1.4e-45,0,inf\n\
        2.8e-45,2.8e-45,1.4e-45,0,0,-1,0,inf\n\
        1,1,-5.0000005,0,0,1,0,inf\n\
        1.5e38,0,3e38,0,0,-3e38,0,inf\n\
        1.5e38,0.01,3e38,0,0,-3e38,0,inf\n"
    );
    let sandbox = Sandbox::new();
    sandbox.write("mesh.obj", EXTREMES);
    sandbox.write("rays.csv", &rays);
    for structure in ["brute", "bsp", "kdtree", "bvh"] {
        let line = format!("query mesh.obj --rays rays.csv --out - --accel {structure}");
        let hits = sandbox.run(&line).succeeds().stdout;
        let found: Vec<String> = hits
            .lines()
            .skip(1)
            .map(|line| {
                line.split(',')
                    .skip(1)
                    .take(3)
                    .collect::<Vec<_>>()
                    .join(" ")
            })
            .collect();
        let expected = [
            "1 1 0",
            "1 1 0",
            // One step beyond its edge.
            "1 6 1",
            "1 3 0",
            // 2^149 is beyond the largest number.
            "1 340282350000000000000000000000000000000 0",
            "1 0.000000000000000000000000000000000000000000001 0",
            "1 0.00000047683716 1",
            // On the edge of the large triangle, and beside it.
            "1 1 1",
            "0  ",
        ];
        assert_eq!(found, expected, "{structure}");
    }
}
