//! Raster images on a machine: size, place, and the work of the tool.

use super::JobFileArgs;
use crate::terminal::say;
use trirrr_jobs::{Fitted, fit, level_origin_m};
use trirrr_scene::Scene;
use trirrr_toolpath::raster::{GreyImage, RasterPath, RasterSetup};
use trirrr_toolpath::{PathFault, ToolPlace, ToolWork};

/// Lists for which a machine has room at least: one is played, others come.
const LISTS: usize = 4;

fn fault(word: &str, reason: String) -> PathFault {
    PathFault {
        line: 0,
        word: word.to_owned(),
        reason,
    }
}

/// Tool path of `image` on the machine of `scene`, with its lower left corner at the zero point, or where it fits.
///
/// # Errors
/// The image has no speed, or one at which its pixels are shorter than a tick; the machine has no room for it; nothing is
/// burnt, or too many pixels are.
pub(super) fn rows(
    image: &GreyImage,
    scene: &Scene,
    args: &JobFileArgs,
) -> Result<RasterPath, PathFault> {
    let (own, shared) = (&args.image, &args.drawing);
    let origin_m = level_origin_m(&args.options())?;
    let feed_m_s = shared.speed_m_s().ok_or_else(|| {
        let reason = "an image has no speed: add --speed MM_PER_MIN, the speed along its rows";
        fault("", reason.into())
    })?;
    let pitch_m = own.pitch_m(image)?;
    let tick_m = feed_m_s * scene.period_s();
    if tick_m > pitch_m * (1.0 + 1e-9) {
        let mm = |metres: f64| 1e3 * metres;
        return Err(fault(
            "--pitch",
            format!(
                "at {:.0} mm/min the machine goes {:.4} mm in a tick, and pixels are {} mm: take a --pitch of at least {:.4}, or a --speed of at most {:.0}",
                60.0 * mm(feed_m_s),
                mm(tick_m),
                mm(pitch_m),
                mm(tick_m),
                (60.0 * mm(pitch_m) / scene.period_s()).floor(),
            ),
        ));
    }
    let mut placed = Fitted {
        scale: shared.scale.unwrap_or(1.0),
        origin_m,
    };
    let width_m = own.width_m(image.columns(), pitch_m);
    if shared.fit {
        let bounds = [[0.0; 2], [width_m, width_m * image.aspect()]];
        placed = fit(bounds, own.overscan_m(), placed.scale, scene)?;
        say(&format!("--fit: as {placed}"));
    }
    let pixels = placed.scale * width_m / pitch_m;
    let raster = image.raster(pixels, own.tones())?;
    raster.path(&RasterSetup {
        origin: ToolPlace {
            position_m: placed.origin_m,
            alpha_rad: scene.job.start.angle,
        },
        pitch_m,
        feed_m_s,
        work: ToolWork {
            power: shared.power.unwrap_or(1.0),
            follows_speed: !shared.constant_power,
        },
        overscan_m: own.overscan_m(),
        one_way: own.one_way,
        list: match scene.service.power_lists {
            0 => None,
            room => Some(usize::from(room) / LISTS),
        },
    })
}
