//! Lists sorted by a number of each element. All types share one sort, for lists that are short or sorted once. The
//! sort of another type would add about 10 kB to the library.

/// Sorts numbers, ascending.
#[inline(never)]
pub fn sort(numbers: &mut [f64]) {
    numbers.sort_unstable_by(f64::total_cmp);
}

/// Indices of keys in ascending order. Equal keys keep their order.
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

/// Indices of values in ascending order. Equal values keep their order.
pub fn ascending(values: &[f64]) -> Vec<usize> {
    in_order(values.iter().map(|value| key(*value)))
}

/// A list sorted by a number of each element, ascending. Elements with equal numbers keep their order.
pub fn sorted<T>(list: Vec<T>, number: impl Fn(&T) -> f64) -> Vec<T> {
    let order = in_order(list.iter().map(|element| key(number(element))));
    reordered(list, order)
}

/// A list sorted by two indices of each element, first by the first index, then by the second. Elements with equal
/// indices keep their order. Each index is below 2^32.
pub fn sorted_by_pair<T>(list: Vec<T>, pair: impl Fn(&T) -> (usize, usize)) -> Vec<T> {
    let key = |(first, second): (usize, usize)| (first as u64) << 32 | second as u64;
    let order = in_order(list.iter().map(|element| key(pair(element))));
    reordered(list, order)
}

/// The elements of a list in the order of these indices.
fn reordered<T>(list: Vec<T>, order: Vec<usize>) -> Vec<T> {
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
    fn keys_have_the_order_of_their_values() {
        let infinite = f64::INFINITY;
        let values = [-f64::NAN, -infinite, -1.5, -1.0, -0.0, 0.0, f64::MIN_POSITIVE, 1.0, infinite, f64::NAN];
        assert!(values.is_sorted_by(|a, b| key(*a) < key(*b) && a.total_cmp(b).is_lt()));
        let pairs = [(0, 7), (1, 0), (1, 1), (2, 0)];
        assert_eq!(sorted_by_pair(pairs.into_iter().rev().collect(), |pair| *pair), pairs);
    }
}
