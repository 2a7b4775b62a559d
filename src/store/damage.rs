//! Damaged Parquet files: polars answers some of them with a panic, which is an error here.

use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How many reads are under way; a panic during one is told as an error, and not printed.
static READING: AtomicUsize = AtomicUsize::new(0);
static HOOK: Once = Once::new();

/// Reads something of a Parquet file. An error, or a panic of the reader, is its reason in a few words.
///
/// The reader's threads panic on behalf of the caller, so the message is held back for all threads while
/// a read is under way.
pub(super) fn read<T, E: std::fmt::Display>(
    work: impl FnOnce() -> Result<T, E>,
) -> Result<T, String> {
    HOOK.call_once(|| {
        let usual = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if READING.load(Ordering::SeqCst) == 0 {
                usual(info);
            }
        }));
    });
    READING.fetch_add(1, Ordering::SeqCst);
    let result = panic::catch_unwind(AssertUnwindSafe(work));
    READING.fetch_sub(1, Ordering::SeqCst);
    match result {
        Ok(result) => result.map_err(|reason| reason.to_string()),
        Err(_) => Err("the file is damaged".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_a_panic_of_the_reader_is_a_reason() {
        let panics = || -> Result<(), String> { panic!("offset out of bounds") };
        assert_eq!(read(panics), Err("the file is damaged".to_owned()));
        assert_eq!(read(|| Err::<(), _>("no such column")), Err("no such column".to_owned()));
        assert_eq!(read(|| Ok::<_, String>(7)), Ok(7));
    }
}
