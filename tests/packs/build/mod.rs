//! Building packs: the readers of maps, whole builds, and the command, also killed.

mod command;
mod maps;
mod packs;
mod readers;
mod rejections;
