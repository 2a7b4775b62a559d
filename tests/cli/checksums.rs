//! Damage to a table: every byte of it is under a checksum, in a whole table and in one whose writer died.

use super::program::Place;
use reeldown::campaign::{Ensemble, Progress, sampler};
use reeldown::numerics::columns::Columns;
use reeldown::outcomes::OutcomeTable;
use reeldown::store::{
    Field, OutcomesReader, OutcomesWriter, Parentage, UnfinishedTable, read_number_column,
    write_table,
};
use reeldown::study::Study;
use std::path::{Path, PathBuf};

/// Samples of each row group.
const GROUPS: [usize; 3] = [17, 20, 5];

/// A study of the shipped card, and its first samples.
fn samples() -> (Study, Vec<OutcomeTable>) {
    let study = Study::load(None, &[]).expect("the embedded study");
    let (sampler, ensemble) = (sampler(&study).expect("a sampler"), Ensemble::new(&study));
    let mut first = 0;
    let group = |rows: usize| {
        let mut points = Columns::new(rows, ensemble.dimension());
        sampler.fill(first, &mut points).expect("points");
        let mut table = ensemble.at_uniform(&points, &Progress::default());
        table.first = first;
        first += rows as u64;
        table
    };
    let tables = GROUPS.into_iter().map(group).collect();
    (study, tables)
}

fn parents() -> Parentage {
    // Entries of the lengths that a real footer has.
    let entries = [("version", "1".to_owned()), ("texts", "a card ".repeat(60))];
    Parentage(entries.into_iter().map(|(key, text)| (key.to_owned(), text)).collect())
}

/// Starts a table and writes row groups.
fn begun(path: &Path, study: &Study, tables: &[OutcomeTable]) -> OutcomesWriter {
    let mut writer = OutcomesWriter::create(path, study, &parents()).expect("a writable place");
    for table in tables {
        writer.write(std::slice::from_ref(table)).expect("space");
    }
    writer
}

/// A whole table of these row groups.
fn whole(place: &Place, name: &str, study: &Study, tables: &[OutcomeTable]) -> Vec<u8> {
    let path = place.path().join(name);
    begun(&path, study, tables).finish().expect("space");
    place.bytes(name)
}

/// Reads all of a table that has the rows of the first `groups` row groups, one by one.
fn read(path: &Path, study: &Study, tables: &[OutcomeTable]) -> Result<(), String> {
    let reader = OutcomesReader::open(path).map_err(|error| error.to_string())?;
    assert_eq!(reader.rows() as usize, tables.iter().map(OutcomeTable::rows).sum::<usize>());
    for table in tables {
        let found = reader.read(study, table.first, table.rows());
        let found = found.map_err(|error| error.to_string())?;
        assert_eq!((&found.inputs, &found.outcomes), (&table.inputs, &table.outcomes));
    }
    Ok(())
}

/// Where the row groups end in a file: what a table of fewer of them has before its footer.
fn ends(place: &Place, study: &Study, tables: &[OutcomeTable]) -> Vec<usize> {
    let end = |groups: usize| {
        let bytes = whole(place, "fewer.parquet", study, &tables[..groups]);
        let length = bytes[bytes.len() - 8..][..4].try_into().expect("four bytes");
        bytes.len() - 8 - u32::from_le_bytes(length) as usize
    };
    (1..=tables.len()).map(end).collect()
}

#[test]
fn property_no_byte_of_a_table_changes_unnoticed() {
    let place = Place::new("flipped");
    let (study, tables) = samples();
    let good = whole(&place, "good.parquet", &study, &tables);
    let path = place.path().join("bad.parquet");
    read(&place.path().join("good.parquet"), &study, &tables).expect("a good table");
    let ends = ends(&place, &study, &tables);
    let data = 4..*ends.last().expect("groups");
    for at in 0..good.len() {
        let mut bad = good.clone();
        bad[at] ^= 1 << (at % 8);
        std::fs::write(&path, &bad).expect("a writable place");
        let Err(said) = read(&path, &study, &tables) else { panic!("byte {at} was believed") };
        assert!(said.contains("bad.parquet"), "{at}: {said}");
        if data.contains(&at) {
            // The place is named, and the groups before it can still be read.
            let group = ends.iter().position(|&end| at < end).expect("a group");
            let first = tables[group].first;
            let last = first + GROUPS[group] as u64 - 1;
            let place = format!("row group {group} (rows {first} to {last}) is damaged");
            assert!(said.contains(&place), "{at}: {said}");
        }
    }
}

#[test]
fn property_a_table_that_is_cut_padded_or_rearranged_is_refused() {
    let place = Place::new("rearranged");
    let (study, tables) = samples();
    let good = whole(&place, "good.parquet", &study, &tables);
    let path = place.path().join("bad.parquet");
    let ends = ends(&place, &study, &tables);
    let refused = |bytes: &[u8], what: &str| {
        std::fs::write(&path, bytes).expect("a writable place");
        assert!(read(&path, &study, &tables).is_err(), "{what} was believed");
    };
    for length in 0..good.len() {
        refused(&good[..length], &format!("a table cut after {length} bytes"));
    }
    for at in [0, 4, ends[0], ends[2], good.len()] {
        let longer = [&good[..at], &[0; 16], &good[at..]].concat();
        refused(&longer, &format!("16 bytes put in at {at}"));
        let zeros = at.min(good.len() - 64);
        let mut blank = good.clone();
        blank[zeros..zeros + 64].fill(0);
        refused(&blank, &format!("64 zeros from {zeros}"));
    }
    // The data of one table under the footer of another: two writers of one file would leave that.
    let (_, mut others) = samples();
    others[1].outcomes.column_mut(0)[3] += 1.0;
    let other = whole(&place, "other.parquet", &study, &others);
    let end = ends[2];
    assert_eq!(good.len(), other.len());
    refused(&[&good[..end], &other[end..]].concat(), "another table's footer");
}

#[test]
fn property_small_tables_are_verified_too() {
    let place = Place::new("small");
    let path = place.path().join("small.parquet");
    let column = vec![("x".to_owned(), Field::Number(vec![Some(1.0), Some(2.5), Some(4.0)]))];
    write_table(&path, column, parents().entries()).expect("a writable place");
    assert_eq!(read_number_column(&path, "x"), Ok(vec![1.0, 2.5, 4.0]));
    let good = place.bytes("small.parquet");
    for at in 0..good.len() {
        let mut bad = good.clone();
        bad[at] ^= 1 << (at % 8);
        std::fs::write(&path, &bad).expect("a writable place");
        assert!(read_number_column(&path, "x").is_err(), "byte {at} was believed");
    }
}

/// A table whose writer died, as its two files.
struct Dead {
    place: Place,
    study: Study,
    tables: Vec<OutcomeTable>,
    table: PathBuf,
    part: Vec<u8>,
    journal: Vec<u8>,
}

impl Dead {
    fn new(name: &str) -> Dead {
        let place = Place::new(name);
        let (study, tables) = samples();
        let table = place.path().join("t.parquet");
        drop(begun(&table, &study, &tables));
        let (part, journal) =
            (place.bytes("t.parquet.part"), place.bytes("t.parquet.journal.part"));
        assert!(!table.exists());
        Dead { place, study, tables, table, part, journal }
    }

    /// How many row groups are found in what is left, all of them right to the last bit; `None` is no table.
    fn recovered(&self, part: &[u8], journal: &[u8]) -> Option<usize> {
        self.place.write("t.parquet.part", part);
        self.place.write("t.parquet.journal.part", journal);
        let left = UnfinishedTable::recover(&self.table).expect("files that can be read");
        let groups = left.map(|left| {
            let rows = OutcomesReader::open(&left.path()).expect("a table").rows() as usize;
            let sums = GROUPS.iter().scan(0, |sum, rows| {
                *sum += rows;
                Some(*sum)
            });
            let groups = 1 + sums.into_iter().position(|sum| sum == rows).expect("whole groups");
            left.adopt().expect("a writable place");
            read(&self.table, &self.study, &self.tables[..groups]).expect("what was written");
            groups
        });
        // Nothing lies about, and a table of them is the one that a writer of so many would have ended with.
        assert_eq!(self.place.unfinished(), Vec::<PathBuf>::new());
        if let Some(groups) = groups {
            let found = self.place.bytes("t.parquet");
            std::fs::remove_file(&self.table).expect("it is there");
            let kept = &self.tables[..groups];
            assert!(found == whole(&self.place, "kept.parquet", &self.study, kept));
        }
        groups
    }

    /// The offsets after the journal's lines.
    fn lines(&self) -> Vec<usize> {
        let ends = |(at, &byte)| (byte == b'\n').then_some(at + 1);
        self.journal.iter().enumerate().filter_map(ends).collect()
    }
}

#[test]
fn property_what_a_dead_writer_left_is_taken_up_to_its_last_whole_row_group() {
    let dead = Dead::new("dead");
    let ends = ends(&dead.place, &dead.study, &dead.tables);
    let lines = dead.lines();
    assert_eq!(lines.len(), 1 + GROUPS.len());
    let some = |groups: usize| (groups > 0).then_some(groups);
    let before = |places: &[usize], length: usize| places.iter().filter(|&&p| p <= length).count();
    assert_eq!(dead.recovered(&dead.part, &dead.journal), Some(3));
    // A journal or a table that ends anywhere, and near every boundary.
    let near = |places: &[usize], length: usize| -> Vec<usize> {
        let close = places.iter().flat_map(|&p| p - 2..=p + 2);
        let mut all: Vec<usize> = close.chain((0..=length).step_by(131)).collect();
        all.retain(|&at| at <= length);
        all
    };
    for length in near(&lines, dead.journal.len()) {
        let expected = some(before(&lines, length).saturating_sub(1));
        assert_eq!(dead.recovered(&dead.part, &dead.journal[..length]), expected, "{length}");
    }
    for length in near(&ends, dead.part.len()) {
        let expected = some(before(&ends, length));
        assert_eq!(dead.recovered(&dead.part[..length], &dead.journal), expected, "{length}");
    }
    // A row group under way after those that the journal knows of.
    let longer = [&dead.part[..], &[7; 999]].concat();
    assert_eq!(dead.recovered(&longer, &dead.journal), Some(3));
}

#[test]
fn property_damage_to_what_a_dead_writer_left_costs_the_row_groups_from_there_on() {
    let dead = Dead::new("dead-damaged");
    let ends = ends(&dead.place, &dead.study, &dead.tables);
    let lines = dead.lines();
    let some = |groups: usize| (groups > 0).then_some(groups);
    let before = |places: &[usize], at: usize| places.iter().filter(|&&p| p <= at).count();
    for at in (0..4).chain((4..dead.part.len()).step_by(37)) {
        let mut bad = dead.part.clone();
        bad[at] ^= 1 << (at % 8);
        // Without its magic word it is no table at all.
        let expected = if at < 4 { None } else { some(before(&ends, at)) };
        assert_eq!(dead.recovered(&bad, &dead.journal), expected, "byte {at}");
    }
    for at in (0..dead.journal.len()).step_by(37) {
        let mut bad = dead.journal.clone();
        bad[at] ^= 1 << (at % 8);
        let expected = some(before(&lines, at).saturating_sub(1));
        assert_eq!(dead.recovered(&dead.part, &bad), expected, "byte {at} of the journal");
    }
}
