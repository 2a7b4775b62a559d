//! A source file reduced to what the rules are about: code without comments, texts and unit tests.

/// A word of code, or one other character.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Token<'a> {
    /// The characters.
    pub text: &'a str,
    /// The line, counted from 1.
    pub line: usize,
}

/// The text with every comment and the inside of every string and character blanked out; lines stay.
pub fn without_comments_and_texts(text: &str) -> String {
    let bytes = text.as_bytes();
    let mut out = bytes.to_vec();
    let mut at = 0;
    while at < bytes.len() {
        let end = match bytes[at] {
            b'/' if text[at..].starts_with("//") => {
                text[at..].find('\n').map_or(bytes.len(), |n| at + n)
            }
            b'/' if text[at..].starts_with("/*") => end_of_block_comment(bytes, at),
            b'"' => end_of_string(bytes, at),
            b'r' if !word_before(bytes, at) && raw_hashes(bytes, at).is_some() => {
                end_of_raw_string(text, at)
            }
            b'\'' => end_of_character(text, at),
            _ => {
                at += 1;
                continue;
            }
        };
        for byte in &mut out[at..end] {
            if *byte != b'\n' {
                *byte = b' ';
            }
        }
        at = end.max(at + 1);
    }
    String::from_utf8(out).expect("whole characters were blanked out")
}

fn word_before(bytes: &[u8], at: usize) -> bool {
    // A byte string's `b` before `r` belongs to the literal.
    at > 0
        && (bytes[at - 1].is_ascii_alphanumeric() || bytes[at - 1] == b'_')
        && bytes[at - 1] != b'b'
}

fn end_of_block_comment(bytes: &[u8], start: usize) -> usize {
    let (mut at, mut depth) = (start, 0);
    while at < bytes.len() {
        match bytes[at..] {
            [b'/', b'*', ..] => (depth, at) = (depth + 1, at + 2),
            [b'*', b'/', ..] => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            break;
        }
    }
    at.min(bytes.len())
}

fn end_of_string(bytes: &[u8], start: usize) -> usize {
    let mut at = start + 1;
    while at < bytes.len() && bytes[at] != b'"' {
        at += if bytes[at] == b'\\' { 2 } else { 1 };
    }
    (at + 1).min(bytes.len())
}

/// How many `#` a raw string that begins at the `r` has; `None` if none begins there.
fn raw_hashes(bytes: &[u8], at: usize) -> Option<usize> {
    let hashes = bytes[at + 1..].iter().take_while(|&&byte| byte == b'#').count();
    (bytes.get(at + 1 + hashes) == Some(&b'"')).then_some(hashes)
}

fn end_of_raw_string(text: &str, at: usize) -> usize {
    let hashes = raw_hashes(text.as_bytes(), at).unwrap_or(0);
    let inside = at + 2 + hashes;
    let close = format!("\"{}", "#".repeat(hashes));
    text[inside..].find(&close).map_or(text.len(), |n| inside + n + close.len())
}

/// The end of a character literal, or of the quote alone where it begins a lifetime.
fn end_of_character(text: &str, at: usize) -> usize {
    let mut inside = text[at + 1..].char_indices();
    match inside.next() {
        Some((_, '\\')) => {
            let rest = &text[at + 3..];
            rest.find('\'').map_or(text.len(), |n| at + 3 + n + 1)
        }
        Some((_, first)) if inside.next().is_some_and(|(_, second)| second == '\'') => {
            at + 1 + first.len_utf8() + 1
        }
        _ => at + 1,
    }
}

/// Blanked text without its items under `#[cfg(test)]`: their attribute and braces are blanked too.
pub fn without_unit_tests(code: &str) -> String {
    const MARK: &str = "#[cfg(test)]";
    let mut out = code.as_bytes().to_vec();
    let mut at = 0;
    while let Some(start) = code[at..].find(MARK).map(|n| at + n) {
        let after = start + MARK.len();
        // The item ends with its closing brace, or with a semicolon before any brace opens.
        let (mut depth, mut end) = (0, code.len());
        for (n, byte) in code.bytes().enumerate().skip(after) {
            match byte {
                b'{' => depth += 1,
                b'}' => depth -= 1,
                _ => {}
            }
            if depth == 0 && (byte == b'}' || byte == b';') {
                end = n + 1;
                break;
            }
        }
        for byte in &mut out[start..end] {
            if *byte != b'\n' {
                *byte = b' ';
            }
        }
        at = end;
    }
    String::from_utf8(out)
        .expect("only ASCII was left inside, or whole characters were blanked out")
}

/// The words and other characters of code, in order, white space left out.
pub fn tokens(code: &str) -> Vec<Token<'_>> {
    let word = |c: char| c.is_alphanumeric() || c == '_';
    let mut out = Vec::new();
    let (mut line, mut at) = (1, 0);
    while let Some(first) = code[at..].chars().next() {
        let length = if word(first) {
            code[at..].find(|c: char| !word(c)).unwrap_or(code.len() - at)
        } else {
            first.len_utf8()
        };
        if first == '\n' {
            line += 1;
        } else if !first.is_whitespace() {
            out.push(Token { text: &code[at..at + length], line });
        }
        at += length;
    }
    out
}

/// Every path in the code that begins with a word of `roots`, written out in full: the group in
/// `use crate::{a, b::{c, d}};` is `crate::a`, `crate::b::c` and `crate::b::d`. With the line.
pub fn paths(tokens: &[Token<'_>], roots: &[&str]) -> Vec<(Vec<String>, usize)> {
    let mut out = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        let starts = roots.contains(&tokens[at].text)
            && separator(tokens, at + 1)
            && !(at >= 2 && separator(tokens, at - 2));
        if starts {
            at = follow(tokens, at, Vec::new(), &mut out);
        } else {
            at += 1;
        }
    }
    out
}

fn separator(tokens: &[Token<'_>], at: usize) -> bool {
    matches!(tokens.get(at..at + 2), Some([a, b]) if a.text == ":" && b.text == ":")
}

/// Follows a path or a group from `at`, with what stands before it, and returns where it ends.
fn follow(
    tokens: &[Token<'_>],
    mut at: usize,
    mut before: Vec<String>,
    out: &mut Vec<(Vec<String>, usize)>,
) -> usize {
    loop {
        let Some(token) = tokens.get(at) else { return at };
        if token.text == "{" {
            at += 1;
            while tokens.get(at).is_some_and(|token| token.text != "}") {
                let next = follow(tokens, at, before.clone(), out);
                at = if tokens.get(next).is_some_and(|t| t.text == ",") { next + 1 } else { next };
                if next == at && tokens.get(at).is_some_and(|t| t.text != "}") {
                    // `as name`, or anything else that is not a path.
                    at += 1;
                }
            }
            return at + 1;
        }
        before.push(token.text.to_owned());
        at += 1;
        if !separator(tokens, at) {
            out.push((before, token.line));
            return at;
        }
        at += 2;
    }
}
