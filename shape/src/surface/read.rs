//! Surfaces from STL and OBJ files.

use std::borrow::Cow;
use std::io::Cursor;

use super::{Surface, SurfaceError, fault};

/// Begin of a text STL file. The reader takes the word alone for a binary file, and all binary
/// files that begin with it for text.
const SOLID: &[u8] = b"solid";

impl Surface {
    /// Reads a surface from the bytes of an STL file, binary or text, of which a unit is `unit_m`
    /// metres.
    ///
    /// # Errors
    /// A [`SurfaceError`] that says what is wrong with the file or the surface.
    pub fn from_stl(bytes: &[u8], unit_m: f64) -> Result<Self, SurfaceError> {
        let unreadable = |error: std::io::Error| SurfaceError::Text(fault::of_stl(bytes, &error.to_string()));
        let mut cursor = Cursor::new(with_clear_begin(bytes));
        let mut reader = stl_io::create_stl_reader(&mut cursor).map_err(unreadable)?;
        let mesh = reader.as_indexed_triangles().map_err(unreadable)?;
        let points: Vec<_> = mesh.vertices.iter().map(|vertex| vertex.0.map(|part| f64::from(part) * unit_m)).collect();
        let triangles: Vec<_> = mesh.faces.iter().map(|face| face.vertices).collect();
        Self::new(&points, &triangles)
    }

    /// Reads a surface from the text of an OBJ file, of which a unit is `unit_m` metres; polygons
    /// are parted into triangles.
    ///
    /// # Errors
    /// A [`SurfaceError`] that says what is wrong with the file or the surface.
    pub fn from_obj(text: &[u8], unit_m: f64) -> Result<Self, SurfaceError> {
        let options = tobj::LoadOptions { triangulate: true, ignore_lines: true, ..tobj::LoadOptions::default() };
        let no_material = |_: &std::path::Path| Ok((Vec::new(), Default::default()));
        let (models, _) = tobj::load_obj_buf(&mut Cursor::new(text), &options, no_material)
            .map_err(|error| SurfaceError::Text(fault::of_obj(text, &error.to_string())))?;
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for model in models {
            let first = points.len();
            let (places, _) = model.mesh.positions.as_chunks::<3>();
            points.extend(places.iter().map(|place| place.map(|part| part * unit_m)));
            let (faces, _) = model.mesh.indices.as_chunks::<3>();
            triangles.extend(faces.iter().map(|face| face.map(|vertex| first + vertex as usize)));
        }
        Self::new(&points, &triangles)
    }
}

/// Changes the begin of an STL file, where its reader would take text for a binary file or the
/// other way round.
fn with_clear_begin(bytes: &[u8]) -> Cow<'_, [u8]> {
    let Some(rest) = bytes.strip_prefix(SOLID) else { return bytes.into() };
    if fault::announced(bytes).is_some_and(|(_, size)| size == bytes.len()) {
        return [b"     ", rest].concat().into();
    }
    match rest.first() {
        Some(b'\n' | b'\r') => [SOLID, b" ", rest].concat().into(),
        _ => bytes.into(),
    }
}
