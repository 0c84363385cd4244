//! Every scene of the gallery reads, and what is resolved from it reads back the same.

use std::path::Path;

use wale::scene::Scene;

#[test]
fn every_scene_reads_and_resolves_to_itself() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let scene = Scene::read(&path).unwrap_or_else(|error| panic!("{error}\n{:?}", error.mend()));
        assert!(!scene.title.is_empty(), "{} has no title", path.display());
        let resolved = scene.resolved_toml().unwrap();
        let again = Scene::from_text(&resolved, "resolved").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(again, scene, "{}", path.display());
        count += 1;
    }
    assert!(count > 0, "no scenes");
}
