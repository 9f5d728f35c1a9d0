//! Packs on disk: opened, read tile by tile and as whole maps, verified, previewed, and bad ones rejected.

mod coarsest;
mod command;
mod fixture;
mod mutations;
mod open;
mod parts;
mod tiles;
mod verify;
