//! Shipped kits: they are valid, and equal the files in tables/.

use std::path::Path;

use dsp_core::table::Kit as TableView;
use kit::{KitError, binary};

#[test]
fn every_shipped_kit_is_valid_and_says_where_its_numbers_come_from() -> Result<(), KitError> {
    assert!(kit::shipped_names().any(|name| name == "demo"));
    for name in kit::shipped_names() {
        let loaded = kit::open(name)?;
        assert_eq!(loaded.kit.name, name);
        assert!(TableView::parse(&loaded.binary).is_ok());
        assert_eq!(binary::build(&loaded.kit)?, loaded.binary);
        assert!(!loaded.kit.pads.is_empty());
        for object in &loaded.kit.objects {
            assert!(!object.source.is_empty() && !object.licence.is_empty(), "{}", object.name);
        }
        for striker in &loaded.kit.strikers {
            assert!(!striker.source.is_empty() && !striker.licence.is_empty(), "{}", striker.name);
        }
    }
    Ok(())
}

#[test]
fn shipped_kit_equals_its_file() -> Result<(), KitError> {
    for name in kit::shipped_names() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tables").join(format!("{name}.toml"));
        assert_eq!(kit::load(&file)?.binary, kit::open(name)?.binary);
    }
    Ok(())
}

#[test]
fn name_of_neither_file_nor_shipped_kit_is_refused_with_the_shipped_ones() {
    let message = kit::open("nosuch.toml").expect_err("there is none").to_string();
    assert!(message.contains("nosuch.toml") && message.contains("demo"), "{message}");
}
