//! The picture of `muslin validate --only hinge`: rigidity of each sheet by direction.

use kuva::backend::svg::SvgBackend;
use kuva::plot::LinePlot;
use kuva::render::figure::Figure;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;

use crate::study::validate::{Row, cylinders};

/// Colour of each sheet [Wong 2011].
const COLORS: [&str; 4] = ["#000000", "#56b4e9", "#d55e00", "#0072b2"];

/// Size of the panel, px.
const PANEL: [f64; 2] = [560.0, 380.0];

/// Rigidity over the one asked for by the direction along which a sheet is bent. `None` if nothing was measured.
pub fn rigidity(rows: &[Row]) -> Option<String> {
    let sheets = cylinders(rows);
    let most = sheets.iter().flat_map(|(_, points)| points).map(|point| point.1).fold(0.0, f64::max);
    if most == 0.0 {
        return None;
    }
    let drawn = sheets.into_iter().zip(COLORS).filter(|((_, points), _)| !points.is_empty());
    let lines = drawn.map(|((name, points), color)| {
        Plot::Line(LinePlot::new().with_data(points).with_color(color).with_stroke_width(2.0).with_legend(name))
    });
    let layout = Layout::new((0.0, 180.0), (0.0, 1.1 * most))
        .with_x_tick_step(45.0)
        .with_x_label("direction along which the sheet is bent, degrees from x towards z")
        .with_y_label("rigidity / rigidity asked for");
    let figure = Figure::new(1, 1)
        .with_title("Rigidity of sheets of hinges that stay cylinders, in equilibrium")
        .with_plots(vec![lines.collect()])
        .with_layouts(vec![layout])
        .with_cell_size(PANEL[0], PANEL[1])
        .with_shared_legend_right_middle();
    Some(SvgBackend.render_scene(&figure.render()))
}
