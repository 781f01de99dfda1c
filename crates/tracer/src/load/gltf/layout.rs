//! How numbers, vectors and matrices are stored.

/// How a number is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

/// How the components of one element follow each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    columns: usize,
    rows: usize,
    pub(super) component_size: usize,
    /// Columns of matrices begin at multiples of four bytes.
    column_stride: usize,
}

impl Component {
    pub(super) fn from_code(code: u64) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    pub(super) const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::I8 => "BYTE",
            Self::U8 => "UNSIGNED_BYTE",
            Self::I16 => "SHORT",
            Self::U16 => "UNSIGNED_SHORT",
            Self::U32 => "UNSIGNED_INT",
            Self::F32 => "FLOAT",
        }
    }

    /// The largest value of an integer that is stored so; it is the divisor of normalized ones.
    pub(super) const fn largest(self) -> u32 {
        match self {
            Self::I8 => i8::MAX as u32,
            Self::U8 => u8::MAX as u32,
            Self::I16 => i16::MAX as u32,
            Self::U16 => u16::MAX as u32,
            Self::U32 | Self::F32 => u32::MAX,
        }
    }

    /// The number that `bytes` begin with. Not a number if there are too few of them, which the checks exclude.
    pub(super) fn read(self, bytes: &[u8]) -> f64 {
        match self {
            Self::I8 => bytes
                .first_chunk()
                .map(|b| f64::from(i8::from_le_bytes(*b))),
            Self::U8 => bytes.first().map(|byte| f64::from(*byte)),
            Self::I16 => bytes
                .first_chunk()
                .map(|b| f64::from(i16::from_le_bytes(*b))),
            Self::U16 => bytes
                .first_chunk()
                .map(|b| f64::from(u16::from_le_bytes(*b))),
            Self::U32 => bytes
                .first_chunk()
                .map(|b| f64::from(u32::from_le_bytes(*b))),
            Self::F32 => bytes
                .first_chunk()
                .map(|b| f64::from(f32::from_le_bytes(*b))),
        }
        .unwrap_or(f64::NAN)
    }
}

impl Layout {
    pub(super) fn new(shape: &str, component: Component) -> Option<Self> {
        let (columns, rows) = match shape {
            "SCALAR" => (1, 1),
            "VEC2" => (1, 2),
            "VEC3" => (1, 3),
            "VEC4" => (1, 4),
            "MAT2" => (2, 2),
            "MAT3" => (3, 3),
            "MAT4" => (4, 4),
            _ => return None,
        };
        let component_size = component.size();
        let column_size = rows * component_size;
        let column_stride = if columns > 1 {
            column_size.next_multiple_of(4)
        } else {
            column_size
        };
        Some(Self {
            columns,
            rows,
            component_size,
            column_stride,
        })
    }

    /// The layout of single numbers.
    pub(super) const fn scalar(component: Component) -> Self {
        Self {
            columns: 1,
            rows: 1,
            component_size: component.size(),
            column_stride: component.size(),
        }
    }

    pub(super) const fn is_matrix(self) -> bool {
        self.columns > 1
    }

    pub(super) const fn components(self) -> usize {
        self.columns * self.rows
    }

    /// The distance of elements that follow each other without a gap.
    pub(super) const fn packed_stride(self) -> usize {
        self.columns * self.column_stride
    }

    /// The bytes of one element without the padding after its last column.
    pub(super) const fn size(self) -> usize {
        (self.columns - 1) * self.column_stride + self.rows * self.component_size
    }

    /// The bytes that a number of elements take up.
    pub(super) fn extent(self, count: u64, stride: usize) -> Option<u64> {
        let Some(gaps) = count.checked_sub(1) else {
            return Some(0);
        };
        gaps.checked_mul(stride as u64)?
            .checked_add(self.size() as u64)
    }

    pub(super) const fn offset_of(self, component: usize) -> usize {
        component / self.rows * self.column_stride + component % self.rows * self.component_size
    }
}
