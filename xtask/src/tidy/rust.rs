//! Rules about Rust source.

use super::Finding;
use super::code::{RustFile, contains_word};

/// Packages whose roots forbid unsafe code altogether.
pub(super) const SAFE_PACKAGES: [&str; 5] = [
    "tahko-bsp",
    "tahko-kdtree",
    "tahko-tracer",
    "tahko-cli",
    "xtask",
];

/// The kernel modules that may contain unsafe code, and the bindings of other libraries in the benchmark, by path.
const UNSAFE_FILES: &[&str] = &[
    "benches/src/peers/embree/denormals.rs",
    "benches/src/peers/embree/ffi.rs",
    "benches/src/peers/embree/scene.rs",
    "benches/src/peers/embree/trace.rs",
    "benches/src/peers/embree/tree.rs",
    "benches/src/peers/tinybvh.rs",
    "crates/bvh/src/filling.rs",
    "crates/bvh/src/huge_pages.rs",
    "crates/bvh/src/wide/access.rs",
    "crates/bvh/src/wide/plane_order.rs",
    "crates/bvh/src/wide/stack.rs",
    "crates/geometry/src/simd/x86.rs",
    // An allocator that counts, for a test.
    "crates/bvh/tests/memory.rs",
];

/// All rules that hold for every Rust file.
pub(super) fn all(file: &RustFile) -> Vec<Finding> {
    let rules = [
        no_unfinished_code,
        no_unwrap_outside_tests,
        no_ignored_tests,
        no_sleep_in_tests,
        unsafe_only_in_kernels,
        exceptions_have_reasons,
    ];
    rules.iter().flat_map(|rule| rule(file)).collect()
}

/// Code that is not finished or was only for looking into the program does not land.
fn no_unfinished_code(file: &RustFile) -> Vec<Finding> {
    let macros = ["todo", "unimplemented", "dbg"];
    lines_where(file, |line, _| {
        let used = macros
            .iter()
            .find(|name| contains_word(line, name) && line.contains(&format!("{name}!(")));
        used.map(|name| format!("`{name}!` in committed code"))
    })
}

/// A panic has a sentence that says which invariant was broken.
fn no_unwrap_outside_tests(file: &RustFile) -> Vec<Finding> {
    lines_where(file, |line, is_test| {
        let found = !is_test && line.contains(".unwrap()");
        found.then(|| "`.unwrap()` outside tests: use `?` or `.expect(\"reason\")`".to_owned())
    })
}

/// A test that never runs proves nothing.
fn no_ignored_tests(file: &RustFile) -> Vec<Finding> {
    attributes_where(file, |content| {
        contains_word(content, "ignore").then(|| "ignored test".to_owned())
    })
}

/// Tests that wait for a time to pass are slow, or fail on a slow machine. Waiting for other programs has a file of its own.
fn no_sleep_in_tests(file: &RustFile) -> Vec<Finding> {
    let waits = file.path.ends_with("tests/common/wait.rs");
    lines_where(file, |line, is_test| {
        let found = is_test && !waits && line.contains("thread::sleep");
        found.then(|| "a test that sleeps: wait for the event itself".to_owned())
    })
}

/// Unsafe code stays in kernel modules, where its obligations are reviewed together.
fn unsafe_only_in_kernels(file: &RustFile) -> Vec<Finding> {
    let allowed = UNSAFE_FILES.contains(&file.path.as_str());
    lines_where(file, |line, _| {
        let found = !allowed && contains_word(line, "unsafe");
        found.then(|| "`unsafe` outside the modules listed in xtask".to_owned())
    })
}

/// Whoever switches a lint off says why.
fn exceptions_have_reasons(file: &RustFile) -> Vec<Finding> {
    attributes_where(file, |content| {
        let switches_off = ["allow", "expect"]
            .iter()
            .find(|name| contains_word(content, name) && content.contains(&format!("{name}(")))?;
        let has_reason = contains_word(content, "reason");
        (!has_reason).then(|| format!("`{switches_off}` without a reason"))
    })
}

/// The root of a package without unsafe code says so, and the compiler keeps it to that.
pub(super) fn forbids_unsafe(file: &RustFile) -> Option<Finding> {
    let forbids = file
        .attributes()
        .any(|attribute| attribute.content == "forbid(unsafe_code)");
    (!forbids).then(|| Finding::new(&file.path, 1, "lacks `#![forbid(unsafe_code)]`"))
}

fn lines_where(file: &RustFile, rule: impl Fn(&str, bool) -> Option<String>) -> Vec<Finding> {
    file.lines()
        .zip(&file.is_test)
        .filter_map(|((number, line), is_test)| {
            let message = rule(line, *is_test)?;
            Some(Finding::new(&file.path, number, message))
        })
        .collect()
}

fn attributes_where(file: &RustFile, rule: impl Fn(&str) -> Option<String>) -> Vec<Finding> {
    file.attributes()
        .filter_map(|attribute| {
            let message = rule(attribute.content)?;
            Some(Finding::new(&file.path, attribute.line, message))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    type Rule = fn(&RustFile) -> Vec<Finding>;

    /// The lines at which a rule finds something.
    fn lines(rule: Rule, path: &str, text: &str) -> Vec<usize> {
        let findings = rule(&RustFile::new(path, text));
        findings.iter().map(|finding| finding.line).collect()
    }

    #[test]
    fn unfinished_code_is_found_but_not_in_texts() {
        let text = "todo!();\n// todo!()\n\"dbg!(1)\";\nmy_todo!();\ndbg!(1);\nunimplemented!()";
        assert_eq!(lines(no_unfinished_code, "a.rs", text), [1, 5, 6]);
    }

    #[test]
    fn unwrap_is_for_tests() {
        let text = "a.unwrap();\na.unwrap_or(0);\n#[cfg(test)]\nmod tests {\n a.unwrap();\n}\n";
        assert_eq!(lines(no_unwrap_outside_tests, "src/a.rs", text), [1]);
        let in_tests = lines(no_unwrap_outside_tests, "tests/a.rs", text);
        assert!(in_tests.is_empty(), "{in_tests:?}");
    }

    #[test]
    fn ignored_tests_are_found_with_and_without_a_reason() {
        let text = "#[test]\n#[ignore]\nfn a() {}\n#[ignore = \"slow\"]\nfn b() {}\nignore();\n";
        assert_eq!(lines(no_ignored_tests, "a.rs", text), [2, 4]);
    }

    #[test]
    fn sleeping_is_found_in_tests_only() {
        let text = "std::thread::sleep(second);\n#[test]\nfn a() {\n thread::sleep(second);\n}\n";
        assert_eq!(lines(no_sleep_in_tests, "src/a.rs", text), [4]);
        let waits = lines(no_sleep_in_tests, "a/tests/common/wait.rs", text);
        assert!(waits.is_empty(), "{waits:?}");
    }

    #[test]
    fn unsafe_code_is_found_but_not_the_name_of_the_lint() {
        let text = "#![forbid(unsafe_code)]\nunsafe { f() }\n// unsafe\n";
        assert_eq!(lines(unsafe_only_in_kernels, "a.rs", text), [2]);
    }

    #[test]
    fn exceptions_need_a_reason() {
        let text = "#[allow(dead_code)]\n#[expect(a, reason = \"b\")]\n\
            #[cfg_attr(c,\n expect(d))]\nx.expect(\"e\");\n#[cfg(test)]\n";
        assert_eq!(lines(exceptions_have_reasons, "a.rs", text), [1, 3]);
    }

    #[test]
    fn forbidding_unsafe_code_in_a_comment_does_not_count() {
        let finding = |text| forbids_unsafe(&RustFile::new("a.rs", text));
        assert_eq!(finding("#![forbid(unsafe_code)]\n"), None);
        assert!(
            finding("// #![forbid(unsafe_code)]\n").is_some(),
            "a comment"
        );
    }
}
