//! Progress: a bar on a terminal, nothing in a pipe.

use indicatif::{ProgressBar, ProgressStyle};

/// A bar on standard error; hidden where that is no terminal, or where nobody wants one.
pub(crate) fn bar(length: u64, message: &str) -> ProgressBar {
    let bar = ProgressBar::new(length).with_message(message.to_owned());
    // The template is a constant that is known to be right; the default style would do too.
    let style =
        ProgressStyle::with_template("{msg:>22} [{bar:40}] {percent:>3} %  {elapsed} of about {duration}");
    if let Ok(style) = style {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
}
