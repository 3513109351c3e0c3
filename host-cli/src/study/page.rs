//! One HTML page with the results of all studies of a scene.

use std::path::Path;

use crate::limits;

/// Name of the file.
pub const NAME: &str = "study.html";

/// Title and file stem of each study, in the order of the page.
const STUDIES: [(&str, &str); 4] = [
    ("Error against cost", "chart"),
    ("Where methods fail", "stability"),
    ("Effect and cost of each term", "needs"),
    ("What to choose", "choose"),
];

const STYLE: &str =
    "body { font: 16px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem }
svg { max-width: 100%; height: auto } pre { overflow-x: auto }";

/// The page of all studies whose files are in a folder.
pub fn of(folder: &Path, scene: &str) -> String {
    let sections = STUDIES.iter().filter_map(|(title, stem)| {
        let svg = read(&folder.join(format!("{stem}.svg")))?;
        let words = read(&folder.join(format!("{stem}.txt")))?;
        let svg = named_apart(&scalable(&svg), stem);
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

/// Reads a file that a study wrote.
fn read(path: &Path) -> Option<String> {
    String::from_utf8(limits::read(path, limits::DATA).ok()?).ok()
}

/// Gives a picture a `viewBox`. Without one, a page that is narrower than the picture cuts it off.
fn scalable(svg: &str) -> String {
    let side = |name: &str| Some(svg.split_once(name)?.1.split_once('"')?.0);
    match (side(" width=\""), side(" height=\"")) {
        (Some(width), Some(height)) => svg.replacen("<svg ", &format!("<svg viewBox=\"0 0 {width} {height}\" "), 1),
        _ => svg.to_owned(),
    }
}

/// Adds a prefix to the ids inside a picture: on a page with several pictures ids must be unique.
fn named_apart(svg: &str, stem: &str) -> String {
    svg.replace(" id=\"", &format!(" id=\"{stem}-")).replace("url(#", &format!("url(#{stem}-"))
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_shrinks_with_the_page() {
        let svg =
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"852.25\" height=\"460\"><rect width=\"100%\"/></svg>";
        assert!(scalable(svg).starts_with("<svg viewBox=\"0 0 852.25 460\" xmlns="), "{}", scalable(svg));
    }
}
