//! Drawing of the mechanism for the 3D panel: links as lines, the platform as a triangle, joints as balls.

use foxglove::messages::{
    Color, LinePrimitive, Point3, Pose, Quaternion, SceneEntity, SceneUpdate, SpherePrimitive,
    Timestamp, Vector3, line_primitive,
};
use trirrr_scene::record::{LegRecord, Record};

/// Frame of the machine's base.
pub(crate) const WORLD: &str = "world";

/// Thickness of a line, px.
const THICKNESS_PX: f64 = 4.0;

/// Radius of a joint as a part of the proximal link.
const JOINT: f64 = 0.06;

const LINK: Color = Color {
    r: 0.35,
    g: 0.55,
    b: 0.85,
    a: 1.0,
};

const PLATFORM: Color = Color {
    r: 0.95,
    g: 0.6,
    b: 0.2,
    a: 1.0,
};

/// The machine where `record` has it. It replaces the drawing before.
pub(crate) fn update(record: &Record, at: Timestamp) -> SceneUpdate {
    let corners = record.legs.each_ref().map(platform_joint);
    let lines = record.legs.iter().map(|leg| {
        let points = [leg.base, leg.elbow(), platform_joint(leg)];
        line(&points, line_primitive::Type::LineStrip, LINK)
    });
    let platform = line(&corners, line_primitive::Type::LineLoop, PLATFORM);
    let size = record.legs.iter().map(|leg| leg.r1[0].hypot(leg.r1[1]));
    let size = JOINT * size.fold(f64::INFINITY, f64::min);
    let joints = record.legs.iter().flat_map(|leg| [leg.base, leg.elbow()]);
    let entity = SceneEntity {
        timestamp: Some(at),
        frame_id: WORLD.into(),
        id: "machine".into(),
        lines: lines.chain([platform]).collect(),
        spheres: joints.map(|place| ball(place, size)).collect(),
        ..SceneEntity::default()
    };
    SceneUpdate {
        deletions: Vec::new(),
        entities: vec![entity],
    }
}

/// Platform joint C of a leg.
fn platform_joint(leg: &LegRecord) -> [f64; 2] {
    let [x, y] = leg.elbow();
    [x + leg.r2[0], y + leg.r2[1]]
}

fn line(points: &[[f64; 2]], kind: line_primitive::Type, color: Color) -> LinePrimitive {
    let point = |[x, y]: &[f64; 2]| Point3 {
        x: *x,
        y: *y,
        z: 0.0,
    };
    LinePrimitive {
        r#type: kind.into(),
        pose: Some(place([0.0; 2])),
        thickness: THICKNESS_PX,
        scale_invariant: true,
        points: points.iter().map(point).collect(),
        color: Some(color),
        ..LinePrimitive::default()
    }
}

fn ball(at: [f64; 2], diameter: f64) -> SpherePrimitive {
    SpherePrimitive {
        pose: Some(place(at)),
        size: Some(Vector3 {
            x: diameter,
            y: diameter,
            z: diameter,
        }),
        color: Some(LINK),
    }
}

fn place([x, y]: [f64; 2]) -> Pose {
    Pose {
        position: Some(Vector3 { x, y, z: 0.0 }),
        orientation: Some(Quaternion {
            x: 0.0,
            y: 0.0,
            z: 0.0,
            w: 1.0,
        }),
    }
}
