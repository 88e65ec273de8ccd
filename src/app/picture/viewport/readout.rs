//! The values at a point of the tissue, every layer of it, in the units and words of the cards.

use crate::app::plan::device::Device;
use crate::app::texts::{self, fixed, tr};
use crate::measure::{Field, Fields, MMHG_PER_KPA, thickness_at_rest};
use crate::scene::Scene;
use crate::view::body::Body;
use crate::view::pick::{Hit, Target};
use crate::view::place::{Nodes, Place, nearest_column};

/// Strain taken up by wrinkles from which the values list it \[-\].
const LEAST_FOLDED: f32 = 5e-4;

/// The point of the tissue at a hit; `None` beyond the computed tissue.
pub(super) fn place_of(hit: &Hit, body: &Body, fields: &Fields) -> Option<Place> {
    let sheet = fields.solution().problem().sheet();
    if body.nodes_per_side != sheet.nodes_per_side() {
        return None;
    }
    match &hit.target {
        Target::Ring => None,
        Target::Sheet(nodes) => {
            let depth = depth_of(nodes, body, hit)?;
            Some(Place::new(nodes, depth, sheet))
        }
        Target::Cut(_) | Target::Implant => {
            let (column, depth) = nearest_column(body, hit.point)?;
            let is_near =
                body.levels.iter().any(|level| level[column].distance(hit.point) < REACH_MM);
            let nodes = [(column, 1.0), (column, 0.0), (column, 0.0)];
            is_near.then(|| Place::new(&nodes, depth, sheet))
        }
    }
}

/// Distance of a point from its column above which the point belongs to tissue without values \[mm\].
const REACH_MM: f32 = 30.0;

/// Depth of a hit on a surface of the tissue: 0 on the skin, or that of the inner face.
fn depth_of(nodes: &Nodes, body: &Body, hit: &Hit) -> Option<f32> {
    let node = nodes.iter().max_by(|a, b| a.1.total_cmp(&b.1))?.0;
    let last = body.levels.len().checked_sub(1)?;
    let far = |level: usize| body.levels[level].get(node).map(|p| p.distance(hit.point));
    let (outer, inner) = (far(0)?, far(last)?);
    Some(if outer <= inner { 0.0 } else { last as f32 })
}

/// What is at a hit, in a few words; nothing on the skin.
pub(super) fn heading(hit: &Hit, fields: &Fields, scene: &Scene, device: Device) -> Option<String> {
    match hit.target {
        Target::Sheet(_) => None,
        Target::Ring => Some(tr("Outside the pocket (not computed)").to_owned()),
        Target::Cut(layer) => Some(tr!("In {tissue}", tissue = name(scene, layer))),
        Target::Implant => {
            let name = device.words(tr("Implant"));
            let wall =
                fields.solution().problem().obstacle.wall.0.height(hit.point.truncate().as_dvec2());
            let height = hit.point.z - wall as f32;
            Some(tr!("{name}, {height:.1} mm above the chest wall", name, height))
        }
    }
}

fn name(scene: &Scene, layer: usize) -> &str {
    scene.layers.get(layer).map_or(tr("tissue"), |layer| texts::tissue(&layer.tissue))
}

/// The values at three nodes, one per line: stretch of the skin, cover, pressure; with `has_layers` every layer now and at rest.
pub(super) fn values(
    nodes: &Nodes,
    fields: &Fields,
    scene: &Scene,
    has_layers: bool,
) -> Vec<String> {
    // Interpolated between three nodes; fields that are not displayed are not computed.
    let value = |field: Field| -> f32 {
        let at = |&(node, weight): &(usize, f32)| fields.at(field, node).map(|v| v as f32 * weight);
        nodes.iter().map(at).sum::<Option<f32>>().unwrap_or(0.0)
    };
    let mut lines = vec![tr!(
        "Skin stretch {stretch:.0} %, area {area:+.0} %",
        stretch = 100.0 * value(Field::PrincipalStrain),
        area = 100.0 * (value(Field::AreaStretch) - 1.0)
    )];
    let folded = value(Field::WrinkleStrain);
    if folded > LEAST_FOLDED {
        lines.push(tr!("Skin in folds: {folded:.1} %", folded = 100.0 * folded));
    }
    let problem = fields.solution().problem();
    let at_rest = |layer: usize| -> f64 {
        let at = |&(node, weight): &(usize, f32)| {
            f64::from(weight) * thickness_at_rest(problem, layer, node)
        };
        nodes.iter().map(at).sum()
    };
    let layers = fields.solution().stack().thickness_mm.iter().enumerate();
    for (k, thickness) in layers.filter(|_| has_layers) {
        let now = |&(node, weight): &(usize, f32)| thickness.get(node).map(|mm| mm * weight);
        let now = nodes.iter().map(now).sum::<Option<f32>>().unwrap_or(0.0);
        let rest = at_rest(k);
        let stress = value(Field::Stress(k));
        let (name, word) =
            (name(scene, k), if stress < 0.0 { tr("compression") } else { tr("pull") });
        let stress = three_figures(stress.abs());
        lines.push(tr!(
            "{name} {now:.1} mm (at rest {rest:.1}), {word} {stress} kPa",
            name,
            now,
            rest,
            word,
            stress
        ));
    }
    let pressure = value(Field::ContactPressure);
    // Beside the implant the distance from the implant to the skin is no cover.
    if scene.is_layered() && pressure > 0.0 {
        let rest: f64 = (0..problem.materials.len()).map(at_rest).sum();
        lines.push(tr!(
            "Cover {cover:.1} mm (at rest {rest:.1})",
            cover = value(Field::Cover),
            rest
        ));
    }
    lines.push(if pressure > 0.0 {
        tr!("Pressure {pressure}", pressure = texts::pressure(f64::from(pressure) * MMHG_PER_KPA))
    } else {
        tr("No pressure here").to_owned()
    });
    lines
}

/// Formats a value with at most three digits.
fn three_figures(value: f32) -> String {
    let decimals = match value.abs() {
        v if v >= 100.0 => 0,
        v if v >= 10.0 => 1,
        _ => 2,
    };
    fixed(f64::from(value), decimals)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::Session;
    use std::rc::Rc;

    fn solved(mut scene: Scene) -> Session {
        scene.solver.nodes_per_side = 33;
        let mut session = Session::new(scene).expect("the scene is valid");
        while session.is_working() {
            session.advance(&mut || false);
        }
        session
    }

    #[test]
    fn values_have_at_most_three_figures() {
        let shown = [0.1234_f32, 1.234, 12.34, 123.4].map(three_figures);
        assert_eq!(shown, ["0.12", "1.23", "12.3", "123"]);
    }

    #[test]
    fn every_layer_is_read_now_and_at_rest_and_the_cover_is_their_result() {
        let session = solved(Scene::default());
        let outcome = session.outcome().expect("the scene is solved");
        let fields: Rc<Fields> = Rc::clone(session.fields());
        let apex = 16 * 33 + 16;
        let nodes = [(apex, 1.0), (apex, 0.0), (apex, 0.0)];
        let lines = values(&nodes, &fields, session.scene(), true);
        let cover = outcome.cover_mm.expect("layered tissue has a cover").apex;
        let rest = session.scene().tissue_mm();
        assert!(lines.contains(&format!("Cover {cover:.1} mm (at rest {rest:.1})")), "{lines:?}");
        for layer in &session.scene().layers {
            let rest = format!("(at rest {:.1}), ", layer.thickness_mm);
            let is_read = |line: &String| {
                line.starts_with(texts::tissue(&layer.tissue)) && line.contains(&rest)
            };
            assert!(lines.iter().any(is_read), "{} in {lines:?}", layer.tissue);
        }
        assert!(lines[0].starts_with("Skin stretch "), "{lines:?}");
        // Fat under the skin is pressed: its word has the sign.
        assert!(!lines.iter().any(|line| line.contains(" -")), "{lines:?}");
        assert!(lines.iter().any(|line| line.starts_with("Pressure ")), "{lines:?}");
        let few = values(&nodes, &fields, session.scene(), false);
        assert_eq!(few, [0, lines.len() - 2, lines.len() - 1].map(|k| lines[k].clone()));
    }

    #[test]
    fn a_sheet_has_no_cover_and_the_border_no_pressure() {
        let session = solved(Scene::sheet());
        let border = 16 * 33;
        let nodes = [(border, 1.0), (border, 0.0), (border, 0.0)];
        let lines = values(&nodes, session.fields(), session.scene(), true);
        assert!(!lines.iter().any(|line| line.starts_with("Cover")), "{lines:?}");
        assert_eq!(lines.last().map(String::as_str), Some("No pressure here"));
    }
}
