//! Reports: answers and studies in words, and their tables.

pub(crate) mod certificate;
pub(crate) mod in_words;
pub(crate) mod means;
pub(crate) mod modes;
pub(crate) mod motion_report;
pub(crate) mod motion_tradeoff;
pub(crate) mod report;
pub(crate) mod sensitivity;
pub(crate) mod tradeoff;
pub(crate) mod tradeoff_plot;
