//! Devices and scenes of Embree, safe to use.

use std::ffi::{CString, c_int, c_void};
use std::path::Path;
use std::sync::atomic::{AtomicIsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use anyhow::{Context, Result, ensure};
use tahko_tracer::geometry::TriangleMesh;

use super::denormals::FlushDenormals;
use super::ffi::{self, Functions};

/// The library with its devices, which live as long as the program.
#[derive(Debug)]
pub(super) struct Embree {
    pub(super) functions: Functions,
    devices: Mutex<Vec<&'static Device>>,
    /// Rays of the widest packet for which the library has code of its own on this processor.
    pub(super) packet: usize,
}

#[derive(Debug)]
pub(super) struct Device {
    pub(super) handle: ffi::Device,
    threads: usize,
    /// What the library has allocated and not freed.
    bytes: AtomicIsize,
    /// Held while a scene is built, so that `bytes` tells what one scene needs.
    building: Mutex<()>,
}

// SAFETY: Embree's devices may be used by several threads.
unsafe impl Send for Device {}
// SAFETY: as above.
unsafe impl Sync for Device {}

impl Embree {
    /// Loads the library and makes the device for one thread, before any for more: see [`Self::device`].
    pub(super) fn load(path: &Path) -> Result<Self> {
        let mut embree = Self {
            functions: Functions::load(path)?,
            devices: Mutex::default(),
            packet: 1,
        };
        let device = embree.device(1)?;
        ensure!(
            embree.property(device, ffi::PROPERTY_VERSION_MAJOR) == 4,
            "it is not Embree 4"
        );
        let packets = [
            (16, ffi::PROPERTY_NATIVE_RAY16),
            (8, ffi::PROPERTY_NATIVE_RAY8),
        ];
        let native = packets
            .iter()
            .find(|(_, property)| embree.property(device, *property) != 0);
        embree.packet = native.map_or(1, |(rays, _)| *rays);
        Ok(embree)
    }

    fn property(&self, device: &Device, property: c_int) -> isize {
        // SAFETY: the device lives as long as the program.
        unsafe { (self.functions.device_property)(device.handle, property) }
    }

    fn error(&self, device: ffi::Device) -> c_int {
        // SAFETY: the device lives as long as the program, or is null, which stands for the error of this thread.
        unsafe { (self.functions.device_error)(device) }
    }

    /// The device whose builds use so many threads.
    ///
    /// A device builds in a task arena of its own. The size of the arena is the largest number of threads of all devices that exist when it
    /// is made: a device for few threads must be older than those for more.
    pub(super) fn device(&self, threads: usize) -> Result<&'static Device> {
        let mut devices = locked(&self.devices);
        if let Some(device) = devices.iter().find(|device| device.threads == threads) {
            return Ok(device);
        }
        let most = devices.iter().map(|device| device.threads).max();
        ensure!(
            most.is_none_or(|most| most < threads),
            "Embree can no longer be limited to {threads} threads, after it was given more"
        );
        let config = CString::new(format!("threads={threads}")).context("a text without zeros")?;
        // SAFETY: the text ends with a zero and is read during the call.
        let handle = unsafe { (self.functions.new_device)(config.as_ptr()) };
        ensure!(
            !handle.0.is_null(),
            "Embree makes no device: error {}",
            self.error(handle)
        );
        let device: &'static Device = Box::leak(Box::new(Device {
            handle,
            threads,
            bytes: AtomicIsize::new(0),
            building: Mutex::new(()),
        }));
        let counter = (&raw const device.bytes).cast_mut().cast::<c_void>();
        // SAFETY: the counter lives as long as the program, and `count_bytes` takes it for what it is.
        unsafe { (self.functions.set_memory_monitor)(handle, count_bytes, counter) };
        devices.push(device);
        Ok(device)
    }
}

/// Adds to the counter of a device what it allocates, and takes off what it frees.
///
/// # Safety
/// `counter` points to an `AtomicIsize`.
unsafe extern "C" fn count_bytes(counter: *mut c_void, bytes: isize, _is_done: bool) -> bool {
    // SAFETY: `Embree::device` gives a counter that lives as long as the program.
    let counter = unsafe { &*counter.cast::<AtomicIsize>() };
    counter.fetch_add(bytes, Ordering::Relaxed);
    true
}

/// A lock that cannot be left in a bad state by a panic.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// How a scene is built.
#[derive(Clone, Copy, Debug)]
pub(super) struct Settings {
    pub(super) flags: c_int,
    pub(super) quality: c_int,
}

/// A built scene of one mesh.
#[derive(Debug)]
pub(super) struct Scene {
    pub(super) embree: &'static Embree,
    pub(super) handle: ffi::Scene,
    /// What the library holds for it.
    pub(super) bytes: usize,
    /// The library keeps pointers to these. A vertex has four numbers, since the library may read 16 bytes at once.
    vertices: Vec<[f32; 4]>,
    indices: Vec<[u32; 3]>,
}

// SAFETY: Embree's objects may be used and released by any thread.
unsafe impl Send for Scene {}
// SAFETY: a committed scene, which is not changed again, may be asked by several threads.
unsafe impl Sync for Scene {}

impl Scene {
    /// Builds a scene with at most so many threads.
    pub(super) fn build(
        embree: &'static Embree,
        mesh: &TriangleMesh,
        settings: Settings,
        threads: usize,
    ) -> Result<Self> {
        let vertices: Vec<[f32; 4]> = mesh
            .vertices()
            .iter()
            .map(|vertex| vertex.extend(0.0).to_array())
            .collect();
        let indices = mesh.indices().to_vec();
        let device = embree.device(threads)?;
        let _building = locked(&device.building);
        let _flush = FlushDenormals::new();
        let bytes_before = device.bytes.load(Ordering::Relaxed);
        let functions = &embree.functions;
        // SAFETY: the device lives as long as the program.
        let handle = unsafe { (functions.new_scene)(device.handle) };
        let mut scene = Self {
            embree,
            handle,
            bytes: 0,
            vertices,
            indices,
        };
        scene.attach_mesh(device);
        // SAFETY: the scene was made above and belongs to this thread until it is returned.
        unsafe {
            (functions.set_scene_flags)(handle, settings.flags);
            (functions.set_build_quality)(handle, settings.quality);
            // The build runs in the arena of the device. `rtcCommitScene` would leave it to the arena of the calling thread, whose limit is
            // that of all devices together.
            (functions.join_commit_scene)(handle);
        }
        let error = embree.error(device.handle);
        ensure!(
            error == ffi::ERROR_NONE,
            "Embree cannot build the scene: error {error}"
        );
        let bytes = device.bytes.load(Ordering::Relaxed) - bytes_before;
        scene.bytes = usize::try_from(bytes).unwrap_or(0);
        Ok(scene)
    }

    fn attach_mesh(&self, device: &Device) {
        let functions = &self.embree.functions;
        let set_buffer = functions.set_shared_buffer;
        let vertices = self.vertices.as_ptr().cast();
        let indices = self.indices.as_ptr().cast();
        // SAFETY: the buffers have the formats, strides and lengths that are given, every index is that of a vertex, and they stay where they
        // are until `self` releases the scene, which holds the last reference to the geometry.
        unsafe {
            let geometry = (functions.new_geometry)(device.handle, ffi::GEOMETRY_TRIANGLE);
            let (stride, count) = (size_of::<[f32; 4]>(), self.vertices.len());
            set_buffer(
                geometry,
                ffi::BUFFER_VERTEX,
                0,
                ffi::FORMAT_FLOAT3,
                vertices,
                0,
                stride,
                count,
            );
            let (stride, count) = (size_of::<[u32; 3]>(), self.indices.len());
            set_buffer(
                geometry,
                ffi::BUFFER_INDEX,
                0,
                ffi::FORMAT_UINT3,
                indices,
                0,
                stride,
                count,
            );
            (functions.commit_geometry)(geometry);
            (functions.attach_geometry)(self.handle, geometry);
            (functions.release_geometry)(geometry);
        }
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        // SAFETY: made by `build`, and released only here.
        unsafe { (self.embree.functions.release_scene)(self.handle) };
    }
}
