//! `cargo xtask cycles`: modelled cycles of the tick, of the service's tick and of the admission.
//!
//! The images are those that count instructions. QEMU runs them and logs each instruction of some of the calls;
//! the timing tables of the cores and a model of their flash turn that into cycles. `docs/cycles.md` has the
//! tables, their sources and what they leave out.

mod boards;
pub(crate) mod document;
mod flash;
mod gdb;
mod measure;
mod model;
mod operation;
#[cfg(test)]
mod tests;
mod timing;
mod trace;

use crate::admission;
use crate::budget::{BudgetRow, Ceiling, Options, hold_ceilings};
use crate::cores::{self, Core};
use crate::image::Image;
use crate::insns::{counts::Counts, has_service};
use crate::repository::SceneFile;
use crate::{parallel, qemu};
use anyhow::{Context, Result};
use boards::{BOARDS, Memory};
use measure::{Calls, Meter, Traced, measure};
use model::Classes;
use serde::{Deserialize, Serialize};
use std::path::Path;
use trirrr_scene::Scene;

/// Ceilings that no change may exceed, cycles.
const CEILINGS: [Ceiling; 18] = [
    Ceiling::new("m4f f32 thesis tick ram", "max", 1100.0),
    Ceiling::new("m4f f32 thesis tick flash", "max", 1250.0),
    Ceiling::new("m4f f32 thesis-links tick ram", "max", 1310.0),
    Ceiling::new("m4f f32 thesis-links tick flash", "max", 1450.0),
    Ceiling::new("m3 fixed thesis tick ram", "max", 3400.0),
    Ceiling::new("m0 fixed thesis tick ram", "max", 15_000.0),
    // Of the service with a sample in each tick, with holds and homing.
    Ceiling::new("m4f f32 * service ram", "max", 3400.0),
    Ceiling::new("m4f f32 * service flash", "max", 4000.0),
    // Its drives are heard, six frames in a tick, watched in the service, and commanded.
    Ceiling::new("m4f f32 odrive service ram", "max", 5400.0),
    Ceiling::new("m4f f32 odrive service flash", "max", 6400.0),
    // Their encoders are read for the service, and one sample of the loops is counted with the tick.
    Ceiling::new("m4f f32 bldc-massless service ram", "max", 4500.0),
    Ceiling::new("m4f f32 bldc-massless service flash", "max", 5400.0),
    Ceiling::new("m4f f32 vertical service ram", "max", 4500.0),
    Ceiling::new("m4f f32 vertical service flash", "max", 5400.0),
    // Their jobs are planned. The tick in which a move begins takes more numbers over, and a setpoint is that of a quintic.
    Ceiling::new("m4f f32 engraving service ram", "max", 4200.0),
    Ceiling::new("m4f f32 engraving service flash", "max", 5200.0),
    Ceiling::new("m4f f32 plotter service ram", "max", 4200.0),
    Ceiling::new("m4f f32 plotter service flash", "max", 5200.0),
];

/// Modelled cycles of one piece of work on one board, with the setpoint in the tick.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct CyclesRow {
    core: String,
    scalar: String,
    scene: String,
    /// `tick`: setpoint and pipeline; `service`: the tick of the service; `slice`: a slice of admission;
    /// `admission`: the whole of one move.
    what: String,
    /// `ram`: no wait states; `flash`: with those of the board, caches as the tick before left them;
    /// `flash-cold`: with empty caches.
    memory: String,
    board: String,
    mhz: f64,
    /// Calls that the mean is made of.
    calls: usize,
    instructions: f64,
    mean: f64,
    max: f64,
    /// The setpoint alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    setpoint_mean: Option<f64>,
    us_mean: f64,
    us_max: f64,
    // Mean cycles by class.
    float: f64,
    divide: f64,
    multiply: f64,
    integer: f64,
    load: f64,
    store: f64,
    multiple: f64,
    branch: f64,
    stall: f64,
    flash: f64,
}

impl CyclesRow {
    /// Mean cycles by class, waits of the flash apart, in the order of the columns.
    fn classes(&self) -> [f64; 9] {
        [
            self.float,
            self.divide,
            self.multiply,
            self.integer,
            self.load,
            self.store,
            self.multiple,
            self.branch,
            self.stall,
        ]
    }
}

impl BudgetRow for CyclesRow {
    const KEY: &str = "core scalar scene what memory";
    const FIGURES: &str = "mean max setpoint_mean";
    const COLUMNS: &str = "core scalar scene what memory board mhz instructions mean max setpoint_mean us_mean us_max \
                           float divide multiply integer load store multiple branch stall flash";

    /// Code that moves in an image lies in other lines of the flash, although nothing in it has changed.
    fn tolerance(&self) -> f64 {
        match self.memory == Memory::Ram.name() {
            true => crate::budget::TOLERANCE,
            false => 0.06,
        }
    }
}

pub(crate) fn run(options: &Options) -> Result<()> {
    let rows = all(options)?;
    options.print(&rows)?;
    hold_ceilings(&rows, &CEILINGS)?;
    options.settle("cycles", rows)
}

fn all(options: &Options) -> Result<Vec<CyclesRow>> {
    let scenes = options.scenes()?;
    let cores = timed(options.cores()?);
    let has_admission = cores.iter().any(|core| core.name == admission::CORE);
    // None: admission, which has a number type of its own.
    let mut jobs = Vec::new();
    for file in &scenes {
        let scalars = options.scalars(&Scene::read(&file.path)?);
        let scalars = scalars.into_iter().map(Some);
        let admission = has_admission.then_some(None);
        jobs.extend(scalars.chain(admission).map(|scalar| (file, scalar)));
    }
    let rows = parallel::map(parallel::workers(), &jobs, |(file, scalar)| match scalar {
        Some(scalar) => ticks(&cores, file, scalar),
        None => admissions(file),
    })?;
    Ok(rows.into_iter().flatten().collect())
}

/// Those of `cores` that there is a timing table for.
fn timed(mut cores: Vec<&'static Core>) -> Vec<&'static Core> {
    cores.retain(|core| BOARDS.iter().any(|board| board.emulated == core.name));
    cores
}

fn ticks(
    cores: &[&'static Core],
    file: &SceneFile,
    scalar: &'static str,
) -> Result<Vec<CyclesRow>> {
    let scene = Scene::read(&file.path)?;
    let targets: Vec<_> = cores.iter().map(|core| core.target).collect();
    let first = cores.first().context("a core with a timing table")?;
    let images = Image::insns("count", file, scalar, first.target).build_for(&targets)?;
    let mut rows = Vec::new();
    for (&core, image) in cores.iter().zip(images) {
        let of = |what| Subject { file, scalar, what };
        let traced = tick(core, &image).with_context(|| format!("{} {scalar}", core.name))?;
        rows.extend(of("tick").rows(&traced));
        if has_service(core, &scene, scalar) {
            let image = Image::insns("serve", file, scalar, core.target);
            let [image, _] = image.build_with("bare-service")?;
            let traced = service(core, &image)?;
            rows.extend(of("service").rows(&traced));
        }
    }
    Ok(rows)
}

/// Setpoint and tick.
fn tick(core: &Core, image: &Path) -> Result<Traced> {
    let printed = qemu::run(core, image)?;
    let counts = Counts::parse(&printed, core.units_per_instruction, &["tick"], 3)?;
    let columns = [counts.column("tick", 1), counts.column("tick", 0)];
    let lengths: Vec<u32> = columns[0]
        .iter()
        .zip(&columns[1])
        .map(|(set, tick)| set + tick)
        .collect();
    let calls = Calls {
        stop: "count::counter::stop",
        functions: &["trirrr_insns::tick::set", "trirrr_insns::tick::evaluate"],
        counted: &|function, call| columns[function].get(call).copied(),
        of: 0..lengths.len(),
        longest: longest(&lengths, 0),
    };
    measure(core, image, &calls, mean(&lengths))
}

/// The longest, behind `before` other calls.
fn longest(lengths: &[u32], before: usize) -> Vec<usize> {
    let place = (0..lengths.len()).max_by_key(|place| lengths[*place]);
    place.map(|place| before + place).into_iter().collect()
}

fn mean(lengths: &[u32]) -> f64 {
    lengths.iter().copied().map(f64::from).sum::<f64>() / lengths.len() as f64
}

/// The service's tick: the mean while it plays the job, the longest of holds and homing, too.
fn service(core: &Core, image: &Path) -> Result<Traced> {
    let printed = qemu::run(core, image)?;
    let kinds = ["homing", "tick", "held"];
    let counts = Counts::parse(&printed, core.units_per_instruction, &kinds, 1)?;
    let [homing, job, held] = kinds.map(|kind| counts.column(kind, 0));
    // Behind the job comes a call that finds it done, and prints nothing.
    let job_end = homing.len() + job.len();
    let calls: Vec<Option<u32>> = [&homing, &job]
        .into_iter()
        .flatten()
        .copied()
        .map(Some)
        .chain([None])
        .chain(held.iter().copied().map(Some))
        .collect();
    let longest = [
        longest(&homing, 0),
        longest(&job, homing.len()),
        longest(&held, job_end + 1),
    ];
    let calls = Calls {
        stop: "serve::counter::stop",
        functions: &["trirrr_insns::service::tick"],
        counted: &|_, call| calls.get(call).copied().flatten(),
        of: homing.len()..job_end,
        longest: longest.concat(),
    };
    measure(core, image, &calls, mean(&job))
}

/// A slice of admission, and a whole move: as many slices as the image has counted instructions for.
fn admissions(file: &SceneFile) -> Result<Vec<CyclesRow>> {
    let core = cores::named(admission::CORE).context("a core of the table")?;
    let image = admission::image(file, core)?;
    let printed = qemu::run(core, &image)?;
    let mut moves = admission::parse(&printed, core.units_per_instruction)?;
    // The second half is the same moves with every limit.
    moves.truncate(moves.len() / 2);
    let slices: usize = moves.iter().map(|one| one.intervals as usize).sum();
    let totals: Vec<f64> = moves.iter().map(|one| one.total).collect();
    let sum: f64 = totals.iter().sum();
    let calls = Calls {
        stop: "admit::counter::stop",
        functions: &["admit::run::step"],
        counted: &|_, _| None,
        of: 0..slices,
        longest: Vec::new(),
    };
    let traced = measure(core, &image, &calls, sum / slices as f64)?;
    let of = |what| Subject {
        file,
        scalar: admission::SCALAR,
        what,
    };
    let slice = of("slice").rows(&traced);
    let mean = sum / totals.len() as f64;
    let longest = totals.iter().copied().fold(0.0, f64::max);
    let whole = slice
        .iter()
        .map(|row| row.scaled("admission", mean, longest));
    Ok(slice.iter().cloned().chain(whole).collect())
}

/// Subject of rows.
struct Subject<'a> {
    file: &'a SceneFile,
    scalar: &'a str,
    what: &'a str,
}

impl Subject<'_> {
    fn rows(&self, traced: &Traced) -> Vec<CyclesRow> {
        let meters = traced.meters.iter();
        meters.map(|meter| self.row(traced, meter)).collect()
    }

    fn row(&self, traced: &Traced, meter: &Meter) -> CyclesRow {
        let total = |parts: &Vec<Classes>| parts.iter().map(Classes::total).sum::<u64>() as f64;
        let count = traced.even.len() as f64;
        let even = || traced.even.iter().map(|call| &meter.samples[call]);
        let mean = even().map(total).sum::<f64>() / count;
        let max = meter.samples.values().map(total).fold(0.0, f64::max);
        let has_setpoint = even().all(|parts| parts.len() == 2);
        let setpoint = even().map(|parts| parts[0].total() as f64).sum::<f64>() / count;
        let mut classes = Classes::default();
        for part in even().flatten() {
            classes += *part;
        }
        let class = |cycles: u64| tenths(cycles as f64 / count);
        let mhz = meter.board.mhz;
        CyclesRow {
            core: meter.board.core.into(),
            scalar: self.scalar.into(),
            scene: self.file.name.clone(),
            what: self.what.into(),
            memory: meter.memory.name().into(),
            board: meter.board.name.into(),
            mhz,
            calls: traced.even.len(),
            instructions: tenths(traced.mean_instructions()),
            mean: tenths(mean),
            max,
            setpoint_mean: has_setpoint.then_some(tenths(setpoint)),
            us_mean: hundredths(mean / mhz),
            us_max: hundredths(max / mhz),
            float: class(classes.float),
            divide: class(classes.divide),
            multiply: class(classes.multiply),
            integer: class(classes.integer),
            load: class(classes.load),
            store: class(classes.store),
            multiple: class(classes.multiple),
            branch: class(classes.branch),
            stall: class(classes.stall),
            flash: class(classes.flash),
        }
    }
}

impl CyclesRow {
    /// The same code for `mean` instructions, and at most `longest`.
    fn scaled(&self, what: &str, mean: f64, longest: f64) -> Self {
        let by = mean / self.instructions;
        let max = tenths(self.mean * longest / self.instructions);
        let class = |cycles: f64| tenths(cycles * by);
        Self {
            what: what.into(),
            instructions: tenths(mean),
            mean: tenths(self.mean * by),
            max,
            us_mean: hundredths(self.mean * by / self.mhz),
            us_max: hundredths(max / self.mhz),
            float: class(self.float),
            divide: class(self.divide),
            multiply: class(self.multiply),
            integer: class(self.integer),
            load: class(self.load),
            store: class(self.store),
            multiple: class(self.multiple),
            branch: class(self.branch),
            stall: class(self.stall),
            flash: class(self.flash),
            ..self.clone()
        }
    }
}

fn tenths(value: f64) -> f64 {
    (10.0 * value).round() / 10.0
}

fn hundredths(value: f64) -> f64 {
    (100.0 * value).round() / 100.0
}

#[cfg(test)]
mod rows {
    use super::*;

    fn row(memory: &str, mean: f64) -> CyclesRow {
        CyclesRow {
            core: "m4f".into(),
            scalar: "f32".into(),
            scene: "thesis".into(),
            what: "slice".into(),
            memory: memory.into(),
            board: "STM32F405".into(),
            mhz: 168.0,
            calls: 4,
            instructions: 1000.0,
            mean,
            max: 2100.0,
            setpoint_mean: None,
            us_mean: 11.9,
            us_max: 12.5,
            float: 0.0,
            divide: 0.0,
            multiply: 0.0,
            integer: mean,
            load: 0.0,
            store: 0.0,
            multiple: 0.0,
            branch: 0.0,
            stall: 0.0,
            flash: 0.0,
        }
    }

    #[test]
    fn json_is_an_array_of_flat_objects_with_the_contract_s_keys() {
        let json = serde_json::to_value([row("ram", 2000.0)]).expect("plain data");
        let object = json[0].as_object().expect("an object");
        for key in ["core", "scalar", "scene", "what", "memory", "mean", "max"] {
            assert!(object.contains_key(key), "{key}");
        }
        let is_flat = |value: &serde_json::Value| !value.is_object() && !value.is_array();
        assert!(object.values().all(is_flat));
    }

    #[test]
    fn a_move_takes_the_cycles_of_its_instructions() {
        // Two cycles an instruction: 16 slices of 1,000 are 32,000 cycles; at 168 MHz 190.48 us.
        let whole = row("ram", 2000.0).scaled("admission", 16_000.0, 20_000.0);
        assert_eq!((whole.mean, whole.max), (32_000.0, 40_000.0));
        assert_eq!((whole.us_mean, whole.integer), (190.48, 32_000.0));
        assert_eq!(whole.key(), "m4f f32 thesis admission ram");
    }

    #[test]
    fn figures_in_flash_may_move_further() {
        assert!(row("ram", 1.0).tolerance() < row("flash", 1.0).tolerance());
    }

    #[test]
    fn every_ceiling_is_of_something_that_is_modelled() {
        crate::budget::expect_measured::<CyclesRow>("cycles", &CEILINGS);
    }

    /// Checks that the classes add up, in the figures that are checked in.
    #[test]
    fn classes_add_up_to_the_mean() {
        let rows: Vec<CyclesRow> =
            crate::budget::checked_in("cycles").expect("the file of figures");
        assert!(!rows.is_empty());
        for row in rows {
            let miss = row.classes().iter().sum::<f64>() + row.flash - row.mean;
            // Each is rounded to a tenth.
            assert!(miss.abs() < 0.6 + 1e-4 * row.mean, "{}: {miss}", row.key());
        }
    }

    #[test]
    fn both_thesis_scenes_are_modelled_for_every_board_and_number_type() {
        let rows: Vec<CyclesRow> =
            crate::budget::checked_in("cycles").expect("the file of figures");
        for scene in ["thesis", "thesis-links"] {
            for board in &BOARDS {
                for (scalar, _) in trirrr_image::generate::SCALARS {
                    for memory in boards::MEMORIES {
                        let key = format!("{} {scalar} {scene} tick {}", board.core, memory.name());
                        assert!(rows.iter().any(|row| row.key() == key), "{key}");
                    }
                }
            }
        }
    }
}
