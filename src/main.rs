//! The `nagata` program.

fn main() {
    std::process::exit(nagata::cli::run());
}
