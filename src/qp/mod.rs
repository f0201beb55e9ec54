//! The certified quadratic program: minimise 1/2 u'K u - f'u subject to B u - g <= 0. It speaks no mechanics.

pub mod barrier;
pub mod linear;
pub mod matrix_market;
pub mod memory;
pub mod method;
pub mod problem;
pub mod solve;
pub mod transform;
