//! Error messages for a chart that cannot be drawn or cannot be trusted.

use muslin_core::integrate::Method;

use crate::study::Study;
use crate::study::reference::Reference;
use crate::study::trajectory::Ending;
use crate::units::time;

use super::report::Chart;

/// The message if no two steps of the reference's method could be compared: how far it came, and which budget would
/// suffice.
pub fn no_reference(study: &Study<'_>, reference: &Reference) -> String {
    let tried = [reference.cut.as_ref(), reference.runs.last(), reference.failed.as_ref()];
    let reached = tried.into_iter().flatten().next().map_or_else(
        || "no step was tried".into(),
        |(variant, run)| {
            let became = match &run.ending {
                Ending::Complete => "works, but there was no time for shorter steps".into(),
                Ending::OutOfTime => {
                    format!("reached {:.3} s of {} s in this time", run.report.time, study.scene.desc.duration)
                }
                Ending::Diverged(what) => format!("fails ({what})"),
                Ending::Grown => "fails: its energy grows".into(),
            };
            format!(
                "the shortest step that was tried, {} of {}, {became}",
                time(variant.step(&study.scene)),
                variant.method.name()
            )
        },
    );
    let needs = reference.least_budget().map_or_else(String::new, |s| {
        format!("; two runs with this step, which can be compared, would take a --budget of at least {s:.0} s")
    });
    format!(
        "no reference for {} within {} s, of which it may take {:.0} %: {reached}{needs}; take a shorter --duration, a \
         coarser or softer cloth by --set, or a larger --budget",
        study.scene.desc.name,
        study.arguments.budget,
        100.0 * crate::study::reference::SHARE
    )
}

/// The message if there is a reference, but no run to compare with it.
pub fn nothing_charted(chart: &Chart) -> String {
    let reasons: Vec<_> = chart.omitted.iter().map(|o| format!("{} {}: {}", o.method, o.precision, o.why)).collect();
    format!("nothing could be charted for {}: {}", chart.scene, reasons.join("; "))
}

/// The message if the chart is drawn, but no implicit method confirms its reference.
pub fn unconfirmed(chart: &Chart) -> String {
    let implicit = |name: &str| Method::ALL.into_iter().any(|method| method.is_implicit() && method.name() == name);
    let slopes = chart.orders.iter().filter(|order| implicit(order.method));
    let slopes: Vec<_> = slopes
        .map(|order| format!("{} has the slope {:.2}, not {}", order.method, order.measured, order.theory))
        .collect();
    let slopes = if slopes.is_empty() { "none has an order yet".into() } else { slopes.join(", ") };
    format!(
        "no implicit method confirms the reference for {}, whose shortest step was {}: {slopes}; the errors rest on \
         this reference only. Take a larger --budget for shorter steps, a shorter --duration, or damping for modes \
         that oscillate",
        chart.scene,
        time(chart.reference.step),
    )
}
