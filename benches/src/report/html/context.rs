//! What the sections share: the report, names, colours, and figures over all scenes.

use std::collections::{BTreeMap, BTreeSet};

use maud::{Markup, html};

use super::super::{BuildRow, Contender, RayClass, Report, SceneReport, TraceRow};
use super::format;
use super::mark::{Mark, Palette};
use super::mistakes::Mistakes;
use super::names::Names;

/// The report and what is derived from it once.
#[derive(Debug)]
pub(super) struct Context<'a> {
    pub(super) report: &'a Report,
    pub(super) names: Names,
    palette: Palette,
    /// The number of threads of the charts: the smallest that was measured.
    pub(super) threads: usize,
}

/// A contender on a class of rays over several scenes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Overall<'a> {
    pub(super) contender: &'a Contender,
    /// Geometric mean over the scenes, in million rays per second.
    pub(super) rate: f64,
    /// Sum over the scenes.
    pub(super) mistakes: Mistakes,
}

/// The contenders that can be compared on a class of rays.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Field<'a> {
    /// Those with a rate and audited answers on all `scenes`, the fastest first.
    pub(super) shown: Vec<Overall<'a>>,
    /// The others, with the number of scenes they have.
    pub(super) left_out: Vec<(&'a Contender, usize)>,
    /// How many scenes have the class.
    pub(super) scenes: usize,
}

impl<'a> Context<'a> {
    pub(super) fn new(report: &'a Report) -> Self {
        let rows = || report.scenes.iter().flat_map(|scene| &scene.traces);
        let mut contenders: BTreeSet<Contender> = rows().map(|row| row.contender.clone()).collect();
        let builds = report.scenes.iter().flat_map(|scene| &scene.builds);
        contenders.extend(builds.map(|row| row.contender.clone()));
        contenders.extend(report.growth.iter().map(|curve| curve.contender.clone()));
        Self {
            report,
            palette: Palette::new(&contenders),
            names: Names::new(contenders),
            threads: rows().map(|row| row.threads).min().unwrap_or(1),
        }
    }

    pub(super) fn mark(&self, contender: &Contender) -> Mark {
        self.palette.mark(contender)
    }

    /// The marker and a name.
    pub(super) fn badge(&self, contender: &Contender, name: &str) -> Markup {
        html! { span.who { (self.mark(contender).in_text()) " " (name) } }
    }

    /// `one thread`, `4 threads`.
    pub(super) fn on_threads(&self) -> String {
        threads_in_words(self.threads)
    }

    /// The classes that were measured, in order.
    pub(super) fn classes(&self) -> Vec<RayClass> {
        let is_there = |class: &RayClass| self.rows(*class).next().is_some();
        RayClass::ALL.into_iter().filter(is_there).collect()
    }

    /// The class that stands for all where one must: diffuse, else random, else the first.
    pub(super) fn main_class(&self) -> Option<RayClass> {
        let classes = self.classes();
        [RayClass::Diffuse, RayClass::Random]
            .into_iter()
            .find(|class| classes.contains(class))
            .or_else(|| classes.first().copied())
    }

    /// The rows of a class at [`Self::threads`].
    pub(super) fn rows(
        &self,
        class: RayClass,
    ) -> impl Iterator<Item = (&'a SceneReport, &'a TraceRow)> {
        let threads = self.threads;
        self.report.scenes.iter().flat_map(move |scene| {
            let rows = scene.traces.iter();
            rows.filter(move |row| row.class == class && row.threads == threads)
                .map(move |row| (scene, row))
        })
    }

    /// Figures over all scenes. A mean over other scenes would be another quantity, so who lacks a scene is left out.
    pub(super) fn field(&self, class: RayClass) -> Field<'a> {
        let mut scenes = BTreeSet::new();
        let mut rows: BTreeMap<&Contender, Vec<&TraceRow>> = BTreeMap::new();
        for (scene, row) in self.rows(class) {
            scenes.insert(&scene.name);
            let rows = rows.entry(&row.contender).or_default();
            let rate = row.rate.median();
            if rate.is_finite() && rate > 0.0 && row.errors.audited > 0 {
                rows.push(row);
            }
        }
        let mut field = Field {
            scenes: scenes.len(),
            ..Field::default()
        };
        for (contender, rows) in rows {
            if rows.len() < field.scenes {
                field.left_out.push((contender, rows.len()));
                continue;
            }
            field.shown.push(Overall {
                contender,
                rate: geometric_mean(rows.iter().map(|row| row.rate.median())),
                mistakes: rows.iter().map(|row| &row.errors).collect(),
            });
        }
        field.shown.sort_by(|a, b| b.rate.total_cmp(&a.rate));
        field
    }

    /// The rows that trace with what a build made, at [`Self::threads`].
    pub(super) fn traces_of(
        &self,
        scene: &'a SceneReport,
        build: &'a BuildRow,
        class: RayClass,
    ) -> impl Iterator<Item = &'a TraceRow> {
        let threads = self.threads;
        scene.traces.iter().filter(move |row| {
            let is_built_so = same_build(&row.contender, &build.contender);
            is_built_so && row.class == class && row.threads == threads
        })
    }
}

/// Whether one build serves both.
pub(super) fn same_build(a: &Contender, b: &Contender) -> bool {
    (&a.library, &a.structure, &a.preset) == (&b.library, &b.structure, &b.preset)
}

/// `one thread`, `4 threads`.
pub(super) fn threads_in_words(threads: usize) -> String {
    match threads {
        1 => "one thread".to_owned(),
        _ => format!("{} threads", format::count(threads)),
    }
}

/// The geometric mean; not a number without values.
pub(super) fn geometric_mean(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, count) = values.into_iter().fold((0.0, 0.0), |(sum, count), value| {
        (sum + value.ln(), count + 1.0)
    });
    (sum / count).exp()
}

/// The middle value, of two the larger one; `None` without values.
pub(super) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.retain(|value| value.is_finite());
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
