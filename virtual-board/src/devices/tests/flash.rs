//! Tests of the flash controller: locks, flags, times, and contents.

use super::{Bench, FLASH};
use crate::error::Problem;
use crate::flash::{FlashChange, FlashEnding, FlashTimes};
use crate::input::Fault;
use crate::wiring::Board;

const KEYR: u32 = FLASH + 0x04;
const OPTKEYR: u32 = FLASH + 0x08;
const SR: u32 = FLASH + 0x0c;
const CR: u32 = FLASH + 0x10;
const OPTCR: u32 = FLASH + 0x14;

const PG: u32 = 1;
const SER: u32 = 1 << 1;
const WORDS: u32 = 2 << 8;
const STRT: u32 = 1 << 16;
const EOPIE: u32 = 1 << 24;
const ERRIE: u32 = 1 << 25;
const LOCK: u32 = 1 << 31;
const BSY: u32 = 1 << 16;

/// Address in sector 5, which the program of the bench does not reach.
const ADDRESS: u32 = 0x0802_0000;
/// Cycles of 16 us at 16 MHz.
const PROGRAM: u64 = 256;
/// Cycles of a millisecond at 16 MHz.
const MS: u64 = 16_000;

impl Bench {
    fn unlocked(board: Board) -> Bench {
        let mut bench = Bench::after_reset(board);
        bench.write(KEYR, 0x4567_0123);
        bench.write(KEYR, 0xcdef_89ab);
        bench
    }

    fn store(&mut self, address: u32, bytes: u32, value: u32) -> Result<(), Problem> {
        self.devices.store_to_flash(address, bytes, value)
    }

    fn word(&self, address: u32) -> u32 {
        let mut bytes = [0; 4];
        self.machine.read(address, &mut bytes).unwrap();
        let kept = self.devices.flash_contents().0.read(address, 4).unwrap();
        assert_eq!(bytes, kept, "the machine and the contents agree");
        u32::from_le_bytes(bytes)
    }

    /// Programs a word and waits for it.
    fn program(&mut self, address: u32, value: u32) {
        self.write(CR, PG | WORDS);
        self.store(address, 4, value).unwrap();
        self.pass(PROGRAM);
    }
}

#[test]
fn flash_is_locked_until_both_keys_and_a_wrong_key_locks_until_a_reset() {
    let mut bench = Bench::after_reset(Board::Stm32f407gDisc1);
    assert_eq!(bench.read(CR), LOCK);
    bench.write(CR, PG);
    assert_eq!(bench.read(CR), LOCK, "a write to a locked register has no effect");
    assert!(bench.devices.recording.warnings[0].contains("FLASH_CR is written while it is locked"));
    bench.write(KEYR, 0x4567_0123);
    assert_eq!(bench.read(CR), LOCK);
    bench.write(KEYR, 0xcdef_89ab);
    assert_eq!(bench.read(CR), 0);
    bench.write(CR, LOCK | PG);
    assert_eq!(bench.read(CR), LOCK | PG);
    let refused = bench.try_write(KEYR, 0xcdef_89ab).unwrap_err().to_string();
    assert!(refused.contains("is not the next key"), "{refused}");
    assert!(bench.try_write(KEYR, 0x4567_0123).is_err());
    assert!(bench.try_write(KEYR, 0xcdef_89ab).is_err());
    assert_ne!(bench.read(CR) & LOCK, 0);
    bench.devices.reset(crate::devices::rcc::ResetCause::Software, 0);
    bench.write(KEYR, 0x4567_0123);
    bench.write(KEYR, 0xcdef_89ab);
    assert_eq!(bench.read(CR), 0);
}

#[test]
fn flash_word_is_there_after_16_us_and_busy_until_then() {
    let mut bench = Bench::unlocked(Board::BlackpillF411);
    bench.write(CR, PG | WORDS | EOPIE);
    bench.store(ADDRESS, 4, 0x1234_5678).unwrap();
    assert_eq!((bench.read(SR), bench.word(ADDRESS)), (BSY, 0xffff_ffff));
    assert!(bench.store(ADDRESS + 4, 4, 0).is_err(), "one operation at a time");
    bench.pass(PROGRAM - 1);
    assert_eq!((bench.read(SR), bench.devices.lines()), (BSY, 0));
    bench.pass(1);
    assert_eq!((bench.read(SR), bench.word(ADDRESS)), (1, 0x1234_5678));
    assert_eq!(bench.devices.lines(), 1 << 4);
    bench.write(SR, 1);
    assert_eq!((bench.read(SR), bench.devices.lines()), (0, 0));
    bench.program(ADDRESS + 4, 7);
    assert_eq!(bench.read(SR), 0, "EOP takes EOPIE");
}

#[test]
fn flash_erase_takes_the_time_of_its_sector_and_parallelism_and_wears() {
    for (times, sector, psize, ms) in [
        (FlashTimes::Typical, 1, 2, 250),
        (FlashTimes::Typical, 4, 2, 550),
        (FlashTimes::Typical, 5, 0, 2000),
        (FlashTimes::Maximum, 5, 2, 2000),
        (FlashTimes::Maximum, 5, 0, 4000),
    ] {
        let mut bench = Bench::unlocked(Board::Stm32f407gDisc1);
        let memory = bench.devices.flash_contents().0.clone();
        bench.devices.insert_flash(memory, Vec::new(), times, &[]);
        bench.write(KEYR, 0x4567_0123);
        bench.write(KEYR, 0xcdef_89ab);
        let setting = SER | sector << 3 | psize << 8;
        bench.write(CR, setting);
        bench.write(CR, setting | STRT);
        assert_eq!((bench.read(SR), bench.read(CR)), (BSY, setting | STRT));
        bench.pass(ms * MS - 1);
        assert_eq!(bench.read(SR), BSY, "{times:?} {sector} {psize}");
        bench.pass(1);
        assert_eq!((bench.read(SR), bench.read(CR)), (0, setting));
        let erases = bench.devices.flash_contents().0.erases();
        assert_eq!(erases.iter().sum::<u32>(), 1);
        assert_eq!(erases[sector as usize], 1);
    }
}

#[test]
fn flash_erase_sets_all_bits_of_its_sector_and_no_others() {
    let mut bench = Bench::unlocked(Board::Stm32f407gDisc1);
    for address in [ADDRESS - 4, ADDRESS, ADDRESS + 0x1_fffc, ADDRESS + 0x2_0000] {
        bench.program(address, 0x55);
    }
    bench.write(CR, SER | WORDS | 5 << 3 | STRT);
    bench.pass(1000 * MS);
    assert_eq!([ADDRESS, ADDRESS + 0x1_fffc].map(|address| bench.word(address)), [u32::MAX; 2]);
    assert_eq!([ADDRESS - 4, ADDRESS + 0x2_0000].map(|address| bench.word(address)), [0x55; 2]);
}

#[test]
fn flash_bits_only_become_zero_and_a_lost_one_is_warned_of() {
    let mut bench = Bench::unlocked(Board::Stm32f407gDisc1);
    bench.program(ADDRESS, 0xffff_00ff);
    bench.program(ADDRESS, 0x00ff_00ff);
    assert_eq!(bench.word(ADDRESS), 0x00ff_00ff);
    assert!(bench.devices.recording.warnings.is_empty(), "bits that become 0 are in order");
    bench.program(ADDRESS, 0xff00_00ff);
    assert_eq!(bench.word(ADDRESS), 0x0000_00ff);
    assert!(bench.devices.recording.warnings[0].contains("becomes 1 only by"));
}

#[test]
fn flash_errors_set_the_flags_of_the_manual_and_change_nothing() {
    let mut bench = Bench::unlocked(Board::Stm32f407gDisc1);
    bench.write(CR, WORDS);
    bench.store(ADDRESS, 4, 0).unwrap();
    assert_eq!(bench.read(SR), 1 << 7, "PGSERR: PG is not set");
    bench.write(SR, 1 << 7);
    bench.write(CR, PG | WORDS | ERRIE);
    bench.store(ADDRESS, 1, 0).unwrap();
    assert_eq!(bench.read(SR), 1 << 6 | 1 << 1, "PGPERR: a byte with a parallelism of words");
    assert_eq!(bench.devices.lines(), 1 << 4);
    bench.write(SR, u32::MAX);
    assert_eq!((bench.read(SR), bench.devices.lines(), bench.word(ADDRESS)), (0, 0, u32::MAX));

    // Bytes and half-words have parallelisms of their own.
    bench.write(CR, PG);
    bench.store(ADDRESS, 1, 0x11).unwrap();
    bench.pass(PROGRAM);
    bench.write(CR, PG | 1 << 8);
    bench.store(ADDRESS + 2, 2, 0x2233).unwrap();
    bench.pass(PROGRAM);
    assert_eq!((bench.read(SR), bench.word(ADDRESS)), (0, 0x2233_ff11));
}

#[test]
fn flash_misuse_that_no_flag_tells_ends_the_run() {
    let mut bench = Bench::after_reset(Board::BlackpillF411);
    assert!(bench.store(ADDRESS, 4, 0).unwrap_err().to_string().contains("locked"));
    let mut bench = Bench::unlocked(Board::BlackpillF411);
    let memory = bench.devices.flash_contents().0.clone();
    bench.devices.insert_flash(memory, vec![(0x0802_0100, 100)], FlashTimes::Typical, &[]);
    bench.write(KEYR, 0x4567_0123);
    bench.write(KEYR, 0xcdef_89ab);
    for (control, reason) in [
        (SER | 8 << 3 | WORDS | STRT, "has no such sector"),
        (SER | 5 << 3 | WORDS | STRT, "contains the program"),
        (SER | 6 << 3 | 3 << 8 | STRT, "64 bits"),
        (1 << 2 | WORDS | STRT, "mass erase"),
        (WORDS | STRT, "neither SER nor MER"),
        (SER | PG | WORDS | STRT, "more than one"),
    ] {
        let refused = bench.try_write(CR, control).unwrap_err().to_string();
        assert!(refused.contains(reason), "{control:#x}: {refused}");
    }
    bench.write(CR, PG | WORDS);
    for (address, reason) in
        [(0x0808_0000, "no flash there"), (0x0802_0160, "overwrites itself"), (0x0802_00fc + 4, "overwrites itself")]
    {
        let refused = bench.store(address, 4, 0).unwrap_err().to_string();
        assert!(refused.contains(reason), "{address:#x}: {refused}");
    }
    bench.program(0x0802_00fc, 0);
    bench.program(0x0802_0164, 0);
}

#[test]
fn option_bytes_keep_a_brown_out_level_over_a_reset_and_protect_sectors() {
    let mut bench = Bench::unlocked(Board::Stm32f407gDisc1);
    assert_eq!(bench.read(OPTCR), 0x0fff_aaed, "as the factory leaves them");
    bench.write(OPTKEYR, 0x0819_2a3b);
    bench.write(OPTKEYR, 0x4c5d_6e7f);
    // Brown-out level 3, and sector 5 protected.
    let options = 0x0fdf_aae0;
    bench.write(OPTCR, options);
    bench.write(OPTCR, options | 1 << 1);
    assert_eq!(bench.read(SR), BSY);
    bench.pass(250 * MS);
    assert_eq!((bench.read(SR), bench.read(OPTCR)), (0, options));
    bench.devices.reset(crate::devices::rcc::ResetCause::Software, 0);
    assert_eq!(bench.read(OPTCR), options | 1, "locked");
    assert_eq!(bench.devices.flash_contents().0.options(), options | 1);

    bench.write(KEYR, 0x4567_0123);
    bench.write(KEYR, 0xcdef_89ab);
    bench.write(CR, PG | WORDS);
    bench.store(ADDRESS, 4, 0).unwrap();
    assert_eq!(bench.read(SR), 1 << 4, "WRPERR");
    bench.write(SR, 1 << 4);
    bench.write(CR, SER | WORDS | 5 << 3 | STRT);
    assert_eq!(bench.read(SR), 1 << 4, "WRPERR");
    bench.write(OPTKEYR, 0x0819_2a3b);
    bench.write(OPTKEYR, 0x4c5d_6e7f);
    assert!(bench.try_write(OPTCR, 0x0fff_55ee).is_err(), "read protection");
}

#[test]
fn operation_that_is_to_fail_raises_a_flag_and_the_others_go_on() {
    let mut bench = Bench::after_reset(Board::Stm32f407gDisc1);
    let memory = bench.devices.flash_contents().0.clone();
    bench.devices.insert_flash(memory, Vec::new(), FlashTimes::Typical, &[Fault::FlashError { nth: 1 }]);
    bench.write(KEYR, 0x4567_0123);
    bench.write(KEYR, 0xcdef_89ab);
    let flags = [0, 4, 8].map(|offset| {
        bench.program(ADDRESS + offset, offset);
        let flags = bench.read(SR);
        bench.write(SR, flags);
        flags
    });
    assert_eq!(flags, [0, 1 << 4, 0]);
    assert_eq!([0, 4, 8].map(|offset| bench.word(ADDRESS + offset)), [0, u32::MAX, 8]);
    let endings = bench.devices.flash_contents().1.operations.iter().map(|operation| operation.ending);
    assert_eq!(endings.collect::<Vec<_>>(), [FlashEnding::Done, FlashEnding::Failed, FlashEnding::Done]);
}

#[test]
fn torn_word_mixes_old_and_new_bits_and_a_torn_sector_is_any_mix() {
    let mut bench = Bench::unlocked(Board::Stm32f407gDisc1);
    bench.program(ADDRESS, 0x00ff_ff0f);
    bench.program(ADDRESS, 0x00f0_f00f);
    bench.write(CR, SER | WORDS | 5 << 3 | STRT);
    bench.pass(1000 * MS);
    let history = bench.devices.flash_contents().1.clone();
    assert_eq!(
        history.operations[1].change,
        FlashChange::Program { address: ADDRESS, bytes: 4, old: 0x00ff_ff0f, new: 0x00f0_f00f }
    );
    assert!(history.before(0).read(ADDRESS, 4) == Some(&[0xff; 4]));
    assert!(history.before(9) == *bench.devices.flash_contents().0, "as it is now");
    let mut words = std::collections::BTreeSet::new();
    let mut erased = std::collections::BTreeSet::new();
    for seed in 0..200 {
        let word = |nth| {
            let bytes = history.torn(nth, seed).unwrap();
            u32::from_le_bytes(*bytes.read(ADDRESS, 4).unwrap().as_array().unwrap())
        };
        // The bits that do not change are what they were.
        assert_eq!(word(1) & !0x000f_0f00, 0x00f0_f00f);
        words.insert(word(1));
        erased.insert(word(2));
        assert_eq!(word(1), word(1), "a seed leaves one content");
        let torn = history.torn(2, seed).unwrap();
        assert!(torn.read(ADDRESS - 4, 4) == Some(&[0xff; 4]) && torn.erases()[5] == 1);
    }
    assert!(words.len() > 50 && erased.len() > 20, "{} and {}", words.len(), erased.len());
    assert!(history.torn(3, 0).is_none());
}
