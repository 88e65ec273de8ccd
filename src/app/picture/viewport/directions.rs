//! The words for the directions of the patient, at the edges of the picture to which the directions point.

use crate::app::texts::tr;
use glam::{Vec2, Vec3};

/// An edge of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Edge {
    Top,
    Bottom,
    Left,
    Right,
}

/// Length on the screen of a unit direction below which the direction points towards the eye or away and has no word \[-\].
const LEAST: f32 = 0.35;

/// The words of a view with these unit vectors to the right and up, each with its edge. Of the two axes of the patient one goes
/// across the screen and the other one up, as both are seen best. A drawn torso has its own midline and sides, which are not the edges of
/// the picture: beside it only head and feet have words.
pub(super) fn words(right: Vec3, up: Vec3, has_torso: bool) -> Vec<(Edge, &'static str)> {
    let on_screen = |axis: Vec3| Vec2::new(axis.dot(right), axis.dot(up));
    let [side, head] = [Vec3::X, Vec3::Y].map(on_screen);
    let is_side_across = side.x.abs() + head.y.abs() >= side.y.abs() + head.x.abs();
    let axes = [
        (side, is_side_across, [tr("midline"), tr("side")]),
        (head, !is_side_across, [tr("feet"), tr("head")]),
    ];
    let mut words = Vec::with_capacity(4);
    for (axis, is_across, [back, forth]) in axes.into_iter().skip(usize::from(has_torso)) {
        let (along, edges) = if is_across {
            (axis.x, [Edge::Left, Edge::Right])
        } else {
            (axis.y, [Edge::Bottom, Edge::Top])
        };
        if along.abs() < LEAST {
            continue;
        }
        let [low, high] = if along > 0.0 { [back, forth] } else { [forth, back] };
        words.extend([(edges[0], low), (edges[1], high)]);
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::camera::{Camera, View};

    /// The word at an edge of a standard view.
    fn word(view: View, edge: Edge) -> Option<&'static str> {
        let mut camera = Camera::new(90.0, 1.4);
        camera.fit(90.0, 1.4, view);
        while camera.ease(0.1) {}
        let (right, up) = camera.right_and_up();
        words(right, up, false).into_iter().find_map(|(at, word)| (at == edge).then_some(word))
    }

    #[test]
    fn every_standard_view_has_the_words_at_the_edges_to_which_the_directions_point() {
        let all = |view| [Edge::Top, Edge::Bottom, Edge::Left, Edge::Right].map(|e| word(view, e));
        let front = [Some("head"), Some("feet"), Some("midline"), Some("side")];
        assert_eq!(all(View::Front), front);
        assert_eq!(all(View::Side), [Some("head"), Some("feet"), None, None]);
        // The patient lies: what is up is the front of the chest, which has no word.
        assert_eq!(all(View::Top), [None, None, Some("side"), Some("midline")]);
        assert_eq!(all(View::All)[2..], [Some("midline"), Some("side")]);
        assert_eq!(all(View::All)[0], Some("head"));
    }

    #[test]
    fn a_word_is_never_at_the_edge_from_which_its_direction_points_away() {
        let mut camera = Camera::new(90.0, 1.4);
        for _ in 0..60 {
            camera.drag(Vec2::new(17.0, 3.0));
            let (right, up) = camera.right_and_up();
            let found = words(right, up, false);
            assert!(found.len() >= 2, "{found:?}");
            for (edge, word) in found {
                let axis = match word {
                    "head" => Vec3::Y,
                    "feet" => -Vec3::Y,
                    "side" => Vec3::X,
                    _ => -Vec3::X,
                };
                let along = match edge {
                    Edge::Top => axis.dot(up),
                    Edge::Bottom => -axis.dot(up),
                    Edge::Left => -axis.dot(right),
                    Edge::Right => axis.dot(right),
                };
                assert!(along >= LEAST, "{word} {edge:?} {along}");
            }
        }
    }
}
