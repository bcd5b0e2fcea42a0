//! Places of faults in STL and OBJ files, which the readers do not name.

use kit::counting::counted;

/// Size of a binary STL file's header with its count of triangles, and of a triangle, bytes.
const HEADER: usize = 84;
const TRIANGLE: usize = 50;
/// Lines of a triangle in a text STL file.
const LINES: [&str; 7] = ["facet normal", "outer loop", "vertex", "vertex", "vertex", "endloop", "endfacet"];
/// Number of characters of a line that are told.
const TOLD: usize = 40;

/// Count of triangles in the header of a binary STL file, and the size of a file with as many.
pub(super) fn announced(bytes: &[u8]) -> Option<(u32, usize)> {
    let count = u32::from_le_bytes(bytes.get(HEADER - 4..HEADER)?.try_into().ok()?);
    Some((count, (count as usize).saturating_mul(TRIANGLE).saturating_add(HEADER)))
}

/// Finds the first fault of an STL file; `reason` is what its reader said.
pub(super) fn of_stl(bytes: &[u8], reason: &str) -> String {
    if bytes.starts_with(b"solid") {
        let found = of_text(&String::from_utf8_lossy(bytes));
        return found.unwrap_or_else(|| format!("{reason} in a text STL file")) + "; export it again, as binary STL";
    }
    let length = bytes.len();
    let fault = match announced(bytes) {
        None if length == 0 => "the file is empty".to_owned(),
        Some((count, size)) if size > length => format!(
            "a binary STL file of {count} triangles, as bytes 81 to 84 tell, has {size} bytes, and this one {length}: it is cut off, or no STL file"
        ),
        Some(_) => reason.to_owned(),
        None => {
            format!("with {length} bytes it is neither a binary STL file nor a text one, which begins with \"solid\"")
        }
    };
    fault + "; export the body again as STL"
}

/// Finds the first fault of a text STL file.
fn of_text(text: &str) -> Option<String> {
    let mut expected = 0;
    let mut triangles = 0;
    let lines = text.lines().enumerate().skip(1);
    for (number, line) in lines.map(|(number, line)| (number + 1, line.trim())).filter(|(_, line)| !line.is_empty()) {
        if expected == 0 && line.starts_with("endsolid") {
            return None;
        }
        let wanted = LINES[expected];
        let words: Vec<&str> = line.split_whitespace().collect();
        let begin: Vec<&str> = wanted.split(' ').collect();
        let numbers = words.get(begin.len()..).unwrap_or_default();
        let count = if matches!(wanted, "vertex" | "facet normal") { 3 } else { 0 };
        if !words.starts_with(&begin) {
            return Some(format!("line {number} has {} where triangle {} has \"{wanted}\"", told(line), triangles + 1));
        }
        if numbers.len() != count || !numbers.iter().all(|word| word.parse::<f32>().is_ok_and(f32::is_finite)) {
            return Some(format!("line {number} has {}, and \"{wanted}\" has {count} numbers", told(line)));
        }
        expected = (expected + 1) % LINES.len();
        triangles += usize::from(expected == 0);
    }
    Some(format!("the file ends after {} without \"endsolid\": it is cut off", counted(triangles, "triangles")))
}

/// Finds the first fault of an OBJ file; `reason` is what its reader said.
pub(super) fn of_obj(text: &[u8], reason: &str) -> String {
    let text = String::from_utf8_lossy(text);
    let begins = |line: &str, with: &str| line.split_whitespace().next() == Some(with);
    let vertices = text.lines().filter(|line| begins(line, "v")).count();
    let advice = "; export the body again as OBJ";
    for (number, line) in text.lines().enumerate().map(|(number, line)| (number + 1, line.trim())) {
        let words: Vec<&str> = line.split_whitespace().skip(1).collect();
        let numbers = || words.iter().take_while(|word| word.parse::<f64>().is_ok()).count();
        if begins(line, "v") && numbers() < 3 {
            return format!("line {number} has {}, and a vertex has three numbers{advice}", told(line));
        }
        if (begins(line, "vn") || begins(line, "vt")) && numbers() < words.len() {
            return format!("line {number} has {}, which are no numbers{advice}", told(line));
        }
        if begins(line, "f") {
            let vertex = |word: &&str| word.split('/').next().unwrap_or_default().parse::<i64>();
            let is_there = |index: i64| index != 0 && index.unsigned_abs() <= vertices as u64;
            if let Some(word) = words.iter().find(|word| !vertex(word).is_ok_and(is_there)) {
                return format!(
                    "line {number} has {}, and {} is no vertex of the file, which has {vertices}{advice}",
                    told(line),
                    told(word)
                );
            }
            if words.len() < 3 {
                return format!("line {number} has {}, and a face has at least three vertices{advice}", told(line));
            }
        }
    }
    format!("{reason}{advice}, without materials and textures")
}

/// Text of the file in quotes, without its end if it is long.
fn told(text: &str) -> String {
    let begin: String = text.chars().take(TOLD).map(|letter| if letter.is_control() { '?' } else { letter }).collect();
    if begin.len() < text.len() { format!("\"{begin}...\"") } else { format!("\"{begin}\"") }
}
