//! The kinds of `scenes/kinds.json`: usual lengths with their spread, a closed form as text, bodies and slides.
//!
//! In: the file. Out: sketches. A kind `like` another one inherits all that it does not state itself. Three kinds with
//! a random number of parts have a program each.
use super::expression::Term;
use super::jet::{Jet, Vector};
use super::sketch::{Coordinate, Miss, Sketch};
use super::{Vary, serial};
use serde_json::{Map, Value};

const FILE: &str = include_str!("../../scenes/kinds.json");

/// A kind of mechanism.
pub struct Kind {
    /// Usual name in engineering.
    pub name: String,
    source: Source,
}

enum Source {
    Words(Box<Words>),
    Program(fn(&mut Vary) -> Sketch),
}

/// A name and its term.
type Named = (String, Term);

/// A kind as text.
struct Words {
    name: String,
    /// Usual lengths; usual angles and their spread.
    lengths: Vec<(String, f64)>,
    angles: Vec<(String, [f64; 2])>,
    /// Values that follow from these.
    values: Vec<Term>,
    start: [f64; 2],
    /// Values that follow from the parameter; the last `points` of them are the points.
    steps: Vec<Term>,
    points: usize,
    ground: Vec<usize>,
    parts: Vec<Part>,
    coordinate: Coordinate,
}

/// A body or a guide, with its name and the point at its origin.
struct Part {
    name: String,
    at: usize,
    shape: Shape,
}

enum Shape {
    /// To another point, with further points.
    Rod { end: usize, length: Term, points: Vec<(usize, Term)> },
    /// On the ground or a body, through a point of it; a guide of the existing block, or a separate block.
    Slide { on: Option<usize>, from: usize, axis: Term, block: Option<usize> },
}

/// All kinds of the file.
pub fn read() -> Result<Vec<Kind>, String> {
    let file: Vec<Map<String, Value>> = serde_json::from_str(FILE).map_err(|e| e.to_string())?;
    file.iter().map(|own| kind(own, &file).map_err(|why| format!("{own:?}: {why}"))).collect()
}

fn kind(own: &Map<String, Value>, file: &[Map<String, Value>]) -> Result<Kind, String> {
    let name = own.get("kind").and_then(Value::as_str).ok_or("no kind")?.to_owned();
    if let Some(program) = own.get("program").and_then(Value::as_str) {
        let program = serial::PROGRAMS.iter().find(|(word, _)| *word == program).ok_or("no such program")?;
        return Ok(Kind { name, source: Source::Program(program.1) });
    }
    let base = own.get("like").and_then(|like| file.iter().find(|other| other.get("kind") == Some(like)));
    let of = |key: &str| own.get(key).or_else(|| base?.get(key));
    let text = |key: &str| of(key).and_then(Value::as_str);
    let list = |key: &str| of(key).and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str);
    let pairs = |key: &'static str| {
        let halves = |line: &'_ str| {
            let (name, value) = line.split_once(" = ").ok_or_else(|| format!("{key}: {line}"))?;
            Ok::<_, String>((name.to_owned(), value.to_owned()))
        };
        list(key).map(halves).collect::<Result<Vec<_>, _>>()
    };
    let number = |text: &str| Term::read(text, &[])?.value(&[]).map(|v| v.x.value()).map_err(|e| format!("{e:?}"));
    let spread = |text: &str| {
        let (usual, most) = text.split_once(" +- ").ok_or_else(|| format!("no spread: {text}"))?;
        Ok::<_, String>([number(usual)?, number(most)?])
    };
    let mut names = Vec::new();
    let (mut lengths, mut angles) = (Vec::new(), Vec::new());
    for (name, usual) in pairs("lengths")? {
        lengths.push((name.clone(), number(&usual)?));
        names.push(name);
    }
    for (name, usual) in pairs("angles")? {
        angles.push((name.clone(), spread(&usual)?));
        names.push(name);
    }
    let terms = |all: Vec<(String, String)>, names: &mut Vec<String>| -> Result<Vec<Named>, String> {
        all.into_iter()
            .map(|(name, text)| {
                let term = Term::read(&text, names)?;
                names.push(name.clone());
                Ok((name, term))
            })
            .collect()
    };
    let values = terms(pairs("values")?, &mut names)?;
    let constants = names.clone();
    names.push("t".into());
    let steps = terms(pairs("with")?, &mut names)?;
    let points = terms(pairs("points")?, &mut names)?;
    let point =
        |name: &str| points.iter().position(|(own, _)| own == name).ok_or_else(|| format!("there is no point {name}"));
    let mut parts = Vec::new();
    for line in list("bodies") {
        let part = Part::read(line, &parts, &point, &|text| Term::read(text, &constants));
        parts.push(part.map_err(|why| format!("{line}: {why}"))?);
    }
    let coordinate = match text("coordinate") {
        None => Coordinate::Angle(0),
        Some("slide 0") => Coordinate::Position(0),
        Some(body) => Coordinate::Angle(body_of(&parts, |part| part.name == body)?),
    };
    let ground = text("ground").unwrap_or_default().split(' ').map(point).collect::<Result<_, _>>()?;
    let words = Words {
        name: text("name").ok_or("no name")?.to_owned(),
        start: spread(text("start").ok_or("no start")?)?,
        lengths,
        angles,
        values: values.into_iter().map(|(_, term)| term).collect(),
        points: points.len(),
        steps: steps.into_iter().chain(points).map(|(_, term)| term).collect(),
        ground,
        parts,
        coordinate,
    };
    Ok(Kind { name, source: Source::Words(Box::new(words)) })
}

impl Part {
    fn is_body(&self) -> bool {
        !matches!(self.shape, Shape::Slide { block: Some(_), .. })
    }

    /// Parse `name: from to end, length with point local`, `name: point on rail along axis` or `guide name: ...`; a
    /// rail is a point of the ground, or of a body as `body.point`.
    fn read(
        line: &str,
        before: &[Self],
        point: &dyn Fn(&str) -> Result<usize, String>,
        term: &dyn Fn(&str) -> Result<Term, String>,
    ) -> Result<Self, String> {
        let (name, rest) = line.split_once(": ").ok_or("no name")?;
        if let Some((from, rest)) = rest.split_once(" to ") {
            let mut pieces = rest.split(" with ");
            let (end, length) = pieces.next().and_then(|piece| piece.split_once(", ")).ok_or("no length")?;
            let points = pieces.map(|piece| {
                let (name, local) = piece.split_once(' ').ok_or("no place")?;
                Ok::<_, String>((point(name)?, term(local)?))
            });
            let (points, at) = (points.collect::<Result<_, _>>()?, point(from)?);
            let shape = Shape::Rod { end: point(end)?, length: term(length)?, points };
            return Ok(Self { name: name.into(), at, shape });
        }
        let (at, rest) = rest.split_once(" on ").ok_or("neither rod nor slide")?;
        let (rail, axis) = rest.split_once(" along ").ok_or("no axis")?;
        let (at, axis) = (point(at)?, term(axis)?);
        let (on, from) = match rail.split_once('.') {
            Some((body, from)) => (Some(body_of(before, |part| part.name == body)?), from),
            None => (None, rail),
        };
        let (name, block) = match name.strip_prefix("guide ") {
            Some(name) => (name, Some(body_of(before, |part| part.at == at)?)),
            None => (name, None),
        };
        Ok(Self { name: name.into(), at, shape: Shape::Slide { on, from: point(from)?, axis, block } })
    }
}

/// The number of the last body that fulfils a condition.
fn body_of(parts: &[Part], is_it: impl Fn(&Part) -> bool) -> Result<usize, String> {
    let mut bodies: Vec<&Part> = parts.iter().filter(|part| part.is_body()).collect();
    bodies.iter_mut().rposition(|part| is_it(part)).ok_or_else(|| "there is no such body".into())
}

impl Kind {
    /// A mechanism of this kind.
    pub fn sketch(&'static self, vary: &mut Vary) -> Sketch {
        match &self.source {
            Source::Words(words) => words.sketch(vary),
            Source::Program(program) => program(vary),
        }
    }
}

impl Words {
    fn sketch(&'static self, vary: &mut Vary) -> Sketch {
        let real = |x: f64| Vector::from(Jet::from(x));
        let mut constants: Vec<Vector> = self.lengths.iter().map(|(_, usual)| real(vary.length(*usual))).collect();
        constants.extend(self.angles.iter().map(|(_, [usual, most])| real(vary.angle(*usual, *most))));
        for term in &self.values {
            // Neither circles nor lines: these always have values.
            constants.push(term.value(&constants).unwrap_or_default());
        }
        let of = |term: &Term| term.value(&constants).unwrap_or_default();
        let (real, local) = (|term: &Term| of(term).x.value(), |term: &Term| of(term).place());
        let [usual, most] = self.start;
        let start = vary.angle(usual, most);
        let given = constants.clone();
        let mut out = Sketch::new(&self.name, start, move |t| self.places(&given, t)).by(self.coordinate);
        let fixed = self.places(&constants, Jet::variable(usual)).unwrap_or_default();
        for &point in &self.ground {
            out = out.ground(&[(point, fixed.get(point).copied().unwrap_or_default().place())]);
        }
        for part in &self.parts {
            let (name, at) = (part.name.as_str(), part.at);
            out = match &part.shape {
                Shape::Rod { end, length, points } => {
                    let points: Vec<_> = points.iter().map(|(point, term)| (*point, local(term))).collect();
                    out.plate(name, at, *end, real(length), &points)
                }
                Shape::Slide { on, from, axis, block: None } => out.slider(name, at, *on, *from, real(axis)),
                Shape::Slide { on, from, axis, block: Some(block) } => out.guided(name, *on, *from, real(axis), *block),
            };
        }
        out
    }

    fn places(&self, constants: &[Vector], t: Jet) -> Result<Vec<Vector>, Miss> {
        let mut named = Vec::with_capacity(constants.len() + 1 + self.steps.len());
        named.extend_from_slice(constants);
        named.push(t.into());
        for term in &self.steps {
            named.push(term.value(&named)?);
        }
        Ok(named.split_off(named.len() - self.points))
    }
}
