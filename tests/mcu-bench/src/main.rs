//! probe
#![allow(dead_code)]
mod chip;
mod cpu;
mod time;
mod trace;
use std::path::Path;
fn main() -> anyhow::Result<()> {
    let file = std::env::args().nth(1).unwrap();
    let mut board = cpu::Board::switch_on(Path::new(&file), chip::Crystal::Runs { mhz: 8 }, 32_000)?;
    let t = std::time::Instant::now();
    board.run(300 * time::MS)?;
    println!("{:?} {:?}", t.elapsed(), board.work());
    println!("{:?}", board.chip().unknown); println!("resets {:?}", board.resets);
    println!("{} handled {:?}", board.handled.len(), &board.handled[..board.handled.len().min(6)]);
    println!("{:?} baud {:?}", board.chip().line().sent.len(), board.chip().line_baud());
    for pin in [trace::Pin('B', 12), trace::Pin('A', 4), trace::Pin('A', 5), trace::Pin('C', 0), trace::Pin('C', 3)] {
        println!("{pin} {:?}", board.chip().trace.edges(pin).iter().take(5).collect::<Vec<_>>());
    }
    Ok(())
}
