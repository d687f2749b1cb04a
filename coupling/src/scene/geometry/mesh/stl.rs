//! STL, text or binary, all solids of a file.
//!
//! A reader of its own, because the usual one stops silently after the first solid of a text file and
//! refuses keywords in capitals.

use riprap_dda::Vec3;

use super::Soup;
use crate::scene::access::fault::{Fault, MOST_TRIANGLES};

/// Bytes before the first facet: a free header and the number of facets.
const HEADER: usize = 84;
/// Bytes of a facet: normal and three corners in single precision, and two unused ones.
const FACET: usize = 50;

pub(super) fn read(content: &[u8]) -> Result<Soup, Fault> {
    let stated = content
        .get(80..HEADER)
        .and_then(|b| b.try_into().ok())
        .map(u32::from_le_bytes);
    let expected = stated.map(|n| HEADER as u64 + FACET as u64 * u64::from(n));
    // a binary file may begin with "solid" too, so its length is asked first
    if expected == Some(content.len() as u64) {
        return binary(&content[HEADER..]);
    }
    let begins = content.trim_ascii_start().get(..5).unwrap_or_default();
    match (begins.eq_ignore_ascii_case(b"solid"), stated, expected) {
        (true, ..) => text(&String::from_utf8_lossy(content)),
        (false, Some(stated), Some(expected)) => Err(Fault::Format(format!(
            "not text, and as binary STL of {stated} facets it should have {expected} bytes, not {}; \
             the file is cut or damaged: export it again",
            content.len()
        ))),
        _ => Err(Fault::Format(
            "neither text that begins with `solid` nor binary STL".into(),
        )),
    }
}

fn binary(facets: &[u8]) -> Result<Soup, Fault> {
    let mut soup = Soup::default();
    for facet in facets.as_chunks::<FACET>().0 {
        let number = |k: usize| {
            let at = 12 + 4 * k;
            f64::from(f32::from_le_bytes([
                facet[at],
                facet[at + 1],
                facet[at + 2],
                facet[at + 3],
            ]))
        };
        let corners = [0, 3, 6].map(|k| Vec3::new(number(k), number(k + 1), number(k + 2)));
        push(&mut soup, corners)?;
    }
    Ok(soup)
}

/// Text STL. Only `vertex` lines carry geometry; the other keywords are checked against them, so that a facet of two or
/// four corners and a truncated file are noticed.
fn text(text: &str) -> Result<Soup, Fault> {
    let mut soup = Soup::default();
    let mut corners = Vec::new();
    let mut is_inside = false;
    for (index, line) in text.lines().enumerate() {
        let wrong = |found: String| Fault::Format(format!("line {}: {found}", index + 1));
        let mut words = line.split_whitespace();
        let keyword = words.next().unwrap_or_default().to_ascii_lowercase();
        match keyword.as_str() {
            "solid" => is_inside = true,
            "endsolid" => is_inside = false,
            "vertex" => {
                corners.push(corner(words).ok_or_else(|| {
                    wrong(format!("found `{}`, needed `vertex x y z`", line.trim()))
                })?)
            }
            "endfacet" => {
                let [a, b, c] = corners[..] else {
                    return Err(wrong(format!(
                        "the facet has {} corners, needs 3",
                        corners.len()
                    )));
                };
                push(&mut soup, [a, b, c])?;
                corners.clear();
            }
            "" | "facet" | "outer" | "endloop" => {}
            _ => {
                return Err(wrong(format!(
                    "`{keyword}` is not a keyword of STL; write one statement a line"
                )));
            }
        }
    }
    if is_inside || !corners.is_empty() {
        return Err(Fault::Format(
            "ends without `endsolid`; the file is cut: export it again".into(),
        ));
    }
    Ok(soup)
}

fn corner<'a>(words: impl Iterator<Item = &'a str>) -> Option<Vec3> {
    let numbers: Option<Vec<f64>> = words.map(|word| word.parse().ok()).collect();
    match numbers?[..] {
        [x, y, z] => Some(Vec3::new(x, y, z)),
        _ => None,
    }
}

fn push(soup: &mut Soup, corners: [Vec3; 3]) -> Result<(), Fault> {
    if soup.triangles.len() >= MOST_TRIANGLES {
        return Err(Fault::TooManyTriangles);
    }
    let first = soup.points.len() as u32;
    soup.points.extend(corners);
    soup.triangles.push([first, first + 1, first + 2]);
    Ok(())
}
