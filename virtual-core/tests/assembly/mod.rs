//! Reader of a disassembler's listing, which derives from the text alone what the decoder should
//! find.

use virtual_core::decode::{Flow, Instruction, Kind, decode};

mod mnemonics;

use mnemonics::{Shape, shape};

/// Instruction of the listing.
pub(crate) struct Line<'a> {
    pub(crate) text: &'a str,
    pub(crate) address: u32,
    pub(crate) halves: [u16; 2],
    bytes: u8,
    pub(crate) mnemonic: &'a str,
    operands: &'a str,
    /// Address that the disassembler computed for a branch or a literal.
    target: Option<u32>,
}

impl<'a> Line<'a> {
    /// Reads a line such as ` 8000064: fb10 2011    \tsmlabt\tr0, r0, r1, r2`.
    ///
    /// Returns `None` for data, labels and blank lines.
    pub(crate) fn parse(text: &'a str) -> Option<Line<'a>> {
        let mut columns = text.split('\t');
        let (address, raw) = columns.next()?.split_once(": ")?;
        let mnemonic = columns.next()?.split_whitespace().next()?;
        let rest = columns.next().unwrap_or("");
        let halves: Vec<u16> =
            raw.split_whitespace().map(|half| u16::from_str_radix(half, 16)).collect::<Result<_, _>>().ok()?;
        // Data is listed byte by byte.
        if mnemonic.starts_with('.') || raw.split_whitespace().any(|half| half.len() != 4) {
            return None;
        }
        let (operands, comment) = rest.split_once('@').unwrap_or((rest, ""));
        let number = |text: &str| {
            let digits = text.trim().strip_prefix("0x")?;
            let end = digits.find(|c: char| !c.is_ascii_hexdigit()).unwrap_or(digits.len());
            u32::from_str_radix(&digits[..end], 16).ok()
        };
        let branch = operands.rsplit(", ").next().and_then(number);
        Some(Line {
            text,
            address: u32::from_str_radix(address.trim(), 16).ok()?,
            halves: [halves[0], halves.get(1).copied().unwrap_or(0)],
            bytes: 2 * halves.len() as u8,
            mnemonic,
            operands: operands.trim(),
            target: if operands.contains('[') { number(comment) } else { branch },
        })
    }

    /// Returns the instruction that the decoder should find.
    ///
    /// `in_block` is true inside an IT block, where the condition of a branch is that of the block.
    pub(crate) fn expected(&self, in_block: bool) -> Instruction {
        let (shape, base, conditional) =
            shape(self.mnemonic).unwrap_or_else(|| panic!("unknown mnemonic: {}", self.text));
        let all = Registers::of(self.operands);
        let (outside, inside) = self.operands.split_once('[').unwrap_or((self.operands, ""));
        let destinations = Registers::of(outside);
        let memory = Registers::of(inside.split(']').next().unwrap_or(""));
        let updates = inside.contains("]!") || inside.contains("], #");
        let none = Instruction {
            // Tests of the core have the operation, by what it does.
            operation: decode(self.address, self.halves[0], self.halves[1]).operation,
            kind: Kind::Alu,
            flow: Flow::Next,
            bytes: self.bytes,
            words: 0,
            comment: 0,
            operands: [0; 2],
            address: 0,
            result: 0,
            writeback: 0,
            float_sources: 0,
            float_addend: 0,
            float_result: 0,
            target: 0,
        };
        let of = |kind| Instruction { kind, ..none };
        let jump_if = |list: &[u8]| if list.contains(&15) { Flow::Computed } else { Flow::Next };
        match shape {
            Shape::Plain(kind) => of(kind),
            Shape::Commented(kind) => {
                let digits = self.operands.trim_start_matches("#0x");
                Instruction { comment: u8::from_str_radix(digits, 16).unwrap(), ..of(kind) }
            }
            Shape::SupervisorCall => {
                let digits = self.operands.trim_start_matches("#0x");
                let comment = u8::from_str_radix(digits, 16).unwrap();
                Instruction { comment, flow: Flow::Computed, ..of(Kind::SupervisorCall) }
            }
            Shape::First(kind) => {
                Instruction { result: core(&all.core[..1]), flow: jump_if(&all.core[..1]), ..of(kind) }
            }
            Shape::FirstTwo => Instruction { result: core(&all.core[..2]), ..of(Kind::Alu) },
            Shape::Divide { signed } => {
                // The last two registers of `udiv r2, r2, r3` and of `udiv r2, r3` are the
                // operands.
                let [.., dividend, divisor] = all.core[..] else { panic!("{}", self.text) };
                Instruction {
                    result: core(&all.core[..1]),
                    operands: [dividend, divisor],
                    ..of(Kind::Divide { signed })
                }
            }
            Shape::ToSpecial => Instruction { result: 1 << 13, ..of(Kind::Special) },
            Shape::Branch { link, compare } => {
                let always = !compare && (!conditional || in_block);
                let flow = if always { Flow::Always } else { Flow::Conditional };
                let result = if link { 1 << 14 } else { 0 };
                Instruction { flow, result, target: self.target.unwrap(), ..of(Kind::Branch) }
            }
            Shape::BranchTo { link } => {
                Instruction { flow: Flow::Computed, result: if link { 1 << 14 } else { 0 }, ..of(Kind::Branch) }
            }
            Shape::Table => Instruction { flow: Flow::Computed, address: core(&memory.core), ..of(Kind::TableBranch) },
            Shape::Load | Shape::Store | Shape::StoreExclusive => {
                let kind = match shape {
                    Shape::Load if destinations.double => Kind::LoadMultiple,
                    Shape::Load => Kind::Load,
                    Shape::StoreExclusive => Kind::StoreExclusive,
                    _ if destinations.double => Kind::StoreMultiple,
                    _ if !destinations.float.is_empty() => Kind::StoreFloat,
                    _ if memory.core.len() == 2 => Kind::StoreRegister,
                    _ => Kind::StoreImmediate,
                };
                let load = shape == Shape::Load;
                let written = match shape {
                    Shape::Load => &destinations.core[..],
                    Shape::StoreExclusive => &destinations.core[..1],
                    _ => &[],
                };
                let literal = load && memory.core == [15];
                let stored = if shape == Shape::Store { destinations.core.first().copied() } else { None };
                Instruction {
                    flow: jump_if(written),
                    words: if destinations.double { 2 } else { 0 },
                    operands: [stored.unwrap_or(0), 0],
                    address: core(&memory.core),
                    result: core(written),
                    writeback: if updates { core(&memory.core[..1]) } else { 0 },
                    float_result: if load { single(&destinations.float) } else { 0 },
                    float_sources: if load { 0 } else { single(&destinations.float) },
                    target: if literal { self.target.unwrap() } else { 0 },
                    ..of(kind)
                }
            }
            Shape::Pair { load } => Instruction {
                words: 2,
                address: core(&memory.core),
                result: if load { core(&destinations.core) } else { 0 },
                writeback: if updates { core(&memory.core[..1]) } else { 0 },
                target: if load && memory.core == [15] { self.target.unwrap() } else { 0 },
                ..of(if load { Kind::LoadMultiple } else { Kind::StoreMultiple })
            },
            Shape::Multiple { load, on_stack } => {
                let (base, list) =
                    if on_stack { ("sp!", self.operands) } else { self.operands.split_once(", ").unwrap() };
                let (list, base_register) = (Registers::of(list), core(&Registers::of(base).core));
                let words = if list.double {
                    2 * list.core.len().max(list.float.len() / 2)
                } else {
                    list.core.len() + list.float.len()
                };
                Instruction {
                    flow: if load { jump_if(&list.core) } else { Flow::Next },
                    words: words as u8,
                    address: base_register,
                    writeback: if base.contains('!') { base_register } else { 0 },
                    result: if load { core(&list.core) } else { 0 },
                    float_result: if load { single(&list.float) } else { 0 },
                    float_sources: if load { 0 } else { single(&list.float) },
                    ..of(if load { Kind::LoadMultiple } else { Kind::StoreMultiple })
                }
            }
            Shape::Float(kind) => {
                let (result, rest) = all.float.split_at(1);
                let addend = if kind == Kind::FloatMultiplyAccumulate { single(result) } else { 0 };
                // A form of two registers (`vcvt.f32.s32 s0, s0, #27`) reads the last one.
                Instruction {
                    float_result: single(result),
                    float_sources: single(rest),
                    float_addend: addend,
                    ..of(kind)
                }
            }
            Shape::Compare => Instruction { float_sources: single(&all.float), ..of(Kind::FloatMove) },
            Shape::Move => self.expected_move(&all, of(Kind::FloatMove)),
            Shape::FromStatus => {
                let result = if base == "vmrs" { core(&all.core[..all.core.len().min(1)]) } else { 0 };
                Instruction { result, ..of(Kind::FloatMove) }
            }
        }
    }

    /// Returns the expected VMOV between floats, to or from one or two core registers, or of a
    /// constant.
    fn expected_move(&self, all: &Registers, plain: Instruction) -> Instruction {
        let kind = if all.core.len() == 2 { Kind::FloatMovePair } else { Kind::FloatMove };
        let from_core = all.core.first().is_some_and(|_| self.operands.starts_with(['s', 'd']));
        let (float_result, float_sources) = match (all.core.len(), from_core) {
            (0, _) => (single(&all.float[..1]), single(&all.float[1..])),
            (_, true) => (single(&all.float), 0),
            (_, false) => (0, single(&all.float)),
        };
        Instruction { kind, float_result, float_sources, result: if from_core { 0 } else { core(&all.core) }, ..plain }
    }
}

/// Registers that a piece of text names, in order.
struct Registers {
    core: Vec<u8>,
    /// FPU registers as singles: `d1` is `s2` and `s3`.
    float: Vec<u8>,
    double: bool,
}

impl Registers {
    fn of(text: &str) -> Registers {
        let mut registers = Registers { core: Vec::new(), float: Vec::new(), double: false };
        for word in text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_') {
            let number = |prefix| word.strip_prefix(prefix).and_then(|digits: &str| digits.parse::<u8>().ok());
            match word {
                "sp" => registers.core.push(13),
                "lr" => registers.core.push(14),
                "pc" => registers.core.push(15),
                _ => {
                    registers.core.extend(number('r'));
                    registers.float.extend(number('s'));
                    if let Some(double) = number('d') {
                        registers.float.extend([2 * double, 2 * double + 1]);
                        registers.double = true;
                    }
                }
            }
        }
        registers
    }
}

/// Returns a set of core registers without the program counter.
fn core(registers: &[u8]) -> u16 {
    registers.iter().filter(|&&register| register != 15).fold(0, |set, register| set | 1 << register)
}

/// Returns a set of FPU registers.
fn single(registers: &[u8]) -> u32 {
    registers.iter().fold(0, |set, register| set | 1 << register)
}
