//! A selection of equally spaced items of a series of unknown length, from the first item on, in constant memory.
//!
//! In: items in order. Out: the kept items. The module must not know what an item is.

/// The kept items. If there is no room for more, every second item is dropped.
pub struct Thinned<T> {
    items: Vec<T>,
    /// Room, an even number, so that the kept items stay equally spaced.
    room: usize,
    /// Number of items of which one is kept.
    stride: u64,
    /// Number of items seen.
    seen: u64,
}

impl<T> Thinned<T> {
    /// No items yet. Of at least `room` items, at least `room` / 2 + 1 will be kept.
    pub fn new(room: usize) -> Self {
        Self { items: Vec::new(), room: room.next_multiple_of(2), stride: 1, seen: 0 }
    }

    /// Whether the next item is to be kept. The next call is about the item after it.
    pub fn wants_next(&mut self) -> bool {
        let is_wanted = self.seen.is_multiple_of(self.stride);
        self.seen += 1;
        is_wanted
    }

    /// Keep an item for which [`Self::wants_next`] was true.
    pub fn keep(&mut self, item: T) {
        if self.items.len() == self.room {
            let mut index = 0_usize;
            self.items.retain(|_| {
                index += 1;
                !index.is_multiple_of(2)
            });
            self.stride *= 2;
        }
        self.items.push(item);
    }

    /// The kept items.
    pub fn into_items(self) -> Vec<T> {
        self.items
    }
}

#[cfg(test)]
mod tests {
    use super::Thinned;

    #[test]
    fn items_are_equally_spaced_whatever_their_number() {
        for count in [1, 5, 8, 9, 16, 17, 1000, 12_345] {
            let mut thinned = Thinned::new(8);
            for item in 0..count {
                if thinned.wants_next() {
                    thinned.keep(item);
                }
            }
            let items = thinned.into_items();
            let stride = if items.len() > 1 { items[1] } else { 1 };
            assert!(items.iter().enumerate().all(|(k, item)| *item == k as u64 * stride), "{count}: {items:?}");
            assert!(count - 1 - items[items.len() - 1] < stride, "{count}: {items:?}");
            assert!(items.len() <= 8 && (items.len() >= 4 || items.len() as u64 == count), "{count}: {items:?}");
        }
    }
}
