//! The picture of a series: energies, works, and the forces of pins and colliders, over time.

use std::path::Path;
use std::sync::Arc;

use kuva::backend::svg::SvgBackend;
use kuva::plot::LinePlot;
use kuva::plot::legend::LegendPosition;
use kuva::render::figure::Figure;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;
use muslin_core::scene::SceneDesc;

use crate::failure::Failure;
use crate::limits;
use crate::units::tick;

/// Size of one panel, px.
const PANEL: [f64; 2] = [820.0, 320.0];
/// Most points of a curve.
const MOST: usize = 1500;
/// Colours that colour-blind readers can distinguish [Wong 2011], and that can be seen on white: yellow is left out. A
/// panel with more quantities begins anew.
const COLORS: [&str; 8] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#999999"];

/// The columns of a series, by name.
struct Table<'a> {
    /// The name of the energy in `gravity_J` and `work_gravity_J`.
    potential: &'static str,
    names: Vec<&'a str>,
    rows: Vec<Vec<f64>>,
}

impl<'a> Table<'a> {
    /// Parses a series. Empty cells are not a number.
    fn parse(text: &'a str, potential: &'static str) -> Self {
        let mut lines = text.lines();
        let names = lines.next().unwrap_or_default().split(',').collect();
        let rows: Vec<_> = lines.collect();
        let every = rows.len().div_ceil(MOST).max(1);
        let values = |row: &&str| row.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
        Self { potential, names, rows: rows.iter().step_by(every).map(values).collect() }
    }

    /// The curve of a value of each row over time, where it is finite.
    fn curve(&self, value: impl Fn(&[f64]) -> f64) -> Vec<(f64, f64)> {
        let points = self.rows.iter().filter(|row| row.len() == self.names.len()).map(|row| (row[1], value(row)));
        points.filter(|(time, value)| time.is_finite() && value.is_finite()).collect()
    }

    /// Energies, the potential energy from its first value on, except for those that are always zero.
    fn energies(&self) -> Vec<Curve> {
        self.joules(|name| !Self::is_work(name))
    }

    /// Works and the energy that the method adds, except for those that are always zero.
    fn works(&self) -> Vec<Curve> {
        self.joules(Self::is_work)
    }

    fn is_work(name: &str) -> bool {
        name.starts_with("work_") || name == "method_J"
    }

    fn joules(&self, is_wanted: impl Fn(&str) -> bool) -> Vec<Curve> {
        let columns = self.names.iter().enumerate().filter(|(_, name)| name.ends_with("_J") && is_wanted(name));
        let curve = |(place, (column, name)): (usize, (usize, &&str))| {
            let first = if *name == "gravity_J" { self.rows.first().map_or(0.0, |row| row[column]) } else { 0.0 };
            let points = self.curve(|row| row[column] - first);
            let name = match name.trim_end_matches("_J").trim_start_matches("work_") {
                "gravity" => self.potential.to_owned(),
                name => name.replace('_', " "),
            };
            Curve { place, name, is_dashed: false, points }
        };
        columns.enumerate().map(curve).filter(|curve| curve.points.iter().any(|point| point.1 != 0.0)).collect()
    }

    /// Sizes of the forces. Those of colliders are dashed and take the colours from the last one on, so that they keep
    /// their looks where there are more pins.
    fn forces(&self) -> Vec<Curve> {
        let size = |row: &[f64], column: usize| row[column..column + 3].iter().map(|x| x * x).sum::<f64>().sqrt();
        let all = |kind: &str, is_dashed: bool| {
            let names = self.names.iter().enumerate().filter(|(_, name)| name.starts_with(kind));
            let first = names.filter_map(|(column, name)| Some((column, name.strip_suffix("_force_x_N")?)));
            let curve = |(number, (column, name)): (usize, (usize, &str))| Curve {
                place: if is_dashed { COLORS.len() - 1 - number % COLORS.len() } else { number },
                is_dashed,
                name: name.replace('_', " "),
                points: self.curve(|row| size(row, column)),
            };
            first.enumerate().map(curve).collect::<Vec<_>>()
        };
        [all("pin_", false), all("collider_", true)].concat()
    }
}

/// A curve.
#[derive(Clone)]
struct Curve {
    /// Its place among all quantities of its panel, drawn or not. It decides the colour, so that a quantity looks the
    /// same in all runs.
    place: usize,
    is_dashed: bool,
    name: String,
    /// Time, s, and value.
    points: Vec<(f64, f64)>,
}

/// Draws a series as SVG; `None` without two frames.
pub fn draw(path: &Path, scene: &SceneDesc) -> Result<Option<String>, Failure> {
    let failed = |error| Failure::Tool(format!("cannot draw {}: {error}", path.display()));
    let text = limits::read(path, limits::DATA).map_err(failed)?;
    Ok(picture(&String::from_utf8_lossy(&text), &scene.name, potential(scene)))
}

/// The name of the potential energy of a scene.
fn potential(scene: &SceneDesc) -> &'static str {
    let has_loads = scene.cloth.iter().any(|cloth| !cloth.load.is_empty());
    match (scene.largest_gravity() > 0.0, has_loads) {
        (true, true) => "gravity and loads",
        (false, true) => "loads",
        _ => "gravity",
    }
}

fn picture(text: &str, scene: &str, potential: &'static str) -> Option<String> {
    let table = Table::parse(text, potential);
    let panels =
        [("energy, J", table.energies()), ("work, J", table.works()), ("force on the cloth, N", table.forces())];
    let panels = panels.into_iter().filter(|(_, curves)| curves.iter().any(|curve| curve.points.len() > 1));
    let (layouts, plots): (Vec<_>, Vec<_>) = panels.map(|(label, curves)| panel(label, &curves)).unzip();
    if plots.is_empty() {
        return None;
    }
    let figure = Figure::new(plots.len(), 1)
        .with_title(format!("{scene}: energies from the start on, works, and reactions"))
        .with_plots(plots)
        .with_layouts(layouts)
        .with_cell_size(PANEL[0], PANEL[1]);
    Some(SvgBackend.render_scene(&figure.render()))
}

fn panel(label: &str, curves: &[Curve]) -> (Layout, Vec<Plot>) {
    let plot = |Curve { place, is_dashed, name, points }: &Curve| {
        let line = LinePlot::new().with_data(points.clone()).with_color(COLORS[place % COLORS.len()]);
        let line = line.with_stroke_width(1.4).with_legend(name.clone());
        Plot::Line(if *is_dashed { line.with_dashed() } else { line })
    };
    let plots: Vec<_> = curves.iter().map(plot).collect();
    let layout = Layout::auto_from_plots(&plots).with_x_label("simulated time, s").with_y_label(label);
    let ticks = |(low, high): (f64, f64)| TickFormat::Custom(Arc::new(move |value| tick(value, high - low)));
    let (across, up) = (ticks(layout.x_range), ticks(layout.y_range));
    let layout = layout.with_x_tick_format(across).with_y_tick_format(up);
    (layout.with_legend_position(LegendPosition::OutsideRightTop), plots)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_the_columns_that_are_not_zero() {
        let header = "frame,time_s,kinetic_J,bend_J,gravity_J,pin_0_0_force_x_N,pin_0_0_force_y_N,pin_0_0_force_z_N";
        let text =
            format!("{header}\n0,0.0,0.0,0.0,5.0,,,\n1,0.1,1.0,0.0,4.0,3.0,4.0,0.0\n2,0.2,2.0,0.0,3.0,3.0,4.0,0.0\n");
        let svg = picture(&text, "ball", "gravity").unwrap();
        assert!(svg.starts_with("<svg") && !svg.contains("NaN"), "{svg}");
        for (name, drawn) in [(">kinetic<", true), (">bend<", false), (">gravity<", true), (">pin 0 0<", true)] {
            assert_eq!(svg.contains(name), drawn, "{name} in {svg}");
        }
        assert_eq!(Table::parse(&text, "gravity").forces()[0].points, [(0.1, 5.0), (0.2, 5.0)]);
        assert_eq!(picture(&format!("{header}\n"), "ball", "gravity"), None);
    }

    /// Loads have no column of their own.
    #[test]
    fn the_legend_names_gravity_and_loads() {
        let flag = || -> SceneDesc { crate::scene_file::load("flag", &[]).unwrap().desc };
        let load = "select = { edge = \"front\" }\nforce = [0, -1, 0]";
        for (has_gravity, has_loads, name) in
            [(true, false, "gravity"), (false, true, "loads"), (true, true, "gravity and loads")]
        {
            let mut scene = flag();
            scene.gravity = scene.gravity.filter(|_| has_gravity);
            scene.cloth[0].load.extend(has_loads.then(|| toml::from_str(load).unwrap()));
            let text = "frame,time_s,gravity_J,work_gravity_J\n0,0,5,0\n1,0.1,4,1\n";
            let svg = picture(text, "flag", potential(&scene)).unwrap();
            assert_eq!(svg.matches(&format!(">{name}<")).count(), 2, "{svg}");
        }
    }

    /// A resumed run of short frames begins late, and its energies differ by little.
    #[test]
    fn ticks_differ_where_values_are_close() {
        let row = |k: u32| format!("{k},{},{}", 9.81 + 1e-4 * f64::from(k), -(1.0 + 1e-5 * f64::from(k)));
        let text = format!("frame,time_s,kinetic_J\n{}\n", [0, 1, 2, 3, 4].map(row).join("\n"));
        let svg = picture(&text, "ball", "gravity").unwrap();
        let labels: Vec<_> = svg.split("</text>").filter_map(|text| text.rsplit('>').next()).collect();
        let numbers: Vec<_> = labels.into_iter().filter(|label| label.parse::<f64>().is_ok()).collect();
        let distinct: std::collections::BTreeSet<_> = numbers.iter().collect();
        assert!(numbers.len() > 8 && distinct.len() == numbers.len(), "{numbers:?}");
    }

    /// No panel shows a colour twice, unless it has more than eight forces.
    #[test]
    fn the_curves_of_a_panel_differ_in_colour() {
        let energies = "kinetic_J,stretch_J,shear_J,bend_J,seam_J,gravity_J";
        let works = "work_pins_J,work_colliders_J,work_wind_J,work_gravity_J,work_separation_J,work_contacts_J,\
                     work_damping_J,method_J";
        let forces = "pin_0_0_force_x_N,y,z,pin_0_1_force_x_N,y,z,collider_0_force_x_N,y,z,collider_1_force_x_N,y,z";
        let header = format!("frame,time_s,{energies},{works},{forces}");
        let row = |value: &str| vec![value; header.split(',').count()].join(",");
        let text = format!("{header}\n{}\n{}\n", row("1"), row("2"));
        let table = Table::parse(&text, "gravity");
        for (curves, count) in [(table.energies(), 6), (table.works(), 8), (table.forces(), 4)] {
            let colors: std::collections::BTreeSet<_> = curves.iter().map(|c| COLORS[c.place % COLORS.len()]).collect();
            assert_eq!((curves.len(), colors.len()), (count, count));
        }
    }

    /// The looks of a quantity do not depend on which others a run has.
    #[test]
    fn a_quantity_has_its_own_colour() {
        let places = |text: &str| {
            let table = Table::parse(text, "gravity");
            let all = [table.energies(), table.works(), table.forces()].concat();
            all.into_iter().map(|curve| (curve.name, curve.place)).collect::<Vec<_>>()
        };
        let header = "frame,time_s,kinetic_J,bend_J,gravity_J";
        let own = |curves: &[(&str, usize)]| curves.iter().map(|&(name, k)| (name.to_owned(), k)).collect::<Vec<_>>();
        assert_eq!(places(&format!("{header}\n0,0,0,0,5\n1,0.1,1,0,4\n")), own(&[("kinetic", 0), ("gravity", 2)]));
        let forces = "pin_0_0_force_x_N,y,z,collider_0_force_x_N,y,z";
        let bent = format!("{header},{forces}\n0,0,0,0,5,,,,,,\n1,0.1,0,1,4,3,4,0,1,0,0\n");
        assert_eq!(places(&bent), own(&[("bend", 1), ("gravity", 2), ("pin 0 0", 0), ("collider 0", 7)]));
    }
}
