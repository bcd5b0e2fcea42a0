//! Mnemonics of the Cortex-M4F and the meaning of their operands.

use virtual_core::decode::Kind;

/// Meaning of the operands of a mnemonic.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shape {
    /// No register is written that another instruction could wait for.
    Plain(Kind),
    /// The operand is a number that the decoder keeps.
    Commented(Kind),
    SupervisorCall,
    /// The first register is written.
    First(Kind),
    /// The first two registers are written.
    FirstTwo,
    Divide {
        signed: bool,
    },
    ToSpecial,
    Branch {
        link: bool,
        compare: bool,
    },
    BranchTo {
        link: bool,
    },
    Table,
    Load,
    Store,
    StoreExclusive,
    Pair {
        load: bool,
    },
    Multiple {
        load: bool,
        on_stack: bool,
    },
    Float(Kind),
    Compare,
    Move,
    FromStatus,
}

const CONDITIONS: [&str; 15] =
    ["eq", "ne", "hs", "lo", "mi", "pl", "vs", "vc", "hi", "ls", "ge", "lt", "gt", "le", "al"];

/// Returns the shape of a mnemonic, the mnemonic without its suffixes, and true if it has a
/// condition.
pub(crate) fn shape(mnemonic: &str) -> Option<(Shape, &str, bool)> {
    let name = mnemonic.split('.').next()?;
    if let Some(slots) = name.strip_prefix("it")
        && slots.chars().all(|slot| "te".contains(slot))
    {
        return Some((Shape::Plain(Kind::IfThen), name, false));
    }
    let without_condition = CONDITIONS.iter().find_map(|condition| name.strip_suffix(condition));
    let flags = name.strip_suffix('s');
    let readings = [Some((name, false)), without_condition.map(|name| (name, true)), flags.map(|name| (name, false))];
    readings.into_iter().flatten().find_map(|(base, conditional)| Some((known(base)?, base, conditional)))
}

fn known(base: &str) -> Option<Shape> {
    Some(match base {
        "cmp" | "cmn" | "tst" | "teq" => Shape::Plain(Kind::Alu),
        "nop" | "sev" | "yield" | "clrex" | "pld" | "pli" => Shape::Plain(Kind::Hint),
        "wfi" | "wfe" => Shape::Plain(Kind::Wait),
        "dmb" | "dsb" | "isb" => Shape::Plain(Kind::Barrier),
        "cpsid" | "cpsie" => Shape::Plain(Kind::ChangeState),
        "udf" | "trap" | "<unknown>" => Shape::Plain(Kind::Undefined),
        "bkpt" => Shape::Commented(Kind::Breakpoint),
        "svc" => Shape::SupervisorCall,
        "mrs" => Shape::First(Kind::Special),
        "msr" => Shape::ToSpecial,
        "mla" | "mls" => Shape::First(Kind::MultiplyAccumulate),
        "sdiv" => Shape::Divide { signed: true },
        "udiv" => Shape::Divide { signed: false },
        "smull" | "umull" | "smlal" | "umlal" | "umaal" | "smlalbb" | "smlalbt" | "smlaltb" | "smlaltt" | "smlald"
        | "smlaldx" | "smlsld" | "smlsldx" => Shape::FirstTwo,
        "b" => Shape::Branch { link: false, compare: false },
        "bl" => Shape::Branch { link: true, compare: false },
        "cbz" | "cbnz" => Shape::Branch { link: false, compare: true },
        "bx" => Shape::BranchTo { link: false },
        "blx" => Shape::BranchTo { link: true },
        "tbb" | "tbh" => Shape::Table,
        "ldr" | "ldrb" | "ldrh" | "ldrsb" | "ldrsh" | "ldrt" | "ldrbt" | "ldrht" | "ldrex" | "ldrexb" | "ldrexh"
        | "vldr" => Shape::Load,
        "str" | "strb" | "strh" | "strt" | "strbt" | "strht" | "vstr" => Shape::Store,
        "strex" | "strexb" | "strexh" => Shape::StoreExclusive,
        "ldrd" => Shape::Pair { load: true },
        "strd" => Shape::Pair { load: false },
        "ldm" | "ldmdb" | "vldmia" | "vldmdb" => Shape::Multiple { load: true, on_stack: false },
        "stm" | "stmdb" | "vstmia" | "vstmdb" => Shape::Multiple { load: false, on_stack: false },
        "pop" | "vpop" => Shape::Multiple { load: true, on_stack: true },
        "push" | "vpush" => Shape::Multiple { load: false, on_stack: true },
        "vadd" | "vsub" | "vmul" | "vnmul" | "vcvt" | "vcvtr" | "vcvtb" | "vcvtt" => Shape::Float(Kind::Float),
        "vmla" | "vmls" | "vnmla" | "vnmls" | "vfma" | "vfms" | "vfnma" | "vfnms" => {
            Shape::Float(Kind::FloatMultiplyAccumulate)
        }
        "vdiv" | "vsqrt" => Shape::Float(Kind::FloatDivide),
        "vneg" | "vabs" => Shape::Float(Kind::FloatMove),
        "vcmp" | "vcmpe" => Shape::Compare,
        "vmov" => Shape::Move,
        "vmrs" | "vmsr" => Shape::FromStatus,
        _ if ALU.contains(&base) => Shape::First(Kind::Alu),
        _ => {
            let lanes = ["add8", "sub8", "add16", "sub16", "asx", "sax"];
            let prefixes = ["s", "q", "sh", "u", "uq", "uh"];
            let simd = lanes.iter().filter_map(|lane| base.strip_suffix(lane)).any(|prefix| prefixes.contains(&prefix));
            return simd.then_some(Shape::First(Kind::Alu));
        }
    })
}

const ALU: [&str; 84] = [
    "add", "addw", "adc", "sub", "subw", "sbc", "rsb", "and", "orr", "orn", "eor", "bic", "mov", "movw", "movt", "mvn",
    "adr", "lsl", "lsr", "asr", "ror", "rrx", "mul", "smmul", "smmulr", "smmla", "smmlar", "smmls", "smmlsr", "smulbb",
    "smulbt", "smultb", "smultt", "smulwb", "smulwt", "smlabb", "smlabt", "smlatb", "smlatt", "smlawb", "smlawt",
    "smuad", "smuadx", "smusd", "smusdx", "smlad", "smladx", "smlsd", "smlsdx", "qadd", "qsub", "qdadd", "qdsub",
    "ssat", "usat", "ssat16", "usat16", "sel", "usad8", "usada8", "pkhbt", "pkhtb", "sxtb", "sxth", "uxtb", "uxth",
    "sxtb16", "uxtb16", "sxtab", "sxtah", "uxtab", "uxtah", "sxtab16", "uxtab16", "clz", "rbit", "rev", "rev16",
    "revsh", "bfi", "bfc", "sbfx", "ubfx", "neg",
];
