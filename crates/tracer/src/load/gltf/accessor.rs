//! Arrays of numbers in buffers: laid out with gaps, as integers or floats, in part replaced by sparse values.
//!
//! An [`Accessor`] exists only if all that it may read is there, so reading it cannot fail.

use gltf::json::Value;

use super::buffers::{View, part};
use super::fault::{Fault, element_name, integer, items, reference, require};
use super::layout::{Component, Layout};

/// An accessor without a buffer view consists of zeros, of which a file of a few bytes can ask for any number. Larger
/// ones than this are refused; real ones hold a handful of sparse values.
const MAX_IMPLICIT_ELEMENTS: u64 = 1 << 24;

/// A checked array of vectors, matrices or scalars.
#[derive(Clone, Debug)]
pub(super) struct Accessor<'a> {
    /// The name for messages.
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) component: Component,
    /// `SCALAR`, `VEC2`, ... as in the file.
    pub(super) shape: &'a str,
    pub(super) normalized: bool,
    pub(super) min: Option<Vec<f64>>,
    pub(super) max: Option<Vec<f64>>,
    layout: Layout,
    /// Starts at the first element; empty where all elements are zero.
    data: &'a [u8],
    stride: usize,
    sparse: Option<Sparse<'a>>,
}

/// Elements that replace others.
#[derive(Clone, Debug)]
struct Sparse<'a> {
    /// The numbers of the replaced elements, strictly increasing.
    indices: Vec<usize>,
    values: &'a [u8],
    stride: usize,
}

/// The accessors of a file.
///
/// # Errors
/// If one reads over the end of its view, is not aligned, or has a format that makes no sense.
pub(super) fn accessors<'a>(
    json: &'a Value,
    views: &[View<'a>],
) -> Result<Vec<Accessor<'a>>, Fault> {
    items(json, "accessors")
        .iter()
        .enumerate()
        .map(|(index, json)| Accessor::new(index, json, views))
        .collect()
}

impl<'a> Accessor<'a> {
    fn new(index: usize, json: &'a Value, views: &[View<'a>]) -> Result<Self, Fault> {
        let name = element_name("accessor", index, json);
        let shape = json.get("type").and_then(Value::as_str).unwrap_or_default();
        let component = integer(json, "componentType").and_then(Component::from_code);
        let (Some(component), Some(count)) = (component, integer(json, "count")) else {
            return Err(Fault::invalid(name, "its format is missing"));
        };
        let layout = Layout::new(shape, component)
            .ok_or_else(|| Fault::invalid(&name, format!("the type '{shape}' does not exist")))?;
        let normalized = json.get("normalized").and_then(Value::as_bool) == Some(true);
        require(!normalized || component.size() < 4, &name, || {
            format!("{} cannot be normalized", component.name())
        })?;
        let view_index = reference(json, "bufferView");
        let offset = integer(json, "byteOffset");
        let (data, stride) = match view_index.and_then(|index| views.get(index)) {
            Some(view) => base_data(layout, view, offset.unwrap_or(0), count, &name)?,
            None => {
                require(
                    offset.unwrap_or(0) == 0,
                    &name,
                    || "it has a byteOffset but no bufferView",
                )?;
                require(count <= MAX_IMPLICIT_ELEMENTS, &name, || {
                    format!("{count} elements without a buffer view are too many")
                })?;
                (&[][..], layout.packed_stride())
            }
        };
        let sparse = json
            .get("sparse")
            .map(|sparse| Sparse::new(sparse, layout, count, views, &name))
            .transpose()?;
        Ok(Self {
            count: usize::try_from(count).unwrap_or(usize::MAX),
            component,
            shape,
            normalized,
            min: bounds(json, "min", layout, &name)?,
            max: bounds(json, "max", layout, &name)?,
            layout,
            data,
            stride,
            sparse,
            name,
        })
    }

    /// Whether there are values to read besides implied zeros.
    pub(super) const fn has_data(&self) -> bool {
        !self.data.is_empty() || self.sparse.is_some()
    }

    pub(super) const fn components(&self) -> usize {
        self.layout.components()
    }

    /// The bytes from one element to the next.
    pub(super) const fn stride(&self) -> usize {
        self.stride
    }

    /// A component of an element as it is stored: column by column for matrices. Zero out of range.
    pub(super) fn stored(&self, element: usize, component: usize) -> f64 {
        let (bytes, start) = match &self.sparse {
            Some(sparse) => match sparse.indices.binary_search(&element) {
                Ok(position) => (sparse.values, position * sparse.stride),
                Err(_) => (self.data, element * self.stride),
            },
            None => (self.data, element * self.stride),
        };
        if bytes.is_empty() {
            return 0.0;
        }
        let start = start + self.layout.offset_of(component);
        self.component.read(bytes.get(start..).unwrap_or_default())
    }

    /// A component of an element, with normalized integers as fractions.
    pub(super) fn value(&self, element: usize, component: usize) -> f64 {
        let stored = self.stored(element, component);
        if self.normalized {
            (stored / f64::from(self.component.largest())).max(-1.0)
        } else {
            stored
        }
    }

    /// The first components of an element, with normalized integers as fractions, rounded to f32.
    pub(super) fn vector<const N: usize>(&self, element: usize) -> [f32; N] {
        #[expect(clippy::cast_possible_truncation, reason = "f32 is what scenes hold")]
        std::array::from_fn(|component| self.value(element, component) as f32)
    }

    /// An element of an array of indices.
    pub(super) fn index(&self, element: usize) -> u32 {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a stored unsigned integer"
        )]
        let index = self.stored(element, 0) as u32;
        index
    }
}

/// The bytes from the first element on, and the distance between elements.
fn base_data<'a>(
    layout: Layout,
    view: &View<'a>,
    offset: u64,
    count: u64,
    name: &str,
) -> Result<(&'a [u8], usize), Fault> {
    let alignment = layout.component_size as u64;
    require(offset.is_multiple_of(alignment), name, || {
        format!("its byteOffset of {offset} is not a multiple of its component size {alignment}")
    })?;
    require(
        !layout.is_matrix() || offset.is_multiple_of(4),
        name,
        || format!("its byteOffset of {offset} is not a multiple of 4, as matrices need"),
    )?;
    // Alignments are powers of two, so that wrapping around does not change remainders.
    let start = (view.offset as u64).wrapping_add(offset);
    require(start.is_multiple_of(alignment), name, || {
        format!("its data does not begin at a multiple of its component size {alignment}")
    })?;
    let stride = view.stride.unwrap_or(layout.packed_stride());
    require(stride >= layout.size(), name, || {
        format!(
            "an element has {} bytes, more than the stride of {stride}",
            layout.size()
        )
    })?;
    require((stride as u64).is_multiple_of(alignment), name, || {
        format!("the stride of {stride} is not a multiple of its component size {alignment}")
    })?;
    let data = layout
        .extent(count, stride)
        .and_then(|extent| part(view.bytes, offset, extent));
    let data = data.ok_or_else(|| {
        let reason = format!(
            "{count} elements from byte {offset} reach over the end of its buffer view of {} bytes",
            view.bytes.len()
        );
        Fault::invalid(name, reason)
    })?;
    Ok((data, stride))
}

fn bounds(
    json: &Value,
    property: &str,
    layout: Layout,
    name: &str,
) -> Result<Option<Vec<f64>>, Fault> {
    if json.get(property).is_none() {
        return Ok(None);
    }
    let bounds: Vec<f64> = items(json, property)
        .iter()
        .filter_map(Value::as_f64)
        .collect();
    require(bounds.len() == layout.components(), name, || {
        format!(
            "{property} has {} numbers for {} components",
            bounds.len(),
            layout.components()
        )
    })?;
    Ok(Some(bounds))
}

impl<'a> Sparse<'a> {
    fn new(
        json: &Value,
        layout: Layout,
        element_count: u64,
        views: &[View<'a>],
        name: &str,
    ) -> Result<Self, Fault> {
        let count = integer(json, "count").unwrap_or(0);
        require(count <= element_count, name, || {
            format!("{count} sparse values replace only {element_count} elements")
        })?;
        let null = Value::Null;
        let indices = json.get("indices").unwrap_or(&null);
        let values = json.get("values").unwrap_or(&null);
        let component = integer(indices, "componentType").and_then(Component::from_code);
        let component = component
            .ok_or_else(|| Fault::invalid(name, "its sparse indices have no componentType"))?;
        let index_layout = Layout::scalar(component);
        let index_data = sparse_data(indices, index_layout, count, views, name, "indices")?;
        let stride = layout.packed_stride();
        let values = sparse_data(values, layout, count, views, name, "values")?;
        let indices = index_data.chunks_exact(component.size()).map(|bytes| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a stored unsigned integer"
            )]
            let index = component.read(bytes) as usize;
            index
        });
        let indices: Vec<usize> = indices.collect();
        if let Some(pair) = indices.windows(2).find(|pair| pair[0] >= pair[1]) {
            let reason = format!("its sparse indices do not increase at {}", pair[1]);
            return Err(Fault::invalid(name, reason));
        }
        let last = indices.last().copied().unwrap_or(0);
        require((last as u64) < element_count, name, || {
            format!("its sparse index {last} is not below its count of {element_count}")
        })?;
        Ok(Self {
            indices,
            values,
            stride,
        })
    }
}

fn sparse_data<'a>(
    json: &Value,
    layout: Layout,
    count: u64,
    views: &[View<'a>],
    name: &str,
    what: &str,
) -> Result<&'a [u8], Fault> {
    let view = reference(json, "bufferView").and_then(|index| views.get(index));
    let view =
        view.ok_or_else(|| Fault::invalid(name, format!("its sparse {what} have no buffer view")))?;
    require(view.stride.is_none() && view.target.is_none(), name, || {
        format!("the buffer view of its sparse {what} has a byteStride or a target")
    })?;
    let view = View {
        stride: Some(layout.packed_stride()),
        ..*view
    };
    let offset = integer(json, "byteOffset").unwrap_or(0);
    let place = format!("{name}, sparse {what}");
    Ok(base_data(layout, &view, offset, count, &place)?.0)
}
