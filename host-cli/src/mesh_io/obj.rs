//! Wavefront OBJ (paulbourke.net/dataformats/obj): `v`, `vt` and `f`, and the statement `stitch a b c w` of sewing
//! patterns, whose indices count from 0: vertex a is sewn to (1 - w) b + w c. All other statements are ignored.

use std::borrow::Cow;
use std::str::{FromStr, SplitAsciiWhitespace};

use muslin_core::mesh::{Stitch, TriMesh};

use super::polygon;

/// An error in an OBJ file.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum ObjError {
    /// A statement is invalid.
    #[error("line {line}: {problem}")]
    Line {
        /// Counted from 1.
        line: usize,
        /// The problem in it.
        problem: Problem,
    },
    /// The file has statements, but no mesh.
    #[error("it has no line `v x y z` and no line `f a b c`; it is not a Wavefront OBJ file, or it has no mesh")]
    NoMesh,
}

/// A problem in a line.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    #[error("a number is missing; `{0}` needs more")]
    Missing(&'static str),
    #[error("`{0}` is not a number that can stand here")]
    Number(String),
    #[error("the face names {what} `{index}`, but the lines above define {count} (the first is 1)")]
    OutOfRange { what: &'static str, index: i64, count: usize },
    #[error("the face has {0} corners; it needs three or more")]
    FewCorners(usize),
}

/// Reads the text of an OBJ file. Texture coordinates are kept only if every face has them.
pub fn parse(text: &str) -> Result<TriMesh, ObjError> {
    let mut mesh = TriMesh::default();
    let mut others = false;
    for (line, statement) in statements(text) {
        others |= !add(&mut mesh, &statement).map_err(|problem| ObjError::Line { line, problem })?;
    }
    if others && mesh == TriMesh::default() {
        return Err(ObjError::NoMesh);
    }
    if !mesh.has_uvs() {
        mesh.uvs.clear();
        mesh.uv_triangles.clear();
    }
    Ok(mesh)
}

/// The statements, each with the number of its first line. Comments are removed and continued lines are joined.
fn statements(text: &str) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    // On the first Macs lines ended with \r alone; `str::lines` would not split them.
    let ends: &[char] = if text.contains('\n') { &['\n'] } else { &['\r'] };
    let mut lines = text.split(ends).map(|line| line.split('#').next().unwrap_or("").trim_end()).zip(1..);
    std::iter::from_fn(move || {
        let (first, number) = lines.next()?;
        let mut statement = Cow::Borrowed(first);
        while let Some(begun) = statement.strip_suffix('\\') {
            let rest = lines.next().map_or("", |(line, _)| line);
            statement = Cow::Owned(format!("{begun} {rest}"));
        }
        Some((number, statement))
    })
}

/// Adds a statement to the mesh; returns whether it was known or empty.
fn add(mesh: &mut TriMesh, statement: &str) -> Result<bool, Problem> {
    let mut words = statement.split_ascii_whitespace();
    match words.next() {
        Some("v") => mesh.positions.push(vertex(&mut words)?),
        Some("vt") => mesh.uvs.push(texture(&mut words)?),
        Some("f") => face(mesh, words)?,
        Some("stitch") => mesh.stitches.push(stitch(&mut words)?),
        None => {}
        Some(_) => return Ok(false),
    }
    Ok(true)
}

fn vertex(words: &mut SplitAsciiWhitespace) -> Result<[f64; 3], Problem> {
    let mut coordinate = || next(words, "v x y z");
    Ok([coordinate()?, coordinate()?, coordinate()?])
}

fn texture(words: &mut SplitAsciiWhitespace) -> Result<[f64; 2], Problem> {
    Ok([next(words, "vt u v")?, words.next().map_or(Ok(0.0), number)?])
}

fn stitch(words: &mut SplitAsciiWhitespace) -> Result<Stitch, Problem> {
    const FORM: &str = "stitch a b c w";
    Ok(Stitch { a: next(words, FORM)?, edge: [next(words, FORM)?, next(words, FORM)?], weight: next(words, FORM)? })
}

fn next<T: FromStr>(words: &mut SplitAsciiWhitespace, form: &'static str) -> Result<T, Problem> {
    number(words.next().ok_or(Problem::Missing(form))?)
}

fn number<T: FromStr>(word: &str) -> Result<T, Problem> {
    word.parse().map_err(|_| Problem::Number(word.into()))
}

fn face(mesh: &mut TriMesh, words: SplitAsciiWhitespace) -> Result<(), Problem> {
    let (mut corners, mut textures) = (Vec::new(), Vec::new());
    for word in words {
        let mut parts = word.split('/');
        corners.push(index(parts.next().unwrap_or(""), mesh.positions.len(), "vertex")?);
        if let Some(part) = parts.next().filter(|part| !part.is_empty()) {
            textures.push(index(part, mesh.uvs.len(), "texture coordinate")?);
        }
    }
    if corners.len() < 3 {
        return Err(Problem::FewCorners(corners.len()));
    }
    for triangle in polygon::triangles(&corners, &mesh.positions) {
        mesh.triangles.push(triangle.map(|k| corners[k]));
        if textures.len() == corners.len() {
            mesh.uv_triangles.push(triangle.map(|k| textures[k]));
        }
    }
    Ok(())
}

/// Array index for an OBJ index, which counts from 1 or, if negative, back from the last of `count` items.
fn index(word: &str, count: usize, what: &'static str) -> Result<u32, Problem> {
    let index: i64 = number(word)?;
    let place = if index < 0 { index.checked_add(count as i64) } else { index.checked_sub(1) };
    place
        .filter(|place| (0..count as i64).contains(place))
        .and_then(|place| u32::try_from(place).ok())
        .ok_or(Problem::OutOfRange { what, index, count })
}

#[cfg(test)]
mod tests {
    use super::*;

    const QUAD: &str = "# a quad\r\nmtllib a.mtl\no quad\nv -1 0 0 1.0 # w\nv 0 -5.0e-001 0\nv 1 0 0\nv 0 5.0e-001 0
vt 0 0\nvt 1 0 0\nvt 1\nvt 0 1\nvn 0 0 1\ns off\nf 1/1/1 2/2/1 \\\n 3/3/1 -1/-1/1\nstitch 0 1 2 2.5e-001\n";

    fn message(text: &str) -> String {
        parse(text).unwrap_err().to_string()
    }

    #[test]
    fn every_line_end_is_one() {
        let text = "v 0 0 0\nv 1 0 0\n\nv 0 1 0\nf 1 2 3\n";
        let whole = parse(text).expect("it is one triangle");
        assert_eq!(whole.triangles, [[0, 1, 2]]);
        for end in ["\r\n", "\r"] {
            assert_eq!(parse(&text.replace('\n', end)), Ok(whole.clone()), "{end:?}");
        }
    }

    #[test]
    fn reads_all_statements() {
        let mesh = parse(QUAD).unwrap();
        assert_eq!(mesh.positions, [[-1.0, 0.0, 0.0], [0.0, -0.5, 0.0], [1.0, 0.0, 0.0], [0.0, 0.5, 0.0]]);
        assert_eq!(mesh.triangles, [[1, 2, 3], [1, 3, 0]]);
        assert_eq!(mesh.uv_triangles, mesh.triangles);
        assert_eq!(mesh.uvs, [[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
        assert_eq!(mesh.stitches, [Stitch { a: 0, edge: [1, 2], weight: 0.25 }]);
    }

    #[test]
    fn drops_textures_that_some_face_lacks() {
        let mesh = parse("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\nf 1//1 2//1 3//1\nf 1/1 2/1 3\n").unwrap();
        assert_eq!(mesh.triangles.len(), 3);
        assert!(mesh.uvs.is_empty() && mesh.uv_triangles.is_empty());
    }

    #[test]
    fn reads_what_the_check_will_refuse() {
        assert!(parse("v nan 0 inf").unwrap().positions[0][0].is_nan());
        assert_eq!(parse("").unwrap(), TriMesh::default());
    }

    #[test]
    fn says_what_is_wrong_and_where() {
        assert_eq!(message("v 0 0 0\nv 1 2"), "line 2: a number is missing; `v x y z` needs more");
        assert_eq!(message("v 0 0x 0"), "line 1: `0x` is not a number that can stand here");
        assert!(
            message("v 0 0 0\n\nf 1 2 3").contains("line 3: the face names vertex `2`, but the lines above define 1")
        );
        assert!(message("v 0 0 0\nf 0 1 1").contains("vertex `0`"));
        assert!(message("v 0 0 0\nf -2 1 1").contains("vertex `-2`"));
        assert!(message("v 0 0 0\nf -9223372036854775808 1 1").contains("vertex `-9223372036854775808`"));
        assert!(message("v 0 0 0\nf 1/1 1/1 1/1").contains("texture coordinate `1`"));
        assert!(message("v 0 0 0\nf 1 1").contains("line 2: the face has 2 corners"));
        assert!(message("f / / /").contains("line 1"));
        assert!(message("# \\\nstitch 0 -1 2 0").contains("line 2: `-1`"));
        assert!(message("v 0 \\\n 0 0\nv \\").contains("line 3"));
    }

    #[test]
    fn survives_damage() {
        for place in 0..QUAD.len() {
            let _ = parse(&QUAD[..place]);
            for byte in [0, b'\n', b' ', b'-', b'/', b'9', b'\\', 0xff] {
                let mut damaged = QUAD.as_bytes().to_vec();
                damaged[place] = byte;
                let _ = parse(&String::from_utf8_lossy(&damaged));
            }
        }
    }
}
