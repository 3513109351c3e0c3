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

/// A time with its unit.
pub fn time(seconds: f64) -> String {
    match seconds {
        s if s >= 1.0 => format!("{s:.2} s"),
        s if s >= 1e-3 => format!("{:.2} ms", 1e3 * s),
        s => format!("{:.2} us", 1e6 * s),
    }
}
