//! Work that somebody waits for: on so many threads, with a progress bar on a terminal, stopped by Ctrl-C.

use crate::campaign::{self, Progress};
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

/// Progress that Ctrl-C asks to stop at the next batch; a second Ctrl-C ends the program at once.
///
/// # Errors
/// If the signal cannot be caught.
pub(super) fn interruptible() -> Result<Arc<Progress>> {
    let progress = Arc::new(Progress::default());
    let stopped = Arc::clone(&progress);
    ctrlc::set_handler(move || {
        if stopped.stopping() {
            std::process::exit(130);
        }
        stopped.request_stop();
    })
    .map_err(|reason| Error::argument(format!("cannot catch Ctrl-C: {reason}")))?;
    Ok(progress)
}

/// Carries out work on so many threads, one a core unless stated, and shows how far it is.
///
/// # Errors
/// If the threads cannot be started, and those of the work.
pub(super) fn carry_out<'a, T: Send>(
    progress: &'a Arc<Progress>,
    threads: Option<usize>,
    work: impl FnOnce(&'a Progress) -> Result<T> + Send,
) -> Result<T> {
    let _watch = Watch::start(progress);
    campaign::with_threads(threads, || work(progress))?
}

/// A progress bar over a campaign, on standard error if that is a terminal.
struct Watch {
    over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Watch {
    /// Watches `progress` from stage to stage.
    fn start(progress: &Arc<Progress>) -> Self {
        let over = Arc::new(AtomicBool::new(false));
        if !std::io::stderr().is_terminal() {
            return Watch { over, thread: None };
        }
        let (progress, finished) = (Arc::clone(progress), Arc::clone(&over));
        let thread = thread::spawn(move || {
            let begun = Instant::now();
            while begun.elapsed() < PATIENCE {
                if finished.load(Ordering::Relaxed) {
                    return;
                }
                thread::sleep(TICK);
            }
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
            let layout = "{msg} {bar:30} {human_pos}/{human_len}  {per_sec}  {eta} left";
            if let Ok(style) = ProgressStyle::with_template(layout) {
                bar.set_style(style);
            }
            let mut shown = None;
            while !finished.load(Ordering::Relaxed) {
                let stage = progress.stage();
                if shown != Some(stage) {
                    bar.set_message(stage.name);
                    bar.set_length(stage.descents);
                    bar.reset();
                    shown = Some(stage);
                }
                bar.set_position(progress.done() - stage.before);
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
