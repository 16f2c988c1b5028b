//! Paths that are planned in blocks, their moves in memory and in a file.

use std::convert::Infallible;
use std::f64::consts::FRAC_PI_2;
use tempfile::tempfile;
use trirrr_core::setpoint::Pose;
use trirrr_plan::corner::{CornerRounding, round_corners};
use trirrr_plan::course::PathPiece;
use trirrr_plan::piece::{Piece, PlaneCurve};
use trirrr_scene::{
    BlockCutter, Dwell, JobPath, OutputBits, PathBlock, PathOutputs, Scene, Tool, Unplanned,
    UntakenJob,
};

const ENGRAVING: &str = include_str!("../../../../scenes/engraving.toml");
const CORNER_M: f64 = 1e-5;
const TOLERANCES: [f64; 2] = [1e-5, 1e-4];

/// Chords of 0.1 mm around circles, the tool off along a few of them, with a dwell now and then.
struct Chords {
    pieces: Vec<PathPiece>,
    dwells: Vec<Dwell>,
    tools: Vec<Option<Tool>>,
}

fn chords(scene: &Scene, count: usize) -> Chords {
    let start = scene.job.start;
    let place = |index: usize| {
        let (sin, cos) = (7e-3 * index as f64 - FRAC_PI_2).sin_cos();
        let [x, y] = [
            start.position.x + 0.014 * cos,
            start.position.y + 0.014 * (1.0 + sin),
        ];
        Pose::from_f64(x, y, start.angle)
    };
    let mut all = Chords {
        pieces: Vec::new(),
        dwells: Vec::new(),
        tools: Vec::new(),
    };
    for index in 0..count {
        let source = all.tools.len();
        let tool = (index % 900 > 20).then_some(Tool {
            power: 0.5,
            speed_m_s: 0.1,
        });
        all.pieces.push(PathPiece {
            piece: Piece::line(place(index), place(index + 1)),
            feed_m_s: Some(0.1),
            source,
            stops: index == 0
                || all
                    .dwells
                    .last()
                    .is_some_and(|dwell| dwell.source + 1 == source),
            setting: usize::from(tool.is_some()),
        });
        all.tools.push(tool);
        if index % 2500 == 2499 {
            all.dwells.push(Dwell {
                source: source + 1,
                ticks: 50,
            });
            all.tools.push(None);
        }
    }
    all
}

impl Chords {
    fn path(&self) -> JobPath {
        JobPath {
            pieces: round_corners(&self.pieces, CORNER_M),
            free: None,
            dwells: self.dwells.clone(),
            tools: self.tools.clone(),
            rows: Vec::new(),
            outputs: self.outputs(),
            tolerance_m: TOLERANCES[0],
            tolerance_rad: TOLERANCES[1],
        }
    }

    /// Outputs that change at every 700th piece, and in each dwell.
    fn outputs(&self) -> Vec<PathOutputs> {
        let mut changes: Vec<PathOutputs> = Vec::new();
        for piece in self.pieces.iter().step_by(700) {
            changes.push(PathOutputs {
                source: piece.source,
                with_motion: true,
                bits: OutputBits::one((piece.source / 700 % 3) as u8, piece.source % 2 == 0),
            });
        }
        changes.extend(self.dwells.iter().map(|dwell| PathOutputs {
            source: dwell.source,
            with_motion: false,
            bits: OutputBits::one(7, dwell.source % 4 < 2),
        }));
        changes.sort_by_key(|change| change.source);
        changes
    }

    /// Blocks as a reader of a file makes them, with the fewest pieces in memory.
    fn blocks(&self) -> impl Iterator<Item = Result<PathBlock, Infallible>> {
        let [tolerance_m, tolerance_rad] = TOLERANCES;
        let mut cutter = BlockCutter::new(tolerance_m, tolerance_rad);
        let mut corners = CornerRounding::new(CORNER_M);
        let mut blocks = Vec::new();
        let mut dwells = self.dwells.iter().peekable();
        let outputs = self.outputs();
        let mut outputs = outputs.iter().peekable();
        for piece in &self.pieces {
            while let Some(change) = outputs.next_if(|change| change.source <= piece.source) {
                cutter.outputs(*change);
            }
            while let Some(dwell) = dwells.next_if(|dwell| dwell.source < piece.source) {
                cutter.tool(dwell.source, None);
                cutter.dwell(*dwell);
            }
            cutter.tool(piece.source, self.tools[piece.source]);
            corners.push(*piece, |piece| blocks.extend(cutter.piece(piece)));
        }
        corners.finish(|piece| blocks.extend(cutter.piece(piece)));
        outputs.for_each(|change| cutter.outputs(*change));
        for dwell in dwells {
            cutter.tool(dwell.source, None);
            cutter.dwell(*dwell);
        }
        blocks.extend(cutter.finish());
        blocks.into_iter().map(Ok)
    }
}

#[test]
fn moves_in_a_file_are_those_in_memory() {
    let machine = Scene::parse(ENGRAVING, "engraving.toml").unwrap();
    let chords = chords(&machine, 13_000);
    assert!(chords.blocks().count() >= 3);
    let (mut held, mut spooled) = (machine.clone(), machine.clone());
    held.take_path(&chords.path()).unwrap();
    spooled
        .take_blocks(chords.blocks(), tempfile().unwrap())
        .unwrap();
    let spool = spooled.job.spool.clone().unwrap();
    let all = spool.read(0..u32::MAX).unwrap();
    assert_eq!(all.moves, held.job.moves);
    assert_eq!(spooled.job.outputs, held.job.outputs);
    let changes = held.job.outputs.changes();
    assert!(changes.len() > 15, "{}", changes.len());
    // Those of dwells are with moves that stand.
    for (index, bits) in changes {
        let each = &held.job.moves[*index as usize];
        assert_eq!(
            each.from == each.to,
            (bits.on | bits.off) & 0x80 != 0,
            "{index}"
        );
    }
    assert!(held.job.moves.iter().any(|each| each.tool.is_none()));
    // Facts and parts of the job.
    assert_eq!(spooled.job.count(), held.job.moves.len());
    assert_eq!(spooled.ticks(), held.ticks());
    assert_eq!(spooled.job.shortest_ticks(), held.job.shortest_ticks());
    assert!(spooled.plays_quintics() && held.plays_quintics());
    let longest = held.longest_stop().unwrap();
    assert!(longest.time_s > 0.1);
    // The way is a bound, whose last digits depend on the order in which stops are looked at.
    let of_spool = spooled.longest_stop().unwrap();
    assert_eq!(of_spool.time_s, longest.time_s);
    assert!((of_spool.way_m / longest.way_m - 1.0).abs() < 0.01);
    let part = spool.read(100..110).unwrap();
    assert_eq!(part.moves, held.job.moves[100..110]);
    let before = held.job.moves[..100]
        .iter()
        .map(|each| u64::from(each.duration_ticks));
    assert_eq!(part.before, before.sum::<u64>());
    assert_eq!(
        spool.read(spool.count()..u32::MAX).unwrap().before,
        u64::from(spool.ticks())
    );
    // One after the other without a gap, all dwells among them.
    for pair in all.moves.windows(2) {
        assert_eq!(pair[0].to, pair[1].from);
    }
    let stands = all
        .moves
        .iter()
        .filter(|each| each.from == each.to && each.duration_ticks == 50);
    assert_eq!(stands.count(), 5);
}

/// The first block without a plan names its piece; so does a source that fails. The scene keeps its own job.
#[test]
fn a_path_that_is_refused_leaves_the_job_as_it_was() {
    let machine = Scene::parse(ENGRAVING, "engraving.toml").unwrap();
    let mut far = chords(&machine, 8800);
    let number = far.pieces.len() - 100;
    for each in &mut far.pieces[number..] {
        // Out of reach.
        if let PlaneCurve::Line { start, .. } = &mut each.piece.curve {
            start.x += 1.0;
        }
        each.stops = true;
    }
    let mut scene = machine.clone();
    let source = far.pieces[number].source;
    match scene.take_blocks(far.blocks(), tempfile().unwrap()) {
        Err(UntakenJob::Plan(Unplanned::Path { number, .. })) => assert_eq!(number, source),
        other => panic!("{other:?}"),
    }
    assert_eq!(scene, machine);
    let end = std::iter::once(Err("the disk is gone"));
    let blocks = far
        .blocks()
        .take(1)
        .map(|block| block.map_err(|never| match never {}));
    match scene.take_blocks(blocks.chain(end), tempfile().unwrap()) {
        Err(UntakenJob::Path(why)) => assert_eq!(why, "the disk is gone"),
        other => panic!("{other:?}"),
    }
    assert_eq!(scene, machine);
}
