//! The build tools of the library for each platform: names of the platform, linker, packages.
//!
//! In: a platform of the command line. Out: a row of constants.

use crate::binary::{ARM_LINUX, MAC};
use fmu_cli::Platform;

/// Settings of Rust and the linker for a platform.
pub struct Toolchain {
    /// Name in FMI 3.0.
    pub tuple: &'static str,
    /// Folder in FMI 2.0.
    pub folder: &'static str,
    /// Name of the machine for Rust.
    pub triple: &'static str,
    /// Extension of its shared libraries.
    pub extension: &'static str,
    /// The linker, and its Debian package. None for macOS.
    pub linker: Option<(&'static str, &'static str)>,
    /// The Debian package with the standard library for Debian's own Rust, if there is one. Debian 12 has a recent Rust
    /// under the package name rustc-web. Its package rust-src belongs to Rust 1.63.
    pub debian: &'static str,
}

/// Linux, x86.
pub const X86_LINUX: Toolchain = Toolchain {
    tuple: "x86_64-linux",
    folder: "linux64",
    triple: "x86_64-unknown-linux-gnu",
    extension: "so",
    linker: Some(("x86_64-linux-gnu-gcc", "gcc-x86-64-linux-gnu")),
    debian: " (if Rust comes from the Debian package rustc-web, run: apt-get install libstd-rust-web-dev:amd64)",
};

/// Windows, x86.
pub const X86_WINDOWS: Toolchain = Toolchain {
    tuple: "x86_64-windows",
    folder: "win64",
    triple: "x86_64-pc-windows-gnu",
    extension: "dll",
    linker: Some(("x86_64-w64-mingw32-gcc", "gcc-mingw-w64-x86-64")),
    debian: " (if Rust comes from the Debian package rustc-web, run: apt-get install rust-web-src, and set \
        RUSTC_BOOTSTRAP=1)",
};

/// Linux, ARM.
pub const ARM: Toolchain = Toolchain {
    tuple: ARM_LINUX,
    folder: ARM_LINUX,
    triple: "aarch64-unknown-linux-gnu",
    extension: "so",
    linker: Some(("aarch64-linux-gnu-gcc", "gcc-aarch64-linux-gnu")),
    debian: " (if Rust comes from the Debian package rustc-web, run: dpkg --add-architecture arm64; apt-get install \
             libstd-rust-web-dev:arm64)",
};

/// macOS, x86.
pub const X86_MAC: Toolchain = Toolchain {
    tuple: "x86_64-darwin",
    folder: MAC,
    triple: "x86_64-apple-darwin",
    extension: "dylib",
    linker: None,
    debian: "",
};

/// macOS, ARM.
pub const ARM_MAC: Toolchain = Toolchain { tuple: "aarch64-darwin", triple: "aarch64-apple-darwin", ..X86_MAC };

/// All of them.
pub const TOOLCHAINS: [&Toolchain; 5] = [&X86_LINUX, &X86_WINDOWS, &ARM, &X86_MAC, &ARM_MAC];

impl Toolchain {
    /// Whether its libraries are for Linux.
    pub fn is_linux(&self) -> bool {
        self.extension == "so"
    }

    /// Whether Rust puts all functions of a crate into one section, so that the linker omits all or none of them.
    pub fn is_in_one_section(&self) -> bool {
        self.triple.ends_with("-windows-gnu")
    }

    /// Whether the library from Cargo's normal build is suitable for this machine with this name. On macOS the library
    /// would contain paths of this machine, and a signature that prevents removing them.
    pub fn is_built_plainly(&self, tuple: &str) -> bool {
        self.tuple == tuple && self.linker.is_some()
    }
}

/// The toolchain for a platform.
pub fn toolchain(platform: Platform) -> &'static Toolchain {
    match platform {
        Platform::X86Linux => &X86_LINUX,
        Platform::X86Windows => &X86_WINDOWS,
        Platform::ArmLinux => &ARM,
        Platform::X86Mac => &X86_MAC,
        Platform::ArmMac => &ARM_MAC,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_toolchain_makes_libraries_of_its_platform() {
        for toolchain in TOOLCHAINS {
            let path = crate::binary::path(toolchain.folder, "A").unwrap();
            assert_eq!(path, format!("binaries/{}/A.{}", toolchain.folder, toolchain.extension));
            assert_eq!(
                crate::binary::path(toolchain.tuple, "A").unwrap().split_once('.').unwrap().1,
                toolchain.extension
            );
        }
    }

    #[test]
    fn a_library_of_macos_is_never_built_plainly() {
        for toolchain in TOOLCHAINS {
            assert_eq!(toolchain.is_built_plainly(toolchain.tuple), toolchain.extension != "dylib");
            assert!(!toolchain.is_built_plainly("riscv64-linux"));
        }
    }
}
