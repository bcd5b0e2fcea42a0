//! Fits the budget's constants to scenes that the virtual core plays. The PC counts the cost items.
//!
//! Prints the cycles of each cost item that fit the modelled cost best. The fit is a non-negative
//! least-squares fit in which each tick is weighed by its own cost.

use std::error::Error;

use dsp_core::SampleRate;
use dsp_core::engine::{COST_ITEMS, CYCLES, CostItem, Counts, Direct, Skipping};
use dsp_core::event::Event;
use dsp_core::resonator::TICK_FRAMES;
use dsp_core::table::Kit;
use host_tests::lent;
use host_tests::on_chip::EngineOnChip;
use host_tests::on_chip::budget_scenes::{BudgetScene, all};

fn main() -> Result<(), Box<dyn Error>> {
    let mut rows = Vec::new();
    for scene in all() {
        rows.extend(play(&scene)?);
        eprintln!("{}: {} ticks in all", scene.name, rows.len());
    }
    let fitted = fit(&rows);
    let cycles: Vec<String> = fitted.iter().map(|cycles| format!("{cycles:.0}")).collect();
    println!("[{}]", cycles.join(", "));
    for (index, (old, new)) in CYCLES.iter().zip(&fitted).enumerate() {
        let counted: u64 = rows.iter().map(|(counts, _)| u64::from(counts.all()[index])).sum();
        println!("{index}: {old} -> {new:.1} ({counted} counted)");
    }
    Ok(())
}

/// Counts and modelled cycles of each tick of a scene.
fn play(scene: &BudgetScene) -> Result<Vec<(Counts, f64)>, Box<dyn Error>> {
    let mut chip = EngineOnChip::new()?;
    chip.load(&scene.kit, SampleRate::HZ_48000)?;
    chip.set_budget(scene.budget)?;
    let kit = Kit::parse(&scene.kit).map_err(|error| error.to_string())?;
    let mut pc = lent::engine(&kit, SampleRate::HZ_48000, Skipping::On)?;
    pc.set_budget(Some(scene.budget));
    let mut rows = Vec::new();
    for tick in 0..scene.ticks {
        let (events, force) = scene.tick(tick);
        let direct = force.map(|force| Direct { pad: 0, force });
        let (_, call) = chip.render(&events, direct, TICK_FRAMES)?;
        let mut counts = Counts::NONE;
        let mut out = [[0; 2]; TICK_FRAMES];
        let events: &[Event] = &events;
        pc.render_observed(events, direct, &mut out, |report| counts = report.counts)?;
        rows.push((counts, call.cost.nominal as f64));
    }
    Ok(rows)
}

/// Cost items that no fit can tell apart, because they are rare or always come with others. Their
/// cycles come from the profile. A kernel's cycle is one cycle by definition.
const HELD: [CostItem; 9] = [
    CostItem::GuardedRingingGroup,
    CostItem::Strike,
    CostItem::DrivenFrame,
    CostItem::ContactFrame,
    CostItem::Survey,
    CostItem::SurveyedGroup,
    CostItem::ShedGroup,
    CostItem::Look,
    CostItem::KernelCycle,
];

fn fit(rows: &[(Counts, f64)]) -> [f64; COST_ITEMS] {
    let mut cycles = CYCLES.map(f64::from);
    for _ in 0..4000 {
        for item in 0..COST_ITEMS {
            if HELD.iter().any(|&held| item == held as usize) {
                continue;
            }
            let (mut numerator, mut denominator) = (0.0, 0.0);
            for (counts, modelled) in rows {
                let count = f64::from(counts.all()[item]);
                if count > 0.0 {
                    let predicted: f64 = counts.all().iter().zip(cycles).map(|(&n, c)| f64::from(n) * c).sum();
                    let weight = 1.0 / modelled;
                    numerator += weight * count * (modelled - predicted + count * cycles[item]);
                    denominator += weight * count * count;
                }
            }
            if denominator > 0.0 {
                cycles[item] = f64::max(numerator / denominator, 0.0);
            }
        }
    }
    cycles
}
