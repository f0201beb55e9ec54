//! Writes meshes in every form of `.msh`: versions 4.1 and 2.2, as ASCII and as binary data in both byte orders.
//!
//! # Source
//! C. Geuzaine, J.-F. Remacle, *Gmsh Reference Manual*, chapter "Gmsh file formats", MSH file format and its version 2.

/// The form of numbers in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    Ascii,
    Little,
    Big,
}

/// Every form in every version.
pub const FORMS: [(f64, Form); 6] = [
    (4.1, Form::Ascii),
    (4.1, Form::Little),
    (4.1, Form::Big),
    (2.2, Form::Ascii),
    (2.2, Form::Little),
    (2.2, Form::Big),
];

/// Elements of one type on one entity of the geometry.
pub struct Part {
    pub dimension: i32,
    pub entity: i32,
    /// The physical group, or 0 for no group.
    pub group: i32,
    /// The number of the element type.
    pub number: i32,
    /// The nodes of each element by their tags.
    pub elements: Vec<Vec<u64>>,
}

/// The content of a file.
pub struct Drawing {
    /// Dimension, tag and name of each physical group that is written.
    pub names: Vec<(i32, i32, &'static str)>,
    /// Tag and coordinates of each node.
    pub nodes: Vec<(u64, [f64; 3])>,
    pub parts: Vec<Part>,
}

/// Writes numbers one after the other.
struct Pen {
    bytes: Vec<u8>,
    form: Form,
}

impl Pen {
    fn put<const N: usize>(&mut self, word: String, mut little: [u8; N]) {
        match self.form {
            Form::Ascii => self.bytes.extend(format!("{word} ").bytes()),
            Form::Little => self.bytes.extend(little),
            Form::Big => {
                little.reverse();
                self.bytes.extend(little);
            }
        }
    }

    fn int(&mut self, value: i32) {
        self.put(value.to_string(), value.to_le_bytes());
    }

    fn size(&mut self, value: u64) {
        self.put(value.to_string(), value.to_le_bytes());
    }

    fn double(&mut self, value: f64) {
        self.put(format!("{value:e}"), value.to_le_bytes());
    }

    /// Ends a line of an ASCII file.
    fn end(&mut self) {
        if self.form == Form::Ascii {
            self.bytes.push(b'\n');
        }
    }

    fn text(&mut self, text: &str) {
        self.bytes.extend(text.bytes());
    }
}

impl Drawing {
    pub fn written(&self, (version, form): (f64, Form)) -> Vec<u8> {
        let mut pen = Pen { bytes: Vec::new(), form };
        pen.text(&format!("$MeshFormat\n{version} {} 8\n", i32::from(form != Form::Ascii)));
        if form != Form::Ascii {
            pen.int(1);
            pen.text("\n");
        }
        pen.text(&format!("$EndMeshFormat\n$PhysicalNames\n{}\n", self.names.len()));
        for (dimension, tag, name) in &self.names {
            pen.text(&format!("{dimension} {tag} \"{name}\"\n"));
        }
        pen.text("$EndPhysicalNames\n");
        if version == 4.1 {
            self.entities(&mut pen);
            self.nodes_in_blocks(&mut pen);
            self.elements_in_blocks(&mut pen);
        } else {
            self.nodes_each_with_tag(&mut pen);
            self.elements_each_with_header(&mut pen);
        }
        pen.bytes
    }

    fn entities(&self, pen: &mut Pen) {
        pen.text("$Entities\n");
        let of = |dimension| self.parts.iter().filter(move |part| part.dimension == dimension);
        (0..4).for_each(|dimension| pen.size(of(dimension).count() as u64));
        pen.end();
        for part in (0..4).flat_map(of) {
            pen.int(part.entity);
            (0..if part.dimension == 0 { 3 } else { 6 }).for_each(|axis| pen.double(f64::from(axis) / 7.0));
            pen.size(u64::from(part.group != 0));
            if part.group != 0 {
                pen.int(part.group);
            }
            if part.dimension > 0 {
                pen.size(2);
                pen.int(3);
                pen.int(-3);
            }
            pen.end();
        }
        pen.text(if pen.form == Form::Ascii { "$EndEntities\n" } else { "\n$EndEntities\n" });
        // A reader skips this section: its content looks like the end of a section, but is not.
        pen.text("$Periodic\n$EndPeriodically \u{1}\u{10}");
        pen.text(if pen.form == Form::Ascii { "\n$EndPeriodic\n" } else { "$EndPeriodic\n" });
    }

    /// Nodes in two blocks, the second with parametric coordinates.
    fn nodes_in_blocks(&self, pen: &mut Pen) {
        let (first, second) = self.nodes.split_at(self.nodes.len() / 2);
        let tags = || self.nodes.iter().map(|node| node.0);
        pen.text("$Nodes\n");
        [2, self.nodes.len() as u64, tags().min().unwrap_or(0), tags().max().unwrap_or(0)]
            .iter()
            .for_each(|&count| pen.size(count));
        pen.end();
        for (parametric, nodes) in [(0, first), (1, second)] {
            [2, self.parts[0].entity, parametric].iter().for_each(|&value| pen.int(value));
            pen.size(nodes.len() as u64);
            pen.end();
            for (tag, _) in nodes {
                pen.size(*tag);
                pen.end();
            }
            for (_, at) in nodes {
                at.iter().for_each(|&value| pen.double(value));
                (0..2 * parametric).for_each(|_| pen.double(0.25));
                pen.end();
            }
        }
        // Most files have a line end after the numbers, but not all.
        pen.text("$EndNodes\n");
    }

    fn elements_in_blocks(&self, pen: &mut Pen) {
        let count = self.parts.iter().map(|part| part.elements.len() as u64).sum();
        pen.text("$Elements\n");
        [self.parts.len() as u64, count, 1, count].iter().for_each(|&count| pen.size(count));
        pen.end();
        let mut tag = 0;
        for part in &self.parts {
            [part.dimension, part.entity, part.number].iter().for_each(|&value| pen.int(value));
            pen.size(part.elements.len() as u64);
            pen.end();
            for nodes in &part.elements {
                tag += 1;
                pen.size(tag);
                nodes.iter().for_each(|&node| pen.size(node));
                pen.end();
            }
        }
        pen.text(if pen.form == Form::Ascii { "$EndElements\n" } else { "\n$EndElements\n" });
    }

    fn nodes_each_with_tag(&self, pen: &mut Pen) {
        pen.text(&format!("$Nodes\n{}\n", self.nodes.len()));
        for (tag, at) in &self.nodes {
            pen.int(*tag as i32);
            at.iter().for_each(|&value| pen.double(value));
            pen.end();
        }
        pen.text(if pen.form == Form::Ascii { "$EndNodes\n" } else { "\n$EndNodes\n" });
    }

    fn elements_each_with_header(&self, pen: &mut Pen) {
        let count: usize = self.parts.iter().map(|part| part.elements.len()).sum();
        pen.text(&format!("$Elements\n{count}\n"));
        let mut tag = 0;
        for part in &self.parts {
            if pen.form != Form::Ascii {
                [part.number, part.elements.len() as i32, 2].iter().for_each(|&value| pen.int(value));
            }
            for nodes in &part.elements {
                tag += 1;
                pen.int(tag);
                if pen.form == Form::Ascii {
                    [part.number, 2].iter().for_each(|&value| pen.int(value));
                }
                [part.group, part.entity].iter().for_each(|&value| pen.int(value));
                nodes.iter().for_each(|&node| pen.int(node as i32));
                pen.end();
            }
        }
        pen.text("$EndElements\n");
    }
}
