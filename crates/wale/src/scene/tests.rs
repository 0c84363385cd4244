//! Good scenes read, bad ones say what is wrong and where, and what is written reads back.

mod cards;
mod refusals;
mod together;
mod weaves;

use super::*;
use crate::model::{Drive, Edge, Selection, Shape};
use crate::pattern::{Chart, Side, Structure, Working};
use glam::DVec3;
use miette::Diagnostic;
use proptest::prelude::*;

const CHART: &str = "[fabric.chart]\npattern = \"garter\"\ncolumns = 6\nrows = 4\n";

fn chart_of(scene: &Scene) -> &Chart {
    scene.structure.chart().unwrap()
}

fn working_of(scene: &Scene) -> Working {
    match scene.structure {
        Structure::Chart { working, .. } => working,
        _ => panic!("no chart"),
    }
}

fn read(rest: &str) -> Scene {
    Scene::from_text(&format!("schema = 1\n{rest}"), "scene.toml").unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn five_lines_are_a_scene() {
    let scene = read(CHART);
    assert_eq!(scene.structure.size(), [4, 6]);
    assert_eq!(working_of(&scene), Working::default());
    assert_eq!(scene.yarns.first().linear_density, 500e-6);
    // The fabric card follows from yarn and loop length in the default proportions.
    let proportions = crate::model::LoopProportions::default();
    let card = scene.fabric.knit().unwrap();
    let wrap = card.wrapping_stiffness * card.stitch_length * card.loop_length / scene.yarns.first().bending_stiffness;
    assert!((wrap - proportions.wrapping).abs() < 1e-12);
    assert!((card.loop_length - proportions.path_ratio * 0.02).abs() < 1e-15);
    assert_eq!(scene.plan.simulation.gravity, DVec3::new(0.0, 0.0, -9.80665));
}

#[test]
fn the_template_is_a_scene_and_says_the_defaults_in_its_comments() {
    let scene = Scene::from_text(template(), "new.toml").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(scene.plan.obstacles.len(), 1);
    // Every key that is commented out must be one that exists: with all of them in place of the others it still reads.
    let opened: String = template()
        .lines()
        .filter(|line| !line.starts_with("pattern ="))
        .map(|line| {
            let key = line.strip_prefix("# ").filter(|rest| {
                let code = rest.starts_with([' ', ']', '[']) || rest.contains(" = ");
                code && !rest.contains("file = ") && !rest.starts_with("worked")
            });
            format!("{}\n", key.unwrap_or(line))
        })
        .collect();
    Scene::from_text(&opened, "opened.toml").unwrap_or_else(|error| panic!("{error}\n{opened}"));
}

#[test]
fn a_yarn_of_ones_own_goes_before_the_preset() {
    let scene = read(&format!("[yarn]\npreset = \"thick-acrylic\"\npacking = 0.5\nfibre_density = 1180\n{CHART}"));
    let area = std::f64::consts::PI * scene.yarns.first().radius * scene.yarns.first().radius;
    assert!((scene.yarns.first().linear_density / area - 590.0).abs() < 1e-9, "packing replaces the preset's diameter");
    let scene =
        read(&format!("[yarn]\ndiameter = \"1 mm\"\nelastic_modulus = \"10 MPa\"\nbending_modulus = 1e-3\n{CHART}"));
    assert!((scene.yarns.first().stretch_stiffness - 7.853_981_633_974_483).abs() < 1e-12);
    assert!((scene.yarns.first().bending_stiffness - 7.853_981_633_974_483e-10).abs() < 1e-22);
}

#[test]
fn the_papers_table_is_taken_in_true_units() {
    let table = "[fabric.paper_table_1]\nloop_width = \"3 mm\"\nR = \"0.75 mm\"\nY = 1e7\nB = 1e-3\nk_w = 1e-2\n";
    let scene = read(&format!("{table}mu = 0.3\nalpha = 10\nbeta = 0.01\n{CHART}"));
    assert!((scene.yarns.first().stretch_stiffness - 17.67).abs() < 0.01);
    assert!((scene.yarns.first().bending_stiffness - 1.767e-9).abs() < 1e-12);
    assert_eq!(scene.fabric.knit().unwrap().wrapping_stiffness, 1e-2);
    assert_eq!(scene.fabric.knit().unwrap().wale_spacing, 3e-3);
    assert_eq!((scene.yarns.first().mass_damping, scene.yarns.first().stiffness_damping), (10.0, 0.01));
}

#[test]
fn stitch_size_may_stand_in_place_of_the_loop_length() {
    let scene = read(&format!("[fabric]\nwale_spacing = \"5 mm\"\n{CHART}"));
    let proportions = crate::model::LoopProportions::default();
    assert!((scene.fabric.knit().unwrap().loop_length - 5e-3 / proportions.wale_spacing).abs() < 1e-15);
    assert_eq!(scene.fabric.knit().unwrap().wale_spacing, 5e-3);
}

#[test]
fn charts_come_from_symbols_with_a_legend_and_repeat() {
    let scene = read(
        "[fabric.chart]\nsymbols = [\"ox\", \"xx\"]\nlegend = { x = \"knit\", o = \"purl\" }\ncolumns = 3\nworked = \"round\"\n",
    );
    assert_eq!(format!("{:?}", chart_of(&scene)), "\npkp\nkkk");
    assert_eq!(working_of(&scene), Working::Round);
    let scene = read(&format!("{CHART}first_row = \"wrong_side\"\n"));
    assert_eq!(working_of(&scene), Working::Flat { first_row: Side::WrongSide });
}

#[test]
fn stitches_have_the_yarn_and_the_yarns_their_colour() {
    let yarns = "[yarns.B]\ncolor = \"#ffffff\"\n";
    let chart = "[fabric.chart]\npattern = \"stockinette\"\ncolumns = 4\nrows = 4\n";
    let scene = read(&format!("[yarn]\ncolor = \"#102030\"\n{yarns}{chart}stripes = [\"A\", \"B\"]\n"));
    assert_eq!([0, 1, 2, 3].map(|row| chart_of(&scene).yarn(row, 2)), [0, 1, 0, 1]);
    assert_eq!(scene.yarn_colors, [[0x10, 0x20, 0x30], [255; 3]]);
    // The last row comes first, and the grid repeats.
    let scene = read(&format!("{yarns}{chart}yarns = [\"BBA\", \"ABA\"]\n"));
    assert_eq!([0, 1, 2, 3].map(|at| chart_of(&scene).yarn(0, at)), [0, 1, 0, 0]);
    assert_eq!([0, 1, 2, 3].map(|at| chart_of(&scene).yarn(3, at)), [1, 1, 0, 1]);
    let mut network = scene.structure.network(&scene.fabric);
    scene.color_yarns(&mut network);
    assert!(network.yarn_color.contains(&[255; 3]) && network.yarn_color.contains(&scene.yarn_colors[0]));
}

#[test]
fn an_image_is_a_chart_of_stitches_or_of_yarns() {
    let folder = tempfile::tempdir().unwrap();
    let image = crate::picture::Image { width: 2, height: 2, pixels: vec![[255; 3], [0; 3], [255; 3], [255; 3]] };
    crate::picture::write_png(&image, std::fs::File::create(folder.path().join("chart.png")).unwrap()).unwrap();
    let scene_with = |chart: &str| {
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, format!("schema = 1\n[fabric.chart]\nimage = \"chart.png\"\n{chart}\n")).unwrap();
        Scene::read_with_inputs(&path)
    };
    let read = scene_with("palette = { \"#ffffff\" = \"k\", \"#000000\" = \"p\" }\ncolumns = 4").unwrap();
    assert_eq!(format!("{:?}", chart_of(&read.scene)), "\nkpkp\nkkkk");
    assert_eq!(read.inputs.len(), 2);
    let read = scene_with("palette = { \"#ffffff\" = \"A\", \"#000000\" = \"B\" }").unwrap();
    assert_eq!(format!("{:?}", chart_of(&read.scene)), "\nkk\nkk");
    assert_eq!((chart_of(&read.scene).yarn(1, 1), chart_of(&read.scene).yarn(0, 1)), (1, 0));
    let read = scene_with(
        "pattern = \"garter\"\ncolumns = 3\nrows = 2\npalette = { \"#ffffff\" = \"A\", \"#000000\" = \"B\" }",
    );
    assert_eq!(format!("{:?}", chart_of(&read.unwrap().scene)), "\nppp\nkkk");
    let error = scene_with("palette = { \"#ffffff\" = \"A\" }").unwrap_err().to_string();
    assert!(error.contains("the pixel 2 from the left, 1 from the top is #000000"), "{error}");
}

#[test]
fn a_machines_program_is_a_fabric() {
    let folder = tempfile::tempdir().unwrap();
    let program =
        ";!knitout-2\n;;Carriers: 1 2\nin 1\ntuck - f2 1\ntuck - f1 1\nin 2\nknit + f1 2\nknit + f2 2\nout 1\nout 2\n";
    std::fs::write(folder.path().join("two.k"), program).unwrap();
    let scene_with = |chart: &str| {
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, format!("schema = 1\n[yarns.2]\ncolor = \"#ffffff\"\n[fabric.chart]\n{chart}\n"))
            .unwrap();
        Scene::read_with_inputs(&path)
    };
    let read = scene_with("file = \"two.k\"").unwrap();
    assert_eq!((read.scene.structure.size(), read.scene.structure.yarn_count(), read.inputs.len()), ([2, 2], 2, 2));
    assert_eq!(read.scene.yarn_colors[1], [255; 3]);
    assert_eq!(resolved_again(&read.scene), read.scene, "the program goes along");
    let error = scene_with("file = \"two.k\"\ncolumns = 3").unwrap_err().to_string();
    assert!(error.contains("columns beside a program"), "{error}");
    let image = crate::picture::Image { width: 1, height: 1, pixels: vec![[255; 3]] };
    crate::picture::write_png(&image, std::fs::File::create(folder.path().join("one.png")).unwrap()).unwrap();
    let beside = "file = \"two.k\"\nimage = \"one.png\"\npalette = { \"#ffffff\" = \"A\" }";
    let error = scene_with(beside).unwrap_err().to_string();
    assert!(error.contains("image beside a program"), "{error}");
    std::fs::write(folder.path().join("two.k"), program.replace("in 2\n", "")).unwrap();
    let error = scene_with("file = \"two.k\"").unwrap_err();
    assert!(error.to_string().contains("line 6: carrier 2 makes a loop but was not brought in"), "{error}");
    assert!(error.to_string().contains("two.k"), "{error}");
}

#[test]
fn what_happens_is_read_to_motions() {
    let scene = read(&format!(
        "{CHART}[simulation]\nduration = 2\n\
         [[obstacle]]\nbox = {{ center = [0, 0, 0], size = [2, 4, 6] }}\n\
         motion = {{ turn = {{ axis = [0, 0, 2], rate = \"90 deg/s\" }} }}\n\
         [[grip]]\nselect = {{ edge = \"left\" }}\n\
         [[grip]]\nselect = {{ rows = [2, 3], columns = [1, 1] }}\naxes = \"xz\"\nfrom = 0.5\n\
         motion = {{ velocity = [\"20 mm/s\", 0, 0], until = 1.5 }}\n\
         [[grip]]\nselect = {{ corner = \"top_right\" }}\npull = {{ force = [0, \"5 cN\", 0], ramp = 0.1 }}\nuntil = 1\n"
    ));
    let obstacle = &scene.plan.obstacles[0];
    assert!(matches!(obstacle.shape, Shape::Block { half_size, .. } if half_size == DVec3::new(1.0, 2.0, 3.0)));
    assert!((obstacle.motion.keys[1].rotation - DVec3::Z * std::f64::consts::PI).length() < 1e-14);
    assert_eq!(scene.plan.grips[0].nodes, Selection::Edge { edge: Edge::Left, depth: 1 });
    assert_eq!(scene.plan.grips[1].nodes, Selection::Loops { rows: Some(1..3), columns: Some(0..1) });
    assert_eq!(scene.plan.grips[1].axes, [true, false, true]);
    let Drive::Follow(motion) = &scene.plan.grips[1].drive else { panic!("follows a motion") };
    assert_eq!((motion.keys[0].time, motion.keys[1].time), (0.5, 1.5));
    assert!((motion.keys[1].translation.x - 0.02).abs() < 1e-15);
    assert!(scene.plan.grips[2].holds(0.9) && !scene.plan.grips[2].holds(1.0));
}

/// The scene, what is underlined, a part of what is said, a part of the mend, and the class.
type Bad = (&'static str, &'static str, &'static str, &'static str, ErrorClass);

#[test]
fn chart_files_are_read_from_the_scenes_folder_only() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("scenes");
    std::fs::create_dir(&inner).unwrap();
    let scene_with = |chart: &str| {
        let path = inner.join("scene.toml");
        std::fs::write(&path, format!("schema = 1\n[fabric.chart]\n{chart}\n")).unwrap();
        Scene::read_with_inputs(&path)
    };
    std::fs::write(inner.join("rib.knit"), "Cast on 4\nRnd 1: *k1, p1*\n").unwrap();
    let read = scene_with("file = \"rib.knit\"\nrows = 3").unwrap();
    assert_eq!(format!("{:?}", chart_of(&read.scene)), "\npkpk\npkpk\npkpk");
    assert_eq!(working_of(&read.scene), Working::Round);
    assert_eq!(read.inputs.len(), 2);

    std::fs::write(inner.join("bad.knit"), "Cast on 5\n# a rib\nRow 1: k1, *k1, p1, k1*\n").unwrap();
    let error = scene_with("file = \"bad.knit\"").unwrap_err();
    assert!(error.file().ends_with("bad.knit"));
    assert_eq!(error.line_and_column(), Some((3, 12)));
    assert_eq!(error.underlined(), Some("*k1, p1, k1*"));
    assert!(error.what().contains("repeats 3 stitches, but 4 of the 5"), "{error}");

    for (chart, what) in [
        ("file = \"none.knit\"", "cannot be read"),
        ("file = \".\"", "is no file"),
        ("file = \"rib.knit\"\ncolumns = 6", "casts on 4"),
        ("file = \"rib.knit\"\nworked = \"flat\"", "in the round"),
        ("file = \"rib.knit\"\nfirst_row = \"wrong_side\"", "which side"),
    ] {
        let error = scene_with(chart).unwrap_err();
        assert!(error.what().contains(what), "{chart}: {error}");
        assert_eq!(error.class(), ErrorClass::BadInput);
    }
    std::fs::write(inner.join("odd.knit"), "Cast on 4\nRow 1: k\n").unwrap();
    assert!(scene_with("file = \"odd.knit\"\nrows = 3").unwrap_err().what().contains("repeated flat"));
    std::fs::write(inner.join("bytes.knit"), [0xff, 0xfe]).unwrap();
    assert!(scene_with("file = \"bytes.knit\"").unwrap_err().what().contains("UTF-8"));
    #[cfg(unix)]
    {
        std::fs::write(folder.path().join("secret.knit"), "Cast on 4\nRow 1: k\n").unwrap();
        std::os::unix::fs::symlink("../secret.knit", inner.join("link.knit")).unwrap();
        assert!(scene_with("file = \"link.knit\"").unwrap_err().what().contains("leads out"));
    }
    let missing = Scene::read(&inner.join("missing.toml")).unwrap_err();
    assert_eq!((missing.class(), missing.class().exit_code()), (ErrorClass::BadInput, 3));
    assert!(Scene::read(&inner).is_err(), "a folder is no scene");
}

#[test]
fn the_schema_describes_every_table() {
    let schema = json_schema();
    let text = schema.to_string();
    for word in ["paper_table_1", "frame_rate", "Coefficient of friction between yarns", "cast-on", "anyOf"] {
        assert!(text.contains(word), "{word}");
    }
    assert_eq!(schema["additionalProperties"], false);
    assert_eq!(schema["required"], serde_json::json!(["schema", "fabric"]));
}

fn resolved_again(scene: &Scene) -> Scene {
    let text = scene.resolved_toml().unwrap();
    Scene::from_text(&text, "resolved.toml").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

#[test]
fn resolved_scenes_of_every_kind_read_back_the_same() {
    for text in [
        template().to_owned(),
        "schema = 1\n[fabric.chart]\nsymbols = [\"#kk#\", \"#/k#\", \"x/\", \"kkkk\"]\nlegend = { k = \"k\", x = \"(k, yo, p) in 1 st\", \"/\" = \"cdd\" }\n".to_owned(),
        "schema = 1\n[yarn]\ncolor = \"#101010\"\n[yarns.B]\ncolor = \"#ffffff\"\n[fabric.chart]\npattern = \"garter\"\ncolumns = 6\nrows = 8\nstripes = [\"A\", \"A\", \"B\", \"B\"]\n".to_owned(),
        "schema = 1\n[yarns.2]\ncolor = \"#ffffff\"\n[fabric.chart]\npattern = \"stockinette\"\ncolumns = 6\nrows = 8\nyarns = [\"121\", \"112\"]\n".to_owned(),
        format!("schema = 1\n[fabric]\nstance = \"hanging\"\ncenter = [0.1, \"2 mm\", 3]\n{CHART}worked = \"round\"\n"),
        format!(
            "schema = 1\ntitle = \"a \\\"title\\\"\"\n{CHART}[output]\nexports = [\"vtk\", \"usd\", \"vtk\"]\n\
             [[obstacle]]\nplane = {{ point = [0, 0, 0], normal = [1, 2, 3] }}\n\
             [[obstacle]]\ncapsule = {{ a = [0, 0, 0], b = [1, 0, 0], radius = \"1 in\" }}\n\
             motion = {{ velocity = [0.1, 0, 0], turn = {{ axis = [1, 1, 0], rate = \"7 rpm\" }}, from = 0.1 }}\n\
             [[obstacle]]\nbox = {{ center = [0, 0, 0], size = [1, 2, 0.3], rotation = {{ axis = [1, 2, 3], angle = \"33 deg\" }} }}\n\
             [[grip]]\nselect = {{ corner = \"bottom_left\", depth = 2 }}\naxes = \"y\"\nuntil = 0.7\n\
             [[grip]]\nselect = {{ region = {{ low = [0, 0, 0], high = [1, 1, 1] }} }}\npull = {{ force = [1, 0, 0] }}\n\
             [[grip]]\nselect = {{ columns = [2, 3] }}\nmotion = {{ keys = [{{ time = 0.3, translation = [1, 0, 0] }}] }}\n\
             [[grip]]\nselect = {{ all = true }}\n"
        ),
    ] {
        let scene = Scene::from_text(&text, "scene.toml").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(resolved_again(&scene), scene);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn resolved_numbers_read_back_to_the_same_bits(
        loop_length in 3e-3..1.0_f64,
        spacing in 1e-3..1e-2_f64,
        angle in -3.1..3.1_f64,
        axis in prop::array::uniform3(-1.0..1.0_f64),
        center in prop::array::uniform3(-10.0..10.0_f64),
        gravity in prop::array::uniform3(-10.0..10.0_f64),
        tex in 50.0..2000.0_f64,
        knits in prop::collection::vec(any::<bool>(), 12),
        seed in any::<u32>(),
    ) {
        prop_assume!(DVec3::from_array(axis).length() > 1e-3);
        let row: String = knits.iter().map(|knit| if *knit { 'k' } else { 'p' }).collect();
        let text = format!(
            "schema = 1\n[yarn]\nlinear_density = \"{tex} tex\"\n\
             [fabric]\nloop_length = {loop_length}\nwale_spacing = {spacing}\nwrapping_angle_leg = {angle}\n\
             center = {center:?}\nrotation = {{ axis = {axis:?}, angle = {angle} }}\n\
             [fabric.chart]\nsymbols = [\"{}\", \"{}\", \"{}\"]\n\
             [simulation]\ngravity = {gravity:?}\nseed = {seed}\n\
             [[obstacle]]\nplane = {{ point = {center:?}, normal = {axis:?} }}\n\
             motion = {{ velocity = {gravity:?}, turn = {{ axis = {axis:?}, rate = {angle} }} }}\n",
            &row[..4], &row[4..8], &row[8..]
        );
        match Scene::from_text(&text, "scene.toml") {
            Ok(scene) => prop_assert_eq!(resolved_again(&scene), scene),
            // Short loops of thick yarn are refused.
            Err(error) => prop_assert!(error.what().contains("thick") || error.what().contains("leave too little"), "{}", error),
        }
    }

    #[test]
    fn any_text_is_read_or_refused(text in ".{0,300}") {
        let _ = Scene::from_text(&text, "scene.toml");
    }

    #[test]
    fn spoilt_scenes_are_read_or_refused(at in 0_usize..4000, length in 0_usize..20, with in ".{0,6}") {
        let text = template();
        let start = (0..=at.min(text.len())).rev().find(|&i| text.is_char_boundary(i)).unwrap_or(0);
        let end = (start + length..=text.len()).find(|&i| text.is_char_boundary(i)).unwrap_or(text.len());
        let spoilt = format!("{}{with}{}", &text[..start], &text[end..]);
        if let Err(error) = Scene::from_text(&spoilt, "scene.toml") {
            prop_assert!(!error.what().is_empty());
            let drawn = format!("{:?}", miette::Report::new(error));
            prop_assert!(drawn.contains("scene.toml"), "{}", drawn);
        }
    }
}
