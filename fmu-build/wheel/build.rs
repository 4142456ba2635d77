//! Arguments of the linker for a Python extension: on macOS the functions of Python are resolved when the extension is
//! loaded.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
