//! Rates of contenders that take turns.
//!
//! In a round every contender traces the same rays, another one beginning each time, so that what slows the machine down slows all of them.
//! Where the slowest one would take longer than a turn for all rays, all of them trace the same pieces, which are spread evenly over the set and take it a turn: other rays would be
//! other questions, easier or harder. Who is through in a small part of a turn traces them again. Before each turn an eighth of the
//! pieces is traced untimed, to fill the caches. On one thread the time is the thread's own: what other programs take does not count.

use std::hint::black_box;
use std::time::{Duration, Instant};

use rayon::ThreadPool;
use rayon::prelude::*;
use tahko_tracer::geometry::{Hit, Ray};

use crate::contender::Contender;
use crate::report::{RayClass, Sample};

/// How long is measured.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    /// Rounds in which the contenders take turns.
    pub(crate) rounds: usize,
    /// About how long a turn takes at most, on each thread; longer where [`FEWEST`] rays do.
    pub(crate) turn: Duration,
}

/// On how many threads.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Threads<'a> {
    /// The calling one.
    One,
    /// Those of a pool.
    Pool(&'a ThreadPool),
}

impl Threads<'_> {
    pub(crate) fn count(self) -> usize {
        match self {
            Self::One => 1,
            Self::Pool(pool) => pool.current_num_threads(),
        }
    }
}

/// The rays of a class.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Questions<'a> {
    pub(crate) class: RayClass,
    pub(crate) rays: &'a [Ray],
}

/// The most rays that are handed over in one go: enough for a batch to be sorted, and few enough for their hits to stay in the cache.
const LARGEST_PIECE: usize = 4096;
/// The fewest.
const SMALLEST_PIECE: usize = 64;
/// Pieces at least, for each thread: they are spread over the set and among the threads.
const PIECES: usize = 8;
/// The fewest rays of a turn, however slow a contender is: so many say something about a class.
const FEWEST: usize = PIECES * SMALLEST_PIECE;
/// The part of the pieces that is traced untimed before each turn.
const WARM_UP: usize = 8;
/// A contender that is through in less than this part of a turn traces the rays again, until it takes as long: the shorter, the larger is the part of noise.
const SHORTEST: f64 = 1.0 / 16.0;

/// Million rays per second: for each contender one value a round. `advance` is told after each turn. There are rays.
pub(crate) fn rates(
    contenders: &[&dyn Contender],
    questions: Questions<'_>,
    threads: Threads<'_>,
    effort: &Effort,
    advance: &dyn Fn(),
) -> Vec<Sample> {
    let plans = Plan::of_all(contenders, questions, threads, effort.turn);
    let mut rates = vec![Sample::default(); contenders.len()];
    for round in 0..effort.rounds {
        for turn in 0..contenders.len() {
            let index = (turn + round) % contenders.len();
            rates[index].push(plans[index].rate(threads));
            advance();
        }
    }
    rates
}

/// The pieces that a contender traces in its turns.
struct Plan<'a> {
    contender: &'a dyn Contender,
    class: RayClass,
    pieces: Vec<&'a [Ray]>,
    rays: usize,
    /// How often it traces them in a turn.
    passes: usize,
}

/// A place in a part of the pieces: another one in each, or a part for every row of a picture would be a column of it.
fn somewhere(part: u32, len: usize) -> usize {
    /// The golden ratio's fraction, of which the multiples are spread evenly.
    const GOLDEN: u32 = 0x9e37_79b9;
    let fraction = u64::from(part.wrapping_mul(GOLDEN));
    ((fraction * len as u64) >> 32) as usize
}

impl<'a> Plan<'a> {
    /// The plans of some contenders, with the same pieces for all.
    fn of_all(
        contenders: &[&'a dyn Contender],
        questions: Questions<'a>,
        threads: Threads<'_>,
        turn: Duration,
    ) -> Vec<Self> {
        let rates: Vec<f64> = contenders
            .iter()
            .map(|contender| Self::rough_rate(*contender, questions, turn))
            .collect();
        let seconds = turn.as_secs_f64() * threads.count() as f64;
        let slowest = rates.iter().copied().fold(f64::INFINITY, f64::min);
        let count = rays_of_a_turn(slowest * seconds, questions.rays.len());
        let piece = (count / (PIECES * threads.count())).clamp(SMALLEST_PIECE, LARGEST_PIECE);
        let plan = |(contender, rate): (&&'a dyn Contender, f64)| {
            let mut plan = Self::spread(*contender, questions, count, piece);
            plan.passes = passes_of_a_turn(rate * seconds, plan.rays);
            plan
        };
        contenders.iter().zip(rates).map(plan).collect()
    }

    /// How many rays a second, about, on one thread? More and more rays, until they take a tenth of a turn.
    fn rough_rate(contender: &dyn Contender, questions: Questions<'_>, turn: Duration) -> f64 {
        let all = questions.rays.len();
        let mut count = SMALLEST_PIECE.min(all);
        loop {
            let sample = Plan::spread(contender, questions, count, count.div_ceil(PIECES));
            let seconds = sample.seconds(Threads::One);
            if count >= all || seconds > 0.1 * turn.as_secs_f64() {
                break sample.rays as f64 / seconds.max(f64::MIN_POSITIVE);
            }
            count = (count * 4).min(all);
        }
    }

    /// About `count` rays once, in pieces that are spread evenly over the set.
    fn spread(
        contender: &'a dyn Contender,
        Questions { class, rays }: Questions<'a>,
        count: usize,
        piece: usize,
    ) -> Self {
        let all: Vec<&[Ray]> = rays.chunks(piece.max(1)).collect();
        let wanted = count.div_ceil(piece.max(1)).clamp(1, all.len().max(1));
        let parts = (0..wanted).map(|part| [part, part + 1].map(|end| end * all.len() / wanted));
        let pieces: Vec<&[Ray]> = (0u32..)
            .zip(parts)
            .map(|(part, [first, end])| all[first + somewhere(part, end - first)])
            .collect();
        Self {
            contender,
            class,
            rays: pieces.iter().map(|piece| piece.len()).sum(),
            pieces,
            passes: 1,
        }
    }

    /// Million rays per second in one turn.
    fn rate(&self, threads: Threads<'_>) -> f64 {
        let warm_up = self.pieces.len().div_ceil(WARM_UP);
        self.trace(&self.pieces[..warm_up], threads);
        (self.rays * self.passes) as f64 / self.seconds(threads) / 1e6
    }

    fn seconds(&self, threads: Threads<'_>) -> f64 {
        match threads {
            Threads::One => {
                let start = thread_time();
                self.pass(threads);
                (thread_time() - start).as_secs_f64()
            }
            Threads::Pool(_) => {
                let start = Instant::now();
                self.pass(threads);
                start.elapsed().as_secs_f64()
            }
        }
    }

    /// Traces all pieces as often as is planned.
    fn pass(&self, threads: Threads<'_>) {
        for _ in 0..self.passes {
            self.trace(&self.pieces, threads);
        }
    }

    fn trace(&self, pieces: &[&[Ray]], threads: Threads<'_>) {
        let mut answers = Answers::default();
        match threads {
            Threads::One => {
                for rays in pieces {
                    answers.ask(self.contender, self.class, rays);
                }
            }
            Threads::Pool(pool) => pool.install(|| {
                pieces
                    .par_iter()
                    .for_each_init(Answers::default, |answers, rays| {
                        answers.ask(self.contender, self.class, rays);
                    });
            }),
        }
    }
}

/// How many of all rays are traced, if the slowest contender gets through so many in a turn.
fn rays_of_a_turn(affordable: f64, all: usize) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to a count"
    )]
    let affordable = affordable.clamp(0.0, all as f64) as usize;
    affordable.max(FEWEST.min(all))
}

/// How often a contender traces some rays that would get through so many in a turn.
fn passes_of_a_turn(affordable: f64, rays: usize) -> usize {
    // Half a pass too few is near enough.
    let passes = (affordable * SHORTEST / rays as f64).round();
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to a count"
    )]
    let passes = passes.clamp(1.0, 1e6) as usize;
    passes
}

/// Room for the answers to a piece.
#[derive(Default)]
struct Answers {
    hits: Vec<Option<Hit>>,
    found: Vec<bool>,
}

impl Answers {
    fn ask(&mut self, contender: &dyn Contender, class: RayClass, rays: &[Ray]) {
        if class.asks_any() {
            self.found.resize(rays.len(), false);
            contender.any_hits(rays, &mut self.found);
            black_box(&self.found);
        } else {
            self.hits.resize(rays.len(), None);
            contender.closest_hits(rays, &mut self.hits);
            black_box(&self.hits);
        }
    }
}

/// The processor time of this thread; where the system does not tell it, the time since the program's first look at the clock.
fn thread_time() -> Duration {
    #[cfg(unix)]
    {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
        // Neither is negative, and the second is below a thousand million.
        let seconds = u64::try_from(time.tv_sec).unwrap_or(0);
        let nanoseconds = u32::try_from(time.tv_nsec).unwrap_or(0);
        Duration::new(seconds, nanoseconds)
    }
    #[cfg(not(unix))]
    {
        static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
        START.get_or_init(Instant::now).elapsed()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use tahko_tracer::geometry::glam::Vec3;

    use super::*;

    /// Takes note of the rays that it is asked.
    #[derive(Default)]
    struct Recorder {
        asked: Mutex<Vec<f32>>,
    }

    impl Contender for Recorder {
        fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
            assert_eq!(rays.len(), hits.len());
            self.asked
                .lock()
                .unwrap()
                .extend(rays.iter().map(|ray| ray.origin.x));
        }

        fn any_hits(&self, rays: &[Ray], found: &mut [bool]) {
            assert_eq!(rays.len(), found.len());
        }
    }

    fn rays(count: u16) -> Vec<Ray> {
        (0..count)
            .map(|index| Ray::new(Vec3::X * f32::from(index), Vec3::Y))
            .collect()
    }

    fn questions(rays: &[Ray]) -> Questions<'_> {
        Questions {
            class: RayClass::Random,
            rays,
        }
    }

    #[test]
    fn a_part_of_the_rays_is_spread_over_all_of_them() {
        let rays = rays(6400);
        let recorder = Recorder::default();
        let plan = Plan::spread(&recorder, questions(&rays), 640, 64);
        assert_eq!(plan.rays, 640);
        plan.trace(&plan.pieces, Threads::One);
        let asked = recorder.asked.into_inner().unwrap();
        let mut sorted = asked.clone();
        sorted.dedup();
        assert_eq!(sorted.len(), 640, "each ray once");
        let mean = asked.iter().sum::<f32>() / 640.0;
        assert!((mean - 3200.0).abs() < 640.0, "{mean}");
    }

    /// A picture of 80 rows with 10 tiles of 64 rays each: pieces of one column may all be of the sky.
    #[test]
    fn pieces_are_of_many_columns_of_a_picture() {
        let rays = rays(51_200);
        let recorder = Recorder::default();
        let plan = Plan::spread(&recorder, questions(&rays), FEWEST, SMALLEST_PIECE);
        let tile = |piece: &&[Ray]| piece[0].origin.x / 64.0;
        let mut rows: Vec<f32> = plan
            .pieces
            .iter()
            .map(|piece| (tile(piece) / 10.0).floor())
            .collect();
        let mut columns: Vec<f32> = plan.pieces.iter().map(|piece| tile(piece) % 10.0).collect();
        for places in [&mut rows, &mut columns] {
            places.sort_by(f32::total_cmp);
            places.dedup();
        }
        assert_eq!(rows.len(), PIECES, "{rows:?}");
        assert!(columns.len() > PIECES / 2, "{columns:?}");
    }

    #[test]
    fn all_rays_are_traced_where_there_is_time_on_one_thread_and_on_several() {
        let rays = rays(1000);
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(2)
            .build()
            .unwrap();
        for threads in [Threads::One, Threads::Pool(&pool)] {
            let recorder = Recorder::default();
            let turn = Duration::from_secs(1000);
            let plans = Plan::of_all(&[&recorder], questions(&rays), threads, turn);
            let [plan] = plans.try_into().ok().expect("one contender");
            recorder.asked.lock().unwrap().clear();
            plan.trace(&plan.pieces, threads);
            let mut asked = recorder.asked.lock().unwrap().clone();
            asked.sort_by(f32::total_cmp);
            assert!(
                asked.iter().copied().eq((0..1000u16).map(f32::from)),
                "{threads:?}"
            );
        }
    }

    /// Takes 50 microseconds for each ray.
    struct Slow(Recorder);

    impl Contender for Slow {
        fn closest_hits(&self, rays: &[Ray], hits: &mut [Option<Hit>]) {
            let start = thread_time();
            self.0.closest_hits(rays, hits);
            let took = Duration::from_micros(50) * u32::try_from(rays.len()).unwrap();
            while thread_time() - start < took {
                std::hint::spin_loop();
            }
        }

        fn any_hits(&self, rays: &[Ray], found: &mut [bool]) {
            self.0.any_hits(rays, found);
        }
    }

    #[test]
    fn a_slow_contender_and_a_fast_one_trace_the_same_rays() {
        let rays = rays(60_000);
        let (fast, slow) = (Recorder::default(), Slow(Recorder::default()));
        let turn = Duration::from_millis(40);
        let plans = Plan::of_all(&[&fast, &slow], questions(&rays), Threads::One, turn);
        for recorder in [&fast, &slow.0] {
            recorder.asked.lock().unwrap().clear();
        }
        for plan in &plans {
            plan.trace(&plan.pieces, Threads::One);
        }
        let asked = [&fast, &slow.0].map(|recorder| recorder.asked.lock().unwrap().clone());
        assert_eq!(asked[0], asked[1]);
        assert!(
            (FEWEST..rays.len()).contains(&asked[0].len()),
            "some, not all"
        );
    }

    #[test]
    fn rates_tell_how_many_rays_a_turn_has_and_how_often() {
        assert_eq!(rays_of_a_turn(2000.5, 60_000), 2000);
        assert_eq!(
            rays_of_a_turn(1e9, 60_000),
            60_000,
            "no more than there are"
        );
        assert_eq!(rays_of_a_turn(3.0, 60_000), FEWEST);
        assert_eq!(rays_of_a_turn(3.0, 100), 100);
        assert_eq!(rays_of_a_turn(f64::INFINITY, 100), 100, "nobody was timed");
        // A sixteenth of a turn at the least.
        assert_eq!(passes_of_a_turn(2000.0, 2000), 1);
        assert_eq!(passes_of_a_turn(16.0 * 2000.0, 2000), 1);
        assert_eq!(passes_of_a_turn(48.0 * 2000.0, 2000), 3);
    }

    #[test]
    fn all_passes_count_as_rays() {
        let rays = rays(1000);
        let recorder = Recorder::default();
        let mut plan = Plan::spread(&recorder, questions(&rays), 1000, 100);
        plan.passes = 3;
        plan.pass(Threads::One);
        assert_eq!(recorder.asked.lock().unwrap().len(), 3 * plan.rays);
    }

    #[test]
    fn every_contender_gets_a_rate_in_every_round() {
        let rays = rays(100);
        let contenders = [Recorder::default(), Recorder::default()];
        let contenders: Vec<&dyn Contender> =
            contenders.iter().map(|c| c as &dyn Contender).collect();
        let effort = Effort {
            rounds: 3,
            turn: Duration::from_millis(1),
        };
        let turns = std::cell::Cell::new(0);
        let advance = || turns.set(turns.get() + 1);
        let rates = rates(
            &contenders,
            questions(&rays),
            Threads::One,
            &effort,
            &advance,
        );
        assert!(
            rates
                .iter()
                .all(|rate| rate.values().len() == 3 && rate.low() > 0.0)
        );
        assert_eq!(turns.get(), 6);
    }
}
