//! Residuals and the background in text: invalid ones are refused with their place.

use crate::sample;

const TEXT: &str = r#"format = 1
name = "test"

[background]
seed = 3
edges_hz = [100.0, 1000.0, 9000.0]
weight = [0.001, 0.002]

[[object]]
name = "bar"
modes = []

[object.residual]
seed = 7
edges_hz = [50, 200, 800, 3200]
weight = [0.1, 0.05, 0.01]
decay_db_per_s = [100, 200.5, 400]

[[striker]]
name = "yarn"
peak_force = 20.0
contact_time_s = 0.001

[[pad]]
name = "bar"
object = "bar"
strikers = ["yarn"]
"#;

fn refusal(from: &str, to: &str) -> String {
    assert_eq!(TEXT.matches(from).count(), 1, "{from:?} stands there once");
    sample::parse(&TEXT.replace(from, to)).expect_err("a wrong text").to_string()
}

#[test]
fn residual_and_background_come_through_text_and_bytes_unchanged() {
    let kit = sample::parse(TEXT).expect("a right text");
    let residual = kit.objects[0].residual.as_ref().expect("the object has one");
    assert_eq!((residual.seed, residual.edges_hz.len(), residual.decay_db_per_s[1]), (7, 4, 200.5));
    assert_eq!(kit.background.as_ref().map(|background| background.weight[1]), Some(0.002));
    assert_eq!(sample::parse(&kit::text::write(&kit)).expect("its own text"), kit);
    let bytes = kit::binary::build(&kit).expect("a right kit");
    assert_eq!(kit::binary::read(&bytes).expect("its own bytes"), kit);
}

#[test]
fn edges_out_of_order_are_refused_with_their_place() {
    let message = refusal("800, 3200", "150, 3200");
    assert_eq!(
        message,
        "test.toml:15:22: object 0 \"bar\", residual, edge 2: edges_hz = 150: must be at least 1 Hz above the edge before it, 200"
    );
    let message = refusal("1000.0, 9000.0", "1000.0, 1000.5");
    assert!(
        message.starts_with("test.toml:6:28: background, edge 2: edges_hz = 1000.5: must be at least 1 Hz"),
        "{message}"
    );
}

#[test]
fn weights_and_decays_out_of_range_are_refused_with_their_place() {
    let message = refusal("[100, 200.5, 400]", "[100, -200.5, 400]");
    assert_eq!(
        message,
        "test.toml:16:16: object 0 \"bar\", residual, band 1: decay_db_per_s = -200.5: must be from 1 to 20000"
    );
    let message = refusal("0.05, 0.01", "0.05, -0.01");
    assert!(
        message.starts_with("test.toml:16:22: object 0 \"bar\", residual, band 2: weight = -0.01: must be from 0"),
        "{message}"
    );
    let message = refusal("800, 3200", "800, 96001");
    assert!(
        message.starts_with("test.toml:15:27: object 0 \"bar\", residual, edge 3: edges_hz = 96001: must be"),
        "{message}"
    );
    let message = refusal("[0.001, 0.002]", "[0.001, 17]");
    assert!(message.starts_with("test.toml:7:18: background, band 1: weight = 17: must be from 0 to 16"), "{message}");
}

#[test]
fn more_bands_than_fit_and_arrays_of_unlike_length_are_refused() {
    let many = |count: usize, number: fn(usize) -> f32| {
        let numbers: Vec<String> = (0..count).map(|index| number(index).to_string()).collect();
        format!("[{}]", numbers.join(", "))
    };
    let text = TEXT
        .replace("[50, 200, 800, 3200]", &many(102, |index| 50.0 + 100.0 * index as f32))
        .replace("[0.1, 0.05, 0.01]", &many(101, |_| 0.1))
        .replace("[100, 200.5, 400]", &many(101, |_| 100.0));
    let message = sample::parse(&text).expect_err("too many bands").to_string();
    assert_eq!(message, "test.toml:13:1: object 0 \"bar\", residual: weight = 101: must be from 1 to 100");
    let message = refusal("[0.1, 0.05, 0.01]", "[0.1, 0.05]");
    assert!(
        message.contains("object 0 \"bar\", residual: edges_hz has 4 numbers: must have 3, one more than"),
        "{message}"
    );
    let message = refusal("[100, 200.5, 400]", "[100]");
    assert!(message.contains("decay_db_per_s has 1 number: must have 3, as many as weight has"), "{message}");
    let message = refusal("[100, 200.5, 400]", "[]\nother = 1");
    assert!(message.starts_with("test.toml:18:1: unknown key `other`"), "{message}");
}
