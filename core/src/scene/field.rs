//! The numbers that a scene stores, a row each: path, words, unit, limits, the cost of a change, place, and how a screen shows the number.
//!
//! Check and key of a scene, the patient's values, `study::Parameter`, `study::Unknown` and the controls, axes and tables of the app
//! read the rows. Numbers of nodes and cells are whole, see [`super::limits`].

use super::implant::MAX_APEX_SHIFT;
use super::limits::{CHEST_RADIUS_MM, PATCH_RADIUS_MAX_MM, POCKET_RADIUS_MAX_MM};
use super::{Body, Implant, Scene, SceneError, Torso, error::out_of_range};
use crate::clinical::limits::{
    ASPECT, BASE_WIDTH_MM, FULLNESS, MEASURED_WIDTH_MM, PINCH_MM, PROJECTION_MM, PULL_MM,
};
use crate::curve::{SCALES, number};
use std::ops::Deref;

/// Greatest way of the apex \[mm\].
const MOST_APEX_SHIFT_MM: f64 = 0.5 * MAX_APEX_SHIFT * BASE_WIDTH_MM.1;

/// What a change of a number costs a solver that goes from scene to scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Change {
    /// Neither grid nor tables.
    Dome,
    /// Another grid.
    Grid,
    /// Other tables.
    Tables,
}

/// What contains a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Every scene.
    Scene,
    /// A scene with a tissue model; a sheet ignores the number.
    Body,
    /// A layer.
    Layer,
    /// The chest; a flat one has no such number.
    Chest,
    /// The built-in torso; another chest has no such number.
    Torso,
    /// The measurements of a patient; no result depends on the number.
    Patient,
}

/// The scale of a number on a screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// The unit.
    pub unit: &'static str,
    /// The shown number by the stored one.
    pub factor: f64,
    /// The step of a control \[`unit`\]; 0: three significant digits.
    pub step: f64,
    /// The least number of decimals.
    pub decimals: usize,
}

/// Lengths in cm.
pub const CM: Scale = Scale { unit: "cm", factor: 0.1, step: 0.1, decimals: 1 };
/// Half-axes in mm as widths in cm.
const WIDTH: Scale = Scale { factor: 0.2, ..CM };
const MM: Scale = Scale { unit: "mm", factor: 1.0, step: 0.5, decimals: 1 };
const THIN: Scale = Scale { step: 0.1, ..MM };
const PERCENT: Scale = Scale { unit: "%", factor: 100.0, step: 1.0, decimals: 0 };
const OF_RADIUS: Scale = Scale { unit: "% of the base radius", step: 0.0, decimals: 2, ..PERCENT };
const PLAIN: Scale = Scale { unit: "", factor: 1.0, step: 0.01, decimals: 2 };
const TENSION: Scale = Scale { unit: "N/m", factor: 1.0, step: 1.0, decimals: 0 };
const DEGREES: Scale = Scale { unit: "°", factor: 1.0, step: 5.0, decimals: 0 };
const MILLILITRES: Scale = Scale { unit: "ml", factor: 1.0, step: 5.0, decimals: 0 };
const FLUID: Scale = Scale { step: 1.0, ..MILLILITRES };
const STIFFNESS: Scale = Scale { unit: "kPa/mm", factor: 1.0, step: 0.1, decimals: 1 };

/// What is common to a number of all scenes.
#[derive(Debug)]
pub struct Row {
    /// The path in a file; `[]` stands for the index of a layer.
    pub path: &'static str,
    /// The number in words; of a layer's number those of the skin.
    pub words: &'static str,
    /// The unit; empty for a number without unit.
    pub unit: &'static str,
    /// The limits of every scene, inclusive; other numbers may narrow them.
    pub limits: (f64, f64),
    /// The cost of a change.
    pub change: Change,
    /// What contains the number.
    pub part: Part,
    /// The name of its control; empty for a number without a control.
    pub label: &'static str,
    /// The scale of its control.
    pub scale: Scale,
    /// The meaning in a sentence or two; empty for a number without a control.
    pub help: &'static str,
    value: fn(&Scene, usize) -> Option<f64>,
    place: fn(&mut Scene, usize) -> Option<&mut f64>,
}

/// The value of a number; an optional member has one by the function behind `=`.
macro_rules! value {
    (Scene $of:ident.$number:ident = $present:path) => { |scene, _| Some($present(&scene.$of)) };
    (Scene $($at:tt)+) => { |scene, _| Some(scene.$($at)+) };
    (Body $of:ident?) => { |scene, _| scene.body.$of };
    (Body $($at:tt)+) => { |scene, _| Some(scene.body.$($at)+) };
    (Layer $($at:tt)+) => { |scene, k| Some(scene.layers.get(k)?.$($at)+) };
    (Chest $axis:literal) => { |scene, _| scene.chest.as_ref()?.radius($axis) };
    (Torso $k:literal) => { |scene, _| scene.torso?.number($k).copied() };
    (Patient $($at:tt)+) => { |scene, _| scene.patient.as_ref()?.measured.$($at)+ };
}

macro_rules! place {
    (Scene $of:ident.$number:ident = $present:path) => {
        |scene, _| {
            let present = $present(&scene.$of);
            Some(scene.$of.$number.get_or_insert(present))
        }
    };
    (Scene $($at:tt)+) => { |scene, _| Some(&mut scene.$($at)+) };
    (Body $of:ident?) => { |scene, _| scene.body.$of.as_mut() };
    (Body $($at:tt)+) => { |scene, _| Some(&mut scene.body.$($at)+) };
    (Layer $($at:tt)+) => { |scene, k| Some(&mut scene.layers.get_mut(k)?.$($at)+) };
    (Chest $axis:literal) => { |scene, _| scene.chest.as_mut()?.place($axis) };
    (Torso $k:literal) => { |scene, _| scene.torso.as_mut()?.number($k) };
    (Patient $($at:tt)+) => { |scene, _| scene.patient.as_mut()?.measured.$($at)+.as_mut() };
}

macro_rules! fields {
    ($($name:ident: $path:literal, $part:ident[$($at:tt)+], $words:literal, $unit:literal, $limits:expr, $change:ident;
        $label:literal, $scale:expr, $help:literal;)+) => {
        /// A number that a scene stores; it reads as its [`Row`].
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Field {
            $(
                #[doc = concat!("`", $path, "`")]
                $name,
            )+
        }

        impl Field {
            /// All numbers, in the order of a file.
            pub const ALL: &[Self] = &[$(Self::$name),+];
        }

        static ROWS: &[Row] = &[
            $(Row {
                path: $path,
                words: $words,
                unit: $unit,
                limits: $limits,
                change: Change::$change,
                part: Part::$part,
                label: $label,
                scale: $scale,
                help: $help,
                value: value!($part $($at)+),
                place: place!($part $($at)+),
            }),+
        ];
    };
}

impl Deref for Field {
    type Target = Row;

    fn deref(&self) -> &Row {
        self.row()
    }
}

fields! {
    BaseRadius: "implant.base_radius_mm", Scene[implant.base_radius_mm], "base radius", "mm", (0.5 * BASE_WIDTH_MM.0, 0.5 * BASE_WIDTH_MM.1), Grid;
        "Width", WIDTH, "Width of the implant's base. Round implants are 7.8–18 cm wide.";
    Projection: "implant.projection_mm", Scene[implant.projection_mm], "projection", "mm", PROJECTION_MM, Dome;
        "Projection", CM, "Height of the implant above the chest. Round implants: 2–7.5 cm.";
    CenterX: "implant.center_mm[0]", Scene[implant.center_mm[0]], "centre of the implant, x", "mm", (-POCKET_RADIUS_MAX_MM, POCKET_RADIUS_MAX_MM), Grid;
        "To the side", CM, "Offset of the implant from the pocket's centre towards the patient's side (−: the midline).";
    CenterY: "implant.center_mm[1]", Scene[implant.center_mm[1]], "centre of the implant, y", "mm", (-POCKET_RADIUS_MAX_MM, POCKET_RADIUS_MAX_MM), Grid;
        "Up", CM, "Offset of the implant from the pocket's centre towards the head (−: the feet).";
    BaseHeight: "implant.base_height_mm", Scene[implant.base_height_mm = Implant::base_height], "height of the base", "mm", BASE_WIDTH_MM, Grid;
        "Height", CM, "Height of the implant's base along the body, from its lower to its upper edge. The value that follows changes with it.";
    ApexShift: "implant.apex_shift_mm", Scene[implant.apex_shift_mm], "way of the apex towards the feet", "mm", (-MOST_APEX_SHIFT_MM, MOST_APEX_SHIFT_MM), Dome;
        "Apex lower", CM, "How far the implant's highest point is below the middle of its base, towards the feet (−: above it).";
    Fullness: "implant.fullness", Scene[implant.fullness = Implant::fullness], "fullness", "", FULLNESS, Dome;
        "Fullness", PLAIN, "Volume of the implant by that of the cylinder around it: width, projection and fullness give the volume. Half of an ellipsoid has 0.67, makers' sizes have 0.55 to 0.80.";
    PocketRadius: "pocket_radius_mm", Scene[pocket_radius_mm], "radius of the pocket", "mm", (10.0, POCKET_RADIUS_MAX_MM), Grid;
        "Pocket", CM, "";
    PatchRadius: "patch_radius_mm", Body[patch_radius_mm], "radius of the simulated tissue", "mm", (30.0, PATCH_RADIUS_MAX_MM), Grid;
        "Computed radius", MM, "Radius of the computed tissue around the pocket's centre; the tissue is held at its edge.";
    AttachmentStiffness: "attachment.stiffness_kpa_per_mm", Body[attachment.stiffness_kpa_per_mm], "stiffness of the attachment", "kPa/mm", (0.1, 50.0), Dome;
        "Attachment stiffness", STIFFNESS, "How firmly the tissue beyond the pocket is held to the chest wall. Plausible: 1–5 kPa/mm.";
    AttachmentRamp: "attachment.ramp_mm", Body[attachment.ramp_mm], "ramp of the attachment", "mm", (1.0, 40.0), Grid;
        "Attachment ramp", MM, "Width over which the hold rises from zero at the pocket's edge.";
    NaturalTension: "skin_state.natural_tension_n_per_m", Body[skin_state.natural_tension_n_per_m], "natural tension of the skin", "N/m", (0.0, 300.0), Tables;
        "", TENSION, "";
    Anisotropy: "skin_state.anisotropy", Body[skin_state.anisotropy], "anisotropy of the natural tension", "", (1.0, 3.0), Tables;
        "", PLAIN, "";
    TensionDirection: "skin_state.direction_deg", Body[skin_state.direction_deg], "direction of the natural tension", "°", (-180.0, 180.0), Tables;
        "", DEGREES, "";
    Relaxed: "skin_state.relaxed", Body[skin_state.relaxed], "relaxed tension of the skin", "", (0.05, 1.0), Tables;
        "", PLAIN, "";
    Grown: "skin_state.grown", Body[skin_state.grown], "growth of the skin", "", (0.0, 1.0), Tables;
        "", PLAIN, "";
    PocketLowered: "pocket_lowered_mm", Body[pocket_lowered_mm], "new fold below the old one", "mm", (0.0, 40.0), Grid;
        "New fold lower", CM, "How far the new fold is below the old one: the pocket's lower edge moves down by so much, its width stays. Six months after an augmentation folds are about 1.4 cm lower by themselves (14 women, Eder et al. 2011).";
    PocketVoid: "pocket_void_ml", Body[pocket_void_ml?], "greatest void of the pocket", "ml", (0.0, 200.0), Dome;
        "Fluid", FLUID, "How much fluid the ring between the implant's rim and the pocket's edge holds at most: a few ml on the table, later none. The tissue is then drawn into it.";
    ChestAcross: "chest.radius_across_mm", Chest[0], "radius of the chest across", "mm", CHEST_RADIUS_MM, Grid;
        "Radius across", CM, "Radius of curvature of the chest wall at the pocket's centre; a negative radius in a file is a hollow chest.";
    ChestAlong: "chest.radius_along_mm", Chest[1], "radius of the chest along the body", "mm", CHEST_RADIUS_MM, Grid;
        "Radius along", CM, "Radius of curvature of the chest wall at the pocket's centre; a negative radius in a file is a hollow chest.";
    TorsoChest: "chest.torso.chest_width_mm", Torso[0], "width of the chest", "mm", (220.0, 320.0), Tables;
        "Chest width", CM, "Width of the chest at the level of the folds, straight, without arms.";
    TorsoBreast: "chest.torso.breast_width_mm", Torso[1], "width of the breast", "mm", (110.0, 150.0), Tables;
        "Breast width", CM, "Width of the breast from its medial to its lateral end, straight.";
    TorsoNotch: "chest.torso.notch_nipple_mm", Torso[2], "notch to nipple", "mm", (170.0, 250.0), Tables;
        "Notch to nipple", CM, "From the sternal notch to the nipple, straight.";
    TorsoFold: "chest.torso.nipple_fold_mm", Torso[3], "nipple to fold", "mm", (40.0, 120.0), Tables;
        "Nipple to fold", CM, "From the nipple to the fold, along the skin, unstretched. Usual: as the other measures give it.";
    TorsoNipples: "chest.torso.nipple_nipple_mm", Torso[4], "nipple to nipple", "mm", (180.0, 250.0), Tables;
        "Nipple to nipple", CM, "Between the nipples, straight.";
    TorsoVolume: "chest.torso.breast_volume_ml", Torso[5], "volume of the breast", "ml", (80.0, 500.0), Tables;
        "Breast volume", MILLILITRES, "Volume of the breast before the operation, between skin and bare chest.";
    Insertion: "insertion", Scene[insertion], "insertion", "", (0.0, 1.0), Dome;
        "In place", PERCENT, "Height of the implant under the tissue, from flat (0 %) to full (100 %).";
    Thickness: "layers[].thickness_mm", Layer[thickness_mm], "thickness of the skin", "mm", (0.2, 60.0), Tables;
        "Thickness", THIN, "Unstretched thickness. Breast skin is about 1–3 mm thick, the fat 5–40 mm.";
    PoissonRatio: "layers[].poisson_ratio", Layer[poisson_ratio], "Poisson ratio", "", (0.0, 0.5), Tables;
        "Poisson ratio", PLAIN, "How little the volume changes when pulled: transverse contraction relative to the stretch. Soft tissue: 0.35–0.50.";
    StrainScale: "layers[].curve.strain_scale", Layer[curve.strain_scale], "strain scale of the skin", "", SCALES, Tables;
        "Laxity of the skin", PLAIN, "";
    StressScale: "layers[].curve.stress_scale", Layer[curve.stress_scale], "stress scale of the skin", "", SCALES, Tables;
        "Stiffness of the skin", PLAIN, "";
    BreastWidth: "patient.base_width_mm", Patient[base_width_mm], "base width of the breast", "mm", MEASURED_WIDTH_MM, Tables;
        "Breast base", CM, "Base width of the breast, best measured; practice's volume and the pull depend on it.";
    Pinch: "patient.pinch_mm", Patient[pinch_mm], "pinch", "mm", PINCH_MM, Tables;
        "Pinch", CM, "Thickness of a fold of skin and fat between two fingers. The fold contains the cover twice.";
    SkinPull: "patient.skin_pull_mm", Patient[skin_pull_mm], "pull of the skin", "mm", PULL_MM, Tables;
        "Pull", CM, "How far a grip of the fingertips lifts the skin in front of the areola.";
    Tolerance: "solver.tolerance", Scene[solver.tolerance], "tolerance", "", (1e-7, 1e-2), Dome;
        "Tolerance", OF_RADIUS, "Largest position error of a node that the solver accepts.";
}

/// Radii of the chest across and along the body.
pub const CHEST: [Field; 2] = [Field::ChestAcross, Field::ChestAlong];

/// The numbers of the built-in torso.
pub const TORSO: [Field; 6] = [
    Field::TorsoChest,
    Field::TorsoBreast,
    Field::TorsoNotch,
    Field::TorsoFold,
    Field::TorsoNipples,
    Field::TorsoVolume,
];

/// The numbers of a [`Body`](super::Body).
pub(super) fn of_body() -> impl Iterator<Item = Field> {
    Field::ALL.iter().copied().filter(|field| field.part == Part::Body)
}

impl Field {
    /// The numbers of the plan that have no code of their own on a screen: the folded part of the plan, form, report, comparison and table
    /// of numbers show them by their rows.
    pub const PLAIN: [Self; 1] = [Self::Fullness];

    fn row(self) -> &'static Row {
        &ROWS[self as usize]
    }

    /// The path of the number of a layer, from the skin from 0; other numbers have one path.
    #[must_use]
    pub fn path(self, layer: usize) -> String {
        self.row().path.replacen("[]", &format!("[{layer}]"), 1)
    }

    /// The number of a path, and its layer, from the skin from 0.
    pub(crate) fn of_path(path: &str) -> Option<(Self, usize)> {
        let layer = path.strip_prefix("layers[").and_then(|rest| rest.split_once(']'));
        let (row, layer) = match layer {
            Some((index, rest)) => (format!("layers[]{rest}"), index.parse().ok()?),
            None => (path.to_owned(), 0),
        };
        let field = Self::ALL.iter().copied().find(|field| field.path == row)?;
        Some((field, layer))
    }

    /// Limits in words.
    pub(super) fn allowed(self, (least, most): (f64, f64)) -> String {
        let with_unit = |end| format!("{} {}", number(end), self.row().unit).trim_end().to_owned();
        match most {
            f64::MAX => format!("{} or more", with_unit(least)),
            _ => format!("{} to {}", number(least), with_unit(most)),
        }
    }

    /// The value in a scene, of a layer's number in that layer; `None` if the scene has no such number.
    #[must_use]
    pub fn value(self, scene: &Scene, layer: usize) -> Option<f64> {
        (self.row().value)(scene, layer)
    }

    /// The value as a screen shows it \[`scale.unit`\]; `None` if the scene has no such number.
    #[must_use]
    pub fn shown(self, scene: &Scene) -> Option<f64> {
        Some(self.row().scale.factor * self.value(scene, 0)?)
    }

    /// The value of a plan that does not state the number, as a screen shows it \[`scale.unit`\].
    #[must_use]
    pub fn usual(self) -> f64 {
        let torso = (self.part == Part::Torso).then(Torso::default);
        self.shown(&Scene { torso, ..Scene::default() }).unwrap_or_default()
    }

    /// Has a scene another value than the usual one?
    #[must_use]
    pub fn is_stated(self, scene: &Scene) -> bool {
        self.shown(scene).is_some_and(|value| (value - self.usual()).abs() > 1e-9)
    }

    /// How many of these numbers the equilibrium of a scene depends on; patch and attachment belong to layered tissue.
    pub(crate) fn count(self, scene: &Scene) -> usize {
        match self.row().part {
            Part::Scene | Part::Chest | Part::Torso => 1,
            Part::Body => usize::from(scene.is_layered()),
            Part::Layer => scene.layers.len(),
            Part::Patient => 0,
        }
    }

    /// The place of the value in a scene.
    pub fn place(self, scene: &mut Scene, layer: usize) -> Option<&mut f64> {
        (self.row().place)(scene, layer)
    }

    /// The limits in a scene: the patch depends on the pocket, height and apex of an anatomical implant on its base, the chest on
    /// patch and implant, and a sheet ignores the numbers of a body.
    #[must_use]
    pub fn range(self, scene: &Scene) -> (f64, f64) {
        match self.row().part {
            Part::Body if !scene.is_layered() => (0.0, f64::MAX),
            Part::Body if self == Self::PatchRadius => Body::patch_range(scene.pocket_reach_mm()),
            _ if self == Self::BaseHeight => {
                let (width, (least, most)) =
                    (2.0 * scene.implant.base_radius_mm, self.row().limits);
                ((width * ASPECT.0).max(least), (width * ASPECT.1).min(most))
            }
            _ if self == Self::ApexShift => {
                let most = 0.5 * MAX_APEX_SHIFT * scene.implant.base_height();
                (-most, most)
            }
            Part::Chest => scene.chest_range(self),
            _ => self.row().limits,
        }
    }

    /// Sets the value, of a number beyond its range the limit.
    pub fn set(self, scene: &mut Scene, layer: usize, value: f64) {
        let (least, most) = self.range(scene);
        if let Some(place) = self.place(scene, layer) {
            *place = value.clamp(least, most);
        }
    }

    /// Checks the value in a scene.
    pub(super) fn check(self, scene: &Scene, layer: usize) -> Result<(), SceneError> {
        let (least, most) = self.range(scene);
        match self.value(scene, layer) {
            Some(value) if !(least..=most).contains(&value) => {
                let allowed = self.allowed((least, most));
                Err(out_of_range(&self.path(layer), number(value), &allowed))
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clinical::Measurements;
    use crate::scene::{ChestShape, SkinState};
    use serde_json::Value;

    /// The paths of the numbers of a scene.
    fn paths(of: &Value, path: &str, found: &mut Vec<String>) {
        match of {
            Value::Number(_) => found.push(path.trim_start_matches('.').to_owned()),
            Value::Array(list) => {
                list.iter().enumerate().for_each(|(k, v)| paths(v, &format!("{path}[{k}]"), found));
            }
            Value::Object(map) => {
                map.iter().for_each(|(name, v)| paths(v, &format!("{path}.{name}"), found));
            }
            _ => {}
        }
    }

    #[test]
    fn each_number_of_a_scene_has_a_row_with_its_value_and_its_place() {
        let mut scene = Scene::opening();
        let measured = Measurements {
            base_width_mm: Some(120.0),
            pinch_mm: Some(30.0),
            skin_pull_mm: Some(20.0),
            ..Measurements::default()
        };
        scene.apply_patient(measured).unwrap();
        scene.implant.base_height_mm = Some(126.0);
        scene.implant.apex_shift_mm = 12.0;
        Field::PLAIN.iter().for_each(|number| number.set(&mut scene, 0, number.limits.1));
        scene.chest = Some(ChestShape { radius_across_mm: 150.0, radius_along_mm: Some(-400.0) });
        scene.body.skin_state = SkinState {
            natural_tension_n_per_m: 20.0,
            anisotropy: 1.5,
            direction_deg: -30.0,
            relaxed: 0.6,
            grown: 0.3,
        };
        scene.body.pocket_lowered_mm = 14.0;
        scene.body.pocket_void_ml = Some(12.0);
        scene.layers[1].curve.strain_scale = 1.5;
        scene.layers.iter_mut().for_each(|layer| layer.curve.stress_scale = 1.25);
        let mut on_torso = scene.clone();
        on_torso.set_torso(Torso { nipple_fold_mm: Some(80.0), ..Torso::default() });
        let json = [&scene, &on_torso].map(|scene| serde_json::to_value(scene).unwrap());
        let (mut wanted, mut found) = (Vec::new(), vec!["solver.nodes_per_side".to_owned()]);
        paths(&json[0], "", &mut wanted);
        paths(&json[1]["chest"], "chest", &mut wanted);
        for field in Field::ALL {
            let is_of_torso = field.part == Part::Torso;
            let json = &json[usize::from(is_of_torso)];
            let scene = if is_of_torso { &mut on_torso } else { &mut scene };
            let layers = if field.part == Part::Layer { scene.layers.len() } else { 1 };
            for layer in 0..layers {
                let value = field.value(scene, layer).unwrap();
                let path = field.path(layer);
                let pointer = format!("/{}", path.replace(['.', '['], "/").replace(']', ""));
                assert_eq!(json.pointer(&pointer).and_then(Value::as_f64), Some(value), "{path}");
                assert_eq!(field.place(scene, layer).copied(), Some(value), "{path}");
                let mut other = scene.clone();
                *field.place(&mut other, layer).unwrap() += 1.0;
                assert!(!other.is_same_plan(scene), "{path}");
                found.push(path);
            }
        }
        wanted.sort();
        found.sort();
        assert_eq!(wanted, found);
    }

    #[test]
    fn each_row_stands_in_the_document_of_the_formats_with_its_limits_and_unit() {
        let document = include_str!("../../../docs/formats.md");
        for field in Field::ALL {
            let (least, most) = field.limits;
            let range = if [Field::PocketRadius, Field::PatchRadius].contains(field) {
                // Other numbers narrow the least value.
                format!("to {most}")
            } else if *field == Field::Tolerance {
                format!("{least:e}–{most:e}")
            } else {
                format!("{least}–{most}").replace('-', "−")
            };
            let allowed = format!("{range} {}", field.unit);
            let path = field.path.trim_end_matches(['[', '0', '1', ']']);
            let is_short = field.part == Part::Patient || path.contains("curve");
            let name = if is_short { path.rsplit('.').next().unwrap() } else { path };
            let has_name = |line: &&str| line.contains(&format!("`{name}`"));
            let mut lines = document.lines().filter(has_name);
            assert!(lines.any(|line| line.contains(allowed.trim_end())), "{name}: {allowed}");
        }
    }
}
