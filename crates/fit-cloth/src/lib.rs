//! The command line of fit-cloth.
