//! The program `fit-cloth`.

fn main() {}
