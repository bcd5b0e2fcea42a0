//! The `dynf` sections: the dynamic filter of an object, with the exciter and the loops.

use zerocopy::FromBytes;
use zerocopy::byteorder::little_endian::F32;

use super::check::{check_count, check_object, check_range, check_ranges};
use super::error::TableError;
use super::frame::{head, sections};
use super::kit::Kit;
use super::layout::{BreakpointRecord, DynamicFilterHeader, HAS_EXCITER, HAS_LEVELS, LoopRecord, MODES_THROUGH, tag};
use super::place::{Field, Place};
use super::range::{self, Range};

/// Dynamic filter of one object of a [`Kit`].
#[derive(Clone, Copy, Debug)]
pub struct DynamicFilter<'a> {
    header: &'a DynamicFilterHeader,
    path: &'a [BreakpointRecord],
    loops: &'a [LoopRecord],
    /// One level for each breakpoint; empty if all levels are 1.
    levels: &'a [F32],
}

/// Band of the exciter's noise. A strike multiplies both edges by `(peak force / reference
/// force)^exponent`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExciterBand {
    /// Lower edge in Hz of a strike at the reference force.
    pub low_hz: f32,
    /// Upper edge in Hz of a strike at the reference force.
    pub high_hz: f32,
    /// Power of the peak force that both edges follow.
    pub exponent: f32,
}

impl<'a> Kit<'a> {
    /// Dynamic filters in the order of their objects, each checked as it is read.
    ///
    /// [`Kit::parse`] leaves the filters unchecked, because few engines play them. The engine
    /// checks on load what depends on the sample rate, such as the gain round the loops.
    ///
    /// # Errors
    /// The first [`TableError`] of each section.
    pub fn dynamic_filters(&self) -> impl Iterator<Item = Result<DynamicFilter<'a>, TableError>> + use<'a> {
        let (objects, mut next_object) = (self.objects().count(), 0);
        sections(self.directory, self.bytes, tag::DYNAMIC_FILTER).map(move |body| {
            let filter = DynamicFilter::read(body)?;
            filter.check(objects, next_object)?;
            next_object = filter.object_index() + 1;
            Ok(filter)
        })
    }

    /// Dynamic filter of the object of an index; `None` if the object has no filter.
    ///
    /// # Errors
    /// The first [`TableError`] of the dynamic filters up to that of the object.
    pub fn dynamic_filter_of(&self, object: usize) -> Result<Option<DynamicFilter<'a>>, TableError> {
        let mut filters = self.dynamic_filters();
        filters.find(|filter| filter.as_ref().map_or(true, |filter| filter.object_index() == object)).transpose()
    }
}

impl<'a> DynamicFilter<'a> {
    fn read(body: &'a [u8]) -> Result<Self, TableError> {
        let (header, rest) = head::<DynamicFilterHeader>(body, Place::Kit)?;
        let place = Place::ObjectFilter(usize::from(header.object.get()));
        let (path, loops) = (usize::from(header.breakpoint_count.get()), usize::from(header.loop_count.get()));
        check_count(place, Field::Path, path, 1, range::BREAKPOINTS)?;
        check_count(place, Field::Loops, loops, 0, range::LOOPS)?;
        let levels = if header.flags & HAS_LEVELS != 0 { path } else { 0 };
        let expected = size_of::<DynamicFilterHeader>()
            + size_of::<BreakpointRecord>() * path
            + size_of::<LoopRecord>() * loops
            + size_of::<F32>() * levels;
        let mismatch = TableError::LengthMismatch { place, expected, found: body.len() };
        let (path, rest) = <[BreakpointRecord]>::ref_from_prefix_with_elems(rest, path).map_err(|_| mismatch)?;
        let (loops, rest) = <[LoopRecord]>::ref_from_prefix_with_elems(rest, loops).map_err(|_| mismatch)?;
        let (levels, rest) = <[F32]>::ref_from_prefix_with_elems(rest, levels).map_err(|_| mismatch)?;
        if rest.is_empty() { Ok(Self { header, path, loops, levels }) } else { Err(mismatch) }
    }

    fn check(&self, objects: usize, next_object: usize) -> Result<(), TableError> {
        let object = self.object_index();
        check_object(object, objects, next_object, Place::ObjectFilter(object))?;
        let place = Place::ObjectFilter(object);
        check_count(place, Field::Order, usize::from(self.header.order), 1, 2)?;
        if self.header.flags & !(MODES_THROUGH | HAS_EXCITER | HAS_LEVELS) != 0 {
            return Err(TableError::NotZero { place, field: Field::Padding });
        }
        check_range(place, Field::RateHz, self.rate_hz(), range::RATE_HZ)?;
        self.check_exciter(place)?;
        let mut before = None;
        for (index, breakpoint) in self.path.iter().enumerate() {
            self.check_breakpoint(Place::ObjectBreakpoint(object, index), breakpoint, before)?;
            before = Some(breakpoint.time_s.get());
        }
        for (index, level) in self.levels.iter().enumerate() {
            check_range(Place::ObjectBreakpoint(object, index), Field::Noise, level.get(), range::NOISE_LEVEL)?;
        }
        self.loops
            .iter()
            .enumerate()
            .try_for_each(|(index, record)| check_loop(Place::ObjectLoop(object, index), record))
    }

    fn check_exciter(&self, place: Place) -> Result<(), TableError> {
        let band = self.band();
        let values = [band.low_hz, band.high_hz, band.exponent];
        if self.header.flags & HAS_EXCITER == 0 {
            return match values.iter().all(|value| value.to_bits() == 0) {
                true => Ok(()),
                false => Err(TableError::NotZero { place, field: Field::Exciter }),
            };
        }
        check_ranges(place, &EXCITER, &values)?;
        if band.high_hz - band.low_hz < range::BAND_WIDTH_HZ {
            return Err(TableError::EdgeOrder { place, field: Field::HighHz, below: band.low_hz, above: band.high_hz });
        }
        Ok(())
    }

    fn check_breakpoint(&self, place: Place, record: &BreakpointRecord, before: Option<f32>) -> Result<(), TableError> {
        let time_s = record.time_s.get();
        let times = if before.is_some() { range::TIME_S } else { Range::new(0.0, 0.0) };
        check_range(place, Field::TimeS, time_s, times)?;
        if let Some(before_s) = before.filter(|&before_s| time_s <= before_s) {
            return Err(TableError::TimeOrder { place, before_s, time_s });
        }
        let [a1, a2, b0, b1, b2] =
            [record.a1, record.a2, record.b0, record.b1, record.b2].map(|coefficient| coefficient.get());
        check_ranges(place, &BREAKPOINT, &[a1, a2, b0, b1, b2])?;
        if self.header.order == 1 {
            for (field, value) in [(Field::A2, a2), (Field::B2, b2)] {
                if value.to_bits() != 0 {
                    return Err(TableError::NotZero { place, field });
                }
            }
        }
        let radius = largest_radius(f64::from(a1), f64::from(a2));
        if radius < 1.0 {
            Ok(())
        } else {
            Err(TableError::UnstablePole { place, field: Field::A1, radius: radius as f32 })
        }
    }

    fn band(&self) -> ExciterBand {
        let DynamicFilterHeader { low_hz, high_hz, exponent, .. } = self.header;
        ExciterBand { low_hz: low_hz.get(), high_hz: high_hz.get(), exponent: exponent.get() }
    }

    /// Number of the object, counted from 0.
    pub fn object_index(&self) -> usize {
        usize::from(self.header.object.get())
    }

    /// Order of the filter, 1 or 2.
    pub fn order(&self) -> u8 {
        self.header.order
    }

    /// True if the object's modes are added to the filter's input; if false, to the output.
    pub fn takes_modes(&self) -> bool {
        self.header.flags & MODES_THROUGH != 0
    }

    /// Seed of the noise.
    pub fn seed(&self) -> u32 {
        self.header.seed.get()
    }

    /// Sample rate in Hz that the coefficients are for.
    pub fn rate_hz(&self) -> f32 {
        self.header.rate_hz.get()
    }

    /// Band of the exciter; `None` if the filter has no exciter.
    pub fn exciter(&self) -> Option<ExciterBand> {
        (self.header.flags & HAS_EXCITER != 0).then(|| self.band())
    }

    /// Path of the coefficients, 1 to [`range::BREAKPOINTS`] breakpoints.
    pub fn path(&self) -> &'a [BreakpointRecord] {
        self.path
    }

    /// Levels of the noise at the breakpoints of [`Self::path`], 0 to 1. They are 1 if the table
    /// gives no levels.
    pub fn levels(&self) -> impl Iterator<Item = f32> + Clone + use<'a> {
        let levels = self.levels;
        (0..self.path.len()).map(move |index| levels.get(index).map_or(1.0, |level| level.get()))
    }

    /// Loops round the filter, at most [`range::LOOPS`].
    pub fn loops(&self) -> &'a [LoopRecord] {
        self.loops
    }
}

fn check_loop(place: Place, record: &LoopRecord) -> Result<(), TableError> {
    let [frequency_hz, bandwidth_hz] = [record.frequency_hz.get(), record.bandwidth_hz.get()];
    check_ranges(place, &LOOP, &[frequency_hz, bandwidth_hz, record.gain.get(), record.delay_s.get()])?;
    if bandwidth_hz >= frequency_hz {
        let allowed = Range::new(range::BANDWIDTH_HZ.min, frequency_hz);
        return Err(TableError::OutOfRange { place, field: Field::BandwidthHz, value: bandwidth_hz, allowed });
    }
    Ok(())
}

/// Largest radius of the roots of `z² + a1 z + a2`.
fn largest_radius(a1: f64, a2: f64) -> f64 {
    let discriminant = a1 * a1 - 4.0 * a2;
    if discriminant < 0.0 { libm::sqrt(a2) } else { (libm::fabs(a1) + libm::sqrt(discriminant)) / 2.0 }
}

const EXCITER: [(Field, Range); 3] =
    [(Field::LowHz, range::EDGE_HZ), (Field::HighHz, range::EDGE_HZ), (Field::Exponent, range::EXCITER_EXPONENT)];
const BREAKPOINT: [(Field, Range); 5] = [
    (Field::A1, range::A1),
    (Field::A2, range::A2),
    (Field::B0, range::COEFFICIENT),
    (Field::B1, range::COEFFICIENT),
    (Field::B2, range::COEFFICIENT),
];
const LOOP: [(Field, Range); 4] = [
    (Field::FrequencyHz, range::EDGE_HZ),
    (Field::BandwidthHz, range::BANDWIDTH_HZ),
    (Field::Gain, range::LOOP_GAIN),
    (Field::DelayS, range::DELAY_S),
];
