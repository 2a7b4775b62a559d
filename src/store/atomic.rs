//! Files that appear whole under their name, or not at all.

use crate::error::{Error, Result};
use std::ffi::OsStr;
use std::fs::{self, File, TryLockError};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// A file written beside its final name and renamed when it is whole. Dropped before that, it leaves
/// nothing behind, and whatever had the final name is untouched.
///
/// The name that it has meanwhile is its own, `NAME.PROCESS-COUNT.part`, and it is locked: two processes that write
/// one file do not meet, the last one to finish is the one that is read, and what a killed process has left can be
/// told from what another is writing.
#[derive(Debug)]
pub struct AtomicFile {
    path: PathBuf,
    part: PathBuf,
    writer: Option<BufWriter<File>>,
    /// Bytes written since the disk was last waited for.
    pending: usize,
    /// Whether it is left under its part's name if it is dropped.
    kept: bool,
}

/// Bytes after which the disk is waited for. A large file is then on the disk bit by bit, beside whatever other
/// threads compute, instead of all at once when it is committed and everybody waits.
const SYNC_BYTES: usize = 16 << 20;
/// Names that are tried.
const NAMES: u32 = 1000;
/// Counts the files of this process.
static COUNT: AtomicU32 = AtomicU32::new(0);

impl AtomicFile {
    /// Starts a file; its directory is made if it is not there.
    ///
    /// # Errors
    /// If the directory or the file cannot be made.
    pub fn create(path: &Path) -> Result<Self> {
        make_parent(path)?;
        let own = path.file_name().unwrap_or_default();
        remove_abandoned(path.parent().unwrap_or(Path::new("")), |name| name == own);
        let mut refused = io::Error::other("there is no free name beside it");
        for _ in 0..NAMES {
            let mut name = own.to_owned();
            let count = COUNT.fetch_add(1, Ordering::Relaxed);
            name.push(format!(".{}-{count}.part", std::process::id()));
            let part = path.with_file_name(name);
            match File::create_new(&part) {
                // Whoever removes what is abandoned may have taken it for that before it was locked.
                Ok(file) if may_hold(&file) && part.exists() => {
                    return Ok(Self::of(path, part, file));
                }
                Ok(_) => {}
                Err(reason) if reason.kind() == io::ErrorKind::AlreadyExists => {}
                Err(reason) => {
                    refused = reason;
                    break;
                }
            }
        }
        let help = "name another place with --out, or make it writable";
        Err(Error::file(path, "write", refused, help))
    }

    /// Starts a file that has the name `part` until it is whole. The caller sees to it that nobody else writes
    /// under that name.
    pub(super) fn create_as(path: &Path, part: PathBuf) -> Result<Self> {
        make_parent(path)?;
        let file = File::create(&part).map_err(|reason| {
            let help = "name another place with --out, or make it writable";
            Error::file(&part, "write", reason, help)
        })?;
        Ok(Self::of(path, part, file))
    }

    fn of(path: &Path, part: PathBuf, file: File) -> Self {
        let writer = Some(BufWriter::new(file));
        AtomicFile { path: path.to_owned(), part, writer, pending: 0, kept: false }
    }

    /// The final name.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Waits until all that was written is on the disk.
    pub(super) fn sync(&mut self) -> io::Result<()> {
        let Some(writer) = &mut self.writer else { return Ok(()) };
        writer.flush()?;
        self.pending = 0;
        writer.get_ref().sync_data()
    }

    /// From now on what was written stays, under its part's name, if the file is dropped.
    pub(super) fn keep(&mut self) {
        self.kept = true;
    }

    /// Ends the file and gives it its name.
    ///
    /// # Errors
    /// If what is left cannot be written, or the file cannot be renamed.
    pub fn commit(mut self) -> Result<()> {
        let finish = |writer: BufWriter<File>| -> io::Result<File> {
            let file = writer.into_inner().map_err(io::IntoInnerError::into_error)?;
            file.sync_all()?;
            Ok(file)
        };
        let Some(writer) = self.writer.take() else { return Ok(()) };
        // It stays open, and locked, until it has its name.
        let _file = finish(writer).map_err(|reason| cannot_write(&self.path, reason))?;
        fs::rename(&self.part, &self.path).map_err(|reason| cannot_write(&self.path, reason))?;
        self.kept = true;
        Ok(())
    }
}

/// Refuses an obstacle at a path, and makes the directory that it is to stand in.
fn make_parent(path: &Path) -> Result<()> {
    refuse_obstacle(path)?;
    match path.parent().filter(|parent| !parent.as_os_str().is_empty()) {
        Some(directory) => make_directory(directory),
        None => Ok(()),
    }
}

/// Makes a directory, with those above it.
///
/// # Errors
/// If it cannot be made.
pub(super) fn make_directory(directory: &Path) -> Result<()> {
    fs::create_dir_all(directory).map_err(|reason| {
        let help = "name another place with --out, or make it writable";
        Error::file(directory, "make the directory", reason, help)
    })
}

/// Takes the lock of a file, if nobody has it. The system lets go of it when the file is closed, by death too.
/// Where the file system knows no locks, everybody may have it.
pub(super) fn may_hold(file: &File) -> bool {
    !matches!(file.try_lock(), Err(TryLockError::WouldBlock))
}

/// Removes what processes that are dead have left in a directory of files of whose names `of` approves.
pub(super) fn remove_abandoned(directory: &Path, of: impl Fn(&OsStr) -> bool) {
    let here = if directory.as_os_str().is_empty() { Path::new(".") } else { directory };
    for entry in fs::read_dir(here).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let Some((own, number)) =
            name.to_str().and_then(|name| name.strip_suffix(".part")?.rsplit_once('.'))
        else {
            continue;
        };
        let digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
        if number.split_once('-').is_none_or(|(p, n)| !digits(p) || !digits(n)) || !of(own.as_ref())
        {
            continue;
        }
        // What another process writes is locked; what cannot be opened or removed is nobody's business here.
        if let Ok(file) = File::open(entry.path())
            && matches!(file.try_lock(), Ok(()))
        {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Waits until the names in the directory of `path` are on the disk. Where directories cannot be opened the system
/// sees to that itself.
pub(super) fn sync_directory(path: &Path) -> io::Result<()> {
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    match File::open(parent.unwrap_or(Path::new("."))) {
        Ok(directory) if cfg!(unix) => directory.sync_all(),
        _ => Ok(()),
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let Some(writer) = &mut self.writer else {
            return Err(io::Error::other("the file is closed"));
        };
        let written = writer.write(bytes)?;
        self.pending += written;
        if self.pending >= SYNC_BYTES {
            writer.flush()?;
            writer.get_ref().sync_data()?;
            self.pending = 0;
        }
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.as_mut().map_or(Ok(()), Write::flush)
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        self.writer = None;
        if self.kept {
            return;
        }
        // There is nobody to tell of a failure.
        let _ = fs::remove_file(&self.part);
    }
}

/// Refuses a place where a file would replace something that is not a file: a directory, or a device,
/// which a rename would quietly do away with.
///
/// # Errors
/// If there is such a thing at `path`.
pub fn refuse_obstacle(path: &Path) -> Result<()> {
    let kind = match fs::metadata(path) {
        Ok(there) if there.is_dir() => "it is a directory",
        Ok(there) if !there.is_file() => "it is not a regular file",
        // What is not there, or cannot be looked at, is for the system to judge when it is written.
        _ => return Ok(()),
    };
    Err(Error::file(path, "write", kind, "name another place, or move it away"))
}

/// The error of a file that could not be written.
pub(super) fn cannot_write(path: &Path, reason: impl std::fmt::Display) -> Error {
    let help = "nothing was left under this name; free some space or name another place with --out";
    Error::file(path, "write", reason, help)
}

/// Writes a whole text file.
///
/// # Errors
/// If the file cannot be written.
pub fn write_text(path: &Path, text: &str) -> Result<()> {
    write_bytes(path, text.as_bytes())
}

/// Writes a whole file.
///
/// # Errors
/// If the file cannot be written.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<()> {
    let mut file = AtomicFile::create(path)?;
    file.write_all(bytes).map_err(|reason| cannot_write(path, reason))?;
    file.commit()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_a_file_is_whole_or_not_there() {
        let directory =
            std::env::temp_dir().join(format!("reeldown-atomic-{}", std::process::id()));
        let path = directory.join("deep/report.md");
        write_text(&path, "first").unwrap();
        let mut abandoned = AtomicFile::create(&path).unwrap();
        abandoned.write_all(b"half").unwrap();
        drop(abandoned);
        assert_eq!(fs::read_to_string(&path).unwrap(), "first");
        write_text(&path, "second").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "second");
        assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 1, "no .part is left");
        fs::remove_dir_all(&directory).unwrap();
    }

    #[test]
    fn property_nothing_but_a_file_is_replaced() {
        for place in ["/", "/dev/null"] {
            let error = write_text(Path::new(place), "x").unwrap_err().to_string();
            assert!(error.starts_with(&format!("cannot write {place}: it is ")), "{error}");
        }
    }

    #[test]
    fn property_a_directory_that_cannot_be_made_is_an_error_with_help() {
        let error = write_text(Path::new("/dev/null/report.md"), "x").unwrap_err().to_string();
        assert!(error.contains("/dev/null") && error.contains("--out"), "{error}");
    }
}
