//! Lines for the user on the stages of a kit that a board leaves out.

use dsp_core::engine::{LoadError, Stage};
use dsp_core::table::Kit;
use virtual_board::Board;

/// Lines that say which stages of a kit a board leaves out and why, or why it refuses the kit; and
/// whether the kit is too long to be sent to it.
pub(super) fn left_out(kit: &str, board: Board, table: &Kit<'_>) -> Vec<String> {
    let name = board.name();
    let mut lines = match malleus::render::board::plan(board, table) {
        Ok(plan) => {
            plan.left_out.iter().map(|reason| format!("{kit}: {name} leaves out: {}", text(reason, table))).collect()
        }
        Err(error) => vec![format!("{kit}: {name} refuses it and plays its built-in kit: {error}")],
    };
    let bytes = table.len_bytes();
    if bytes > boards::SLOT_BYTES {
        lines.push(format!(
            "{kit}: {name} has no room for it: the kit is {bytes} bytes long, and a slot has {}; give it fewer or shorter surfaces, or fewer modes",
            boards::SLOT_BYTES
        ));
    }
    lines
}

fn text(reason: &LoadError, table: &Kit<'_>) -> String {
    match reason {
        LoadError::NotBuilt { stage: Stage::Scrapes } => format!(
            "surfaces, {} of them: boards play strikes, malleus play --motion scrapes and rolls",
            table.surfaces().count()
        ),
        _ => reason.to_string(),
    }
}
