//! The job of a scene, tick by tick.

use trirrr_core::number::Number;
use trirrr_design::modes::{MODES, ModeResult, in_mode};
use trirrr_scene::record::{Record, tick_columns};
use trirrr_scene::{Scene, in_number_type, pipeline};
use wasm_bindgen::prelude::wasm_bindgen;

/// A job that was played in the number type of its scene: the setpoints and results that a board computes.
///
/// The table has the columns of `ticks.csv`. Of a long job it holds every so many ticks.
#[wasm_bindgen]
#[derive(Clone, Debug, Default)]
pub struct PlayedJob {
    columns: Vec<&'static str>,
    /// One list for each column.
    values: Vec<Vec<f64>>,
    every: u32,
    ticks: u32,
    rate_hz: f64,
    /// Speeds that the path asks for, m/s.
    feeds: Vec<f64>,
    /// First tick of each move.
    begins: Vec<u32>,
    /// Reason why the job ends before its last tick.
    reason: Option<String>,
}

impl PlayedJob {
    /// Plays the job of `scene`, which has moves.
    pub(crate) fn of(scene: &Scene, rows: u32) -> Result<Self, String> {
        in_number_type!(scene.number, N => Self::play::<N>(scene, rows))
    }

    fn play<N: Number>(scene: &Scene, rows: u32) -> Result<Self, String> {
        let job = pipeline::scene::<N>(scene)?;
        let ticks = job.player.ticks();
        let columns: Vec<_> = tick_columns(scene.torque).collect();
        let mut next = 0;
        let begins = scene.job.moves.iter().map(|each| {
            let begin = next;
            next += each.duration_ticks;
            begin
        });
        let mut played = Self {
            values: vec![Vec::new(); columns.len()],
            columns,
            every: ticks / rows.max(1) + 1,
            ticks,
            rate_hz: scene.tick_rate_hz,
            begins: begins.collect(),
            feeds: feeds(scene),
            ..Self::default()
        };
        for tick in rows_of(ticks, played.every) {
            let t = f64::from(tick) * scene.period_s();
            match job.machine.evaluate(t, &job.player.at(tick)) {
                Ok(record) => played.keep(&record, scene.torque),
                Err(status) => {
                    played.reason = Some(format!("the job ends at t = {t} s: {status}"));
                    break;
                }
            }
        }
        Ok(played)
    }

    fn keep(&mut self, record: &Record, torque: bool) {
        for (values, value) in self.values.iter_mut().zip(record.tick_row(torque)) {
            values.push(value);
        }
    }
}

#[wasm_bindgen]
impl PlayedJob {
    /// Names of the columns.
    #[wasm_bindgen(getter)]
    pub fn columns(&self) -> Vec<String> {
        self.columns.iter().map(|name| (*name).to_owned()).collect()
    }

    /// Values of the column `name`; none where the table has no such column: torques of a scene that computes none.
    pub fn values(&self, name: &str) -> Option<Vec<f64>> {
        let column = self.columns.iter().position(|column| *column == name)?;
        self.values.get(column).cloned()
    }

    /// Speed of D along its path, m/s, of each row.
    pub fn speeds(&self) -> Vec<f64> {
        let [x, y] = ["vx", "vy"].map(|name| self.values(name).unwrap_or_default());
        x.iter().zip(&y).map(|(x, y)| x.hypot(*y)).collect()
    }

    /// Greatest speeds that the path of the job asks for, m/s, each once; none of moves between poses.
    #[wasm_bindgen(getter)]
    pub fn feeds(&self) -> Vec<f64> {
        self.feeds.clone()
    }

    /// Ticks from one row to the next.
    #[wasm_bindgen(getter)]
    pub fn every(&self) -> u32 {
        self.every
    }

    /// Ticks of the job.
    #[wasm_bindgen(getter)]
    pub fn ticks(&self) -> u32 {
        self.ticks
    }

    /// Times at which moves begin, s.
    #[wasm_bindgen(getter)]
    pub fn begins(&self) -> Vec<f64> {
        let begins = self.begins.iter();
        begins.map(|tick| f64::from(*tick) / self.rate_hz).collect()
    }

    /// Reason why the table ends before the job.
    #[wasm_bindgen(getter)]
    pub fn reason(&self) -> Option<String> {
        self.reason.clone()
    }
}

/// Speeds of the pieces of a path, each once.
fn feeds(scene: &Scene) -> Vec<f64> {
    let pieces = scene.job.path.iter().flat_map(|path| &path.pieces);
    let mut feeds: Vec<f64> = pieces.filter_map(|each| each.feed_m_s).collect();
    feeds.sort_by(f64::total_cmp);
    feeds.dedup();
    feeds
}

/// Ticks of the rows: every so many, and the last one.
fn rows_of(ticks: u32, every: u32) -> impl Iterator<Item = u32> {
    let last = (!ticks.is_multiple_of(every)).then_some(ticks);
    (0..=ticks).step_by(every as usize).chain(last)
}

/// The job in one of the eight working modes.
#[wasm_bindgen(getter_with_clone)]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JobMode {
    /// Elbow signs, such as `+-+`.
    pub name: String,
    /// Reason why the mode does not do the job.
    pub reason: Option<String>,
    /// Largest torque of a motor, N m.
    pub torque: f64,
    /// Largest rate of a motor, rad/s.
    pub rate: f64,
    /// Least distance from a serial singularity.
    pub serial: f64,
    /// Least distance from the parallel singularity.
    pub parallel: f64,
    /// It is the mode of the scene.
    #[wasm_bindgen(js_name = isOwn)]
    pub is_own: bool,
}

/// Most ticks of a job that is played in all modes.
const MODES_TICKS: u32 = 1_000_000;

impl JobMode {
    pub(crate) fn all(scene: &Scene) -> Result<Vec<Self>, String> {
        if scene.ticks() > MODES_TICKS {
            return Ok(Vec::new());
        }
        let own = scene.parameters.legs.each_ref().map(|leg| leg.elbow);
        let modes = MODES.iter().map(|elbows| {
            let result = in_mode(scene, *elbows)?;
            Ok(Self::of(&result, *elbows == own))
        });
        modes.collect()
    }

    fn of(result: &ModeResult, is_own: bool) -> Self {
        let largest = |values: [f64; 3]| values.into_iter().fold(0.0, f64::max);
        let figures = result.figures;
        let reason = match (&result.fault, figures) {
            (Some(fault), _) => Some(format!("at t = {} s: {}", fault.t_s, fault.reason)),
            (None, Some(figures)) if !result.is_feasible() => Some(format!(
                "{:.3} times as much as a limit allows",
                figures.limit_part
            )),
            _ => None,
        };
        Self {
            name: result.name(),
            reason,
            torque: figures.map_or(0.0, |figures| largest(figures.torque_peak_nm)),
            rate: figures.map_or(0.0, |figures| largest(figures.rate_peak_rad_s)),
            serial: figures.map_or(0.0, |figures| figures.serial_min),
            parallel: figures.map_or(0.0, |figures| figures.parallel_min),
            is_own,
        }
    }
}
