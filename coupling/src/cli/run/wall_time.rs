//! Wall times on the command line.

use std::time::Duration;

/// Largest wall time; s.
const LARGEST: f64 = 1e9;

/// Reads `90`, `90s`, `45min`, `2h`, `3h30m`, `1:30:00` or `45:00`.
pub(in crate::cli) fn wall_time(text: &str) -> Result<Duration, String> {
    let seconds = match text.contains(':') {
        true => clock(text),
        false => units(text),
    };
    match seconds {
        Some(seconds) if 0.0 < seconds && seconds <= LARGEST => {
            Ok(Duration::from_secs_f64(seconds))
        }
        _ => Err(format!(
            "`{text}` is no wall time above 0; write 5400, 90min, 1h30m or 1:30:00"
        )),
    }
}

/// `h:mm:ss` or `m:ss`; s.
fn clock(text: &str) -> Option<f64> {
    let parts: Vec<&str> = text.split(':').collect();
    if !(2..=3).contains(&parts.len()) {
        return None;
    }
    parts.iter().enumerate().try_fold(0.0, |sum, (k, part)| {
        let is_number = !part.is_empty() && part.bytes().all(|digit| digit.is_ascii_digit());
        let number: f64 = part.parse().ok().filter(|_| is_number)?;
        (k == 0 || number < 60.0).then_some(60.0 * sum + number)
    })
}

/// Numbers with units, the largest first; a number alone is in seconds; s.
fn units(text: &str) -> Option<f64> {
    let (mut rest, mut sum, mut before) = (text.trim(), 0.0, f64::INFINITY);
    if rest.is_empty() {
        return None;
    }
    while !rest.is_empty() {
        let end = rest.find(|c: char| !(c.is_ascii_digit() || c == '.'));
        let (number, behind) = rest.split_at(end.unwrap_or(rest.len()));
        let behind = behind.trim_start();
        let end = behind.find(|c: char| !c.is_ascii_alphabetic());
        let (unit, behind) = behind.split_at(end.unwrap_or(behind.len()));
        let unit = match unit {
            "d" => 86_400.0,
            "h" => 3600.0,
            "min" | "m" => 60.0,
            "s" => 1.0,
            "" if behind.is_empty() => 1.0,
            _ => return None,
        };
        if before <= unit {
            return None;
        }
        sum += unit * number.parse::<f64>().ok()?;
        (rest, before) = (behind.trim_start(), unit);
    }
    Some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wall_times_are_read_as_people_write_them() {
        for (text, seconds) in [
            ("90", 90),
            ("90s", 90),
            ("90 s", 90),
            ("45min", 2700),
            ("2h", 7200),
            ("0.5h", 1800),
            ("3h30m", 12_600),
            ("3 h 30 min", 12_600),
            ("1d2h", 93_600),
            ("45:00", 2700),
            ("1:30:00", 5400),
            ("100:00:30", 360_030),
        ] {
            assert_eq!(wall_time(text), Ok(Duration::from_secs(seconds)), "{text}");
        }
        for text in [
            "", "0", "-5", "h", "3x", "30m3h", "3h3h", "5 6", "1:75:00", "1:2:3:4", ":30", "1:-2",
            "inf", "NaN", "1e400", "2e9s",
        ] {
            assert!(wall_time(text).is_err(), "{text}");
        }
    }
}
