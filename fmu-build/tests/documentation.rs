//! The documentation in an FMU: the page against definition and engine, pictures, reference results, hostile texts.
#![allow(clippy::unwrap_used)]

#[allow(dead_code)]
#[path = "../../tests/support/definition.rs"]
mod definition;
#[path = "../../tests/support/folder.rs"]
mod folder;

use definition::{With, rod};
use fmu_build::check::{self, Checked};
use fmu_build::documentation::{
    ANIMATION, Extent, ICON, MANIFEST, Made, PAGE, Picture, RESULTS, Subject, TERMINAL_ICONS, scene_path,
};
use fmu_build::drawing::{Colours, to_svg};
use fmu_build::workspace::Workspace;
use folder::Folder;
use linkage_fmu::component::Component;
use linkage_fmu::simulation::Simulation;
use quick_xml::Reader;
use quick_xml::events::Event;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

const MECHANISM: &str = "mechanism.json";
const ALL: Extent = Extent { animation: true, results: true };

fn definition(name: &str) -> String {
    let path = Workspace::locate().descriptions().join(name).join("resources").join(MECHANISM);
    fs::read_to_string(path).unwrap()
}

/// The gear with another value at a path such as `/description`.
fn gear_with(path: &str, value: Value) -> String {
    let mut all: Value = serde_json::from_str(&definition("LandingGearRetraction")).unwrap();
    *all.pointer_mut(path).unwrap() = value;
    all.to_string()
}

/// Call a function with the subject of a definition.
fn with<T>(kind: &str, text: &str, readme: Option<&str>, call: impl FnOnce(&Subject) -> T) -> T {
    let checked: Checked = check::check("somewhere/else.json".into(), kind, text.to_owned()).unwrap();
    let component = Component::from_definition(kind, text).unwrap();
    call(&Subject { checked: &checked, component: &component, readme })
}

fn page(text: &str, readme: Option<&str>) -> String {
    with(MECHANISM, text, readme, |subject| subject.page().unwrap())
}

fn made(kind: &str, text: &str, extent: Extent) -> Made {
    with(kind, text, None, |subject| subject.files(&Workspace::locate(), extent).unwrap())
}

fn entry<'a>(made: &'a Made, name: &str) -> &'a str {
    let entry = made.entries.iter().find(|entry| entry.name == name).unwrap_or_else(|| panic!("no {name}"));
    std::str::from_utf8(&entry.content).unwrap()
}

/// Position of the drawn element of a joint.
fn drawn(svg: &str, joint: &str) -> [f64; 2] {
    let mut reader = Reader::from_str(svg);
    loop {
        match reader.read_event().unwrap() {
            Event::Start(element) | Event::Empty(element) => {
                let of = |name: &str| {
                    let found = element.attributes().flatten().find(|a| a.key.as_ref() == name)?;
                    Some(found.value.into_owned())
                };
                if of("data-joint").as_deref() == Some(joint) {
                    return ["cx", "cy"].map(|name| of(name).unwrap().parse().unwrap());
                }
            }
            Event::Eof => panic!("{joint} is not drawn"),
            _ => {}
        }
    }
}

fn svg_of(page: &str) -> &str {
    let from = page.find("<svg").unwrap();
    &page[from..page.find("</svg>").unwrap() + "</svg>".len()]
}

#[test]
fn drawn_joints_are_where_the_engine_has_them() {
    let page = page(&definition("LandingGearRetraction"), None);
    let svg = svg_of(&page);
    let mut gear = Simulation::open(&definition("LandingGearRetraction")).unwrap();
    gear.initialize().unwrap();
    let [crank, follower] = ["crank.angle", "follower.angle"].map(|name| gear.get(name).unwrap());
    // The pins of the ground give origin and scale. The lengths are those of the definition.
    let ([x1, y1], [x4, y4]) = (drawn(svg, "joint1"), drawn(svg, "joint4"));
    let scale = (x4 - x1) / 0.5729;
    assert!(scale > 100.0 && (y1 - y4).abs() < 0.02, "{scale}");
    for (joint, [x, y]) in [
        ("joint2", [0.1755 * crank.cos(), 0.1755 * crank.sin()]),
        ("joint3", [0.5729 + 0.34 * follower.cos(), 0.34 * follower.sin()]),
    ] {
        let [u, v] = drawn(svg, joint);
        let off = (u - x1 - scale * x).hypot(v - y1 + scale * y);
        // Lengths are written to 0.01 px. The error of the scale is part of the difference.
        assert!(off < 0.05, "{joint}: {off} px");
    }
}

#[test]
fn every_variable_stands_in_the_page_with_its_unit_and_start() {
    let text = definition("LandingGearRetraction");
    let page = page(&text, None);
    let component = Component::from_definition(MECHANISM, &text).unwrap();
    for variable in component.interface().list() {
        let row = format!("<tr data-variable=\"{}\">", variable.name);
        let at = page.find(&row).unwrap_or_else(|| panic!("{} is missing", variable.name));
        let cells = &page[at..at + page[at..].find("</tr>").unwrap()];
        if let Some(unit) = variable.unit {
            let cell = format!("<td>{}</td>", unit.name().replace('/', "&#x2f;"));
            assert!(cells.contains(&cell) || cells.contains(&format!("<td>{}</td>", unit.name())), "{cells}");
        }
    }
    assert!(page.contains("0.8 (45.8366 deg)") && page.contains("in the direction of -115.26&deg;"), "gravity, start");
    for scope in ["<th scope=\"col\">Variable</th>", "<th scope=\"row\"><bdi>crank.angle</bdi></th>"] {
        assert!(page.contains(scope), "{scope}");
    }
    assert!(page.contains("role=\"img\" aria-labelledby=\"drawing-title drawing-description\""));
    assert!(page.contains("joint2 (revolute) between crank and coupler"));
}

const HOSTILE: &str =
    "</script></svg></style><img src=x onerror=alert(1)><!--\" ' & \u{202e}reversed\u{202c} \u{200f} ]]> {{ 7*7 }}";

/// The texts after an XML reader, escaped.
const HOSTILE_READ: &str = "&lt;/script&gt;&lt;/svg&gt;&lt;/style&gt;&lt;img src=x onerror=alert(1)&gt;&lt;!--&quot; \
    &apos; &amp; \u{202e}reversed\u{202c} \u{200f} ]]&gt; {{ 7*7 }}";

/// Texts that HTML, XML and templates could interpret.
#[test]
fn markup_in_texts_stays_text() {
    let text = gear_with("/description", json!(HOSTILE));
    let readme = format!(
        "# {HOSTILE}\n\n{HOSTILE}\n\n<script>alert(2)</script>\n\n[x](javascript:alert(3)) ![y](https://z/y.png)\n"
    );
    let page = page(&text, Some(&readme));
    for tag in ["<script", "<img", "<!--", "</style><", "javascript:"] {
        assert!(!page.contains(tag) || tag == "javascript:" && !page.contains("href=\"javascript"), "{tag}");
    }
    // The drawings for a wide and a narrow page.
    assert_eq!(page.matches("</svg>").count(), 2);
    assert_eq!(page.matches("</style>").count(), 1);
    assert!(page.contains("{{ 7*7 }}") && page.contains("\u{202e}reversed"));
    // Each text of the user is in an element that isolates its direction.
    for (at, _) in page.match_indices('\u{202e}') {
        let before = &page[..at];
        let opens = ["<bdi>", "<p>", "<h3>"].iter().filter_map(|tag| before.rfind(tag)).max().unwrap();
        let closes = ["</bdi>", "</p>", "</h3>"].iter().filter_map(|tag| before.rfind(tag)).max().unwrap_or(0);
        assert!(opens > closes, "{}", &before[before.len().saturating_sub(200)..]);
    }
}

/// The format allows only names of letters, digits and underscores. The drawing does not rely on this.
#[test]
fn markup_in_names_of_a_scene_stays_text() {
    let text = definition("LandingGearRetraction");
    let component = Component::from_definition(MECHANISM, &text).unwrap();
    let Picture::Mechanism { name, mut scene, start, typical, stops } = Picture::new(&component, &text).unwrap() else {
        panic!()
    };
    for name in [&mut scene.joints[1].name, &mut scene.bodies[1].name, &mut scene.actuators[0].name] {
        *name = HOSTILE.to_owned();
    }
    let [drawing, _] = Picture::Mechanism { name, scene, start, typical, stops }.of_the_page();
    for colours in [Colours::Own, Colours::OfThePage] {
        let svg = to_svg(&drawing, colours, "hostile").unwrap();
        assert_eq!(
            (svg.matches("</svg>").count(), svg.matches("<script").count(), svg.matches("<img").count()),
            (1, 0, 0)
        );
        // As an attribute, as the title of a shape and as a label.
        assert!(svg.matches("&lt;/script&gt;").count() >= 6, "{svg}");
        drawn(&svg, HOSTILE_READ);
    }
}

#[test]
fn the_page_loads_nothing_and_links_to_what_is_there() {
    let made = made(MECHANISM, &definition("SliderCrank"), ALL);
    assert_eq!(made.left_out, Vec::<String>::new());
    let page = entry(&made, PAGE);
    assert!(page.contains("default-src 'none'"));
    for outside in ["src=\"", "@import", "url(", "href=\"http", "<script"] {
        assert!(!page.contains(outside), "{outside}");
    }
    let names: Vec<&str> = made.entries.iter().map(|entry| entry.name.as_str()).collect();
    for link in page.split("href=\"").skip(1).map(|rest| rest.split('"').next().unwrap()) {
        if let Some(id) = link.strip_prefix('#') {
            assert!(page.contains(&format!("id=\"{id}\"")), "{link}");
        } else if !link.starts_with("data:") {
            let link = link.replace("&#x2f;", "/");
            let path = link.strip_prefix("../").map_or_else(|| format!("documentation/{link}"), str::to_owned);
            assert!(names.contains(&path.as_str()), "{link}: {names:?}");
        }
    }
    assert!(entry(&made, ANIMATION).contains("\"source\":\"resources/mechanism.json\""));
    assert!(!entry(&made, ANIMATION).contains("somewhere"));
}

#[test]
fn excluded_documents_are_omitted_and_not_linked() {
    let made = made(MECHANISM, &definition("SliderCrank"), Extent { animation: false, results: false });
    let page = entry(&made, PAGE);
    assert!(!page.contains("animation.html") && !page.contains("fmi-ls-ref"));
    assert!(made.entries.iter().all(|entry| entry.name != ANIMATION && !entry.name.starts_with(RESULTS)));
}

#[test]
fn every_model_has_its_files_and_they_are_the_same_each_time() {
    for folder in Workspace::locate().description_folders().unwrap() {
        let kinds = Component::definition_files();
        let kind = kinds.into_iter().find(|kind| folder.join("resources").join(kind).is_file()).unwrap();
        let text = fs::read_to_string(folder.join("resources").join(kind)).unwrap();
        let [one, other] = [0, 1].map(|_| made(kind, &text, ALL));
        assert_eq!(one.left_out, Vec::<String>::new(), "{}", folder.display());
        let content =
            |made: &Made| made.entries.iter().map(|e| (e.name.clone(), e.content.clone())).collect::<Vec<_>>();
        assert!(content(&one) == content(&other), "{}", folder.display());
        for name in [ICON, TERMINAL_ICONS[0]] {
            let icon = one.entries.iter().find(|entry| entry.name == name).unwrap();
            assert!(icon.content.starts_with(b"\x89PNG\r\n"));
        }
        assert!(entry(&one, TERMINAL_ICONS[1]).starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\""));
        assert!(entry(&one, MANIFEST).contains("role=\"result\""));
        assert_eq!(one.entries.iter().any(|entry| entry.name == ANIMATION), kind == MECHANISM);
    }
}

#[test]
fn reference_results_are_those_of_the_engine() {
    let text = definition("LandingGearRetraction");
    let made = made(MECHANISM, &text, ALL);
    let table = entry(&made, &format!("{RESULTS}/LandingGearRetraction_out.csv"));
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let head: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    let column = |name: &str| head.iter().position(|other| other == name).unwrap();
    let rows: Vec<Vec<f64>> =
        reader.records().map(|row| row.unwrap().iter().map(|x| x.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), 151);
    let mut gear = Simulation::open(&text).unwrap();
    gear.initialize().unwrap();
    for row in &rows {
        let angle = gear.get("crank.angle").unwrap();
        // The packer's steps end at multiples of the interval, these steps are equal: they differ by rounding of the
        // time.
        assert!((row[column("crank.angle")] - angle).abs() < 1e-11, "{row:?}");
        gear.step(1e-3).unwrap();
    }
    let inputs = entry(&made, &format!("{RESULTS}/LandingGearRetraction_in.csv"));
    let lines: Vec<&str> = inputs.lines().collect();
    assert!(lines[0].starts_with("\"time\",\"actuator.force\""), "{}", lines[0]);
    assert!(lines[1].starts_with("0,30000,") && lines[2].starts_with("0.15,30000,"), "{inputs}");
}

/// If a run fails, the FMU has no results, and a message states this.
#[test]
fn a_run_that_ends_early_gives_no_results_but_a_page() {
    let mut all: Value = serde_json::from_str(&definition("LandingGearRetraction")).unwrap();
    all["solver"] = json!({ "tolerance": 1e-9, "method": "rigid_fem", "fem_step": 1e-5 });
    all["experiment"] = json!({ "stop_time": 0.3, "step_size": 0.001 });
    let made = made(MECHANISM, &all.to_string(), ALL);
    assert_eq!(made.left_out.len(), 1);
    assert!(
        made.left_out[0].starts_with("no reference results were written: ")
            && made.left_out[0].contains("the run ends at")
    );
    assert!(made.entries.iter().all(|entry| !entry.name.starts_with(RESULTS)));
    assert!(!entry(&made, PAGE).contains("fmi-ls-ref"));
    assert!(entry(&made, ANIMATION).contains("the motion stopped with an error"));
}

#[test]
fn the_icon_of_a_flat_start_shows_another_position() {
    // The gear with crank, coupler and follower on one line has no height.
    let flat = definition::slider_crank([rod(0.5, 1.0), rod(1.0, 1.0), json!({ "mass": 1.0 })], 0.5).with(json!({
        "name": "Flat", "start": { "angle": 0.0, "speed": 1.0 },
        "experiment": { "stop_time": 1.0, "step_size": 0.01 },
    }));
    let text = flat.to_string();
    let component = Component::from_definition(MECHANISM, &text).unwrap();
    let Picture::Mechanism { start, typical, .. } = Picture::new(&component, &text).unwrap() else { panic!() };
    assert!(start[1][0].abs() < 1e-9 && typical[1][0].sin().abs() > 0.5, "{start:?} {typical:?}");
}

#[test]
fn a_folder_may_contain_any_text_about_the_model() {
    let folder = Folder::new("documentation");
    folder.write("resources/mechanism.json", definition("FourBar"));
    let source = |folder: &Path| fmu_build::source::Source::find(&Workspace::locate(), folder).unwrap();
    assert_eq!(source(&folder).readme().unwrap(), None);
    folder.write("README.md", "Größe *x*");
    let readme = source(&folder).readme().unwrap().unwrap();
    assert!(page(&definition("FourBar"), Some(&readme)).contains("<p>Größe <em>x</em></p>"));
    folder.write("README.md", [0xff, 0xfe]);
    assert!(source(&folder).readme().unwrap_err().to_string().contains("is not UTF-8 text"));
}

/// Texts of the elements of this name, in their order.
fn texts(xml: &str, name: &str) -> Vec<String> {
    let (open, close) = (format!("<{name}>"), format!("</{name}>"));
    let parts = xml.split(&open).skip(1);
    parts.map(|part| part[..part.find(&close).unwrap()].to_owned()).collect()
}

fn scene_of(text: &str) -> (String, Component) {
    let component = Component::from_definition(MECHANISM, text).unwrap();
    let made = made(MECHANISM, text, Extent { animation: false, results: false });
    (entry(&made, &scene_path(component.name())).to_owned(), component)
}

#[test]
fn a_scene_names_variables_that_are_there_and_no_shape_twice() {
    let chain = include_str!("../../tests/fixtures/four_bar_chain_40.json");
    let drives = include_str!("../../tests/fixtures/two_drives.json");
    for text in [&definition("LandingGearRetraction"), chain, drives] {
        let (scene, component) = scene_of(text);
        assert_eq!(scene, scene_of(text).0, "the same bytes");
        let named = texts(&scene, "cref");
        assert!(!named.is_empty());
        assert!(named.iter().all(|name| component.interface().find(name).is_some()), "{named:?}");
        let mut idents = texts(&scene, "ident");
        let count = idents.len();
        idents.sort();
        idents.dedup();
        assert_eq!(idents.len(), count);
        let constants: Vec<f64> = texts(&scene, "exp").iter().map(|value| value.parse().unwrap()).collect();
        assert!(constants.iter().all(|value| value.is_finite()));
    }
}

/// A drive along a prismatic joint has the length of its own variable, as long as it stays positive. A drive between
/// two points has no direction in the scene.
#[test]
fn a_scene_draws_the_drives_whose_direction_it_has() {
    let drives = include_str!("../../tests/fixtures/two_drives.json");
    let shape = |scene: &str, ident: &str| {
        texts(scene, "shape").into_iter().find(|shape| texts(shape, "ident") == [ident.to_owned()])
    };
    let (scene, _) = scene_of(drives);
    let ram = shape(&scene, "drive.ram").unwrap();
    assert!(texts(&ram, "length")[0].contains("<cref>ram.position</cref>"), "{ram}");
    assert_eq!(shape(&scene, "drive.servo"), None, "it turns");
    assert_eq!(shape(&scene_of(&definition("LandingGearRetraction")).0, "drive.actuator"), None);
    let mut shifted: Value = serde_json::from_str(drives).unwrap();
    // The guide starts beyond the travel of the slider.
    shifted["bodies"]["ground"] = json!({ "points": { "far": [9.0, 0.0] } });
    let joint = shifted["actuators"]["ram"]["joint"].as_str().unwrap().to_owned();
    shifted["joints"][&joint]["first"] = json!("ground.far");
    shifted["guess"][&joint] = json!(-8.65);
    assert_eq!(shape(&scene_of(&shifted.to_string()).0, "drive.ram"), None);
}
