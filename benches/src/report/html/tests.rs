use std::collections::BTreeSet;

use roxmltree::{Document, Node};

use super::context::Context;
use super::{fixture, page};
use crate::report::{Report, Sample};

/// The page as XML: without the two lines that only HTML understands.
fn xml(page: &str) -> String {
    let mut text = page
        .strip_prefix("<!DOCTYPE html>")
        .expect("a document type")
        .to_owned();
    while let Some(start) = text.find("<meta") {
        let length = text[start..].find('>').expect("the end of the tag");
        text.replace_range(start..=start + length, "");
    }
    text
}

fn with_document(report: &Report, check: impl FnOnce(&Document<'_>)) {
    let text = xml(&page(report));
    let document = Document::parse(&text).expect("well-formed XML");
    check(&document);
}

fn headings(document: &Document<'_>) -> Vec<String> {
    let nodes = document
        .descendants()
        .filter(|node| node.has_tag_name("h2"));
    nodes.map(text_of).collect()
}

fn text_of(node: Node<'_, '_>) -> String {
    let texts = node.descendants().filter(Node::is_text);
    texts.filter_map(|text| text.text()).collect()
}

/// Spoils numbers of the report in all ways in which a measurement can be no number.
fn spoiled() -> Report {
    let mut report = fixture::report();
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -1.0];
    for scene in &mut report.scenes {
        for (row, bad) in scene
            .traces
            .iter_mut()
            .step_by(3)
            .zip(bad.into_iter().cycle())
        {
            row.rate = Sample::new(vec![bad, bad]);
            if let Some(work) = &mut row.work {
                work.node_visits = bad;
            }
        }
        for (row, bad) in scene.builds.iter_mut().zip(bad.into_iter().cycle()) {
            row.seconds = Sample::new(vec![bad]);
            row.bytes_per_triangle = Some(bad);
            if let Some(tree) = &mut row.tree {
                (tree.sah_cost, tree.expected_triangle_tests) = (bad, bad);
            }
        }
        for (row, bad) in scene.images.iter_mut().zip(bad.into_iter().cycle()) {
            row.rmse_reference = bad;
            row.seconds[0] = bad;
        }
    }
    for (curve, bad) in report.growth.iter_mut().zip(bad.into_iter().cycle()) {
        curve.points[0].build_seconds = bad;
        curve.points[1].ray_nanoseconds = bad;
    }
    report
}

#[test]
fn the_page_is_well_formed_and_has_all_sections() {
    with_document(&fixture::report(), |document| {
        let headings = headings(document);
        assert_eq!(headings.len(), 10, "{headings:?}");
        assert_eq!(headings[0], "1. Speed against error");
        assert_eq!(headings[9], "10. How to read this");
    });
}

#[test]
fn sections_without_data_are_left_out() {
    with_document(&fixture::empty(), |document| {
        assert_eq!(headings(document), ["1. How to read this"]);
        assert!(
            !document.descendants().any(|node| node.has_tag_name("svg")),
            "no chart"
        );
    });
    let mut report = fixture::report();
    report.growth.clear();
    report
        .scenes
        .iter_mut()
        .for_each(|scene| scene.images.clear());
    with_document(&report, |document| {
        let headings = headings(document).join(" ");
        assert!(
            !headings.contains("Growth") && !headings.contains("Pictures"),
            "{headings}"
        );
        assert!(headings.contains("Claims"), "{headings}");
    });
}

#[test]
fn links_of_the_contents_lead_to_sections() {
    with_document(&fixture::report(), |document| {
        let ids: Vec<&str> = document
            .descendants()
            .filter_map(|node| node.attribute("id"))
            .collect();
        let distinct: BTreeSet<&str> = ids.iter().copied().collect();
        assert_eq!(ids.len(), distinct.len(), "each id once");
        let links = document
            .descendants()
            .filter_map(|node| node.attribute("href"));
        let targets: Vec<&str> = links
            .map(|link| link.strip_prefix('#').expect("within the page"))
            .collect();
        assert_eq!(targets, ids);
    });
}

#[test]
fn the_page_needs_nothing_from_outside() {
    let page = page(&fixture::report());
    for outside in ["<script", "<link", "<img", "src=", "url(", "@import"] {
        assert!(!page.contains(outside), "{outside}");
    }
}

#[test]
fn the_same_report_gives_the_same_bytes() {
    assert_eq!(page(&fixture::report()), page(&fixture::report()));
}

#[test]
fn special_characters_are_text() {
    let report = fixture::report();
    assert!(!page(&report).contains("<large>"), "a name is no markup");
    with_document(&report, |document| {
        let text = text_of(document.root_element());
        for shown in [
            report.scenes[2].name.as_str(),
            report.machine.processor.as_str(),
            report.command.as_str(),
            report.claims[0].finding.as_str(),
        ] {
            assert!(text.contains(shown), "{shown}");
        }
    });
}

#[test]
fn what_is_no_number_never_reaches_a_coordinate() {
    let places = [
        "x",
        "y",
        "x1",
        "x2",
        "y1",
        "y2",
        "width",
        "height",
        "d",
        "points",
        "transform",
        "viewBox",
        "style",
    ];
    with_document(&spoiled(), |document| {
        let mut seen = 0;
        for node in document.descendants().filter(Node::is_element) {
            for place in places.iter().filter_map(|place| node.attribute(*place)) {
                seen += 1;
                let is_bad = place.contains("NaN") || place.contains("inf");
                assert!(!is_bad, "{}: {place}", node.tag_name().name());
            }
            if let Some(width) = node.attribute("width") {
                assert!(!width.starts_with('-'), "{width}");
            }
        }
        assert!(seen > 1000, "{seen} places");
        let text = text_of(document.root_element());
        assert!(!text.contains("NaN") && !text.contains(" inf"), "text");
    });
}

#[test]
fn no_speed_stands_without_its_error() {
    let is_speed = |name: &str| ["Mrays/s", "ns per ray", "speed"].contains(&name);
    with_document(&fixture::report(), |document| {
        let tables = document
            .descendants()
            .filter(|node| node.has_tag_name("table"));
        let own =
            tables.filter(|table| !table.ancestors().any(|node| node.has_tag_name("article")));
        let mut with_speed = 0;
        for table in own {
            let header: Vec<String> = table
                .descendants()
                .filter(|node| node.attribute("scope") == Some("col"))
                .map(text_of)
                .collect();
            let rows = table
                .descendants()
                .filter(|node| node.has_tag_name("tr"))
                .skip(1);
            for row in rows {
                let cells = row.children().filter(Node::is_element).count();
                assert_eq!(cells, header.len(), "{}", text_of(row));
            }
            if header.iter().any(|name| is_speed(name)) {
                with_speed += 1;
                assert!(
                    header.iter().any(|name| name.starts_with("wrong / M")),
                    "{header:?}"
                );
            }
        }
        assert!(with_speed > 30, "{with_speed} tables");
    });
    with_document(&fixture::report(), |document| {
        let titles = document
            .descendants()
            .filter(|node| node.has_tag_name("title"));
        for title in titles
            .map(text_of)
            .filter(|title| title.contains("Mrays/s"))
        {
            let has_error = ["wrong answers per million", "no wrong answer in"]
                .iter()
                .any(|error| title.contains(error));
            assert!(has_error, "{title}");
        }
    });
}

#[test]
fn every_row_of_the_report_is_in_a_table() {
    let report = fixture::report();
    with_document(&report, |document| {
        let section = document
            .descendants()
            .find(|node| node.attribute("id") == Some("scenes"))
            .expect("the section");
        let rows = section
            .descendants()
            .filter(|node| node.attribute("scope") == Some("row"));
        let expected: usize = report.scenes.iter().map(|scene| scene.traces.len()).sum();
        assert_eq!(rows.count(), expected);
    });
}

#[test]
fn the_fastest_row_without_an_error_is_marked_for_each_class_and_number_of_threads() {
    let report = fixture::report();
    with_document(&report, |document| {
        let best = document
            .descendants()
            .filter(|node| node.attribute("class") == Some("best"));
        let best: Vec<Node<'_, '_>> = best.collect();
        assert_eq!(best.len(), report.scenes.len() * 6 * 2);
        for row in best {
            let good = row
                .children()
                .any(|cell| cell.attribute("class") == Some("n good"));
            assert!(good, "{}", text_of(row));
        }
    });
}

#[test]
fn a_mean_is_taken_over_scenes_that_all_shown_contenders_have() {
    let report = fixture::report();
    let context = Context::new(&report);
    let field = context.field(context.main_class().expect("a class"));
    let left_out: BTreeSet<&str> = field
        .left_out
        .iter()
        .map(|(contender, _)| contender.structure.as_str())
        .collect();
    assert_eq!(left_out, BTreeSet::from(["brute", "bsp"]));
    assert!(
        field.shown.is_sorted_by(|a, b| a.rate >= b.rate),
        "the fastest first"
    );
    with_document(&report, |document| {
        let text = text_of(document.root_element());
        assert!(text.contains("bsp (4 of 5 scenes)"), "a note says so");
    });
}

#[test]
fn a_row_that_was_not_audited_is_never_called_free_of_errors() {
    let mut report = fixture::report();
    for row in report.scenes.iter_mut().flat_map(|scene| &mut scene.traces) {
        row.errors = crate::report::Errors::default();
    }
    with_document(&report, |document| {
        let text = text_of(document.root_element());
        assert!(text.contains("not audited"), "said in the tables");
        assert!(
            !text.contains("the fastest without a wrong answer is"),
            "no such finding"
        );
        let best = document
            .descendants()
            .any(|node| node.attribute("class") == Some("best"));
        assert!(!best, "no row is marked");
        assert!(
            text.contains("none gave no wrong answer"),
            "nobody is free of errors"
        );
    });
}

#[test]
fn a_quick_run_says_so() {
    let mut report = fixture::report();
    assert!(!page(&report).contains("A quick run."), "not quick");
    report.settings.quick = true;
    assert!(page(&report).contains("A quick run."), "quick");
}
