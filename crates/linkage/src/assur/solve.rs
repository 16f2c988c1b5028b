//! A linkage at one time: its groups solved in order.

use super::constraint::equations;
use super::description::{FRAME, JointDrive, JointKind, Linkage};
use super::dyad::Built;
use super::groups::{Group, GroupKind};
use super::newton;
use super::rail::{Rail, reframed, turned_back};
use super::state::{LinkState, Reason, Solved};
use crate::motion::unit;
use crate::motion::{LinkMotion, SlideMotion};
use nalgebra::Vector2;

/// The linkage at one time.
#[derive(Clone, Debug)]
pub struct Position {
    /// s.
    pub t: f64,
    /// The states of the links, in their order.
    pub states: Vec<LinkState>,
    /// Result of each group, in solving order.
    pub groups: Vec<Solved>,
}

/// A group that has no position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unsolved {
    /// Index in solving order.
    pub group: usize,
    /// Reason.
    pub reason: Reason,
}

/// A linkage with its dyads built.
pub(super) struct Solver<'a> {
    pub(super) linkage: &'a Linkage,
    dyads: Vec<Option<Built>>,
}

/// Both branches, in the order that they are tried in.
const BRANCHES: [f64; 2] = [1.0, -1.0];

impl<'a> Solver<'a> {
    /// Builds every dyad, on the branch that the file asks for or that is nearest to its guess at
    /// the time 0, and returns the first position with it.
    pub(super) fn start(linkage: &'a Linkage) -> Result<(Self, Position), Unsolved> {
        let guesses = linkage
            .links
            .iter()
            .map(|link| link.guess.unwrap_or([0.0; 3]));
        let mut position = Position {
            t: 0.0,
            states: guesses.map(LinkState::at_rest).collect(),
            groups: Vec::new(),
        };
        position.states[FRAME] = LinkState::at_rest([0.0; 3]);
        position.states[FRAME].known = true;
        let mut solver = Self {
            linkage,
            dyads: Vec::new(),
        };
        for (index, group) in linkage.groups.iter().enumerate() {
            let unsolved = |reason| Unsolved {
                group: index,
                reason,
            };
            let built = match group.kind {
                GroupKind::Dyad(kind) => {
                    let asked = group.joints.get(1).and_then(|&j| linkage.joints[j].branch);
                    let open = asked.is_none() && kind.has_branches();
                    let tried: &[f64] = if open { &BRANCHES } else { &BRANCHES[..1] };
                    let mut best: Option<(f64, Built)> = None;
                    let mut refused = Reason::Singular;
                    for &branch in tried {
                        let branch = asked.unwrap_or(branch);
                        let known = |link: usize| position.states[link].known;
                        let built = Built::new(linkage, group, kind, &known, branch)
                            .ok_or_else(|| unsolved(Reason::Singular))?;
                        let mut states = position.states.clone();
                        match built.solve(&mut states) {
                            Ok(_) => {
                                let miss = guess_miss(linkage, group, &states);
                                if best.is_none_or(|(least, _)| miss < least) {
                                    best = Some((miss, built));
                                }
                            }
                            Err(status) => refused = Reason::Dyad(status),
                        }
                    }
                    Some(best.ok_or_else(|| unsolved(refused))?.1)
                }
                _ => None,
            };
            place_blocks(linkage, group, &mut position.states);
            solver.dyads.push(built);
            let solved = solver
                .group(index, &mut position.states, 0.0)
                .map_err(unsolved)?;
            position.groups.push(solved);
        }
        Ok((solver, position))
    }

    /// The position at the time `t`, from predicted states.
    pub(super) fn position(
        &self,
        mut states: Vec<LinkState>,
        t: f64,
    ) -> Result<Position, Unsolved> {
        for state in &mut states {
            state.known = false;
        }
        states[FRAME].known = true;
        let mut groups = Vec::with_capacity(self.linkage.groups.len());
        for group in 0..self.linkage.groups.len() {
            let solved = self
                .group(group, &mut states, t)
                .map_err(|reason| Unsolved { group, reason })?;
            groups.push(solved);
        }
        Ok(Position { t, states, groups })
    }

    fn group(&self, index: usize, states: &mut [LinkState], t: f64) -> Result<Solved, Reason> {
        let group = &self.linkage.groups[index];
        let closed = |distance| Solved {
            distance,
            iterations: 0,
            positive: true,
        };
        match (group.kind, &self.dyads[index]) {
            (GroupKind::Driven, _) => {
                let motion = self.driven(group, states, t).ok_or(Reason::Singular)?;
                states[group.links[0]].take(motion);
                Ok(closed(1.0))
            }
            (GroupKind::Dyad(_), Some(dyad)) => {
                dyad.solve(states).map(closed).map_err(Reason::Dyad)
            }
            _ => {
                let solved = newton::solve(self.linkage, group, states, t)?;
                for &link in &group.links {
                    states[link].known = true;
                }
                Ok(solved)
            }
        }
    }

    /// The motion of the one link of a driven group.
    fn driven(&self, group: &Group, states: &[LinkState], t: f64) -> Option<LinkMotion<f64>> {
        let (own, joint) = (group.links[0], group.joints[0]);
        let drive = &self.linkage.drives[*group.drives.first()?];
        let value = drive.at(t);
        match &self.linkage.joints[joint].kind {
            JointKind::Revolute(pins) => {
                let held = pins.iter().find(|pin| states[pin.link].known)?;
                let pin = states[held.link].motion.point(self.linkage.local(*held));
                let own_pin = pins.iter().find(|pin| pin.link == own)?;
                let motion = turned_by(drive, value, own, states).with_origin(pin);
                let own_pin = self.linkage.local(*own_pin);
                Some(reframed(&motion, Vector2::x(), own_pin))
            }
            JointKind::Prismatic(_) => {
                let holder = match drive.link == own {
                    true => drive.base,
                    false => drive.link,
                };
                let rail = Rail::new(self.linkage, joint, own)?;
                let guide = states[holder].motion.frame(rail.point, rail.direction);
                let sign = if rail.own_is_slider { 1.0 } else { -1.0 };
                let [length, rate, acceleration] = value.map(|value| sign * value);
                let slide = SlideMotion {
                    length,
                    rate,
                    acceleration,
                };
                let motion = guide.with_origin(guide.sliding(&slide, rail.offset));
                Some(reframed(&motion, rail.own_direction, rail.own_point))
            }
        }
    }

    /// The largest residual of all equations of all groups at a position: how well the loops
    /// close, m (and rad for the angles of prismatic joints and drives, times the linkage's size).
    pub(super) fn closure(&self, position: &Position) -> f64 {
        let groups = 0..self.linkage.groups.len();
        let residual = |group: usize| self.residual(group, position);
        groups.map(residual).fold(0.0, f64::max)
    }

    /// The largest residual of one group's equations, as for [`closure`](Self::closure).
    pub(super) fn residual(&self, group: usize, position: &Position) -> f64 {
        let (size, group) = (self.linkage.size(), &self.linkage.groups[group]);
        let at = equations(self.linkage, group, &position.states, position.t);
        let residuals = at
            .iter()
            .map(|e| e.residual.abs() * if e.angular { size } else { 1.0 });
        residuals.fold(0.0, f64::max)
    }
}

/// Direction and turning of the driven link `own`, from the other link of its drive.
fn turned_by(
    drive: &JointDrive,
    [angle, rate, acceleration]: [f64; 3],
    own: usize,
    states: &[LinkState],
) -> LinkMotion<f64> {
    let forwards = drive.link == own;
    let other = states[if forwards { drive.base } else { drive.link }].motion;
    let sign = if forwards { 1.0 } else { -1.0 };
    LinkMotion {
        // Turning back by the opposite angle is turning forwards.
        direction: turned_back(other.direction, unit(-sign * angle)),
        rate: other.rate + sign * rate,
        acceleration: other.acceleration + sign * acceleration,
        ..other
    }
}

/// Puts the blocks of an iterated group where the links of their joints are, or are guessed to be.
fn place_blocks(linkage: &Linkage, group: &Group, states: &mut [LinkState]) {
    let blocks = group
        .links
        .iter()
        .filter(|link| linkage.links[**link].is_block);
    for &block in blocks.filter(|_| group.is_iterated()) {
        for joint in &linkage.joints {
            match &joint.kind {
                JointKind::Prismatic(slide) if slide.slider.link == block => {
                    let [x, y, _] = states[block].pose();
                    let angle = states[slide.guide.link].angle + slide.angle;
                    states[block].move_to([x, y, angle]);
                }
                JointKind::Revolute(pins) if pins.iter().any(|pin| pin.link == block) => {
                    let held = pins.iter().find(|pin| pin.link != block);
                    if let Some(&held) = held {
                        let at = states[held.link].motion.point(linkage.local(held)).position;
                        let [.., angle] = states[block].pose();
                        states[block].move_to([at.x, at.y, angle]);
                    }
                }
                _ => {}
            }
        }
    }
}

/// Returns the squared distance of the group's links from their guesses, in sizes and rad.
fn guess_miss(linkage: &Linkage, group: &Group, states: &[LinkState]) -> f64 {
    let size = linkage.size();
    let misses = group.links.iter().filter_map(|&link| {
        let [x, y, angle] = linkage.links[link].guess?;
        let [at_x, at_y, at_angle] = states[link].pose();
        let turn = super::constraint::wrapped(at_angle - angle);
        Some(((at_x - x) / size).powi(2) + ((at_y - y) / size).powi(2) + turn * turn)
    });
    misses.sum()
}
