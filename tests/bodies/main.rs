//! Bodies without contact: elements, meshes, loads, mass, norms, and linear answers compared with exact ones.

mod accuracy;
mod closed_forms;
mod elements;
mod facets;
mod gmsh_binary_faults;
mod gmsh_faults;
mod gmsh_forms;
mod gmsh_meshes;
mod loads;
mod manufactured;
mod mass;
mod materials;
mod mesh;
mod misfits;
mod norms;
mod patch_test;
mod temperature;
