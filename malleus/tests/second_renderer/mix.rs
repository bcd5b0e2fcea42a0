//! Sections `[[pad]]` and "From force to samples" of docs/kit-format.md.

use std::f64::consts::PI;
use std::path::Path;

use toml::Table;

use crate::acceleration::balance;
use crate::biquads::{Chain, chains};
use crate::contact::{Contact, peak_force};
use crate::events::{Action, Event};
use crate::filter::Filter;
use crate::modes::Bank;
use crate::text::{self, Kit, number, word};

struct Pad<'a> {
    fs: f64,
    table: &'a Table,
    object: &'a Table,
    strikers: Vec<&'a Table>,
    bank: Bank,
    striker_banks: Vec<Bank>,
    chains: Vec<Chain>,
    filter: Option<Filter>,
    contacts: Vec<Contact>,
    /// Decay rate of the hand on the pad in 1/s; 0 without a hand.
    hand_per_s: f64,
}

/// Renders events, or a direct force on a pad, as left and right 24-bit samples.
///
/// The force is in reference forces of the pad's object.
pub(crate) fn render(
    kit: &Path,
    events: &[Event],
    direct: Option<(&str, &[f64])>,
    fs: f64,
    frames: usize,
) -> Vec<[i32; 2]> {
    let kit = text::read(kit);
    let mut sides = vec![[0.0; 2]; frames];
    for (stream, table) in kit.pads.iter().enumerate() {
        let mut pad = Pad::new(&kit, table, stream as u32, fs);
        let direct = direct.filter(|(name, _)| *name == word(table, "name", "")).map_or(&[][..], |(_, force)| force);
        let own = events.iter().filter(|event| event.pad == word(table, "name", ""));
        let (strikes, hands): (Vec<_>, Vec<_>) = own.partition(|event| matches!(event.action, Action::Strike { .. }));
        let (mut strikes, mut hands) = (strikes.into_iter().peekable(), hands.into_iter().peekable());
        let level = 10f64.powf(number(table, "level_db", 0.0) / 20.0);
        let (right, left) = ((number(table, "pan", 0.0) + 1.0) * PI / 4.0).sin_cos();
        for (n, sides) in sides.iter_mut().enumerate() {
            // A hand acts at the first tick after its event.
            let mut latest = None;
            while let Some(event) = hands.next_if(|event| n % 32 == 0 && event.at.ceil() < n as f64) {
                latest = Some(event);
            }
            latest.into_iter().for_each(|event| pad.event(n, event));
            pad.tick(n);
            while let Some(event) = strikes.next_if(|event| event.at <= n as f64) {
                pad.event(n, event);
            }
            let x = level * pad.play(n, direct.get(n).copied().unwrap_or(0.0));
            sides[0] += left * x;
            sides[1] += right * x;
        }
    }
    let sample = |y: f64| (8_388_608.0 * y + 0.5).floor().clamp(-8_388_608.0, 8_388_607.0) as i32;
    sides.into_iter().map(|sides| sides.map(sample)).collect()
}

impl<'a> Pad<'a> {
    fn new(kit: &'a Kit, table: &'a Table, stream: u32, fs: f64) -> Self {
        let object = kit.object(word(table, "object", ""));
        let names = table["strikers"].as_array().unwrap().iter();
        let strikers = names.map(|name| kit.striker(name.as_str().unwrap())).collect::<Vec<_>>();
        Self {
            fs,
            table,
            object,
            bank: Bank::new(object, fs),
            striker_banks: strikers.iter().map(|striker| Bank::new(striker, fs)).collect(),
            strikers,
            chains: chains(object, fs),
            filter: Filter::new(object, stream, fs),
            contacts: Vec::new(),
            hand_per_s: 0.0,
        }
    }

    fn banks(&mut self) -> impl Iterator<Item = &mut Bank> {
        self.striker_banks.iter_mut().chain([&mut self.bank])
    }

    /// Lets the hand reach further modes, at each tick.
    fn tick(&mut self, n: usize) {
        if n.is_multiple_of(32) {
            let hand_per_s = self.hand_per_s;
            self.banks().for_each(|bank| bank.reach(hand_per_s));
        }
    }

    /// Acts on an event in the frame of sample n.
    fn event(&mut self, n: usize, event: &Event) {
        match &event.action {
            Action::Strike { velocity, position, striker } => self.strike(n, event.at, *velocity, *position, striker),
            Action::Choke => {
                let t60 = number(self.table, "choke_t60_s", f64::from(0.1_f32));
                if t60 > 0.0 {
                    self.hand(1000f64.ln() / t60);
                }
            }
            Action::Release => self.hand(0.0),
        }
    }

    fn strike(&mut self, n: usize, at: f64, velocity: f64, position: f64, striker: &str) {
        if velocity == 0.0 {
            return;
        }
        let named = self.strikers.iter().position(|table| word(table, "name", "") == striker);
        let index = named.unwrap_or(0);
        let table = self.strikers[index];
        self.contacts.push(Contact::new(table, index, velocity, position, at, self.fs));
        if let Some(filter) = &mut self.filter {
            let level = peak_force(table, velocity) / number(self.object, "reference_force", 1.0);
            filter.strike(n, level, self.object["dynamic_filter"].as_table().unwrap());
        }
    }

    fn hand(&mut self, hand_per_s: f64) {
        if self.hand_per_s != hand_per_s {
            self.hand_per_s = hand_per_s;
            self.filter.iter_mut().for_each(Filter::hand);
            self.banks().for_each(Bank::hand);
        }
    }

    /// Sound of the pad at sample n, under its contacts and a direct force.
    fn play(&mut self, n: usize, direct: f64) -> f64 {
        let direct = direct * number(self.object, "reference_force", 1.0);
        let mut forces = self.contacts.iter().map(|contact| (contact.position, contact.force(n))).collect::<Vec<_>>();
        forces.push((0.0, direct));
        let force = forces.iter().map(|(_, force)| force).sum::<f64>();
        let balanced = self.object.get("acceleration").and_then(toml::Value::as_str) == Some("balance");
        let modes = self.bank.play(&forces);
        let mut beside = self.chains.iter_mut().map(|chain| chain.play(force)).sum::<f64>();
        let weight = number(self.table, "striker_weight", 1.0);
        for (index, bank) in self.striker_banks.iter_mut().enumerate() {
            let own = self.contacts.iter().filter(|contact| contact.striker == index);
            let force = own.map(|contact| contact.force(n)).sum::<f64>() + if index == 0 { direct } else { 0.0 };
            beside += weight * bank.play(&[(0.0, force)]);
            if balanced {
                beside += weight * balance(bank, 0.0, self.fs) * force;
            }
        }
        let mut object = modes;
        if balanced {
            object += forces.iter().map(|&(x, force)| balance(&self.bank, x, self.fs) * force).sum::<f64>();
        } else {
            beside += number(self.object, "acceleration", 0.0) * force;
        }
        let sound = match &mut self.filter {
            Some(filter) if filter.through => filter.play(n, object, self.hand_per_s),
            Some(filter) => filter.play(n, 0.0, self.hand_per_s) + object,
            None => object,
        };
        if self.hand_per_s > 0.0 {
            self.chains.iter_mut().for_each(|chain| chain.damp(self.hand_per_s, self.fs));
        }
        self.contacts.retain(|contact| !contact.is_over(n));
        sound + beside
    }
}
