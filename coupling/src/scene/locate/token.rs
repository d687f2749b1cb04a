//! Tokens of a scene text, broken or not.

use std::ops::Range;

/// A piece of RON text. Whitespace, comments and `#![enable(...)]` lines leave no token.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Token {
    /// Kind of the token.
    pub kind: TokenKind,
    /// Location; bytes.
    pub span: Range<usize>,
}

/// Kinds of tokens that matter for the structure of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TokenKind {
    /// One of `( [ {`.
    Open(char),
    /// One of `) ] }`.
    Close(char),
    /// `:`
    Colon,
    /// `,`
    Comma,
    /// A number or an identifier.
    Word,
    /// A string or character, with its quotes.
    Text,
}

/// An unclosed comment or string.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unclosed {
    /// `comment` or `string`.
    pub what: &'static str,
    /// Start; bytes.
    pub start: usize,
}

/// The tokens of `text`, and the first unclosed comment or string.
pub fn tokens(text: &str) -> (Vec<Token>, Option<Unclosed>) {
    let mut lexer = Lexer {
        text,
        at: 0,
        unclosed: None,
    };
    let mut tokens = Vec::new();
    while let Some(token) = lexer.next_token() {
        tokens.push(token);
    }
    (tokens, lexer.unclosed)
}

struct Lexer<'a> {
    text: &'a str,
    at: usize,
    unclosed: Option<Unclosed>,
}

impl Lexer<'_> {
    fn rest(&self) -> &str {
        self.text.get(self.at..).unwrap_or_default()
    }

    /// Moves to the first character for which `stop` holds, or to the end.
    fn advance_to(&mut self, stop: impl Fn(char) -> bool) {
        let rest = self.rest();
        self.at += rest.find(stop).unwrap_or(rest.len());
    }

    /// Moves behind `end`; without one, the token that began at `start` remains open.
    fn advance_behind(&mut self, end: &str, what: &'static str, start: usize) {
        match self.rest().find(end) {
            Some(found) => self.at += found + end.len(),
            None => self.leave_open(what, start),
        }
    }

    fn leave_open(&mut self, what: &'static str, start: usize) {
        self.at = self.text.len();
        self.unclosed.get_or_insert(Unclosed { what, start });
    }

    fn next_token(&mut self) -> Option<Token> {
        self.skip_blank();
        let start = self.at;
        let first = self.rest().chars().next()?;
        let kind = match first {
            '(' | '[' | '{' => self.single(TokenKind::Open(first)),
            ')' | ']' | '}' => self.single(TokenKind::Close(first)),
            ':' => self.single(TokenKind::Colon),
            ',' => self.single(TokenKind::Comma),
            '"' => self.quoted('"'),
            '\'' => self.quoted('\''),
            _ => self.word_or_raw_string(),
        };
        Some(Token {
            kind,
            span: start..self.at,
        })
    }

    fn single(&mut self, kind: TokenKind) -> TokenKind {
        self.at += 1;
        kind
    }

    fn skip_blank(&mut self) {
        loop {
            self.advance_to(|c| !is_blank(c));
            let start = self.at;
            if self.rest().starts_with("//") {
                self.advance_to(|c| c == '\n');
            } else if self.rest().starts_with("/*") {
                self.skip_block_comment(start);
            } else if self.rest().starts_with("#!") {
                self.advance_behind("]", "attribute", start);
            } else {
                return;
            }
        }
    }

    /// Block comments nest in RON.
    fn skip_block_comment(&mut self, start: usize) {
        let mut depth = 0_usize;
        while !self.rest().is_empty() {
            if self.rest().starts_with("/*") {
                depth += 1;
                self.at += 2;
            } else if self.rest().starts_with("*/") {
                depth -= 1;
                self.at += 2;
                if depth == 0 {
                    return;
                }
            } else {
                self.at += self.rest().chars().next().map_or(1, char::len_utf8);
            }
        }
        self.leave_open("comment", start);
    }

    fn quoted(&mut self, quote: char) -> TokenKind {
        let start = self.at;
        self.at += 1;
        loop {
            self.advance_to(|c| c == '\\' || c == quote);
            match self.rest().chars().next() {
                Some('\\') => {
                    // The escaped character may be a quote: both are passed over.
                    let escaped = self.rest().chars().nth(1);
                    self.at += 1 + escaped.map_or(0, char::len_utf8);
                }
                Some(_) => {
                    self.at += 1;
                    return TokenKind::Text;
                }
                None => {
                    self.leave_open("string", start);
                    return TokenKind::Text;
                }
            }
        }
    }

    /// `r"..."`, `r#"..."#`, `b"..."`, `br"..."`, or else a word.
    fn word_or_raw_string(&mut self) -> TokenKind {
        let start = self.at;
        let rest = self.rest();
        let bare = rest.strip_prefix('b').unwrap_or(rest);
        let hashes = bare.strip_prefix('r').and_then(|body| {
            let n = body.len() - body.trim_start_matches('#').len();
            body.get(n..)?.starts_with('"').then_some(n)
        });
        let prefix = rest.len() - bare.len();
        let quote = bare.chars().next().filter(|c| ['"', '\''].contains(c));
        if let Some(n) = hashes {
            self.at += prefix + 1 + n + 1;
            let end = format!("\"{}", "#".repeat(n));
            self.advance_behind(&end, "string", start);
            return TokenKind::Text;
        }
        if let (1, Some(quote)) = (prefix, quote) {
            self.at += 1;
            return self.quoted(quote);
        }
        self.skip_word();
        TokenKind::Word
    }

    fn skip_word(&mut self) {
        let mut previous = None;
        let mut end = 0;
        for (at, c) in self.rest().char_indices() {
            let comment = previous == Some('/') && (c == '/' || c == '*');
            if comment {
                end = at - 1;
                break;
            }
            if is_blank(c) || "()[]{}:,\"'".contains(c) {
                break;
            }
            end = at + c.len_utf8();
            previous = Some(c);
        }
        self.at += end.max(1);
    }
}

/// Whitespace between tokens.
fn is_blank(c: char) -> bool {
    c.is_ascii_whitespace()
        || matches!(
            c,
            '\u{b}' | '\u{85}' | '\u{200e}' | '\u{200f}' | '\u{2028}' | '\u{2029}' | '\u{feff}'
        )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<&str> {
        let (tokens, _) = tokens(text);
        tokens.iter().map(|t| &text[t.span.clone()]).collect()
    }

    #[test]
    fn comments_nest_and_leave_no_token() {
        assert_eq!(words("a /* b /* c */ d */ e // f\ng"), ["a", "e", "g"]);
        assert_eq!(words("1.5//half\n2/*two*/3"), ["1.5", "2", "3"]);
    }

    #[test]
    fn strings_keep_their_brackets() {
        let text = r###"("a\")", r#"b")"#, b"c", 'd', '\'', r#type)"###;
        let expected = [
            "(",
            r#""a\")""#,
            ",",
            r###"r#"b")"#"###,
            ",",
            r#"b"c""#,
            ",",
            "'d'",
            ",",
            r"'\''",
            ",",
            "r#type",
            ")",
        ];
        assert_eq!(words(text), expected);
    }

    #[test]
    fn what_is_never_closed_is_told() {
        let (_, unclosed) = tokens("a /* b /* c */");
        assert_eq!(
            unclosed,
            Some(Unclosed {
                what: "comment",
                start: 2
            })
        );
        let (_, unclosed) = tokens("(\"abc\\");
        assert_eq!(
            unclosed,
            Some(Unclosed {
                what: "string",
                start: 1
            })
        );
    }
}
