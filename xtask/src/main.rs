//! Everything a person does with the repository.
fn main() {}
