//! The real binary as a child process, and directories for it to write in.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// The study whose answers are certified: see its head.
pub const PINNED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/habe/study.toml");

/// What a run of the program left behind.
pub struct Answer {
    /// Exit code.
    pub code: i32,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

impl Answer {
    /// Reads a finished process; whatever was asked, it must not have panicked, and must not have sent
    /// escape codes into a pipe.
    pub fn of(output: Output) -> Answer {
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("the program prints UTF-8");
        let (out, err) = (text(output.stdout), text(output.stderr));
        for said in [&out, &err] {
            assert!(!said.contains("panicked"), "{said}");
            assert!(!said.contains('\u{1b}'), "an escape code in a pipe: {said:?}");
        }
        let code = output.status.code().unwrap_or_else(|| panic!("ended by a signal: {err}"));
        Answer { code, out, err }
    }

    /// The answer, if the program ended with `code`.
    #[track_caller]
    pub fn ended_with(self, code: i32) -> Answer {
        assert_eq!(self.code, code, "out: {}\nerr: {}", self.out, self.err);
        self
    }

    /// Standard output as the one JSON object that it must be.
    #[track_caller]
    pub fn json(&self) -> Value {
        let value: Value = serde_json::from_str(&self.out)
            .unwrap_or_else(|why| panic!("not one JSON value: {why}: {}", self.out));
        assert!(value.is_object(), "{value}");
        value
    }
}

/// The program, ready to be given arguments.
pub fn program() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_reeldown"));
    command.env_remove("NO_COLOR").stdin(Stdio::null());
    command
}

/// Runs the program to its end.
pub fn reeldown(arguments: &[&str]) -> Answer {
    Answer::of(program().args(arguments).output().expect("the program starts"))
}

/// A directory of one test, gone with the test.
pub struct Place {
    directory: PathBuf,
}

impl Place {
    /// An empty directory; `name` is the test's own.
    pub fn new(name: &str) -> Place {
        let directory =
            std::env::temp_dir().join(format!("reeldown-cli-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&directory);
        std::fs::create_dir_all(&directory).expect("the temporary directory is writable");
        Place { directory }
    }

    /// The directory.
    pub fn path(&self) -> &Path {
        &self.directory
    }

    /// The path of something in it, as an argument.
    pub fn at(&self, name: &str) -> String {
        self.directory.join(name).to_str().expect("a UTF-8 path").to_owned()
    }

    /// Writes a text into it and returns its path.
    pub fn write(&self, name: &str, text: impl AsRef<[u8]>) -> String {
        std::fs::write(self.directory.join(name), text).expect("a writable directory");
        self.at(name)
    }

    /// The bytes of a file in it.
    #[track_caller]
    pub fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.directory.join(name)).unwrap_or_else(|why| panic!("{name}: {why}"))
    }

    /// Every file below it that was left unfinished.
    pub fn unfinished(&self) -> Vec<PathBuf> {
        let mut found = Vec::new();
        let mut open = vec![self.directory.clone()];
        while let Some(directory) = open.pop() {
            for entry in std::fs::read_dir(directory).expect("a directory") {
                let path = entry.expect("an entry").path();
                if path.is_dir() {
                    open.push(path);
                } else if path.extension().is_some_and(|ending| ending == "part") {
                    found.push(path);
                }
            }
        }
        found
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.directory);
    }
}
