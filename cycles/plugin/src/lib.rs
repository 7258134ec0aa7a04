//! A plugin of QEMU's that records a core's flow of execution. It knows no prices: `cycles` has them.
//!
//! Arguments: `isa=arm` or `isa=thumb`; `entry=ADDRESS`, of a function to be recorded, one or more; `out=PATH`, which is written when
//! QEMU ends; `each=on`, where every call is to be a flow of its own; `code_end=ADDRESS`, where instruction memory ends.

mod api;

use std::ffi::{CStr, OsStr, OsString, c_char, c_int, c_uint, c_void};
use std::io::Write;
use std::ops::Range;
use std::os::unix::ffi::OsStrExt;
use std::path::PathBuf;
use std::sync::atomic::{AtomicPtr, Ordering};

use cycles::flow::{Instruction, Isa};
use cycles::recorder::Recorder;
use cycles::{file, options};

/// The version of QEMU's interface that this was made for; QEMU looks for it.
#[unsafe(no_mangle)]
#[allow(non_upper_case_globals, reason = "QEMU gives the name")]
pub static qemu_plugin_version: c_int = api::VERSION;

struct Plugin {
    recorder: Recorder,
    file: PathBuf,
}

/// Made once, when the plugin is loaded, and there until QEMU ends.
static PLUGIN: AtomicPtr<Plugin> = AtomicPtr::new(std::ptr::null_mut());

/// Instructions that a block has at most, a power of two: QEMU's own limit.
const BLOCK_LENGTH: usize = 1024;

/// Called by QEMU when it loads the plugin.
///
/// # Safety
/// As QEMU calls it: `info` and `words` point to what the interface says, `count` words of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qemu_plugin_install(
    id: api::Id,
    info: *const api::Info,
    count: c_int,
    words: *const *const c_char,
) -> c_int {
    // SAFETY: the caller's promise.
    let (info, words) = unsafe { (&*info, arguments(count, words)) };
    match set_up(info, &words) {
        Ok(plugin) => {
            PLUGIN.store(Box::into_raw(Box::new(plugin)), Ordering::Relaxed);
            // SAFETY: QEMU's functions, called as its interface says, from within its call of the plugin.
            unsafe {
                api::qemu_plugin_register_vcpu_tb_trans_cb(id, translated);
                api::qemu_plugin_register_atexit_cb(id, ended, std::ptr::null_mut());
            }
            0
        }
        Err(error) => {
            complain(&error);
            1
        }
    }
}

/// # Safety
/// `words` points to so many strings.
unsafe fn arguments(count: c_int, words: *const *const c_char) -> Vec<OsString> {
    let count = usize::try_from(count).unwrap_or_default();
    // SAFETY: the caller's promise.
    let word = |place| unsafe { CStr::from_ptr(*words.add(place)) };
    let words = (0..count).map(|place| OsStr::from_bytes(word(place).to_bytes()).to_owned());
    words.collect()
}

fn set_up(info: &api::Info, words: &[OsString]) -> Result<Plugin, String> {
    if !info.system_emulation || info.processors != 1 {
        return Err("it records a whole machine with one processor".to_owned());
    }
    let (wanted, file) = options::parse(words)?;
    Ok(Plugin {
        recorder: Recorder::new(wanted),
        file,
    })
}

fn complain(error: &str) {
    // Nobody is left to tell where standard error is gone.
    let _ = writeln!(std::io::stderr(), "cycles-plugin: {error}");
}

/// The plugin, for a callback.
///
/// # Safety
/// Only within a callback of QEMU's, which with one processor never run beside each other, and once in each.
unsafe fn plugin<'a>() -> &'a mut Plugin {
    // SAFETY: it was stored before the first callback was registered and is never freed; the caller has the only reference.
    unsafe { &mut *PLUGIN.load(Ordering::Relaxed) }
}

extern "C" fn translated(_id: api::Id, block: *mut api::Block) {
    // SAFETY: a callback; and QEMU's functions get what QEMU has given, within the call.
    unsafe {
        let count = api::qemu_plugin_tb_n_insns(block);
        let handles: Vec<_> = (0..count)
            .map(|place| api::qemu_plugin_tb_get_insn(block, place))
            .collect();
        let recorder = &mut plugin().recorder;
        let isa = recorder.isa();
        let instructions = handles.iter().map_while(|&handle| instruction(isa, handle));
        let instructions: Vec<_> = instructions.collect();
        let number = if instructions.len() == handles.len() {
            recorder.block(instructions)
        } else {
            recorder.foreign_block(extent(&handles))
        };
        api::qemu_plugin_register_vcpu_tb_exec_cb(block, executed, api::NO_REGISTERS, data(number));
        let watched = recorder.watched(number);
        for (place, (&handle, _)) in handles
            .iter()
            .zip(watched)
            .enumerate()
            .filter(|(_, (_, watched))| *watched)
        {
            let data = data(number * BLOCK_LENGTH + place);
            api::qemu_plugin_register_vcpu_mem_cb(
                handle,
                accessed,
                api::NO_REGISTERS,
                api::READS_AND_WRITES,
                data,
            );
        }
    }
}

/// A number as what QEMU hands to a callback.
fn data(number: usize) -> *mut c_void {
    std::ptr::without_provenance_mut(number)
}

/// Nothing for what is no instruction, whose execution would be an exception.
///
/// # Safety
/// `handle` is an instruction of the block in translation.
unsafe fn instruction(isa: Isa, handle: *const api::Instruction) -> Option<Instruction> {
    // SAFETY: the caller's promise; the data are as long as QEMU says, and are read before the call ends.
    let (address, bytes) = unsafe {
        let data = api::qemu_plugin_insn_data(handle).cast::<u8>();
        let length = api::qemu_plugin_insn_size(handle);
        (
            api::qemu_plugin_insn_vaddr(handle),
            std::slice::from_raw_parts(data, length),
        )
    };
    // At the end of a page QEMU looks further ahead than the instruction is long.
    Instruction::read(isa, address as u32, bytes)
}

/// The addresses from a block's first instruction to its end.
///
/// # Safety
/// `handles` are the instructions of the block in translation.
unsafe fn extent(handles: &[*mut api::Instruction]) -> Range<u32> {
    // SAFETY: the caller's promise.
    let start = |handle| unsafe { api::qemu_plugin_insn_vaddr(handle) as u32 };
    // SAFETY: as above.
    let length = |handle| unsafe { api::qemu_plugin_insn_size(handle) as u32 };
    let first = handles.first().map_or(0, |&handle| start(handle));
    let last = handles.last().map_or(0, |&handle| start(handle) + length(handle));
    first..last
}

extern "C" fn executed(_processor: c_uint, data: *mut c_void) {
    // SAFETY: a callback.
    unsafe { plugin().recorder.executed(data.addr()) }
}

extern "C" fn accessed(_processor: c_uint, _info: u32, address: u64, data: *mut c_void) {
    let (number, place) = (data.addr() / BLOCK_LENGTH, data.addr() % BLOCK_LENGTH);
    // SAFETY: a callback.
    unsafe { plugin().recorder.accessed(number, place, address as u32) }
}

extern "C" fn ended(_id: api::Id, _data: *mut c_void) {
    // SAFETY: it came of a box, and this is the last callback.
    let plugin = unsafe { Box::from_raw(PLUGIN.swap(std::ptr::null_mut(), Ordering::Relaxed)) };
    let recording = match plugin.recorder.finish() {
        Ok(recording) => recording,
        Err(error) => return complain(&format!("nothing is written: {error}")),
    };
    let written = std::fs::write(&plugin.file, file::encode(&recording));
    if let Err(error) = written {
        complain(&format!("cannot write {}: {error}", plugin.file.display()));
    }
}
