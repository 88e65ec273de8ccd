//! Controls by their accessible names, for scripts of the page: the keyboard focus moves to a control of a name.
//!
//! The names are those of the accessibility tree, which egui makes for the frame after a request only.

use eframe::egui::accesskit::{Action, ActionRequest, Node, NodeId, TreeId, TreeUpdate};
use eframe::egui::{Context, Event, FullOutput, Plugin, RawInput};
use std::collections::HashMap;

/// The request for a control.
#[derive(Default)]
struct Controls {
    /// Name of the control.
    wanted: Option<String>,
    /// The control, once the tree of a frame contains it.
    found: Option<NodeId>,
}

impl Plugin for Controls {
    fn debug_name(&self) -> &'static str {
        "controls by name"
    }

    fn output_hook(&mut self, ctx: &Context, output: &mut FullOutput) {
        let Some(tree) = &output.platform_output.accesskit_update else { return };
        let Some(name) = self.wanted.take() else { return };
        self.found = find(tree, &name);
        ctx.disable_accesskit();
        ctx.request_repaint();
    }

    fn input_hook(&mut self, _: &Context, input: &mut RawInput) {
        let focus = |target_node| {
            Event::AccessKitActionRequest(ActionRequest {
                action: Action::Focus,
                target_tree: TreeId::ROOT,
                target_node,
                data: None,
            })
        };
        input.events.extend(self.found.take().map(focus));
    }
}

/// The first focusable control of a name, in the order of the tree.
fn find(tree: &TreeUpdate, name: &str) -> Option<NodeId> {
    let nodes: HashMap<NodeId, &Node> = tree.nodes.iter().map(|(id, node)| (*id, node)).collect();
    let mut ahead = vec![tree.tree.as_ref()?.root];
    while let Some(id) = ahead.pop() {
        let Some(node) = nodes.get(&id) else { continue };
        if node.supports_action(Action::Focus) && node.label().or(node.value()) == Some(name) {
            return Some(id);
        }
        ahead.extend(node.children().iter().rev());
    }
    None
}

/// Moves the keyboard focus to the first control of an accessible name, within the next frames; without such a control the
/// focus stays.
pub(crate) fn focus(ctx: &Context, name: &str) {
    let controls = ctx.plugin_or_default::<Controls>();
    controls.lock().wanted = Some(name.to_owned());
    ctx.enable_accesskit();
    ctx.request_repaint();
}
