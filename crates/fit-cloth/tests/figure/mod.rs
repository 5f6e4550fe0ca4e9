//! An SVG figure: its elements, and its texts with their positions.

#![allow(clippy::unwrap_used, reason = "a figure that cannot be read has failed")]

use roxmltree::{Document, Node};
use std::path::Path;

/// Attributes that hold numbers or pairs of numbers.
const NUMBERS: [&str; 17] = [
    "x",
    "y",
    "x1",
    "y1",
    "x2",
    "y2",
    "cx",
    "cy",
    "r",
    "width",
    "height",
    "points",
    "viewBox",
    "font-size",
    "stroke-width",
    "opacity",
    "transform",
];

/// An SVG file.
pub(crate) struct Figure {
    pub(crate) name: String,
    pub(crate) svg: String,
}

/// A line of text and its bounding box: left, top, right, bottom.
#[derive(Debug, Clone)]
pub(crate) struct Text {
    pub(crate) content: String,
    edges: [f64; 4],
}

impl Figure {
    pub(crate) fn read(path: &Path) -> Self {
        let name = path.file_stem().unwrap().to_str().unwrap().into();
        let svg = std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        Self { name, svg }
    }

    /// Number of elements with a tag and all these attributes.
    pub(crate) fn count(&self, tag: &str, attributes: &[(&str, &str)]) -> usize {
        let document = Document::parse(&self.svg).unwrap();
        let has =
            |node: &Node<'_, '_>| attributes.iter().all(|(key, value)| node.attribute(*key) == Some(value));
        document.descendants().filter(|node| node.has_tag_name(tag) || local(node) == tag).filter(has).count()
    }

    /// Extent along x of every line of a colour and width, in pixels.
    pub(crate) fn spans(&self, colour: &str, width: &str) -> Vec<[f64; 2]> {
        let document = Document::parse(&self.svg).unwrap();
        let is_one = |node: &Node<'_, '_>| {
            local(node) == "polyline"
                && (node.attribute("stroke"), node.attribute("stroke-width")) == (Some(colour), Some(width))
        };
        let span = |node: Node<'_, '_>| {
            let places = numbers(node.attribute("points").unwrap()).unwrap();
            let across = || places.iter().step_by(2).copied();
            [across().fold(f64::MAX, f64::min), across().fold(f64::MIN, f64::max)]
        };
        document.descendants().filter(is_one).map(span).collect()
    }

    /// All lines of text.
    pub(crate) fn texts(&self) -> Vec<Text> {
        let document = Document::parse(&self.svg).unwrap();
        document.descendants().filter(|node| local(node) == "text").map(|node| text(&node)).collect()
    }

    /// Wanted lines of text that are missing.
    pub(crate) fn missing(&self, wanted: &[&str]) -> Vec<String> {
        let texts = self.texts();
        let is_missing = |wanted: &&&str| texts.iter().all(|text| text.content != **wanted);
        wanted.iter().filter(is_missing).map(|text| format!("{}: no \"{text}\"", self.name)).collect()
    }

    /// Faults that no figure may have.
    pub(crate) fn faults(&self) -> Vec<String> {
        let document = match Document::parse(&self.svg) {
            Ok(document) => document,
            Err(error) => return vec![format!("{}: {error}", self.name)],
        };
        let root = document.root_element();
        let [wide, high] =
            ["width", "height"].map(|side| root.attribute(side).unwrap().parse::<f64>().unwrap());
        let mut faults = Vec::new();
        if root.attribute("viewBox") != Some(&format!("0 0 {wide} {high}")) {
            faults.push("its view is not its size".into());
        }
        for node in document.descendants().filter(Node::is_element) {
            for attribute in node.attributes().filter(|attribute| NUMBERS.contains(&attribute.name())) {
                let Some(numbers) = numbers(attribute.value()) else {
                    faults.push(format!("{}=\"{}\" is no number", attribute.name(), attribute.value()));
                    continue;
                };
                let most = match attribute.name() {
                    "x" | "x1" | "x2" | "cx" => [wide, wide],
                    "y" | "y1" | "y2" | "cy" => [high, high],
                    "points" => [wide, high],
                    _ => continue,
                };
                let outside = |(i, number): (usize, &f64)| !(0.0..=most[i % 2]).contains(number);
                if numbers.iter().enumerate().any(outside) {
                    faults.push(format!(
                        "{} {}=\"{}\" outside",
                        local(&node),
                        attribute.name(),
                        attribute.value()
                    ));
                }
            }
        }
        let texts = self.texts();
        for (index, text) in texts.iter().enumerate() {
            let [left, top, right, bottom] = text.edges;
            if left < 0.0 || top < 0.0 || right > wide || bottom > high {
                faults.push(format!("{text:?} leaves the figure"));
            }
            if ["NaN", "inf", "not drawn"].iter().any(|word| text.content.contains(word)) {
                faults.push(format!("{text:?}"));
            }
            faults.extend(
                texts[..index]
                    .iter()
                    .filter(|other| text.overlaps(other))
                    .map(|other| format!("{text:?} over {other:?}")),
            );
        }
        faults.iter().map(|fault| format!("{}: {fault}", self.name)).collect()
    }
}

impl Text {
    fn overlaps(&self, other: &Self) -> bool {
        let ([a, b, c, d], [e, f, g, h]) = (self.edges, other.edges);
        a < g && e < c && b < h && f < d
    }
}

fn local<'d>(node: &Node<'d, '_>) -> &'d str {
    node.tag_name().name()
}

/// The numbers between letters, brackets and commas; `None` if one is invalid.
fn numbers(value: &str) -> Option<Vec<f64>> {
    let inner = value.trim_start_matches("rotate(").trim_end_matches(')');
    let parts = inner.split([' ', ',']).filter(|part| !part.is_empty());
    parts.map(|part| part.parse().ok().filter(|number: &f64| number.is_finite())).collect()
}

/// Bounding box of a text: per character 0.6 of the font size wide and one font size high, placed by its anchor.
fn text(node: &Node<'_, '_>) -> Text {
    let content = node.text().unwrap_or_default().trim().to_string();
    let number =
        |name: &str| node.attribute(name).and_then(|value| value.parse::<f64>().ok()).unwrap_or(f64::NAN);
    let [x, y, size] = ["x", "y", "font-size"].map(number);
    let length = 0.6 * size * content.chars().count() as f64;
    let from = match node.attribute("text-anchor") {
        Some("end") => -length,
        Some("middle") => -0.5 * length,
        _ => 0.0,
    };
    let above = match node.attribute("dy") {
        Some("0.76em") => 0.0,
        Some("0.5ex") => -0.5 * size,
        _ => -size,
    };
    let (to, below) = (from + length, above + size);
    let edges = match node.attribute("transform") {
        // Reads upwards.
        Some(turn) if turn.starts_with("rotate(270") => [x + above, y - to, x + below, y - from],
        Some(turn) => panic!("{turn}"),
        None => [x + from, y + above, x + to, y + below],
    };
    Text { content, edges }
}
