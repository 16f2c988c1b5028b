//! Jobs along a path.
#[test]
fn outline() {
    let text = include_str!("outline_tmp.toml");
    for (number, hold) in [("f64", "0.5"), ("f32", "0.5"), ("f32", "0.1")] {
        let text = text
            .replace("number = \"f32\"", &format!("number = \"{number}\""))
            .replace("hold_ramp_s = 0.5", &format!("hold_ramp_s = {hold}"));
        let began = std::time::Instant::now();
        match trirrr_scene::Scene::parse(&text, "outline.toml") {
            Ok(scene) => println!(
                "{number} {hold}: {} moves {} ticks {:?}",
                scene.job.moves.len(),
                scene.ticks(),
                began.elapsed()
            ),
            Err(error) => println!("{number} {hold}: {error} {:?}", began.elapsed()),
        }
    }
}
