//! What a firmware image takes of a board's memory, read from its ELF file.

use object::LittleEndian;
use object::elf::{FileHeader32, SHF_ALLOC, SHF_WRITE, SHT_NOBITS};
use object::read::elf::{ElfFile, SectionHeader};
use object::{Object, ObjectSection, ObjectSymbol};

/// Bytes by use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Image {
    /// Code and constants, in flash.
    pub text: u64,
    /// Variables with a starting value: in flash and, once started, in RAM.
    pub data: u64,
    /// Variables that start at zero, in RAM.
    pub bss: u64,
    /// RAM left to the stack: from the last variable to where the stack starts.
    pub stack_reserved: u64,
}

/// Where cortex-m-rt's linker script says the stack starts; it grows down from there,
const STACK_START: &str = "_stack_start";
/// and where the last variable ends.
const VARIABLES_END: &str = "__sheap";

impl Image {
    /// Sums the sections of a 32-bit ELF file; the error is a clause such as "it has no symbol `x`".
    pub fn read(bytes: &[u8]) -> Result<Self, String> {
        let elf = ElfFile::<FileHeader32<LittleEndian>>::parse(bytes)
            .map_err(|error| format!("it is not a 32-bit little-endian ELF file: {error}"))?;
        let (mut text, mut data, mut bss) = (0, 0, 0);
        for section in elf.sections() {
            let header = section.elf_section_header();
            let flags = header.sh_flags(LittleEndian);
            let sum = if !flags.contains(SHF_ALLOC) {
                continue; // debug information, symbols: not on the board
            } else if header.sh_type(LittleEndian) == SHT_NOBITS {
                &mut bss
            } else if flags.contains(SHF_WRITE) {
                &mut data
            } else {
                &mut text
            };
            *sum += section.size();
        }
        let address = |name: &str| {
            elf.symbols()
                .find(|symbol| symbol.name() == Ok(name))
                .map(|symbol| symbol.address())
                .ok_or_else(|| format!("it has no symbol `{name}`"))
        };
        let stack_reserved =
            address(STACK_START)?.checked_sub(address(VARIABLES_END)?).ok_or("its variables lie above its stack")?;
        Ok(Self { text, data, bss, stack_reserved })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PROGBITS: u32 = 1;
    const SYMTAB: u32 = 2;
    const STRTAB: u32 = 3;
    const NOBITS: u32 = 8;
    const WRITE: u32 = 1;
    const ALLOC: u32 = 2;
    const EXECUTE: u32 = 4;

    fn words(numbers: &[u32]) -> Vec<u8> {
        numbers.iter().flat_map(|n| n.to_le_bytes()).collect()
    }

    /// A little-endian ELF file for Arm with the given sections and two symbols.
    fn elf(sections: &[(u32, u32, u32)], stack_start: u32, variables_end: u32) -> Vec<u8> {
        const HEADER: u32 = 52;
        let names = b"\0_stack_start\0__sheap\0";
        // Each symbol: name, value, size, then binding/visibility/section (absolute, global).
        let absolute = u32::from_le_bytes([0x10, 0, 0xf1, 0xff]);
        let symbols =
            [words(&[0, 0, 0, 0]), words(&[1, stack_start, 0, absolute]), words(&[14, variables_end, 0, absolute])]
                .concat();
        let loaded: u32 = sections.iter().filter(|(kind, ..)| *kind != NOBITS).map(|(.., size)| size).sum();
        let symbols_at = HEADER + loaded;
        let names_at = symbols_at + symbols.len() as u32;
        let headers_at = names_at + names.len() as u32;
        let count = sections.len() as u16 + 3;

        let mut file = b"\x7fELF\x01\x01\x01\0\0\0\0\0\0\0\0\0".to_vec();
        file.extend([2, 0, 40, 0]); // executable, Arm
        file.extend(words(&[1, 0, 0, headers_at, 0]));
        for half in [HEADER as u16, 0, 0, 40, count, count - 1] {
            file.extend(half.to_le_bytes());
        }
        file.resize(symbols_at as usize, 0);
        file.extend(symbols);
        file.extend(names);

        // Name, type, flags, address, offset, size, link, info, alignment, entry size.
        file.extend(words(&[0; 10]));
        let mut offset = HEADER;
        for &(kind, flags, size) in sections {
            file.extend(words(&[0, kind, flags, 0, offset, size, 0, 0, 1, 0]));
            offset += if kind == NOBITS { 0 } else { size };
        }
        let string_table = u32::from(count) - 1;
        file.extend(words(&[0, SYMTAB, 0, 0, symbols_at, 48, string_table, 1, 4, 16]));
        file.extend(words(&[0, STRTAB, 0, 0, names_at, names.len() as u32, 0, 0, 1, 0]));
        file
    }

    #[test]
    fn sections_are_summed_by_use() {
        let file = elf(
            &[
                (PROGBITS, ALLOC, 64),             // vector table
                (PROGBITS, ALLOC | EXECUTE, 1000), // code
                (PROGBITS, ALLOC, 200),            // constants
                (PROGBITS, ALLOC | WRITE, 24),     // data
                (NOBITS, ALLOC | WRITE, 500),      // bss
                (NOBITS, ALLOC | WRITE, 12),       // uninit
                (PROGBITS, 0, 4000),               // debug information
            ],
            0x2000_4000,
            0x2000_0400,
        );
        assert_eq!(Image::read(&file), Ok(Image { text: 1264, data: 24, bss: 512, stack_reserved: 0x3c00 }));
    }

    #[test]
    fn what_is_no_firmware_is_told_so() {
        assert!(Image::read(b"#!/bin/sh").unwrap_err().contains("ELF"));
        let mut unnamed = elf(&[], 0, 0);
        let name = unnamed.windows(7).position(|w| w == b"__sheap").unwrap();
        unnamed[name] = b'x';
        assert_eq!(Image::read(&unnamed), Err("it has no symbol `__sheap`".to_owned()));
        let crossed = elf(&[], 0x2000_0000, 0x2000_0001);
        assert!(Image::read(&crossed).is_err());
    }
}
