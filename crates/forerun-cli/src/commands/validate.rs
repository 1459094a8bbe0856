//! Validate: runs the cases; a Markdown table of their figures for people, one JSON object for programs.

use indicatif::ProgressBar;
use serde::Serialize;

use crate::args::ValidateArgs;
use crate::failure::Failure;
use crate::output::{print, print_json};
use crate::progress;
use crate::validate::{CASES, Case, Figure, Verdict};

/// The result; the fields are those of `validate --json`.
#[derive(Debug, Default, Serialize)]
struct ValidateReport {
    figures: Vec<FigureReport>,
    /// How many of the figures have a limit that decides.
    judged: usize,
    /// How many of those hold it.
    passed: usize,
    /// Cases that were left out because they take minutes.
    not_run: Vec<&'static str>,
}

#[derive(Debug, Serialize)]
struct FigureReport {
    case: &'static str,
    figure: String,
    value: f64,
    /// What is asked of the value, in words.
    limit: String,
    /// `pass`, `miss`, `reported` (it has no limit), or, of a time, `in_time` or `too_slow` on this machine.
    verdict: &'static str,
    /// Of a miss, why it is one; none where that is not known.
    cause: Option<String>,
}

/// `forerun validate`.
pub(crate) fn run(args: &ValidateArgs) -> Result<(), Failure> {
    let chosen = choose(&args.cases)?;
    let mut report = ValidateReport::default();
    if args.cases.is_empty() {
        report.not_run = CASES.iter().filter(|case| case.long).map(|case| case.id).collect();
    }
    if !args.json {
        print("| case | figure | value | limit | |")?;
        print("|---|---|---:|---|---|")?;
    }
    let bar = progress::bar(chosen.len() as u64, "cases");
    for case in chosen {
        bar.set_message(case.id);
        for figure in (case.run)() {
            if !args.json {
                print_row(&bar, case.id, &figure)?;
            }
            report.add(case.id, figure);
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    if args.json { print_json(&report) } else { report.print_end() }?;
    if args.strict && report.passed < report.judged {
        let (misses, judged) = (report.judged - report.passed, report.judged);
        return Err(Failure::Check(format!("{misses} of {judged} figures miss their limit")));
    }
    Ok(())
}

impl ValidateReport {
    fn add(&mut self, case: &'static str, figure: Figure) {
        self.judged += usize::from(figure.verdict.counts());
        self.passed += usize::from(figure.verdict == Verdict::Pass);
        let cause = figure.cause(case);
        let Figure { name, value, limit, verdict } = figure;
        self.figures.push(FigureReport {
            case,
            figure: name,
            value,
            limit: limit.to_string(),
            verdict: verdict.key(),
            cause,
        });
    }

    fn print_end(&self) -> Result<(), Failure> {
        print(&format!("\n{} of {} figures pass", self.passed, self.judged))?;
        if self.not_run.is_empty() {
            return Ok(());
        }
        print(&format!("not run, as they take minutes: {}", self.not_run.join(", ")))
    }
}

/// Prints a figure above the bar, not through it.
fn print_row(bar: &ProgressBar, case: &str, figure: &Figure) -> Result<(), Failure> {
    let (digits, word) = (figure.digits(), figure.verdict.word());
    let verdict = figure.cause(case).map_or_else(|| word.to_owned(), |cause| format!("{word}, {cause}"));
    bar.suspend(|| print(&format!("| {case} | {} | {digits} | {} | {verdict} |", figure.name, figure.limit)))
}

fn choose(ids: &[String]) -> Result<Vec<&'static Case>, Failure> {
    if ids.is_empty() {
        return Ok(CASES.iter().filter(|case| !case.long).collect());
    }
    let find = |id: &String| {
        CASES.iter().find(|case| case.id == id).ok_or_else(|| {
            let known: Vec<&str> = CASES.iter().map(|case| case.id).collect();
            Failure::Input(format!("there is no case \"{id}\"; there are {}", known.join(", ")))
        })
    };
    ids.iter().map(find).collect()
}
