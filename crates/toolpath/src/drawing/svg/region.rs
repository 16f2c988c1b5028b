//! Regions that clips and masks leave, and what of chains lies in them.

use super::chain::CurveChain;
use super::curve::{PathCurve, distance};
use super::edges::{Edges, FLATNESS_M, NEAR_M};

/// Region in the plane, m: the last of its shapes that holds a point says whether it is in it.
#[derive(Debug, Default)]
pub(super) struct ClipRegion {
    pub(super) shapes: Vec<RegionShape>,
}

/// Shape of a region.
#[derive(Debug)]
pub(super) struct RegionShape {
    pub(super) chains: Vec<CurveChain>,
    pub(super) is_non_zero: bool,
    /// True: it adds to the region. False: it takes away.
    pub(super) adds: bool,
    edges: Edges,
}

impl RegionShape {
    pub(super) fn new(chains: Vec<CurveChain>, is_non_zero: bool, adds: bool) -> Self {
        let edges = Edges::new(&chains);
        Self {
            chains,
            is_non_zero,
            adds,
            edges,
        }
    }

    fn holds(&self, point: [f64; 2]) -> bool {
        let winding = self.edges.winding(point);
        match self.is_non_zero {
            true => winding != 0,
            false => winding % 2 != 0,
        }
    }

    /// Lower left and upper right corner, if it is a rectangle along the axes.
    fn rectangle(&self) -> Option<[[f64; 2]; 2]> {
        let [chain] = &self.chains[..] else {
            return None;
        };
        let corners: Vec<[f64; 2]> = chain.curves.iter().map(PathCurve::end).collect();
        let straight = chain
            .curves
            .iter()
            .all(|curve| matches!(curve, PathCurve::Line(_)));
        let (low, high) = (self.edges.low, self.edges.high);
        let in_corner = |point: &[f64; 2]| {
            [0, 1]
                .iter()
                .all(|&i| (point[i] - low[i]).min(high[i] - point[i]).abs() < 1e-12)
        };
        (self.adds && straight && matches!(corners.len(), 3 | 4) && corners.iter().all(in_corner))
            .then_some([low, high])
    }
}

impl ClipRegion {
    fn holds(&self, point: [f64; 2]) -> bool {
        let mut shapes = self.shapes.iter().rev();
        shapes
            .find(|shape| shape.holds(point))
            .is_some_and(|shape| shape.adds)
    }

    fn is_near(&self, point: [f64; 2]) -> bool {
        self.shapes.iter().any(|shape| shape.edges.is_near(point))
    }

    /// Returns true if the chains are in the region by their hulls alone.
    fn holds_hull(&self, chains: &[CurveChain]) -> bool {
        let [shape] = &self.shapes[..] else {
            return false;
        };
        shape.rectangle().is_some_and(|[low, high]| {
            chains.iter().flat_map(CurveChain::hull).all(|point| {
                [0, 1]
                    .iter()
                    .all(|&i| point[i] >= low[i] - NEAR_M && point[i] <= high[i] + NEAR_M)
            })
        })
    }
}

/// Returns the parts of lines that are in all regions, or on their edges.
pub(super) fn cut_lines(chains: &[CurveChain], regions: &[&ClipRegion]) -> Vec<CurveChain> {
    let mut left = chains.to_vec();
    for region in regions {
        if region.holds_hull(&left) {
            continue;
        }
        let edges: Vec<&Edges> = region.shapes.iter().map(|shape| &shape.edges).collect();
        let is_in = |point, _| region.holds(point) || region.is_near(point);
        left = left
            .iter()
            .flat_map(|chain| split(chain, &edges, &is_in))
            .collect();
    }
    left
}

/// Outlines of an area in all regions: None where the regions hold it whole.
pub(super) fn cut_area(
    chains: &[CurveChain],
    is_non_zero: bool,
    regions: &[&ClipRegion],
) -> Option<Vec<CurveChain>> {
    let mut cutting = regions.to_vec();
    cutting.retain(|region| !region.holds_hull(chains));
    if cutting.is_empty() {
        return None;
    }
    let area = RegionShape::new(chains.to_vec(), is_non_zero, true);
    let is_in = |point| area.holds(point) && cutting.iter().all(|region| region.holds(point));
    let sides = |point: [f64; 2], normal: [f64; 2]| {
        [1.0, -1.0].map(|side| is_in([0, 1].map(|i| point[i] + 2.0 * side * NEAR_M * normal[i])))
    };
    let shapes = || cutting.iter().flat_map(|region| &region.shapes);
    let mut edges: Vec<&Edges> = shapes().map(|shape| &shape.edges).collect();
    let mut found = Vec::new();
    for chain in chains {
        // One side of an outline, or both, is in the area.
        found.extend(split(chain, &edges, &|point, normal| {
            sides(point, normal) != [false; 2]
        }));
    }
    edges.push(&area.edges);
    let is_whole = found == chains;
    let own = found.len();
    let mut drawn = vec![&area.edges];
    for shape in shapes() {
        for chain in &shape.chains {
            let mut chain = chain.clone();
            chain.close();
            found.extend(split(&chain, &edges, &|point, normal| {
                let [left, right] = sides(point, normal);
                left != right && !drawn.iter().any(|edges| edges.is_near(point))
            }));
        }
        drawn.push(&shape.edges);
    }
    (!is_whole || found.len() > own).then_some(found)
}

/// Parts of a chain that are kept: by a point on them, and the direction across.
fn split(
    chain: &CurveChain,
    edges: &[&Edges],
    is_kept: &dyn Fn([f64; 2], [f64; 2]) -> bool,
) -> Vec<CurveChain> {
    let mut parts: Vec<CurveChain> = Vec::new();
    let mut open: Option<CurveChain> = None;
    let (mut begins_in, mut is_whole) = (false, true);
    for (index, (from, curve)) in chain.curves().enumerate() {
        let mut places = vec![0.0, 1.0];
        let count = curve.chords(from, FLATNESS_M);
        let part = |index: u32| f64::from(index) / f64::from(count);
        let mut at = from;
        for chord in 0..count {
            let to = match chord + 1 == count {
                true => curve.end(),
                false => curve.at(from, part(chord + 1)),
            };
            for edges in edges {
                edges.crossings(at, to, &mut |place| {
                    places.push(part(chord) + place / f64::from(count))
                });
            }
            at = to;
        }
        places.sort_by(f64::total_cmp);
        let mut begin = 0.0;
        let mut run: Option<f64> = None;
        for &end in &places[1..] {
            let points = [0.25, 0.5, 0.75].map(|p| curve.at(from, begin + p * (end - begin)));
            let along = [points[2][0] - points[0][0], points[2][1] - points[0][1]];
            let length = libm::hypot(along[0], along[1]);
            // Two crossings in one place.
            if length < 0.1 * NEAR_M && end < 1.0 {
                continue;
            }
            let normal = match length > 0.0 {
                true => [-along[1] / length, along[0] / length],
                false => [0.0; 2],
            };
            match is_kept(points[1], normal) {
                true => {
                    begins_in |= index == 0 && begin == 0.0;
                    run = run.or(Some(begin));
                }
                false => {
                    is_whole = false;
                    if let Some(start) = run.take() {
                        add(&mut open, from, curve, [start, begin]);
                    }
                    parts.extend(open.take());
                }
            }
            begin = end;
        }
        if let Some(start) = run {
            add(&mut open, from, curve, [start, 1.0]);
        }
    }
    if is_whole {
        return vec![chain.clone()];
    }
    match open {
        // The start of a closed chain is no end of a part.
        Some(mut last)
            if begins_in && distance(last.end(), chain.start) < NEAR_M && !parts.is_empty() =>
        {
            last.curves.extend(parts.remove(0).curves);
            parts.insert(0, last);
        }
        open => parts.extend(open),
    }
    parts
}

fn add(open: &mut Option<CurveChain>, from: [f64; 2], curve: &PathCurve, ends: [f64; 2]) {
    let (start, part) = match ends == [0.0, 1.0] {
        true => (from, *curve),
        false => curve.part(from, ends),
    };
    open.get_or_insert_with(|| CurveChain::new(start))
        .curves
        .push(part);
}
