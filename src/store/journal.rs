//! Row groups that outlive the death of whoever wrote them.
//!
//! A table that takes long to compute grows under a name of its own, `NAME.part`, and beside it a journal,
//! `NAME.journal.part`, gets a line for every row group that is on the disk: what a footer would say of it. After a
//! death, that of the machine included, the table is cut off after the last row group that journal and checksum
//! agree on, gets its footer, and is a table like any other, of the rows that were done.

use super::atomic::{AtomicFile, cannot_write, sync_directory};
use super::checksums::{self, MAGIC};
use super::footer::Footer;
use crate::error::{Error, Result};
use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The journal of a table under way.
#[derive(Debug)]
pub(super) struct Journal {
    table: PathBuf,
    file: Option<File>,
}

/// The name of something beside a table.
fn beside(table: &Path, ending: &str) -> PathBuf {
    let mut name = table.file_name().unwrap_or_default().to_owned();
    name.push(ending);
    table.with_file_name(name)
}

fn part(table: &Path) -> PathBuf {
    beside(table, ".part")
}

fn journal(table: &Path) -> PathBuf {
    beside(table, ".journal.part")
}

impl Journal {
    /// Begins anew: what an earlier journal says is no longer true once the table under its name is begun again.
    pub(super) fn new(table: &Path) -> Result<Self> {
        remove(&journal(table))?;
        Ok(Journal { table: table.to_owned(), file: None })
    }

    /// The name under which the table grows.
    pub(super) fn part(&self) -> PathBuf {
        part(&self.table)
    }

    /// Notes the last row group of a footer, once the table's file is on the disk up to its end.
    pub(super) fn note(&mut self, table: &mut AtomicFile, footer: &Footer) -> Result<()> {
        let path = journal(&self.table);
        let fail = |reason: &dyn std::fmt::Display| cannot_write(&path, reason);
        table.sync().map_err(|reason| cannot_write(&self.table, reason))?;
        let mut text = String::new();
        let (file, begun) = match &mut self.file {
            Some(file) => (file, true),
            None => {
                text = footer.first_line().map_err(|reason| fail(&reason))?;
                let file = File::create(&path).map_err(|reason| fail(&reason))?;
                (self.file.insert(file), false)
            }
        };
        text += &footer.last_line().map_err(|reason| fail(&reason))?;
        let written = file.write_all(text.as_bytes()).and_then(|()| file.sync_data());
        written.map_err(|reason| fail(&reason))?;
        if !begun {
            sync_directory(&path).map_err(|reason| fail(&reason))?;
        }
        table.keep();
        Ok(())
    }

    /// Ends with the table, which has its name now.
    pub(super) fn close(self) -> Result<()> {
        sync_directory(&self.table).map_err(|reason| cannot_write(&self.table, reason))?;
        drop(self.file);
        remove(&journal(&self.table))
    }
}

/// A table that its writer did not finish.
#[derive(Debug)]
pub struct UnfinishedTable {
    table: PathBuf,
}

impl UnfinishedTable {
    /// Looks for the unfinished table that would have become `table`, and makes what was done of it readable. What
    /// holds no row group is removed. The caller sees to it that nobody is writing it.
    ///
    /// # Errors
    /// If it cannot be read, cut off or removed.
    pub fn recover(table: &Path) -> Result<Option<Self>> {
        let found = UnfinishedTable { table: table.to_owned() };
        let Some(mut footer) = read(&journal(table))?.and_then(|t| Footer::from_journal(&t)) else {
            found.discard()?;
            return Ok(None);
        };
        let path = part(table);
        let mut file = match OpenOptions::new().read(true).write(true).open(&path) {
            Ok(file) => file,
            Err(reason) if reason.kind() == ErrorKind::NotFound => {
                found.discard()?;
                return Ok(None);
            }
            Err(reason) => return Err(cannot_recover(&path, &reason)),
        };
        let mut start = MAGIC.len() as u64;
        let mut matches = |end: u64, sha256: &str| {
            let bytes: Range<u64> = start..end;
            start = end;
            checksums::digest(&mut file, bytes).is_ok_and(|found| found == sha256)
        };
        let whole = footer.sums().iter().take_while(|sum| matches(sum.end, &sum.sha256)).count();
        let whole = if begins_right(&mut file) { whole } else { 0 };
        footer.truncate(whole);
        if whole == 0 {
            drop(file);
            found.discard()?;
            return Ok(None);
        }
        let bytes = footer.bytes().map_err(|reason| cannot_recover(&path, &reason))?;
        let mended = file
            .set_len(footer.end())
            .and_then(|()| file.seek(SeekFrom::End(0)))
            .and_then(|_| file.write_all(&bytes))
            .and_then(|()| file.sync_all());
        mended.map_err(|reason| cannot_recover(&path, &reason))?;
        Ok(Some(found))
    }

    /// Where the rows that were done can be read.
    pub fn path(&self) -> PathBuf {
        part(&self.table)
    }

    /// Gives it the name that it was to have, in place of what has that now.
    ///
    /// # Errors
    /// If it cannot be renamed.
    pub fn adopt(self) -> Result<()> {
        let named = fs::rename(part(&self.table), &self.table);
        named
            .and_then(|()| sync_directory(&self.table))
            .map_err(|reason| cannot_write(&self.table, reason))?;
        remove(&journal(&self.table))
    }

    /// Removes it.
    ///
    /// # Errors
    /// If it cannot be removed.
    pub fn discard(self) -> Result<()> {
        // The journal first: without it, what is left is nothing.
        remove(&journal(&self.table))?;
        remove(&part(&self.table))
    }
}

/// Whether a file begins as Parquet does.
fn begins_right(file: &mut File) -> bool {
    let mut magic = [0; MAGIC.len()];
    file.rewind().and_then(|()| file.read_exact(&mut magic)).is_ok() && magic == MAGIC
}

fn cannot_recover(path: &Path, reason: &dyn std::fmt::Display) -> Error {
    Error::file(path, "recover", reason, "run without --resume to begin anew")
}

fn read(path: &Path) -> Result<Option<Vec<u8>>> {
    match fs::read(path) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(reason) if reason.kind() == ErrorKind::NotFound => Ok(None),
        Err(reason) => Err(cannot_recover(path, &reason)),
    }
}

fn remove(path: &Path) -> Result<()> {
    match fs::remove_file(path) {
        Err(reason) if reason.kind() != ErrorKind::NotFound => {
            Err(Error::file(path, "remove", reason, "move it away"))
        }
        _ => Ok(()),
    }
}
