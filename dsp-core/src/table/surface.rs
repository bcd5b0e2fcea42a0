//! The `surf`, `osur`, `scrp` and `roll` sections: surfaces, and what moves over them.
//!
//! [`Kit::parse`] skips them, as it skips other stages that few engines have;
//! [`Kit::check_surfaces`] checks them for a program that plays them.

use zerocopy::FromBytes;
use zerocopy::byteorder::little_endian::I16;

use super::Kit;
use super::check::{
    check_count, check_distinct, check_name, check_range, check_ranges, check_text, name_str, text_str,
};
use super::error::TableError;
use super::frame::{head, optional_section, sections};
use super::layout::{
    CURVATURES, GRID_MULTIPLE, GUARD, LIMITS, MapHeader, OCTAVES, ObjectSurfaceRecord, RollRecord, ScrapeRecord,
    SurfaceHeader, tag,
};
use super::map::Map;
use super::place::{Field, Place};
use super::range::{self, Range};

/// Surface of a [`Kit`].
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    header: &'a SurfaceHeader,
    map: Option<&'a MapHeader>,
    heights: &'a [I16],
    curvature: &'a [I16],
    /// All octaves, one behind the other.
    slopes: &'a [I16],
    source: &'a [u8],
    licence: &'a [u8],
}

/// Number of slope coefficients of all octaves over a grid.
fn slope_count(grid: usize) -> usize {
    (0..OCTAVES).map(|octave| ((grid >> octave) + GUARD) * LIMITS).sum()
}

impl<'a> Surface<'a> {
    fn read(body: &'a [u8], index: usize) -> Result<Self, TableError> {
        let place = Place::Surface(index);
        let (header, rest) = head::<SurfaceHeader>(body, place)?;
        let (map, rest) = if header.rows.get() > 1 {
            let (map, rest) = head::<MapHeader>(rest, place)?;
            (Some(map), rest)
        } else {
            (None, rest)
        };
        let (points, grid) = (header.point_count.get() as usize, header.grid_count.get() as usize);
        let [least, most] = range::HEIGHTS;
        check_count(place, Field::Heights, points, least, most)?;
        let multiple = if map.is_some() { 1 } else { GRID_MULTIPLE };
        check_count(place, Field::Heights, grid, multiple.max(range::GRID_POINTS), most)?;
        let (curvatures, slopes) = match map {
            None => (grid + GUARD, slope_count(grid)),
            Some(map) => {
                let rows = map.grid_rows.get() as usize;
                check_count(place, Field::Rows, rows, range::GRID_POINTS, most)?;
                check_count(place, Field::Heights, rows * grid, 1, most)?;
                (CURVATURES * (grid + GUARD) * (rows + GUARD), 0)
            }
        };
        let texts = usize::from(header.source_bytes.get()) + usize::from(header.licence_bytes.get());
        let heads = size_of::<SurfaceHeader>() + map.map_or(0, |_| size_of::<MapHeader>());
        let expected = heads + (2 * (points + curvatures + slopes) + texts).next_multiple_of(4);
        let mismatch = TableError::LengthMismatch { place, expected, found: body.len() };
        if body.len() != expected || !grid.is_multiple_of(multiple) {
            return Err(mismatch);
        }
        let take = |rest: &'a [u8], count| <[I16]>::ref_from_prefix_with_elems(rest, count).map_err(|_| mismatch);
        let (heights, rest) = take(rest, points)?;
        let (curvature, rest) = take(rest, curvatures)?;
        let (slopes, rest) = take(rest, slopes)?;
        let (source, rest) = rest.split_at_checked(header.source_bytes.get().into()).ok_or(mismatch)?;
        let (licence, padding) = rest.split_at_checked(header.licence_bytes.get().into()).ok_or(mismatch)?;
        if padding.iter().any(|&byte| byte != 0) {
            return Err(TableError::NotZero { place, field: Field::Padding });
        }
        Ok(Self { header, map, heights, curvature, slopes, source, licence })
    }

    fn check(&self, index: usize) -> Result<(), TableError> {
        let place = Place::Surface(index);
        check_name(&self.header.name, place)?;
        [self.source, self.licence].iter().try_for_each(|text| check_text(text, place))?;
        check_range(place, Field::StepM, self.step_m(), range::STEP_M)?;
        check_range(place, Field::UnitM, self.unit_m(), range::UNIT_M)?;
        check_range(place, Field::ShortestM, self.shortest_m(), range::SHORTEST_M)?;
        let finest = Range::new(2.0 * self.step_m(), range::SHORTEST_M.max);
        check_range(place, Field::ShortestM, self.shortest_m(), finest)?;
        check_count(place, Field::Rows, self.rows(), 1, self.heights.len() / 2)?;
        if !self.heights.len().is_multiple_of(self.rows().max(1)) {
            let (expected, found) = (self.heights.len().next_multiple_of(self.rows()), self.heights.len());
            return Err(TableError::LengthMismatch { place, expected, found });
        }
        if let Some(map) = self.map() {
            // A walk over a map goes on by a few points a frame in both directions.
            let steps = Range::new(0.5 * self.grid_step_m(), 2.0 * self.grid_step_m());
            check_range(place, Field::StepM, map.row_step_m(), steps)?;
        }
        // Curvature and slope are derived: any finite numbers above 0 in the limits' order will do.
        let header = self.header;
        let positive = Range::new(1e-30, 1e30);
        let derived = [header.curvature_rms_per_m, header.curvature_unit_per_m];
        for value in derived.iter().chain(&header.slope_unit).chain(&header.alpha_m) {
            check_range(place, Field::Surface, value.get(), positive)?;
        }
        let waves = self.map.iter().flat_map(|map| map.mean_waves_per_m.iter().flatten());
        header
            .mean_per_m
            .iter()
            .chain(waves)
            .try_for_each(|mean| check_range(place, Field::Surface, mean.get(), Range::new(-1e30, 1e30)))?;
        header
            .mix_gain
            .iter()
            .try_for_each(|gain| check_range(place, Field::Surface, gain.get(), Range::new(0.0, 1.0)))?;
        let [low, middle, high] = self.alpha_m();
        if low < middle && middle < high {
            return Ok(());
        }
        Err(TableError::OutOfRange { place, field: Field::Surface, value: middle, allowed: Range::new(low, high) })
    }

    /// Name of the surface.
    pub fn name(&self) -> &'a str {
        name_str(&self.header.name)
    }

    /// Distance of the heights in metres.
    pub fn step_m(&self) -> f32 {
        self.header.step_m.get()
    }

    /// Height of one unit in metres.
    pub fn unit_m(&self) -> f32 {
        self.header.unit_m.get()
    }

    /// Shortest wave in metres.
    pub fn shortest_m(&self) -> f32 {
        self.header.shortest_m.get()
    }

    /// Number of rows of the heights; a profile has 1.
    pub fn rows(&self) -> usize {
        self.header.rows.get().into()
    }

    /// Heights, row by row.
    pub fn heights(&self) -> &'a [I16] {
        self.heights
    }

    /// Distance of the grid's points in metres, on which curvature and slope are given; of a map's
    /// in a row.
    pub fn grid_step_m(&self) -> f32 {
        self.step_m() * (self.heights.len() / self.rows().max(1)) as f32 / self.grid_points() as f32
    }

    /// Number of the grid's points; of a map's in a row.
    pub fn grid_points(&self) -> usize {
        self.header.grid_count.get() as usize
    }

    /// Curvatures of a map; `None` for a profile.
    pub fn map(&self) -> Option<Map<'a>> {
        let header = self.map?;
        let points = [self.grid_points(), header.grid_rows.get() as usize];
        let row_step_m = self.step_m() * self.rows() as f32 / points[1] as f32;
        Some(Map { header, points, row_step_m, coefficients: self.curvature })
    }

    /// Rms of the curvature, 1/m.
    pub fn curvature_rms_per_m(&self) -> f32 {
        self.header.curvature_rms_per_m.get()
    }

    /// Curvature of one unit, 1/m.
    pub fn curvature_unit_per_m(&self) -> f32 {
        self.header.curvature_unit_per_m.get()
    }

    /// Coefficients of the curvature's spline, one for each point of the grid, with its
    /// [`GUARD`]; for a map see [`Map::coefficients`].
    pub fn curvature(&self) -> &'a [I16] {
        self.curvature
    }

    /// Limits α in metres at which slopes are given, rising.
    pub fn alpha_m(&self) -> [f32; LIMITS] {
        self.header.alpha_m.map(|alpha| alpha.get())
    }

    /// Slope of one unit at each limit.
    pub fn slope_unit(&self) -> [f32; LIMITS] {
        self.header.slope_unit.map(|unit| unit.get())
    }

    /// Mean of the limited curvature at each limit, 1/m, which the slope leaves out.
    pub fn mean_per_m(&self) -> [f32; LIMITS] {
        self.header.mean_per_m.map(|mean| mean.get())
    }

    /// Gain by which a mix of the slopes at two neighbouring limits falls short.
    pub fn mix_gain(&self) -> [f32; LIMITS - 1] {
        self.header.mix_gain.map(|gain| gain.get())
    }

    /// Coefficients of the slope's splines in an octave, whose points lie `2^octave` points of the
    /// grid apart: those of all limits at each point, with their [`GUARD`]. Empty for an octave
    /// that there is not.
    pub fn slopes(&self, octave: usize) -> &'a [I16] {
        let count = |octave: usize| ((self.grid_points() >> octave) + GUARD) * LIMITS;
        let begin: usize = (0..octave.min(OCTAVES)).map(count).sum();
        self.slopes.get(begin..begin + count(octave)).filter(|_| octave < OCTAVES).unwrap_or(&[])
    }

    /// Source of the numbers, as text.
    pub fn source(&self) -> &'a str {
        text_str(self.source)
    }

    /// Licence of the numbers, as text.
    pub fn licence(&self) -> &'a str {
        text_str(self.licence)
    }
}

/// Records of a section that may stand once; empty without it.
fn records<'a, T>(kit: &Kit<'a>, tag: [u8; 4]) -> Result<&'a [T], TableError>
where
    [T]: FromBytes + zerocopy::Immutable + zerocopy::KnownLayout + zerocopy::Unaligned,
{
    let Some(body) = optional_section(kit.directory, kit.bytes, tag)? else { return Ok(&[]) };
    let expected = body.len() / size_of::<T>() * size_of::<T>();
    <[T]>::ref_from_bytes(body).map_err(|_| TableError::LengthMismatch {
        place: Place::Kit,
        expected,
        found: body.len(),
    })
}

/// Checks that records name things that there are, each at most once and in their order.
fn check_order(numbers: impl Iterator<Item = usize>, count: usize, field: Field) -> Result<(), TableError> {
    let mut next = 0;
    for index in numbers {
        if index >= count || index < next {
            return Err(TableError::Dangling { place: Place::Kit, field, index, count });
        }
        next = index + 1;
    }
    Ok(())
}

impl<'a> Kit<'a> {
    /// Surfaces, in the order in which objects count them.
    pub fn surfaces(&self) -> impl Iterator<Item = Surface<'a>> + Clone + use<'a> {
        sections(self.directory, self.bytes, tag::SURFACE).filter_map(|body| Surface::read(body, 0).ok())
    }

    /// Surfaces of objects, in the order of the objects.
    pub fn object_surfaces(&self) -> &'a [ObjectSurfaceRecord] {
        records(self, tag::OBJECT_SURFACES).unwrap_or(&[])
    }

    /// Strikers that scrape, in their order.
    pub fn scrapes(&self) -> &'a [ScrapeRecord] {
        records(self, tag::SCRAPE).unwrap_or(&[])
    }

    /// Strikers that roll, in their order.
    pub fn rolls(&self) -> &'a [RollRecord] {
        records(self, tag::ROLL).unwrap_or(&[])
    }

    /// Checks surfaces and what moves over them.
    ///
    /// # Errors
    /// A [`TableError`] for the first thing that is wrong.
    pub fn check_surfaces(&self) -> Result<(), TableError> {
        let mut count = 0;
        for body in sections(self.directory, self.bytes, tag::SURFACE) {
            Surface::read(body, count)?.check(count)?;
            count += 1;
        }
        check_distinct(self.surfaces().map(|surface| surface.name()), Place::Surface)?;
        let places: &[ObjectSurfaceRecord] = records(self, tag::OBJECT_SURFACES)?;
        check_order(places.iter().map(|record| record.object.get().into()), self.objects().count(), Field::Object)?;
        for record in places {
            let (object, surface) = (usize::from(record.object.get()), usize::from(record.surface.get()));
            if surface >= count {
                let place = Place::Object(object);
                return Err(TableError::Dangling { place, field: Field::Surface, index: surface, count });
            }
            check_range(Place::Object(object), Field::SurfaceLevelDb, record.level_db.get(), range::SURFACE_LEVEL_DB)?;
            for size_m in record.size_m {
                check_range(Place::Object(object), Field::SizeM, size_m.get(), range::SIZE_M)?;
            }
        }
        let strikers = self.strikers().count();
        let scrapes: &[ScrapeRecord] = records(self, tag::SCRAPE)?;
        check_order(scrapes.iter().map(|record| record.striker.get().into()), strikers, Field::Scrape)?;
        scrapes.iter().try_for_each(check_scrape)?;
        let rolls: &[RollRecord] = records(self, tag::ROLL)?;
        check_order(rolls.iter().map(|record| record.striker.get().into()), strikers, Field::Scrape)?;
        rolls.iter().try_for_each(|record| check_roll(record, scrapes))
    }
}

fn check_scrape(record: &ScrapeRecord) -> Result<(), TableError> {
    let place = Place::StrikerScrape(record.striker.get().into());
    let ranges = const {
        &[
            (Field::MassKg, range::MASS_KG),
            (Field::SlopeGain, range::SLOPE_GAIN),
            (Field::SlopeExponent, range::SLOPE_EXPONENT),
            (Field::AlphaExponent, range::ALPHA_EXPONENT),
            (Field::SmoothingS, range::SMOOTHING_S),
            (Field::TiltRad, range::TILT_RAD),
            (Field::Friction, range::FRICTION),
        ]
    };
    let [low, high] = [record.alpha_min_m.get(), record.alpha_max_m.get()];
    let (tilt_rad, friction) = (record.tilt_rad.get(), record.friction.get());
    let values = [
        record.mass_kg.get(),
        record.slope_gain.get(),
        record.slope_exponent.get(),
        record.alpha_exponent.get(),
        record.smoothing_s.get(),
        tilt_rad,
        friction,
    ];
    check_ranges(place, ranges, &values)?;
    if record.reserved.get() != 0 {
        return Err(TableError::NotZero { place, field: Field::Padding });
    }
    let own_or =
        |field, alpha_m| if alpha_m == 0.0 { Ok(()) } else { check_range(place, field, alpha_m, range::ALPHA_M) };
    own_or(Field::AlphaMinM, low)?;
    own_or(Field::AlphaMaxM, high)?;
    if high > 0.0 {
        check_range(place, Field::AlphaMinM, low, Range::new(0.0, high))?;
    }
    // Of a steeper push more would go into the surface than into the motion (eq. 8).
    let steepest = (0.999 / crate::sine::tan(f64::from(tilt_rad))) as f32;
    let steepest = if tilt_rad > 0.0 { steepest } else { range::FRICTION.max };
    check_range(place, Field::Friction, friction, Range::new(0.0, steepest))
}

fn check_roll(record: &RollRecord, scrapes: &[ScrapeRecord]) -> Result<(), TableError> {
    let place = Place::StrikerScrape(record.striker.get().into());
    let ranges = const {
        &[
            (Field::RadiusM, range::RADIUS_M),
            (Field::OffsetM, range::OFFSET_M),
            (Field::Stiffness, range::STIFFNESS),
            (Field::Dissipation, range::DISSIPATION),
            (Field::Modulation, range::MODULATION),
            (Field::Slip, range::SLIP),
        ]
    };
    let values = [
        record.radius_m.get(),
        record.offset_m.get(),
        record.stiffness.get(),
        record.dissipation.get(),
        record.modulation.get(),
        record.slip.get(),
    ];
    check_ranges(place, ranges, &values)?;
    if record.reserved.get() != 0 {
        return Err(TableError::NotZero { place, field: Field::Padding });
    }
    if scrapes.iter().any(|scrape| scrape.striker == record.striker) {
        return Ok(());
    }
    Err(TableError::RollAlone { place })
}
