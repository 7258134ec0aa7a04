//! Says whether the target has the instructions of `src/assembly/arm.rs`, ARM's own 32-bit set, or Thumb with 32-bit
//! instructions; of `src/assembly/halves.rs`, which ARM's own set has from ARMv5TE on; and whether it is a microcontroller that divides. The target's name tells; a stable compiler keeps the
//! instruction set from `cfg`.

fn main() {
    println!("cargo::rustc-check-cfg=cfg(shifted_operands, half_products, hardware_divide)");
    println!("cargo::rerun-if-changed=build.rs");
    let target = std::env::var("TARGET").unwrap_or_default();
    let arm =
        target.starts_with("arm") && std::env::var("CARGO_CFG_TARGET_ARCH").is_ok_and(|arch| arch == "arm");
    let thumb2 = ["thumbv7", "thumbv8m.main"]
        .iter()
        .any(|start| target.starts_with(start));
    if arm || thumb2 {
        println!("cargo::rustc-cfg=shifted_operands");
    }
    if arm && !target.starts_with("armv4") {
        println!("cargo::rustc-cfg=half_products");
    }
    if thumb2 || target.starts_with("thumbv8m.base") {
        println!("cargo::rustc-cfg=hardware_divide");
    }
}
