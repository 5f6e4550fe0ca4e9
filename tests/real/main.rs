//! Tests on reference and measured data outside the repository. The environment variable `FIT_CLOTH_DATA` names the
//! data folder: `FIT_CLOTH_DATA=… cargo test -p fit-cloth-tests --test real`.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod analytic;
mod bending_laws;
mod bias;
mod cantilever;
mod drape;
mod hang;
mod knits;
mod motion;
mod nist;
mod picture_frame;
mod repeats;
mod strips;
mod synthetic;
mod wool;
