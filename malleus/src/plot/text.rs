//! Text in the font that the program carries: Noto Sans, SIL Open Font License.
//!
//! So a picture needs no font of the machine.

use ab_glyph::{Font, FontRef, GlyphId, PxScale, point};

use super::colour::Colour;

/// Height of a capital letter as a share of the text size.
///
/// A baseline half of this height below a place centres the text on that place.
pub(super) const CAPITAL_HEIGHT: f32 = 0.714;

/// Weight of a font's strokes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Weight {
    /// Weight of labels.
    Regular,
    /// Weight of titles.
    Bold,
}

/// Point along a text that stands at the given place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    /// Beginning of the text.
    Start,
    /// Middle of the text.
    Middle,
    /// End of the text.
    End,
}

/// Size, weight and colour of a text.
#[derive(Clone, Copy, Debug)]
pub(super) struct TextStyle {
    /// Em size in pixels.
    pub(super) size_px: f32,
    /// Weight of the strokes.
    pub(super) weight: Weight,
    /// Colour of the strokes.
    pub(super) colour: Colour,
}

impl TextStyle {
    /// Creates the style of a text of regular weight.
    pub(super) const fn regular(size_px: f32, colour: Colour) -> Self {
        Self { size_px, weight: Weight::Regular, colour }
    }

    /// Creates the style of a text of bold weight.
    pub(super) const fn bold(size_px: f32, colour: Colour) -> Self {
        Self { size_px, weight: Weight::Bold, colour }
    }
}

/// Font in its two weights.
pub(super) struct Typeface {
    regular: FontRef<'static>,
    bold: FontRef<'static>,
}

impl Typeface {
    /// Loads the font that the program carries; `None` if its bytes are damaged.
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

    /// Length of `text` in pixels.
    pub(super) fn length_px(&self, text: &str, style: TextStyle) -> f32 {
        let font = self.font(style.weight);
        let (places, end) = places(font, text, style.size_px);
        if places.is_empty() { 0.0 } else { end }
    }

    /// The whole text if it is at most `room_px` pixels long, else as much of its beginning as fits
    /// before an ellipsis.
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

    /// Calls `cover(along, across, share)` for every pixel that `text` touches.
    ///
    /// `along` counts pixels in the direction of the text, which begins at `start_px`; `across`
    /// counts them downwards, with the baseline at `baseline_px`. `share` is the share of the pixel
    /// that is covered, 0 to 1.
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

/// Glyphs of `text` with their places along the baseline, and the length of the text, in pixels.
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

/// Scale of the font library for an em of `size_px` pixels.
///
/// The library scales by the height of a line, while a text size is that of the em.
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
    fn built_in_font_has_every_character_that_a_picture_uses() {
        let typeface = Typeface::built_in().expect("font");
        for weight in [Weight::Regular, Weight::Bold] {
            for sign in "0123456789−.:%·…–×≤≥µ°²äöüéñ".chars() {
                assert_ne!(typeface.font(weight).glyph_id(sign), GlyphId(0), "{sign} in {weight:?}");
            }
        }
    }

    #[test]
    fn text_that_fits_is_not_cut() {
        let typeface = Typeface::built_in().expect("font");
        assert_eq!(typeface.shortened("snare", STYLE, 100.0), "snare");
    }

    #[test]
    fn text_that_is_too_long_is_cut_before_an_ellipsis() {
        let typeface = Typeface::built_in().expect("font");
        let short = typeface.shortened("a very long name of a drum", STYLE, 60.0);
        assert!(short.ends_with('…') && short.len() > 5, "{short}");
        assert!(typeface.length_px(&short, STYLE) <= 60.0);
    }

    #[test]
    fn text_of_twice_the_size_has_twice_the_length() {
        let typeface = Typeface::built_in().expect("font");
        let large = TextStyle::regular(28.0, INK);
        let ratio = typeface.length_px("malleus", large) / typeface.length_px("malleus", STYLE);
        assert!((ratio - 2.0).abs() < 1e-3);
    }
}
