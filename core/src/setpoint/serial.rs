//! Setpoints in messages: plain tuples, in the order of their fields.

use super::{Pose, Setpoint};
use crate::number::Number;
use nalgebra::{Vector2, Vector3};
use postcard_schema::Schema;
use postcard_schema::schema::{DataModelType, NamedType};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

impl<N: Number + Serialize> Serialize for Pose<N>
where
    N::Angle: Serialize,
{
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        (self.position.x, self.position.y, self.angle).serialize(serializer)
    }
}

impl<'de, N: Number + Deserialize<'de>> Deserialize<'de> for Pose<N>
where
    N::Angle: Deserialize<'de>,
{
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let (x, y, angle) = Deserialize::deserialize(deserializer)?;
        Ok(Self {
            position: Vector2::new(x, y),
            angle,
        })
    }
}

impl<N: Number + Serialize> Serialize for Setpoint<N>
where
    N::Angle: Serialize,
{
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let velocity: [N; 3] = self.velocity.into();
        let acceleration: [N; 3] = self.acceleration.into();
        (&self.pose, velocity, acceleration).serialize(serializer)
    }
}

impl<'de, N: Number + Deserialize<'de>> Deserialize<'de> for Setpoint<N>
where
    N::Angle: Deserialize<'de>,
{
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let (pose, velocity, acceleration): (Pose<N>, [N; 3], [N; 3]) =
            Deserialize::deserialize(deserializer)?;
        Ok(Self {
            pose,
            velocity: Vector3::from(velocity),
            acceleration: Vector3::from(acceleration),
        })
    }
}

impl<N: Number + Schema> Schema for Pose<N>
where
    N::Angle: Schema,
{
    const SCHEMA: &'static NamedType = &NamedType {
        name: "Pose",
        ty: &DataModelType::Tuple(&[N::SCHEMA, N::SCHEMA, N::Angle::SCHEMA]),
    };
}

impl<N: Number + Schema> Schema for Setpoint<N>
where
    N::Angle: Schema,
{
    const SCHEMA: &'static NamedType = &NamedType {
        name: "Setpoint",
        ty: &DataModelType::Tuple(&[Pose::<N>::SCHEMA, <[N; 3]>::SCHEMA, <[N; 3]>::SCHEMA]),
    };
}
