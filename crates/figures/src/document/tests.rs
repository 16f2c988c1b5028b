use super::{Document, Facts, csv, digits, schema};
use serde_json::json;

fn peak(value: f64, t_s: f64) -> Facts {
    Facts::new()
        .pair("value", "", value)
        .pair("t_s", "at t =", t_s)
}

fn document() -> Document {
    let mut document = Document::new();
    document.pairs(
        Facts::new()
            .pair("scene", "scene", "thesis")
            .words("thesis (a\nb.toml)")
            .pair("width_m", "width", 0.000_123)
            .group("error_m", "error", peak(0.002, 1.25))
            .pair("end.reason", "reason", None::<String>)
            .pair("end.name", "end", "complete"),
    );
    let motor = |name: &str, torque: Option<f64>| {
        Facts::new()
            .text("motor", name)
            .pair("torque_nm", "torque", torque)
            .pair("source", "source", "https://example.org/a page 2")
            .page_only()
            .pair("rate_rad_s", "rate", None::<f64>)
            .marked(name == "two")
    };
    document.table(
        "motors",
        vec![motor("one", Some(12.3456)), motor("two", None)],
    );
    document
        .page_note("a < b")
        .figure("<svg/>")
        .files(["out/ticks.csv"]);
    document
}

#[test]
fn text_json_and_page_come_from_the_same_values() {
    let document = document();
    assert_eq!(
        document.text(),
        "scene       thesis (a\\u{a}b.toml)\nwidth       123.0 um\nerror       2 mm at t = 1.25 s\nend         complete\n\n  \
         motor  torque, N m\n  one          12.35\n* two              -\n\nwritten     out/ticks.csv\n"
    );
    let motor = |torque: Option<f64>| json!({ "torque_nm": torque, "rate_rad_s": null, "source": "https://example.org/a page 2" });
    let json = json!({
        "scene": "thesis", "width_m": 0.000_123, "error_m": { "value": 0.002, "t_s": 1.25 },
        "end": { "reason": null, "name": "complete" },
        "motors": [motor(Some(12.3456)), motor(None)],
        "files": ["out/ticks.csv"],
    });
    assert_eq!(document.json(), json);
    let page = document.page("A & B");
    for part in [
        "<h1>A &amp; B</h1>",
        "<p>a &lt; b</p>",
        "<th>torque, N m</th>",
        "<td class=\"number\">12.35</td>",
        "<tr class=\"own\"><td>two</td>",
        "<a href=\"https://example.org/a\">",
        "<svg/>",
    ] {
        assert!(page.contains(part), "{part} in\n{page}");
    }
    assert!(!page.contains("rate"), "a column without a value");
}

#[test]
fn a_schema_tells_kinds_units_and_keys() {
    let json = document().json();
    let other = json!({ "scene": 3, "motors": [{ "torque_nm": 2, "rate_rad_s": 1.5 }] });
    let schema = schema::of("run", &[json, other]);
    let width = &schema["properties"]["width_m"];
    assert_eq!(
        (&width["x-unit"], &width["type"]),
        (&json!("m"), &json!("number"))
    );
    let value = &schema["properties"]["error_m"]["properties"]["value"];
    assert_eq!(value["x-unit"], "m");
    assert_eq!(
        schema["properties"]["scene"]["type"],
        json!(["integer", "string"])
    );
    assert_eq!(schema["required"], json!(["motors", "scene"]));
    let motor = &schema["properties"]["motors"]["items"];
    assert_eq!(motor["required"], json!(["rate_rad_s", "torque_nm"]));
    assert_eq!(
        motor["properties"]["torque_nm"]["type"],
        json!(["null", "number"])
    );
}

#[test]
fn tables_in_csv_read_back() {
    let row = |name: &str, value: Option<f64>| {
        Facts::new()
            .data("name", name)
            .data("x_m", value)
            .data("own", true)
            .text("shown", "not here")
    };
    assert_eq!(
        csv(&[row("a,\"b\"", Some(0.1)), row("c", None)]),
        "name,x_m,own\n\"a,\"\"b\"\"\",0.1,1\nc,,1\n"
    );
}

#[test]
fn numbers_have_four_digits() {
    assert_eq!(digits(0.012345678), "0.01235");
    assert_eq!(digits(-123.456), "-123.5");
    assert_eq!(digits(54321.9), "54322");
    assert_eq!(digits(1.5e-9), "1.500e-9");
}
