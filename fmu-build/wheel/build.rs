//! Arguments of the linker for an extension of Python: macOS finds Python's functions when it is loaded.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
