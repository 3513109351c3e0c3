//! One page with all that was studied of a scene.

use std::fs;
use std::path::Path;

/// Its file.
pub const NAME: &str = "study.html";

/// The studies in the order in which they are asked: title, and the stem of their files.
const STUDIES: [(&str, &str); 4] = [
    ("Error against cost", "chart"),
    ("Where methods fail", "stability"),
    ("What each term is worth", "needs"),
    ("What to choose", "choose"),
];

const STYLE: &str =
    "body { font: 16px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem }
svg { max-width: 100%; height: auto } pre { overflow-x: auto }";

/// The page of the studies whose files lie in a folder.
pub fn of(folder: &Path, scene: &str) -> String {
    let sections = STUDIES.iter().filter_map(|(title, stem)| {
        let svg = fs::read_to_string(folder.join(format!("{stem}.svg"))).ok()?;
        let words = fs::read_to_string(folder.join(format!("{stem}.txt"))).ok()?;
        let svg = named_apart(&svg, stem);
        Some(format!("<h2>{title}</h2>\n{svg}\n<pre>{}</pre>\n", escape(&words)))
    });
    let sections: String = sections.collect();
    let scene = escape(scene);
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n<title>{scene}</title>\n\
         <style>{STYLE}</style>\n<h1>{scene}</h1>\n{sections}</html>"
    )
}

/// Gives the names inside a picture a prefix: in a page they must differ from picture to picture.
fn named_apart(svg: &str, stem: &str) -> String {
    svg.replace(" id=\"", &format!(" id=\"{stem}-")).replace("url(#", &format!("url(#{stem}-"))
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
