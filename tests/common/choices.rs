//! Scenes, curves and patients from any bytes.

use implant_preview::curve::{CurveSpec, Fat, Interpolation, Section};
use serde_json::{Value, json};

/// A source of choices from bytes, common to fuzz targets and property tests; zeros follow the last byte.
pub(crate) struct Choices<'a>(pub(crate) &'a [u8]);

impl Choices<'_> {
    fn byte(&mut self) -> u8 {
        match self.0 {
            [first, rest @ ..] => {
                self.0 = rest;
                *first
            }
            [] => 0,
        }
    }

    fn below(&mut self, count: u8) -> u8 {
        self.byte() % count
    }

    fn share(&mut self) -> f64 {
        f64::from(u16::from_le_bytes([self.byte(), self.byte()])) / 65535.0
    }

    /// A number: mostly in the range, sometimes an end of the range, sometimes arbitrary.
    pub(crate) fn number(&mut self, least: f64, most: f64) -> f64 {
        const ODD: [f64; 12] = [
            0.0,
            -0.0,
            -1.0,
            1e9,
            1e308,
            -1e308,
            5e-324,
            1e-300,
            f64::MAX,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
        ];
        match self.byte() {
            0..=199 => least + (most - least) * self.share(),
            200..=214 => least,
            215..=229 => most,
            230..=239 => most + (most - least) * self.share(),
            240..=246 => ODD[usize::from(self.below(12))],
            247..=251 => 10.0_f64.powf(24.0 * self.share() - 12.0),
            _ => f64::from_bits(u64::from_le_bytes([0; 8].map(|_: u8| self.byte()))),
        }
    }

    /// A positive number of any order of magnitude in the range; sometimes arbitrary.
    fn magnitude(&mut self, least: f64, most: f64) -> f64 {
        if self.byte() < 240 {
            least * (most / least).powf(self.share())
        } else {
            self.number(least, most)
        }
    }

    /// A curve of any kind.
    pub(crate) fn curve(&mut self) -> CurveSpec {
        match self.below(8) {
            0 => CurveSpec::Skin {},
            1 if self.byte() < 128 => CurveSpec::Adipose {},
            1 => CurveSpec::Fat { variant: Fat::ALL[usize::from(self.below(3))] },
            2 => CurveSpec::Linear { modulus_kpa: self.magnitude(1e-6, 1e7) },
            3 => CurveSpec::Arctangent {
                scale_kpa: self.magnitude(1e-6, 1e7),
                rate: self.magnitude(1e-3, 100.0),
            },
            4 => CurveSpec::Exponential {
                scale_kpa: self.magnitude(1e-6, 1e6),
                rate: self.magnitude(1e-3, 100.0),
            },
            5 | 6 => {
                let interpolation =
                    [Interpolation::Line, Interpolation::Spline][usize::from(self.below(2))];
                CurveSpec::Points { points: self.points(), interpolation }
            }
            _ => CurveSpec::Sections { sections: self.sections() },
        }
    }

    /// Points from [0, 0] in steps of any size, including near-vertical steps and plateaus.
    fn points(&mut self) -> Vec<[f64; 2]> {
        let mut points = vec![[0.0, 0.0]];
        for _ in 0..self.below(12) {
            let [strain, stress] = points[points.len() - 1];
            let step = [self.magnitude(1e-10, 0.5), self.magnitude(1e-9, 1e3)];
            points.push([strain + step[0], stress + step[1]]);
        }
        if self.byte() == 255 {
            let k = usize::from(self.byte()) % points.len();
            points[k][usize::from(self.below(2))] = self.number(0.0, 1.0);
        }
        points
    }

    fn sections(&mut self) -> Vec<Section> {
        let mut sections = Vec::new();
        let mut end = 0.0;
        for _ in 0..self.below(6) {
            let from = if self.byte() < 250 { end } else { self.number(0.0, 1.0) };
            let to = from + self.magnitude(1e-8, 0.5);
            end = to;
            sections.push(match self.below(6) {
                0 => Section::Linear { from, to, modulus_kpa: self.magnitude(1e-6, 1e7) },
                1 => Section::Cubic {
                    from,
                    to,
                    end_stress_kpa: self.magnitude(1e-6, 1e7),
                    end_slope_kpa: self.magnitude(1e-6, 1e9),
                },
                2 => {
                    let count = self.below(9);
                    let term = |c: &mut Self| {
                        let size = c.magnitude(1e-6, 1e6);
                        if c.byte() < 200 { size } else { -size }
                    };
                    let coefficients_kpa = (0..count).map(|_| term(self)).collect();
                    Section::Polynomial { from, to, coefficients_kpa }
                }
                kind => {
                    let (scale_kpa, rate) =
                        (self.magnitude(1e-6, 1e4), self.magnitude(1e-3, 100.0));
                    match kind {
                        3 => Section::Arctangent { from, to, scale_kpa, rate },
                        4 => Section::Sine { from, to, scale_kpa, rate },
                        _ => Section::Exponential { from, to, scale_kpa, rate },
                    }
                }
            });
        }
        sections
    }

    /// Measurements of a person, some of them inconsistent.
    fn patient(&mut self) -> Value {
        const CLASSES: [&str; 5] = ["tight", "normal", "lax", "very_lax", "jelly"];
        let mut patient = json!({ "pinch_mm": self.number(4.0, 120.0) });
        if self.below(2) == 1 {
            patient["base_width_mm"] = json!(self.number(60.0, 240.0));
        }
        match self.below(3) {
            0 => patient["skin_pull_mm"] = json!(self.number(5.0, 80.0)),
            1 => patient["skin_class"] = json!(CLASSES[usize::from(self.below(5))]),
            _ => {}
        }
        if self.below(3) == 1 {
            let path = format!("layers[{}].thickness_mm", self.below(10));
            patient["derived"] = json!([path, "layers[0].curve.strain_scale"]);
        }
        patient
    }

    /// A scene with all fields, as JSON text.
    pub(crate) fn scene(&mut self) -> String {
        const TISSUES: [&str; 7] = ["skin", "adipose", "", "Kapsel", "\u{1b}[2J", "\n", "💧"];
        const SPRINGS: [&str; 3] = ["coupled", "coupled", "nikolaev"];
        let radius = self.number(10.0, 120.0);
        let center = [self.number(-20.0, 20.0), self.number(-20.0, 20.0)];
        let least = radius + center[0].hypot(center[1]);
        let layers: Vec<Value> = (0..=self.below(9))
            .map(|_| {
                let tissue = usize::from(self.below(7));
                let mut curve = json!(self.curve());
                if self.below(4) == 1 {
                    curve["strain_scale"] = json!(self.magnitude(0.05, 20.0));
                    curve["stress_scale"] = json!(self.number(0.05, 20.0));
                }
                json!({
                    "tissue": TISSUES[tissue],
                    "thickness_mm": self.number(0.2, 60.0),
                    "poisson_ratio": self.number(0.0, 0.5),
                    "curve": curve,
                })
            })
            .collect();
        let springs = usize::from(self.below(3));
        let mut scene = json!({
            "implant": { "base_radius_mm": radius, "projection_mm": self.number(2.0, 120.0),
                "center_mm": center },
            "pocket_radius_mm": self.number(least, 200.0),
            "insertion": self.number(0.0, 1.0),
            "layers": layers,
            "springs": SPRINGS[springs],
            "solver": { "nodes_per_side": 17 + usize::from(self.byte()),
                "tolerance": self.magnitude(1e-7, 1e-2) },
        });
        match self.byte() {
            255 => {}
            254 => scene["schema"] = json!("implant-preview/scene/1"),
            _ => scene["tissue_model"] = json!("sheet"),
        }
        if self.below(4) == 1 {
            scene["patient"] = self.patient();
        }
        scene.to_string()
    }

    /// A scene with all fields, mostly of layered tissue, as JSON text.
    pub(crate) fn layered_scene(&mut self) -> String {
        const MODELS: [&str; 4] = ["layered", "layered", "layered", "sheet"];
        let model = MODELS[usize::from(self.below(4))];
        let attachment = json!({ "stiffness_kpa_per_mm": self.magnitude(0.1, 50.0),
            "ramp_mm": self.number(1.0, 40.0) });
        let margin = self.number(20.0, 60.0);
        let cells = match self.byte() {
            0..=99 => json!("auto"),
            100..=239 => json!(1 + self.below(8)),
            240..=247 => json!([0, 9, 255, 65_535][usize::from(self.below(4))]),
            _ => json!(self.number(1.0, 8.0)),
        };
        let keeps_springs = self.byte() >= 240;
        let mut scene: Value = serde_json::from_str(&self.scene()).expect("written above");
        let pocket = scene["pocket_radius_mm"].as_f64().unwrap_or(100.0);
        scene["tissue_model"] = json!(model);
        scene["patch_radius_mm"] = json!(pocket + margin);
        scene["attachment"] = attachment;
        scene["solver"]["cells_through"] = cells;
        if !keeps_springs {
            scene["springs"] = json!("coupled");
        }
        scene.to_string()
    }

    /// A scene with a chest, mostly of radii that its patch allows, as JSON text.
    pub(crate) fn chest_scene(&mut self) -> String {
        let sign = |c: &mut Self| if c.byte() < 192 { 1.0 } else { -1.0 };
        let across = sign(self) * self.number(100.0, 400.0);
        let along = (self.byte() < 128).then(|| sign(self) * self.number(100.0, 2000.0));
        let mut scene: Value = serde_json::from_str(&self.layered_scene()).expect("written above");
        scene["chest"] = json!({ "radius_across_mm": across, "radius_along_mm": along });
        scene.to_string()
    }

    /// A scene with an anatomical implant, a scan of the chest and a thickness field, any of them absent, as JSON text.
    pub(crate) fn scanned_scene(&mut self) -> String {
        // Heights without data from a corner on, or nothing but gaps: the first choice, of which every input has one.
        let gaps = self.byte();
        let mut scene: Value = serde_json::from_str(&self.layered_scene()).expect("written above");
        if self.byte() < 128 {
            scene["implant"]["base_height_mm"] = json!(self.number(40.0, 160.0));
            scene["implant"]["apex_shift_mm"] = json!(self.number(-20.0, 20.0));
        }
        let count = 7 + usize::from(self.byte() % 4);
        let grid = |c: &mut Self, name: &str, least: f64, most: f64| {
            let numbers: Vec<f64> = (0..count * count).map(|_| c.number(least, most)).collect();
            json!({ "spacing_mm": c.number(45.0, 50.0), "columns": count, "rows": count, name: numbers })
        };
        if self.byte() < 128 {
            let mut heights = grid(self, "heights_mm", -9.0, 9.0);
            let list = heights["heights_mm"].as_array_mut().into_iter().flatten().enumerate();
            for (_, height) in list.filter(|(k, _)| gaps == 255 || *k < usize::from(gaps / 16)) {
                *height = Value::Null;
            }
            scene["chest"] = json!({ "grid": heights });
        }
        if self.byte() < 128 {
            scene["thickness_field"] = grid(self, "factors", 0.6, 2.0);
        }
        scene.to_string()
    }
}
