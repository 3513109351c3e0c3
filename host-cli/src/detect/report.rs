//! The report that `muslin detect` prints.

use serde::Serialize;

use super::mesh::Subject;
use super::stages::Touch;
use crate::args::{DetectArguments, Method};
use crate::device::StageTime;

/// The documented keys, and a few more. A value that was not requested is null.
#[derive(Serialize)]
pub struct Report {
    pub edge_edge: Pairs,
    pub vertex_triangle: Pairs,
    /// Number of crossings.
    pub intersections: Option<usize>,
    /// Time of the first impact as a fraction of the motion, 0..1.
    pub first_impact: Option<f32>,
    pub ms: StageMs,
    pub backend: &'static str,
    pub adapter: Option<String>,
    pub mesh: String,
    pub next: Option<String>,
    pub method: &'static str,
    pub thickness_m: f32,
    pub threads: usize,
    pub vertices: usize,
    /// Vertices that belong to no triangle.
    pub loose_vertices: usize,
    pub triangles: usize,
    pub edges: usize,
}

/// Numbers of pairs of one kind.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Pairs {
    pub candidates: usize,
    pub contacts: Option<usize>,
    /// Pairs that collide during the motion.
    pub ccd: Option<usize>,
}

impl Pairs {
    /// Pairs with only the number of candidates known.
    pub fn of(candidates: usize) -> Self {
        Self { candidates, contacts: None, ccd: None }
    }

    fn add(self, other: Self) -> Self {
        let sum = |a: Option<usize>, b: Option<usize>| Some(a? + b?);
        Self {
            candidates: self.candidates + other.candidates,
            contacts: sum(self.contacts, other.contacts),
            ccd: sum(self.ccd, other.ccd),
        }
    }
}

/// Time of each stage, ms.
#[derive(Clone, Debug, Default, Serialize)]
pub struct StageMs {
    pub candidates: Option<f64>,
    pub contacts: Option<f64>,
    pub ccd: Option<f64>,
    pub intersections: Option<f64>,
    /// The whole detection on the graphics processor, with transfers.
    pub gpu: Option<f64>,
    /// Time of each stage on the graphics processor, by its own clock.
    pub gpu_stages: Option<Vec<StageTime>>,
}

impl Report {
    /// A report on a mesh, without any counts.
    pub fn new(arguments: &DetectArguments, subject: &Subject, threads: usize) -> Self {
        Self {
            edge_edge: Pairs::of(0),
            vertex_triangle: Pairs::of(0),
            intersections: None,
            first_impact: None,
            ms: StageMs::default(),
            backend: arguments.backend.name(),
            adapter: None,
            mesh: arguments.mesh.display().to_string(),
            next: arguments.next.as_ref().map(|path| path.display().to_string()),
            method: match arguments.method {
                Method::Grid => "grid",
                Method::Reference => "reference",
                Method::Brute => "brute",
            },
            thickness_m: arguments.thickness,
            threads,
            vertices: subject.positions.len(),
            loose_vertices: subject.loose_vertices,
            triangles: subject.surface.triangles.len(),
            edges: subject.surface.edges.len(),
        }
    }

    /// Adds the impacts during the motion.
    pub fn add_touch(&mut self, touch: &Touch) {
        self.vertex_triangle.ccd = Some(touch.vertex_triangle);
        self.edge_edge.ccd = Some(touch.edge_edge);
        self.first_impact = touch.first;
    }

    /// The report as a table for a person.
    pub fn table(&self) -> String {
        let all = self.edge_edge.add(self.vertex_triangle);
        let next = self.next.as_ref().map(|next| format!(" -> {next}")).unwrap_or_default();
        let mut text = format!(
            "{}{next}: {} vertices, {} triangles, {} edges\nthickness {} m, method {}, {}\n\n\
             {:16}{:>16}{:>14}{:>12}\n",
            self.mesh,
            self.vertices,
            self.triangles,
            self.edges,
            self.thickness_m,
            self.method,
            self.adapter.clone().unwrap_or_else(|| format!("{} thread(s)", self.threads)),
            "pairs",
            "candidates",
            "contacts",
            "ccd"
        );
        for (name, pairs) in [("edge-edge", self.edge_edge), ("vertex-triangle", self.vertex_triangle), ("all", all)] {
            let Pairs { candidates, contacts, ccd } = pairs;
            text += &format!("{name:16}{:>16}{:>14}{:>12}\n", grouped(candidates), or_dash(contacts), or_dash(ccd));
        }
        text += &format!("\n{:16}{:>16}{:>14}\n", "stage", "ms", "candidates/s");
        let StageMs { candidates, contacts, ccd, gpu, .. } = self.ms;
        let stages = [("candidates", candidates), ("contacts", contacts), ("ccd", ccd), ("all on the GPU", gpu)];
        for (name, ms) in stages.into_iter().filter_map(|(name, ms)| Some((name, ms?))) {
            text += &format!("{name:16}{ms:>16.2}{:>14.3e}\n", all.candidates as f64 / (1e-3 * ms));
        }
        for StageTime { stage, ms } in self.ms.gpu_stages.iter().flatten() {
            text += &format!("  {stage:24}{ms:>6.2}\n");
        }
        if let Some(ms) = self.ms.intersections {
            text += &format!("{:16}{ms:>16.2}\n", "intersections");
        }
        text += "\n";
        match (all.candidates, all.contacts) {
            (candidates, Some(contacts @ 1..)) => {
                text += &format!("candidates : contacts = {:.1}\n", candidates as f64 / contacts as f64);
            }
            (_, Some(0)) => text += "no contacts\n",
            _ => {}
        }
        if all.ccd.is_some() {
            text += &match self.first_impact {
                Some(time) => format!("first impact at {time:.6} of the motion\n"),
                None => "no impact during the motion\n".into(),
            };
        }
        if let Some(count) = self.intersections {
            text += &format!("{} intersections\n", grouped(count));
        }
        text.trim_end().into()
    }
}

fn or_dash(count: Option<usize>) -> String {
    count.map_or("-".into(), grouped)
}

/// A number with commas between thousands.
fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let groups: Vec<_> = digits.as_bytes().rchunks(3).rev().map(String::from_utf8_lossy).collect();
    groups.join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousands_are_grouped() {
        assert_eq!([0, 999, 1000, 5_197_332].map(grouped), ["0", "999", "1,000", "5,197,332"]);
    }
}
