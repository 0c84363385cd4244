//! Woven fabrics as scenes say them.

use super::*;
use crate::model::WhichEnd;
use crate::pattern::weave::{Draft, Selvedge};

const YARN: &str = "[yarn]\nlinear_density = \"20 tex\"\ndiameter = \"0.2 mm\"\n";

#[test]
fn a_weave_is_a_scene_and_reads_back() {
    let scene = read(&format!(
        "{YARN}[yarns.weft]\nlinear_density = \"40 tex\"\ndiameter = \"0.3 mm\"\ncolor = \"#204060\"\n\
         [fabric.weave]\npattern = \"twill 2/1\"\nends = 10\npicks = 8\nend_count = \"20 /cm\"\npick_spacing = \"0.6 mm\"\n\
         weft = [\"weft\", \"weft\", \"warp\"]\nselvedge = \"cut\"\nwarp_fringe = \"3 mm\"\nwarp_colors = [\"#010203\", \"#040506\"]\n"
    ));
    let woven = scene.structure.woven().unwrap();
    assert_eq!(scene.structure.size(), [8, 10]);
    assert_eq!((woven.selvedge, woven.fringe), (Selvedge::Cut, [3e-3, 0.25e-3]));
    assert_eq!(woven.draft.lines(), Draft::twill(2, 1).unwrap().repeat(10, 8).unwrap().lines());
    assert_eq!(woven.draft.weft.iter().map(|thread| thread.yarn).collect::<Vec<_>>(), [1, 1, 0, 1, 1, 0, 1, 1]);
    assert!(
        [0.1e-3, 0.15e-3].iter().zip(scene.yarns.cards()).all(|(radius, card)| (card.radius - radius).abs() < 1e-15)
    );
    assert!((scene.yarns.of(1).linear_density - 40e-6).abs() < 1e-18);
    assert_eq!(scene.yarns.of(1).friction_coefficient, scene.yarns.of(0).friction_coefficient);
    let card = scene.fabric.woven().unwrap();
    assert!((card.spacing[0] - 0.5e-3).abs() < 1e-15 && card.spacing[1] == 0.6e-3);
    assert!((card.crimp_height[0] + card.crimp_height[1] - 0.5e-3).abs() < 1e-12);
    assert_eq!(resolved_again(&scene), scene);
    let mut network = scene.structure.network(&scene.fabric);
    scene.color_yarns(&mut network);
    assert_eq!(network.yarn_color[..3], [[1, 2, 3], [4, 5, 6], [1, 2, 3]]);
    assert_eq!(network.yarn_color[10], [0x20, 0x40, 0x60]);
}

#[test]
fn grips_hold_the_ends_of_yarns() {
    let weave = format!(
        "{YARN}[fabric.weave]\npattern = \"plain\"\nend_spacing = \"1 mm\"\npick_spacing = \"1 mm\"\nends = 4\npicks = 5\n\
         selvedge = \"cut\"\n[[grip]]\nselect = {{ yarn_end = {{ yarn = \"weft\", number = 2, end = \"last\" }} }}\n"
    );
    let scene = read(&weave);
    assert_eq!(scene.plan.grips[0].nodes, Selection::YarnEnd { yarn: 1, length: Some(1), end: WhichEnd::Last });
    assert_eq!(resolved_again(&scene), scene);
    let network = scene.structure.network(&scene.fabric);
    let held = scene.plan.grips[0].nodes.nodes(&network, &network.position);
    assert_eq!(held.len(), 1);
    assert!(network.position[held[0].index()].abs_diff_eq(DVec3::new(3.5e-3, 1e-3, 0.0), 1e-12));
    let wrong = weave.replace("yarn = \"weft\"", "yarn = \"wool\"");
    let error = Scene::from_text(&format!("schema = 1\n{wrong}"), "scene.toml").unwrap_err();
    assert!(error.to_string().contains("no yarn \"wool\""), "{error}");
}

#[test]
fn a_piece_on_the_bias_is_as_large_as_the_scene_says() {
    let weave = format!(
        "{YARN}[fabric.weave]\npattern = \"plain\"\nend_spacing = \"1 mm\"\npick_spacing = \"1 mm\"\n\
         bias = {{ angle = \"45 deg\", width = \"10 mm\", length = \"30 mm\" }}\n"
    );
    let scene = read(&weave);
    assert_eq!(scene.structure.size(), [29, 29]);
    assert_eq!(resolved_again(&scene), scene);
    let error = Scene::from_text(&format!("schema = 1\n{weave}ends = 30\n"), "scene.toml").unwrap_err();
    assert!(error.to_string().contains("ends beside bias"), "{error}");
    let tiny = weave.replace("end_spacing = \"1 mm\"", "end_spacing = 1e-300");
    let error = Scene::from_text(&format!("schema = 1\n{tiny}"), "scene.toml").unwrap_err();
    assert!(error.to_string().contains("the limit is 16000000"), "{error}");
}

#[test]
fn what_the_scene_states_of_a_weave_goes_before_its_geometry() {
    let scene = read(&format!(
        "{YARN}[fabric]\nresidual_compression = \"1 mN\"\n[fabric.weave]\nsymbols = [\".x\", \"x.\"]\nends = 4\npicks = 4\n\
         end_spacing = \"0.5 mm\"\npick_spacing = \"0.5 mm\"\ncrimp = [0.08, \"3 %\"]\nshear_stiffness = \"5 mN\"\n"
    ));
    let card = scene.fabric.woven().unwrap();
    assert_eq!((card.crimp, card.shear_stiffness, card.residual_compression), ([0.08, 0.03], 5e-3, 1e-3));
    assert_eq!(resolved_again(&scene), scene);
}

#[test]
fn what_only_knits_have_is_refused_beside_a_weave() {
    for key in ["wale_spacing", "contact_distance", "leg_distance", "facing_distance"] {
        let text = format!(
            "schema = 1\n{YARN}[fabric]\n{key} = \"1 mm\"\n[fabric.weave]\npattern = \"plain\"\nends = 4\npicks = 4\n\
             end_spacing = \"0.5 mm\"\npick_spacing = \"0.5 mm\"\n"
        );
        let error = Scene::from_text(&text, "scene.toml").unwrap_err();
        assert!(error.to_string().contains(&format!("{key} beside a weave")), "{error}");
    }
}

#[test]
fn a_wif_brings_its_colours_and_its_sett() {
    let folder = std::env::temp_dir().join(format!("wale-wif-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let wif = "[WIF]\nVersion=1.1\n[CONTENTS]\nWEAVING=1\nTHREADING=1\nTIEUP=1\nTREADLING=1\nWARP=1\nWEFT=1\n\
               [WEAVING]\nShafts=2\nTreadles=2\n[WARP]\nThreads=2\nUnits=centimeters\nSpacing=0.05\nColor=2\n\
               [WEFT]\nThreads=2\nUnits=centimeters\nSpacing=0.06\n[COLOR PALETTE]\nRange=0,255\nEntries=2\n\
               [COLOR TABLE]\n1=10,20,30\n2=255,0,0\n[THREADING]\n1=1\n2=2\n[TIEUP]\n1=1\n2=2\n[TREADLING]\n1=1\n2=2\n";
    std::fs::write(folder.join("plain.wif"), wif).unwrap();
    let write = |rest: &str| {
        let path = folder.join("scene.toml");
        std::fs::write(&path, format!("schema = 1\n{YARN}[fabric.weave]\nfile = \"plain.wif\"\n{rest}")).unwrap();
        Scene::read(&path)
    };
    let scene = write("ends = 6\npicks = 4\n").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(scene.fabric.cell(), [0.5e-3, 0.6e-3]);
    assert_eq!(scene.structure.woven().unwrap().draft.warp[5].color, Some([255, 0, 0]));
    assert_eq!(resolved_again(&scene), scene);
    // The file's sett jams with a thicker yarn, and the error says at what.
    let error = write("[yarns.warp]\ndiameter = \"0.5 mm\"\nlinear_density = \"90 tex\"\n").unwrap_err();
    assert!(error.to_string().contains("it jams at"), "{error}");
    // A file without units has no sett; the error says how close it can be.
    std::fs::write(folder.join("plain.wif"), wif.replace("Units=centimeters\n", "")).unwrap();
    let error = write("").unwrap_err();
    assert!(error.to_string().contains("no end_spacing, and no spacing with its unit in the file"), "{error}");
    let why = error.why().unwrap();
    let (_, closest) = why.split_once("jams at ").unwrap();
    let closest: f64 = closest.split_once(" mm").unwrap().0.parse().unwrap();
    let at = |factor: f64| write(&format!("end_spacing = \"{0} mm\"\npick_spacing = \"{0} mm\"\n", factor * closest));
    assert!(at(1.01).is_ok() && at(0.99).is_err(), "{why}");
    let wrong = wif.replace("[TREADLING]\n1=1", "[TREADLING]\n1=7");
    std::fs::write(folder.join("plain.wif"), &wrong).unwrap();
    let error = write("").unwrap_err();
    assert!(error.to_string().contains("plain.wif:35:1:"), "{error}");
    // The same in a file with a title in Latin-1, which is no UTF-8.
    let latin =
        [wrong.split_at(18).0.as_bytes(), b"[TEXT]\nTitle=K\xf6per\n", wrong.split_at(18).1.as_bytes()].concat();
    std::fs::write(folder.join("plain.wif"), latin).unwrap();
    let error = write("").unwrap_err();
    assert!(error.to_string().contains("plain.wif:37:1:"), "{error}");
    assert_eq!(error.underlined(), Some("1=7"));
    std::fs::remove_dir_all(folder).unwrap();
}
