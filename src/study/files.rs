//! What a study is made from besides its own text, and who gives it.

/// A text with the name by which diagnostics call it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedText {
    /// The name: a path as a person would write it.
    pub origin: String,
    /// The text.
    pub text: String,
}

/// Where cards and the files of empirical laws and joint samples come from. A failure is its reason, in a few words.
pub trait Files {
    /// The card called `name`, which was named by the study file or, if `by_option`, by `--set card=…`.
    ///
    /// # Errors
    /// Why the card cannot be read.
    fn card(&mut self, name: &str, by_option: bool) -> std::result::Result<NamedText, String>;

    /// The whole of the file `name` that the card `card` names, column by column.
    ///
    /// # Errors
    /// Why the file cannot be read.
    fn sample(&mut self, card: &str, name: &str) -> std::result::Result<SampleFile, String>;
}

/// A column of numbers, or why it holds none, in a few words.
pub type SampleColumn = (String, std::result::Result<Vec<f64>, String>);

/// A column of numbers, `None` where one is missing, or why it holds none, in a few words.
pub type NumberColumn = (String, std::result::Result<Vec<Option<f64>>, String>);

/// A file of columns, read.
#[derive(Debug, Clone)]
pub struct SampleFile {
    /// SHA-256 of the file, in hexadecimal.
    pub sha256: String,
    /// Its columns in their order, by the names in its header.
    pub columns: Vec<SampleColumn>,
}
