//! The GUID of an interface.
use super::{Unit, Variable};
use std::collections::HashMap;

/// FNV-1a with 128 bits over everything that a host can see but start values, in the form of a GUID.
pub(super) fn guid(name: &str, list: &[Variable]) -> String {
    const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013B;
    let mut hash: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    let mut feed = |text: &str| {
        for byte in text.bytes().chain([0]) {
            hash = (hash ^ u128::from(byte)).wrapping_mul(PRIME);
        }
    };
    feed(name);
    // Few sorts of variables, many variables.
    let mut texts = HashMap::new();
    for v in list {
        feed(&v.name);
        let sort = (v.kind, v.causality, v.variability, v.unit);
        feed(texts.entry(sort).or_insert_with(|| {
            format!("{:?} {:?} {:?} {}", v.kind, v.causality, v.variability, v.unit.map_or("", Unit::name))
        }));
    }
    let hex = format!("{hash:032x}");
    format!("{{{}-{}-{}-{}-{}}}", &hex[..8], &hex[8..12], &hex[12..16], &hex[16..20], &hex[20..])
}
