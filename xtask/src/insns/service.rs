//! The tick of the whole service: state machine, path, pipeline, guard, tool, report, telemetry.

use super::counts::Spread;
use crate::cores::Core;
use crate::image::Image;
use crate::qemu;
use crate::repository::SceneFile;
use anyhow::{Context, Result, bail, ensure};

/// Instructions that no tick of the service may exceed on m4f in f32, with a sample in each tick.
pub(super) const CEILING: f64 = 1500.0;

/// Instructions of the service's ticks, by what they do.
pub(super) struct ServiceCounts {
    /// The job as it is.
    pub(super) job: Spread,
    /// The job with holds and resumes all along.
    pub(super) held: Spread,
    /// Homing before it, where the scene has one.
    pub(super) homing: Option<Spread>,
}

/// Links the tick without a panic in it, then counts it under QEMU. `bits`: checksum of the job's
/// results without a service, which those of the service have to have too.
pub(super) fn measure(
    scene: &SceneFile,
    scalar: &'static str,
    core: &Core,
    bits: u64,
) -> Result<ServiceCounts> {
    let image = Image {
        package: "trirrr-insns",
        binary: "serve",
        scene,
        scalar,
        target: core.target,
    };
    let [serve, _] = image
        .build_with("bare-service")
        .context("`bare-service` links only without a panic in the tick of the service")?;
    let printed = qemu::run(core, &serve)?;
    parse(&printed, core.units_per_instruction, bits)
        .with_context(|| format!("service: {} {scalar} {}", core.name, scene.name))
}

/// Reads `empty E`, then `homing T`, `tick T` and `held T` per tick, then `bits HEX`.
fn parse(printed: &str, units: f64, bits: u64) -> Result<ServiceCounts> {
    let mut empty = None;
    let (mut homing, mut job, mut held) = (Vec::new(), Vec::new(), Vec::new());
    let mut found = None;
    for line in printed.lines() {
        let (kind, value) = line.split_once(' ').unwrap_or((line, ""));
        let count = || -> Result<u32> {
            let count: u32 = value.parse().with_context(|| line.to_owned())?;
            Ok((f64::from(count) / units).round() as u32)
        };
        let less = |count: u32| {
            empty
                .and_then(|empty| count.checked_sub(empty))
                .with_context(|| format!("{line}: less than the empty call"))
        };
        match kind {
            "empty" => empty = Some(count()?),
            "homing" => homing.push(less(count()?)?),
            "tick" => job.push(less(count()?)?),
            "held" => held.push(less(count()?)?),
            "bits" => {
                let bits = u64::from_str_radix(value, 16).with_context(|| line.to_owned())?;
                found = Some(bits);
            }
            _ => bail!("the image says: {line}"),
        }
    }
    let found = found.context("the image printed no checksum")?;
    ensure!(
        found == bits,
        "the results differ from the pipeline's own (checksum {found:016x}, without a service \
         {bits:016x})"
    );
    Ok(ServiceCounts {
        job: Spread::of(&job)?,
        held: Spread::of(&held)?,
        homing: match homing.as_slice() {
            [] => None,
            homing => Some(Spread::of(homing)?),
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_both_runs_and_compares_the_bits() {
        let printed = "empty 64\ntick 704\ntick 640\nheld 1280\nbits ff\n";
        let service = parse(printed, 6.4, 255).expect("well formed");
        assert_eq!((service.job.min, service.job.max), (90.0, 100.0));
        assert_eq!(service.held.max, 190.0);
        assert!(service.homing.is_none());
        let homed = printed.replace("tick 704", "homing 1344\nhoming 704\ntick 704");
        let service = parse(&homed, 6.4, 255).expect("well formed");
        let homing = service.homing.expect("two ticks of it");
        assert_eq!((homing.min, homing.max), (100.0, 200.0));
        assert_eq!((service.job.min, service.job.max), (90.0, 100.0));
        let error = parse(printed, 6.4, 254).err().expect("other bits");
        assert!(error.to_string().contains("without a service"), "{error}");
        assert!(parse("error: no room\n", 6.4, 0).is_err());
    }
}
