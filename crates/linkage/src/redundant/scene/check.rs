//! Checks of a whole scene: the machine, the places of its sliders, and its job at every tick.

use super::player::RedundantPlayer;
use super::record::RedundantRecord;
use super::sliders::{BestPlace, RedundantSlider};
use super::{RedundantLimits, RedundantPipeline, RedundantScene};
use crate::redundant::Travel;
use trirrr_protocol::message::{Bounded, Violation};
use trirrr_scene::read::{Document, Section};
use trirrr_scene::tables::PlacedJob;
use trirrr_scene::words;

/// Poses of the job for which sliders are placed.
const PLACED_POSES: u32 = 65;

/// Checks the machine of `scene` and places its sliders. Returns true if nothing was refused.
pub(super) fn check_machine(root: &Section, scene: &mut RedundantScene) -> bool {
    let machine = match scene.pipeline() {
        Ok(machine) => machine,
        Err(error) => {
            root.refuse_list("machine", error.to_string());
            return false;
        }
    };
    let is_placed = |slider: &RedundantSlider| slider.is_placed;
    if !scene.sliders.iter().flatten().any(is_placed) {
        return true;
    }
    match place_sliders(&*machine, scene) {
        Ok(()) => true,
        Err(reason) => {
            root.refuse_list("machine", format!("place = \"best\": {reason}"));
            false
        }
    }
}

fn place_sliders(
    machine: &dyn RedundantPipeline,
    scene: &mut RedundantScene,
) -> Result<(), String> {
    let starts = scene.slider_starts();
    let before = least_distance(machine, scene);
    // A slider that stays has a travel of no length.
    let travels = scene.sliders.iter().zip(&starts).map(|(slider, &at)| {
        slider.map(|slider| match slider.is_placed {
            true => slider.travel,
            false => Travel {
                low_m: at,
                high_m: at,
            },
        })
    });
    let travels: Vec<_> = travels.collect();
    let player = RedundantPlayer::new(scene);
    let (ticks, last) = (u64::from(player.ticks()), u64::from(PLACED_POSES - 1));
    let poses: Vec<_> = (0..=last)
        .map(|part| player.platform((ticks * part / last) as u32).pose)
        .collect();
    let (places, looked_at) = machine
        .placed(&poses, &travels)
        .map_err(|error| error.to_string())?;
    for (leg, slider) in scene.sliders.iter_mut().enumerate() {
        if let Some(slider) = slider.as_mut().filter(|slider| slider.is_placed) {
            slider.position_m = places[leg];
            for at in &mut scene.slider_moves {
                at[leg] = places[leg];
            }
        }
    }
    let after = least_distance(machine, scene);
    scene.placement = Some(BestPlace {
        before,
        after: after.ok_or("a pose between those looked at is out of reach")?,
        looked_at,
    });
    Ok(())
}

/// Least distance to a singularity at any tick of the job; none where a tick is out of reach.
fn least_distance(machine: &dyn RedundantPipeline, scene: &RedundantScene) -> Option<f64> {
    let player = RedundantPlayer::new(scene);
    let mut least = f64::INFINITY;
    for tick in 0..=player.ticks() {
        let sliders: Vec<f64> = player.sliders(tick).iter().map(|it| it.position).collect();
        let distance = machine.distance(&player.platform(tick).pose, &sliders);
        least = least.min(distance.ok()?);
    }
    Some(least)
}

/// Refuses every move of the job in which a tick has no motion or breaks a limit.
pub(super) fn check_job(document: &Document, scene: &RedundantScene, placed: &PlacedJob) {
    let Ok(machine) = scene.pipeline() else {
        return;
    };
    let player = RedundantPlayer::new(scene);
    let mut refused: Option<RefusedMove> = None;
    for tick in 0..=player.ticks() {
        let number = player.move_at(tick);
        if let Some(refused) = refused.take_if(|refused| refused.number != number) {
            refused.report(document, placed);
        }
        let setpoint = player.platform(tick);
        let instant = || words::instant(player.time_in_move(tick), &setpoint.pose);
        match player.record(&*machine, tick) {
            Ok(record) => {
                for breach in breaches(scene, &record) {
                    match &mut refused {
                        None => refused = Some(RefusedMove::new(number, instant(), breach)),
                        Some(refused) => refused.worsen(instant, breach),
                    }
                }
            }
            Err(status) => {
                let reason = format!("{}: {status}", instant());
                match &mut refused {
                    None => refused = Some(RefusedMove::without_motion(number, reason)),
                    Some(refused) => refused.lose(reason),
                }
            }
        }
    }
    if let Some(refused) = refused {
        refused.report(document, placed);
    }
}

/// A limit that is broken at one tick.
struct Breach {
    /// BreachedQuantity and its leg or slider, from 0.
    quantity: (BreachedQuantity, Option<usize>),
    value: f64,
    limit: f64,
}

#[derive(Clone, Copy, PartialEq)]
enum BreachedQuantity {
    Of3Rrr(Bounded),
    Velocity,
    Force,
    Power,
}

impl Breach {
    /// Factor by which the value is beyond the limit, above 1.
    fn factor(&self) -> f64 {
        match self.quantity.0 {
            BreachedQuantity::Of3Rrr(Bounded::SerialDistance | Bounded::ParallelDistance) => {
                self.limit / self.value
            }
            _ => self.value / self.limit,
        }
    }

    fn describe(&self) -> String {
        let (quantity, index) = self.quantity;
        let (name, unit) = match quantity {
            BreachedQuantity::Of3Rrr(what) => {
                return words::violation(&Violation {
                    what,
                    index: index.map(|index| index as u8),
                    at: 0.0,
                    value: self.value,
                    error: Some(0.0),
                    limit: self.limit,
                    certain: true,
                    ramp: false,
                    shortest: None,
                });
            }
            BreachedQuantity::Velocity => ("velocity", "m/s"),
            BreachedQuantity::Force => ("force", "N"),
            BreachedQuantity::Power => ("power", "W"),
        };
        format!(
            "{name} of the slider of leg {} would be {} {unit}, the most allowed is {} {unit}",
            index.map_or(0, |index| index + 1),
            words::short(self.value),
            words::short(self.limit)
        )
    }
}

/// Limits of `scene` that `record` breaks.
fn breaches(scene: &RedundantScene, record: &RedundantRecord) -> Vec<Breach> {
    let mut found = Vec::new();
    let RedundantLimits {
        rate_rad_s,
        acceleration_rad_s2,
        torque_nm,
        power_w,
        serial_distance_min,
        parallel_distance_min,
    } = &scene.limits;
    let mut most = |quantity, index, value: f64, limit: Option<f64>| {
        let value = value.abs();
        // Written so that a value that is not a number is refused.
        if let Some(limit) = limit.filter(|limit| !(value <= *limit)) {
            let quantity = (quantity, Some(index));
            found.push(Breach {
                quantity,
                value,
                limit,
            });
        }
    };
    for (index, (own, slider)) in record.legs.iter().zip(&scene.sliders).enumerate() {
        let leg = &own.leg;
        for (what, value, limits) in [
            (Bounded::Rate, leg.dth1, rate_rad_s),
            (Bounded::Acceleration, leg.ddth1, acceleration_rad_s2),
            (Bounded::Torque, leg.torque, torque_nm),
            (Bounded::Power, leg.power, power_w),
        ] {
            let limit = limits.as_ref().map(|limits| limits[index]);
            most(BreachedQuantity::Of3Rrr(what), index, value, limit);
        }
        if let (Some(slider), Some(own)) = (slider, &own.slider) {
            let limits = &slider.limits;
            most(
                BreachedQuantity::Velocity,
                index,
                own.velocity,
                limits.velocity_m_s,
            );
            most(BreachedQuantity::Force, index, own.force, limits.force_n);
            most(BreachedQuantity::Power, index, own.power, limits.power_w);
        }
    }
    let serial = record.legs.iter().enumerate();
    let serial = serial.map(|(index, leg)| {
        let what = Bounded::SerialDistance;
        (what, Some(index), leg.leg.serial, *serial_distance_min)
    });
    let parallel = (
        Bounded::ParallelDistance,
        None,
        record.parallel,
        *parallel_distance_min,
    );
    for (what, index, value, limit) in serial.chain([parallel]) {
        if !(value >= limit) {
            let quantity = (BreachedQuantity::Of3Rrr(what), index);
            found.push(Breach {
                quantity,
                value,
                limit,
            });
        }
    }
    found
}

/// A move that is refused: its first breach, and the worst of the same quantity.
struct RefusedMove {
    number: usize,
    reason: String,
    first: Option<Breach>,
    worst: Option<(String, Breach)>,
    /// Later instant from which there is no motion.
    lost: Option<String>,
}

impl RefusedMove {
    fn new(number: usize, instant: String, first: Breach) -> Self {
        Self {
            number,
            reason: format!("{instant}: {}", first.describe()),
            first: Some(first),
            worst: None,
            lost: None,
        }
    }

    fn without_motion(number: usize, reason: String) -> Self {
        Self {
            number,
            reason,
            first: None,
            worst: None,
            lost: None,
        }
    }

    /// Takes a later breach of the same limit in.
    fn worsen(&mut self, instant: impl Fn() -> String, breach: Breach) {
        let Some(first) = self
            .first
            .as_ref()
            .filter(|it| it.quantity == breach.quantity)
        else {
            return;
        };
        let so_far = self.worst.as_ref().map_or(first, |(_, worst)| worst);
        if breach.factor() > so_far.factor() * 1.001 {
            self.worst = Some((instant(), breach));
        }
    }

    /// Takes the first later tick without a motion in.
    fn lose(&mut self, reason: String) {
        if self.first.is_some() {
            self.lost.get_or_insert(reason);
        }
    }

    fn report(self, document: &Document, placed: &PlacedJob) {
        let mut reason = self.reason;
        if let Some((instant, worst)) = &self.worst {
            reason += &format!("; at worst {} {instant}", words::short(worst.value));
        }
        if let Some(lost) = &self.lost {
            reason += &format!("; and {lost}");
        }
        if let Some(place) = placed.moves.get(self.number) {
            document.refuse(&place.whole, reason);
        }
    }
}
