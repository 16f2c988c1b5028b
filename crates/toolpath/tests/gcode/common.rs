//! Shorthand of these tests.
use trirrr_toolpath::gcode::{GcodeSetup, Interpreter};
use trirrr_toolpath::{Act, Element, PathFault, ToolCurve, ToolMotion, ToolPlace};

/// Place of x and y, mm, and alpha, degrees.
pub(crate) fn place(x: f64, y: f64, alpha: f64) -> ToolPlace {
    ToolPlace {
        position_m: [x / 1000.0, y / 1000.0],
        alpha_rad: alpha.to_radians(),
    }
}

/// Runs all lines of a text.
pub(crate) fn run_with(setup: GcodeSetup, text: &str) -> (Interpreter, Vec<Element>) {
    let mut interpreter = Interpreter::new(setup);
    let mut elements = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        elements.extend(interpreter.line(number, line).unwrap().elements);
    }
    (interpreter, elements)
}

/// Runs all lines with the standard setup.
pub(crate) fn run(text: &str) -> (Interpreter, Vec<Element>) {
    run_with(GcodeSetup::default(), text)
}

/// The last motion of a text.
pub(crate) fn last(text: &str) -> ToolMotion {
    motion(run(text).1.last().unwrap())
}

/// The motion of an element.
pub(crate) fn motion(element: &Element) -> ToolMotion {
    match element.act {
        Act::Motion(motion) => motion,
        act => panic!("no motion: {act:?}"),
    }
}

/// Centre, mm, and turn, degrees, of an arc.
pub(crate) fn arc(motion: ToolMotion) -> ([f64; 2], f64) {
    match motion.curve {
        ToolCurve::Arc {
            centre_m: [x, y],
            turn_rad,
        } => ([x * 1000.0, y * 1000.0], turn_rad.to_degrees()),
        curve => panic!("no arc: {curve:?}"),
    }
}

/// Refusal of the last line of a text. The lines before must hold, and the last one must change nothing.
pub(crate) fn refused_with(setup: GcodeSetup, text: &str) -> PathFault {
    let (before, line) = text.rsplit_once('\n').unwrap_or(("", text));
    let (mut interpreter, _) = run_with(setup, before);
    let state = observable(&interpreter);
    let number = 1 + before.lines().count() as u32;
    let fault = interpreter.line(number, line).expect_err(line).fault;
    assert_eq!(observable(&interpreter), state, "{line}");
    assert_eq!(fault.line, number);
    assert!(fault.reason.len() > 10, "{fault}");
    fault
}

/// Refusal with the standard setup.
pub(crate) fn refused(text: &str) -> PathFault {
    refused_with(GcodeSetup::default(), text)
}

/// Everything that can be seen of an interpreter.
pub(crate) fn observable(interpreter: &Interpreter) -> String {
    let origins: Vec<_> = (0..6).map(|index| interpreter.origin(index)).collect();
    format!(
        "{:?} {:?} {:?} {:?}",
        interpreter.place(),
        interpreter.modal(),
        origins,
        interpreter.shift()
    )
}

/// Asserts that two places are the same within 1e-12 m and rad.
#[track_caller]
pub(crate) fn same(a: ToolPlace, b: ToolPlace) {
    let [dx, dy] = [0, 1].map(|axis| a.position_m[axis] - b.position_m[axis]);
    assert!(
        dx.hypot(dy) < 1e-12 && (a.alpha_rad - b.alpha_rad).abs() < 1e-12,
        "{a:?} is not {b:?}"
    );
}

/// Asserts that two numbers are the same within 1e-9 of the second.
#[track_caller]
pub(crate) fn near(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-9 * b.abs().max(1e-3), "{a} is not {b}");
}
