//! Who calls a function, however indirectly, read from an ELF file that was linked with `--emit-relocs`.

use std::collections::{BTreeMap, BTreeSet};

use addr2line::Context;
use addr2line::gimli::{Dwarf, EndianSlice, LittleEndian, SectionId};
use object::read::elf::ElfFile32;
use object::{Endianness, Object, ObjectSection, ObjectSymbol, RelocationTarget, SectionKind, SymbolKind};

/// The lowest bit of a function's address says that it is Thumb code.
const THUMB: u64 = 1;

/// What the language's own functions are called.
const LANGUAGE: [&str; 2] = ["core::", "__rustc::"];

/// A function by its place in the image.
struct Function {
    start: u64,
    end: u64,
    name: String,
}

/// The places, each as `file:line (function)`, from which the language's own functions (`core::...`) are entered that end in the function
/// whose name contains `callee`. The error is a clause.
pub fn of(bytes: &[u8], callee: &str) -> Result<BTreeSet<String>, String> {
    let elf = ElfFile32::<Endianness>::parse(bytes).map_err(|error| error.to_string())?;
    let functions = functions(&elf);
    let lines = lines(&elf)?;
    let target = functions.iter().position(|f| f.name.contains(callee)).ok_or(format!("it has no `{callee}`"))?;
    let calls = calls(&elf, &functions);
    let (mut places, mut seen, mut waiting) = (BTreeSet::new(), BTreeSet::from([target]), vec![target]);
    while let Some(callee) = waiting.pop() {
        for &(caller, at) in calls.get(&callee).into_iter().flatten() {
            // Until it is nothing of the language: there the panic is written, or a function is used that panics.
            let ours = !LANGUAGE.iter().any(|path| functions[caller].name.starts_with(path));
            if ours {
                places.insert(place(&lines, at, &functions[caller].name, &functions[callee].name));
            } else if seen.insert(caller) {
                waiting.push(caller);
            }
        }
    }
    Ok(places)
}

fn functions(elf: &ElfFile32) -> Vec<Function> {
    let symbols = elf.symbols().filter(|symbol| symbol.kind() == SymbolKind::Text && symbol.size() > 0);
    let function = |symbol: object::read::elf::ElfSymbol32| {
        let start = symbol.address() & !THUMB;
        let name = format!("{:#}", rustc_demangle::demangle(symbol.name().unwrap_or("?")));
        // `<T as core::...>::f` is what the trait is.
        let name = name.trim_start_matches('<').to_owned();
        Function { start, end: start + symbol.size(), name }
    };
    symbols.map(function).collect()
}

/// For each function, who calls it and from where.
fn calls(elf: &ElfFile32, functions: &[Function]) -> BTreeMap<usize, Vec<(usize, u64)>> {
    let by_start: BTreeMap<u64, usize> = functions.iter().enumerate().map(|(i, f)| (f.start, i)).collect();
    let at = |address: u64| {
        let (_, index) = by_start.range(..=address).next_back()?;
        (address < functions[*index].end).then_some(*index)
    };
    let mut calls = BTreeMap::<usize, Vec<(usize, u64)>>::new();
    for section in elf.sections().filter(|section| section.kind() == SectionKind::Text) {
        for (from, relocation) in section.relocations() {
            let RelocationTarget::Symbol(symbol) = relocation.target() else { continue };
            let Ok(symbol) = elf.symbol_by_index(symbol) else { continue };
            if let (Some(caller), Some(callee)) = (at(from), at(symbol.address() & !THUMB)) {
                calls.entry(callee).or_default().push((caller, from));
            }
        }
    }
    calls
}

type Lines<'a> = Context<EndianSlice<'a, LittleEndian>>;

fn lines<'a>(elf: &ElfFile32<'a>) -> Result<Lines<'a>, String> {
    let load = |id: SectionId| -> Result<_, addr2line::gimli::Error> {
        let data = elf.section_by_name(id.name()).and_then(|section| section.data().ok()).unwrap_or_default();
        Ok(EndianSlice::new(data, LittleEndian))
    };
    let dwarf = Dwarf::load(load).and_then(Context::from_dwarf);
    dwarf.map_err(|error| format!("its debug information: {error}"))
}

/// The nearest line that is not the language's own; without lines, the functions.
fn place(lines: &Lines, at: u64, caller: &str, callee: &str) -> String {
    let mut frames = lines.find_frames(at).skip_all_loads().ok();
    while let Some(Ok(Some(frame))) = frames.as_mut().map(|frames| frames.next()) {
        let Some((file, line)) = frame.location.and_then(|l| Some((l.file?, l.line?))) else { continue };
        if !file.contains("/rustc/") && !file.contains("/rustlib/") {
            return format!("{file}:{line} (calls {callee}, in {caller})");
        }
    }
    format!("{caller} (calls {callee})")
}
