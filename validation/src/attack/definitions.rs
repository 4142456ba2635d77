//! Malformed definitions: extreme numbers, keys dropped, duplicated or exchanged, long names, deep nesting, bytes. Each
//! is rejected with a message, or is a model that starts and steps.
use super::histories::outputs;
use super::mechanism;
use super::prepared::{Definition, Prepared};
use super::probe::Probe;
use super::random::Random;
use super::{actuator, network};
use linkage_fmu::component::{Component, Stepped};
use serde_json::Value;

/// Given definitions, used next to the random ones.
const GIVEN: [&str; 7] = [
    example!("LandingGearRetraction"),
    example!("SliderCrank"),
    example!("FourBar"),
    example!("Jib"),
    example!("CraneJib"),
    example!("AndrewsSqueezer"),
    example!("LandingGearRetractionHydraulic"),
];

/// Steps of a model from a malformed definition.
const STEPS: usize = 3;
/// Placeholder in a text for a piece of text that JSON cannot represent.
const PLACE: &str = "\"@@place@@\"";

/// The case of this part: one definition.
pub fn attack(probe: &mut Probe) -> Result<(), String> {
    let mut random = probe.random.clone();
    let (file, text) = match random.below(9) {
        0..=2 => ("mechanism.json", random.pick(&GIVEN).to_owned()),
        3..=5 => ("mechanism.json", mechanism::definition(&mut random).text),
        6 => ("hydraulics.json", actuator::definition(&mut random).text),
        7 => ("network.json", network::definition(&mut random).text),
        _ => ("mechanism.json", actuator::gear(&mut random).text),
    };
    let text = malformed(&mut random, &text);
    if probe.verbose {
        println!("{text}");
    }
    let refused = |probe: &mut Probe, message: String| {
        probe.count("definitions refused");
        // The message may quote a name; the logger of an instance truncates it.
        let long = message.len() > 3 * text.len() + 1000;
        if message.is_empty() || message.contains('\n') || long {
            return Err(format!("a refusal of {} bytes: {message:.200}", message.len()));
        }
        Ok(())
    };
    if let Ok(found) = probe.timed("inspection", || Component::inspect(file, &text)) {
        for finding in found.findings {
            if finding.message.is_empty() || finding.message.contains('\n') {
                return Err(format!("a finding without words, or of several lines: {finding:?}"));
            }
        }
    }
    let mut model = match probe.timed("instantiation", || Component::from_definition(file, &text)) {
        Ok(model) => model,
        Err(error) => return refused(probe, error.to_string()),
    };
    if let Err(error) = probe.timed("initialisation", || model.initialize()) {
        return refused(probe, error.to_string());
    }
    probe.count("models");
    let prepared = Prepared::of(Definition { file, text, force: 0.0, torque: 0.0, h: 0.0 }, model.clone());
    let read = |probe: &mut Probe, model: &mut Component| probe.timed("outputs", || outputs(model, &prepared));
    read(probe, &mut model).map_err(|e| format!("at the start: {e}"))?;
    for n in 0..STEPS {
        let h = random.decades(1e-6, 1.0);
        match probe.timed("step", || model.step(h)) {
            Ok(Stepped::Whole) => probe.count("steps"),
            Ok(_) | Err(_) => probe.count("steps that ended with an error"),
        }
        read(probe, &mut model).map_err(|e| format!("after step {n} of {h:e} s: {e}"))?;
    }
    Ok(())
}

/// A number in place of another one.
fn number(random: &mut Random, old: f64) -> String {
    const ODD: [&str; 24] = [
        "0", "-0", "1", "-1", "1e-6", "1e3", "-1e3", "1e6", "1e17", "-1e17", "1e100", "1e150", "-1e155", "1e200",
        "1e308", "-1e308", "1e-160", "1e-308", "5e-324", "1e999", "NaN", "true", "\"1\"", "null",
    ];
    match random.below(4) {
        0 => random.pick(&ODD).into(),
        1 => format!("{:e}", f64::from_bits(random.word())),
        2 => format!("{:e}", old * (1.0 + random.pick(&[1e-16, 1e-12, -1e-9, 1e-3]))),
        _ => format!("{:e}", old * random.pick(&[-1.0, 1.0]) * random.decades(1e-6, 1e6)),
    }
}

/// The JSON pointers of the members and elements of a value.
fn pointers(value: &Value, at: &str, found: &mut Vec<String>) {
    let mut below = |key: &str, member: &Value| {
        let pointer = format!("{at}/{key}");
        found.push(pointer.clone());
        pointers(member, &pointer, found);
    };
    match value {
        Value::Object(members) => members.iter().for_each(|(key, member)| below(key, member)),
        Value::Array(elements) => elements.iter().enumerate().for_each(|(k, element)| below(&k.to_string(), element)),
        _ => {}
    }
}

/// A definition with up to three changes.
fn malformed(random: &mut Random, text: &str) -> String {
    let mut value: Value = serde_json::from_str(text).unwrap_or_default();
    let mut text = None;
    for _ in 0..=random.below(3) {
        let mut found = Vec::new();
        pointers(&value, "", &mut found);
        if found.is_empty() {
            break;
        }
        let place = &found[random.below(found.len())];
        let numbers: Vec<&String> = found.iter().filter(|at| value.pointer(at).is_some_and(Value::is_number)).collect();
        match random.below(12) {
            0..=5 if !numbers.is_empty() => {
                let place = numbers[random.below(numbers.len())].clone();
                let old = value.pointer(&place).and_then(Value::as_f64).unwrap_or(1.0);
                let new = number(random, old);
                match serde_json::from_str(&new) {
                    Ok(new) => put(&mut value, &place, new),
                    Err(_) => text = Some(placed(&value, &place, &new)),
                }
            }
            6 => remove(&mut value, place),
            7 => {
                // A duplicated key.
                if let Some((_, key)) =
                    place.rsplit_once('/').filter(|_| !place.ends_with(|c: char| c.is_ascii_digit()))
                {
                    let own = value.pointer(place).map(Value::to_string).unwrap_or_default();
                    text = Some(placed(&value, place, &format!("{own},\"{key}\":{own}")));
                }
            }
            8 => {
                let other = value.pointer(&found[random.below(found.len())]).cloned().unwrap_or_default();
                put(&mut value, place, other);
            }
            9 => {
                let strings: Vec<&String> =
                    found.iter().filter(|at| value.pointer(at).is_some_and(Value::is_string)).collect();
                if strings.len() > 1 {
                    let [a, b] = [0, 1].map(|_| strings[random.below(strings.len())].clone());
                    let other = value.pointer(&b).cloned().unwrap_or_default();
                    put(&mut value, &a, other);
                }
            }
            10 => {
                let name = random.pick(&["x", "\u{e9}", "a.", " ", "\n", "_"]).repeat(1 << random.below(17));
                rename(&mut value, place, &name);
            }
            _ => {
                let depth = 1 << random.below(18);
                let open = random.pick(&["[", "{\"a\":", "{\"bodies\":{\"ground\":"]);
                let close = if random.chance(0.5) { "" } else { random.pick(&["]", "}"]) };
                text = Some(placed(&value, place, &format!("{}1{}", open.repeat(depth), close.repeat(depth))));
            }
        }
    }
    let mut text = text.unwrap_or_else(|| value.to_string()).into_bytes();
    if random.chance(0.1) && !text.is_empty() {
        let at = random.below(text.len());
        match random.below(3) {
            0 => text.truncate(at),
            1 => text[at] = random.word() as u8,
            _ => drop(text.remove(at)),
        }
    }
    String::from_utf8_lossy(&text).into_owned()
}

fn put(value: &mut Value, place: &str, new: Value) {
    if let Some(own) = value.pointer_mut(place) {
        *own = new;
    }
}

/// The text with another piece of text in place of the placeholder.
fn placed(value: &Value, place: &str, piece: &str) -> String {
    let mut value = value.clone();
    put(&mut value, place, PLACE.trim_matches('"').into());
    value.to_string().replace(PLACE, piece)
}

fn remove(value: &mut Value, place: &str) {
    let Some((parent, key)) = place.rsplit_once('/') else { return };
    if let Some(members) = value.pointer_mut(parent).and_then(Value::as_object_mut) {
        members.remove(key);
    }
}

fn rename(value: &mut Value, place: &str, name: &str) {
    let Some((parent, key)) = place.rsplit_once('/') else { return };
    if let Some(members) = value.pointer_mut(parent).and_then(Value::as_object_mut)
        && let Some(member) = members.remove(key)
    {
        members.insert(name.into(), member);
    }
}
