//! One row of the table as a machine and a setpoint.

use super::columns::{Column, Columns, LegColumns, MoveColumns, SetpointColumns};
use csv::ByteRecord;
use nalgebra::{Vector2, Vector3};
use std::borrow::Cow;
use trirrr_core::machine::{Elbow, LegParameters, LinkParameters, Parameters, PlatformParameters};
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Pose, RestToRest, Setpoint};

/// Machine and setpoint of one row.
#[derive(Clone, Debug)]
pub struct Case<N: Number> {
    /// The machine, SI units.
    pub parameters: Parameters,
    /// The setpoint in the number type, SI units.
    pub setpoint: Setpoint<N>,
}

/// Fields of one row of a table, by the places of their columns.
pub trait Fields {
    /// Number of fields.
    fn count(&self) -> usize;

    /// The field at `index` as a number. `None`: the field holds none.
    fn number(&self, index: usize) -> Option<f64>;

    /// The field at `index` as text, for messages. Empty: the field holds nothing.
    fn text(&self, index: usize) -> Cow<'_, str>;
}

impl Fields for ByteRecord {
    fn count(&self) -> usize {
        self.len()
    }

    fn number(&self, index: usize) -> Option<f64> {
        let field = self.get(index)?.trim_ascii();
        std::str::from_utf8(field).ok()?.parse().ok()
    }

    fn text(&self, index: usize) -> Cow<'_, str> {
        String::from_utf8_lossy(self.get(index).unwrap_or_default().trim_ascii())
    }
}

/// Reads a row as one case.
///
/// # Errors
/// The first column whose value cannot be used, with the value and the reason.
pub fn read<N: Number>(columns: &Columns, row: &impl Fields) -> Result<Case<N>, String> {
    if row.count() != columns.width {
        let hint = match row.count() > columns.width {
            true => " (write decimal points)",
            false => "",
        };
        return Err(format!(
            "{} fields where the header has {}{hint}",
            row.count(),
            columns.width
        ));
    }
    let row = TypedRow {
        row,
        number_type: std::any::type_name::<N>(),
    };
    let [leg1, leg2, leg3] = &columns.legs;
    let link_mass = match &columns.link_mass {
        Some(column) => row.not_negative::<N>(column)?,
        None => 0.0,
    };
    let or_zero = |column: &Option<Column>| match column {
        Some(column) => row.number::<N>(column),
        None => Ok(0.0),
    };
    let [gx, gy] = &columns.gravity;
    let [wx, wy, wa] = &columns.wrench;
    let leg = |columns| read_leg::<N>(&row, columns, link_mass);
    Ok(Case {
        parameters: Parameters {
            legs: [leg(leg1)?, leg(leg2)?, leg(leg3)?],
            platform: PlatformParameters {
                mass_kg: row.not_negative::<N>(&columns.mass)?,
                inertia_kgm2: row.not_negative::<N>(&columns.inertia)?,
                com_m: Vector2::zeros(),
                tool_point_m: Vector2::zeros(),
            },
            gravity_m_s2: Vector2::new(or_zero(gx)?, or_zero(gy)?),
            wrench_force_n: Vector2::new(or_zero(wx)?, or_zero(wy)?),
            wrench_torque_nm: or_zero(wa)?,
        },
        setpoint: match &columns.motion {
            SetpointColumns::State(state) => read_state(&row, state)?,
            SetpointColumns::Move(each) => read_move(&row, each)?,
        },
    })
}

fn read_leg<N: Number>(
    row: &TypedRow<'_, impl Fields>,
    columns: &LegColumns,
    link_mass: f64,
) -> Result<LegParameters, String> {
    let [x, y] = &columns.base;
    let proximal_m = row.positive::<N>(&columns.proximal)?;
    let distal_m = row.positive::<N>(&columns.distal)?;
    Ok(LegParameters {
        base_m: Vector2::new(row.number::<N>(x)?, row.number::<N>(y)?),
        proximal_m,
        distal_m,
        joint_radius_m: row.not_negative::<N>(&columns.joint_radius)?,
        joint_angle_rad: row.number::<N>(&columns.joint_angle)?,
        elbow: match row.number::<N>(&columns.elbow)? {
            1.0 => Elbow::Positive,
            -1.0 => Elbow::Negative,
            _ => return Err(row.refusal(&columns.elbow, "must be 1 or -1")),
        },
        proximal: LinkParameters::uniform_rod(link_mass, proximal_m),
        distal: LinkParameters::uniform_rod(link_mass, distal_m),
        rotor_inertia_kgm2: 0.0,
    })
}

fn read_state<N: Number>(
    row: &TypedRow<'_, impl Fields>,
    columns: &[Column; 9],
) -> Result<Setpoint<N>, String> {
    let mut values = [0.0; 9];
    for (value, column) in values.iter_mut().zip(columns) {
        *value = row.number::<N>(column)?;
    }
    let [x, y, alpha, velocity @ .., ax, ay, aalpha] = values;
    Ok(Setpoint {
        pose: Pose::from_f64(x, y, alpha),
        velocity: Vector3::from(velocity).map(N::from_f64),
        acceleration: Vector3::new(ax, ay, aalpha).map(N::from_f64),
    })
}

fn read_move<N: Number>(
    row: &TypedRow<'_, impl Fields>,
    columns: &MoveColumns,
) -> Result<Setpoint<N>, String> {
    let pose = |[x, y, alpha]: &[Column; 3]| {
        let (x, y) = (row.number::<N>(x)?, row.number::<N>(y)?);
        Ok::<_, String>(Pose::from_f64(x, y, row.number::<N>(alpha)?))
    };
    let (from, to) = (pose(&columns.from)?, pose(&columns.to)?);
    let duration = row.positive::<N>(&columns.duration)?;
    let time = row.not_negative::<N>(&columns.time)?;
    if time > duration {
        let reason = format!("must not be greater than {}", columns.duration.name);
        return Err(row.refusal(&columns.time, &reason));
    }
    // One tick as long as the whole move: its fraction is t / T, which need not be a tick.
    let whole = N::factor_from_f64(duration);
    let part = N::factor_over(N::factor_from_f64(time), whole);
    Ok(RestToRest::new(from, to, 1, whole).at_fraction(N::ONE.scaled(part)))
}

/// A row with the name of the number type that it has to fit.
struct TypedRow<'a, F> {
    row: &'a F,
    number_type: &'static str,
}

impl<F: Fields> TypedRow<'_, F> {
    /// `column = value: reason`, the value shortened.
    fn refusal(&self, column: &Column, reason: &str) -> String {
        let text = self.row.text(column.index);
        let name = &column.name;
        match text.chars().count() {
            0 => format!("{name} is empty"),
            1..=40 => format!("{name} = {text}: {reason}"),
            _ => format!(
                "{name} = {}...: {reason}",
                text.chars().take(40).collect::<String>()
            ),
        }
    }

    /// A finite number, finite in `N` too.
    fn number<N: Number>(&self, column: &Column) -> Result<f64, String> {
        let value = self
            .row
            .number(column.index)
            .ok_or_else(|| self.refusal(column, "is not a number"))?;
        if !value.is_finite() {
            Err(self.refusal(column, "is not finite"))
        } else if !N::from_f64(value).is_finite() {
            Err(self.refusal(
                column,
                &format!("is beyond the range of {}", self.number_type),
            ))
        } else {
            Ok(value)
        }
    }

    fn not_negative<N: Number>(&self, column: &Column) -> Result<f64, String> {
        match self.number::<N>(column)? {
            value if value >= 0.0 => Ok(value),
            _ => Err(self.refusal(column, "must not be negative")),
        }
    }

    fn positive<N: Number>(&self, column: &Column) -> Result<f64, String> {
        match self.number::<N>(column)? {
            value if N::from_f64(value) > N::ZERO => Ok(value),
            value if value > 0.0 => Err(self.refusal(
                column,
                &format!("is too small for {}, it would count as 0", self.number_type),
            )),
            _ => Err(self.refusal(column, "must be greater than 0")),
        }
    }
}
