//! Parquet files as other programs write them, as hostile ones do, and at random.

use reeldown::store::PARQUET;
use std::path::{Path, PathBuf};

const ROWS: usize = 60;

fn files() -> Vec<PathBuf> {
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/study/parquet");
    let entries = std::fs::read_dir(directory).expect("a directory");
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    files.sort();
    files
}

/// What `references/parquet_files.py` wrote in row `k` of a column of numbers.
fn number_of(column: &str, k: usize) -> Option<f64> {
    let row = k as f64;
    Some(match column {
        "double" => 0.0015 + row * 1e-7,
        "single" => row / 8.0,
        "half" => (row - 30.0) / 4.0,
        "int8" => row - 30.0,
        "uint8" => 255.0 - row,
        "int16" => row - 32768.0,
        "int32" => row * row - 7.0,
        "uint32" => 4_294_967_295.0 - row,
        "int64" => (row - 30.0) * 1e12,
        "uint64" => (u64::MAX - k as u64 * (1 << 20)) as f64,
        "decimal" => format!("0.0{}", 620 + k).parse().expect("a number"),
        "wide" => format!("-{}e-20", 3 * k).parse().expect("a number"),
        "missing" => return (k % 7 != 3).then_some(row),
        "few" => (k / 9) as f64 * 0.25,
        other => panic!("{other} holds no numbers"),
    })
}

#[test]
fn reference_pyarrows_files_hold_what_it_wrote() {
    let files = files();
    assert_eq!(files.len(), 6);
    for file in files {
        let name = file.file_stem().expect("a name").to_string_lossy().into_owned();
        let columns = (PARQUET.table)(&std::fs::read(&file).expect("bytes")).expect(&name);
        assert_eq!(columns.len(), 22, "{name}");
        let mut numbers = 0;
        for (column, values) in columns {
            match values {
                Ok(values) => {
                    numbers += 1;
                    let expected: Vec<_> = (0..ROWS).map(|k| number_of(&column, k)).collect();
                    assert_eq!(values, expected, "{name}: {column}");
                }
                Err(reason) => {
                    let expected = match column.as_str() {
                        "day" => "it holds dates, not numbers",
                        "pair" | "list" => "it is nested, not numbers",
                        "text" => "it holds text, not numbers",
                        "flag" => "it holds true and false, not numbers",
                        "never" => "it holds no values, not numbers",
                        "clock" => "it holds times of a clock, not numbers",
                        "bytes" => "it holds bytes, not numbers",
                        other => panic!("{name}: {other}: {reason}"),
                    };
                    assert_eq!(reason, expected, "{name}: {column}");
                }
            }
        }
        assert_eq!(numbers, 14, "{name}");
    }
}

/// A value of Thrift's compact protocol, to write files that no library would.
enum Thrift {
    Whole(i64),
    Text(&'static str),
    /// A list of structures, and the number of them that it claims.
    List(Vec<Fields>, u64),
    Struct(Fields),
}

type Fields = Vec<(u8, Thrift)>;

fn varint(mut value: u64, out: &mut Vec<u8>) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

fn structure(fields: &Fields, out: &mut Vec<u8>) {
    let mut before = 0;
    for (id, value) in fields {
        let kind = match value {
            Thrift::Whole(_) => 6,
            Thrift::Text(_) => 8,
            Thrift::List(..) => 9,
            Thrift::Struct(_) => 12,
        };
        out.push((id - before) << 4 | kind);
        before = *id;
        match value {
            Thrift::Whole(number) => varint((number << 1 ^ number >> 63) as u64, out),
            Thrift::Text(text) => {
                varint(text.len() as u64, out);
                out.extend(text.as_bytes());
            }
            Thrift::List(items, claimed) => {
                out.push(0xfc);
                varint(*claimed, out);
                items.iter().for_each(|item| structure(item, out));
            }
            Thrift::Struct(fields) => structure(fields, out),
        }
    }
    out.push(0);
}

/// A file of these pages and a footer.
fn file(pages: &[u8], footer: &[u8]) -> Vec<u8> {
    let length = (footer.len() as u32).to_le_bytes();
    [b"PAR1", pages, footer, &length, b"PAR1"].concat()
}

/// The schema of one column of doubles called `x`, which is all there is.
fn one_column() -> Thrift {
    let root = vec![(4, Thrift::Text("root")), (5, Thrift::Whole(1))];
    let x = vec![(1, Thrift::Whole(5)), (3, Thrift::Whole(0)), (4, Thrift::Text("x"))];
    Thrift::List(vec![root, x], 2)
}

/// A footer of one row group whose chunk of `rows` values lies in `length` bytes behind the magic word.
fn footer(schema: Thrift, rows: i64, length: i64) -> Vec<u8> {
    let about = vec![
        (1, Thrift::Whole(5)),
        (4, Thrift::Whole(0)),
        (5, Thrift::Whole(rows)),
        (7, Thrift::Whole(length)),
        (9, Thrift::Whole(4)),
    ];
    let chunk = vec![(3, Thrift::Struct(about))];
    let group = vec![(1, Thrift::List(vec![chunk], 1)), (3, Thrift::Whole(rows))];
    let mut bytes = Vec::new();
    let fields = vec![(2, schema), (3, Thrift::Whole(rows)), (4, Thrift::List(vec![group], 1))];
    structure(&fields, &mut bytes);
    bytes
}

/// A page of a kind, with the structure that tells about it, and its bytes.
fn page(kind: i64, about: (u8, Fields), bytes: &[u8]) -> Vec<u8> {
    let size = Thrift::Whole(bytes.len() as i64);
    let again = Thrift::Whole(bytes.len() as i64);
    let mut page = Vec::new();
    let fields =
        vec![(1, Thrift::Whole(kind)), (2, size), (3, again), (about.0, Thrift::Struct(about.1))];
    structure(&fields, &mut page);
    page.extend(bytes);
    page
}

fn reason(bytes: &[u8]) -> String {
    match (PARQUET.table)(bytes) {
        Err(reason) => reason,
        Ok(columns) => columns
            .into_iter()
            .find_map(|(_, values)| values.err())
            .expect("one column that cannot be read"),
    }
}

#[test]
fn analytic_a_file_made_by_hand_is_read() {
    let counted = |count| vec![(1, Thrift::Whole(count)), (2, Thrift::Whole(0))];
    let numbers: Vec<u8> = [1.5f64, -2.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    let page = page(0, (5, counted(2)), &numbers);
    let bytes = file(&page, &footer(one_column(), 2, page.len() as i64));
    let columns = (PARQUET.table)(&bytes).expect("a table");
    assert_eq!(columns, [("x".to_owned(), Ok(vec![Some(1.5), Some(-2.0)]))]);
}

#[test]
fn property_a_small_file_that_claims_much_is_refused_before_it_is_believed() {
    let damaged = "the file is damaged";
    // Columns, row groups: 2^31 of them in a handful of bytes.
    for field in [2, 4] {
        let mut bytes = Vec::new();
        structure(&vec![(field, Thrift::List(Vec::new(), 1 << 31))], &mut bytes);
        assert_eq!(reason(&file(&[], &bytes)), damaged);
    }
    // 2^40 values, of which there are none; and 2^28 in one run of six bytes.
    let counted = |count, encoding| vec![(1, Thrift::Whole(count)), (2, Thrift::Whole(encoding))];
    let too_much = "it claims to unpack into more than a thousand times its size";
    for rows in [1 << 40, 1 << 28] {
        let number = 1.0f64.to_le_bytes();
        let mut run = vec![1];
        varint((rows as u64) << 1, &mut run);
        run.push(0);
        let pages =
            [page(2, (7, counted(1, 0)), &number), page(0, (5, counted(rows, 8)), &run)].concat();
        let bytes = file(&pages, &footer(one_column(), rows, pages.len() as i64));
        assert!(bytes.len() < 150);
        assert_eq!(reason(&bytes), too_much);
    }
    // A dictionary of 2^28 numbers, a page of 2^30 bytes, without their bytes.
    let dictionary = page(2, (7, counted(1 << 28, 0)), &[0; 8]);
    let bytes = file(&dictionary, &footer(one_column(), 1, dictionary.len() as i64));
    assert_eq!(reason(&bytes), damaged);
    // A schema nested 100 000 deep, of which the bottom is the column.
    let mut deep = vec![vec![(4, Thrift::Text("root")), (5, Thrift::Whole(1))]];
    deep.extend((0..100_000).map(|_| vec![(4, Thrift::Text("g")), (5, Thrift::Whole(1))]));
    deep.push(vec![(1, Thrift::Whole(5)), (4, Thrift::Text("x"))]);
    let count = deep.len() as u64;
    let bytes = file(&[], &footer(Thrift::List(deep, count), 0, 0));
    assert_eq!(reason(&bytes), "it is nested, not numbers");
    // The same nesting in the protocol itself.
    let nested = [vec![0x1c; 100_000], vec![0; 100_001]].concat();
    assert_eq!(reason(&file(&[], &nested)), damaged);
}

/// Changes that are the same in every run: a linear congruential generator's (Knuth's MMIX).
struct Chance(u64);

impl Chance {
    fn below(&mut self, end: usize) -> usize {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % end
    }
}

#[test]
fn property_no_change_of_a_file_makes_the_reader_panic() {
    let mut chance = Chance(12);
    let originals: Vec<Vec<u8>> =
        files().iter().map(|file| std::fs::read(file).expect("bytes")).collect();
    let (mut refused, mut read) = (0, 0);
    for round in 0..3000 {
        let mut bytes = originals[round % originals.len()].clone();
        for _ in 0..=chance.below(4) {
            let at = match chance.below(2) {
                // The footer and the ends of pages are where the claims are.
                0 => bytes.len() - 1 - chance.below(bytes.len().min(4000)),
                _ => chance.below(bytes.len()),
            };
            match chance.below(4) {
                0 => bytes[at] ^= 1 << chance.below(8),
                1 => bytes[at] = [0, 0x7f, 0x80, 0xff][chance.below(4)],
                2 => bytes[at] = chance.below(256) as u8,
                _ => {
                    let long = chance.below(16).min(bytes.len() - at);
                    bytes.drain(at..at + long);
                    let filling = vec![0xff; if chance.below(2) == 0 { long } else { 0 }];
                    bytes.splice(at..at, filling);
                }
            }
        }
        match (PARQUET.table)(&bytes) {
            Ok(columns) if columns.iter().any(|(_, values)| values.is_ok()) => read += 1,
            _ => refused += 1,
        }
    }
    // Both ends of the door have been used.
    assert!(refused > 300 && read > 300, "{refused} refused, {read} read");
}
