//! Which line is the lowest where: after how many rays a slower build has paid for itself.

/// A build and what each ray then costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line {
    /// Seconds before the first ray.
    pub(super) build: f64,
    /// Seconds for each ray.
    pub(super) ray: f64,
}

/// A stretch on which a line is the lowest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stretch {
    /// Which line.
    pub(super) line: usize,
    /// The number of rays from which on it is the lowest.
    pub(super) from: f64,
    /// The number of rays from which on the next one is; infinite for the last.
    pub(super) to: f64,
}

/// The lower envelope of `build + rays · ray`, from no rays to any number of them.
pub(super) fn lower(lines: &[Line]) -> Vec<Stretch> {
    let is_finite = |line: &Line| line.build.is_finite() && line.ray.is_finite();
    let candidates: Vec<usize> = (0..lines.len())
        .filter(|index| is_finite(&lines[*index]))
        .collect();
    let key = |index: usize| (lines[index].build, lines[index].ray);
    let first = candidates
        .iter()
        .copied()
        .min_by(|a, b| key(*a).partial_cmp(&key(*b)).expect("finite"));
    let mut stretches: Vec<Stretch> = Vec::new();
    let (mut now, mut from) = (first, 0.0);
    while let Some(line) = now {
        let next = next_crossing(lines, &candidates, line);
        let to = next.map_or(f64::INFINITY, |(_, at)| at);
        if to > from {
            stretches.push(Stretch { line, from, to });
        }
        (now, from) = (next.map(|(line, _)| line), to);
    }
    stretches
}

/// Where the first of the lines with cheaper rays crosses a line; of those that cross together, the one with the cheapest rays.
fn next_crossing(lines: &[Line], candidates: &[usize], line: usize) -> Option<(usize, f64)> {
    let here = lines[line];
    let crossings = candidates
        .iter()
        .filter(|other| lines[**other].ray < here.ray)
        .map(|other| {
            let there = lines[*other];
            (*other, (there.build - here.build) / (here.ray - there.ray))
        });
    crossings.min_by(|a, b| {
        a.1.total_cmp(&b.1)
            .then(lines[a.0].ray.total_cmp(&lines[b.0].ray))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(build: f64, ray: f64) -> Line {
        Line { build, ray }
    }

    #[test]
    fn a_slower_build_takes_over_when_its_rays_have_paid_for_it() {
        let lines = [
            line(10.0, 1.0),
            line(0.0, 3.0),
            line(50.0, 0.5),
            line(9.0, 9.0),
        ];
        let stretches = lower(&lines);
        let order: Vec<usize> = stretches.iter().map(|stretch| stretch.line).collect();
        assert_eq!(order, [1, 0, 2]);
        assert_eq!((stretches[0].from, stretches[0].to), (0.0, 5.0));
        assert_eq!((stretches[1].from, stretches[1].to), (5.0, 80.0));
        assert_eq!((stretches[2].from, stretches[2].to), (80.0, f64::INFINITY));
    }

    #[test]
    fn each_stretch_is_the_lowest_in_its_middle() {
        let lines: Vec<Line> = (1..30u8)
            .map(|index| {
                let value = f64::from(index);
                line((value * 7.3) % 11.0, 5.0 / value + (value * 3.7) % 2.0)
            })
            .collect();
        let total = |line: Line, rays: f64| line.build + rays * line.ray;
        for stretch in lower(&lines) {
            let rays = if stretch.to.is_finite() {
                (stretch.from + stretch.to) / 2.0
            } else {
                stretch.from * 2.0 + 1.0
            };
            let here = total(lines[stretch.line], rays);
            assert!(
                lines.iter().all(|line| total(*line, rays) >= here - 1e-9),
                "{stretch:?}"
            );
        }
    }

    #[test]
    fn lines_without_a_number_are_left_out() {
        assert_eq!(lower(&[line(f64::NAN, 1.0), line(1.0, f64::INFINITY)]), []);
        assert_eq!(lower(&[]), []);
        assert_eq!(lower(&[line(1.0, 1.0), line(1.0, 1.0)]).len(), 1);
    }
}
