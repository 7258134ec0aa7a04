//! What takes minutes: commands whose results are figures, in their quick runs. `cargo xtask test` leaves these out; their own command is
//! `cargo test --release -p whole-system --test figures`.

mod choices;
mod scaling;
