//! Chores of this repository: `cargo xtask --help`.

mod admission;
mod bench;
mod boards;
mod boot;
mod budget;
mod callgraph;
mod ci;
mod client;
mod cores;
mod cycles;
mod elf;
mod emulate;
mod footprints;
mod fuzz;
mod house;
mod image;
mod insns;
mod nightly;
mod other_boards;
mod packages;
mod page;
mod parallel;
mod planning;
mod programs;
mod qemu;
mod reference;
mod repository;
mod rp2040;
mod senders;
mod simulators;
mod size;
mod steps;
mod symbols;
mod table;
mod weight;
mod wire;

use clap::{Parser, Subcommand};

#[derive(Parser)]
#[command(name = "cargo xtask", about = "Chores of this repository")]
struct Arguments {
    #[command(subcommand)]
    chore: Chore,
}

#[derive(Subcommand)]
enum Chore {
    /// Count the instructions of every tick of a scene's job, under QEMU
    Insns(budget::Options),
    /// Count the instructions of the admission of every move of a scene's job, under QEMU
    Admission(budget::Options),
    /// Count the instructions of a plan of 100 cells, under QEMU
    Planning(budget::Options),
    /// Model the cycles of the tick, the service and the admission on boards, from traces under QEMU
    Cycles(budget::Options),
    /// Measure flash and RAM: the tick alone on every target, and the firmware
    Size(budget::Options),
    /// Build the firmware for the RP2040, check that it can boot, print its size
    Rp2040(rp2040::Rp2040Args),
    /// Build the firmware for the STM32G474, check that it can boot, print its size
    G474,
    /// Boot the firmware in QEMU, play jobs on it with every client, compare every sample
    Emulate(emulate::EmulateArgs),
    /// Build the boot loaders of the STM32F405 and the STM32G474, check that they can boot, print their sizes
    Boot,
    /// Execute the firmware with a model of its registers, check pins and times of drives and tool
    Bench(bench::BenchArgs),
    /// Play jobs on trirrr device with the Python client, compare its tables
    Client,
    /// Compare torques with those of MuJoCo and Pinocchio
    Simulators,
    /// Drive trirrr grbl by senders of G-code that users have
    Senders,
    /// Build the page as one file, and test it in a headless Chromium
    Page(page::PageArgs),
    /// Print the tables of docs/footprints.md and docs/cycles.md, from the figures checked in
    Footprints(footprints::FootprintsArgs),
    /// Fuzz the decoder and the service's commands
    Fuzz(fuzz::FuzzArgs),
    /// Print figures of the source's shape: type parameters, names, openings of docs, lines, examples
    House(house::HouseArgs),
    /// Print how deep the stack of an image gets, and on which ways
    Stack(callgraph::StackArgs),
    /// Count the services in the program; check what the main job compiles, holds, and hands over
    Weight(weight::WeightArgs),
    /// Write the reference of docs/wire.md, and messages and texts of the Python client, from the protocol's types
    Wire(wire::WireArgs),
    /// Everything that CI checks
    Ci,
    /// Checks that take longer than CI may: dependencies, long fuzzing, many random moves
    Nightly(nightly::NightlyArgs),
}

fn main() -> anyhow::Result<()> {
    match Arguments::parse().chore {
        Chore::Insns(options) => insns::run(&options),
        Chore::Admission(options) => admission::run(&options),
        Chore::Planning(options) => planning::run(&options),
        Chore::Cycles(options) => cycles::run(&options),
        Chore::Footprints(arguments) => footprints::run(&arguments),
        Chore::Size(options) => size::run(&options),
        Chore::Rp2040(arguments) => rp2040::run(&arguments),
        Chore::G474 => other_boards::g474(),
        Chore::Emulate(arguments) => emulate::run(&arguments),
        Chore::Boot => boot::run(),
        Chore::Bench(arguments) => bench::run(&arguments),
        Chore::Client => client::run(),
        Chore::Senders => senders::run(),
        Chore::Simulators => simulators::run(),
        Chore::Page(arguments) => page::run(&arguments),
        Chore::Fuzz(arguments) => fuzz::run(&arguments),
        Chore::House(arguments) => house::run(&arguments),
        Chore::Stack(arguments) => callgraph::run(&arguments),
        Chore::Weight(arguments) => weight::run(&arguments),
        Chore::Wire(arguments) => wire::run(&arguments),
        Chore::Ci => ci::run(),
        Chore::Nightly(arguments) => nightly::run(&arguments),
    }
}
