//! A plugin of QEMU's that records a core's flow of execution. It knows no prices: `cycles` has them.
//!
//! Arguments: `isa=arm` or `isa=thumb`; `entry=ADDRESS`, of a function to be recorded, one or more; `out=PATH`, which is written when
//! QEMU ends; `each=on`, where every call is to be a flow of its own; `code_end=ADDRESS`, where instruction memory ends.

mod api;

use std::ffi::{CStr, c_char, c_int, c_uint, c_void};
use std::io::Write;
use std::path::PathBuf;
use std::sync::atomic::{AtomicPtr, Ordering};

use cycles::file;
use cycles::flow::{Instruction, Isa};
use cycles::recorder::{Recorder, Wanted};

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
unsafe fn arguments(count: c_int, words: *const *const c_char) -> Vec<String> {
    let count = usize::try_from(count).unwrap_or_default();
    // SAFETY: the caller's promise.
    let word = |place| unsafe { CStr::from_ptr(*words.add(place)) };
    (0..count)
        .map(|place| word(place).to_string_lossy().into_owned())
        .collect()
}

fn set_up(info: &api::Info, words: &[String]) -> Result<Plugin, String> {
    if !info.system_emulation || info.processors != 1 {
        return Err("it records a whole machine with one processor".to_owned());
    }
    let mut wanted = Wanted {
        isa: Isa::Arm,
        entries: Vec::new(),
        each: false,
        code_end: 0,
    };
    let mut file = None;
    for word in words {
        let (key, value) = word.split_once('=').unwrap_or((word, ""));
        match (key, value) {
            ("isa", "arm") => wanted.isa = Isa::Arm,
            ("isa", "thumb") => wanted.isa = Isa::Thumb,
            ("each", _) => wanted.each = value == "on",
            ("code_end", _) => wanted.code_end = address(value)?,
            ("out", _) => file = Some(PathBuf::from(value)),
            ("entry", _) => wanted.entries.push(address(value)?),
            _ => {
                return Err(format!(
                    "`{word}` is none of its arguments (isa, entry, out, each, code_end)"
                ));
            }
        }
    }
    let file = file.ok_or("it needs `out=PATH`")?;
    if wanted.entries.is_empty() {
        return Err("it needs `entry=ADDRESS`, once or more".to_owned());
    }
    Ok(Plugin {
        recorder: Recorder::new(wanted),
        file,
    })
}

fn address(text: &str) -> Result<u32, String> {
    let digits = text.strip_prefix("0x").unwrap_or(text);
    // A Thumb function's symbol has its lowest bit set; its instructions lie at even addresses.
    let parsed = u32::from_str_radix(digits, 16).map(|address| address & !1);
    parsed.map_err(|_| format!("`{text}` is no hexadecimal address"))
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
        let instructions = handles.iter().map(|&handle| instruction(handle)).collect();
        let recorder = &mut plugin().recorder;
        let number = recorder.block(instructions);
        api::qemu_plugin_register_vcpu_tb_exec_cb(block, executed, api::NO_REGISTERS, data(number));
        let watched = recorder.watched(number);
        for (place, &handle) in handles.iter().enumerate().filter(|&(place, _)| watched[place]) {
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

/// # Safety
/// `handle` is an instruction of the block in translation.
unsafe fn instruction(handle: *const api::Instruction) -> Instruction {
    // SAFETY: the caller's promise; the data are as long as QEMU says, and were copied before the call ends.
    let (address, bytes) = unsafe {
        let data = api::qemu_plugin_insn_data(handle).cast::<u8>();
        let length = api::qemu_plugin_insn_size(handle);
        (
            api::qemu_plugin_insn_vaddr(handle),
            std::slice::from_raw_parts(data, length),
        )
    };
    let encoding = match *bytes {
        [a, b] => u16::from_le_bytes([a, b]).into(),
        [a, b, c, d] => u32::from_le_bytes([a, b, c, d]),
        _ => 0,
    };
    Instruction {
        address: address as u32,
        encoding,
        bytes: bytes.len() as u8,
    }
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
    let Some(recording) = plugin.recorder.finish() else {
        return complain("the core ended within the recorded function: nothing is written");
    };
    let written = std::fs::write(&plugin.file, file::encode(&recording));
    if let Err(error) = written {
        complain(&format!("cannot write {}: {error}", plugin.file.display()));
    }
}
