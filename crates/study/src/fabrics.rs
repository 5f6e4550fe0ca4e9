//! Built-in fabrics.

/// Names and files.
const KNOWN: [(&str, &str); 4] = [
    ("cotton-denim", include_str!("../../../fixtures/fabrics/cotton-denim.toml")),
    ("cotton-satin", include_str!("../../../fixtures/fabrics/cotton-satin.toml")),
    ("rayon-spandex-knit", include_str!("../../../fixtures/fabrics/rayon-spandex-knit.toml")),
    ("wool-cotton", include_str!("../../../fixtures/fabrics/wool-cotton.toml")),
];

/// Names of all built-in fabrics.
pub fn names() -> Vec<&'static str> {
    KNOWN.iter().map(|(name, _)| *name).collect()
}

/// File of a built-in fabric by name.
pub fn known(name: &str) -> Option<&'static str> {
    KNOWN.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}
