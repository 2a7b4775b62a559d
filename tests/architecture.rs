//! The rules of the house that can be read off the text of `src/`: who may import whom, and what may be
//! said only in one place. ARCHITECTURE.md gives the reasons.

mod architecture {
    mod checker;
    mod rings;
    mod snippets;
    pub mod source;

    use checker::violations;
    use rings::rings;
    use std::path::{Path, PathBuf};

    /// Every Rust file below a directory of the project, as its path from the root and its text.
    fn files(below: &str) -> Vec<(String, String)> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let mut open = vec![root.join(below)];
        let mut found: Vec<PathBuf> = Vec::new();
        while let Some(directory) = open.pop() {
            for entry in std::fs::read_dir(&directory).expect("a directory") {
                let path = entry.expect("an entry").path();
                if path.is_dir() {
                    open.push(path);
                } else if path.extension().is_some_and(|ending| ending == "rs") {
                    found.push(path);
                }
            }
        }
        found.sort();
        let name = |path: &Path| {
            let inside = path.strip_prefix(root).expect("inside the project");
            inside.to_str().expect("a UTF-8 path").replace('\\', "/")
        };
        found
            .iter()
            .map(|path| (name(path), std::fs::read_to_string(path).expect("UTF-8 source")))
            .collect()
    }

    #[test]
    fn property_the_source_keeps_the_rules_of_the_house() {
        let files = files("src");
        assert!(files.len() > 100, "only {} files were found", files.len());
        let wrong: Vec<String> =
            files.iter().flat_map(|(path, text)| violations(path, text)).collect();
        assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
    }

    /// Rings of files that are still there. Take out a line when its ring is broken; add none.
    const RINGS_LEFT: &[&[&str]] = &[
        &["campaign/refutation", "campaign/tighten"],
        &["campaign/scores", "campaign/trade"],
        &["cli/arguments", "cli/calibrate_arguments", "cli/rig_arguments"],
        &["findings/derivatives", "findings/design_value", "findings/trade"],
        &["findings/rare", "findings/story"],
        &["findings/sweep", "findings/sweep_best"],
        &["reliability/demonstration", "reliability/probability"],
        &["reliability/design_point", "reliability/design_search"],
        &["render/figures/chart", "render/figures/key"],
        &["render/figures/sweep", "render/figures/sweep_map"],
        &["uncertainty/marginal", "uncertainty/moments"],
    ];

    #[test]
    fn property_no_files_import_each_other_in_a_ring() {
        let found = rings(&files("src"));
        let left: Vec<Vec<&str>> = RINGS_LEFT.iter().map(|ring| ring.to_vec()).collect();
        let new: Vec<_> = found.iter().filter(|ring| !left.iter().any(|l| l == *ring)).collect();
        assert!(new.is_empty(), "these files import each other in a ring: {new:#?}");
        let gone: Vec<_> = left.iter().filter(|l| !found.iter().any(|ring| ring == *l)).collect();
        assert!(gone.is_empty(), "broken by now: take them out of RINGS_LEFT: {gone:#?}");
    }

    #[test]
    fn property_the_tests_keep_what_concerns_them() {
        let wrong: Vec<String> =
            files("tests").iter().flat_map(|(path, text)| violations(path, text)).collect();
        assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
    }
}
