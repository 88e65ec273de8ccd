//! Colours, sizes and type of the app: the only place with such literals.

use eframe::egui::{
    Color32, Context, CornerRadius, FontFamily, FontId, Margin, Stroke, Style, TextStyle, Theme,
    Visuals, vec2,
};

/// Space between things that belong together \[points\].
pub(super) const SPACE_SMALL: f32 = 4.0;
/// Space between things.
pub(super) const SPACE: f32 = 8.0;
/// Width of the side panels.
pub(super) const PANEL_WIDTH: f32 = 312.0;
/// Below this width the panels become a bottom sheet.
pub(super) const NARROW: f32 = 760.0;

/// Colours of one theme.
pub(super) struct Palette {
    ground: Color32,
    panel: Color32,
    field: Color32,
    line: Color32,
    text: Color32,
    quiet: Color32,
    /// The one accent.
    pub(super) accent: Color32,
    /// Converged.
    pub(super) good: Color32,
    /// Working, or to be looked at.
    pub(super) caution: Color32,
    /// Refused or failed.
    pub(super) bad: Color32,
    /// Curves in plots, one for each layer in turn.
    pub(super) curves: [Color32; 4],
}

const fn rgb(hex: u32) -> Color32 {
    Color32::from_rgb((hex >> 16) as u8, (hex >> 8) as u8, hex as u8)
}

const LIGHT: Palette = Palette {
    ground: rgb(0x00EE_F0F2),
    panel: rgb(0x00FB_FCFC),
    field: rgb(0x00E9_ECEF),
    line: rgb(0x00D5_DADF),
    text: rgb(0x0023_282D),
    quiet: rgb(0x005F_6872),
    accent: rgb(0x001F_7A8C),
    good: rgb(0x002E_7D4F),
    caution: rgb(0x009A_6700),
    bad: rgb(0x00B3_3A3A),
    curves: [rgb(0x00B8_5F45), rgb(0x00B0_8614), rgb(0x003F_6FB0), rgb(0x006F_5C9E)],
};

const DARK: Palette = Palette {
    ground: rgb(0x0014_1618),
    panel: rgb(0x001E_2124),
    field: rgb(0x002A_2E32),
    line: rgb(0x003A_4046),
    text: rgb(0x00E3_E6E9),
    quiet: rgb(0x009D_A6AF),
    accent: rgb(0x0055_B3C5),
    good: rgb(0x006C_C08F),
    caution: rgb(0x00E0_B04A),
    bad: rgb(0x00E8_7C7C),
    curves: [rgb(0x00E0_9A80), rgb(0x00E2_BE5A), rgb(0x0086_AEE6), rgb(0x00B3_A0DC)],
};

/// The palette of the theme in use.
pub(super) fn palette(visuals: &Visuals) -> &'static Palette {
    if visuals.dark_mode { &DARK } else { &LIGHT }
}

/// Sets type, spacing and colours of both themes.
pub(super) fn install(ctx: &Context) {
    for (theme, palette) in [(Theme::Light, &LIGHT), (Theme::Dark, &DARK)] {
        ctx.style_mut_of(theme, |style| apply(style, palette, theme));
    }
    // Where the system has no say: the same on the desktop and in the page.
    ctx.options_mut(|options| options.fallback_theme = Theme::Light);
}

fn apply(style: &mut Style, palette: &Palette, theme: Theme) {
    style.text_styles = [
        (TextStyle::Small, FontId::new(11.5, FontFamily::Proportional)),
        (TextStyle::Body, FontId::new(13.5, FontFamily::Proportional)),
        (TextStyle::Button, FontId::new(13.5, FontFamily::Proportional)),
        (TextStyle::Heading, FontId::new(16.0, FontFamily::Proportional)),
        // Numbers: every figure has the same width.
        (TextStyle::Monospace, FontId::new(12.5, FontFamily::Monospace)),
    ]
    .into();
    style.drag_value_text_style = TextStyle::Monospace;
    let spacing = &mut style.spacing;
    spacing.item_spacing = vec2(SPACE, SPACE_SMALL + 2.0);
    spacing.button_padding = vec2(SPACE, SPACE_SMALL);
    spacing.interact_size = vec2(40.0, 24.0);
    spacing.slider_rail_height = 5.0;
    spacing.window_margin = Margin::same(16);
    style.animation_time = 0.08;

    let mut visuals = match theme {
        Theme::Light => Visuals::light(),
        Theme::Dark => Visuals::dark(),
    };
    visuals.panel_fill = palette.panel;
    visuals.window_fill = palette.panel;
    visuals.extreme_bg_color = palette.ground;
    visuals.faint_bg_color = palette.field;
    visuals.hyperlink_color = palette.accent;
    visuals.warn_fg_color = palette.caution;
    visuals.error_fg_color = palette.bad;
    visuals.weak_text_color = Some(palette.quiet);
    visuals.selection.bg_fill = palette.accent.gamma_multiply(0.75);
    visuals.selection.stroke = Stroke::new(1.0, Color32::WHITE);
    visuals.slider_trailing_fill = true;
    visuals.window_stroke = Stroke::new(1.0, palette.line);
    let corner = CornerRadius::same(6);
    let widgets = &mut visuals.widgets;
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, palette.line);
    widgets.noninteractive.fg_stroke = Stroke::new(1.0, palette.text);
    for (widget, fill, stroke) in [
        (&mut widgets.inactive, palette.field, Color32::TRANSPARENT),
        (&mut widgets.hovered, palette.line, palette.accent),
        (&mut widgets.active, palette.line, palette.accent),
        (&mut widgets.open, palette.field, palette.line),
    ] {
        widget.bg_fill = fill;
        widget.weak_bg_fill = fill;
        widget.bg_stroke = Stroke::new(1.0, stroke);
        widget.fg_stroke = Stroke::new(1.0, palette.text);
        widget.corner_radius = corner;
        widget.expansion = 0.0;
    }
    style.visuals = visuals;
}
