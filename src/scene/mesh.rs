//! The mesh of a scene's body.

use std::path::{Path, PathBuf};

use super::body::DescribedBody;
use super::entry::{located, wrong};
use super::schema::{
    AxisSpec, BodySpec, ElementSpec, GmshSpec, HalfSpec, IntegrationSpec, SolidElementSpec, SymmetrySpec, ZoneSpec,
};
use crate::error::Error;
use crate::fem::mesh::gmsh::GmshFile;
use crate::fem::mesh::{self, Axis, ElementKind, Mesh, Zone};

impl BodySpec {
    /// As it is written.
    pub(super) fn name(&self) -> &'static str {
        match self {
            BodySpec::Rectangle(_) => "rectangle",
            BodySpec::Bar(_) => "bar",
            BodySpec::Box(_) => "box",
            BodySpec::Disc(_) => "disc",
            BodySpec::HalfDisc(_) => "half-disc",
            BodySpec::HalfBall(_) => "half-ball",
            BodySpec::Ring(_) => "ring",
            BodySpec::Gmsh(_) => "gmsh",
        }
    }

    /// The coordinates that the body has; those of a mesh file are known when it has been read.
    pub(super) fn dimension(&self) -> Option<usize> {
        match self {
            BodySpec::Bar(_) => Some(1),
            BodySpec::Rectangle(_) | BodySpec::Disc(_) | BodySpec::HalfDisc(_) | BodySpec::Ring(_) => Some(2),
            BodySpec::Box(_) | BodySpec::HalfBall(_) => Some(3),
            BodySpec::Gmsh(_) => None,
        }
    }

    pub(super) fn integration(&self) -> IntegrationSpec {
        match self {
            BodySpec::Bar(_) => IntegrationSpec::Standard,
            BodySpec::Rectangle(spec) => spec.integration,
            BodySpec::Box(spec) => spec.integration,
            BodySpec::Disc(spec) => spec.integration,
            BodySpec::HalfDisc(spec) => spec.integration,
            BodySpec::HalfBall(spec) => spec.integration,
            BodySpec::Ring(spec) => spec.integration,
            BodySpec::Gmsh(spec) => spec.integration,
        }
    }
}

impl DescribedBody<'_> {
    pub(super) fn mesh(&self) -> Result<Mesh, Error> {
        self.spec.check_count(self.path(""))?;
        let lines = |spec: &AxisSpec, axis: &str| {
            let of =
                Axis { points: spec.points.clone(), divisions: spec.divisions.clone(), ratios: spec.ratios.clone() };
            of.coordinates().map_err(|error| wrong(self.path(&format!(".{axis}.{}", error.field)), error.message))
        };
        let mesh = match self.spec {
            BodySpec::Bar(spec) => mesh::bar(&lines(&spec.x, "x")?),
            BodySpec::Rectangle(spec) => {
                mesh::rectangle(&lines(&spec.x, "x")?, &lines(&spec.y, "y")?, spec.element.kind())
            }
            BodySpec::Box(spec) => {
                let kind = match spec.element {
                    SolidElementSpec::Tet4 => ElementKind::Tet4,
                    SolidElementSpec::Hex8 => ElementKind::Hex8,
                };
                mesh::cuboid(&lines(&spec.x, "x")?, &lines(&spec.y, "y")?, &lines(&spec.z, "z")?, kind)
            }
            BodySpec::Disc(spec) => {
                mesh::disc(spec.centre, spec.radius, &spec.zone.zone(), spec.symmetric, spec.element.kind())
            }
            BodySpec::HalfDisc(spec) => {
                mesh::half_disc(spec.centre, spec.radius, &spec.zone.zone(), spec.symmetric, spec.element.kind())
                    .map(|mesh| spec.half.of(mesh, 1, spec.centre[1]))
            }
            BodySpec::HalfBall(spec) => {
                let symmetric = [SymmetrySpec::X, SymmetrySpec::Y].map(|axis| spec.symmetric.contains(&axis));
                mesh::half_ball(spec.centre, spec.radius, &spec.zone.zone(), symmetric)
                    .map(|mesh| spec.half.of(mesh, 2, spec.centre[2]))
            }
            BodySpec::Ring(spec) => {
                let (radii, angles) = (lines(&spec.radius, "radius")?, lines(&spec.angle, "angle")?);
                mesh::ring(spec.centre, &radii, &angles, spec.element.kind())
            }
            BodySpec::Gmsh(spec) => self.gmsh(spec),
        };
        mesh.map_err(|error| self.at_body(error))
    }

    /// An error of the mesh at its place in the scene; what has a file and a line of its own stays there.
    pub(super) fn at_body(&self, error: Error) -> Error {
        match error {
            Error::Mesh { message } => wrong(self.path(""), message),
            other => located(other, &self.path(".")),
        }
    }

    /// The mesh file that is named, which lies below the folder of the scene once `..` and links are followed, unless the
    /// scene may read outside.
    fn mesh_file(&self, spec: &GmshSpec) -> Result<PathBuf, Error> {
        // The folder of a scene that is named alone is the empty path.
        let folder = self.scene.folder.as_deref().unwrap_or(Path::new(""));
        let file = folder.join(&spec.file);
        if self.scene.reads_outside {
            return Ok(file);
        }
        let real = |path: &Path| {
            path.canonicalize().map_err(|source| Error::File { action: "read", path: path.into(), source })
        };
        let home = real(if folder.as_os_str().is_empty() { Path::new(".") } else { folder })?;
        if !real(&file)?.starts_with(home) {
            let message = format!(
                "the file {} lies outside the folder of the scene; copy it there, or allow it (--allow-outside)",
                file.display()
            );
            return Err(wrong(self.path(".file"), message));
        }
        Ok(file)
    }

    fn gmsh(&self, spec: &GmshSpec) -> Result<Mesh, Error> {
        let mesh = GmshFile::read(self.mesh_file(spec)?)?.mesh(spec.group.as_deref(), spec.scale)?;
        let (found, model) = (mesh.dimension(), self.scene.model.name());
        if found != self.scene.model.dimension() {
            let body = ["a bar", "plane", "in space"][found - 1];
            return Err(wrong(
                self.path(".file"),
                format!("the mesh is {body}, which is no body of the model `{model}`"),
            ));
        }
        Ok(mesh)
    }
}

impl ElementSpec {
    fn kind(self) -> ElementKind {
        match self {
            ElementSpec::T3 => ElementKind::T3,
            ElementSpec::T6 => ElementKind::T6,
            ElementSpec::Q4 => ElementKind::Q4,
            ElementSpec::Q8 => ElementKind::Q8,
        }
    }
}

impl HalfSpec {
    /// The half of a body of which `lower` is the lower one, the cut lying where the coordinate `axis` is `centre`.
    fn of(self, lower: Mesh, axis: usize, centre: f64) -> Mesh {
        match self {
            HalfSpec::Lower => lower,
            HalfSpec::Upper => lower.mirrored(axis, centre),
        }
    }
}

impl ZoneSpec {
    pub(super) fn zone(&self) -> Zone {
        Zone { width: self.width, divisions: self.divisions, growth: self.growth }
    }
}
