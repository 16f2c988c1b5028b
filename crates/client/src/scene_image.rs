//! Values of a scene as they go over the line.

use trirrr_protocol::message::{SceneHeader, SceneTypes};
use trirrr_protocol::wire::{checksum_of_bytes, to_bytes};
use trirrr_service::coefficients::SceneValues;

/// Values of a scene for a board whose program takes one over its line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneImage {
    header: SceneHeader,
    bytes: Vec<u8>,
    /// Of the scene.
    key: u32,
}

impl SceneImage {
    /// Values of a scene that needs `types`.
    pub fn new(types: SceneTypes, values: &SceneValues) -> Self {
        let mut room = [0; SceneValues::LONGEST];
        let bytes = to_bytes(values, &mut room).expect("the room is that of the longest values");
        Self {
            header: SceneHeader {
                // Within the room.
                length: bytes.len() as u32,
                checksum: checksum_of_bytes(bytes),
                layout: SceneValues::LAYOUT,
                types,
            },
            bytes: bytes.to_vec(),
            key: values.key,
        }
    }

    /// Description of the values.
    pub fn header(&self) -> &SceneHeader {
        &self.header
    }

    /// Values, as they are sent.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Key of the scene.
    pub fn key(&self) -> u32 {
        self.key
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::update_client::{OtherEnd, talk};
    use crate::{Patience, UpdateClient, UpdateFailure};
    use trirrr_core::units::Units;
    use trirrr_protocol::message::{
        Command, Refusal, Reply, SCENE_KEYS, SceneNeed, SceneNeeds, SceneRoom, UpdateOutcome,
        UpdateRefusal, UpdateStatus, UpdateStep,
    };
    use trirrr_protocol::wire::of_bytes;
    use trirrr_scene::Scene;

    const KEYS: [u32; SCENE_KEYS] = [3; SCENE_KEYS];

    fn values() -> SceneValues {
        let text = include_str!("../../../scenes/thesis.toml");
        let scene = Scene::parse(text, "thesis.toml").expect("a shipped scene is good");
        trirrr_scene::values::<f64>(&scene, &Units::SI).expect("a machine at its start")
    }

    fn types(parts: &[SceneNeed]) -> SceneTypes {
        SceneTypes::with_room(parts, 0, KEYS)
    }

    /// A board as the client sees it.
    struct BoardOfTests {
        room: Option<SceneRoom>,
        /// Key of its scene, before and after.
        scene: u32,
        received: Vec<u8>,
        coming: Option<SceneHeader>,
        /// Takes the scene at its restart.
        adopts: bool,
        steps: u32,
    }

    impl BoardOfTests {
        fn with(types: SceneTypes) -> Self {
            Self {
                room: Some(SceneRoom {
                    room: 2000,
                    layout: SceneValues::LAYOUT,
                    types,
                }),
                scene: 1,
                received: Vec::new(),
                coming: None,
                adopts: true,
                steps: 0,
            }
        }

        fn take(&mut self, scene: SceneImage) -> Result<(), UpdateFailure<f64>> {
            let mut client = UpdateClient::of_scene(scene, Patience::default(), 7);
            talk(&mut client, self).expect("a result")
        }
    }

    impl OtherEnd for BoardOfTests {
        fn answer(&mut self, command: &Command<f64>) -> Reply<f64> {
            match command {
                Command::Hello(_) => {
                    let identity = crate::exchange::identity_of_tests(300);
                    Reply::Hello(trirrr_protocol::message::Identity {
                        scene: self.scene,
                        ..identity
                    })
                }
                Command::UpdateStatus => Reply::Update(UpdateStatus {
                    start: 0,
                    room: 0,
                    coming: self.coming.map(|header| header.checksum),
                    received: self.received.len() as u32,
                    outcome: UpdateOutcome::Never,
                    scene: self.room,
                }),
                Command::Update(step) => {
                    self.steps += 1;
                    match step {
                        UpdateStep::BeginScene(header) => {
                            self.coming = Some(*header);
                            self.received.clear();
                        }
                        UpdateStep::Block(block) => self.received.extend(block.bytes()),
                        UpdateStep::Finish => {
                            let header = self.coming.take().expect("a scene was begun");
                            assert_eq!(checksum_of_bytes(&self.received), header.checksum);
                        }
                        UpdateStep::Restart if self.adopts => {
                            let values: SceneValues =
                                of_bytes(&self.received).expect("whole values");
                            self.scene = values.key;
                        }
                        UpdateStep::Restart => {}
                        UpdateStep::Begin(_) => panic!("no program"),
                    }
                    Reply::Done
                }
                other => panic!("{other:?}"),
            }
        }
    }

    #[test]
    fn a_board_takes_a_scene_and_its_hello_tells_the_key() {
        let values = values();
        let mut board = BoardOfTests::with(types(&[SceneNeed::Torques]));
        let image = SceneImage::new(types(&[SceneNeed::Torques]), &values);
        assert_eq!(board.take(image), Ok(()));
        assert_eq!(board.scene, values.key);
        assert_eq!(of_bytes(&board.received), Some(values));
    }

    #[test]
    fn what_an_image_lacks_is_named_before_anything_is_sent() {
        let mut board = BoardOfTests::with(types(&[SceneNeed::Torques]));
        let mut needed = types(&[SceneNeed::Torques, SceneNeed::Jerk]);
        needed.keys[SceneNeed::ToolOutput as usize - SceneNeed::Number as usize] = 4;
        let failure = board
            .take(SceneImage::new(needed, &values()))
            .expect_err("two parts");
        let mut lacks = SceneNeeds::default();
        lacks.insert(SceneNeed::Jerk);
        lacks.insert(SceneNeed::ToolOutput);
        assert_eq!(failure, UpdateFailure::Lacks(lacks));
        let text = failure.describe();
        assert!(
            text.contains("jerk_rad_s3") && text.contains("[tool]"),
            "{text}"
        );
        assert!(text.contains("build an image"), "{text}");
        let refused = |board: &mut BoardOfTests| {
            let image = SceneImage::new(types(&[]), &values());
            board.take(image).expect_err("no such room")
        };
        let update = |refusal| UpdateFailure::Refused(Refusal::Update(refusal));
        board.room = board.room.map(|room| SceneRoom { layout: 1, ..room });
        assert_eq!(refused(&mut board), update(UpdateRefusal::SceneLayout));
        board.room = None;
        assert_eq!(refused(&mut board), update(UpdateRefusal::NoScene));
        assert_eq!(board.steps, 0);
    }

    #[test]
    fn a_board_that_starts_with_another_scene_is_told() {
        let mut board = BoardOfTests::with(types(&[]));
        board.adopts = false;
        let result = board.take(SceneImage::new(types(&[]), &values()));
        assert_eq!(result, Err(UpdateFailure::OtherScene));
    }
}
