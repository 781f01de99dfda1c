//! The part of Embree 4's C interface that is used: layouts, constants, and functions found at run time.
//!
//! Source: the documentation of the Embree 4 API, <https://github.com/RenderKit/embree>. Layouts are those of a library built with its
//! default of one instance level, as distributed.

use std::ffi::{c_char, c_int, c_uint, c_void};
use std::path::Path;

use anyhow::{Context, Result};
use libloading::Library;

/// Reference-counted objects of the library.
#[repr(transparent)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Device(pub(super) *mut c_void);

#[repr(transparent)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Scene(pub(super) *mut c_void);

#[repr(transparent)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Geometry(pub(super) *mut c_void);

#[repr(transparent)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Hierarchy(pub(super) *mut c_void);

pub(super) const INVALID_ID: u32 = u32::MAX;

pub(super) const PROPERTY_VERSION_MAJOR: c_int = 1;
pub(super) const PROPERTY_NATIVE_RAY8: c_int = 33;
pub(super) const PROPERTY_NATIVE_RAY16: c_int = 34;
pub(super) const ERROR_NONE: c_int = 0;
pub(super) const GEOMETRY_TRIANGLE: c_int = 0;
pub(super) const BUFFER_INDEX: c_int = 0;
pub(super) const BUFFER_VERTEX: c_int = 1;
pub(super) const FORMAT_UINT3: c_int = 0x5003;
pub(super) const FORMAT_FLOAT3: c_int = 0x9003;
pub(super) const SCENE_NONE: c_int = 0;
pub(super) const SCENE_ROBUST: c_int = 1 << 2;
pub(super) const BUILD_MEDIUM: c_int = 1;
pub(super) const BUILD_HIGH: c_int = 2;

/// `RTCRay`.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    pub(super) origin: [f32; 3],
    pub(super) t_near: f32,
    pub(super) direction: [f32; 3],
    pub(super) time: f32,
    pub(super) t_far: f32,
    pub(super) mask: c_uint,
    pub(super) id: c_uint,
    pub(super) flags: c_uint,
}

/// `RTCHit`.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    pub(super) normal: [f32; 3],
    pub(super) u: f32,
    pub(super) v: f32,
    pub(super) primitive: c_uint,
    pub(super) geometry: c_uint,
    pub(super) instance: c_uint,
    pub(super) instance_primitive: c_uint,
}

/// `RTCRayHit`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub(super) struct RayHit {
    pub(super) ray: Ray,
    pub(super) hit: Hit,
}

/// `RTCRay8` and `RTCRay16`; the larger alignment of the second does for both.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug)]
pub(super) struct RayPacket<const N: usize> {
    pub(super) origin: [[f32; N]; 3],
    pub(super) t_near: [f32; N],
    pub(super) direction: [[f32; N]; 3],
    pub(super) time: [f32; N],
    pub(super) t_far: [f32; N],
    pub(super) mask: [c_uint; N],
    pub(super) id: [c_uint; N],
    pub(super) flags: [c_uint; N],
}

/// `RTCHit8` and `RTCHit16`.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug)]
pub(super) struct HitPacket<const N: usize> {
    pub(super) normal: [[f32; N]; 3],
    pub(super) u: [f32; N],
    pub(super) v: [f32; N],
    pub(super) primitive: [c_uint; N],
    pub(super) geometry: [c_uint; N],
    pub(super) instance: [c_uint; N],
    pub(super) instance_primitive: [c_uint; N],
}

/// `RTCRayHit8` and `RTCRayHit16`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub(super) struct RayHitPacket<const N: usize> {
    pub(super) ray: RayPacket<N>,
    pub(super) hit: HitPacket<N>,
}

/// Which rays of a packet are traced: -1 for yes, 0 for no.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug)]
pub(super) struct Valid<const N: usize>(pub(super) [c_int; N]);

/// `RTCIntersectArguments`. The last field is there only in some builds of the library; the others do not read it.
#[repr(C)]
#[derive(Debug)]
pub(super) struct Arguments {
    pub(super) flags: c_int,
    pub(super) features: c_uint,
    pub(super) context: *mut c_void,
    pub(super) filter: *const c_void,
    pub(super) intersect: *const c_void,
    pub(super) minimum_width_factor: f32,
}

impl Arguments {
    /// For rays of a packet that run together.
    pub(super) const COHERENT: Self = Self {
        flags: 1 << 16,
        features: u32::MAX,
        context: std::ptr::null_mut(),
        filter: std::ptr::null(),
        intersect: std::ptr::null(),
        minimum_width_factor: 0.0,
    };
}

/// `RTCBuildPrimitive`.
#[repr(C, align(32))]
#[derive(Clone, Copy, Debug)]
pub(super) struct BuildPrimitive {
    pub(super) lower: [f32; 3],
    pub(super) geometry: c_uint,
    pub(super) upper: [f32; 3],
    pub(super) primitive: c_uint,
}

/// `RTCBounds`; the fourth numbers are there for the alignment.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) lower: [f32; 4],
    pub(super) upper: [f32; 4],
}

/// `RTCBuildArguments`.
#[repr(C)]
#[derive(Debug)]
pub(super) struct BuildArguments {
    pub(super) byte_size: usize,
    pub(super) quality: c_int,
    pub(super) flags: c_int,
    pub(super) max_branching_factor: c_uint,
    pub(super) max_depth: c_uint,
    pub(super) sah_block_size: c_uint,
    pub(super) min_leaf_size: c_uint,
    pub(super) max_leaf_size: c_uint,
    pub(super) traversal_cost: f32,
    pub(super) intersection_cost: f32,
    pub(super) hierarchy: Hierarchy,
    pub(super) primitives: *mut BuildPrimitive,
    pub(super) primitive_count: usize,
    pub(super) primitive_capacity: usize,
    pub(super) create_node: unsafe extern "C" fn(*mut c_void, c_uint, *mut c_void) -> *mut c_void,
    pub(super) set_node_children:
        unsafe extern "C" fn(*mut c_void, *const *mut c_void, c_uint, *mut c_void),
    pub(super) set_node_bounds:
        unsafe extern "C" fn(*mut c_void, *const *const Bounds, c_uint, *mut c_void),
    pub(super) create_leaf:
        unsafe extern "C" fn(*mut c_void, *const BuildPrimitive, usize, *mut c_void) -> *mut c_void,
    pub(super) split_primitive: unsafe extern "C" fn(
        *const BuildPrimitive,
        c_uint,
        f32,
        *mut Bounds,
        *mut Bounds,
        *mut c_void,
    ),
    pub(super) progress: *const c_void,
    pub(super) user: *mut c_void,
}

const _: () = {
    assert!(size_of::<BuildPrimitive>() == 32, "RTCBuildPrimitive");
    assert!(size_of::<Bounds>() == 32, "RTCBounds");
    assert!(size_of::<Ray>() == 48 && align_of::<Ray>() == 16, "RTCRay");
    assert!(size_of::<Hit>() == 48 && align_of::<Hit>() == 16, "RTCHit");
    assert!(
        size_of::<RayHit>() == 96 && align_of::<RayHit>() == 16,
        "RTCRayHit"
    );
    assert!(size_of::<RayPacket<8>>() == 12 * 32, "RTCRay8");
    assert!(
        std::mem::offset_of!(RayHitPacket<8>, hit) == 12 * 32,
        "RTCRayHit8"
    );
    assert!(size_of::<RayPacket<16>>() == 12 * 64, "RTCRay16");
    assert!(size_of::<HitPacket<16>>() == 9 * 64, "RTCHit16");
    assert!(size_of::<RayHitPacket<16>>() == 21 * 64, "RTCRayHit16");
    assert!(align_of::<RayHitPacket<16>>() == 64, "RTCRayHit16");
    assert!(
        std::mem::offset_of!(Arguments, filter) == 8 + size_of::<usize>(),
        "RTCIntersectArguments"
    );
};

/// `RTCMemoryMonitorFunction`.
pub(super) type MemoryMonitor = unsafe extern "C" fn(*mut c_void, isize, bool) -> bool;

type IntersectPacket<const N: usize> =
    unsafe extern "C" fn(*const Valid<N>, Scene, *mut RayHitPacket<N>, *const Arguments);
type OccludedPacket<const N: usize> =
    unsafe extern "C" fn(*const Valid<N>, Scene, *mut RayPacket<N>, *const Arguments);

/// Declares the functions and how all of them are found.
macro_rules! functions {
    ($($name:ident = $symbol:literal: $kind:ty;)*) => {
        /// The functions. Their obligations are those of the C interface.
        #[derive(Debug)]
        pub(super) struct Functions {
            $(pub(super) $name: $kind,)*
            /// Keeps the functions in memory.
            _library: Library,
        }

        impl Functions {
            fn find(library: Library) -> Result<Self> {
                Ok(Self {
                    // SAFETY: the symbol has this type in the interface of Embree 4, and `_library` outlives the pointer.
                    $($name: *unsafe { library.get::<$kind>($symbol) }.context("it is not Embree 4")?,)*
                    _library: library,
                })
            }
        }
    };
}

functions! {
    new_device = b"rtcNewDevice\0": unsafe extern "C" fn(*const c_char) -> Device;
    device_property = b"rtcGetDeviceProperty\0": unsafe extern "C" fn(Device, c_int) -> isize;
    device_error = b"rtcGetDeviceError\0": unsafe extern "C" fn(Device) -> c_int;
    set_memory_monitor = b"rtcSetDeviceMemoryMonitorFunction\0": unsafe extern "C" fn(Device, MemoryMonitor, *mut c_void);
    new_scene = b"rtcNewScene\0": unsafe extern "C" fn(Device) -> Scene;
    release_scene = b"rtcReleaseScene\0": unsafe extern "C" fn(Scene);
    set_scene_flags = b"rtcSetSceneFlags\0": unsafe extern "C" fn(Scene, c_int);
    set_build_quality = b"rtcSetSceneBuildQuality\0": unsafe extern "C" fn(Scene, c_int);
    join_commit_scene = b"rtcJoinCommitScene\0": unsafe extern "C" fn(Scene);
    new_geometry = b"rtcNewGeometry\0": unsafe extern "C" fn(Device, c_int) -> Geometry;
    set_shared_buffer = b"rtcSetSharedGeometryBuffer\0":
        unsafe extern "C" fn(Geometry, c_int, c_uint, c_int, *const c_void, usize, usize, usize);
    commit_geometry = b"rtcCommitGeometry\0": unsafe extern "C" fn(Geometry);
    attach_geometry = b"rtcAttachGeometry\0": unsafe extern "C" fn(Scene, Geometry) -> c_uint;
    release_geometry = b"rtcReleaseGeometry\0": unsafe extern "C" fn(Geometry);
    new_hierarchy = b"rtcNewBVH\0": unsafe extern "C" fn(Device) -> Hierarchy;
    build_hierarchy = b"rtcBuildBVH\0": unsafe extern "C" fn(*const BuildArguments) -> *mut c_void;
    release_hierarchy = b"rtcReleaseBVH\0": unsafe extern "C" fn(Hierarchy);
    intersect1 = b"rtcIntersect1\0": unsafe extern "C" fn(Scene, *mut RayHit, *const Arguments);
    occluded1 = b"rtcOccluded1\0": unsafe extern "C" fn(Scene, *mut Ray, *const Arguments);
    intersect8 = b"rtcIntersect8\0": IntersectPacket<8>;
    occluded8 = b"rtcOccluded8\0": OccludedPacket<8>;
    intersect16 = b"rtcIntersect16\0": IntersectPacket<16>;
    occluded16 = b"rtcOccluded16\0": OccludedPacket<16>;
}

impl Functions {
    /// Loads the library.
    pub(super) fn load(path: &Path) -> Result<Self> {
        // SAFETY: what the library does when it is loaded is its authors' affair: the user names it, or it is the one that
        // `cargo xtask peers` installed. Embree's own initialisers have no preconditions.
        let library = unsafe { Library::new(path) }?;
        Self::find(library)
    }
}
