//! Entities of a DXF file, as strokes of a drawing.

use super::colour::{LayerLook, colour};
use super::courses::{
    Course, MESH, ellipse, facing, is_mesh, level, polygon, polyline, quadrangle, round, vertices,
    xy,
};
use super::curves::{Outline, sweep};
use super::fit::FitCurve;
use super::names::{EntityFate, Named, Names};
use super::place::Affine;
use super::spline::Nurbs;
use super::{DxfChoices, fault};
use crate::drawing::{Drawing, Rgb, Shape, Stroke};
use crate::{PathFault, short};
use dxf::Vector;
use dxf::entities::{Entity, EntityType, Insert};
use std::collections::{BTreeMap, HashMap};
use std::f64::consts::TAU;

/// Deepest nesting of blocks.
const DEPTH_MAX: u32 = 16;

/// Most strokes of a file, with all copies of its blocks.
const STROKES_MAX: usize = 1_000_000;

/// Largest size of a coordinate, m: a drawing that is too large is told its size.
const LARGEST_M: f64 = 1e15;

/// Reader of a file.
pub(super) struct Reader<'f> {
    pub(super) file: &'f dxf::Drawing,
    pub(super) names: &'f Names,
    pub(super) layers: HashMap<String, LayerLook>,
    pub(super) choices: &'f DxfChoices,
    pub(super) drawing: Drawing,
    pub(super) told: ToldEntities,
}

/// Entities that a user has to know of: their kinds, each with the number of them and the line of the first one.
#[derive(Debug, Default)]
pub(super) struct ToldEntities {
    /// Entities that are no lines, with the reason.
    pub(super) left_out: BTreeMap<String, (usize, u32, &'static str)>,
    /// Strokes of line types with gaps, by the names of the types.
    pub(super) dashed: BTreeMap<String, (usize, u32)>,
    /// Entities without a length.
    pub(super) points: (usize, u32),
}

/// Place of entities: the drawing itself, or a copy of a block.
pub(super) struct Frame {
    place: Affine,
    /// Layer of what is on layer 0 of a block.
    layer: Option<String>,
    /// Colour of what takes that of its block.
    colour: Option<Rgb>,
    depth: u32,
}

impl Frame {
    /// Frame of the drawing itself.
    pub(super) fn whole(place: Affine) -> Self {
        Self {
            place,
            layer: None,
            colour: None,
            depth: 0,
        }
    }
}

impl Reader<'_> {
    /// Adds what is drawn of `entities`, which the file has at `named`.
    ///
    /// # Errors
    /// An entity that cannot be drawn, or that cannot be read.
    pub(super) fn add<'e>(
        &mut self,
        entities: impl Iterator<Item = &'e Entity>,
        named: &[Named],
        frame: &Frame,
    ) -> Result<(), PathFault> {
        let mut entities = entities.filter(|entity| is_drawn(&entity.specific));
        for named in named {
            let layer = match &frame.layer {
                Some(layer) if named.layer == "0" => layer.as_str(),
                _ => named.layer.as_str(),
            };
            let look = self.layers.get(&layer.to_lowercase());
            let shows = look.is_none_or(|look| look.shows);
            let seen = shows && !named.hidden && !self.choices.leaves_out(layer, &named.name);
            match named.fate() {
                EntityFate::Drawn => {}
                EntityFate::LeftOut(reason) => {
                    if seen {
                        let kind = self.told.left_out.entry(named.name.clone());
                        kind.or_insert((0, named.line, reason)).0 += 1;
                    }
                    continue;
                }
                EntityFate::Refused(reason) => match seen {
                    true => return Err(fault(named.line, &named.name, reason)),
                    false => continue,
                },
            }
            let Some(entity) = entities.next() else {
                return Err(fault(
                    named.line,
                    &named.name,
                    "it cannot be read: a number of it is none",
                ));
            };
            if !seen {
                continue;
            }
            let layer_colour = look.and_then(|look| look.colour);
            let line_type = match entity.common.line_type_name.as_str() {
                own if own.is_empty() || own.eq_ignore_ascii_case("BYLAYER") => {
                    look.map_or("", |look| &look.line_type)
                }
                own => own,
            };
            let is_whole = ["", "CONTINUOUS", "BYBLOCK"]
                .iter()
                .any(|whole| line_type.eq_ignore_ascii_case(whole));
            if !is_whole && !matches!(entity.specific, EntityType::Insert(_)) {
                let kind = self.told.dashed.entry(line_type.to_owned());
                kind.or_insert((0, named.line)).0 += 1;
            }
            let colour = colour(&entity.common, layer_colour, frame.colour);
            match &entity.specific {
                EntityType::Polyline(mesh) if is_mesh(mesh) => {
                    if !self.choices.leaves_out(layer, "MESH") {
                        let kind = self.told.left_out.entry("MESH".into());
                        kind.or_insert((0, named.line, MESH)).0 += 1;
                    }
                }
                EntityType::Insert(insert) => self.insert(insert, named, (layer, colour), frame)?,
                other => self.draw(other, named, (layer, colour), frame)?,
            }
        }
        Ok(())
    }

    /// Adds the copies of a block.
    fn insert(
        &mut self,
        insert: &Insert,
        named: &Named,
        (layer, colour): (&str, Option<Rgb>),
        frame: &Frame,
    ) -> Result<(), PathFault> {
        let refused = |reason: &str| fault(named.line, &named.name, reason);
        let named_so = |name: &str| name.to_lowercase() == insert.name.to_lowercase();
        let block = self.file.blocks().find(|block| named_so(&block.name));
        let block = block
            .ok_or_else(|| refused(&format!("there is no block {:?}", short(&insert.name))))?;
        if frame.depth == DEPTH_MAX {
            return Err(refused("blocks are nested too deeply, or in themselves"));
        }
        let names = self.names;
        let own = names.blocks.get(&block.name).map_or(&[][..], Vec::as_slice);
        let outer = frame
            .place
            .after(&facing(&insert.extrusion_direction, named)?);
        let turn = insert.rotation.to_radians();
        let spacing = Affine::new([1.0; 2], turn, xy(&insert.location));
        let scales = [insert.x_scale_factor, insert.y_scale_factor];
        let base = xy(&block.base_point).map(|base| -base);
        for row in 0..insert.row_count.max(1) {
            for column in 0..insert.column_count.max(1) {
                let corner = [
                    f64::from(column) * insert.column_spacing,
                    f64::from(row) * insert.row_spacing,
                ];
                let copy = Affine::new(scales, turn, spacing.point(corner));
                let frame = Frame {
                    place: outer.after(&copy).after(&Affine::new([1.0; 2], 0.0, base)),
                    layer: Some(layer.to_owned()),
                    colour,
                    depth: frame.depth + 1,
                };
                self.add(block.entities.iter(), own, &frame)?;
                // A block without strokes may have copies without number, too.
                self.count(named)?;
            }
        }
        Ok(())
    }

    fn count(&self, named: &Named) -> Result<(), PathFault> {
        match self.drawing.strokes.len() > STROKES_MAX {
            true => {
                let reason = format!("with it the drawing has more than {STROKES_MAX} strokes");
                Err(fault(named.line, &named.name, &reason))
            }
            false => Ok(()),
        }
    }

    /// Adds the stroke of an entity.
    fn draw(
        &mut self,
        entity: &EntityType,
        named: &Named,
        (layer, colour): (&str, Option<Rgb>),
        frame: &Frame,
    ) -> Result<(), PathFault> {
        let flat = |normal: &Vector| Ok(frame.place.after(&facing(normal, named)?));
        let (start, curves) = match entity {
            EntityType::Line(line) => {
                level(&[&line.p1, &line.p2], named)?;
                polygon(&frame.place, &[&line.p1, &line.p2], false)
            }
            EntityType::Solid(each) => quadrangle(
                &flat(&each.extrusion_direction)?,
                [&each.first_corner, &each.second_corner],
                [&each.third_corner, &each.fourth_corner],
                named,
            )?,
            EntityType::Trace(each) => quadrangle(
                &flat(&each.extrusion_direction)?,
                [&each.first_corner, &each.second_corner],
                [&each.third_corner, &each.fourth_corner],
                named,
            )?,
            EntityType::Arc(arc) => {
                let [from, to] = [arc.start_angle, arc.end_angle].map(f64::to_radians);
                round(
                    &flat(&arc.normal)?,
                    &arc.center,
                    arc.radius,
                    [from, sweep(from, to)],
                )
            }
            EntityType::Circle(circle) => round(
                &flat(&circle.normal)?,
                &circle.center,
                circle.radius,
                [0.0, TAU],
            ),
            EntityType::Ellipse(part) => ellipse(&frame.place, part, named)?,
            EntityType::LwPolyline(line) => {
                let place = flat(&line.extrusion_direction)?;
                let vertices = line
                    .vertices
                    .iter()
                    .map(|vertex| ([vertex.x, vertex.y], vertex.bulge));
                polyline(&place, vertices.collect(), line.is_closed())
            }
            EntityType::Polyline(line) => {
                let (vertices, is_closed) = (vertices(line, named)?, line.is_closed());
                polyline(&flat(&line.normal)?, vertices, is_closed)
            }
            EntityType::Spline(spline) => {
                let points = spline.control_points.iter().chain(&spline.fit_points);
                level(&points.collect::<Vec<_>>(), named)?;
                if spline.control_points.is_empty() && !spline.fit_points.is_empty() {
                    let [first, last] = [&spline.start_tangent, &spline.end_tangent].map(xy);
                    let points = spline.fit_points.iter().map(xy);
                    let curve =
                        FitCurve::new(points, spline.is_closed(), [Some(first), Some(last)]);
                    let mut chain = Outline::new(&frame.place, curve.start());
                    curve.add_to(&mut chain);
                    return self.stroke((chain.start, chain.curves), named, layer, colour);
                }
                let nurbs = Nurbs::new(spline, named.line)?;
                let mut chain = Outline::new(&frame.place, nurbs.start());
                nurbs.add_to(&mut chain);
                (chain.start, chain.curves)
            }
            _ => return Ok(()),
        };
        self.stroke((start, curves), named, layer, colour)
    }

    /// Adds a stroke.
    fn stroke(
        &mut self,
        (start, curves): Course,
        named: &Named,
        layer: &str,
        colour: Option<Rgb>,
    ) -> Result<(), PathFault> {
        let stroke = Stroke {
            shape: self.drawing.shapes.len(),
            colour,
            start,
            curves,
        };
        if !stroke.is_within(LARGEST_M) {
            let reason = "it has a coordinate that is no number, or beyond all drawings";
            return Err(fault(named.line, &named.name, reason));
        }
        if stroke.curves.is_empty() {
            if self.told.points.0 == 0 {
                self.told.points.1 = named.line;
            }
            self.told.points.0 += 1;
            return Ok(());
        }
        self.drawing.shapes.push(Shape {
            name: format!("{} in line {}", named.name, named.line),
            layer: layer.to_owned(),
        });
        self.drawing.strokes.push(stroke);
        self.count(named)
    }
}

/// Returns true for the kinds that are drawn, as [`EntityFate`] has them.
fn is_drawn(entity: &EntityType) -> bool {
    matches!(
        entity,
        EntityType::Line(_)
            | EntityType::LwPolyline(_)
            | EntityType::Polyline(_)
            | EntityType::Arc(_)
            | EntityType::Circle(_)
            | EntityType::Ellipse(_)
            | EntityType::Spline(_)
            | EntityType::Insert(_)
            | EntityType::Solid(_)
            | EntityType::Trace(_)
    )
}
