//! Cases: the registry. A new case is a room beside this one and a row here.

use super::Case;

mod free_fall;

/// All cases, in the order in which they are run.
pub(crate) const CASES: &[Case] = &[Case { id: "free_fall", run: free_fall::run }];
