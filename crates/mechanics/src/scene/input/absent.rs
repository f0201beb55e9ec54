//! What the program does not model, by the names that other programs give it.

struct Absent {
    /// Its names in lower case, without spaces, hyphens and underscores, one space apart.
    names: &'static str,
    /// What is done instead, and what to take.
    instead: &'static str,
}

/// `docs/absent.md` has a row for each.
const ABSENT: [Absent; 7] = [
    Absent {
        names: "mu",
        instead: "friction is not modelled, every contact is frictionless, and elastic constants are `young` and `poisson`: leave the key \
                  out, or take CalculiX or code_aster for Coulomb friction",
    },
    Absent {
        names: "friction coulomb frictioncoefficient coefficientoffriction stickslip",
        instead: "friction is not modelled, every contact is frictionless: leave the key out, or take CalculiX or code_aster for Coulomb \
                  friction",
    },
    Absent {
        names: "contactstiffness penaltystiffness penalty normalstiffness overclosure pressureoverclosure",
        instead: "a contact stiffness is not needed, because the conditions of contact hold without one: leave the key out; `compare` \
                  shows the overlap that a penalty would leave",
    },
    Absent {
        names: "largesliding finitesliding sliding smallsliding",
        instead: "large sliding is not modelled, each node keeps its row: leave the key out if the body slides by less than a facet, or \
                  take CalculiX or code_aster",
    },
    Absent {
        names: "nlgeom largedisplacement largedisplacements largedeformation largedeformations largerotation \
                largerotations largestrain largestrains finitestrain geometricnonlinearity",
        instead: "large displacements are not modelled, strains are linear in the displacement: leave the key out if strains and \
                  rotations stay below some percent, or take CalculiX or code_aster",
    },
    Absent {
        names: "plastic plasticity yield yieldstress yieldstrength hardening hyperelastic mooneyrivlin neohookean",
        instead: "plasticity and hyperelasticity are not modelled, every material is linear elastic: compare the stress of the answer \
                  with the yield stress, or take CalculiX or code_aster",
    },
    Absent {
        names: "adhesion cohesion cohesive glue tied bonded",
        instead: "adhesion is not modelled, a contact only presses: `ties` glue surfaces together for good, and code_aster has cohesive zones",
    },
];

/// The sentence for a name that other programs give to a thing that is not modelled here; `None` for any other name.
pub(crate) fn absent(name: &str) -> Option<&'static str> {
    let plain: String = name.chars().filter(|c| !" -_".contains(*c)).flat_map(char::to_lowercase).collect();
    ABSENT.iter().find(|absent| absent.names.split(' ').any(|name| name == plain)).map(|absent| absent.instead)
}

/// The sentence about a text that is an input deck of Abaqus or CalculiX, or a mesh of Gmsh, instead of a scene.
pub(crate) fn other_format(text: &str) -> Option<String> {
    let first = text.lines().map(str::trim).find(|line| !line.is_empty())?;
    if first.starts_with("$MeshFormat") {
        return Some("this is a mesh of Gmsh, not a scene: `signorini new` writes a first scene for it".into());
    }
    let is_deck = first.starts_with("**") || first.strip_prefix('*')?.starts_with(|c: char| c.is_ascii_alphabetic());
    is_deck.then(|| {
        "this is an input deck of Abaqus or CalculiX, not a scene: give its file a name that ends with `.inp`, and `solve` and \
         `signorini new` read it"
            .into()
    })
}
