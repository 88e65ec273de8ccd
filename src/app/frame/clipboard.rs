//! The text of the clipboard on request: the window's on the desktop, the browser's in the page, where the user or the browser may refuse.
//!
//! Used by `curve_editor`.

use eframe::egui::{Context, Event};
#[cfg(target_arch = "wasm32")]
use std::sync::mpsc::{Receiver, channel};

/// Frames after which a desktop without text in its clipboard has not answered.
#[cfg(not(target_arch = "wasm32"))]
const PATIENCE: u32 = 4;

/// A request for the text of the clipboard.
#[derive(Default)]
pub(crate) struct Clipboard {
    #[cfg(target_arch = "wasm32")]
    answer: Option<Receiver<Option<String>>>,
    #[cfg(not(target_arch = "wasm32"))]
    frames_left: u32,
}

impl Clipboard {
    /// Requests the text.
    pub(crate) fn request(&mut self, ctx: &Context) {
        #[cfg(target_arch = "wasm32")]
        {
            let (sender, receiver) = channel();
            let ctx = ctx.clone();
            self.answer = Some(receiver);
            wasm_bindgen_futures::spawn_local(async move {
                let text = browser_text().await.ok().and_then(|text| text.as_string());
                // The window may be closed in the meantime.
                let _ = sender.send(text);
                ctx.request_repaint();
            });
        }
        #[cfg(not(target_arch = "wasm32"))]
        {
            ctx.send_viewport_cmd(eframe::egui::ViewportCommand::RequestPaste);
            self.frames_left = PATIENCE;
            ctx.request_repaint();
        }
    }

    /// The text, once; `Some(None)` if there is none or if it is refused.
    pub(crate) fn poll(&mut self, ctx: &Context) -> Option<Option<String>> {
        #[cfg(target_arch = "wasm32")]
        {
            let text = self.answer.as_ref()?.try_recv().ok()?;
            self.answer = None;
            // A key of the user may have pasted the text already.
            Some(text.filter(|text| !text.is_empty()).or_else(|| pasted(ctx)))
        }
        #[cfg(not(target_arch = "wasm32"))]
        {
            self.frames_left = self.frames_left.checked_sub(1)?;
            let text = pasted(ctx);
            if text.is_some() {
                self.frames_left = 0;
            } else if self.frames_left > 0 {
                ctx.request_repaint();
                return None;
            }
            Some(text)
        }
    }
}

/// Takes a pasted text out of the frame.
fn pasted(ctx: &Context) -> Option<String> {
    ctx.input_mut(|input| {
        let at = input.events.iter().position(|event| matches!(event, Event::Paste(_)))?;
        match input.events.remove(at) {
            Event::Paste(text) => Some(text),
            _ => None,
        }
    })
}

/// The text of the browser's clipboard. Pages of other machines without encryption have no clipboard.
#[cfg(target_arch = "wasm32")]
async fn browser_text() -> Result<wasm_bindgen::JsValue, wasm_bindgen::JsValue> {
    let get = |of: &wasm_bindgen::JsValue, name: &str| js_sys::Reflect::get(of, &name.into());
    use wasm_bindgen::JsCast as _;
    let navigator = get(&js_sys::global(), "navigator")?;
    let clipboard = get(&navigator, "clipboard")?;
    let read: js_sys::Function = get(&clipboard, "readText")?.dyn_into()?;
    let promise: js_sys::Promise = read.call0(&clipboard)?.dyn_into()?;
    wasm_bindgen_futures::JsFuture::from(promise).await
}
