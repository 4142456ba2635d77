//! Lists in the order of a number that belongs to each element: one sort for all types, where lists are short or sorted
//! once.

/// Indices of values in ascending order; equal values stay in the order in which they stand.
pub fn ascending(values: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    order
}

/// A list in ascending order of a number of each element; equal ones stay in the order in which they stand.
pub fn sorted<T>(list: Vec<T>, number: impl Fn(&T) -> f64) -> Vec<T> {
    let numbers: Vec<f64> = list.iter().map(number).collect();
    let mut list: Vec<Option<T>> = list.into_iter().map(Some).collect();
    ascending(&numbers).into_iter().filter_map(|index| list[index].take()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_elements_keep_their_order() {
        let list = vec![(2.0, 'a'), (1.0, 'b'), (2.0, 'c'), (-0.0, 'd'), (0.0, 'e'), (f64::NAN, 'f'), (1.0, 'g')];
        let letters: String = sorted(list, |(number, _)| *number).into_iter().map(|(_, letter)| letter).collect();
        assert_eq!(letters, "debgacf");
    }
}
