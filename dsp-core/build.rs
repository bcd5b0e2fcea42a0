//! Says `cortex_m4f` for the target whose kernels are assembly: target features are no stable
//! configuration on Arm.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(cortex_m4f)");
    if std::env::var("TARGET").is_ok_and(|target| target == "thumbv7em-none-eabihf") {
        println!("cargo::rustc-cfg=cortex_m4f");
    }
}
