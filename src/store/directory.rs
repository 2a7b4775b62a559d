//! A directory of results: written by one process at a time, replaced only by the study that it belongs to, and
//! either finished as a whole or marked as unfinished.
//!
//! `unfinished.json` is written before anything else and removed after everything else; while a process holds it,
//! it is locked. `manifest.json` is written last: it says whose results these are and names every file, with its
//! SHA-256 where the file has no checksums inside.

use super::atomic::{
    cannot_write, make_directory, may_hold, refuse_obstacle, remove_abandoned, sync_directory,
};
use super::checksums::sha256;
use super::outcomes_file::OutcomesReader;
use crate::error::{Error, Result};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::{Read, Seek, Write};
use std::path::{Component, Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

const MANIFEST: &str = "manifest.json";
const MARKER: &str = "unfinished.json";
/// The directory of figures in a directory of results.
const FIGURES: &str = "figures";
/// What to do about a directory that is not this study's.
const FORCE: &str =
    "name another directory with --out, or use --force (rig: --overwrite) to replace what is there";

/// What a command is going to write.
#[derive(Debug, Clone, Copy)]
pub struct Contents<'a> {
    /// The command's name.
    pub kind: &'static str,
    /// The study's title.
    pub study: &'a str,
    /// The files.
    pub files: &'a [&'a str],
    /// Whether results of something else may be replaced.
    pub force: bool,
}

/// The files of a finished directory, and whose they are.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Manifest {
    kind: String,
    study: String,
    /// Names, and the SHA-256 of those that hold no checksums themselves.
    files: BTreeMap<String, Option<String>>,
}

/// What is said of a directory that is not finished.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Marker {
    note: String,
    kind: String,
    study: String,
    /// Whether files in it were replaced already.
    changed: bool,
    process: u32,
}

/// A directory that this process writes its results into.
#[derive(Debug)]
pub struct ResultDirectory {
    path: PathBuf,
    kind: &'static str,
    study: String,
    marker: Mutex<File>,
    /// Whether files in it were replaced since it was last finished.
    changed: AtomicBool,
    /// Whether a process before this one left it unfinished.
    unfinished: bool,
    /// The files that the results before these consist of.
    earlier: Vec<String>,
    written: Mutex<BTreeMap<String, Option<String>>>,
    finished: bool,
}

impl ResultDirectory {
    /// Makes a directory this process's own until it is dropped, and marks it as unfinished. What killed processes
    /// left half-written is removed.
    ///
    /// # Errors
    /// If it cannot be written, something in it is in the way, another process is writing into it, or it holds
    /// something else than earlier results of the same study and command.
    pub fn open(path: &Path, contents: Contents<'_>) -> Result<Self> {
        make_directory(path)?;
        for name in contents.files.iter().chain(&[MANIFEST, MARKER]) {
            refuse_obstacle(&path.join(name))?;
        }
        let figures = path.join(FIGURES);
        if figures.exists() && !figures.is_dir() {
            let help =
                "it is to be the directory of the figures: name another place, or move it away";
            return Err(Error::file(&figures, "write", "it is not a directory", help));
        }
        let earlier = inspect(path, &contents)?;
        let (mut file, before) = take_marker(path)?;
        // Between the two looks another process may have finished.
        let earlier = match inspect(path, &contents) {
            Ok(now) => now.into_iter().chain(earlier).collect(),
            Err(error) => {
                if before.is_none() {
                    let _ = fs::remove_file(path.join(MARKER));
                }
                return Err(error);
            }
        };
        let changed = before.as_ref().is_some_and(|marker| marker.changed);
        let found = ResultDirectory {
            path: path.to_owned(),
            kind: contents.kind,
            study: contents.study.to_owned(),
            changed: AtomicBool::new(changed),
            unfinished: changed,
            earlier,
            written: Mutex::default(),
            finished: false,
            marker: Mutex::new({
                write_marker(&mut file, path, contents.kind, contents.study, changed)?;
                file
            }),
        };
        sync_directory(&path.join(MARKER)).map_err(|reason| cannot_write(path, reason))?;
        for directory in [path, &figures] {
            remove_abandoned(directory, |_| true);
        }
        Ok(found)
    }

    /// The directory.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The path of a table in it, which is about to be written and has checksums of its own.
    ///
    /// # Errors
    /// If the directory cannot be marked as changed.
    pub fn table(&self, name: &str) -> Result<PathBuf> {
        self.note(name, None)?;
        Ok(self.path.join(name))
    }

    /// Writes a whole text file.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write_text(&self, name: &str, text: &str) -> Result<()> {
        self.write_bytes(name, text.as_bytes())
    }

    /// Writes a whole file.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write_bytes(&self, name: &str, bytes: &[u8]) -> Result<()> {
        self.note(name, Some(sha256(bytes)))?;
        super::atomic::write_bytes(&self.path.join(name), bytes)
    }

    /// Writes a file that differs between two runs of one study: it is named in the manifest, without a checksum.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write_varying(&self, name: &str, text: &str) -> Result<()> {
        self.note(name, None)?;
        super::atomic::write_text(&self.path.join(name), text)
    }

    fn note(&self, name: &str, sha256: Option<String>) -> Result<()> {
        if !self.changed.swap(true, Ordering::Relaxed)
            && let Ok(mut file) = self.marker.lock()
        {
            write_marker(&mut file, &self.path, self.kind, &self.study, true)?;
        }
        if let Ok(mut written) = self.written.lock() {
            written.insert(name.to_owned(), sha256);
        }
        Ok(())
    }

    /// Removes what the results before these had and these have not, writes the manifest, and takes the mark away.
    ///
    /// # Errors
    /// If a file cannot be removed or written.
    pub fn finish(mut self) -> Result<()> {
        let files = self.written.lock().map(|written| written.clone()).unwrap_or_default();
        for name in self.earlier.iter().filter(|name| !files.contains_key(*name) && inside(name)) {
            let path = self.path.join(name);
            if path.is_file() {
                let help = "it is of earlier results: move it away";
                fs::remove_file(&path).map_err(|why| Error::file(&path, "remove", why, help))?;
            }
        }
        // A directory that is empty now is removed with what was in it; another is not.
        let _ = fs::remove_dir(self.path.join(FIGURES));
        let manifest = Manifest { kind: self.kind.to_owned(), study: self.study.clone(), files };
        let path = self.path.join(MANIFEST);
        let text = json(&manifest, &path)?;
        super::atomic::write_text(&path, &text)?;
        sync_directory(&path).map_err(|reason| cannot_write(&path, reason))?;
        self.finished = true;
        Ok(())
    }
}

impl Drop for ResultDirectory {
    fn drop(&mut self) {
        // What nothing was done to is what it was before.
        if self.finished || !(self.changed.load(Ordering::Relaxed) || self.unfinished) {
            let _ = fs::remove_file(self.path.join(MARKER));
            let _ = sync_directory(&self.path.join(MARKER));
            if !self.finished {
                // Only where it is empty, and so was before.
                let _ = fs::remove_dir(&self.path);
            }
        }
    }
}

/// Refuses a directory whose files may be of two runs, because whoever wrote them did not come to an end.
///
/// # Errors
/// If it is unfinished.
pub fn refuse_unfinished(directory: &Path, doing: &'static str) -> Result<()> {
    let path = directory.join(MARKER);
    let marker = fs::read(&path).ok().and_then(|bytes| serde_json::from_slice(&bytes).ok());
    match marker {
        Some(Marker { changed: true, note, .. }) => {
            let help = "finish the run: reeldown run --resume";
            Err(Error::file(directory, doing, format!("it is unfinished: {note}"), help))
        }
        _ => Ok(()),
    }
}

/// Verifies a file against the manifest of its directory, if there is one and it names the file with a checksum.
///
/// # Errors
/// If the file was changed since.
pub fn verify_listed(directory: &Path, name: &str, bytes: &[u8]) -> Result<()> {
    let listed = read_manifest(directory)?.and_then(|manifest| manifest.files.get(name)?.clone());
    if listed.is_some_and(|listed| listed != sha256(bytes)) {
        let reason = format!("its bytes do not match the checksum in {MANIFEST}");
        let help = "it was changed or is damaged: run its study again";
        return Err(Error::file(directory.join(name), "read", reason, help));
    }
    Ok(())
}

fn json(value: &impl Serialize, path: &Path) -> Result<String> {
    let text = serde_json::to_string_pretty(value).map_err(|why| cannot_write(path, why))?;
    Ok(text + "\n")
}

fn read_manifest(directory: &Path) -> Result<Option<Manifest>> {
    let path = directory.join(MANIFEST);
    let Ok(bytes) = fs::read(&path) else { return Ok(None) };
    serde_json::from_slice(&bytes).map(Some).map_err(|why| {
        Error::file(&path, "read", format!("it is not a manifest of reeldown's: {why}"), FORCE)
    })
}

/// Whether a name out of a manifest names something in the manifest's directory.
fn inside(name: &str) -> bool {
    Path::new(name).components().all(|part| matches!(part, Component::Normal(_)))
}

/// The files of earlier results that may be replaced; an error if there is anything else.
fn inspect(directory: &Path, contents: &Contents<'_>) -> Result<Vec<String>> {
    let there = |name: &&&str| directory.join(name).exists();
    let refuse = |reason: String| Err(Error::file(directory, "write into", reason, FORCE));
    let manifest = match read_manifest(directory) {
        Err(error) if !contents.force => return Err(error),
        manifest => manifest.unwrap_or_default(),
    };
    let present = contents.files.iter().filter(there).map(|name| (*name).to_owned()).collect();
    let files = manifest
        .as_ref()
        .map_or(present, |manifest| manifest.files.keys().cloned().collect::<Vec<_>>());
    if contents.force {
        return Ok(files);
    }
    let marker: Option<Marker> = fs::read(directory.join(MARKER))
        .ok()
        .and_then(|bytes| serde_json::from_slice(&bytes).ok())
        .filter(|marker: &Marker| marker.changed);
    let owners = [
        manifest.map(|manifest| (manifest.kind, manifest.study)),
        marker.map(|marker| (marker.kind, marker.study)),
    ];
    let mut owners: Vec<(String, String)> = owners.into_iter().flatten().collect();
    if owners.is_empty() {
        owners.extend(unlisted_owner(directory));
    }
    for (kind, study) in &owners {
        if kind != contents.kind || study != contents.study {
            return refuse(format!("it holds the results of `reeldown {kind}` of \"{study}\""));
        }
    }
    let figures = fs::read_dir(directory.join(FIGURES)).is_ok_and(|mut list| list.next().is_some());
    let found = files.first().map(String::as_str).or(figures.then_some(FIGURES));
    match found.filter(|_| owners.is_empty()) {
        Some(name) => refuse(format!("it holds {name}, and nothing says that reeldown wrote it")),
        None => Ok(files),
    }
}

/// Whose results lie in a directory without a manifest, such as one that was copied in part: command and title of
/// the study, as its findings or its table say.
fn unlisted_owner(directory: &Path) -> Option<(String, String)> {
    let title = |name: &str| -> Option<Value> {
        serde_json::from_slice(&fs::read(directory.join(name)).ok()?).ok()
    };
    for (name, kind) in
        [("findings.json", "run"), ("sweep.json", "sweep"), ("tighten.json", "tighten")]
    {
        if let Some(tree) = title(name)
            && let Some(title) = tree["title"].as_str()
        {
            let kind = if tree["accepted"].is_boolean() { "calibrate" } else { kind };
            return Some((kind.to_owned(), title.to_owned()));
        }
    }
    let table = OutcomesReader::open(&directory.join("outcomes.parquet")).ok()?;
    Some(("run".to_owned(), table.parentage().0.get("title")?.clone()))
}

/// Opens and locks the marker, with what a process before this one said in it.
fn take_marker(directory: &Path) -> Result<(File, Option<Marker>)> {
    let path = directory.join(MARKER);
    loop {
        let mut file = OpenOptions::new()
            .create(true)
            .read(true)
            .write(true)
            .truncate(false)
            .open(&path)
            .map_err(|why| {
                let help = "name another place with --out, or make it writable";
                Error::file(&path, "write", why, help)
            })?;
        let mut text = Vec::new();
        let marker = |text: &[u8]| serde_json::from_slice::<Marker>(text).ok();
        if !may_hold(&file) {
            // Whoever has just taken it may not have written its number yet.
            let process = (0..20).find_map(|attempt| {
                if attempt > 0 {
                    std::thread::sleep(std::time::Duration::from_millis(10));
                }
                text.clear();
                file.rewind().and_then(|()| file.read_to_end(&mut text)).ok()?;
                marker(&text)
            });
            let process = process.map_or(String::new(), |m| format!(" (process {})", m.process));
            let reason = format!("another reeldown is writing into it{process}");
            let help = "wait until it is done, or name another directory with --out";
            return Err(Error::file(directory, "write into", reason, help));
        }
        // Whoever had it may have removed it since it was opened, and a third may have made another.
        if is_same(&file, &path) {
            file.read_to_end(&mut text).map_err(|why| cannot_write(&path, why))?;
            return Ok((file, marker(&text)));
        }
    }
}

#[cfg(unix)]
fn is_same(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    match (file.metadata(), fs::metadata(path)) {
        (Ok(open), Ok(named)) => (open.dev(), open.ino()) == (named.dev(), named.ino()),
        _ => false,
    }
}

#[cfg(not(unix))]
fn is_same(_: &File, path: &Path) -> bool {
    path.exists()
}

/// Writes the marker, in place, for the lock is on the file.
fn write_marker(
    file: &mut File,
    directory: &Path,
    kind: &str,
    study: &str,
    changed: bool,
) -> Result<()> {
    let path = directory.join(MARKER);
    let what = if changed {
        "ended early or is still at work: files here may be of two runs"
    } else {
        "is at work, or ended before it had replaced any file here"
    };
    let marker = Marker {
        note: format!("`reeldown {kind}` of \"{study}\" {what}"),
        kind: kind.to_owned(),
        study: study.to_owned(),
        changed,
        process: std::process::id(),
    };
    let text = json(&marker, &path)?;
    let written = file
        .rewind()
        .and_then(|()| file.set_len(0))
        .and_then(|()| file.write_all(text.as_bytes()))
        .and_then(|()| file.sync_all());
    written.map_err(|reason| cannot_write(&path, reason))
}
