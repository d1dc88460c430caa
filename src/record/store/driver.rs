//! Virtual file driver (VFD) for the HDF5 library that makes every flush an atomic commit, see [`super::journal`].
#![allow(unsafe_code)]

use std::ffi::{CStr, CString, OsStr, c_char, c_int, c_uint, c_ulong, c_void};
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::ptr;
use std::sync::OnceLock;

use hdf5::plist::FileAccess;
use hdf5_sys::h5f::{H5F_ACC_RDWR, H5Fopen};
use hdf5_sys::h5fd::{
    H5FD_FEAT_ACCUMULATE_METADATA, H5FD_FEAT_AGGREGATE_METADATA, H5FD_FEAT_AGGREGATE_SMALLDATA, H5FD_FEAT_DATA_SIEVE,
    H5FDregister,
};
use hdf5_sys::h5i::hid_t;
use hdf5_sys::h5p::H5Pset_driver;

use super::journal::Journaled;

/// Opens a file for reading and writing.
pub(super) fn open_rw(path: &Path) -> hdf5::Result<hdf5::File> {
    // Each chunk is written once and completely, so that a cache would only delay its compression until the flush.
    let access = FileAccess::build().chunk_cache(1, 0, 1.0).finish()?;
    let name = CString::new(path.as_os_str().as_bytes()).map_err(|e| e.to_string())?;
    hdf5::sync::sync(|| {
        // SAFETY: the property list lives through both calls, and the driver as long as the library; the name ends with
        // a zero byte, and the id of the opened file has one owner.
        unsafe {
            hdf5::h5check(H5Pset_driver(access.id(), driver()?, ptr::null()))?;
            hdf5::from_id(hdf5::h5check(H5Fopen(name.as_ptr(), H5F_ACC_RDWR, access.id()))?)
        }
    })
}

/// Returns the id of the driver, which is registered once.
fn driver() -> hdf5::Result<hid_t> {
    static DRIVER: OnceLock<hid_t> = OnceLock::new();
    // SAFETY: the library copies the class, whose layout it checks by its version; the name is static.
    let id = *DRIVER.get_or_init(|| unsafe { H5FDregister(ptr::from_ref(&CLASS.0).cast()) });
    if id < 0 { Err("the HDF5 library refuses the file driver".into()) } else { Ok(id) }
}

/// `H5FD_class_t` of HDF5 2, class version 1. Members that are `None` are optional.
#[repr(C)]
struct Class {
    version: c_uint,
    value: c_int,
    name: *const c_char,
    largest_address: u64,
    close_degree: c_int,
    terminate: Option<extern "C" fn()>,
    superblock: [Option<extern "C" fn()>; 3],
    access_size: usize,
    access: [Option<extern "C" fn()>; 3],
    transfer_size: usize,
    transfer: [Option<extern "C" fn()>; 2],
    open: extern "C" fn(*const c_char, c_uint, hid_t, u64) -> *mut Handle,
    close: extern "C" fn(*mut Handle) -> c_int,
    compare: Option<extern "C" fn()>,
    query: extern "C" fn(*const Handle, *mut c_ulong) -> c_int,
    type_map: Option<extern "C" fn()>,
    allocate_free: [Option<extern "C" fn()>; 2],
    get_eoa: extern "C" fn(*const Handle, c_int) -> u64,
    set_eoa: extern "C" fn(*mut Handle, c_int, u64) -> c_int,
    get_eof: extern "C" fn(*const Handle, c_int) -> u64,
    get_handle: Option<extern "C" fn()>,
    read: extern "C" fn(*mut Handle, c_int, hid_t, u64, usize, *mut u8) -> c_int,
    write: extern "C" fn(*mut Handle, c_int, hid_t, u64, usize, *const u8) -> c_int,
    vectors_and_selections: [Option<extern "C" fn()>; 4],
    flush: extern "C" fn(*mut Handle, hid_t, bool) -> c_int,
    truncate: extern "C" fn(*mut Handle, hid_t, bool) -> c_int,
    lock: extern "C" fn(*mut Handle, bool) -> c_int,
    unlock: extern "C" fn(*mut Handle) -> c_int,
    delete: Option<extern "C" fn()>,
    control: Option<extern "C" fn()>,
    free_lists: [c_int; 7],
}

struct Shared(Class);

// SAFETY: no member is ever modified, and the name is a constant.
unsafe impl Sync for Shared {}

static CLASS: Shared = Shared(Class {
    version: 1,
    // Driver values from 512 on are for drivers outside the library; no registered driver has this one.
    value: 6022,
    name: c"barwave".as_ptr(),
    largest_address: i64::MAX as u64,
    close_degree: 1,
    terminate: None,
    superblock: [None; 3],
    access_size: 0,
    access: [None; 3],
    transfer_size: 0,
    transfer: [None; 2],
    open,
    close,
    compare: None,
    query,
    type_map: None,
    allocate_free: [None; 2],
    get_eoa,
    set_eoa,
    get_eof,
    get_handle: None,
    read,
    write,
    vectors_and_selections: [None; 4],
    flush,
    truncate,
    lock,
    unlock,
    delete: None,
    control: None,
    // Metadata and data in separate free lists (H5FD_FLMAP_DICHOTOMY).
    free_lists: [1, 1, 1, 3, 3, 1, 1],
});

/// Open file: `H5FD_t`, which the library fills in, followed by the driver's own members.
#[repr(C)]
struct Handle {
    driver_id: hid_t,
    class: *const c_void,
    number: c_ulong,
    access_flags: c_uint,
    features: c_ulong,
    largest_address: u64,
    base_address: u64,
    threshold: u64,
    alignment: u64,
    paged: bool,
    file: Journaled,
    /// End of the allocated addresses, bytes.
    eoa: u64,
}

const FAILED: c_int = -1;

fn status(result: &std::io::Result<()>) -> c_int {
    if result.is_ok() { 0 } else { FAILED }
}

/// # Safety
/// The pointer must come from [`open`] and must not have been passed to [`close`].
unsafe fn handle<'a>(handle: *const Handle) -> &'a Handle {
    unsafe { &*handle }
}

/// # Safety
/// As for [`handle`]; the library's lock ensures that there is only one call at a time.
unsafe fn handle_mut<'a>(handle: *mut Handle) -> &'a mut Handle {
    unsafe { &mut *handle }
}

extern "C" fn open(name: *const c_char, _flags: c_uint, _access: hid_t, _largest: u64) -> *mut Handle {
    // SAFETY: the library passes the name of the file, terminated by a zero byte.
    let name = unsafe { CStr::from_ptr(name) };
    let Ok(file) = Journaled::open(Path::new(OsStr::from_bytes(name.to_bytes()))) else { return ptr::null_mut() };
    Box::into_raw(Box::new(Handle {
        driver_id: 0,
        class: ptr::null(),
        number: 0,
        access_flags: 0,
        features: 0,
        largest_address: 0,
        base_address: 0,
        threshold: 0,
        alignment: 0,
        paged: false,
        file,
        eoa: 0,
    }))
}

extern "C" fn close(file: *mut Handle) -> c_int {
    // SAFETY: the library closes each file that it opened once, and does not use it afterwards.
    let handle = unsafe { Box::from_raw(file) };
    // A child process that was forked meanwhile holds the same lock until it executes its program; closing alone would
    // not release the lock. An error only means that the file system has no locks.
    let _ = handle.file.file().unlock();
    0
}

extern "C" fn query(_file: *const Handle, features: *mut c_ulong) -> c_int {
    let all = H5FD_FEAT_AGGREGATE_METADATA
        | H5FD_FEAT_ACCUMULATE_METADATA
        | H5FD_FEAT_DATA_SIEVE
        | H5FD_FEAT_AGGREGATE_SMALLDATA;
    // SAFETY: the library passes a valid pointer for the result.
    unsafe { *features = c_ulong::from(all) };
    0
}

extern "C" fn get_eoa(file: *const Handle, _kind: c_int) -> u64 {
    // SAFETY: see `handle`.
    unsafe { handle(file) }.eoa
}

extern "C" fn set_eoa(file: *mut Handle, _kind: c_int, eoa: u64) -> c_int {
    // SAFETY: see `handle_mut`.
    unsafe { handle_mut(file) }.eoa = eoa;
    0
}

extern "C" fn get_eof(file: *const Handle, _kind: c_int) -> u64 {
    // SAFETY: see `handle`.
    unsafe { handle(file) }.file.end()
}

extern "C" fn read(file: *mut Handle, _kind: c_int, _transfer: hid_t, at: u64, size: usize, bytes: *mut u8) -> c_int {
    // SAFETY: see `handle`; the library passes a buffer of `size` bytes.
    let (file, bytes) = unsafe { (handle(file), std::slice::from_raw_parts_mut(bytes, size)) };
    status(&file.file.read(at, bytes))
}

extern "C" fn write(
    file: *mut Handle,
    _kind: c_int,
    _transfer: hid_t,
    at: u64,
    size: usize,
    bytes: *const u8,
) -> c_int {
    // SAFETY: see `handle_mut`; the library passes a buffer of `size` bytes.
    let (file, bytes) = unsafe { (handle_mut(file), std::slice::from_raw_parts(bytes, size)) };
    status(&file.file.write(at, bytes))
}

/// Commits the changes; the library calls this at the end of every flush.
extern "C" fn flush(file: *mut Handle, _transfer: hid_t, _closing: bool) -> c_int {
    // SAFETY: see `handle_mut`.
    status(&unsafe { handle_mut(file) }.file.commit())
}

extern "C" fn truncate(file: *mut Handle, _transfer: hid_t, _closing: bool) -> c_int {
    // SAFETY: see `handle_mut`.
    let file = unsafe { handle_mut(file) };
    status(&file.file.set_end(file.eoa))
}

extern "C" fn lock(file: *mut Handle, exclusive: bool) -> c_int {
    // SAFETY: see `handle`.
    let file = unsafe { handle(file) }.file.file();
    let locked = if exclusive { file.try_lock() } else { file.try_lock_shared() };
    match locked {
        Err(std::fs::TryLockError::WouldBlock) => FAILED,
        // On a file system without locks the file is written without one.
        Ok(()) | Err(std::fs::TryLockError::Error(_)) => 0,
    }
}

extern "C" fn unlock(file: *mut Handle) -> c_int {
    // SAFETY: see `handle`.
    status(&unsafe { handle(file) }.file.file().unlock())
}
