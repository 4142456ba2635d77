//! The schema of a definition from its tables of keys.
//!
//! In: the elements of a definition, rules about combinations of keys. Out: the text of its schema. The module must not
//! know laws.

use linkage_fmu::format::{Element, Json, Key, Kind, Names, Node, Range, Short, parse, quoted};
use linkage_fmu::hydraulics::network::definition as network;
use linkage_fmu::mechanism::definition::CouplingKind;

/// Rules about combinations of keys, which are merged into the elements with these names.
const RULES: &str = include_str!("rules.json");
/// Largest length of a line with more than one key.
const WIDTH: usize = 118;
/// Text of the error that an invalid generated schema would give.
const SOUND: &str = "what is put together here is JSON";

/// The text of the schema of this definition file.
pub fn schema(definition_file: &str) -> String {
    let is_mechanism = definition_file == "mechanism.json";
    let elements = elements(definition_file);
    let schema = Schema { elements: &elements, takes_expressions: is_mechanism };
    let rules = if is_mechanism { Value::read(RULES) } else { Value::Object(Vec::new()) };
    let [first, end] = if is_mechanism { ["A-Za-z", ", \"maxLength\": 200"] } else { ["A-Za-z_", ""] };
    let name = |more: &str| {
        format!(
            r#"{{ "type": "string", "pattern": "^[{first}][A-Za-z0-9_]*{more}$", "not": {{ "pattern": "\\n" }}{end} }}"#
        )
    };
    let mut all = Value::Object(vec![
        ("$schema".into(), Value::Raw("\"https://json-schema.org/draft/2020-12/schema\"".into())),
        (
            "title".into(),
            Value::text(match definition_file {
                "mechanism.json" => "Mechanism of linkage-fmu",
                "network.json" => "Hydraulic system of linkage-fmu",
                "system.json" => "System of FMUs of linkage-fmu",
                _ => "Hydraulic actuator of linkage-fmu",
            }),
        ),
    ]);
    let mut definitions = Value::Object(vec![("name".into(), Value::read(&name("")))]);
    if is_mechanism {
        let point = r#"{ "type": "string", "pattern": "^[A-Za-z][A-Za-z0-9_]*\\.[A-Za-z][A-Za-z0-9_]*$",
            "not": { "pattern": "\\n" } }"#;
        definitions.merge("point", Value::read(point));
        let body = elements.iter().find(|(name, _)| name == "body").map(|(_, body)| schema.element(body));
        definitions.merge("ground", ground(&body.unwrap_or(Value::Raw(String::new()))));
    }
    for (name, element) in &elements {
        let mut value = schema.element(element);
        if name == "coupling" && is_mechanism {
            value.merge("oneOf", kinds(element));
        }
        if let (true, Value::Object(members)) = (name == "network", &mut value) {
            // The name of the mechanism is the name of the FMU.
            members.retain(|(key, _)| key != "required");
        }
        if let Value::Object(members) = &rules {
            let own = members.iter().find(|(own, _)| own == name);
            own.into_iter().for_each(|(_, rule)| value.merge_all(rule.clone()));
        }
        if name.is_empty() { all.merge_all(value) } else { definitions.merge(name, value) }
    }
    all.merge("$defs", definitions);
    let mut text = String::new();
    all.print("", "", &mut text);
    text + "\n"
}

/// The elements of a definition file with their names in its schema. The first element is the whole file. A mechanism
/// may contain a network.
fn elements(definition_file: &str) -> Vec<(String, Element)> {
    let own = crate::reference::elements(definition_file).into_iter();
    let mut all: Vec<_> = own.map(|element| (element.name.to_owned(), element)).collect();
    if definition_file == "mechanism.json" {
        for element in network::ELEMENTS {
            if all.iter().all(|(_, known)| known.table != element.table) {
                let name = if element.name.is_empty() { "network".into() } else { format!("network_{}", element.name) };
                all.push((name, element));
            }
        }
    }
    all
}

/// The keys of a body that the ground may have.
fn ground(body: &Value) -> Value {
    let Value::Object(members) = body else { unreachable!("{SOUND}") };
    let mut ground = Value::read(
        r#"{ "description": "The body that does not move; its frame is the mechanism frame.", "type": "object",
            "additionalProperties": false, "properties": {} }"#,
    );
    let Some((_, Value::Object(properties))) = members.iter().find(|(name, _)| name == "properties") else {
        return ground;
    };
    let own = properties.iter().filter(|(key, _)| ["length", "points"].contains(&key.as_str())).cloned().collect();
    ground.merge("properties", Value::Object(own));
    ground
}

/// The keys of each kind of coupling.
fn kinds(coupling: &Element) -> Value {
    let kinds = CouplingKind::ALL.into_iter().filter(|kind| *kind != CouplingKind::Screw).map(|kind| {
        let (needed, allowed) = kind.keys();
        let others = coupling
            .table
            .names()
            .filter(|key| !["type", "first", "phase"].contains(key) && !needed.contains(key) && !allowed.contains(key));
        let mut properties = vec![("type".to_owned(), Value::read(&format!("{{ \"const\": \"{}\" }}", kind.word())))];
        properties.extend(others.map(|key| (key.to_owned(), Value::Raw("false".into()))));
        let required = needed.iter().map(|key| Value::text(key)).collect();
        Value::Object(vec![
            ("properties".into(), Value::Object(properties)),
            ("required".into(), Value::List(required)),
        ])
    });
    Value::List(kinds.collect())
}

struct Schema<'e> {
    elements: &'e [(String, Element)],
    /// Whether a text may replace a number.
    takes_expressions: bool,
}

impl Schema<'_> {
    /// An object with the keys of an element.
    fn element(&self, element: &Element) -> Value {
        let keys = || element.table.keys.iter().enumerate().filter(|(_, key)| !key.is_written_only);
        let mut value = Value::Object(vec![
            ("description".into(), Value::text(element.about.trim())),
            ("type".into(), Value::text("object")),
        ]);
        let required: Vec<Value> =
            keys().filter(|(_, key)| key.is_required).map(|(_, key)| Value::text(key.name)).collect();
        if !required.is_empty() {
            value.merge("required", Value::List(required));
        }
        value.merge("additionalProperties", Value::Raw("false".into()));
        let properties = keys().map(|(index, key)| {
            let mut property = Value::Object(vec![("description".into(), Value::text(element.docs[index].trim()))]);
            property.merge_all(self.value(&key.kind, key));
            if let Some(default) = element.default_of(index) {
                property.merge("default", Value::read(&default));
            }
            (key.name.to_owned(), property)
        });
        value.merge("properties", Value::Object(properties.collect()));
        value
    }

    /// Schema of the value of a key, or of an item in its list or group.
    fn value(&self, kind: &Kind, key: &Key) -> Value {
        let read = |text: String| Value::read(&text);
        match kind {
            Kind::Number | Kind::Whole => {
                let word = if key.range == Range::Count { "integer" } else { "number" };
                let types = if self.takes_expressions { format!("[\"{word}\", \"string\"]") } else { quoted(word) };
                let mut value = read(format!("{{ \"type\": {types} }}"));
                let least = if key.range.is_open() { "exclusiveMinimum" } else { "minimum" };
                for (name, bound) in [least, "maximum"].into_iter().zip(key.range.bounds()) {
                    if let Some(bound) = bound {
                        value.merge(name, Value::Raw(number(bound)));
                    }
                }
                value
            }
            Kind::Flag => read("{ \"type\": \"boolean\" }".into()),
            Kind::Text => match key.names {
                Names::Nothing => read("{ \"type\": \"string\" }".into()),
                Names::Line => read(r#"{ "type": "string", "not": { "pattern": "[\\x00-\\x1f\\x7f-\\x9f]" } }"#.into()),
                Names::Element => read("{ \"$ref\": \"#/$defs/name\" }".into()),
                Names::Point => read("{ \"$ref\": \"#/$defs/point\" }".into()),
            },
            Kind::Pair => {
                let mut value = read("{ \"type\": \"array\", \"minItems\": 2, \"maxItems\": 2 }".into());
                value.merge("items", self.value(&Kind::Number, key));
                value
            }
            Kind::Word(words) => {
                let words = words.iter().filter(|word| **word != CouplingKind::Screw.word() || key.name != "type");
                Value::Object(vec![("enum".into(), Value::List(words.map(|word| Value::text(word)).collect()))])
            }
            Kind::Object(table) => {
                let own = self.elements.iter().find(|(_, element)| element.table == *table);
                let name = own.map_or("", |(name, _)| name.as_str());
                let object = read(format!("{{ \"$ref\": \"#/$defs/{name}\" }}"));
                let short = match table.short {
                    Short::None => return object,
                    Short::First => self.value(&table.keys[0].kind, &table.keys[0]),
                    Short::Word(word) => read(format!("{{ \"const\": \"{word}\" }}")),
                };
                Value::Object(vec![("oneOf".into(), Value::List(vec![short, object]))])
            }
            Kind::Group(of) => {
                // Names of variables are texts of one line.
                let names = match key.names {
                    Names::Line => "",
                    _ => ", \"propertyNames\": { \"$ref\": \"#/$defs/name\" }",
                };
                let mut value = read(format!("{{ \"type\": \"object\"{names} }}"));
                value.merge("additionalProperties", self.value(of, key));
                value
            }
            Kind::List(of) => {
                let least = if matches!(of, Kind::Pair) { ", \"minItems\": 2" } else { "" };
                let mut value = read(format!("{{ \"type\": \"array\"{least} }}"));
                value.merge("items", self.value(of, key));
                value
            }
            Kind::Own(_) if key.names == Names::Line => read(r#"{ "type": ["number", "boolean", "string"] }"#.into()),
            Kind::Own(_) => Value::Object(Vec::new()),
        }
    }
}

fn number(value: f64) -> String {
    if value.abs() >= 1e15 { format!("{value:e}") } else { value.to_string() }
}

/// JSON whose members keep their order.
#[derive(Clone)]
enum Value {
    Raw(String),
    List(Vec<Self>),
    Object(Vec<(String, Self)>),
}

impl Value {
    fn text(text: &str) -> Self {
        Self::Raw(quoted(text))
    }

    fn read(text: &str) -> Self {
        Self::of(text, &parse("schema", text).expect(SOUND))
    }

    fn of(text: &str, node: &Node) -> Self {
        match &node.json {
            Json::List(nodes) => Self::List(nodes.iter().map(|node| Self::of(text, node)).collect()),
            Json::Object(members) => {
                Self::Object(members.iter().map(|member| (member.key.clone(), Self::of(text, &member.value))).collect())
            }
            _ => Self::Raw(text[node.span.clone()].to_owned()),
        }
    }

    /// Give an object a member. If the member is an object already, the members of the new one are added to it.
    fn merge(&mut self, key: &str, value: Self) {
        let Self::Object(members) = self else { return };
        match (members.iter_mut().find(|(known, _)| known == key), value) {
            (Some((_, known @ Self::Object(_))), value @ Self::Object(_)) => known.merge_all(value),
            (Some((_, known)), value) => *known = value,
            (None, value) => members.push((key.to_owned(), value)),
        }
    }

    fn merge_all(&mut self, other: Self) {
        if let Self::Object(members) = other {
            members.into_iter().for_each(|(key, value)| self.merge(&key, value));
        }
    }

    /// The text on one line.
    fn compact(&self) -> String {
        match self {
            Self::Raw(text) => text.clone(),
            Self::List(values) => format!("[{}]", values.iter().map(Self::compact).collect::<Vec<_>>().join(", ")),
            Self::Object(members) if members.is_empty() => "{}".into(),
            Self::Object(members) => {
                let members: Vec<String> =
                    members.iter().map(|(key, value)| format!("{}: {}", quoted(key), value.compact())).collect();
                format!("{{ {} }}", members.join(", "))
            }
        }
    }

    /// The text with one key per line.
    fn print(&self, indent: &str, key: &str, out: &mut String) {
        let line = self.compact();
        let is_key = matches!(self, Self::Object(members) if members.iter().any(|(key,
            value)| key == "description" && matches!(value, Self::Raw(_)))
            && members.iter().all(|(key, _)| key != "properties"));
        let inner = format!("{indent}  ");
        let (open, close, parts): (_, _, Vec<(String, &Self)>) = match self {
            Self::List(values) => ("[", "]", values.iter().map(|value| (String::new(), value)).collect()),
            Self::Object(members) => {
                ("{", "}", members.iter().map(|(key, value)| (format!("{}: ", quoted(key)), value)).collect())
            }
            Self::Raw(_) => ("", "", Vec::new()),
        };
        if parts.is_empty() || is_key || indent.len() + key.len() + line.len() <= WIDTH {
            out.push_str(&line);
            return;
        }
        out.push_str(open);
        for (place, (key, value)) in parts.iter().enumerate() {
            out.push_str(if place == 0 { "\n" } else { ",\n" });
            out.push_str(&inner);
            out.push_str(key);
            value.print(&inner, key, out);
        }
        out.push('\n');
        out.push_str(indent);
        out.push_str(close);
    }
}
