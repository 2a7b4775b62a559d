//! Watching a campaign: a progress bar on a terminal, and Ctrl-C.

use crate::campaign::Progress;
use crate::error::{Error, Result};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Work shorter than this shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);
/// How often the bar moves.
const TICK: Duration = Duration::from_millis(100);

/// A progress bar over a campaign, on standard error if that is a terminal.
pub(super) struct Watch {
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Watch {
    /// Watches `progress` on its way to `total` descents; those done already do not count.
    pub fn start(progress: &Arc<Progress>, total: u64, what: &'static str) -> Self {
        let over = Arc::new(AtomicBool::new(false));
        if !std::io::stderr().is_terminal() {
            return Watch { over, thread: None };
        }
        let (progress, finished) = (Arc::clone(progress), Arc::clone(&over));
        let before = progress.done();
        let thread = thread::spawn(move || {
            let begun = Instant::now();
            while begun.elapsed() < PATIENCE {
                if finished.load(Ordering::Relaxed) {
                    return;
                }
                thread::sleep(TICK);
            }
            let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr());
            let layout = "{msg} {bar:30} {human_pos}/{human_len}  {per_sec}  {eta} left";
            if let Ok(style) = ProgressStyle::with_template(layout) {
                bar.set_style(style);
            }
            bar.set_message(what);
            while !finished.load(Ordering::Relaxed) {
                bar.set_position(progress.done() - before);
                thread::sleep(TICK);
            }
            bar.finish_and_clear();
        });
        Watch { over, thread: Some(thread) }
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A bar that has died of something took nothing with it.
            let _ = thread.join();
        }
    }
}

/// Makes Ctrl-C stop `progress` at the next batch; a second one ends the program at once.
///
/// # Errors
/// If the signal cannot be caught.
pub(super) fn stop_on_interrupt(progress: &Arc<Progress>) -> Result<()> {
    let progress = Arc::clone(progress);
    ctrlc::set_handler(move || {
        if progress.stopping() {
            std::process::exit(130);
        }
        progress.request_stop();
    })
    .map_err(|reason| Error::argument(format!("cannot catch Ctrl-C: {reason}")))
}

/// Makes the request to end by which queues and clusters take a machine back stop `progress` at the next batch.
///
/// # Errors
/// If the signal cannot be caught.
#[cfg(unix)]
pub(super) fn stop_on_termination(progress: &Arc<Progress>) -> Result<()> {
    let progress = Arc::clone(progress);
    let mut signals = signal_hook::iterator::Signals::new([signal_hook::consts::SIGTERM])
        .map_err(|reason| Error::argument(format!("cannot catch SIGTERM: {reason}")))?;
    thread::spawn(move || signals.forever().for_each(|_| progress.request_stop()));
    Ok(())
}

/// Elsewhere there is no such request.
///
/// # Errors
/// None.
#[cfg(not(unix))]
pub(super) fn stop_on_termination(_: &Arc<Progress>) -> Result<()> {
    Ok(())
}
