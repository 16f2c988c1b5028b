//! A study as a document, and its table of values.

use super::study::{ModeRow, MotorRow, Study, Surface, largest};
use super::{DesignArgs, motor_figures};
use trirrr_core::machine::Elbow;
use trirrr_design::workspace::Workspace;
use trirrr_figures::document::{Document, Facts, csv, digits};

/// Motors in the summary for a terminal.
const MOTORS_SHOWN: usize = 8;

/// Sentences round the table of motors.
const MARGINS: &str = "* does the job. Margins: what there is over what is asked for. Time: the least in which the motor does the job.";
const MOTORS: &str = "Each motor of the catalogue with the gear that leaves the most. At every instant the torque at the speed counts, and over the job \
    the continuous torque over the root mean square. The inertia of its rotor counts, friction does not; where the catalogue has no inertia, \
    the margins are those of a rotor that weighs nothing, and the motor stands behind the others. What is brought back is the sum of what each \
    motor gives to a supply of its own in braking. A curve that is estimated is the pull-out torque by the winding of a stepper, without \
    resonance: plan with half of it.";

/// The study with its `figures`.
pub(super) fn document(
    study: &Study,
    args: &DesignArgs,
    figures: &[(&'static str, String)],
) -> Document {
    let mut document = Document::new();
    let draw = |document: &mut Document, names: &[&str]| {
        let of = |wanted: &&str| figures.iter().find(|(name, _)| name == wanted);
        for (_, svg) in names.iter().filter_map(of) {
            document.figure(svg.as_str());
        }
    };
    let scene = &study.scene;
    document
        .pairs(
            Facts::new()
                .pair("scene", "scene", &scene.name)
                .text("", scene.description.as_str())
                .data("elbows", signs(study.own_mode())),
        )
        .page_heading("The machine");
    draw(&mut document, &["geometry"]);
    document.page_heading("The job in motion");
    document.figure(study.animation.player());
    modes(&mut document, study);
    draw(&mut document, &["modes"]);
    workspace(&mut document, study, args);
    draw(&mut document, &["workspace", "total_orientation", "angles"]);
    document.page_heading("Speeds, forces, stiffness, accuracy");
    document.page_note(
        "Values at the centres of cells, at rest and without friction. Near a serial singularity the motors have to be fast; \
         near the parallel one they have to be strong, and the platform is hardly held.",
    );
    let maps =
        "singularities rates forces torques force_limit compliance accuracy tolerances angle_loads";
    draw(&mut document, &Vec::from_iter(maps.split(' ')));
    loads(&mut document, study);
    document.page_heading("Velocity ratios along the job");
    document.page_note("The source divides the platform's rates by each motor's. These ratios depend on the motion; the Jacobian below depends on the pose alone.");
    draw(&mut document, &["ratios", "jacobian"]);
    document.heading("Bearings and pins: forces in the joints along the job");
    document.table("joints", joints(study));
    document.page_note("A: motor, B: elbow, C: platform. Each curve is the tip of the force, from the middle of the figure; the dot is the start of the job.");
    draw(&mut document, &["reactions"]);
    document.heading("Motors");
    document.page_note(MOTORS).page_note(match scene.job.path.is_some() {
        true => "The least time is that of a plan with the rates and torques of the motor in place of the limits of the scene.",
        false => "The least time is that of the moves of the job, all of them faster or slower by one factor: their durations are given.",
    });
    document.table(
        "motors",
        study.motors.iter().enumerate().map(motor).collect(),
    );
    document.note(MARGINS);
    draw(&mut document, &motor_figures::NAMES);
    document.page_heading("Duration");
    document.page_note("The same motion of the platform, faster and slower.");
    draw(&mut document, &["durations"]);
    document
}

fn signs(elbows: [Elbow; 3]) -> [i32; 3] {
    elbows.map(|elbow| elbow.sign() as i32)
}

fn modes(document: &mut Document, study: &Study) {
    document.heading("Working modes");
    document.page_note("Each row is the job of the scene with other elbows. A job that asks for the least time is planned in each mode.");
    let row = |row: &ModeRow| {
        // Of a mode that ends early, the peaks of a part would be taken for those of the job.
        let whole = row.result.figures.filter(|_| row.is_feasible());
        Facts::new()
            .pair("elbows", "elbows", signs(row.result.elbows))
            .words(row.result.name())
            .pair("duration_s", "time", row.duration_s)
            .pair(
                "peak_torque_nm",
                "peak torque",
                whole.map(|of| largest(of.torque_peak_nm)),
            )
            .pair(
                "rms_torque_nm",
                "RMS torque",
                whole.map(|of| largest(of.torque_rms_nm)),
            )
            .derived(
                "peak rate",
                "rad/s",
                whole.map(|of| largest(of.rate_peak_rad_s)),
            )
            .derived("work", "J", whole.map(|of| of.work_j))
            .derived("serial", "", whole.map(|of| of.serial_min))
            .derived("parallel", "", whole.map(|of| of.parallel_min))
            .derived("at limits", "%", whole.map(|of| 100.0 * of.time_at_limits))
            .pair("reason", "not feasible", row.reason())
            .data("feasible", row.is_feasible())
            .data("figures", row.result.figures)
            .marked(row.result.elbows == study.own_mode())
    };
    document.table("modes", study.modes.iter().map(row).collect());
    document.note(
        "* the mode of the scene; serial, parallel: least distances to singularities, 0 to 1",
    );
    let best = study.best_mode().map(|row| signs(row.result.elbows));
    document.pairs(Facts::new().pair("best_elbows", "best elbows", best));
}

/// Bounds of an area.
fn map(study: &Study, map: &Workspace) -> Facts {
    let [lower, upper] = map.area_m2();
    Facts::new()
        .data("alpha_rad", study.alpha_rad)
        .data("area_lower_m2", lower)
        .data("area_upper_m2", upper)
        .text("", format!("{:.2} to {:.2} cm^2", 1e4 * lower, 1e4 * upper))
        .pair("undecided", "of the map undecided", map.undecided())
        .words(format!("{:.3} %", 100.0 * map.undecided()))
}

/// Workspace, and the largest circle and rectangle in it.
fn surface(study: &Study, label: &'static str, surface: &Surface) -> Facts {
    Facts::new()
        .group("workspace", label, map(study, &surface.map))
        .pair("connected_m2", "  with start", surface.connected_m2())
        .pair("disc", "  circle", surface.disc)
        .pair("rectangle", "  rectangle", surface.rectangle)
}

fn workspace(document: &mut Document, study: &Study, args: &DesignArgs) {
    document.heading("Workspace");
    document.page_note(
        "Every pose of a coloured cell is proven to keep the conditions, and every pose of a white one to break one. Reach: what the legs reach. \
         Workspace: where the machine keeps its distances to singularities. All angles: where the platform can have every angle.",
    );
    let turn = match args.turn > 0.0 {
        true => format!(" +- {}", args.turn),
        false => String::new(),
    };
    document.pairs(
        Facts::new()
            .text(
                "alpha",
                format!("{:.3}{turn} degrees", study.alpha_rad.to_degrees()),
            )
            .data("turn_rad", args.turn.to_radians())
            .data("cells", study.work.map.grid.size)
            .group("reach", "reach", map(study, &study.reach))
            .and(surface(study, "workspace", &study.work)),
    );
    document.pairs_in(
        "total_orientation",
        surface(study, "all angles", &study.total),
    );
}

/// Values of programs, and which maps are missing for which reason.
fn loads(document: &mut Document, study: &Study) {
    let stiffness = study.stiffness_nm_rad;
    for (is_missing, what, how) in [
        (
            study.scene.limits.torque_nm.is_none(),
            "force that the motors allow",
            "[limits] torque_nm",
        ),
        (
            stiffness.is_none(),
            "compliance",
            "--stiffness-nm-rad, or stiffness_nm_rad of the drives or the plant",
        ),
        (
            study.errors_m.is_none(),
            "offset within tolerances",
            "a table [tolerances]",
        ),
    ] {
        if is_missing {
            document.page_note(format!("A map of the {what} needs {how}."));
        }
    }
    let alphas = study.alphas.iter().map(|row| {
        Facts::new()
            .data("alpha_rad", row.degrees.to_radians())
            .data("area_m2", row.area_m2)
            .data("rate_per_speed_rad_m", row.values.map(|values| values[0]))
            .data("torque_nm", row.values.map(|values| values[1]))
            .data("offset_m", row.values.map(|values| values[2]))
            .data(
                "compliance_m_n",
                row.values
                    .filter(|_| stiffness.is_some())
                    .map(|values| values[3]),
            )
    });
    let durations = study.durations.iter().map(|(seconds, figures)| {
        Facts::new()
            .data("duration_s", seconds)
            .data("torque_peak_nm", figures.torque_peak_nm)
            .data("torque_rms_nm", figures.torque_rms_nm)
            .data("power_peak_w", figures.power_peak_w)
            .data("work_j", figures.work_j)
    });
    document.pairs(
        Facts::new()
            .data("load_n", study.case.load_n)
            .data("acceleration_m_s2", study.case.acceleration_m_s2)
            .data("stiffness_nm_rad", stiffness)
            .rows("alphas", alphas)
            .rows("durations", durations),
    );
}

fn joints(study: &Study) -> Vec<Facts> {
    let legs = study.reactions.forces.iter().enumerate();
    let joints = legs.flat_map(|(leg, forces)| {
        ["A", "B", "C"]
            .into_iter()
            .zip(forces)
            .map(move |each| (leg + 1, each))
    });
    joints
        .map(|(leg, (joint, force))| {
            Facts::new()
                .pair("joint", "joint", format!("{joint}{leg}"))
                .pair("peak_n", "peak", force.peak_n)
                .pair("rms_n", "RMS", force.rms_n)
        })
        .collect()
}

fn motor((place, row): (usize, &MotorRow)) -> Facts {
    let MotorRow {
        motor, candidate, ..
    } = row;
    let needed = match candidate.supply_needed_v {
        Some(supply) if supply.is_infinite() => "none is enough".into(),
        supply => supply.map_or("-".into(), digits),
    };
    let record = Facts::new()
        .pair("name", "motor", &motor.name)
        .pair("gear_ratio", "gear", candidate.gear_ratio)
        .pair("supply_v", "supply", motor.supply_v)
        .pair("supply_needed_v", "needed, V", candidate.supply_needed_v)
        .words(needed)
        .page_only()
        .pair("curve", "curve", motor.curve_source())
        .page_only()
        .pair("peak_margin", "torque margin", candidate.peak_margin)
        .pair("heat_margin", "heat margin", candidate.heat_margin)
        .data("margin", candidate.margin())
        .pair("limited_by", "limited by", candidate.limited_by())
        .pair("torque_peak_nm", "peak", candidate.torque_peak_nm)
        .page_only()
        .pair("torque_rms_nm", "RMS", candidate.torque_rms_nm)
        .page_only()
        .pair("speed_part", "part of the speed", candidate.speed_part)
        .page_only()
        .pair(
            "inertia_ratio",
            "rotor / machine inertia",
            candidate.inertia_ratio,
        )
        .page_only()
        .pair(
            "regenerated_j",
            "brought back by each",
            candidate.regenerated_j,
        )
        .page_only()
        .pair("least_time_s", "time", row.least_time_s)
        .data("mass_kg", motor.mass_kg)
        .pair("source", "source", &motor.source)
        .page_only()
        .marked(candidate.margin() >= 1.0);
    match place < MOTORS_SHOWN {
        true => record,
        false => record.page_row(),
    }
}

/// Values at the cells that the machine works in, as CSV in SI units. What the scene does not tell is empty.
pub(super) fn map_table(study: &Study) -> String {
    let grid = &study.coarse;
    let row = |(index, each): (usize, &Option<trirrr_design::loads::PoseLoads>)| {
        let each = each.as_ref()?;
        let [x, y] = grid.centre_m(index % grid.size[0], index / grid.size[0]);
        let [serial, parallel] = each.ratios.distances;
        let limits = study.scene.limits.torque_nm;
        let errors = study.errors_m.as_ref();
        let record = Facts::new()
            .data("x_m", x)
            .data("y_m", y)
            .data("serial", serial)
            .data("parallel", parallel)
            .data("rate_per_speed_rad_m", each.ratios.rate_per_speed())
            .data("torque_per_force_m", each.ratios.torque_per_force())
            .data("offset_per_error_m_rad", each.ratios.offset_per_error())
            .data("torque_nm", study.case.torque_nm(each))
            .data("force_limit_n", limits.map(|limits| each.force_n(limits)))
            .data(
                "compliance_m_n",
                study
                    .stiffness_nm_rad
                    .map(|each_nm| each.compliance_m_n(each_nm)),
            )
            .data("tolerance_m", errors.and_then(|errors| errors[index]));
        Some(record)
    };
    csv(&study
        .loads
        .iter()
        .enumerate()
        .filter_map(row)
        .collect::<Vec<_>>())
}
