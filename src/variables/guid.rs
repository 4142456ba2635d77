//! The GUID of an interface.
use super::{Unit, Variable};
use crate::codec::checksum::fnv1a_128;

/// Hash of the model's name and of each variable's name, kind, causality, variability and unit, in the form of a GUID.
/// Start values and descriptions do not enter it.
pub(super) fn guid(name: &str, list: &[Variable]) -> String {
    let fields = list.iter().flat_map(|v| {
        let unit = v.unit.map_or("", Unit::name);
        [&v.name, "\0", v.kind.word(), " ", v.causality.word(), " ", v.variability.word(), " ", unit, "\0"]
    });
    let hex = format!("{:032x}", fnv1a_128([name, "\0"].into_iter().chain(fields)));
    format!("{{{}-{}-{}-{}-{}}}", &hex[..8], &hex[8..12], &hex[12..16], &hex[16..20], &hex[20..])
}
