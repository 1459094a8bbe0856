//! Processes: copies of this program, each asked one thing about one engine on one scene.

use std::io::Read as _;
use std::path::PathBuf;
use std::process::{Command, ExitStatus, Stdio};
use std::time::Duration;
use std::{env, thread};

use forerun::Clock;

use crate::engine::Kind;
use crate::measure::{Answer, Question, Task};
use crate::native::{self, Threaded};

/// How long a process may take for what has an end of its own: an hour.
const PATIENCE: Duration = Duration::from_secs(3600);
/// How often is looked whether a process has ended.
const LOOK_EVERY: Duration = Duration::from_millis(5);

/// Where the programs lie.
pub(crate) struct Programs {
    ours: PathBuf,
    one_thread: PathBuf,
    threads: PathBuf,
}

impl Programs {
    /// Builds what these engines need on these thread counts.
    pub(crate) fn build(engines: &[Kind], threads: &[u16]) -> Result<Self, String> {
        let ours = env::current_exe().map_err(|error| error.to_string())?;
        let peers = engines.iter().any(|kind| *kind != Kind::Forerun);
        let build = |wanted: bool, threaded| if wanted { native::build(threaded) } else { Ok(ours.clone()) };
        Ok(Programs {
            one_thread: build(peers && threads.contains(&1), Threaded::No)?,
            threads: build(peers && threads.iter().any(|count| *count > 1), Threaded::Yes)?,
            ours,
        })
    }

    fn of(&self, task: &Task) -> &PathBuf {
        match (task.kind, task.threads) {
            (Kind::Forerun, _) => &self.ours,
            (_, 1) => &self.one_thread,
            _ => &self.threads,
        }
    }

    /// Starts a process for the task and reads its answer.
    pub(crate) fn ask(&self, task: &Task, question: Question) -> Result<Answer, String> {
        self.ask_within(task, question, PATIENCE, &[])
    }

    /// The same, but ends the process when it takes longer; with more words on its command line.
    pub(crate) fn ask_within(
        &self,
        task: &Task,
        question: Question,
        patience: Duration,
        words: &[String],
    ) -> Result<Answer, String> {
        let mut command = Command::new(self.of(task));
        command
            .arg(&task.scene)
            .args(["--frames", &task.frames.to_string(), "--threads", &task.threads.to_string()])
            .args(["--one", &name(&task.kind), "--ask", &name(&question)])
            .args(words);
        let (status, text) = run(command, patience)?;
        if !status.success() {
            return Err(format!("its process ended with {status}"));
        }
        // Engines print too, before and after: the answer is the line that can be read.
        let answer = text.lines().find_map(|line| serde_json::from_str(line).ok());
        answer.ok_or_else(|| format!("its process gave no answer, but \"{}\"", text.trim()))
    }
}

/// As it is typed on the command line.
fn name(value: &impl clap::ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

/// Runs a process to its end, or ends it.
fn run(mut command: Command, patience: Duration) -> Result<(ExitStatus, String), String> {
    let cannot = |error: std::io::Error| format!("its process cannot be run: {error}");
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::inherit()).spawn().map_err(cannot)?;
    let mut out = child.stdout.take().ok_or("its process has no output")?;
    // Read beside, or it would wait for us with a full pipe.
    let reader = thread::spawn(move || {
        let mut bytes = Vec::new();
        out.read_to_end(&mut bytes).map(|_| String::from_utf8_lossy(&bytes).into_owned())
    });
    let clock = Clock::system();
    let start = clock.now();
    let status = loop {
        if let Some(status) = child.try_wait().map_err(cannot)? {
            break status;
        }
        if clock.now() - start > patience {
            child.kill().and_then(|()| child.wait()).map_err(cannot)?;
            return Err(format!("its process was ended after {} s", patience.as_secs()));
        }
        thread::sleep(LOOK_EVERY);
    };
    let text = reader.join().map_err(|_| "its output could not be read")?.map_err(cannot)?;
    Ok((status, text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn a_process_that_takes_too_long_is_ended() {
        let mut sleeping = Command::new("sleep");
        sleeping.arg("60");
        let ended = run(sleeping, Duration::from_millis(50)).unwrap_err();
        assert!(ended.contains("was ended after"), "{ended}");
        let mut saying = Command::new("echo");
        saying.arg("words");
        let (status, text) = run(saying, Duration::from_secs(30)).unwrap();
        assert!(status.success() && text == "words\n", "{text}");
    }
}
