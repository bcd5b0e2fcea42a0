//! Origins of a kit's items: their files and places in them.

use dsp_core::table::Place;
use dsp_core::table::range::CHAIN_DEPTH;
use toml::Spanned;

use super::document::ModeTable;
use super::filters::{BiquadsOrigin, FilterOrigin};
use super::residual::NoiseOrigin;
use super::source::SourceText;
use crate::error::{KitError, Location};

/// Origins of a kit's items, as indices of files and offsets in bytes.
///
/// Lines are counted only for an error.
pub(super) struct Origins {
    files: Vec<SourceText>,
    /// Index of the kit's own file, and the offset of the kit's name.
    kit: (usize, usize),
    pub(super) objects: Vec<ItemOrigin>,
    pub(super) strikers: Vec<ItemOrigin>,
    pub(super) pads: Vec<ItemOrigin>,
    pub(super) surfaces: Vec<ItemOrigin>,
    /// Index of the background's file, and the offsets of the background and its parts.
    background: Option<(usize, NoiseOrigin)>,
    /// For each band of the room, the index of its file and its offset.
    room: Vec<(usize, usize)>,
}

/// Origin of an object, striker or pad and of its parts.
pub(super) struct ItemOrigin {
    file: usize,
    offset: usize,
    name_offset: usize,
    mode_offsets: Vec<usize>,
    residual: NoiseOrigin,
    filter: FilterOrigin,
    biquads: BiquadsOrigin,
    scrape: Option<usize>,
}

impl ItemOrigin {
    pub(super) fn new(file: usize, offset: usize, name: &Spanned<String>, modes: &[Spanned<ModeTable>]) -> Self {
        Self {
            file,
            offset,
            name_offset: name.span().start,
            mode_offsets: modes.iter().map(|mode| mode.span().start).collect(),
            residual: NoiseOrigin::default(),
            filter: FilterOrigin::default(),
            biquads: BiquadsOrigin::default(),
            scrape: None,
        }
    }
}

impl Origins {
    pub(super) fn new(main: &SourceText, name_offset: usize) -> Self {
        Self {
            files: vec![main.clone()],
            kit: (0, name_offset),
            objects: Vec::new(),
            strikers: Vec::new(),
            pads: Vec::new(),
            surfaces: Vec::new(),
            background: None,
            room: Vec::new(),
        }
    }

    /// Starts a file: all items that are added from now on are in it.
    pub(super) fn begin_file(&mut self, source: &SourceText) {
        self.files.push(source.clone());
    }

    /// Index of the file whose items are being added.
    pub(super) fn current_file(&self) -> usize {
        self.files.len() - 1
    }

    /// Sets the origin of an object's residual.
    pub(super) fn set_residual(&mut self, object: usize, origin: NoiseOrigin) {
        if let Some(item) = self.objects.get_mut(object) {
            item.residual = origin;
        }
    }

    /// Sets the origin of an object's dynamic filter.
    pub(super) fn set_filter(&mut self, object: usize, origin: FilterOrigin) {
        if let Some(item) = self.objects.get_mut(object) {
            item.filter = origin;
        }
    }

    /// Sets the origin of an object's biquad bank.
    pub(super) fn set_biquads(&mut self, object: usize, origin: BiquadsOrigin) {
        if let Some(item) = self.objects.get_mut(object) {
            item.biquads = origin;
        }
    }

    /// Sets the origin of a striker's scraping.
    pub(super) fn set_scrape(&mut self, striker: usize, offset: Option<usize>) {
        if let Some(item) = self.strikers.get_mut(striker) {
            item.scrape = offset;
        }
    }

    /// Sets the origin of the background in the current file.
    pub(super) fn set_background(&mut self, origin: NoiseOrigin) {
        self.background = Some((self.current_file(), origin));
    }

    /// Adds the offset of the room's next band in the current file.
    pub(super) fn add_room_band(&mut self, offset: usize) {
        self.room.push((self.current_file(), offset));
    }

    /// Adds the place of its item to an error that has none yet.
    pub(super) fn locate(&self, error: KitError) -> KitError {
        match error {
            KitError::Item { at: None, item, place, fault } => {
                KitError::Item { at: Some(self.location(place)), item, place, fault }
            }
            other => other,
        }
    }

    /// Place of the name of an object, striker or pad.
    pub(super) fn name_of(&self, place: Place) -> Location {
        match self.item(place) {
            Some(item) => self.at(item.file, item.name_offset),
            None => self.location(place),
        }
    }

    /// Place of an item, or of the smallest part round it whose place is known.
    fn location(&self, place: Place) -> Location {
        if let Some((file, background)) = &self.background {
            let at = |offsets: &[usize], index: usize| {
                Some(self.at(*file, offsets.get(index).copied().unwrap_or(background.offset)))
            };
            let found = match place {
                Place::Background => Some(self.at(*file, background.offset)),
                Place::BackgroundEdge(edge) => at(&background.edges, edge),
                Place::BackgroundBand(band) => at(&background.bands, band),
                _ => None,
            };
            if let Some(found) = found {
                return found;
            }
        }
        let band = match place {
            Place::Room => self.room.first(),
            Place::RoomBand(band) => self.room.get(band),
            _ => None,
        };
        if let Some(&(file, offset)) = band {
            return self.at(file, offset);
        }
        let Some(item) = self.item(place) else {
            return self.at(self.kit.0, self.kit.1);
        };
        let (filter, biquads) = (&item.filter, &item.biquads);
        let chain = |chain: usize| biquads.chains.get(chain);
        let part_offset = match place {
            Place::ObjectMode(_, mode) | Place::StrikerMode(_, mode) => item.mode_offsets.get(mode).copied(),
            Place::StrikerScrape(_) => item.scrape,
            Place::ObjectResidual(_) => Some(item.residual.offset),
            Place::ObjectEdge(_, edge) => Some(item.residual.edges.get(edge).copied().unwrap_or(item.residual.offset)),
            Place::ObjectBand(_, band) => Some(item.residual.bands.get(band).copied().unwrap_or(item.residual.offset)),
            Place::ObjectFilter(_) => Some(filter.offset),
            Place::ObjectBreakpoint(_, point) => Some(filter.path.get(point).copied().unwrap_or(filter.offset)),
            Place::ObjectLoop(_, index) => Some(filter.loops.get(index).copied().unwrap_or(filter.offset)),
            Place::ObjectBiquads(_) => Some(biquads.offset),
            Place::ObjectChain(_, index) => Some(chain(index).map_or(biquads.offset, |(offset, _)| *offset)),
            Place::ObjectBiquad(_, number) => {
                let biquad = |(_, own): &(usize, Vec<usize>)| own.get(number % CHAIN_DEPTH).copied();
                Some(chain(number / CHAIN_DEPTH).and_then(biquad).unwrap_or(biquads.offset))
            }
            _ => None,
        };
        self.at(item.file, part_offset.unwrap_or(item.offset))
    }

    fn item(&self, place: Place) -> Option<&ItemOrigin> {
        match place {
            Place::Kit
            | Place::Background
            | Place::BackgroundEdge(_)
            | Place::BackgroundBand(_)
            | Place::Room
            | Place::RoomBand(_) => None,
            Place::Object(index)
            | Place::ObjectMode(index, _)
            | Place::ObjectResidual(index)
            | Place::ObjectEdge(index, _)
            | Place::ObjectBand(index, _)
            | Place::ObjectFilter(index)
            | Place::ObjectBreakpoint(index, _)
            | Place::ObjectLoop(index, _)
            | Place::ObjectBiquads(index)
            | Place::ObjectChain(index, _)
            | Place::ObjectBiquad(index, _) => self.objects.get(index),
            Place::Striker(index) | Place::StrikerMode(index, _) | Place::StrikerScrape(index) => {
                self.strikers.get(index)
            }
            Place::Surface(index) => self.surfaces.get(index),
            Place::Pad(index) => self.pads.get(index),
        }
    }

    fn at(&self, file: usize, offset: usize) -> Location {
        let (file, text) = self.files.get(file).map_or(("", ""), |source| (&source.file, &source.text));
        Location::of(file, text, offset)
    }
}
