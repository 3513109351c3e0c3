//! Numbers as people read them.

/// A length with its unit.
pub fn length(metres: f64) -> String {
    match metres {
        m if m >= 1e-1 => format!("{m:.2} m"),
        m if m >= 1e-3 => format!("{:.1} mm", 1e3 * m),
        m if m >= 1e-6 => format!("{:.1} um", 1e6 * m),
        m if m >= 1e-9 => format!("{:.1} nm", 1e9 * m),
        m if m > 0.0 => format!("{m:.0e} m"),
        _ => "0 m".into(),
    }
}

/// A length with its unit and no more digits than it has: for the ticks of an axis.
pub fn round_length(metres: f64) -> String {
    let scales = [("m", 1.0), ("mm", 1e-3), ("um", 1e-6), ("nm", 1e-9)];
    // A hair below one unit is one unit.
    let fitting = scales.iter().find(|(_, scale)| metres >= 0.999 * scale);
    fitting.map_or_else(|| format!("{metres:.0e} m"), |(unit, scale)| format!("{:.0} {unit}", metres / scale))
}

/// A time with its unit.
pub fn time(seconds: f64) -> String {
    match seconds {
        s if s >= 1.0 => format!("{s:.2} s"),
        s if s >= 1e-3 => format!("{:.2} ms", 1e3 * s),
        s => format!("{:.2} us", 1e6 * s),
    }
}

/// Units of a length, the longer names first, m.
const UNITS: [(&str, f64); 6] = [("cm", 1e-2), ("mm", 1e-3), ("um", 1e-6), ("\u{b5}m", 1e-6), ("nm", 1e-9), ("m", 1.0)];

/// A length as people write it: a number, with a unit or in metres.
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
        let cases = [(1.0, "1 m"), (0.1, "100 mm"), (1e-3, "1 mm"), (0.999_999e-3, "1 mm"), (2e-8, "20 nm")];
        for (metres, expected) in cases {
            assert_eq!(round_length(metres), expected);
        }
        assert_eq!(round_length(1e-12), "1e-12 m");
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
