//! Scenes: accepted and refused input, the rows of obstacles, supports, and contact answers compared with closed forms.

#[path = "../support/bodies.rs"]
mod bodies;
#[path = "../support/closed_forms/mod.rs"]
mod exact_solutions;
#[path = "../support/oracles/mod.rs"]
mod oracles;
#[path = "../support/program.rs"]
mod program;
#[path = "../support/rollers.rs"]
mod rollers;
#[path = "../support/scenes.rs"]
mod solved_scene;
#[path = "../support/triangles.rs"]
mod triangles;

mod concave_obstacles;
mod contact_scenes;
mod dimensions;
mod every_shape;
mod inclined_frames;
mod inclined_supports;
mod loads;
mod materials;
mod mesh_scenes;
mod mortar;
mod obstacle_rows;
mod obstacles_in_space;
mod parts;
mod pressed;
mod resultants;
mod rigid_body_modes;
mod rigid_faces;
mod scene_errors;
mod scene_model;
mod slender;
mod springs;
mod surfaces;
mod symmetry;
mod temperature;
mod turned_bodies;
mod two_bodies;
mod user_obstacles;
mod verification;
mod whole;
