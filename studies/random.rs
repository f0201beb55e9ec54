//! The random scenes of the tests, by kind.

use signorini::Scene;
use support::{axis_scenes, key_scenes, pair_scenes, plane_scenes, space_scenes};

/// The random scene of a seed, with the name of its elements.
type Random = fn(u64) -> (Scene, &'static str);

const KINDS: [(&str, Random); 5] = [
    ("plane", plane_scenes::scene),
    ("axis", axis_scenes::scene),
    ("space", space_scenes::scene),
    ("keys", key_scenes::scene),
    ("pairs", pair_scenes::scene),
];

/// Returns one scene of the first `kinds` kinds, which alternate: its kind, its seed, and itself.
pub fn scene(number: u64, kinds: u64) -> (&'static str, u64, Scene) {
    let (kind, scene) = KINDS[(number % kinds) as usize];
    let seed = 1 + number / kinds;
    (kind, seed, scene(seed).0)
}
