//! An FMU file as an importer takes it: unpacked, its description read, its library opened.
//!
//! In: a `.fmu` file and a folder. Out: instances, and the value references of variables by name. It must not know who
//! made the FMU.
use linkage_fmu::fmi2::host::logger;
use linkage_fmu::fmi2::importer::{Instance, Library};
use linkage_fmu::fmi2::types::ValueReference;
use quick_xml::events::Event;
use quick_xml::{Reader, XmlVersion};
use std::collections::HashMap;
use std::env::consts::{DLL_EXTENSION, OS};
use std::fs::File;
use std::path::Path;
use std::sync::Arc;

/// An opened FMU.
#[derive(Debug)]
pub struct Fmu {
    library: Arc<Library>,
    references: HashMap<String, ValueReference>,
}

impl Fmu {
    /// Unpack an FMU into a folder and open it.
    ///
    /// # Errors
    /// The file is no FMU for co-simulation on this platform, or cannot be unpacked.
    pub fn open(file: &Path, folder: &Path) -> Result<Arc<Self>, String> {
        let refused = |reason: String| format!("{}: {reason}", file.display());
        let archive = File::open(file).map_err(|e| refused(e.to_string()))?;
        let mut archive = zip::ZipArchive::new(archive).map_err(|e| refused(e.to_string()))?;
        archive.extract(folder).map_err(|e| refused(e.to_string()))?;
        let text = std::fs::read_to_string(folder.join("modelDescription.xml")).map_err(|e| refused(e.to_string()))?;
        let description = Description::read(&text).map_err(refused)?;
        let platform = match OS {
            "linux" => "linux64",
            "windows" => "win64",
            _ => "darwin64",
        };
        let name = format!("{}.{DLL_EXTENSION}", description.identifier);
        let library = folder.join("binaries").join(platform).join(name);
        let library = library.canonicalize().map_err(|e| refused(format!("{}: {e}", library.display())))?;
        let resources = folder.canonicalize().map_err(|e| refused(e.to_string()))?.join("resources");
        let location = format!("file://{}", resources.display());
        let library = Library::open(library.as_os_str(), &description.guid, &location)?;
        Ok(Arc::new(Self { library, references: description.references }))
    }

    /// New instance.
    ///
    /// # Errors
    /// The FMU refuses.
    pub fn instantiate(self: &Arc<Self>, name: &str) -> Result<Instance, String> {
        self.library.instantiate(name, Some(logger()))
    }

    /// Value reference of a variable.
    ///
    /// # Errors
    /// There is no such variable.
    pub fn find(&self, name: &str) -> Result<ValueReference, String> {
        self.references.get(name).copied().ok_or_else(|| format!("the FMU has no variable {name}"))
    }

    /// Value references of variables.
    ///
    /// # Errors
    /// There is no such variable.
    pub fn find_all<const N: usize>(&self, names: [&str; N]) -> Result<[ValueReference; N], String> {
        let mut all = [0; N];
        for (reference, name) in all.iter_mut().zip(names) {
            *reference = self.find(name)?;
        }
        Ok(all)
    }
}

/// What `modelDescription.xml` tells.
struct Description {
    guid: String,
    identifier: String,
    references: HashMap<String, ValueReference>,
}

impl Description {
    fn read(text: &str) -> Result<Self, String> {
        let mut reader = Reader::from_str(text);
        let (mut guid, mut identifier, mut references) = (None, None, HashMap::new());
        loop {
            let element = match reader.read_event().map_err(|e| e.to_string())? {
                Event::Eof => break,
                Event::Start(element) | Event::Empty(element) => element,
                _ => continue,
            };
            let attribute = |name: &str| -> Result<Option<String>, String> {
                let found = element.try_get_attribute(name).map_err(|e| e.to_string())?;
                let value = |a: quick_xml::events::attributes::Attribute| {
                    a.normalized_value(XmlVersion::Explicit1_0).map(|v| v.into_owned())
                };
                found.map(value).transpose().map_err(|e| e.to_string())
            };
            match element.name().as_ref() {
                "fmiModelDescription" => guid = attribute("guid")?,
                "CoSimulation" => identifier = attribute("modelIdentifier")?,
                "ScalarVariable" => {
                    let name = attribute("name")?.ok_or("a ScalarVariable has no name")?;
                    let reference = attribute("valueReference")?.and_then(|text| text.parse().ok());
                    references.insert(name, reference.ok_or("a ScalarVariable has no valueReference")?);
                }
                _ => {}
            }
        }
        Ok(Self {
            guid: guid.ok_or("modelDescription.xml has no guid")?,
            identifier: identifier.ok_or("the FMU is not for co-simulation")?,
            references,
        })
    }
}
