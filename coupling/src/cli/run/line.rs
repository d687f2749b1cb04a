//! Line of progress: the parts that a width has room for.

use crate::run::Progress;

/// Between two parts.
const SEPARATOR: &str = " | ";

/// Progress in one line of at most `width` characters.
///
/// ```text
/// t 1.2000 of 6.0000 s (20 %) | step 12000 | dt 1.00e-4 s | 83.1 steps/s | left 2:44
/// ```
pub(super) fn line(progress: &Progress, width: usize) -> String {
    let Progress {
        is_settling,
        steps,
        time,
        end,
        dt,
        contacts,
        fastest,
        share,
        steps_per_second,
        left,
        ..
    } = *progress;
    let stage = if is_settling { "settling " } else { "" };
    // in the order of the line; the rank says which are kept
    let parts = [
        (
            0,
            format!(
                "{stage}t {} of {} s ({:.0} %)",
                fixed(time, end),
                fixed(end, end),
                (100.0 * share).floor()
            ),
        ),
        (2, format!("step {}", count(steps as f64))),
        (3, format!("dt {dt:.2e} s")),
        (6, format!("contacts {}", count(contacts as f64))),
        (5, format!("v max {} m/s", short(fastest))),
        (4, format!("{} steps/s", short(steps_per_second))),
        (1, format!("left {}", duration(left))),
    ];
    let length = |text: &str| text.chars().count();
    let mut room = width;
    let mut is_kept = [false; 7];
    for rank in 0..parts.len() {
        let Some(at) = parts.iter().position(|part| part.0 == rank) else {
            continue;
        };
        let separator = if rank == 0 { 0 } else { SEPARATOR.len() };
        let needed = length(&parts[at].1) + separator;
        is_kept[at] = needed <= room;
        room = room.saturating_sub(if is_kept[at] { needed } else { 0 });
    }
    let kept = parts.iter().zip(is_kept).filter(|(_, is_kept)| *is_kept);
    let texts: Vec<&str> = kept.map(|((_, text), _)| text.as_str()).collect();
    if texts.is_empty() {
        // what fits of the first
        return parts[0].1.chars().take(width).collect();
    }
    texts.join(SEPARATOR)
}

/// A time with as many digits as its end needs for five.
fn fixed(time: f64, end: f64) -> String {
    let magnitude = end.abs().log10().floor();
    if (-5.0..7.0).contains(&magnitude) {
        let digits = (4.0 - magnitude).max(0.0) as usize;
        format!("{time:.digits$}")
    } else {
        format!("{time:.3e}")
    }
}

/// A count, of more than nine digits by its magnitude.
fn count(number: f64) -> String {
    if number < 1e9 {
        format!("{number:.0}")
    } else {
        format!("{number:.2e}")
    }
}

/// Three digits.
fn short(number: f64) -> String {
    match number.abs() {
        0.0 => "0".to_owned(),
        n if !(1e-2..1e4).contains(&n) => format!("{number:.1e}"),
        n if n < 10.0 => format!("{number:.2}"),
        n if n < 100.0 => format!("{number:.1}"),
        _ => format!("{number:.0}"),
    }
}

/// `m:ss`, `h:mm:ss` or days and hours.
fn duration(seconds: Option<f64>) -> String {
    let Some(seconds) = seconds.filter(|seconds| seconds.is_finite()) else {
        return "?".to_owned();
    };
    // a second in which something is left is one
    let all = seconds.max(0.0).ceil().min(1e15) as u64;
    let (days, hours, minutes) = (all / 86_400, all / 3600, all / 60 % 60);
    match (days, hours) {
        (1000.., _) => "> 999 d".to_owned(),
        (1.., _) => format!("{days} d {:02} h", hours % 24),
        (0, 1..) => format!("{hours}:{minutes:02}:{:02}", all % 60),
        (0, 0) => format!("{minutes}:{:02}", all % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::time_step::Cause;

    fn progress() -> Progress {
        Progress {
            is_settling: false,
            steps: 12_000,
            time: 1.2,
            end: 6.0,
            dt: 1e-4,
            cause: Cause::Sound,
            contacts: 412,
            fastest: 3.25,
            particles: 25_000,
            share: 0.2,
            steps_per_second: 83.14,
            left: Some(163.2),
        }
    }

    #[test]
    fn a_wide_line_has_everything_and_one_of_80_columns_the_most_important() {
        assert_eq!(
            line(&progress(), 200),
            "t 1.2000 of 6.0000 s (20 %) | step 12000 | dt 1.00e-4 s | contacts 412 | v max 3.25 m/s | 83.1 steps/s | left 2:44"
        );
        assert_eq!(
            line(&progress(), 79),
            "t 1.2000 of 6.0000 s (20 %) | step 12000 | dt 1.00e-4 s | left 2:44"
        );
        assert_eq!(
            line(&progress(), 42),
            "t 1.2000 of 6.0000 s (20 %) | left 2:44"
        );
        assert_eq!(line(&progress(), 10), "t 1.2000 o");
    }

    #[test]
    fn no_number_makes_a_line_wrap() {
        for (steps, dt, end, left) in [
            (10_000_000, 1e-9, 1e-2, Some(1e9)),
            (u64::MAX, 1e-300, 1e12, Some(f64::MAX)),
            (0, f64::NAN, 1e-9, None),
            (1, 1e300, f64::INFINITY, Some(f64::NAN)),
            (99_999_999, 1.234e-5, 86_400.0, Some(86_399.5)),
        ] {
            let extreme = Progress {
                is_settling: true,
                steps,
                dt,
                end,
                left,
                time: end / 3.0,
                contacts: usize::MAX,
                fastest: 1e12,
                steps_per_second: 1e-7,
                ..progress()
            };
            for width in [0, 1, 20, 39, 79, 119, 500] {
                let line = line(&extreme, width);
                assert!(line.chars().count() <= width, "{width}: {line}");
                assert!(!line.contains('\n'));
            }
            let line = line(&extreme, 79);
            assert!(
                line.starts_with("settling t ") && line.contains("left "),
                "{line}"
            );
        }
        let long = Progress {
            steps: 10_000_000,
            dt: 1e-9,
            ..progress()
        };
        assert!(line(&long, 79).contains("step 10000000 | dt 1.00e-9 s"));
    }

    #[test]
    fn durations_are_those_of_a_clock() {
        for (seconds, text) in [
            (0.0, "0:00"),
            (59.2, "1:00"),
            (3599.0, "59:59"),
            (3600.0, "1:00:00"),
            (86_399.5, "1 d 00 h"),
            (200_000.0, "2 d 07 h"),
            (1e9, "> 999 d"),
        ] {
            assert_eq!(duration(Some(seconds)), text);
        }
    }
}
