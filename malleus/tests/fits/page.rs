//! Pages under test: their tags by parsing, and what a browser finds on them.

use std::fs;
use std::path::Path;
use std::process::Command;

use tempfile::TempDir;

/// Tag of a page.
pub(crate) struct Tag {
    pub(crate) name: String,
    pub(crate) closes: bool,
    pub(crate) attributes: Vec<(String, String)>,
}

/// All tags of a page in order, except those in scripts and styles.
pub(crate) fn tags(html: &str) -> Vec<Tag> {
    let mut tags = Vec::new();
    let mut rest = html;
    while let Some((_, after)) = rest.split_once('<') {
        let (inside, following) = after.split_once('>').expect("each tag ends");
        rest = following;
        let closes = inside.starts_with('/');
        let inside = inside.trim_start_matches('/').trim_end_matches('/');
        let (name, mut fields) = inside.split_once(' ').unwrap_or((inside, ""));
        let mut attributes = Vec::new();
        while let Some((key, after)) = fields.split_once("=\"") {
            let (value, following) = after.split_once('"').expect("each value ends");
            attributes.push((key.trim().to_owned(), value.to_owned()));
            fields = following;
        }
        if ["script", "style"].contains(&name) && !closes {
            rest = rest.split_once(&format!("</{name}>")).expect("it ends").1;
            continue;
        }
        tags.push(Tag { name: name.to_owned(), closes, attributes });
    }
    tags
}

/// Elements that have no end tag.
const VOID: [&str; 6] = ["!DOCTYPE", "meta", "link", "path", "image", "circle"];

pub(crate) fn assert_well_formed_and_self_contained(html: &str) {
    let mut open: Vec<String> = Vec::new();
    for tag in tags(html) {
        for (key, value) in &tag.attributes {
            if ["src", "href", "action", "poster", "srcset", "data"].contains(&key.as_str()) {
                assert!(value.starts_with("data:") || value.starts_with("./"), "{} {key}={value:.60}", tag.name);
            }
        }
        if tag.closes {
            assert_eq!(open.pop(), Some(tag.name));
        } else if !VOID.contains(&tag.name.as_str()) && tag.name != "rect" {
            open.push(tag.name);
        }
    }
    assert!(open.is_empty(), "{open:?} are not closed");
    for address in ["http://", "https://", "@import", "url("] {
        assert!(!html.contains(address), "{address}");
    }
}

pub(crate) fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Script that plays the page's sounds, decodes its pictures, and writes its findings into the
/// page.
const FINDS: &str = r#"<script>
const blocked = [];
document.addEventListener("securitypolicyviolation", event => blocked.push(event.blockedURI));
(async () => {
  const sounds = [];
  for (const sound of document.querySelectorAll("audio")) {
    let played = "yes";
    try { await sound.play(); } catch (error) { played = String(error); }
    sounds.push({ played, duration: sound.duration, error: sound.error && sound.error.message });
    sound.pause();
  }
  const pictures = [];
  for (const picture of document.querySelectorAll("svg image")) {
    const image = new Image();
    image.src = picture.getAttribute("href");
    await image.decode();
    pictures.push(image.naturalWidth);
  }
  const charts = [...document.querySelectorAll("svg")].map(chart => chart.getBoundingClientRect().height);
  const score = document.querySelector(".blind output");
  const [play, ...answers] = document.querySelectorAll(".blind button");
  const counts = [];
  if (score) {
    answers[0].click();
    counts.push(score.textContent);
  }
  for (const answer of answers) {
    play.click();
    answer.click();
    counts.push(score.textContent);
    answer.click();
  }
  const outside = performance.getEntriesByType("resource").map(entry => entry.name).filter(name => !name.startsWith("data:"));
  const found = { sounds, pictures, charts, counts, outside, blocked, wide: document.documentElement.scrollWidth - innerWidth };
  const note = document.createElement("pre");
  note.id = "found";
  note.textContent = JSON.stringify(found);
  document.body.append(note);
})();
</script>
</body>"#;

/// Findings that the script wrote into the page.
///
/// A browser on a busy machine may end before the script does, so that it is run up to three times.
fn dump(browser: &str, window: &str, probe: &Path) -> String {
    let mut said = String::new();
    for _ in 0..3 {
        let profile = TempDir::new().expect("a folder");
        let shown = Command::new(browser)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--mute-audio", "--no-first-run"])
            .args(["--autoplay-policy=no-user-gesture-required", "--virtual-time-budget=20000", "--dump-dom", window])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg(format!("file://{}", probe.display()))
            .output()
            .expect("the browser runs");
        let dom = String::from_utf8_lossy(&shown.stdout);
        let found = dom.split_once("<pre id=\"found\">").and_then(|(_, found)| found.split_once("</pre>"));
        if let Some((found, _)) = found {
            return found.to_owned();
        }
        said = String::from_utf8_lossy(&shown.stderr).into_owned();
    }
    panic!("the page's script did not end: {said}")
}

/// Opens a page in Chromium, in a wide window and in one as narrow as a phone; returns the findings
/// of both. Asserts that the page fetches nothing and is no wider than its window.
pub(crate) fn findings(html: &str) -> Vec<serde_json::Value> {
    let browser = option_env!("CHROMIUM").unwrap_or("chromium");
    let folder = TempDir::new().expect("a folder");
    let probe = folder.path().join("probe.html");
    fs::write(&probe, html.replace("</body>", FINDS)).expect("written");
    let in_window = |window: &str| {
        let found = dump(browser, window, &probe);
        let found = found.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&");
        let found: serde_json::Value = serde_json::from_str(&found).expect("JSON");
        assert!(list(&found, "outside").is_empty() && list(&found, "blocked").is_empty(), "{found}");
        assert!(found["wide"].as_f64() <= Some(0.0), "the page is wider than its window: {found}");
        found
    };
    ["--window-size=1200,900", "--window-size=500,900"].map(in_window).to_vec()
}

/// List among the findings.
pub(crate) fn list(found: &serde_json::Value, name: &str) -> Vec<serde_json::Value> {
    found[name].as_array().expect("a list").clone()
}

/// Asserts that all sounds played, and for a number of seconds within a range.
pub(crate) fn assert_sounds_play(found: &serde_json::Value, range_s: std::ops::Range<f64>) {
    for sound in list(found, "sounds") {
        assert_eq!(sound["played"], "yes", "{found}");
        assert!(sound["duration"].as_f64().is_some_and(|seconds| range_s.contains(&seconds)), "{found}");
        assert!(sound["error"].is_null(), "{found}");
    }
}
