//! Tests on real measurements. They run only when asked for:
//! `FIT_CLOTH_DATA=<folder> cargo test -p fit-cloth-tests --test real`.

mod nist;
