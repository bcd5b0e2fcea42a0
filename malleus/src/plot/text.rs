//! Text in the font that the program carries (Noto Sans, SIL Open Font License), so that a picture needs nothing of the machine.

use ab_glyph::{Font, FontRef, GlyphId, PxScale, point};

use super::colour::Colour;

/// Height of a capital letter as a share of the text size; half of it centres a line of text on a height.
pub(super) const CAPITAL_HEIGHT: f32 = 0.714;

/// The weight of the strokes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Weight {
    /// For labels.
    Regular,
    /// For titles.
    Bold,
}

/// Which point of the text stands at the given place, along the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    /// Its beginning.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// How a text looks.
#[derive(Clone, Copy, Debug)]
pub(super) struct TextStyle {
    /// Em size, pixels.
    pub(super) size_px: f32,
    /// Weight of the strokes.
    pub(super) weight: Weight,
    /// Colour of the strokes.
    pub(super) colour: Colour,
}

impl TextStyle {
    /// A text of regular weight.
    pub(super) const fn regular(size_px: f32, colour: Colour) -> Self {
        Self { size_px, weight: Weight::Regular, colour }
    }

    /// A text of bold weight.
    pub(super) const fn bold(size_px: f32, colour: Colour) -> Self {
        Self { size_px, weight: Weight::Bold, colour }
    }
}

/// The two weights of the font.
pub(super) struct Typeface {
    regular: FontRef<'static>,
    bold: FontRef<'static>,
}

impl Typeface {
    /// The font that the program carries; nothing if its bytes are damaged.
    pub(super) fn built_in() -> Option<Self> {
        Some(Self {
            regular: FontRef::try_from_slice(notosans::REGULAR_TTF).ok()?,
            bold: FontRef::try_from_slice(notosans::BOLD_TTF).ok()?,
        })
    }

    fn font(&self, weight: Weight) -> &FontRef<'static> {
        match weight {
            Weight::Regular => &self.regular,
            Weight::Bold => &self.bold,
        }
    }

    /// Length of `text`, pixels.
    pub(super) fn length_px(&self, text: &str, style: TextStyle) -> f32 {
        let font = self.font(style.weight);
        let (places, end) = places(font, text, style.size_px);
        if places.is_empty() { 0.0 } else { end }
    }

    /// `text` if it is no longer than `room_px`, else as much of its beginning as fits before an ellipsis.
    pub(super) fn shortened(&self, text: &str, style: TextStyle, room_px: f32) -> String {
        if self.length_px(text, style) <= room_px {
            return text.to_owned();
        }
        let mut kept: Vec<char> = text.chars().collect();
        while kept.pop().is_some() {
            let shorter = format!("{}…", kept.iter().collect::<String>().trim_end());
            if self.length_px(&shorter, style) <= room_px {
                return shorter;
            }
        }
        String::new()
    }

    /// Calls `cover(along, across, share)` for every pixel that `text` touches: `along` the baseline from `start_px`, `across` it
    /// (positive below) from `baseline_px`, with the share of the pixel that is covered.
    pub(super) fn cover(
        &self,
        text: &str,
        style: TextStyle,
        (start_px, baseline_px): (f32, f32),
        mut cover: impl FnMut(i32, i32, f32),
    ) {
        let font = self.font(style.weight);
        let scale = line_scale(font, style.size_px);
        for (glyph, along) in places(font, text, style.size_px).0 {
            let placed = glyph.with_scale_and_position(scale, point(start_px + along, baseline_px));
            if let Some(outline) = font.outline_glyph(placed) {
                let corner = outline.px_bounds().min;
                outline.draw(|x, y, share| {
                    cover(corner.x as i32 + x as i32, corner.y as i32 + y as i32, share);
                });
            }
        }
    }
}

/// The glyphs of `text` with their places along the baseline, and the text's length, pixels.
fn places(font: &FontRef<'static>, text: &str, size_px: f32) -> (Vec<(GlyphId, f32)>, f32) {
    let px_per_unit = size_px / font.units_per_em().unwrap_or(1000.0);
    let mut along = 0.0;
    let mut before = None;
    let mut placed = Vec::new();
    for character in text.chars() {
        let glyph = font.glyph_id(character);
        if let Some(before) = before {
            along += font.kern_unscaled(before, glyph) * px_per_unit;
        }
        placed.push((glyph, along));
        along += font.h_advance_unscaled(glyph) * px_per_unit;
        before = Some(glyph);
    }
    (placed, along)
}

/// The font library scales by the height of a line; a text size is that of the em.
fn line_scale(font: &FontRef<'static>, size_px: f32) -> PxScale {
    let units_per_em = font.units_per_em().unwrap_or(1000.0);
    PxScale::from(size_px * font.height_unscaled() / units_per_em)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::colour::INK;

    const STYLE: TextStyle = TextStyle::regular(14.0, INK);

    #[test]
    fn the_built_in_font_has_every_sign_that_a_picture_uses() {
        let typeface = Typeface::built_in().expect("font");
        for weight in [Weight::Regular, Weight::Bold] {
            for sign in "0123456789−.:%·…–×≤≥µ°²äöüéñ".chars() {
                assert_ne!(typeface.font(weight).glyph_id(sign), GlyphId(0), "{sign} in {weight:?}");
            }
        }
    }

    #[test]
    fn a_text_that_fits_is_left_alone() {
        let typeface = Typeface::built_in().expect("font");
        assert_eq!(typeface.shortened("snare", STYLE, 100.0), "snare");
    }

    #[test]
    fn a_text_too_long_is_cut_before_an_ellipsis() {
        let typeface = Typeface::built_in().expect("font");
        let short = typeface.shortened("a very long name of a drum", STYLE, 60.0);
        assert!(short.ends_with('…') && short.len() > 5, "{short}");
        assert!(typeface.length_px(&short, STYLE) <= 60.0);
    }

    #[test]
    fn twice_the_size_is_twice_the_length() {
        let typeface = Typeface::built_in().expect("font");
        let large = TextStyle::regular(28.0, INK);
        let ratio = typeface.length_px("malleus", large) / typeface.length_px("malleus", STYLE);
        assert!((ratio - 2.0).abs() < 1e-3);
    }
}
