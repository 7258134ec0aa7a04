//! From text to a scene whose every value is in range; how values fit together is `validate`'s business.
//!
//! The reader walks TOML's own table, in which every key and value knows its place in the text, and goes on after a
//! fault, so that one run names all of them.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::limits::{
    COORDINATE, EMISSION, INDEX, Limits, NEAR, PLANE_HEIGHT, PLANE_WIDTH, RADIUS, REFLECTANCE,
};
use super::{Camera, FORMAT, Fault, MAX_SPHERES, Material, Sphere};

/// A scene with the places of its parts in the text.
pub(super) struct Draft {
    pub(super) camera: Camera,
    pub(super) camera_at: usize,
    pub(super) spheres: Vec<Placed>,
}

/// A sphere and the byte where its table begins.
pub(super) struct Placed {
    pub(super) sphere: Sphere,
    pub(super) at: usize,
}

/// The text, and what has been found wrong with it.
pub(super) struct Source<'a> {
    file: &'a str,
    text: &'a str,
    faults: Vec<Fault>,
}

impl<'a> Source<'a> {
    pub(super) fn new(file: &'a str, text: &'a str) -> Self {
        Self {
            file,
            text,
            faults: Vec::new(),
        }
    }

    /// Notes a fault at byte `at`.
    pub(super) fn fault(&mut self, at: usize, message: impl Into<String>) {
        let before = self.text.get(..at).unwrap_or(self.text);
        let start_of_line = before.rfind('\n').map_or(0, |newline| newline + 1);
        self.faults.push(Fault {
            file: self.file.to_owned(),
            line: self.line(at),
            column: before[start_of_line..].chars().count() + 1,
            message: message.into(),
        });
    }

    /// The line of byte `at`, from 1.
    pub(super) fn line(&self, at: usize) -> usize {
        let before = self.text.get(..at).unwrap_or(self.text);
        before.bytes().filter(|&byte| byte == b'\n').count() + 1
    }

    /// All faults in the order of the text.
    pub(super) fn into_faults(mut self) -> Vec<Fault> {
        self.faults.sort_by_key(|fault| (fault.line, fault.column));
        self.faults
    }

    pub(super) fn is_clean(&self) -> bool {
        self.faults.is_empty()
    }

    /// Reads the whole text; `None` when there was a fault.
    pub(super) fn read(&mut self) -> Option<Draft> {
        let document = match DeTable::parse(self.text) {
            Ok(document) => document,
            Err(error) => {
                let at = error.span().map_or(0, |span| span.start);
                self.fault(
                    at,
                    format!("not valid TOML: {}", error.message().replace('\n', "; ")),
                );
                return None;
            }
        };
        let mut root = Table {
            title: "the scene".to_owned(),
            at: 0,
            entries: document.get_ref(),
            source: self,
        };
        root.check_format()?;
        root.refuse_unknown(&["format", "camera", "sphere"]);
        let camera = root.camera();
        let spheres = root.spheres();
        let (camera, camera_at) = camera?;
        let draft = Draft {
            camera,
            camera_at,
            spheres: spheres?,
        };
        self.is_clean().then_some(draft)
    }
}

/// A table being read. Its readers note a fault and return `None` where a value will not do.
struct Table<'t, 's, 'a> {
    /// How messages speak of it.
    title: String,
    /// Where it begins.
    at: usize,
    entries: &'t DeTable<'a>,
    source: &'s mut Source<'a>,
}

impl<'t, 'a> Table<'t, '_, 'a> {
    fn check_format(&mut self) -> Option<()> {
        let Some(value) = self.entries.get("format") else {
            self.source.fault(
                0,
                format!("the scene has no `format`; begin the file with `format = {FORMAT}`"),
            );
            return None;
        };
        let format = value
            .get_ref()
            .as_integer()
            .and_then(|i| i64::from_str_radix(i.as_str(), i.radix()).ok());
        if format != Some(FORMAT) {
            let cause =
                format!("this build reads scene format {FORMAT} and no other; write `format = {FORMAT}`");
            self.source
                .fault(value.span().start, format!("{cause} (see docs/scene-format.md)"));
            return None;
        }
        Some(())
    }

    fn camera(&mut self) -> Option<(Camera, usize)> {
        let value = self.required("camera", "a `[camera]` table")?;
        let Some(entries) = value.get_ref().as_table() else {
            self.wrong_type("camera", value, "a table", "write `[camera]`");
            return None;
        };
        let at = value.span().start;
        let mut table = Table {
            title: "the camera".to_owned(),
            at,
            entries,
            source: &mut *self.source,
        };
        table.refuse_unknown(&[
            "position",
            "direction",
            "up",
            "plane_height",
            "plane_width",
            "near",
        ]);
        let position = table.point("position");
        let direction = table.direction("direction");
        let up = if entries.contains_key("up") {
            table.direction("up")
        } else {
            Some([0.0, 1.0, 0.0])
        };
        let plane_height = table.number("plane_height", &PLANE_HEIGHT);
        let plane_width = if entries.contains_key("plane_width") {
            table.number("plane_width", &PLANE_WIDTH).map(Some)
        } else {
            Some(None)
        };
        let near = if entries.contains_key("near") {
            table.number("near", &NEAR)
        } else {
            Some(0.0)
        };
        let camera = Camera {
            position: position?,
            direction: direction?,
            up: up?,
            plane_height: plane_height?,
            plane_width: plane_width?,
            near: near?,
        };
        Some((camera, at))
    }

    fn spheres(&mut self) -> Option<Vec<Placed>> {
        let Some(value) = self.entries.get("sphere") else {
            self.source.fault(
                self.source.text.len(),
                "the scene is empty; add at least one `[[sphere]]`",
            );
            return None;
        };
        let Some(list) = value.get_ref().as_array() else {
            self.wrong_type(
                "sphere",
                value,
                "a list of tables",
                "write `[[sphere]]` with two brackets",
            );
            return None;
        };
        if list.is_empty() {
            self.source.fault(
                value.span().start,
                "the scene is empty; add at least one `[[sphere]]`",
            );
        }
        if let Some(surplus) = list.get(MAX_SPHERES) {
            let message = format!(
                "{} spheres, but a core has room for {MAX_SPHERES}; remove some",
                list.len()
            );
            self.source.fault(surplus.span().start, message);
            return None;
        }
        let mut all = Some(Vec::new());
        for (number, value) in (1..).zip(list.iter()) {
            let Some(entries) = value.get_ref().as_table() else {
                self.wrong_type(
                    "sphere",
                    value,
                    "a table",
                    "write `[[sphere]]` with its keys below",
                );
                all = None;
                continue;
            };
            let at = value.span().start;
            let title = match entries.get("name").and_then(|name| name.get_ref().as_str()) {
                Some(name) => format!("sphere \"{}\"", name.escape_debug()),
                None => format!("sphere {number}"),
            };
            let sphere = Table {
                title,
                at,
                entries,
                source: &mut *self.source,
            }
            .sphere();
            match (&mut all, sphere) {
                (Some(all), Some(sphere)) => all.push(Placed { sphere, at }),
                _ => all = None,
            }
        }
        all
    }

    fn sphere(mut self) -> Option<Sphere> {
        self.refuse_unknown(&[
            "name", "centre", "radius", "hollow", "emission", "diffuse", "mirror", "glass", "index",
        ]);
        let name = self.name();
        let centre = self.point("centre");
        let radius = self.number("radius", &RADIUS);
        let hollow = self.flag("hollow");
        let emission = match self.entries.get("emission") {
            Some(_) => self.triple("emission", &EMISSION),
            None => Some([0.0; 3]),
        };
        let material = self.material();
        if let (Some(Material::Glass { .. }), Some(hollow), Some(emission)) = (material, hollow, emission) {
            if hollow {
                self.fault_at(
                    "hollow",
                    "is glass and `hollow`; glass is solid: remove one of the two",
                );
            }
            if emission != [0.0; 3] {
                self.fault_at(
                    "emission",
                    "is glass and has `emission`; glass does not shine: remove one of the two",
                );
            }
        }
        Some(Sphere {
            name: name?,
            centre: centre?,
            radius: radius?,
            hollow: hollow?,
            emission: emission?,
            material: material?,
        })
    }

    fn material(&mut self) -> Option<Material> {
        let given: Vec<&str> = ["diffuse", "mirror", "glass"]
            .into_iter()
            .filter(|key| self.entries.contains_key(*key))
            .collect();
        let kind = match given[..] {
            [one] => one,
            [] => {
                let cause =
                    "has no material; add `diffuse = [r, g, b]`, `mirror = [r, g, b]` or `glass = [r, g, b]`";
                self.source.fault(self.at, format!("{} {cause}", self.title));
                return None;
            }
            [first, second, ..] => {
                self.fault_at(
                    second,
                    &format!("has both `{first}` and `{second}`; keep one material"),
                );
                return None;
            }
        };
        if kind != "glass" && self.entries.contains_key("index") {
            self.fault_at(
                "index",
                &format!("has an `index` but is `{kind}`; only glass has one: remove it"),
            );
        }
        let colour = self.triple(kind, &REFLECTANCE);
        Some(match kind {
            "diffuse" => Material::Diffuse(colour?),
            "mirror" => Material::Mirror(colour?),
            _ => {
                let index = self.number("index", &INDEX);
                Material::Glass {
                    tint: colour?,
                    index: index?,
                }
            }
        })
    }

    /// Refuses keys not in `known`, and says which known one is nearest.
    fn refuse_unknown(&mut self, known: &[&str]) {
        for key in self.entries.keys() {
            let name = key.get_ref().as_ref();
            if known.contains(&name) {
                continue;
            }
            let nearest = known
                .iter()
                .map(|known| (strsim::damerau_levenshtein(name, known), known))
                .min()
                .filter(|(distance, _)| *distance <= 3);
            let hint = match nearest {
                Some((_, nearest)) => format!("did you mean `{nearest}`?"),
                None => format!("the keys here are {}", known.join(", ")),
            };
            let message = format!(
                "{} has an unknown key `{}`; {hint}",
                self.title,
                name.escape_debug()
            );
            self.source.fault(key.span().start, message);
        }
    }

    fn name(&mut self) -> Option<String> {
        let value = self.required("name", "e.g. `name = \"lamp\"`")?;
        match value.get_ref().as_str() {
            Some("") => {
                self.fault_at("name", "has an empty `name`; give it one that messages can use");
                None
            }
            Some(name) => Some(name.to_owned()),
            None => {
                self.wrong_type("name", value, "a string", "write e.g. `name = \"lamp\"`");
                None
            }
        }
    }

    /// A flag that is false when left out.
    fn flag(&mut self, key: &str) -> Option<bool> {
        let Some(value) = self.entries.get(key) else {
            return Some(false);
        };
        let flag = value.get_ref().as_bool();
        if flag.is_none() {
            self.wrong_type(key, value, "true or false", "write it without quotes");
        }
        flag
    }

    fn number(&mut self, key: &str, limits: &Limits) -> Option<f64> {
        let value = self.required(key, limits.example)?;
        self.scalar(key, value, limits)
    }

    /// A point within the 16:16 range.
    fn point(&mut self, key: &str) -> Option<[f64; 3]> {
        self.triple(key, &COORDINATE)
    }

    /// A vector of any length above zero, made a unit vector.
    fn direction(&mut self, key: &str) -> Option<[f64; 3]> {
        let v = self.triple(key, &COORDINATE)?;
        let length = v.iter().map(|c| c * c).sum::<f64>().sqrt();
        if length < 1e-6 {
            self.fault_at(
                key,
                &format!("has a `{key}` of no length; give it a direction, e.g. [0, 0, -1]"),
            );
            return None;
        }
        Some(v.map(|c| c / length))
    }

    fn triple(&mut self, key: &str, limits: &Limits) -> Option<[f64; 3]> {
        let value = self.required(key, "three numbers, e.g. [0.5, 0.5, 0.5]")?;
        let components: Vec<_> = value
            .get_ref()
            .as_array()
            .into_iter()
            .flat_map(|list| list.iter())
            .collect();
        let [x, y, z] = components[..] else {
            self.wrong_type(key, value, "three numbers", "write [x, y, z]");
            return None;
        };
        let [x, y, z] = [x, y, z].map(|component| self.scalar(key, component, limits));
        Some([x?, y?, z?])
    }

    fn scalar(&mut self, key: &str, value: &Spanned<DeValue<'a>>, limits: &Limits) -> Option<f64> {
        let number = match value.get_ref() {
            DeValue::Float(float) => float.as_str().parse::<f64>().ok(),
            DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix()).ok().map(|i| i as f64),
            _ => {
                self.wrong_type(key, value, "a number", "write e.g. 16.5");
                return None;
            }
        };
        // An integer too long for 64 bits is out of every range here.
        let number = number.unwrap_or(f64::INFINITY);
        match limits.cause(number) {
            Some(cause) => {
                self.source
                    .fault(value.span().start, format!("{}: `{key}` {cause}", self.title));
                None
            }
            None => Some(number),
        }
    }

    fn required(&mut self, key: &str, example: &str) -> Option<&'t Spanned<DeValue<'a>>> {
        let value = self.entries.get(key);
        if value.is_none() {
            self.source
                .fault(self.at, format!("{} has no `{key}`; add {example}", self.title));
        }
        value
    }

    fn wrong_type(&mut self, key: &str, value: &Spanned<DeValue<'a>>, wanted: &str, next: &str) {
        let found = match value.get_ref() {
            DeValue::Array(list) => format!("a list of {}", list.len()),
            other => format!("a TOML {}", other.type_str()),
        };
        let message = format!("{}: `{key}` must be {wanted}, not {found}; {next}", self.title);
        self.source.fault(value.span().start, message);
    }

    /// Notes a fault of this table where its `key` stands.
    fn fault_at(&mut self, key: &str, predicate: &str) {
        let at = self.entries.get(key).map_or(self.at, |value| value.span().start);
        self.source.fault(at, format!("{} {predicate}", self.title));
    }
}
