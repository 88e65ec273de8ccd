//! A date as a person writes it.

use crate::scene::visit::is_date;

/// The date of a text as a person writes it, as 2026-01-31: year-month-day, or day.month.year with points, strokes or hyphens. The day is
/// first; the month only where the second number is no month. `None` for a text that is no date.
pub(super) fn read_date(text: &str) -> Option<String> {
    let parts: Vec<&str> = text.trim().split(['.', '/', '-']).map(str::trim).collect();
    let [first, second, third] = parts.try_into().ok()?;
    let is_year = |part: &str| part.len() == 4;
    let is_number = |part: &str| part.len() <= 2 && part.bytes().all(|b| b.is_ascii_digit());
    let number = |part: &str| part.parse::<u32>().ok().filter(|_| is_number(part));
    let (year, month, day) = match (is_year(first), is_year(third)) {
        (true, false) => (first, number(second)?, number(third)?),
        (false, true) => match (number(first)?, number(second)?) {
            (month, day @ 13..) => (third, month, day),
            (day, month) => (third, month, day),
        },
        _ => return None,
    };
    let date = format!("{year}-{month:02}-{day:02}");
    is_date(&date).then_some(date)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_written_date_is_read_day_first() {
        for (text, date) in [
            ("2026-11-25", Some("2026-11-25")),
            ("25.11.2026", Some("2026-11-25")),
            ("25/11/2026", Some("2026-11-25")),
            (" 5. 3. 2026 ", Some("2026-03-05")),
            ("3-5-2026", Some("2026-05-03")),
            ("2026/3/5", Some("2026-03-05")),
            // No month 25: the month is first.
            ("11/25/2026", Some("2026-11-25")),
            ("31.04.2026", None),
            ("25.11.26", None),
            ("13/13/2026", None),
            ("25.11.2026.", None),
            ("2026-11-2026", None),
            ("+5.3.2026", None),
            ("005.3.2026", None),
            ("25.11.20é", None),
            ("", None),
        ] {
            assert_eq!(read_date(text).as_deref(), date, "{text}");
        }
    }
}
