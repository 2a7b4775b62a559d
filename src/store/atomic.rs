//! Files that appear whole under their name, or not at all.

use crate::error::{Error, Result};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// A file written beside its final name and renamed when it is whole. Dropped before that, it leaves
/// nothing behind, and whatever had the final name is untouched.
#[derive(Debug)]
pub struct AtomicFile {
    path: PathBuf,
    part: PathBuf,
    writer: Option<BufWriter<File>>,
    /// Bytes written since the disk was last waited for.
    pending: usize,
}

/// Bytes after which the disk is waited for. A large file is then on the disk bit by bit, beside whatever other
/// threads compute, instead of all at once when it is committed and everybody waits.
const SYNC_BYTES: usize = 16 << 20;

impl AtomicFile {
    /// Starts a file; its directory is made if it is not there.
    ///
    /// # Errors
    /// If the directory or the file cannot be made.
    pub fn create(path: &Path) -> Result<Self> {
        refuse_obstacle(path)?;
        let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty());
        if let Some(directory) = directory {
            fs::create_dir_all(directory).map_err(|reason| {
                let help = "name another place with --out, or make it writable";
                Error::file(directory, "make the directory", reason, help)
            })?;
        }
        let mut name = path.file_name().unwrap_or_default().to_owned();
        name.push(".part");
        let part = path.with_file_name(name);
        let file = File::create(&part).map_err(|reason| {
            let help = "name another place with --out, or make it writable";
            Error::file(&part, "write", reason, help)
        })?;
        Ok(AtomicFile {
            path: path.to_owned(),
            part,
            writer: Some(BufWriter::new(file)),
            pending: 0,
        })
    }

    /// The final name.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Ends the file and gives it its name.
    ///
    /// # Errors
    /// If what is left cannot be written, or the file cannot be renamed.
    pub fn commit(mut self) -> Result<()> {
        let finish = |writer: BufWriter<File>| -> io::Result<()> {
            writer.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()
        };
        if let Some(writer) = self.writer.take() {
            finish(writer).map_err(|reason| cannot_write(&self.path, reason))?;
        }
        fs::rename(&self.part, &self.path).map_err(|reason| cannot_write(&self.path, reason))
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
        // After a commit there is nothing under this name; there is nobody to tell of a failure.
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
