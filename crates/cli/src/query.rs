//! `tahko query`.

use std::io::Write;
use std::panic;
use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use anyhow::{Result, bail};
use rayon::prelude::*;
use tahko_tracer::geometry::{Ray, RayQuery};
use tahko_tracer::load::load_mesh;

use crate::args::QueryArguments;
use crate::progress::Progress;
use crate::rays::RayReader;
use crate::terminal::Terminal;
use crate::{hits, interrupt, output, structure};

/// Rays that are read, answered and written at once: enough to keep all threads busy.
const CHUNK: usize = 1 << 16;

/// Rays that one thread answers in one go.
const BATCH: usize = 1 << 10;

/// How long Ctrl-C may have to wait when no rays arrive.
const PATIENCE: Duration = Duration::from_millis(100);

pub(crate) fn run(arguments: &QueryArguments, terminal: &Terminal) -> Result<()> {
    let progress = terminal.progress();
    let to_stdout = arguments.out == Path::new("-");
    if !to_stdout {
        output::check(&arguments.out, &[&arguments.mesh, &arguments.rays])?;
    }
    let (reader, size) = RayReader::open(&arguments.rays)?;
    progress.phase(&format!("reading {}", arguments.mesh.display()));
    let (mesh, report) = load_mesh(&arguments.mesh)?;
    terminal.notes(&report);
    let (accel, precision) = (arguments.accel, arguments.precision);
    let accelerator = structure::build(accel, precision, &mesh, &arguments.mesh, progress)?;

    match size {
        Some(bytes) => progress.count("querying", bytes),
        None => progress.phase("querying"),
    }
    let start = Instant::now();
    let rays = RayStream::start(reader);
    let write = |writer: &mut dyn Write| answer(accelerator.query(), rays, writer, progress);
    let tally = if to_stdout {
        output::write_stdout(write)?
    } else {
        output::write_file(&arguments.out, write)?
    };
    progress.clear();
    terminal.summary(&format!(
        "{} triangles, {} built in {:.3} s, {} of {} rays hit, read and answered in {:.3} s",
        mesh.len(),
        accel.name(),
        accelerator.build_time().as_secs_f64(),
        tally.hits,
        tally.rays,
        start.elapsed().as_secs_f64(),
    ));
    Ok(())
}

/// How many rays there were, and how many of them hit.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    rays: u64,
    hits: u64,
}

/// Answers all rays in their order, with memory for a few chunks only.
fn answer(
    query: &dyn RayQuery,
    mut rays: RayStream,
    writer: &mut dyn Write,
    progress: &Progress,
) -> Result<Tally> {
    let mut tally = Tally::default();
    writer.write_all(hits::HEADER.as_bytes())?;
    while let Some(chunk) = rays.next()? {
        let batches = (tally.rays..).step_by(BATCH);
        let batches: Vec<_> = batches.zip(chunk.rays.chunks(BATCH)).collect();
        let answers: Vec<_> = batches
            .into_par_iter()
            .map(|(first, rays)| answer_batch(query, first, rays))
            .collect();
        for (text, hits) in answers {
            writer.write_all(&text)?;
            tally.hits += hits;
        }
        tally.rays += chunk.rays.len() as u64;
        progress.set(chunk.end);
    }
    Ok(tally)
}

/// The lines for some rays, and how many of them hit.
fn answer_batch(query: &dyn RayQuery, first: u64, rays: &[Ray]) -> (Vec<u8>, u64) {
    let mut found = vec![None; rays.len()];
    query.closest_hits(rays, &mut found);
    let hits = found.iter().flatten().count() as u64;
    (hits::to_csv(first, &found), hits)
}

/// Rays that another thread reads, a chunk ahead.
///
/// That thread is never waited for unless it has something to give: a file that no one is writing to, such as
/// a terminal, must not keep Ctrl-C from working.
struct RayStream {
    chunks: Receiver<Result<Chunk>>,
    reader: Option<JoinHandle<()>>,
}

/// Some rays, in their order.
struct Chunk {
    rays: Vec<Ray>,
    /// Bytes of the file up to the end of the chunk.
    end: u64,
}

impl RayStream {
    fn start(mut reader: RayReader) -> Self {
        let (sender, chunks) = sync_channel(1);
        let reader = thread::spawn(move || {
            loop {
                let chunk = reader.read(CHUNK).map(|rays| Chunk {
                    rays,
                    end: reader.bytes_read(),
                });
                let is_last = chunk
                    .as_ref()
                    .map_or(true, |chunk| chunk.rays.len() < CHUNK);
                // The receiver goes away when the rays are not wanted any more.
                if sender.send(chunk).is_err() || is_last {
                    return;
                }
            }
        });
        Self {
            chunks,
            reader: Some(reader),
        }
    }

    /// The next rays, or `None` after the last.
    fn next(&mut self) -> Result<Option<Chunk>> {
        loop {
            if interrupt::requested() {
                bail!("interrupted");
            }
            match self.chunks.recv_timeout(PATIENCE) {
                Ok(chunk) => return chunk.map(Some),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    // A panic of the reader must not look like the end of the file.
                    if let Some(Err(cause)) = self.reader.take().map(JoinHandle::join) {
                        panic::resume_unwind(cause);
                    }
                    return Ok(None);
                }
            }
        }
    }
}
