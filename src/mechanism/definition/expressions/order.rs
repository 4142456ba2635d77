//! The order of expressions: each behind those that it reads.
use super::Calculated;
use crate::format::DefinitionError;
use std::collections::HashMap;

/// The expressions in an order in which each stands behind those that it reads. `names`: indices of the parameters.
///
/// # Errors
/// Expressions that read one another in a circle.
pub(super) fn ordered(
    calculated: Vec<Calculated>,
    names: &HashMap<String, usize>,
) -> Result<Vec<Calculated>, DefinitionError> {
    let of: HashMap<usize, usize> = calculated.iter().enumerate().map(|(place, one)| (one.index, place)).collect();
    let reads: Vec<Vec<usize>> = calculated
        .iter()
        .map(|one| one.expression.names().iter().filter_map(|name| of.get(names.get(name)?).copied()).collect())
        .collect();
    let mut readers = vec![Vec::new(); calculated.len()];
    let mut missing: Vec<usize> = reads.iter().map(Vec::len).collect();
    for (reader, read) in reads.iter().enumerate() {
        read.iter().for_each(|&one| readers[one].push(reader));
    }
    let mut order: Vec<usize> = (0..calculated.len()).filter(|&one| missing[one] == 0).collect();
    let mut next = 0;
    while let Some(&one) = order.get(next) {
        next += 1;
        for &reader in &readers[one] {
            missing[reader] -= 1;
            if missing[reader] == 0 {
                order.push(reader);
            }
        }
    }
    if let Some(first) = (0..calculated.len()).find(|&one| missing[one] > 0) {
        // Each of the rest reads another one of the rest, so that the way ends in a circle.
        let mut way = vec![first];
        let circle = loop {
            let last = way[way.len() - 1];
            let Some(&read) = reads[last].iter().find(|&&read| missing[read] > 0) else { break &way[..] };
            if let Some(start) = way.iter().position(|&one| one == read) {
                way.push(read);
                break &way[start..];
            }
            way.push(read);
        };
        let names: Vec<&str> = circle.iter().map(|&one| calculated[one].name.as_str()).collect();
        let one = &calculated[circle[0]];
        let why = format!(
            "\"{}\": the values refer to each other in a circle ({}): write a number for one of these values",
            one.text(),
            names.join(" reads ")
        );
        return Err(DefinitionError::key(&one.key, why));
    }
    let mut all: Vec<Option<Calculated>> = calculated.into_iter().map(Some).collect();
    Ok(order.into_iter().filter_map(|one| all[one].take()).collect())
}
