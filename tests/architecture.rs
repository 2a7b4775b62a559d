//! The rules of the house that can be read off the text of `src/`: who may import whom, and what may be
//! said only in one place. ARCHITECTURE.md gives the reasons.

mod architecture {
    mod checker;
    mod snippets;
    pub mod source;

    use checker::violations;
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

    #[test]
    fn property_the_tests_keep_what_concerns_them() {
        let wrong: Vec<String> =
            files("tests").iter().flat_map(|(path, text)| violations(path, text)).collect();
        assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
    }
}
