//! Elements that are seen, and those that nobody sees.

use super::{SEEN, assert_length, drawing, refusal};

#[test]
fn what_nobody_sees_is_not_drawn() {
    let line = r##"<path d="M10 20H90" stroke="#f00"/>"##;
    for unseen in [
        format!(r##"<g opacity="0">{line}</g>"##),
        format!(r##"<g style="opacity:0%">{line}</g>"##),
        format!(r##"<g opacity=".05"><g opacity=".02">{line}</g></g>"##),
        r##"<path d="M10 20H90" stroke="#f00" opacity="0.0"/>"##.into(),
        r##"<path d="M10 30H90" stroke="#f00" stroke-opacity="0"/>"##.into(),
        r##"<rect x="5" y="5" width="90" height="90" fill-opacity="0"/>"##.into(),
        r##"<rect x="5" y="5" width="90" height="90" fill="red" style="fill-opacity:0%;stroke:blue;stroke-opacity:0"/>"##.into(),
        r##"<path d="M10 40H90" stroke="transparent"/>"##.into(),
        r##"<path d="M10 40H90" stroke="rgba(255,0,0,0)"/>"##.into(),
        r##"<path d="M10 40H90" stroke="rgb(255 0 0 / 0%)"/>"##.into(),
        r##"<path d="M10 40H90" stroke="#f000"/>"##.into(),
        r##"<path d="M10 40H90" stroke="#ff000000"/>"##.into(),
        r##"<path d="M10 40H90" stroke="hsla(120, 50%, 50%, 0)"/>"##.into(),
        r##"<path d="M10 40H90" stroke="currentColor" color="transparent"/>"##.into(),
        r##"<path d="M10 40H90" stroke="red" stroke-width="0"/>"##.into(),
        r##"<path d="M10 40H90 V50 H10z" fill="none"/>"##.into(),
        // A line without a stroke has no area.
        r##"<path d="M10 40H90"/><line x2="50" y2="50"/><polyline points="1 1 20 20"/>"##.into(),
        r##"<g style="visibility:hidden"><rect width="9" height="9"/></g>"##.into(),
        r##"<g display="none"><rect width="9" height="9"/></g>"##.into(),
        r##"<style>.off{display:none}</style><rect class="off" width="9" height="9"/>"##.into(),
        r##"<linearGradient id="g"><stop stop-opacity="0"/><stop offset="1" stop-opacity="0"/></linearGradient><rect width="50" height="50" fill="url(#g)"/>"##.into(),
        r##"<linearGradient id="g"/><rect width="50" height="50" fill="url(#g)"/>"##.into(),
        r##"<rect width="50" height="50" fill="url(#none)"/>"##.into(),
        r##"<rect width="0" height="50"/><circle r="0"/><ellipse rx="5"  ry="0"/>"##.into(),
        r##"<g transform="scale(0)"><rect width="5" height="5"/></g>"##.into(),
        r##"<clipPath id="c"/><g clip-path="url(#c)"><rect width="5" height="5"/></g>"##.into(),
        r##"<clipPath id="c"><rect x="50" y="50" width="5" height="5"/></clipPath><rect clip-path="url(#c)" width="5" height="5"/>"##.into(),
        r##"<switch><g systemLanguage="de"><rect width="9" height="9"/></g></switch>"##.into(),
        r##"<symbol id="s"><rect width="5" height="5"/></symbol>"##.into(),
        r##"<defs><rect width="5" height="5"/></defs><pattern id="p"><rect width="5" height="5"/></pattern>"##.into(),
    ] {
        assert_length(&format!("{SEEN}{unseen}"), 80.0);
    }
    // A child of what is hidden may be seen.
    assert_length(
        &format!(
            r##"{SEEN}<g visibility="hidden"><path visibility="visible" d="M0 0H9" stroke="red"/></g>"##
        ),
        89.0,
    );
    assert!(
        refusal(r##"<rect width="5" height="5" opacity="0"/>"##)
            .reason
            .contains("nothing in the file is drawn")
    );
}

#[test]
fn paints_of_every_kind_are_known_by_their_colour_or_refused() {
    for (paint, colour) in [
        ("rgb(255 0 0 / 100%)", Some([255, 0, 0])),
        ("rgb(255 0 0)", Some([255, 0, 0])),
        ("rgb(100%, 0%, 50%)", Some([255, 0, 128])),
        ("RGBA(0,128,0,.5)", Some([0, 128, 0])),
        ("#F00F", Some([255, 0, 0])),
        ("Red", Some([255, 0, 0])),
        ("hsl(120deg 100% 50%)", Some([0, 255, 0])),
        ("hwb(240 0% 0%)", Some([0, 0, 255])),
        ("oklch(62.8% 0.2577 29.23)", Some([255, 0, 0])),
        ("lab(54.29% 80.8 69.89)", Some([255, 0, 0])),
        ("color(srgb 0 0 1)", Some([0, 0, 255])),
        ("color(display-p3 0 0 0)", Some([0, 0, 0])),
        ("var(--c, #f00)", Some([255, 0, 0])),
        ("var(--blue)", Some([0, 0, 255])),
        ("var(--none, var(--blue))", Some([0, 0, 255])),
        (
            "#CD853F icc-color(acmecmyk, 0.11, 0.48, 0.83, 0.00)",
            Some([0xCD, 0x85, 0x3F]),
        ),
        ("url(#none) #00f", Some([0, 0, 255])),
        ("url(#some)", None),
        ("url('#some') red", None),
        ("currentColor", Some([1, 2, 3])),
    ] {
        let found = drawing(&format!(
            r##"<style>:root{{--blue:#00f}}</style><linearGradient id="some"><stop/></linearGradient><path d="M10 40L90 50" color="#010203" style="stroke:{paint}"/>"##
        ));
        assert_eq!(found.strokes[0].colour, colour, "{paint}");
    }
    for (content, line, word) in [
        (
            "<g>\n<path id='a' d='M0 0H9' stroke='color-mix(in srgb, red, blue)'/></g>",
            2,
            "path#a",
        ),
        ("<rect width='9' height='9' fill='reddish'/>", 1, "rect"),
        (
            "\n\n<g id='b' style='stroke:light-dark(red, blue)'><path d='M0 0H9'/></g>",
            3,
            "g#b",
        ),
        ("<path d='M0 0H9' stroke='url(other.svg#a)'/>", 1, "path"),
    ] {
        let fault = refusal(content);
        assert_eq!(
            (fault.line, fault.word.as_str()),
            (line, word),
            "{content}: {fault}"
        );
        assert!(fault.reason.contains("not known"), "{fault}");
    }
}

#[test]
fn text_and_images_that_nobody_sees_are_no_text_and_no_images() {
    for unseen in [
        "<g style='display:none'><text x='1' y='1'>n</text></g>",
        "<text x='1' y='1'> \n </text>",
        "<text><tspan/></text>",
        "<text opacity='0'>A</text>",
        "<text fill='none'>A</text>",
        "<text visibility='hidden'>A</text>",
        "<text><tspan style='display:none'>A</tspan></text>",
        "<text font-size='0'>A</text>",
        "<g visibility='hidden'><image href='a.png' width='9' height='9'/></g>",
        "<image width='9' height='9'/>",
        "<image href='a.png' width='0' height='9'/>",
        "<foreignObject width='9' height='9'>  </foreignObject>",
        "<switch><foreignObject requiredExtensions='http://ns.adobe.com/AdobeIllustrator/10.0/' width='9' height='9'><a>x</a></foreignObject><g/></switch>",
        "<metadata><text>A</text></metadata><title>A</title><desc>B</desc>",
        "<x xmlns='http://other'><text xmlns='http://www.w3.org/2000/svg'>A</text></x>",
    ] {
        assert_length(&format!("{SEEN}{unseen}"), 80.0);
    }
    for (seen, word) in [
        ("<text id='t'>A</text>", "text#t"),
        ("<text> <tspan>A</tspan></text>", "text"),
        (
            "<text fill='none'><tspan fill='red'>A</tspan></text>",
            "text",
        ),
        ("<image href='a.png'/>", "image"),
        (
            "<image xlink:href='data:image/png;base64,AAAA' width='5' height='5'/>",
            "image",
        ),
    ] {
        assert_eq!(refusal(&format!("{SEEN}{seen}")).word, word, "{seen}");
    }
}

#[test]
fn a_white_page_is_remarked() {
    for (content, lines) in [
        (
            r##"<rect width="100%" height="100%" fill="white"/>"##,
            vec![1],
        ),
        ("\n<path id='p' d='M0 0h100v100H0z' fill='#fff'/>", vec![2]),
        (
            r##"<rect x="-9" y="-9" width="200" height="200" style="fill:rgb(255 255 255)"/>"##,
            vec![1],
        ),
        (
            r##"<rect width="100%" height="100%" fill="white" stroke="black"/>"##,
            vec![],
        ),
        (r##"<rect width="100%" height="100%" fill="red"/>"##, vec![]),
        (
            r##"<rect width="100%" height="50%" fill="white"/>"##,
            vec![],
        ),
    ] {
        let found = drawing(content);
        let told: Vec<u32> = found.remarks.iter().map(|remark| remark.line).collect();
        assert_eq!(told, lines, "{content}");
    }
}
