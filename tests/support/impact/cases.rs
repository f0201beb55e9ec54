//! GOAL: two bars in impact with a known motion.
//! CONDITIONS: a free bar that flies against a wall, and a held bar that bounces on it with the period 3.
//! REFERENCE: `closed_forms::ImpactingBar`, `closed_forms::BouncingBar`.

use crate::closed_forms::{BouncingBar, ImpactingBar};

use super::measure::Case;

const BAR: ImpactingBar =
    ImpactingBar { length: 10.0, axial_stiffness: 900.0, line_density: 1.0, speed: 10.0, gap: 5.0 };

/// Returns the bar that hits a wall, and the bar that bounces with period 3.
pub fn cases() -> [Case; 2] {
    [
        Case {
            name: "bar against a wall",
            scene: "bar",
            displacement: |x, t| BAR.displacement(x, t),
            contact: BAR.contact(),
            pressure: BAR.force(),
            rebound: Some(BAR.speed),
            reach: BAR.speed * BAR.length / BAR.wave_speed(),
        },
        Case {
            name: "bar of period 3",
            scene: "bouncing_bar",
            displacement: |x, t| BouncingBar.displacement(x, t),
            contact: [1.0, 2.0],
            pressure: 0.5,
            rebound: None,
            reach: 0.5,
        },
    ]
}
