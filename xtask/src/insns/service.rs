//! The tick of the whole service: state machine, path, pipeline, guard, tool, report, telemetry.

use super::counts::Counts;
use crate::cores::Core;
use crate::image::Image;
use crate::qemu;
use crate::repository::SceneFile;
use anyhow::{Context, Result, ensure};

/// Instructions of the service's ticks, with a sample in each.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ServiceFigures {
    /// While it plays the job.
    pub(super) mean: f64,
    pub(super) max: f64,
    /// Its longest tick with holds and resumes all along the job.
    pub(super) held_max: f64,
    /// Its longest tick while it homes the machine, where the scene has homing.
    pub(super) homing_max: Option<f64>,
}

/// Links the tick without a panic in it, then counts it under QEMU. `bits`: checksum of the job's
/// results without a service, which those of the service have to have too.
pub(super) fn measure(
    scene: &SceneFile,
    scalar: &'static str,
    core: &Core,
    bits: u64,
) -> Result<ServiceFigures> {
    let image = Image::insns("serve", scene, scalar, core.target);
    let [serve, _] = image
        .build_with("bare-service")
        .context("`bare-service` links only without a panic in the tick of the service")?;
    let printed = qemu::run(core, &serve)?;
    parse(&printed, core.units_per_instruction, bits)
        .with_context(|| format!("service: {} {scalar} {}", core.name, scene.name))
}

/// Reads `empty E`, then `homing T`, `tick T` and `held T` per tick, then `bits HEX`.
fn parse(printed: &str, units: f64, bits: u64) -> Result<ServiceFigures> {
    let counts = Counts::parse(printed, units, &["homing", "tick", "held"], 1)?;
    ensure!(
        counts.bits == bits,
        "the results differ from the pipeline's own (checksum {:016x}, without a service {bits:016x})",
        counts.bits
    );
    let job = counts.spread("tick", 0)?;
    Ok(ServiceFigures {
        mean: job.mean,
        max: job.max,
        held_max: counts.spread("held", 0)?.max,
        homing_max: counts.spread("homing", 0).ok().map(|homing| homing.max),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_both_runs_and_compares_the_bits() {
        let printed = "empty 64\ntick 704\ntick 640\nheld 1280\nbits ff\n";
        let service = parse(printed, 6.4, 255).expect("well formed");
        assert_eq!((service.mean, service.max), (95.0, 100.0));
        assert_eq!(service.held_max, 190.0);
        assert!(service.homing_max.is_none());
        let homed = printed.replace("tick 704", "homing 1344\nhoming 704\ntick 704");
        let service = parse(&homed, 6.4, 255).expect("well formed");
        assert_eq!(service.homing_max, Some(200.0));
        assert_eq!(service.max, 100.0);
        let error = parse(printed, 6.4, 254).expect_err("other bits");
        assert!(error.to_string().contains("without a service"), "{error}");
        assert!(parse("error: no room\n", 6.4, 0).is_err());
    }
}
