//! Wavefront OBJ: faces of any number of corners; colors, normals and materials are ignored.
//!
//! A reader of its own, because the usual one panics at a corner whose normal or texture is out of range.

use riprap_dda::Vec3;

use super::Soup;
use crate::scene::access::fault::Fault;

/// Marks a point without a number in the soup.
const UNUSED: u32 = u32::MAX;

pub(super) fn read(content: &[u8]) -> Result<Soup, Fault> {
    let text = String::from_utf8_lossy(content);
    let mut points: Vec<Vec3> = Vec::new();
    // only points that a face uses are taken over, in the order of their use
    let mut number: Vec<u32> = Vec::new();
    let mut soup = Soup::default();
    let mut corners = Vec::new();
    let mut lines = (1..).zip(text.lines());
    while let Some((first_line, line)) = lines.next() {
        let wrong = |found: String| Fault::Format(format!("line {first_line}: {found}"));
        let mut statement = without_comment(line).to_owned();
        // a backslash at its end joins a line with the next
        while statement.ends_with('\\') {
            statement.pop();
            let next = lines.next().map_or("", |(_, line)| line);
            statement.push(' ');
            statement.push_str(without_comment(next));
        }
        let mut words = statement.split_whitespace();
        match words.next() {
            Some("v") => {
                let point = place(&mut words).ok_or_else(|| {
                    wrong(format!("found `{}`, needed `v x y z`", statement.trim()))
                })?;
                points.push(point);
                number.push(UNUSED);
            }
            Some("f") => {
                corners.clear();
                for word in words {
                    let point = index(word, points.len()).ok_or_else(|| {
                        let n = points.len();
                        wrong(format!(
                            "`{word}` is not a corner: there are {n} points before it"
                        ))
                    })?;
                    if number[point] == UNUSED {
                        number[point] = soup.points.len() as u32;
                        soup.points.push(points[point]);
                    }
                    corners.push(number[point]);
                }
                soup.push_polygon(&corners)?;
            }
            _ => {}
        }
    }
    Ok(soup)
}

fn without_comment(line: &str) -> &str {
    line.split('#').next().unwrap_or_default().trim_end()
}

/// Three numbers; a weight and colors may follow.
fn place<'a>(words: &mut impl Iterator<Item = &'a str>) -> Option<Vec3> {
    let mut number = || words.next()?.parse().ok();
    Some(Vec3::new(number()?, number()?, number()?))
}

/// The point that a corner `v`, `v/vt`, `v//vn` or `v/vt/vn` names, from 0; those in a file count from 1, or
/// backward from -1.
fn index(corner: &str, n_points: usize) -> Option<usize> {
    let number: i64 = corner.split('/').next()?.parse().ok()?;
    let from_zero = if number < 0 {
        i64::try_from(n_points).ok()?.checked_add(number)?
    } else {
        number - 1
    };
    usize::try_from(from_zero).ok().filter(|&v| v < n_points)
}
