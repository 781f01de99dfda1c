//! The verdict on the pictures of one scene.

use std::fmt::{self, Display};
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;

use super::compare::{self, Difference};
use super::render::{Precision, Rendered};

/// What was found out about a scene.
#[derive(Debug)]
pub(super) struct Report {
    /// A few words for the table.
    pub(super) verdict: String,
    pub(super) problems: Vec<Problem>,
}

/// What is wrong, and the pictures that show it.
#[derive(Debug)]
pub(super) struct Problem {
    message: String,
    pictures: Vec<PathBuf>,
}

impl Problem {
    fn new(message: String) -> Self {
        let pictures = Vec::new();
        Self { message, pictures }
    }
}

impl Display for Problem {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "  {}", self.message)?;
        for picture in &self.pictures {
            write!(formatter, "\n    see {}", picture.display())?;
        }
        Ok(())
    }
}

impl Report {
    fn failed(problems: Vec<Problem>) -> Self {
        Self {
            verdict: format!("FAILED ({})", problems.len()),
            problems,
        }
    }
}

/// Compares the pictures with each other and with the golden image; difference images go to the folder.
pub(super) fn check(
    rendered: &[Rendered],
    golden: Option<&[u8]>,
    folder: &Path,
) -> anyhow::Result<Report> {
    let mut problems = disagreements(rendered, folder)?;
    let expected = match golden.map(compare::decode) {
        Some(Ok(expected)) => expected,
        Some(Err(error)) => {
            problems.push(Problem::new(format!("the golden image: {error:#}")));
            return Ok(Report::failed(problems));
        }
        None => {
            let message = "there is no golden image; look at the picture, accept it with --bless";
            let picture = reference(rendered, Precision::GOLDEN);
            problems.push(Problem {
                message: message.to_owned(),
                pictures: picture
                    .map(|(picture, _)| picture.file.clone())
                    .into_iter()
                    .collect(),
            });
            return Ok(Report::failed(problems));
        }
    };
    let mut verdict = "equal to the golden image".to_owned();
    for precision in Precision::ALL {
        let Some((reference, png)) = reference(rendered, precision) else {
            continue;
        };
        let actual = compare::decode(png).with_context(|| format!("{}", reference.case))?;
        let difference = Difference::between(&expected, &actual);
        let allowed = match precision {
            Precision::Exact | Precision::Watertight => compare::OUTLIERS,
            Precision::Fast => compare::FAST_OUTLIERS,
        };
        if !difference.is_within(allowed) {
            let message = format!("{} and the golden image: {difference}", reference.case);
            let marks = folder.join(format!(
                "{}.golden-difference.png",
                reference.case.file_name()
            ));
            save(&compare::difference_image(&expected, &actual), &marks)?;
            problems.push(Problem {
                message,
                pictures: vec![reference.file.clone(), marks],
            });
        } else if precision == Precision::GOLDEN && golden != Some(png) {
            verdict = format!("within tolerance: {difference}");
        }
    }
    if problems.is_empty() {
        Ok(Report { verdict, problems })
    } else {
        Ok(Report::failed(problems))
    }
}

/// Makes the exact picture the golden image, if all structures agree on it.
pub(super) fn bless(
    rendered: &[Rendered],
    golden: Option<&[u8]>,
    golden_file: &Path,
    folder: &Path,
) -> anyhow::Result<Report> {
    let problems = disagreements(rendered, folder)?;
    let picture = reference(rendered, Precision::GOLDEN);
    let Some((_, png)) = picture.filter(|_| problems.is_empty()) else {
        return Ok(Report::failed(problems));
    };
    let report = check(rendered, Some(png), folder)?;
    if !report.problems.is_empty() {
        return Ok(report);
    }
    let verdict = if golden == Some(png) {
        "unchanged"
    } else {
        let parent = golden_file
            .parent()
            .context("the golden image has no folder")?;
        fs::create_dir_all(parent).with_context(|| format!("cannot make {parent:?}"))?;
        fs::write(golden_file, png).with_context(|| format!("cannot write {golden_file:?}"))?;
        "blessed"
    };
    Ok(Report {
        verdict: verdict.to_owned(),
        problems,
    })
}

/// The first picture of a precision, with which the others are compared.
fn reference(rendered: &[Rendered], precision: Precision) -> Option<(&Rendered, &[u8])> {
    rendered
        .iter()
        .filter(|rendered| rendered.case.precision == precision)
        .find_map(|rendered| Some((rendered, rendered.png.as_deref().ok()?)))
}

/// Cases that gave no picture: one problem for each distinct error, as most scenes fail in all cases alike.
fn failures(rendered: &[Rendered]) -> Vec<Problem> {
    let errors = || {
        let failed = rendered.iter();
        failed.filter_map(|rendered| Some((&rendered.case, rendered.png.as_ref().err()?)))
    };
    let mut reported: Vec<&str> = Vec::new();
    let mut problems = Vec::new();
    for (case, error) in errors() {
        if reported.contains(&error.as_str()) {
            continue;
        }
        reported.push(error);
        let others = errors().filter(|(_, other)| *other == error).count() - 1;
        let others = match others {
            0 => String::new(),
            _ => format!(" and {others} other cases"),
        };
        problems.push(Problem::new(format!("{case}{others}: {error}")));
    }
    problems
}

/// Cases that gave no picture, and pictures that are not byte for byte the reference of their precision.
fn disagreements(rendered: &[Rendered], folder: &Path) -> anyhow::Result<Vec<Problem>> {
    let mut problems = failures(rendered);
    for Rendered { case, file, png } in rendered {
        let Ok(png) = png else {
            continue;
        };
        let Some((reference, expected_png)) = reference(rendered, case.precision) else {
            continue;
        };
        if png == expected_png {
            continue;
        }
        let expected =
            compare::decode(expected_png).with_context(|| format!("{}", reference.case))?;
        let actual = compare::decode(png).with_context(|| format!("{case}"))?;
        let difference = Difference::between(&expected, &actual);
        let marks = folder.join(format!("{}.difference.png", case.file_name()));
        save(&compare::difference_image(&expected, &actual), &marks)?;
        problems.push(Problem {
            message: format!("{case} and {} differ: {difference}", reference.case),
            pictures: vec![reference.file.clone(), file.clone(), marks],
        });
    }
    Ok(problems)
}

fn save(image: &image::RgbaImage, file: &Path) -> anyhow::Result<()> {
    image
        .save(file)
        .with_context(|| format!("cannot write {file:?}"))
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use image::{ImageFormat, Rgba, RgbaImage};

    use super::super::render::Case;
    use super::*;

    /// A picture whose first pixels have another colour.
    fn png(others: usize) -> Vec<u8> {
        let mut image = RgbaImage::from_pixel(160, 120, Rgba([9, 9, 9, 255]));
        for pixel in image.pixels_mut().take(others) {
            *pixel = Rgba([200, 9, 9, 255]);
        }
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, ImageFormat::Png).unwrap();
        bytes.into_inner()
    }

    fn all(picture: impl Fn(&Case) -> Result<Vec<u8>, String>) -> Vec<Rendered> {
        let cases = Case::all(4);
        let rendered = cases.iter().map(|case| Rendered {
            case: *case,
            file: PathBuf::from("picture.png"),
            png: picture(case),
        });
        rendered.collect()
    }

    /// An empty folder of its own for a test.
    fn folder(test: &str) -> PathBuf {
        let name = format!("tahko-xtask-{}-{test}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        fs::create_dir_all(&folder).unwrap();
        folder
    }

    fn messages(report: &Report) -> Vec<&str> {
        let problems = report.problems.iter();
        problems.map(|problem| problem.message.as_str()).collect()
    }

    #[test]
    fn equal_pictures_pass() {
        let folder = folder("equal");
        let report = check(&all(|_| Ok(png(0))), Some(&png(0)), &folder).unwrap();
        assert_eq!(report.verdict, "equal to the golden image");
        assert!(report.problems.is_empty(), "{report:?}");
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn one_structure_that_differs_is_named_with_a_difference_image() {
        let folder = folder("differs");
        let is_odd = |case: &Case| case.file_name() == "fast-bvh-4";
        let pictures = all(|case| Ok(png(usize::from(is_odd(case)))));
        let report = check(&pictures, Some(&png(0)), &folder).unwrap();
        assert_eq!(
            messages(&report),
            [
                "bvh fast (--threads 4) and brute fast (--threads 4) differ: \
                 1 pixels differ, 1 by more than 1, at most by 191"
            ]
        );
        let marks = folder.join("fast-bvh-4.difference.png");
        assert!(marks.exists(), "{marks:?}");
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_picture_beside_the_golden_image_fails_beyond_the_tolerance() {
        let folder = folder("golden");
        let near = check(&all(|_| Ok(png(compare::OUTLIERS))), Some(&png(0)), &folder).unwrap();
        assert!(near.verdict.starts_with("within tolerance"), "{near:?}");
        let pictures = all(|_| Ok(png(compare::OUTLIERS + 1)));
        let far = check(&pictures, Some(&png(0)), &folder).unwrap();
        assert_eq!(far.verdict, "FAILED (2)", "exact and watertight");
        let marks = folder.join("exact-brute-4.golden-difference.png");
        assert!(marks.exists(), "{marks:?}");
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_case_without_a_picture_and_a_missing_golden_image_fail() {
        let folder = folder("missing");
        let pictures = all(|case| match case.structure {
            "bsp" => Err("ended with 1".to_owned()),
            _ => Ok(png(0)),
        });
        let report = check(&pictures, None, &folder).unwrap();
        let expected = "bsp fast (--threads 4) and 3 other cases: ended with 1";
        assert_eq!(messages(&report)[0], expected);
        assert_eq!(report.problems.len(), 2, "{report:?}");
        let broken = check(&all(|_| Ok(png(0))), Some(b"no picture"), &folder).unwrap();
        let message = "the golden image: not a PNG picture";
        assert!(messages(&broken)[0].starts_with(message), "{broken:?}");
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn blessing_writes_the_picture_on_which_all_agree() {
        let folder = folder("bless");
        let golden = folder.join("golden/a.png");
        let report = bless(&all(|_| Ok(png(3))), None, &golden, &folder).unwrap();
        assert_eq!(report.verdict, "blessed");
        assert_eq!(fs::read(&golden).unwrap(), png(3));

        let is_odd = |case: &Case| case.structure == "bvh";
        let pictures = all(|case| Ok(png(usize::from(is_odd(case)))));
        let refused = bless(&pictures, Some(&png(3)), &golden, &folder).unwrap();
        assert_eq!(refused.problems.len(), 4, "{refused:?}");
        assert_eq!(fs::read(&golden).unwrap(), png(3), "left as it was");
        fs::remove_dir_all(folder).unwrap();
    }
}
