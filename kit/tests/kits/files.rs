//! Kits in files: they are recognised, read and written whole.

use std::error::Error;
use std::fs;

use kit::file::write_whole;
use kit::{KitError, binary, text};

use crate::sample;

type Outcome = Result<(), Box<dyn Error>>;

fn names_in(folder: &std::path::Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[test]
fn kit_is_read_as_text_or_binary_by_its_content() -> Outcome {
    let folder = tempfile::tempdir()?;
    let bytes = binary::build(&sample::kit())?;
    for (name, content) in
        [("kit", bytes.clone()), ("kit.bin", bytes.clone()), ("kit.toml", text::write(&sample::kit()).into_bytes())]
    {
        let path = folder.path().join(name);
        write_whole(&path, &content)?;
        let loaded = kit::load(&path)?;
        assert_eq!(loaded.kit, sample::kit(), "{name}");
        assert_eq!(loaded.binary, bytes, "{name}");
        let opened = kit::open(path.to_str().ok_or("a path in UTF-8")?)?;
        assert_eq!(opened.binary, bytes, "{name}");
    }
    Ok(())
}

#[test]
fn bin_file_without_magic_is_refused_as_binary() -> Outcome {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("flash.bin");
    fs::write(&path, [0xFF; 64])?;
    let message = kit::load(&path).expect_err("erased").to_string();
    assert!(message.contains("flash.bin: wrong magic"), "{message}");
    Ok(())
}

#[test]
fn file_that_is_neither_text_nor_binary_kit_is_refused() -> Outcome {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("noise");
    fs::write(&path, [b'a', b'=', 0xFF])?;
    let error = kit::load(&path).expect_err("noise");
    assert!(matches!(error, KitError::NotText { offset: 2, .. }), "{error}");
    assert!(error.to_string().contains("noise: not text in UTF-8 (byte 2 is not); give a kit as text"), "{error}");
    Ok(())
}

#[test]
fn dump_of_a_flash_sector_is_read_without_its_erased_part() -> Outcome {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("sector.bin");
    let kit_bytes = binary::build(&sample::kit())?;
    let mut sector = kit_bytes.clone();
    sector.resize(16 * 1024, 0xFF);
    fs::write(&path, &sector)?;
    assert_eq!(kit::load(&path)?.binary, kit_bytes);
    Ok(())
}

#[test]
fn includes_are_found_beside_the_file_that_names_them() -> Outcome {
    let folder = tempfile::tempdir()?;
    fs::create_dir(folder.path().join("tables"))?;
    fs::write(folder.path().join("tables/bar.toml"), "format = 1\n[[object]]\nname = \"bar\"\nmodes = []\n")?;
    let main = folder.path().join("kit.toml");
    fs::write(&main, "format = 1\ninclude = [\"tables/bar.toml\"]\n")?;
    assert_eq!(kit::load(&main)?.kit.objects.len(), 1);
    fs::remove_file(folder.path().join("tables/bar.toml"))?;
    let message = kit::load(&main).expect_err("gone").to_string();
    assert!(message.contains("kit.toml:2:12: include: ") && message.contains("bar.toml: cannot be read"), "{message}");
    Ok(())
}

#[test]
fn missing_file_is_refused_with_path_and_reason() {
    let message = kit::load(std::path::Path::new("no/such.toml")).expect_err("there is none").to_string();
    assert_eq!(message, "no/such.toml: cannot be read: No such file or directory; check its name and folder");
}

#[test]
fn writing_replaces_the_whole_file_and_leaves_nothing_beside_it() -> Outcome {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("kit.bin");
    write_whole(&path, b"old and long")?;
    write_whole(&path, b"new")?;
    assert_eq!(fs::read(&path)?, b"new");
    assert_eq!(names_in(folder.path()), ["kit.bin"]);
    Ok(())
}

#[test]
fn writing_that_fails_names_the_file_and_leaves_nothing_behind() -> Outcome {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("nowhere/kit.bin");
    let message = write_whole(&path, b"x").expect_err("no folder").to_string();
    assert!(message.contains("nowhere/kit.bin: cannot be written: No such file"), "{message}");
    let message = write_whole(folder.path(), b"x").expect_err("a folder").to_string();
    assert!(message.contains("cannot be written"), "{message}");
    // The system refuses this name only when the finished file is renamed to it.
    let message = write_whole(&folder.path().join("x".repeat(300)), b"x").expect_err("a long name").to_string();
    assert!(message.contains("xxx: cannot be written: "), "{message}");
    assert!(names_in(folder.path()).is_empty());
    Ok(())
}

#[cfg(unix)]
#[test]
fn writing_follows_links_and_keeps_permissions() -> Outcome {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = tempfile::tempdir()?;
    let (path, link) = (folder.path().join("kit.bin"), folder.path().join("link.bin"));
    fs::write(&path, b"old")?;
    fs::set_permissions(&path, fs::Permissions::from_mode(0o640))?;
    symlink("kit.bin", &link)?;
    write_whole(&link, b"new")?;
    assert_eq!(fs::read(&path)?, b"new");
    assert!(fs::symlink_metadata(&link)?.is_symlink());
    assert_eq!(fs::metadata(&path)?.permissions().mode() & 0o777, 0o640);
    Ok(())
}
