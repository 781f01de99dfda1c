//! The stack of the traversal.

/// Entries that most trees are content with.
const USUAL_DEPTH: usize = 64;

/// A stack without a limit that allocates only beyond [`USUAL_DEPTH`] entries.
pub(crate) struct Stack<T> {
    usual: [T; USUAL_DEPTH],
    length: usize,
    beyond: Vec<T>,
}

impl<T: Copy> Stack<T> {
    /// An empty stack; `filler` stands where there is nothing yet.
    #[inline]
    pub(crate) const fn new(filler: T) -> Self {
        Self {
            usual: [filler; USUAL_DEPTH],
            length: 0,
            beyond: Vec::new(),
        }
    }

    #[inline]
    pub(crate) fn push(&mut self, item: T) {
        if let Some(place) = self.usual.get_mut(self.length) {
            *place = item;
            self.length += 1;
        } else {
            self.beyond.push(item);
        }
    }

    #[inline]
    pub(crate) fn pop(&mut self) -> Option<T> {
        if self.length == USUAL_DEPTH
            && let Some(item) = self.beyond.pop()
        {
            return Some(item);
        }
        self.length = self.length.checked_sub(1)?;
        Some(self.usual[self.length])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_come_back_in_reverse_beyond_the_usual_depth_too() {
        let mut stack = Stack::new(0);
        for _ in 0..2 {
            for item in 0..200 {
                stack.push(item);
            }
            let items: Vec<i32> = std::iter::from_fn(|| stack.pop()).collect();
            assert!(items.iter().copied().eq((0..200).rev()), "{items:?}");
        }
    }
}
