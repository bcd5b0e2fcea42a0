//! STL and OBJ files that cannot be read: the message says where the fault is and what to do.

use std::fmt::Write;

use shape::surface::{Surface, SurfaceError};

use crate::surfaces::cuboid;

fn text_stl() -> String {
    let (points, triangles) = cuboid([0.1, 0.05, 0.02]);
    let mut text = "solid box\n".to_owned();
    for triangle in triangles {
        text += "facet normal 0 0 0\n outer loop\n";
        triangle.map(|vertex| points[vertex]).iter().for_each(|[x, y, z]| {
            writeln!(text, "  vertex {x} {y} {z}").unwrap();
        });
        text += " endloop\nendfacet\n";
    }
    text + "endsolid box\n"
}

fn binary_stl(header: &[u8]) -> Vec<u8> {
    let (points, triangles) = cuboid([0.1, 0.05, 0.02]);
    let mut bytes = header.to_vec();
    bytes.resize(80, b' ');
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        let corners = triangle.iter().flat_map(|vertex| points[*vertex]);
        let numbers = [0.0; 3].into_iter().chain(corners);
        bytes.extend(numbers.flat_map(|number| (number as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

fn stl(bytes: &[u8]) -> String {
    Surface::from_stl(bytes, 1.0).unwrap_err().to_string()
}

fn obj(text: &str) -> String {
    Surface::from_obj(text.as_bytes(), 1.0).unwrap_err().to_string()
}

#[test]
fn stl_files_of_any_begin_are_read() {
    let text = text_stl();
    for bytes in [
        text.clone().into_bytes(),
        text.replace("solid box", "solid").into_bytes(),
        text.replace("solid box", "solid").replace('\n', "\r\n").into_bytes(),
        binary_stl(b"a box"),
        binary_stl(b"solid box of a program that writes so"),
    ] {
        let surface = Surface::from_stl(&bytes, 1.0).unwrap();
        assert!((surface.volume_m3() - 1e-4).abs() < 1e-10);
    }
}

#[test]
fn stl_files_that_cannot_be_read_say_where_and_what_to_do() {
    let text = text_stl();
    let word = text.replacen("vertex 0 0 0", "vertex abc 0 0", 1);
    let (binary, cut) = (binary_stl(b"a box"), &text[..text.len() / 2]);
    for (message, where_, fault) in [
        (stl(word.as_bytes()), "line 4", "\"vertex abc 0 0\""),
        (stl(text.replacen(" endloop\n", "", 2).as_bytes()), "line 7", "triangle 1 has \"endloop\""),
        (stl(cut.as_bytes()), "line 44", "triangle 7 has \"facet normal\""),
        (stl(text.replace("endsolid box\n", "").as_bytes()), "after 12 triangles", "cut off"),
        (stl(&binary[..300]), "12 triangles", "has 684 bytes, and this one 300"),
        (stl(b""), "the file is empty", "export"),
        (stl(b"no surface"), "10 bytes", "neither a binary STL file nor a text one"),
    ] {
        assert!(message.contains(where_) && message.contains(fault), "{message}");
        assert!(message.contains("export"), "{message}");
    }
}

#[test]
fn obj_files_that_cannot_be_read_say_where_and_what_to_do() {
    for (text, line, fault) in [
        ("# box\nv a b c\nf 1 2 3\n", "line 2", "a vertex has three numbers"),
        ("v 0 0 0\nv 1 0\nv 0 1 0\nf 1 2 3\n", "line 2", "\"v 1 0\""),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 4\n", "line 5", "\"4\" is no vertex of the file, which has 3"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 x\n", "line 4", "\"x\" is no vertex of"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "line 4", "\"0\" is no vertex of"),
    ] {
        let message = obj(text);
        assert!(message.contains(line) && message.contains(fault) && message.contains("export"), "{text}{message}");
    }
    for text in ["", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 1 2\n"] {
        let error = Surface::from_obj(text.as_bytes(), 1.0).unwrap_err();
        assert_eq!(error, SurfaceError::Empty, "{text}");
        assert!(error.to_string().contains("export the body as triangles"), "{error}");
    }
}
