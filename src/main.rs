//! The `nagata` program.

fn main() {
    petsc::environment::leave(nagata::cli::run())
}
