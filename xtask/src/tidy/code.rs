//! Rust source as the rules see it: without comments and literals, and with the lines of tests known.
//!
//! Not a parser: enough of the lexical grammar that no rule stumbles over a text which only mentions what it
//! looks for, such as the rules themselves.

/// A Rust file.
#[derive(Debug)]
pub(super) struct RustFile {
    pub(super) path: String,
    /// The text with a space for every byte of comments and of the inside of literals; lines stay.
    pub(super) code: String,
    /// For each line, whether it is compiled only for tests.
    pub(super) is_test: Vec<bool>,
}

/// An attribute, `#[...]` or `#![...]`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Attribute<'a> {
    /// Counted from one.
    pub(super) line: usize,
    /// What stands between the brackets.
    pub(super) content: &'a str,
    /// The offset behind the closing bracket.
    end: usize,
}

impl RustFile {
    pub(super) fn new(path: &str, text: &str) -> Self {
        let code = without_comments_and_literals(text);
        let mut is_test = vec![is_test_file(path); code.lines().count()];
        for attribute in attributes(&code).filter(|attribute| is_for_tests(attribute.content)) {
            let end = item_end(&code, attribute.end);
            let last = end.map_or(is_test.len(), |end| line_at(&code, end));
            is_test[attribute.line - 1..last].fill(true);
        }
        Self {
            path: path.to_owned(),
            code,
            is_test,
        }
    }

    /// The lines with their numbers, counted from one.
    pub(super) fn lines(&self) -> impl Iterator<Item = (usize, &str)> {
        (1..).zip(self.code.lines())
    }

    pub(super) fn attributes(&self) -> impl Iterator<Item = Attribute<'_>> {
        attributes(&self.code)
    }
}

/// Whether a word stands in a text by itself, not as a part of a longer one.
pub(super) fn contains_word(text: &str, word: &str) -> bool {
    let is_part = |character: char| character.is_alphanumeric() || character == '_';
    text.match_indices(word).any(|(start, _)| {
        let end = start + word.len();
        !text[..start].ends_with(is_part) && !text[end..].starts_with(is_part)
    })
}

fn is_test_file(path: &str) -> bool {
    path.ends_with("/tests.rs") || path.split('/').any(|folder| folder == "tests")
}

fn is_for_tests(attribute: &str) -> bool {
    attribute == "test"
        || (attribute.starts_with("cfg(")
            && contains_word(attribute, "test")
            && !attribute.contains("not("))
}

fn attributes(code: &str) -> impl Iterator<Item = Attribute<'_>> {
    code.match_indices('#').filter_map(move |(start, _)| {
        let rest = code[start + 1..].trim_start_matches('!');
        let open = code.len() - rest.len();
        let end = rest.starts_with('[').then(|| closing(code, open))??;
        Some(Attribute {
            line: line_at(code, start),
            content: code[open + 1..end - 1].trim(),
            end,
        })
    })
}

/// The offset behind the bracket that closes the one at `open`.
fn closing(code: &str, open: usize) -> Option<usize> {
    let mut depth = 0usize;
    for (offset, byte) in code.bytes().enumerate().skip(open) {
        match byte {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 {
            return Some(offset + 1);
        }
    }
    None
}

/// The end of the item whose first attribute ends at `start`: its closing brace or its semicolon.
fn item_end(code: &str, start: usize) -> Option<usize> {
    let mut offset = start;
    loop {
        match code.as_bytes().get(offset)? {
            b'{' => return closing(code, offset),
            b';' => return Some(offset),
            b'(' | b'[' => offset = closing(code, offset)?,
            _ => offset += 1,
        }
    }
}

fn line_at(code: &str, offset: usize) -> usize {
    let before = &code.as_bytes()[..offset.min(code.len())];
    1 + before.iter().filter(|byte| **byte == b'\n').count()
}

fn without_comments_and_literals(text: &str) -> String {
    let mut code = Vec::with_capacity(text.len());
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let is_word = |byte: &u8| byte.is_ascii_alphanumeric() || *byte == b'_';
        let in_word = code.last().is_some_and(is_word);
        let blank = comment_length(rest)
            .or_else(|| (!in_word).then(|| raw_string_length(rest)).flatten())
            .or_else(|| string_length(rest))
            .or_else(|| character_length(rest));
        let (taken, after) = rest.split_at(blank.unwrap_or(first.len_utf8()));
        if blank.is_some() {
            let line_breaks = |byte| if byte == b'\n' { b'\n' } else { b' ' };
            code.extend(taken.bytes().map(line_breaks));
        } else {
            code.extend(taken.bytes());
        }
        rest = after;
    }
    String::from_utf8_lossy(&code).into_owned()
}

/// The length of the comment at the beginning of a text; block comments nest.
fn comment_length(text: &str) -> Option<usize> {
    if text.starts_with("//") {
        return Some(text.find('\n').unwrap_or(text.len()));
    }
    if !text.starts_with("/*") {
        return None;
    }
    let (mut depth, mut offset) = (0usize, 0);
    let bytes = text.as_bytes();
    while offset < bytes.len() {
        let step = match &bytes[offset..] {
            [b'/', b'*', ..] => {
                depth += 1;
                2
            }
            [b'*', b'/', ..] => {
                depth -= 1;
                2
            }
            _ => 1,
        };
        offset += step;
        if depth == 0 {
            return Some(offset);
        }
    }
    Some(text.len())
}

fn raw_string_length(text: &str) -> Option<usize> {
    let prefixes = ["r", "br", "cr"];
    let prefix = prefixes.iter().find(|prefix| {
        let after = text.strip_prefix(**prefix);
        after.is_some_and(|after| after.starts_with(['#', '"']))
    })?;
    let hashes = text[prefix.len()..].bytes().take_while(|b| *b == b'#');
    let hashes = hashes.count();
    let inside = prefix.len() + hashes + 1;
    // `r#name` is an identifier.
    text[prefix.len() + hashes..].strip_prefix('"')?;
    let end = format!("\"{}", "#".repeat(hashes));
    let length = text[inside..].find(&end);
    Some(length.map_or(text.len(), |length| inside + length + end.len()))
}

fn string_length(text: &str) -> Option<usize> {
    text.strip_prefix('"')?;
    quoted_length(text, b'"')
}

/// The length of a character literal; `None` for a lifetime.
fn character_length(text: &str) -> Option<usize> {
    let mut inside = text.strip_prefix('\'')?.chars();
    match (inside.next()?, inside.next()) {
        ('\\', _) => quoted_length(text, b'\''),
        (first, Some('\'')) => Some(2 + first.len_utf8()),
        _ => None,
    }
}

/// The length of a literal whose quote may be escaped inside.
fn quoted_length(text: &str, quote: u8) -> Option<usize> {
    let bytes = text.as_bytes();
    let mut offset = 1;
    while offset < bytes.len() {
        match bytes[offset] {
            b'\\' => offset += 2,
            byte if byte == quote => return Some(offset + 1),
            _ => offset += 1,
        }
    }
    Some(bytes.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_literals_become_spaces() {
        let cases = [
            ("a // b \"\nc", "a       \nc"),
            ("a /* b /* c */ d\n */ e", "a               \n    e"),
            (r#"f("a\"b", 'c', '\'', "ä")"#, "f(      ,    ,     ,     )"),
            ("r#\"a\"b\"# r\"\\\" br##\"\"#\"##", "         r"),
        ];
        for (text, expected) in cases {
            let code = without_comments_and_literals(text);
            assert_eq!(code.len(), text.len(), "{text}");
            if text.starts_with("r#") {
                assert!(code.trim().is_empty(), "{text} became {code}");
            } else {
                assert_eq!(code, expected);
            }
        }
    }

    #[test]
    fn lifetimes_raw_identifiers_and_words_ending_in_r_are_code() {
        for text in ["fn f<'a>(x: &'a str)", "r#type", "'label: loop", "number#"] {
            assert_eq!(without_comments_and_literals(text), text);
        }
    }

    #[test]
    fn unfinished_literals_end_with_the_text() {
        for text in ["\"a\\", "/* a", "r#\"a\"", "'\\", "// a"] {
            assert!(
                without_comments_and_literals(text).trim().is_empty(),
                "{text}"
            );
        }
    }

    #[test]
    fn the_lines_of_test_modules_are_known() {
        let text = "fn a() {}\n#[cfg(test)]\nmod tests {\n    fn b() {}\n}\nfn c() {}\n";
        let file = RustFile::new("src/a.rs", text);
        assert_eq!(file.is_test, [false, true, true, true, true, false]);

        let text = "#[cfg(test)]\nmod tests;\n#[cfg(not(test))]\nfn c() {}\n";
        let file = RustFile::new("src/a.rs", text);
        assert_eq!(file.is_test, [true, true, false, false]);

        let file = RustFile::new("src/a/tests.rs", "fn a() {}\n");
        assert_eq!(file.is_test, [true]);
    }

    #[test]
    fn attributes_end_at_their_own_bracket() {
        let file = RustFile::new("a.rs", "#![a(b[1])]\n\n#[c]\nfn f() {}\n#[");
        let found: Vec<_> = file.attributes().map(|a| (a.line, a.content)).collect();
        assert_eq!(found, [(1, "a(b[1])"), (3, "c")]);
    }

    #[test]
    fn words_are_found_whole() {
        assert!(contains_word("pub unsafe fn", "unsafe"), "a word");
        assert!(!contains_word("unsafe_code", "unsafe"), "a part of a word");
    }
}
