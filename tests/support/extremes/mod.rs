//! The stability table: problems with extreme numbers, and what each method makes of them.

pub mod cases;
pub mod entry;
