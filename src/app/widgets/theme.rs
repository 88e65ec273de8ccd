//! Colours, sizes and fonts of the app; other files contain no such literals.

use crate::view::color::{Rgb, bytes};
use eframe::egui::{
    Color32, Context, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, Margin, Stroke,
    Style, TextStyle, Theme, Vec2, Visuals, vec2,
};
use std::sync::Arc;

/// Space between related elements \[points\].
pub(crate) const SPACE_SMALL: f32 = 4.0;
/// Space between elements \[points\].
pub(crate) const SPACE: f32 = 8.0;
/// Least and greatest width of the side panels \[points\].
pub(crate) const PANEL_WIDTH: (f32, f32) = (264.0, 330.0);
/// Size of the verdict's word \[points\].
pub(crate) const VERDICT: f32 = 18.0;
/// Height of the greatest figures, those of the answer \[points\].
pub(crate) const FIGURE: f32 = 22.0;
/// Size of a button for fingers \[points\].
pub(crate) const TOUCH: f32 = 48.0;
/// Height of a row for fingers, in menus, lists and rows of buttons \[points\].
pub(crate) const FINGER: f32 = 44.0;
/// Width of the window below which the panels become a bottom sheet \[points\].
pub(crate) const NARROW: f32 = 760.0;
/// Least size of what a window shows, whole or in part \[points\].
pub(crate) const LEAST_WINDOW: Vec2 = vec2(240.0, 200.0);
/// Height of the window below which the screen is that of a turned phone \[points\].
pub(crate) const LOW: f32 = 500.0;

/// Colours of a theme.
pub(crate) struct Palette {
    ground: Color32,
    panel: Color32,
    field: Color32,
    line: Color32,
    /// Border of fields and buttons.
    pub(crate) edge: Color32,
    /// Rail of a slider.
    pub(crate) rail: Color32,
    pub(crate) text: Color32,
    quiet: Color32,
    /// The accent colour of selections and links, apart from the hues of the scales.
    pub(crate) accent: Color32,
    /// Text on the accent colour.
    pub(crate) on_accent: Color32,
    /// High values and cautions.
    pub(crate) caution: Color32,
    /// Very high values and errors.
    pub(crate) bad: Color32,
    /// Curves in plots, one per layer in turn.
    pub(crate) curves: [Color32; 4],
}

const fn rgb(hex: u32) -> Color32 {
    Color32::from_rgb((hex >> 16) as u8, (hex >> 8) as u8, hex as u8)
}

const LIGHT: Palette = Palette {
    ground: rgb(0x00EE_F0F2),
    panel: rgb(0x00FB_FCFC),
    field: rgb(0x00E9_ECEF),
    line: rgb(0x00D5_DADF),
    edge: rgb(0x0078_818A),
    rail: rgb(0x008A_929B),
    text: rgb(0x0023_282D),
    quiet: rgb(0x0058_616B),
    accent: rgb(0x0046_4FA8),
    on_accent: rgb(0x00FF_FFFF),
    caution: rgb(0x0087_5A00),
    bad: rgb(0x00B3_3A3A),
    curves: [rgb(0x00A0_4C33), rgb(0x007D_5F00), rgb(0x0035_62A3), rgb(0x006F_5C9E)],
};

const DARK: Palette = Palette {
    ground: rgb(0x0014_1618),
    panel: rgb(0x001E_2124),
    field: rgb(0x002A_2E32),
    line: rgb(0x003A_4046),
    edge: rgb(0x00A2_ABB4),
    rail: rgb(0x0078_818A),
    text: rgb(0x00E3_E6E9),
    quiet: rgb(0x009D_A6AF),
    accent: rgb(0x00A6_ACF2),
    on_accent: rgb(0x0010_1719),
    caution: rgb(0x00E0_B04A),
    bad: rgb(0x00E8_7C7C),
    curves: [rgb(0x00E0_9A80), rgb(0x00E2_BE5A), rgb(0x0086_AEE6), rgb(0x00B3_A0DC)],
};

/// The palette of the present theme.
pub(crate) fn palette(visuals: &Visuals) -> &'static Palette {
    if visuals.dark_mode { &DARK } else { &LIGHT }
}

/// A colour for a painter.
pub(crate) fn color32(color: Rgb) -> Color32 {
    let [r, g, b] = bytes(color);
    Color32::from_rgb(r, g, b)
}

/// Sets fonts, spacing and colours of both themes.
pub(crate) fn install(ctx: &Context) {
    ctx.set_fonts(fonts());
    for (theme, palette) in [(Theme::Light, &LIGHT), (Theme::Dark, &DARK)] {
        ctx.style_mut_of(theme, |style| apply(style, palette, theme));
    }
    // Fallback without a system theme: equal on the desktop and in the page.
    ctx.options_mut(|options| options.fallback_theme = Theme::Light);
}

/// One font of text and numbers: its digits have equal width. Ubuntu Light with the signs of Latin, Greek and Cyrillic, without
/// hints: a fifth of the download of egui's copy (`assets/font`).
fn fonts() -> FontDefinitions {
    const NAME: &str = "Ubuntu derivative Implant Preview";
    const FILE: &[u8] =
        include_bytes!("../../../assets/font/ubuntu-derivative-implant-preview.ttf");
    let mut fonts = FontDefinitions::empty();
    let data = FontData::from_static(FILE);
    fonts.font_data.insert(NAME.to_owned(), Arc::new(data));
    for family in [FontFamily::Proportional, FontFamily::Monospace] {
        fonts.families.insert(family, vec![NAME.to_owned()]);
    }
    fonts
}

fn apply(style: &mut Style, palette: &Palette, theme: Theme) {
    style.text_styles = [
        (TextStyle::Small, FontId::new(12.0, FontFamily::Proportional)),
        (TextStyle::Body, FontId::new(14.0, FontFamily::Proportional)),
        (TextStyle::Button, FontId::new(14.0, FontFamily::Proportional)),
        (TextStyle::Heading, FontId::new(15.0, FontFamily::Proportional)),
        // Numbers: all digits have equal width.
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
    visuals.selection.bg_fill = palette.accent;
    visuals.selection.stroke = Stroke::new(1.0, palette.on_accent);
    // A blinking cursor would cause frames at rest.
    visuals.text_cursor.blink = false;
    visuals.window_stroke = Stroke::new(1.0, palette.line);
    let corner = CornerRadius::same(6);
    let widgets = &mut visuals.widgets;
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, palette.line);
    widgets.noninteractive.fg_stroke = Stroke::new(1.0, palette.text);
    for (widget, fill, stroke) in [
        (&mut widgets.inactive, palette.field, palette.edge),
        (&mut widgets.hovered, palette.line, palette.accent),
        (&mut widgets.active, palette.line, palette.accent),
        (&mut widgets.open, palette.field, palette.edge),
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance of a colour (WCAG 2.2).
    fn luminance(color: Color32) -> f64 {
        let linear = |byte: u8| {
            let fraction = f64::from(byte) / 255.0;
            if fraction <= 0.04045 {
                fraction / 12.92
            } else {
                ((fraction + 0.055) / 1.055).powf(2.4)
            }
        };
        0.2126 * linear(color.r()) + 0.7152 * linear(color.g()) + 0.0722 * linear(color.b())
    }

    /// Contrast ratio of two colours (WCAG 2.2), 1 to 21.
    fn contrast(a: Color32, b: Color32) -> f64 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn contrast_is_that_of_the_standard() {
        assert!((contrast(Color32::BLACK, Color32::WHITE) - 21.0).abs() < 1e-9);
        assert!((contrast(rgb(0x0077_7777), Color32::WHITE) - 4.48).abs() < 0.01);
    }

    #[test]
    fn text_and_widgets_have_contrast_in_both_themes() {
        for (name, p) in [("light", &LIGHT), ("dark", &DARK)] {
            let grounds = [("panel", p.panel), ("ground", p.ground), ("field", p.field)];
            let text = [
                ("text", p.text),
                ("quiet", p.quiet),
                ("caution", p.caution),
                ("bad", p.bad),
                ("curve 1", p.curves[0]),
                ("curve 2", p.curves[1]),
                ("curve 3", p.curves[2]),
                ("curve 4", p.curves[3]),
            ];
            for (on, ground) in grounds {
                for (what, color) in text {
                    let ratio = contrast(color, ground);
                    assert!(ratio >= 4.5, "{name}: {what} on {on} has {ratio:.2} : 1");
                }
                for (what, color) in [("accent", p.accent), ("edge", p.edge)] {
                    let ratio = contrast(color, ground);
                    assert!(ratio >= 3.0, "{name}: {what} on {on} has {ratio:.2} : 1");
                }
            }
            let ratio = contrast(p.rail, p.panel);
            assert!(ratio >= 3.0, "{name}: the rail has {ratio:.2} : 1");
            let ratio = contrast(p.on_accent, p.accent);
            assert!(ratio >= 4.5, "{name}: text on the accent has {ratio:.2} : 1");
            // The accent is also the colour of the words "implant" and "stable".
            let ratio = contrast(p.accent, p.panel);
            assert!(ratio >= 4.5, "{name}: accent as text has {ratio:.2} : 1");
        }
    }

    /// Hue of a colour \[degrees\].
    fn hue([r, g, b]: [f32; 3]) -> f32 {
        let (most, least) = (r.max(g).max(b), r.min(g).min(b));
        let part = |a: f32, b: f32| (a - b) / (most - least).max(1e-6);
        let sixth = if most <= r {
            part(g, b)
        } else if most <= g {
            part(b, r) + 2.0
        } else {
            part(r, g) + 4.0
        };
        (60.0 * sixth).rem_euclid(360.0)
    }

    #[test]
    fn the_accent_has_no_hue_of_the_bands() {
        for accent in [LIGHT.accent, DARK.accent] {
            let own = hue([accent.r(), accent.g(), accent.b()].map(f32::from));
            for band in 0..4 {
                let apart = (hue(crate::view::color::band(band)) - own).abs();
                assert!(apart.min(360.0 - apart) > 30.0, "band {band}: {apart}°");
            }
        }
    }

    #[test]
    fn thin_dashed_lines_stand_out_of_the_dark_ground() {
        for ground in [DARK.panel, DARK.ground] {
            assert!(contrast(DARK.edge, ground) >= 6.0, "{}", contrast(DARK.edge, ground));
        }
    }

    #[test]
    fn styles_use_the_colours_of_the_palette() {
        let ctx = Context::default();
        install(&ctx);
        for (theme, p) in [(Theme::Light, &LIGHT), (Theme::Dark, &DARK)] {
            let style = ctx.style_of(theme);
            let selection = &style.visuals.selection;
            assert_eq!((selection.bg_fill, selection.stroke.color), (p.accent, p.on_accent));
            assert_eq!(style.visuals.weak_text_color, Some(p.quiet));
            assert_eq!(style.visuals.widgets.inactive.bg_stroke.color, p.edge);
        }
    }
}
