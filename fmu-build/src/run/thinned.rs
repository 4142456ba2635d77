//! Some of the items of a series whose length is not known: equally spaced, from the first on, in constant memory.
//!
//! In: items in order. Out: those that are kept. It must not know what an item is.

/// The items that are kept. Of more than there is room for, every second one is dropped.
pub struct Thinned<T> {
    items: Vec<T>,
    /// Room, an even number, so that those kept stay equally spaced.
    room: usize,
    /// Of how many items one is kept.
    stride: u64,
    /// Number of items seen.
    seen: u64,
}

impl<T> Thinned<T> {
    /// No items yet; at most `room` / 2 + 1 of `room` or more will be kept at least.
    pub fn new(room: usize) -> Self {
        Self { items: Vec::new(), room: room.next_multiple_of(2), stride: 1, seen: 0 }
    }

    /// Whether the next item is to be kept; the next question is about the one after it.
    pub fn wants_next(&mut self) -> bool {
        let is_wanted = self.seen.is_multiple_of(self.stride);
        self.seen += 1;
        is_wanted
    }

    /// Keep an item that [`Self::wants_next`] wanted.
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

    /// The items that are kept.
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
