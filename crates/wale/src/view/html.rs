//! The page: viewer and numbers put together in one file.

use std::io::Write;

use glam::DVec3;
use serde_json::{Value, json};

use super::{
    ViewData, ViewError, ViewSettings,
    pack::{Packed, pack},
};
use crate::{
    geometry::{Solid, SolidShape},
    picture::color_map,
};

const PAGE: &str = include_str!("viewer.html");
const LIGHT: &str = include_str!("light.glsl");

/// Writes the page.
///
/// # Errors
/// If there is nothing to show, frames do not fit together, or the target cannot be written.
pub fn write_html(data: &ViewData, settings: &ViewSettings, mut target: impl Write) -> Result<(), ViewError> {
    let packed = pack(data, settings)?;
    let facts = facts(data, settings, &packed).to_string();
    // Within a script a closing tag would end it, even in a string.
    let facts = facts.replace('<', "\\u003c");
    let yarn = [LIGHT, include_str!("yarn.frag.glsl")].concat();
    let solid = [LIGHT, include_str!("solid.frag.glsl")].concat();
    let title = escaped(&data.title);
    let parts = [
        ("title", title.as_str()),
        ("facts", &facts),
        ("numbers", &packed.text),
        ("yarn.vert", include_str!("yarn.vert.glsl")),
        ("yarn.frag", &yarn),
        ("solid.vert", include_str!("solid.vert.glsl")),
        ("solid.frag", &solid),
        ("compose.vert", include_str!("compose.vert.glsl")),
        ("compose.frag", include_str!("compose.frag.glsl")),
        ("unpack.js", include_str!("unpack.js")),
        ("meshes.js", include_str!("meshes.js")),
        ("painter.js", include_str!("painter.js")),
        ("viewer.js", include_str!("viewer.js")),
    ];
    let mut rest = PAGE;
    while let Some((before, after)) = rest.split_once("{{") {
        let (name, after) = after.split_once("}}").unwrap_or((after, ""));
        let part = parts.iter().find(|(known, _)| *known == name);
        target.write_all(before.as_bytes())?;
        target.write_all(part.map_or("", |(_, text)| text).as_bytes())?;
        rest = after;
    }
    target.write_all(rest.as_bytes())?;
    Ok(target.flush()?)
}

/// Everything but the big numbers.
fn facts(data: &ViewData, settings: &ViewSettings, packed: &Packed) -> Value {
    // The page's own origin is the middle of the fabric: single precision is finest there.
    let middle = 0.5 * (packed.low + packed.high);
    let solids: Vec<DVec3> =
        packed.kept.iter().flat_map(|f| data.frames[*f].solids.iter().flat_map(Solid::extent_points)).collect();
    let low = solids.iter().fold(packed.low, |a, b| a.min(*b));
    let high = solids.iter().fold(packed.high, |a, b| a.max(*b));
    let radius = packed.yarns.iter().map(|y| y.radius).fold(0.0, f64::max);
    let size = high - low + 2.0 * radius;
    let mut start = vec![0];
    for yarn in &packed.yarns {
        start.push(start[start.len() - 1] + yarn.points);
    }
    let notice = match (packed.kept.len(), data.frames.len()) {
        (a, b) if a == b => String::new(),
        (a, b) => format!("{a} of {b} frames are shown, evenly chosen, to keep the page small."),
    };
    json!({
        "title": data.title,
        "notice": notice,
        "points": start[start.len() - 1],
        "start": start,
        "step": packed.step,
        "plies": data.plies,
        "twist": data.twist,
        "background": settings.background,
        "middle": triple(0.5 * (low + high) - middle),
        "size": triple(size),
        "extent": size.length(),
        "yarns": packed.yarns.iter().map(|y| json!({
            "first": y.first, "spacing": y.spacing, "radius": y.radius, "color": y.color,
        })).collect::<Vec<_>>(),
        "frames": packed.kept.iter().zip(&packed.origins).map(|(f, origin)| {
            let frame = &data.frames[*f];
            json!({
                "time": frame.time,
                "origin": triple(*origin - middle),
                "solids": frame.solids.iter().map(|s| solid_facts(s, middle)).collect::<Vec<_>>(),
            })
        }).collect::<Vec<_>>(),
        "quantities": packed.quantities.iter().map(|(quantity, range)| {
            let (unit, scale) = quantity.legend_unit();
            json!({
                "name": quantity.name(),
                "unit": unit,
                "range": range.map(|v| v * scale),
                "map": color_map(*quantity).table(256),
            })
        }).collect::<Vec<_>>(),
    })
}

fn solid_facts(solid: &Solid, middle: DVec3) -> Value {
    let mut facts = match solid.shape {
        SolidShape::Plane => json!({"shape": "plane"}),
        SolidShape::Sphere { radius } => json!({"shape": "sphere", "radius": radius}),
        SolidShape::Capsule { radius, half_length } => {
            json!({"shape": "capsule", "radius": radius, "half_length": half_length})
        }
        SolidShape::Box { half_extents } => json!({"shape": "box", "half_extents": triple(half_extents)}),
    };
    facts["rotation"] = json!(solid.rotation.to_array());
    facts["position"] = json!(triple(solid.position - middle));
    facts["color"] = json!(solid.color);
    facts
}

fn triple(v: DVec3) -> [f64; 3] {
    v.to_array()
}

/// Text as it may stand in HTML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::pack::tests::waving;

    fn page(data: &ViewData) -> String {
        let mut bytes = Vec::new();
        write_html(data, &ViewSettings::default(), &mut bytes).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn the_page_is_whole_and_asks_nothing_of_the_net() {
        let page = page(&waving(3));
        assert!(page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>"));
        for left in ["{{", "src=", "href=", "http://", "https://", "@import"] {
            assert!(!page.contains(left), "{left}");
        }
        for held in ["class Painter", "uniform usampler2D uPoints", "gl_FragDepth", "\"stretch\""] {
            assert!(page.contains(held), "{held}");
        }
    }

    #[test]
    fn a_title_cannot_become_markup() {
        let mut data = waving(1);
        data.title = "</script><script>alert(1)</script> <!-- & {{facts}}".to_owned();
        let page = page(&data);
        assert!(!page.contains("<script>alert"));
        assert!(page.contains("&lt;/script&gt;"));
        assert_eq!(page.matches("</script>").count(), 9);
    }
}
