//! What the page offers to scripts and tests: scene, plan, result, focus and figures of the running app.

use crate::app::App;
use crate::platform::text;
use crate::platform::workers::object;
use std::cell::RefMut;
use wasm_bindgen::prelude::*;

/// Where the app runs.
pub(super) trait Host {
    /// The app.
    ///
    /// # Errors
    /// A panic has stopped the app.
    fn app(&self) -> Result<RefMut<'_, App>, JsError>;

    /// Gives the picture the focus of the page, without which the picture gets no keys.
    fn focus_picture(&self);
}

/// `window.implantPreview`: the running app, for scripts and tests.
#[wasm_bindgen]
pub struct Handle {
    host: &'static dyn Host,
}

impl Handle {
    pub(super) fn new(host: &'static dyn Host) -> Self {
        Self { host }
    }
}

#[wasm_bindgen]
impl Handle {
    /// The present scene (JSON text).
    ///
    /// # Errors
    /// Throws if the app is not running.
    pub fn scene(&self) -> Result<String, JsError> {
        Ok(self.host.app()?.session().scene().to_json())
    }

    /// Replaces the scene (JSON text).
    ///
    /// # Errors
    /// Throws an `Error` with one line that names the field; the scene is then unchanged.
    #[wasm_bindgen(js_name = setScene)]
    pub fn set_scene(
        &self,
        #[wasm_bindgen(unchecked_param_type = "string")] json: &JsValue,
    ) -> Result<(), JsError> {
        let mut app = self.host.app()?;
        app.open(text::text(json, "scene")?)?;
        app.request_frame();
        Ok(())
    }

    /// The fields of the plan as a list (JSON text): `name`, `label`, `unit`, `text` (the value as shown), `hint`, `range` (the
    /// allowed numbers in words), and `least` and `most` of a number or the `choices` of a word with their `words` on the screen.
    ///
    /// # Errors
    /// Throws if the app is not running.
    pub fn plan(&self) -> Result<String, JsError> {
        Ok(self.host.app()?.plan_json())
    }

    /// Sets a field of the plan by its name. A number may have a decimal comma and a unit.
    ///
    /// # Errors
    /// Throws an `Error` with one line: what is wrong and what is allowed; the plan is then unchanged.
    #[wasm_bindgen(js_name = setPlan)]
    pub fn set_plan(
        &self,
        #[wasm_bindgen(unchecked_param_type = "string")] name: &JsValue,
        #[wasm_bindgen(unchecked_param_type = "string")] text: &JsValue,
    ) -> Result<(), JsError> {
        let mut app = self.host.app()?;
        let (name, text) = (text::text(name, "name")?, text::text(text, "value")?);
        app.set_plan(&name, &text).map_err(|error| JsError::new(&error))
    }

    /// The result of the present scene with `scene`, `program_version` and `date` (JSON text);
    /// `undefined` during a solve.
    ///
    /// # Errors
    /// Throws if the app is not running.
    pub fn result(&self) -> Result<Option<String>, JsError> {
        Ok(self.host.app()?.result_json())
    }

    /// The control with the keyboard focus, `{ name, x, y, width, height }` in pixels of the page, or
    /// `undefined`.
    ///
    /// # Errors
    /// Throws if the app is not running.
    pub fn focused(&self) -> Result<JsValue, JsError> {
        let app = self.host.app()?;
        let Some((name, [x, y, width, height])) = app.focused() else {
            return Ok(JsValue::UNDEFINED);
        };
        Ok(object([
            ("name", name.into()),
            ("x", x.into()),
            ("y", y.into()),
            ("width", width.into()),
            ("height", height.into()),
        ]))
    }

    /// Moves the keyboard focus to the first control of an accessible name, within the next frames; without such a control the
    /// focus stays.
    ///
    /// # Errors
    /// Throws if the app is not running, or the name is no text.
    pub fn focus(
        &self,
        #[wasm_bindgen(unchecked_param_type = "string")] name: &JsValue,
    ) -> Result<(), JsError> {
        let name = text::text(name, "name")?;
        self.host.app()?.focus_control(&name);
        self.host.focus_picture();
        Ok(())
    }

    /// `{ frames, frame_ms_p50, frame_ms_p95, solve_ms, solver_ms_p50, solver_ms_p95, solver_ms_max,
    /// converged, solves, work_units, tables, measurements, range_done, range_all,
    /// samples_done, samples_all, jobs }`.
    ///
    /// # Errors
    /// Throws if the app is not running.
    pub fn stats(&self) -> Result<JsValue, JsError> {
        let stats = self.host.app()?.stats();
        Ok(object([
            ("frames", JsValue::from(stats.frames as f64)),
            ("frame_ms_p50", stats.frame_ms_p50.into()),
            ("frame_ms_p95", stats.frame_ms_p95.into()),
            ("solve_ms", stats.solve_ms.into()),
            ("solver_ms_p50", stats.solver_ms_p50.into()),
            ("solver_ms_p95", stats.solver_ms_p95.into()),
            ("solver_ms_max", stats.solver_ms_max.into()),
            ("converged", stats.converged.into()),
            ("solves", JsValue::from(stats.solves as f64)),
            ("work_units", stats.work_units.into()),
            ("tables", JsValue::from(stats.tables as f64)),
            ("measurements", JsValue::from(stats.measurements as f64)),
            ("range_done", JsValue::from(stats.range_done as f64)),
            ("range_all", JsValue::from(stats.range_all as f64)),
            ("samples_done", JsValue::from(stats.samples_done as f64)),
            ("samples_all", JsValue::from(stats.samples_all as f64)),
            ("jobs", JsValue::from(stats.jobs as f64)),
        ]))
    }
}
