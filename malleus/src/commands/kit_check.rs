//! `malleus kit check`: tells if a kit is valid, what clips at velocity 1, and what boards leave
//! out.

use dsp_core::SampleRate;
use dsp_core::engine::LoadError;
use dsp_core::memory::WORD_BYTES;
use dsp_core::table::Kit;
use dsp_core::voice::Form;
use kit::Loaded;
use kit::counting::counted;
use malleus::render::{board, headroom, instrument};
use serde::Serialize;
use virtual_board::Board;

use super::error::CommandError;
use super::kit_check_strikes::{StrikeFinding, dbfs};
use super::kit_report::{KitReport, counts, open};
use super::left_out::left_out;
use super::output::{print, print_json, progress};

/// Findings of the check beyond the facts in [`KitReport`].
#[derive(Debug, Default, Serialize)]
struct Findings {
    /// One finding for each striker on each pad, struck alone at velocity 1.
    strikes: Vec<StrikeFinding>,
    /// Peak of all pads struck at once at velocity 1; `None` for silence.
    chord_peak_dbfs: Option<f64>,
    boards: Vec<BoardFinding>,
    /// Reason for which nothing is rendered, if the instrument cannot render the kit.
    not_rendered: Option<String>,
}

#[derive(Debug, Serialize)]
struct BoardFinding {
    board: &'static str,
    budget_cycles: u32,
    /// Memory and time that the kit takes; `None` if the board refuses it.
    plan: Option<PlanFinding>,
    left_out: Vec<String>,
    /// Modes that the board's budget leaves out of all pads struck at once at velocity 1.
    chord_shed: Vec<ShedFinding>,
    chord_refused_stages: u32,
    /// Form in which each pad's modes are played.
    forms: Vec<FormFinding>,
    /// Number of modes of all pads together.
    #[serde(skip)]
    modes: usize,
    #[serde(skip)]
    is_refused: bool,
}

#[derive(Debug, Serialize)]
struct PlanFinding {
    fast_bytes: usize,
    of_fast_bytes: usize,
    bulk_bytes: usize,
    of_bulk_bytes: usize,
    /// Cycles per tick for stages that strikes begin.
    stage_cycles_left: u32,
    of_stage_cycles: u32,
}

/// Form in which a pad's modes are played: `frames`, or `bank` with a reason.
#[derive(Debug, Serialize)]
struct FormFinding {
    pad: String,
    modes: usize,
    form: &'static str,
    reason: Option<&'static str>,
    #[serde(skip)]
    has_few_modes: bool,
}

#[derive(Debug, Serialize)]
struct ShedFinding {
    pad: String,
    modes: usize,
    of_modes: usize,
}

#[derive(Debug, Serialize)]
struct CheckReport<'a> {
    #[serde(flatten)]
    kit: KitReport<'a>,
    #[serde(flatten)]
    findings: Findings,
}

pub(super) fn run(name: &str, rate: SampleRate, board: Option<Board>, json: bool) -> Result<(), CommandError> {
    let loaded = open(name)?;
    check_filters(name, &loaded, rate)?;
    let findings = if loaded.kit.pads.is_empty() { Findings::default() } else { findings(name, &loaded, rate, board)? };
    if json {
        return print_json(&CheckReport { kit: KitReport::of(name, &loaded), findings });
    }
    print(&format!(
        "{name}: good; {}, {} bytes in binary\n{}",
        counts(&loaded),
        loaded.binary.len(),
        findings.as_text(name, board.is_some())
    ))
}

/// Findings on a kit with pads, which is rendered for them.
///
/// If the instrument cannot render the kit, the findings say why.
fn findings(name: &str, loaded: &Loaded, rate: SampleRate, board: Option<Board>) -> Result<Findings, CommandError> {
    let table = Kit::parse(&loaded.binary).map_err(|error| CommandError::Table { kit: name.to_owned(), error })?;
    let strikes = headroom::strike_count(&loaded.kit) as u64;
    let bar = progress(strikes + 1 + Board::ALL.len() as u64, "checking");
    let mut findings = Findings::default();
    let rendered = headroom::of_strikes(&loaded.kit, rate, || bar.inc(1));
    match rendered.and_then(|strikes| Ok((strikes, headroom::of_chord(&loaded.kit, rate)?))) {
        Ok((strikes, chord)) => {
            findings.strikes =
                strikes.iter().filter_map(|strike| StrikeFinding::of(&loaded.kit, strike, &strikes)).collect();
            findings.chord_peak_dbfs = dbfs(chord);
        }
        Err(error) => findings.not_rendered = Some(error.to_string()),
    }
    for board in Board::ALL.into_iter().filter(|&one| board.is_none_or(|board| board == one)) {
        findings.boards.push(of_board(name, board, &loaded.kit, &table));
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(findings)
}

/// Finding of the stages that a board leaves out of a kit, and of the modes that it leaves out of
/// all pads struck at once.
fn of_board(name: &str, on: Board, kit: &kit::Kit, table: &Kit<'_>) -> BoardFinding {
    let shed = board::shed_of_chord(on, table);
    let is_refused = shed.is_err();
    let shed = shed.unwrap_or_default();
    let modes = shed.modes.iter().map(|(_, of_modes)| of_modes).sum();
    let of_pads = kit.pads.iter().zip(&shed.modes).filter(|(_, (modes, _))| *modes > 0);
    let finding = |(pad, &(modes, of_modes)): (&kit::Pad, &(usize, usize))| ShedFinding {
        pad: pad.name.clone(),
        modes,
        of_modes,
    };
    let forms = kit.pads.iter().zip(&shed.modes).zip(&shed.forms);
    let forms = forms.map(|((pad, &(_, modes)), &form)| FormFinding::of(pad, modes, form)).collect();
    BoardFinding {
        board: on.name(),
        budget_cycles: board::budget_cycles(on),
        plan: board::plan(on, table).ok().map(|plan| PlanFinding::of(&plan)),
        left_out: left_out(name, on, table),
        chord_shed: of_pads.map(finding).collect(),
        chord_refused_stages: shed.refused_stages,
        forms,
        modes,
        is_refused,
    }
}

impl Findings {
    /// The findings as lines, with the boards' plans if these are asked for.
    fn as_text(&self, name: &str, with_plan: bool) -> String {
        let mut lines: Vec<String> = Vec::new();
        for strike in &self.strikes {
            lines.extend(strike.as_lines(name));
        }
        // The chord of a single pad is its strike, which has a line already.
        let has_chord =
            self.strikes.iter().any(|strike| self.strikes.first().is_some_and(|first| first.pad != strike.pad));
        if let Some(peak) = self.chord_peak_dbfs.filter(|&peak| has_chord && peak > 0.0) {
            lines.push(format!(
                "{name}: all pads at once at velocity 1 peak at {peak:+.1} dBFS and clip; every level_db {:.1} dB lower fits",
                (peak * 10.0).ceil() / 10.0
            ));
        }
        if let Some(error) = &self.not_rendered {
            lines.push(format!("{name}: levels are not checked: {error}"));
        }
        for board in &self.boards {
            if let Some(plan) = board.plan.as_ref().filter(|_| with_plan) {
                lines.push(format!("{name}: {} {}", board.board, plan.as_text()));
            }
            lines.extend(board.left_out.iter().cloned());
            lines.extend(
                board.forms.iter().filter_map(|form| Some(format!("{name}: {} {}", board.board, form.as_text()?))),
            );
            if !board.is_refused {
                lines.push(format!("{name}: {} {}", board.board, board.of_chord()));
            }
        }
        lines.into_iter().map(|line| line + "\n").collect()
    }
}

impl PlanFinding {
    fn of(plan: &board::BoardPlan) -> Self {
        Self {
            fast_bytes: plan.taken.fast * WORD_BYTES,
            of_fast_bytes: plan.lent.fast * WORD_BYTES,
            bulk_bytes: plan.taken.bulk * WORD_BYTES,
            of_bulk_bytes: plan.lent.bulk * WORD_BYTES,
            stage_cycles_left: plan.stage_cycles_left,
            of_stage_cycles: plan.stage_cycles,
        }
    }

    /// The plan in words.
    fn as_text(&self) -> String {
        let bulk = match self.of_bulk_bytes {
            0 => String::new(),
            of => format!(" and {} of {of} bytes of large memory", self.bulk_bytes),
        };
        format!(
            "takes {} of {} bytes of fast memory{bulk}; {} of {} cycles a tick are left for stages that strikes begin",
            self.fast_bytes, self.of_fast_bytes, self.stage_cycles_left, self.of_stage_cycles
        )
    }
}

impl FormFinding {
    fn of(pad: &kit::Pad, modes: usize, form: Form) -> Self {
        let reason = match form {
            Form::Frames => None,
            Form::FewModes => Some("it has few"),
            Form::Filtered => Some("its dynamic filter takes them"),
            Form::Scraped => Some("contacts move along it as they scrape"),
            Form::FastChoke => {
                Some("its choke_t60_s is too short for frames, which fall by 24 dB in 256 frames at most")
            }
            Form::TooDear => Some("frames would take too many cycles when it is struck"),
            Form::NoMemory => Some("there is no memory for frames"),
        };
        let name = if form == Form::Frames { "frames" } else { "bank" };
        Self { pad: pad.name.clone(), modes, form: name, reason, has_few_modes: form == Form::FewModes }
    }

    /// The form in words; `None` for a pad of few modes, which has no choice.
    fn as_text(&self) -> Option<String> {
        let Self { pad, modes, .. } = self;
        let place = match self.reason {
            None => "in frames".to_owned(),
            Some(reason) => format!("in the fixed-point bank: {reason}"),
        };
        (!self.has_few_modes).then(|| format!("plays the {modes} modes of {pad:?} {place}"))
    }
}

impl BoardFinding {
    /// Modes and stages that the board leaves out of all pads struck at once, in words.
    fn of_chord(&self) -> String {
        let all_modes = self.chord_shed.iter().map(|shed| shed.of_modes).sum::<usize>();
        let is_all =
            self.chord_shed.iter().all(|shed| shed.modes == shed.of_modes) && all_modes == self.modes && all_modes > 1;
        let modes = self
            .chord_shed
            .iter()
            .filter(|_| !is_all)
            .map(|shed| format!("{} of {} of {:?}", shed.modes, counted(shed.of_modes, "modes"), shed.pad));
        let stages = (self.chord_refused_stages > 0).then(|| {
            let stages = counted(self.chord_refused_stages, "stages");
            format!("{stages} among residuals, dynamic filters and biquad banks")
        });
        let everything = is_all.then(|| format!("all {all_modes} modes"));
        let all: Vec<String> = everything.into_iter().chain(modes).chain(stages).collect();
        match all.is_empty() {
            true => "sheds nothing of all pads at once at velocity 1".to_owned(),
            false => format!("sheds of all pads at once at velocity 1: {}", all.join(", ")),
        }
    }
}

/// Refuses a kit with filters that are unstable at the sample rate.
///
/// Tells the user if the instrument cannot play the kit at that rate.
fn check_filters(name: &str, loaded: &Loaded, rate: SampleRate) -> Result<(), CommandError> {
    let filtered = |object: &&kit::Object| object.dynamic_filter.is_some() || object.biquads.is_some();
    for object in loaded.kit.objects.iter().filter(filtered) {
        // Each object alone, on a pad, so that tables without pads are judged, too.
        let alone = one_object(object);
        let bytes = kit::binary::build(&alone)?;
        let table = Kit::parse(&bytes).map_err(|error| CommandError::Table { kit: name.to_owned(), error })?;
        let what = match instrument::plan(&table, rate) {
            Ok(_) => continue,
            Err(LoadError::DynamicFilter { error, .. }) => format!("dynamic filter: {error}"),
            Err(LoadError::Biquads { error, .. }) => format!("biquads: {error}"),
            Err(other) => other.to_string(),
        };
        return Err(CommandError::Filters { kit: name.to_owned(), object: object.name.clone(), rate, what });
    }
    if loaded.kit.pads.is_empty() {
        return Ok(());
    }
    let table = Kit::parse(&loaded.binary).map_err(|error| CommandError::Table { kit: name.to_owned(), error })?;
    if let Err(error) = instrument::plan(&table, rate) {
        eprintln!("malleus: {name}: it cannot be played at {rate}: {error}");
    }
    Ok(())
}

/// Kit of one pad that plays an object's filters without its modes.
fn one_object(object: &kit::Object) -> kit::Kit {
    let (name, nothing) = ("filters".to_owned(), String::new);
    let striker = kit::Striker {
        name: name.clone(),
        source: nothing(),
        licence: nothing(),
        pulse: kit::Pulse::Hertz,
        peak_force: object.reference_force,
        peak_exponent: 1.0,
        contact_time_s: 0.001,
        contact_exponent: 0.0,
        restitution: kit::Striker::DEFAULT_RESTITUTION,
        scrape: None,
        roll: None,
        modes: vec![],
    };
    let pad = kit::Pad {
        name: name.clone(),
        object: object.name.clone(),
        strikers: vec![name.clone()],
        level_db: 0.0,
        pan: 0.0,
        striker_weight: 1.0,
        choke_t60_s: 0.0,
        midi_notes: vec![],
        note_off: kit::NoteOff::Nothing,
        trigger: None,
    };
    let object = kit::Object { modes: vec![], residual: None, ..object.clone() };
    kit::Kit {
        name,
        objects: vec![object],
        strikers: vec![striker],
        pads: vec![pad],
        background: None,
        room: vec![],
        headphone_db: None,
        surfaces: Vec::new(),
    }
}
