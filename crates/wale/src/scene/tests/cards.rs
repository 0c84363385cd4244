//! Scenes that take the numbers of a fabric's card.

use std::fs;
use std::path::Path;

use super::super::Scene;

const KNIT: &str = "schema = 1\n[yarn]\npreset = \"thick-acrylic\"\ndiameter = \"1.2 mm\"\nstretch_stiffness = \"7 N\"\n\
    [fabric]\nloop_length = \"11 mm\"\nspacing_stiffness = \"30 N\"\nwrapping_stiffness = \"9 mN\"\n\
    [fabric.chart]\npattern = \"stockinette\"\ncolumns = 8\nrows = 8\n";
const WEAVE: &str = "schema = 1\n[yarn]\nlinear_density = \"50 tex\"\ndiameter = \"0.27 mm\"\nstretch_stiffness = \"2.5 N\"\n\
    bending_stiffness = \"5 mN mm^2\"\n[yarns.B]\nstretch_stiffness = \"2.4 N\"\n[fabric]\nanchor_stiffness = \"900 N/m\"\n\
    [fabric.weave]\npattern = \"plain\"\nends = 6\npicks = 6\nend_spacing = \"0.5 mm\"\npick_spacing = \"0.5 mm\"\n\
    warp = [\"A\"]\nweft = [\"B\"]\nshear_stiffness = \"60 mN\"\n";

/// A folder with the card of a fabric whose scene is this, and a scene of another one beside it.
fn folder(fitted: &str, scene: &str) -> (tempfile::TempDir, Scene) {
    let folder = tempfile::tempdir().unwrap();
    let fitted = Scene::from_text(fitted, "fitted").unwrap_or_else(|error| panic!("{error}"));
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("swatch.toml", &fitted.resolved_toml().unwrap());
    write(
        "card.toml",
        "schema = 1\ntitle = \"a\"\n[shell]\nk_xx = \"1 N/m\"\n[contacts]\nscene = \"swatch.toml\"\nnumbers = []\n",
    );
    write("bare.toml", "schema = 1\ntitle = \"a\"\n");
    write("astray.toml", "schema = 1\n[contacts]\nscene = \"../swatch.toml\"\nnumbers = []\n");
    write("scene.toml", scene);
    (folder, fitted)
}

fn read(folder: &Path) -> Result<Scene, String> {
    Scene::read(&folder.join("scene.toml")).map_err(|error| error.to_string())
}

const RIB: &str =
    "schema = 1\n[yarn]\ncard = \"card.toml\"\n[fabric.chart]\npattern = \"rib 1x1\"\ncolumns = 6\nrows = 4\n";

#[test]
fn a_card_stands_behind_another_chart() {
    let (folder, fitted) = folder(KNIT, RIB);
    let scene = read(folder.path()).unwrap();
    assert_eq!((&scene.yarns, &scene.fabric), (&fitted.yarns, &fitted.fabric));
    assert_ne!(scene.structure, fitted.structure);
    let opened = Scene::read_with_inputs(&folder.path().join("scene.toml")).unwrap().inputs;
    assert_eq!(opened.len(), 3, "the scene, the card and the scene of the card: {opened:?}");
    // What the scene says goes before what the card says.
    let own = RIB.replace("\"card.toml\"\n", "\"card.toml\"\nfriction = 0.6\n");
    fs::write(folder.path().join("scene.toml"), own).unwrap();
    let own = read(folder.path()).unwrap();
    assert_eq!(own.yarns.first().friction_coefficient, 0.6);
    assert_eq!(own.yarns.first().stretch_stiffness, 7.0);
}

#[test]
fn a_card_stands_behind_another_weave() {
    let twill = "schema = 1\n[yarn]\ncard = \"card.toml\"\n[fabric.weave]\npattern = \"twill 2/1\"\nends = 6\npicks = 6\n\
        end_spacing = \"0.4 mm\"\npick_spacing = \"0.5 mm\"\nwarp = [\"A\"]\nweft = [\"B\"]\n";
    let (folder, fitted) = folder(WEAVE, twill);
    let scene = read(folder.path()).unwrap();
    assert_eq!(scene.yarns, fitted.yarns);
    let (found, known) = (scene.fabric.woven().unwrap(), fitted.fabric.woven().unwrap());
    assert_eq!(found.shear_stiffness, known.shear_stiffness);
    assert_eq!(found.anchor_stiffness, known.anchor_stiffness);
    assert_ne!(found.spacing, known.spacing, "its sett is its own");
}

#[test]
fn cards_that_cannot_stand_behind_a_scene_are_refused() {
    let (folder, _) = folder(KNIT, RIB);
    for (from, to, says) in [
        ("card.toml", "bare.toml", "the card has no [contacts]"),
        ("card.toml", "none.toml", "\"none.toml\" cannot be read"),
        ("card.toml", "astray.toml", "\"../swatch.toml\" is not a path inside"),
        ("card = ", "preset = \"worsted-wool\"\ncard = ", "the yarn has a preset and a card"),
        ("[fabric.chart]", "[fabric]\nloop_length = \"9 mm\"\n[fabric.chart]", "loop_length beside a card"),
        (
            "[fabric.chart]\npattern = \"rib 1x1\"\ncolumns = 6\nrows = 4\n",
            "[fabric.weave]\npattern = \"plain\"\nends = 4\npicks = 4\nend_spacing = \"2 mm\"\npick_spacing = \"2 mm\"\n",
            "the card is of a knit, the fabric a weave",
        ),
    ] {
        fs::write(folder.path().join("scene.toml"), RIB.replace(from, to)).unwrap();
        let error = read(folder.path()).unwrap_err();
        assert!(error.contains(says), "{says}: {error}");
    }
}
