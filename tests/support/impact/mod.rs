//! Bars in impact, and their runs compared with closed forms.

pub mod cases;
pub mod measure;
