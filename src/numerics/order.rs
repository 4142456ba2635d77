//! Lists in the order of a number that belongs to each element: one sort for all types, where lists are short or sorted
//! once. A sort of a further type is some 10 kB of the library.

/// Sort numbers, ascending.
#[inline(never)]
pub fn sort(numbers: &mut [f64]) {
    numbers.sort_unstable_by(f64::total_cmp);
}

/// Indices of keys in ascending order; equal ones stay in the order in which they stand.
fn in_order(keys: impl Iterator<Item = u64>) -> Vec<usize> {
    let mut all: Vec<(u64, usize)> = keys.zip(0..).collect();
    sort_keys(&mut all);
    all.into_iter().map(|(_, index)| index).collect()
}

#[inline(never)]
fn sort_keys(all: &mut [(u64, usize)]) {
    all.sort_unstable();
}

/// A number as a key, in the order of [`f64::total_cmp`].
fn key(value: f64) -> u64 {
    let bits = value.to_bits();
    if value.is_sign_negative() { !bits } else { bits | 1 << 63 }
}

/// Indices of values in ascending order; equal values stay in the order in which they stand.
pub fn ascending(values: &[f64]) -> Vec<usize> {
    in_order(values.iter().map(|value| key(*value)))
}

/// A list in ascending order of a number of each element; equal ones stay in the order in which they stand.
pub fn sorted<T>(list: Vec<T>, number: impl Fn(&T) -> f64) -> Vec<T> {
    let order = in_order(list.iter().map(|element| key(number(element))));
    taken(list, order)
}

/// A list in ascending order of two indices of each element, of the first, then of the second; equal ones stay in the
/// order in which they stand. Each index is below 2^32.
pub fn sorted_by_pair<T>(list: Vec<T>, pair: impl Fn(&T) -> (usize, usize)) -> Vec<T> {
    let key = |(first, second): (usize, usize)| (first as u64) << 32 | second as u64;
    let order = in_order(list.iter().map(|element| key(pair(element))));
    taken(list, order)
}

/// The elements of a list in this order of their indices.
fn taken<T>(list: Vec<T>, order: Vec<usize>) -> Vec<T> {
    let mut list: Vec<Option<T>> = list.into_iter().map(Some).collect();
    order.into_iter().filter_map(|index| list[index].take()).collect()
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

    #[test]
    fn keys_are_in_the_order_of_what_they_stand_for() {
        let infinite = f64::INFINITY;
        let values = [-f64::NAN, -infinite, -1.5, -1.0, -0.0, 0.0, f64::MIN_POSITIVE, 1.0, infinite, f64::NAN];
        assert!(values.is_sorted_by(|a, b| key(*a) < key(*b) && a.total_cmp(b).is_lt()));
        let pairs = [(0, 7), (1, 0), (1, 1), (2, 0)];
        assert_eq!(sorted_by_pair(pairs.into_iter().rev().collect(), |pair| *pair), pairs);
    }
}
