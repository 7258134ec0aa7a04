//! QEMU's interface for plugins, version 1: what we use of it, declared by ourselves, for Debian ships no header.

use std::ffi::{c_char, c_int, c_uint, c_void};

/// The version of the interface that these declarations are of.
pub(crate) const VERSION: c_int = 1;

/// A plugin's number.
pub(crate) type Id = u64;

/// What QEMU says of itself.
#[repr(C)]
pub struct Info {
    /// The emulated architecture's name.
    pub(crate) target_name: *const c_char,
    /// The oldest version of the interface that this QEMU serves.
    pub(crate) oldest: c_int,
    /// The version of the interface that it has.
    pub(crate) current: c_int,
    /// Whether a whole machine is emulated.
    pub(crate) system_emulation: bool,
    /// Processors at the start.
    pub(crate) processors: c_int,
    /// Processors at most.
    pub(crate) most_processors: c_int,
}

/// A block in translation.
#[repr(C)]
pub(crate) struct Block {
    _opaque: [u8; 0],
}

/// An instruction in translation.
#[repr(C)]
pub(crate) struct Instruction {
    _opaque: [u8; 0],
}

/// The callback does not look at the core's registers.
pub(crate) const NO_REGISTERS: c_int = 0;
/// Loads and stores.
pub(crate) const READS_AND_WRITES: c_int = 3;

/// Called when a block is translated.
pub(crate) type Translated = extern "C" fn(Id, *mut Block);
/// Called when a block is executed.
pub(crate) type Executed = extern "C" fn(c_uint, *mut c_void);
/// Called when an instruction accesses memory.
pub(crate) type Accessed = extern "C" fn(c_uint, u32, u64, *mut c_void);
/// Called when QEMU ends.
pub(crate) type Ended = extern "C" fn(Id, *mut c_void);

unsafe extern "C" {
    pub(crate) fn qemu_plugin_register_vcpu_tb_trans_cb(id: Id, callback: Translated);
    pub(crate) fn qemu_plugin_register_vcpu_tb_exec_cb(
        block: *mut Block,
        callback: Executed,
        flags: c_int,
        data: *mut c_void,
    );
    pub(crate) fn qemu_plugin_register_vcpu_mem_cb(
        instruction: *mut Instruction,
        callback: Accessed,
        flags: c_int,
        kind: c_int,
        data: *mut c_void,
    );
    pub(crate) fn qemu_plugin_register_atexit_cb(id: Id, callback: Ended, data: *mut c_void);
    pub(crate) fn qemu_plugin_tb_n_insns(block: *const Block) -> usize;
    pub(crate) fn qemu_plugin_tb_get_insn(block: *const Block, place: usize) -> *mut Instruction;
    pub(crate) fn qemu_plugin_insn_data(instruction: *const Instruction) -> *const c_void;
    pub(crate) fn qemu_plugin_insn_size(instruction: *const Instruction) -> usize;
    pub(crate) fn qemu_plugin_insn_vaddr(instruction: *const Instruction) -> u64;
}
