//! Validate: runs the cases and prints their figures as a Markdown table.

use crate::args::ValidateArgs;
use crate::failure::Failure;
use crate::output::print;
use crate::progress;
use crate::validate::{CASES, Case, Verdict};

/// `forerun validate`.
pub(crate) fn run(args: &ValidateArgs) -> Result<(), Failure> {
    let chosen = choose(&args.cases)?;
    print("| case | figure | value | limit | |")?;
    print("|---|---|---:|---|---|")?;
    let bar = progress::bar(chosen.len() as u64, "cases");
    let (mut figures, mut misses) = (0_usize, 0_usize);
    for case in chosen {
        bar.set_message(case.id);
        for figure in (case.run)() {
            // Above the bar, not through it.
            bar.suspend(|| {
                print(&format!(
                    "| {} | {} | {} | {} | {} |",
                    case.id,
                    figure.name,
                    figure.digits(),
                    figure.limit,
                    figure.verdict.word()
                ))
            })?;
            figures += usize::from(figure.verdict.counts());
            misses += usize::from(figure.verdict == Verdict::Miss);
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    print(&format!("\n{} of {figures} figures pass", figures - misses))?;
    if args.cases.is_empty() {
        let long: Vec<&str> = CASES.iter().filter(|case| case.long).map(|case| case.id).collect();
        print(&format!("not run, as they take minutes: {}", long.join(", ")))?;
    }
    if args.strict && misses > 0 {
        return Err(Failure::Check(format!("{misses} of {figures} figures miss their limit")));
    }
    Ok(())
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
