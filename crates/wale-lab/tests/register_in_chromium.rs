//! The page of `wale register` in a real browser: yarns are laid over drawn photographs by its own calls and by mouse and keys,
//! and the tiles that it saves are read back.
//!
//! Without a Chromium the tests say so and pass; with `WALE_REQUIRE_CHROMIUM=1` they fail instead.

mod browser;
mod crossings;

use std::{f64::consts::TAU, sync::OnceLock};

use browser::{Visit, chromium_or_say_so, screenshot};
use crossings::{Crossing, assert_touching, closings, crossings};
use glam::{DVec2, DVec3};
use serde_json::Value;
use wale::{
    geometry::Curve,
    picture::{Camera, Image, Projection, Settings, Subject, View, render, write_png},
};
use wale_lab::{
    register::{Photograph, RegisterPage},
    yarn_tile::read_pattern,
};

const WALE: f64 = 1.2e-3;
const COURSE: f64 = 0.9e-3;
const RADIUS: f64 = 0.12e-3;
const SIZE: [usize; 2] = [840, 660];
/// Metres a pixel of the drawn photographs.
const SCALE: f64 = 4.0 * COURSE / SIZE[1] as f64;

/// A course of stockinette: where it is after the part `a` of a loop, from the middle of one sinker loop to the next.
fn stockinette(a: f64) -> DVec3 {
    let angle = a * TAU;
    DVec3::new(
        WALE * (a + 0.26 * (2.0 * angle).sin()),
        COURSE * (0.5 - 0.95 * angle.cos()),
        -1.2 * RADIUS * (2.0 * angle).cos(),
    )
}

/// A photograph of one side of a swatch of it, the middle of a loop in the middle.
fn photograph(view: View) -> Image {
    let course = |row: i32| {
        let mut curve = Curve { radius: RADIUS, color: [214, 200, 170], ..Curve::default() };
        for i in -5 * 48..=5 * 48 {
            let point = stockinette(f64::from(i) / 48.0) + DVec3::Y * COURSE * f64::from(row);
            let length = curve.points.last().map_or(0.0, |last: &DVec3| last.distance(point));
            curve.arc_length.push(curve.arc_length.last().unwrap_or(&0.0) + length);
            curve.points.push(point);
            curve.pass.push(0);
        }
        curve
    };
    let curves: Vec<Curve> = (-4..=4).map(course).collect();
    let (back, up) = view.directions();
    let camera = Camera {
        target: DVec3::new(0.5 * WALE, 0.5 * COURSE, 0.0),
        distance: 0.05,
        right: up.cross(back).normalize(),
        up: up.normalize(),
        back: back.normalize(),
        height: SIZE[1] as f64 * SCALE,
        projection: Projection::Orthographic,
    };
    let settings = Settings {
        width: SIZE[0],
        height: SIZE[1],
        samples: 2,
        background: [52, 48, 44],
        plies: 2,
        twist: 900.0,
        hair: 0.0,
        ground: None,
        ambient_rays: 1,
        scale_bar: false,
        ..Settings::default()
    };
    render(&Subject { curves: &curves, ..Subject::default() }, &camera, &settings)
}

fn stored(image: &Image) -> Photograph {
    let mut bytes = Vec::new();
    write_png(image, &mut bytes).expect("a picture");
    Photograph::new("drawn.png", bytes).expect("a photograph")
}

fn html(page: &RegisterPage) -> String {
    page.check().expect("lengths that make sense");
    let mut bytes = Vec::new();
    page.write_html(&mut bytes).expect("memory");
    String::from_utf8(bytes).expect("text")
}

/// The page of the stockinette, both sides photographed; drawn once.
fn swatch() -> &'static str {
    static PAGE: OnceLock<String> = OnceLock::new();
    PAGE.get_or_init(drawn_swatch)
}

fn drawn_swatch() -> String {
    let [front, back] = [View::Front, View::Back].map(|view| stored(&photograph(view)));
    html(&RegisterPage {
        name: "stockinette".into(),
        periods: [WALE, COURSE],
        radius: RADIUS,
        scale: Some(SCALE),
        front,
        back: Some(back),
        mirrored: true,
    })
}

/// A page with a grey photograph, for what needs none.
fn blank() -> String {
    html(&RegisterPage {
        name: "weave".into(),
        periods: [2.0e-3, 1.6e-3],
        radius: 0.2e-3,
        scale: None,
        front: stored(&Image::filled(400, 300, [120; 3])),
        back: None,
        mirrored: true,
    })
}

/// A script that lays one course of the stockinette, twelve points a loop, into the variable `r`.
fn lay_stockinette() -> String {
    let mut script = format!(
        "const r = window.register; r.setTile({{ origin_px: [{}, {}], along_px: [{}, 0], across_px: [0, {}] }}, false); const y = r.addYarn();\n",
        0.5 * (SIZE[0] as f64 - WALE / SCALE),
        0.5 * (SIZE[1] as f64 + COURSE / SCALE),
        WALE / SCALE,
        -COURSE / SCALE
    );
    for i in 0..12 {
        let at = stockinette(f64::from(i) / 12.0);
        // Legs lie in front, needle and sinker loops at the back; what is between is seen from neither side.
        let layer = ["back", "hidden", "front"][((at.z / RADIUS).clamp(-1.0, 1.0).round() + 1.0) as usize];
        script += &format!("r.addPoint(y, [{:e}, {:e}], \"{layer}\");\n", at.x, at.y);
    }
    script
}

fn text<'a>(value: &'a Value, key: &str) -> &'a str {
    value[key].as_str().unwrap_or_else(|| panic!("no text `{key}` in {value}"))
}

/// All texts of a list as one.
fn texts(value: &Value, key: &str) -> String {
    let list = value[key].as_array().unwrap_or_else(|| panic!("no list `{key}` in {value}"));
    list.iter().map(|item| item.as_str().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

#[test]
fn a_loop_of_stockinette_is_registered_and_read_back() {
    let Some(browser) = chromium_or_say_so("a_loop_of_stockinette_is_registered_and_read_back") else { return };
    let script = format!(
        "{}
        const open = r.faults();
        const closes = r.close(y);
        const pattern = r.exportPattern(), saved = r.save();
        r.removeYarn(y); r.load(saved);
        const again = r.exportPattern();
        r.undo(); const empty = r.work.yarns.length; r.undo(); r.redo(); r.redo();
        return {{ open, closes, pattern, again, empty, redone: r.exportPattern(), crossings: r.crossings(), remarks: r.remarks() }};",
        lay_stockinette()
    );
    let found = Visit::new(&browser, swatch()).run(&script);
    assert!(texts(&found, "open").contains("yarn 1 does not close"), "{found}");
    assert_eq!(found["closes"], serde_json::json!([1, 0]));
    assert_eq!(found["empty"], 0);
    assert!(found["crossings"].as_array().is_some_and(|c| c.len() == 4 && c.iter().all(|c| c["why"] == "marks")));
    for again in ["again", "redone"] {
        assert_eq!(text(&found, again), text(&found, "pattern"), "{again}");
    }

    let tile = read_pattern("stockinette.pyp", text(&found, "pattern")).expect("a pattern");
    assert!((tile.periods()[0] - WALE).abs() < 1e-12 && (tile.periods()[1] - COURSE).abs() < 1e-12);
    assert!((tile.radius() - RADIUS).abs() < 1e-15);
    assert_eq!((tile.yarn_count(), closings(&tile)), (1, vec![[1, 0]]));
    // Vertices lie evenly, one radius apart, within the tile.
    for length in tile.lengths() {
        assert!((length / RADIUS - 1.0).abs() < 0.05, "an edge of {} radii", length / RADIUS);
    }
    assert!(tile.vertices().iter().all(|v| (0.0..=WALE).contains(&v[0]) && (0.0..=COURSE).contains(&v[1])));
    let crossings = crossings(&tile);
    assert_eq!(crossings.len(), 4);
    assert_touching(&crossings, RADIUS);
    for crossing in &crossings {
        // Legs are steep, and lie over the needle and sinker loops that they cross.
        let steep = crossing.directions.map(|d| (d.y / d.x).abs());
        let over = usize::from(crossing.heights[1] > crossing.heights[0]);
        assert!(steep[over] > steep[1 - over], "{steep:?}, {over} is over");
    }
    // It lies where the photograph was drawn from, and comes to the right side of the fabric where it was marked so.
    for vertex in tile.vertices() {
        let images = (0..4000).flat_map(|i| {
            let at = stockinette(f64::from(i) / 4000.0);
            let wrapped = |x: f64, period: f64| x - period * (x / period).round();
            let off = DVec2::new(wrapped(vertex[0] - at.x, WALE), wrapped(vertex[1] - at.y, COURSE));
            [(off.length(), at.z)]
        });
        let (distance, _) = images.fold((f64::INFINITY, 0.0), |a, b| if b.0 < a.0 { b } else { a });
        assert!(distance < 0.1 * RADIUS, "{} radii beside the yarn", distance / RADIUS);
    }
    // At rest as it lies.
    let rest = tile.at_rest_as_it_lies();
    let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9 * (1.0 + b.abs()));
    let (kept, lies) = (tile.rest(), rest.rest());
    assert!(near(&kept.lengths, &lies.lengths) && near(&kept.curvatures, &lies.curvatures));
    assert_eq!(kept.torsions, lies.torsions);
}

#[test]
fn a_plain_weave_needs_orders_and_keeps_them() {
    let Some(browser) = chromium_or_say_so("a_plain_weave_needs_orders_and_keeps_them") else { return };
    let script = "
        const r = window.register, [w, h] = r.work.periods_m;
        for (let i = 0; i < 2; i++) {
          const y = r.addYarn({ name: `weft ${i + 1}` });
          for (let k = 0; k < 2; k++) r.addPoint(y, [(k + 0.5) * w / 2, (i + 0.5) * h / 2], 'hidden');
          r.close(y);
        }
        for (let i = 0; i < 2; i++) {
          const y = r.addYarn({ name: `warp ${i + 1}` });
          for (let k = 0; k < 2; k++) r.addPoint(y, [(i + 0.5) * w / 2, (k + 0.5) * h / 2], 'hidden');
          r.close(y, [0, 1]);
        }
        const closes = r.work.yarns.map(yarn => yarn.closes), orderless = r.faults();
        let refused = '';
        try { r.exportPattern(); } catch (error) { refused = error.message; }
        for (let y = 0; y < 2; y++) for (let k = 0; k < 2; k++) r.setLayer(y, k, (y + k) % 2 ? 'back' : 'front');
        const pattern = r.exportPattern(), orders = r.crossings().map(c => [c.yarns, c.over]);
        r.swap(0);
        const swapped = r.exportPattern(), saved = r.save(), layered = r.remarks();
        r.undo();
        const back = r.exportPattern();
        r.load(saved);
        const again = r.exportPattern();
        // The decision goes along with the crossing when a point is moved.
        r.movePoint(0, 0, [0.27 * w, 0.24 * h]);
        const moved = r.crossings().find(c => c.why === 'click');
        r.close(1, [0, 0]);
        const ring = r.faults();
        const wrong = ['', '{}', saved.replace('\"version\": 1', '\"version\": 2'), saved.replace('\"front\"', '\"above\"'), saved.replace('\"radius_m\": ', '\"radius_m\": -')]
          .map(text => { try { r.load(text); return 'taken'; } catch (error) { return error.message; } });
        return { closes, orderless, refused, pattern, orders, swapped, layered, back, again, moved, ring, wrong };";
    let found = Visit::new(&browser, &blank()).run(script);
    assert_eq!(found["closes"], serde_json::json!([[1, 0], [1, 0], [0, 1], [0, 1]]));
    let orderless = texts(&found, "orderless");
    assert_eq!(orderless.matches("without an order").count(), 4, "{orderless}");
    assert!(orderless.contains("weft 1 and warp 2 cross at (1.500, 0.400) mm"), "{orderless}");
    assert_eq!(text(&found, "refused"), orderless);
    assert!(texts(&found, "ring").contains("weft 2 closes on itself"), "{found}");
    let wrong = texts(&found, "wrong");
    assert_eq!(wrong.lines().filter(|line| line.contains("saved work")).count(), 5, "{wrong}");

    let tile = read_pattern("weave.pyp", text(&found, "pattern")).expect("a pattern");
    assert_eq!(closings(&tile), [[1, 0], [1, 0], [0, 1], [0, 1]]);
    let crossed = crossings(&tile);
    assert_eq!(crossed.len(), 4);
    assert_touching(&crossed, 0.2e-3);
    // Over and under in turn: a weft is over where the sum of column and row is even.
    let weft_over = |crossing: &Crossing| {
        let weft = usize::from(crossing.directions[0].x.abs() < crossing.directions[0].y.abs());
        crossing.heights[weft] > crossing.heights[1 - weft]
    };
    assert_eq!(crossed.iter().map(weft_over).collect::<Vec<_>>(), [true, false, false, true]);
    for order in found["orders"].as_array().expect("orders") {
        let [weft, warp] = [0, 1].map(|k| order[0][k].as_i64().expect("a yarn"));
        assert_eq!(order[1] == order[0][0], (weft + warp) % 2 == 0, "{order}");
    }
    let swapped = read_pattern("weave.pyp", text(&found, "swapped")).expect("a pattern");
    let crossed = crossings(&swapped);
    // That weft now lies below all: four layers that hold to nothing and need not bend, the outermost six radii apart.
    let gaps = crossed.iter().map(|c| (c.heights[0] - c.heights[1]).abs() / 0.2e-3);
    let mut gaps: Vec<f64> = gaps.collect();
    gaps.sort_by(f64::total_cmp);
    assert!(gaps.iter().zip([2.0, 2.0, 2.0, 6.0]).all(|(a, b)| (a - b).abs() < 1e-2), "{gaps:?}");
    assert!(texts(&found, "layered").contains("1 of 4 crossings are held farther apart"), "{found}");
    assert_eq!(crossed.iter().map(weft_over).collect::<Vec<_>>(), [false, false, false, true]);
    assert_eq!(text(&found, "back"), text(&found, "pattern"));
    assert_eq!(text(&found, "again"), text(&found, "swapped"));
    assert_eq!(found["moved"]["why"], "click");
    assert_eq!(found["moved"]["over"], 2);
}

#[test]
fn depths_are_the_smoothest_that_keep_yarns_apart() {
    let Some(browser) = chromium_or_say_so("depths_are_the_smoothest_that_keep_yarns_apart") else { return };
    // At the least, the slope of the energy is the crossings' pressures, which push where yarns touch and nowhere else.
    let script = "
        let seed = 7;
        const random = () => (seed = seed * 16807 % 2147483647) / 2147483647;
        const energy = (yarns, heights) => yarns.reduce((sum, steps, y) => sum + steps.reduce((part, _, i) => {
          const n = steps.length, b = (i + n - 1) % n, a = (i + 1) % n, mean = (steps[b] + steps[i]) / 2, z = heights[y];
          const turn = (z[a] - z[i]) / steps[i] - (z[i] - z[b]) / steps[b];
          return part + 0.5 * turn * turn / mean + 0.5 * TO_THE_MIDDLE * mean * z[i] * z[i];
        }, 0), 0);
        const at = ([yarn, edge, part], heights) => (1 - part) * heights[yarn][edge] + part * heights[yarn][(edge + 1) % heights[yarn].length];
        const trials = [];
        for (let trial = 0; trial < 20; trial++) {
          const yarns = Array.from({ length: 4 }, () => Array.from({ length: 12 + Math.floor(20 * random()) }, () => 0.6 + 0.8 * random()));
          const end = yarn => [yarn, Math.floor(random() * yarns[yarn].length), random()];
          const crossings = Array.from({ length: 10 }, (_, i) => ({ over: end(i % 4), under: end((i + 1 + i % 3) % 4) }));
          const { heights, gaps, pressures } = solveDepths(yarns, crossings);
          const way = yarns.map(steps => steps.map(() => random() - 0.5)), moved = by => heights.map((h, y) => Array.from(h, (z, i) => z + by * way[y][i]));
          const slope = (energy(yarns, moved(1e-4)) - energy(yarns, moved(-1e-4))) / 2e-4;
          const pressed = crossings.reduce((sum, c, i) => sum + pressures[i] * (at(c.over, way) - at(c.under, way)), 0);
          trials.push({ slope, pressed, gap: Math.min(...gaps), open: gaps.filter(g => g > 2.01).length, pull: Math.min(...pressures),
            idle: Math.max(...gaps.map((g, i) => Math.abs(g - 2) * pressures[i])), mean: heights.reduce((s, h) => s + h.reduce((t, z) => t + z, 0), 0) });
        }
        let torn = '';
        const ring = [1, 1, 1, 1, 1, 1], crossing = { over: [0, 2, 0.5], under: [1, 2, 0.5] };
        try { solveDepths([ring, ring], [crossing, { over: crossing.under, under: crossing.over }]); } catch (error) { torn = error.message; }
        return { trials, torn };";
    let found = Visit::new(&browser, &blank()).run(script);
    let mut open = 0.0;
    for trial in found["trials"].as_array().expect("trials") {
        let number = |key: &str| trial[key].as_f64().unwrap_or_else(|| panic!("no number `{key}` in {trial}"));
        let (slope, pressed) = (number("slope"), number("pressed"));
        assert!((slope - pressed).abs() < 1e-5 * (1.0 + pressed.abs()), "{trial}");
        assert!(number("gap") > 2.0 - 1e-5 && number("pull") >= 0.0 && number("idle") < 1e-5, "{trial}");
        assert!(number("mean").abs() < 1e-6, "{trial}");
        open += number("open");
    }
    assert!(open > 0.0, "no crossing is held open by others: the rule was not tried");
    assert!(text(&found, "torn").contains("contradict"), "{found}");
}

#[test]
fn mouse_and_keys_lay_a_yarn_that_is_seen_on_the_photograph() {
    let Some(browser) = chromium_or_say_so("mouse_and_keys_lay_a_yarn_that_is_seen_on_the_photograph") else { return };
    let page = swatch();
    let script = "
        const r = window.register, page = window.registerPage, canvas = document.getElementById('canvas');
        const screen = at => { const box = canvas.getBoundingClientRect(), [x, y] = page.painter.metres(r.work, at); return [x + box.left, y + box.top]; };
        const send = (type, [x, y], more) => canvas.dispatchEvent(new PointerEvent(type, { clientX: x, clientY: y, button: 0, bubbles: true, pointerId: 1, ...more }));
        canvas.setPointerCapture = () => {};
        const click = (at, more) => { send('pointerdown', screen(at), more); send('pointerup', screen(at), more); };
        const press = (key, more) => canvas.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true, cancelable: true, ...more }));
        const [w, h] = r.work.periods_m;
        click([0, 0.5 * h]); press('b'); click([0.5 * w, 0.6 * h]);
        click([w, 0.5 * h]);
        const closed = r.work.yarns[0], said = document.getElementById('said').textContent;
        click([0.25 * w, r.drawn().lines[0].places[12][1]], { shiftKey: true });
        const inserted = r.work.yarns[0].points.length;
        const from = screen([0, 0.5 * h]);
        send('pointerdown', from); send('pointermove', [from[0], from[1] + 20]); send('pointermove', [from[0], from[1] + 40]); send('pointerup', [from[0], from[1] + 40]);
        const dragged = page.painter.view.scale * r.work.tile.across_px[1] * (r.work.yarns[0].points[0].at[1] - 0.5);
        press('z', { ctrlKey: true });
        const undone = r.work.yarns[0].points[0].at[1];
        press('2');
        const corner = page.painter.part(r.work, [1, 0]), box = canvas.getBoundingClientRect();
        const place = [corner[0] + box.left, corner[1] + box.top], before = page.painter.part(r.work, r.work.yarns[0].points[0].at);
        send('pointerdown', place); send('pointermove', [place[0], place[1] - 15]); send('pointerup', [place[0], place[1] - 15]);
        const after = page.painter.part(r.work, r.work.yarns[0].points[0].at), { along_px: u, across_px: v } = r.work.tile;
        return { closed, said, inserted, dragged, undone, stayed: Math.hypot(after[0] - before[0], after[1] - before[1]),
          turned: u[1] / u[0], right: u[0] * v[0] + u[1] * v[1], length: Math.hypot(...u), state: document.body.dataset.state };";
    let found = Visit::new(&browser, page).run(script);
    assert_eq!(found["closed"]["closes"], serde_json::json!([1, 0]), "{found}");
    assert_eq!(found["closed"]["points"].as_array().map(Vec::len), Some(2), "{found}");
    assert_eq!(found["closed"]["points"][0]["layer"], "back", "a key marks the point that is chosen");
    assert_eq!(found["closed"]["points"][1]["layer"], "back", "and those that come after it");
    assert_eq!(found["inserted"], 3, "{found}");
    let number = |key: &str| found[key].as_f64().unwrap_or_else(|| panic!("no number `{key}` in {found}"));
    assert!((number("dragged") - 40.0).abs() < 1e-6 && (number("undone") - 0.5).abs() < 1e-6, "{found}");
    // The tile turned about its first corner, of the same size at the given scale; the yarn stayed on the photograph.
    assert!(number("turned") < -0.02 && number("right").abs() < 1e-6 && number("stayed") < 1e-6, "{found}");
    assert!((number("length") * SCALE / WALE - 1.0).abs() < 1e-9, "{found}");
    assert_eq!(found["state"], "ready");

    // Seen: red curves over the drawn yarns, and beside them the photograph as it was.
    let laid =
        format!("{} r.close(y); registerPage.look.style = 'bands'; registerPage.choose(0, null);", lay_stockinette());
    let shot = screenshot(&browser, page, &laid, [1180, 720], "register");
    let share = |test: &dyn Fn([u8; 3]) -> bool| {
        let pixels = shot.pixels.iter().filter(|p| test(**p)).count();
        pixels as f64 / shot.pixels.len() as f64
    };
    let over = |p: [u8; 3], a: usize, b: usize| i32::from(p[a]) - i32::from(p[b]);
    let red = share(&|p| over(p, 0, 1) > 90 && over(p, 0, 2) > 70);
    let wool = share(&|p| over(p, 0, 2) > 15 && over(p, 0, 1) < 40);
    assert!(red > 0.01 && wool > 0.1, "{red} of the page is red, {wool} of it the colour of the yarn");
}
