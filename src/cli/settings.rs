//! The settings of a solve from the options that every command shares.

use super::options::Common;
use crate::qp::{Condense, Method, Settings, Watch};

/// The settings from `common` for one method; `watch` can end the solve.
pub(super) fn settings(method: Method, common: &Common, watch: &Watch) -> Settings {
    let mut settings = Settings::with_method(method);
    settings.tolerance = Some(common.tolerance);
    settings.threads = common.threads;
    settings.condense = if common.no_condense { Condense::Never } else { Condense::Auto };
    settings.memory = Some(common.limits.most_memory());
    settings.watch = watch.clone();
    settings
}
