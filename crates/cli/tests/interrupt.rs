//! Ctrl-C in the middle of work.

#![cfg(unix)]

mod common;

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, Command, Stdio};

use common::{Sandbox, two_triangles, wait};

/// Presses Ctrl-C and waits for the end.
#[expect(clippy::unwrap_used, reason = "a part of tests")]
fn interrupt(mut child: Child) -> Option<i32> {
    let id = child.id().to_string();
    let kill = Command::new("kill").args(["-INT", &id]).status();
    assert!(kill.unwrap().success(), "no signal was sent");
    let ended = wait::comes_true(|| child.try_wait().unwrap().is_some());
    assert!(ended, "Ctrl-C does not end the program");
    child.wait().unwrap().code()
}

#[test]
fn rendering_ends_at_once_and_leaves_the_old_picture() {
    let sandbox = Sandbox::new();
    sandbox.write(
        "a.obj",
        "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    );
    sandbox.write("a.png", "old");
    // Hours of work, if nobody interrupts it.
    let mut child = sandbox
        .command("render a.obj -o a.png --stats a.json --width 8000 --height 8000 --spp 10000")
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // The note says that the scene has been read.
    let mut note = String::new();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    stderr.read_line(&mut note).unwrap();
    assert!(note.contains("none.mtl"), "{note}");
    assert_eq!(interrupt(child), Some(130));
    assert_eq!(sandbox.files(), ["a.obj", "a.png"]);
    assert_eq!(sandbox.read("a.png"), b"old");
}

#[test]
fn a_half_written_file_of_hits_is_removed() {
    let sandbox = Sandbox::new();
    sandbox.write("mesh.ply", two_triangles());
    sandbox.write("hits.csv", "old");
    let mut child = sandbox
        .command("query mesh.ply --rays - --out hits.csv")
        .stdin(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    // More than a chunk, and then a pause in which more could come.
    let mut rays = child.stdin.take().unwrap();
    let text = "ox,oy,oz,dx,dy,dz,tmin,tmax\n".to_owned() + &"0,0,-1,0,0,1,0,inf\n".repeat(100_000);
    rays.write_all(text.as_bytes()).unwrap();
    let writes = wait::comes_true(|| sandbox.files().len() == 3);
    assert!(writes, "hits are being written");
    assert_eq!(interrupt(child), Some(130));
    assert_eq!(sandbox.files(), ["hits.csv", "mesh.ply"]);
    assert_eq!(sandbox.read("hits.csv"), b"old");
}

#[test]
fn verifying_ends_at_once() {
    let sandbox = Sandbox::new();
    sandbox.write(
        "a.obj",
        "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    );
    let mut child = sandbox
        .command("verify a.obj --rays 10000000")
        .stderr(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    // The note says that the mesh has been read.
    let mut note = String::new();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    stderr.read_line(&mut note).unwrap();
    assert!(note.contains("none.mtl"), "{note}");
    assert_eq!(interrupt(child), Some(130));
}
