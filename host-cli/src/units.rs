//! Numbers with units, formatted for people and parsed from their input.

/// A length with its unit.
pub fn length(metres: f64) -> String {
    precise(metres, 0)
}

/// A length with its unit and `more` additional digits.
fn precise(metres: f64, more: usize) -> String {
    match metres {
        m if m >= 1e-1 => format!("{m:.*} m", 2 + more),
        m if m >= 1e-3 => format!("{:.*} mm", 1 + more, 1e3 * m),
        m if m >= 1e-6 => format!("{:.*} um", 1 + more, 1e6 * m),
        m if m >= 1e-9 => format!("{:.*} nm", 1 + more, 1e9 * m),
        m if m > 0.0 => format!("{m:.more$e} m"),
        _ => "0 m".into(),
    }
}

/// A mass with its unit.
pub fn mass(kilograms: f64) -> String {
    match kilograms {
        m if m >= 1.0 => format!("{m:.2} kg"),
        m if m >= 1e-3 => format!("{:.1} g", 1e3 * m),
        m if m >= 1e-6 => format!("{:.1} mg", 1e6 * m),
        m => format!("{m:.1e} kg"),
    }
}

/// A length as a whole number of its unit, for the ticks of an axis.
pub fn round_length(metres: f64) -> String {
    let scales = [("m", 1.0), ("mm", 1e-3), ("um", 1e-6), ("nm", 1e-9), ("pm", 1e-12), ("fm", 1e-15)];
    // A length that rounding puts just below one unit counts as one unit.
    let fitting = scales.iter().find(|(_, scale)| metres >= 0.999 * scale);
    fitting.map_or_else(|| format!("{metres:.0e} m"), |(unit, scale)| format!("{:.0} {unit}", metres / scale))
}

/// A value on an axis that spans `span`, with as many digits as tell ticks apart: axes have less than 50 of them.
pub fn tick(value: f64, span: f64) -> String {
    let digits = (3.0 - span.log10().floor()).clamp(0.0, 15.0) as usize;
    let value: f64 = format!("{value:.digits$}").parse().unwrap_or(value);
    match value.abs() {
        0.0 => "0".into(),
        1e-2..1e6 => value.to_string(),
        _ => format!("{value:e}"),
    }
}

/// Limit on additional digits: no measured length has more.
const MOST_DIGITS: usize = 8;

/// Two lengths with enough digits to tell them apart; without additional digits if that is impossible.
pub fn apart(a: f64, b: f64) -> [String; 2] {
    let shown = |more| [a, b].map(|metres| precise(metres, more));
    (0..MOST_DIGITS).map(shown).find(|[a, b]| a != b).unwrap_or_else(|| shown(0))
}

/// A time with its unit.
pub fn time(seconds: f64) -> String {
    match seconds {
        s if s >= 1.0 => format!("{s:.2} s"),
        s if s >= 1e-3 => format!("{:.2} ms", 1e3 * s),
        s if s >= 1e-6 => format!("{:.2} us", 1e6 * s),
        s if s >= 1e-9 => format!("{:.2} ns", 1e9 * s),
        s if s > 0.0 => format!("{s:.1e} s"),
        _ => "0 s".into(),
    }
}

/// A number without the rounding errors of its last digits: no time is known to twelve digits.
pub fn without_noise(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}

/// The unit that suits a time: how many of it make a second, and its name.
fn unit(seconds: f64) -> (f64, &'static str) {
    match seconds {
        s if s >= 1.0 => (1.0, "s"),
        s if s >= 1e-3 => (1e3, "ms"),
        s if s >= 1e-6 => (1e6, "us"),
        _ => (1e9, "ns"),
    }
}

/// A number rounded to `digits` significant digits, without an exponent.
fn rounded(value: f64, digits: i32) -> String {
    // Scientific notation rounds correctly where the power of ten changes: 9.99 to two digits is 10.
    let exact = format!("{value:.*e}", (digits - 1).max(0) as usize);
    let power = exact.split_once('e').and_then(|(_, power)| power.parse::<i32>().ok()).unwrap_or(0);
    let value = exact.parse::<f64>().unwrap_or(value);
    format!("{value:.*}", (digits - 1 - power).clamp(0, 12) as usize)
}

/// A time with its unit, to `digits` significant digits.
pub fn significant(seconds: f64, digits: i32) -> String {
    let (times, name) = unit(seconds);
    format!("{} {name}", rounded(times * seconds, digits))
}

/// The range from one time to a longer one, in the unit of the longer one, to two digits.
pub fn time_between(from: f64, to: f64) -> String {
    let (times, name) = unit(to);
    format!("{}..{} {name}", rounded(times * from, 2), rounded(times * to, 2))
}

/// Units of length, m. Longer names come first, because `m` also ends the others.
const UNITS: [(&str, f64); 6] = [("cm", 1e-2), ("mm", 1e-3), ("um", 1e-6), ("\u{b5}m", 1e-6), ("nm", 1e-9), ("m", 1.0)];

/// Parses a length in metres: a number with a unit, or without one in metres.
pub fn metres(text: &str) -> Option<f64> {
    let text = text.trim();
    let (number, unit) =
        UNITS.iter().find_map(|(name, unit)| Some((text.strip_suffix(name)?, *unit))).unwrap_or((text, 1.0));
    number.trim_end().parse::<f64>().ok().map(|number| number * unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tick_is_a_whole_number_of_its_unit() {
        let cases = [
            (1.0, "1 m"),
            (0.1, "100 mm"),
            (1e-3, "1 mm"),
            (0.999_999e-3, "1 mm"),
            (2e-8, "20 nm"),
            (1e-12, "1 pm"),
            (1e-13, "100 fm"),
        ];
        for (metres, expected) in cases {
            assert_eq!(round_length(metres), expected);
        }
        assert_eq!(round_length(1e-18), "1e-18 m");
    }

    #[test]
    fn ticks_have_the_digits_that_tell_them_apart() {
        let shown = |from: f64, step: f64| [0, 1, 2].map(|k| tick(from + f64::from(k) * step, 5.0 * step));
        for (from, step, expected) in [
            (0.0, 0.1, ["0", "0.1", "0.2"]),
            (-0.3, 0.3, ["-0.3", "0", "0.3"]),
            (0.0, 250.0, ["0", "250", "500"]),
            (9.81, 1e-4, ["9.81", "9.8101", "9.8102"]),
            (-123_456.0, 0.5, ["-123456", "-123455.5", "-123455"]),
            (3e-9, 1e-9, ["3e-9", "4e-9", "5e-9"]),
            (2e7, 2.5e6, ["2e7", "2.25e7", "2.5e7"]),
        ] {
            assert_eq!(shown(from, step), expected);
        }
        // Values that are all alike have no span.
        assert_eq!(tick(0.5, 0.0), "0.5");
    }

    #[test]
    fn lengths_that_differ_are_told_apart() {
        for (a, b, shown) in [
            (2.0e-3, 2.04e-3, ["2.00 mm", "2.04 mm"]),
            (2.0e-3, 3.0e-3, ["2.0 mm", "3.0 mm"]),
            (1.0e-3, 1.0004e-3, ["1.0000 mm", "1.0004 mm"]),
            (1e-3, 1e-3, ["1.0 mm", "1.0 mm"]),
        ] {
            assert_eq!(apart(a, b), shown);
        }
    }

    #[test]
    fn times_have_the_unit_that_suits_them() {
        let cases = [(0.0, "0 s"), (2e-8, "20.00 ns"), (1e-300, "1.0e-300 s"), (2e-6, "2.00 us"), (1.5, "1.50 s")];
        for (seconds, expected) in cases {
            assert_eq!(time(seconds), expected);
        }
        assert_eq!([0.1 + 0.2, 3.0 * 0.1, 1.0 / 3.0, 0.0].map(without_noise), [0.3, 0.3, 0.333_333_333_333, 0.0]);
    }

    #[test]
    fn times_have_as_many_digits_as_are_known() {
        let cases = [(0.13333, 2, "130 ms"), (7.4823e-4, 4, "748.2 us"), (1.0 / 3.0, 2, "330 ms"), (2.0, 2, "2.0 s")];
        for (seconds, digits, expected) in cases {
            assert_eq!(significant(seconds, digits), expected);
        }
        assert_eq!(significant(9.996e-3, 2), "10 ms");
        assert_eq!(significant(8.249e-7, 4), "824.9 ns");
        assert_eq!(time_between(7.1e-4, 1.004e-3), "0.71..1.0 ms");
    }

    #[test]
    fn a_length_has_a_unit_or_is_in_metres() {
        let cases = [("1mm", 1e-3), ("0.5 cm", 5e-3), ("200um", 2e-4), ("0.001", 1e-3), ("2m", 2.0), ("3e2nm", 3e-7)];
        for (text, expected) in cases {
            let metres = metres(text).unwrap();
            assert!((metres / expected - 1.0).abs() < 1e-15, "{text}: {metres}");
        }
        for text in ["", "mm", "1 inch", "1 m m", "one", "1,5mm"] {
            assert_eq!(metres(text), None, "{text}");
        }
    }
}
