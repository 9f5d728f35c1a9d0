//! Building packs: the readers of maps, whole builds, and the command, also killed.

#[cfg(feature = "command")]
mod command;
mod maps;
mod packs;
mod readers;
mod refusals;
