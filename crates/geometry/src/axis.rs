//! The three coordinate axes.

/// A coordinate axis. Its number (`axis as usize`) indexes a vector's components.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Axis {
    /// The x axis, number 0.
    X = 0,
    /// The y axis, number 1.
    Y = 1,
    /// The z axis, number 2.
    Z = 2,
}

impl Axis {
    /// The three axes in order.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// The direction of the axis.
    #[must_use]
    pub const fn unit_vector(self) -> glam::Vec3 {
        match self {
            Self::X => glam::Vec3::X,
            Self::Y => glam::Vec3::Y,
            Self::Z => glam::Vec3::Z,
        }
    }

    /// The axis that follows in the cycle x, y, z, x.
    #[must_use]
    pub const fn next(self) -> Self {
        match self {
            Self::X => Self::Y,
            Self::Y => Self::Z,
            Self::Z => Self::X,
        }
    }

    /// The axes in cyclic order, this one last.
    #[inline]
    pub(crate) const fn around(self) -> [Self; 3] {
        [self.next(), self.next().next(), self]
    }

    /// The axis of the component with the largest magnitude; the first one on a tie.
    #[must_use]
    pub fn dominant(vector: glam::Vec3) -> Self {
        let magnitude = vector.abs();
        if magnitude.x >= magnitude.y && magnitude.x >= magnitude.z {
            Self::X
        } else if magnitude.y >= magnitude.z {
            Self::Y
        } else {
            Self::Z
        }
    }
}
