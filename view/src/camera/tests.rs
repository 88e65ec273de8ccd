//! Tests of the camera.

use super::*;

#[test]
fn a_zero_movement_changes_nothing() {
    let mut camera = Camera::new(80.0, 1.5);
    assert!(!camera.drag(Vec2::ZERO));
    assert!(!camera.pan(Vec2::ZERO, 600.0));
    assert!(!camera.zoom(1.0, Vec2::new(0.5, 0.5), 1.5));
    assert!(!camera.ease(0.1));
    assert!(camera.drag(Vec2::new(10.0, 0.0)));
}

#[test]
fn a_movement_by_nothing_leaves_the_animation_running() {
    let mut camera = Camera::new(80.0, 1.5);
    assert!(camera.fit(80.0, 1.5, View::Front));
    while camera.ease(0.02) {
        assert!(!camera.zoom(1.0, Vec2::ZERO, 1.5));
        assert!(!camera.drag(Vec2::ZERO) && !camera.pan(Vec2::ZERO, 600.0));
    }
    assert!(!camera.fit(80.0, 1.5, View::Front));
}

#[test]
fn what_is_under_the_pointer_stays_there_in_a_zoom() {
    let (mut camera, aspect, at) = (Camera::new(80.0, 1.5), 1.5, Vec2::new(0.4, -0.3));
    // The point of the target's plane under the pointer.
    let (before, forward) = (camera.ray(at, aspect), camera.pose().target - camera.eye());
    let depth = forward.length_squared() / forward.dot(before.direction);
    let point = before.origin + depth * before.direction;
    assert!(camera.zoom(1.4, at, aspect));
    let after = camera.project(point, aspect).expect("in front of the eye");
    assert!((after - at).length() < 1e-4, "{after}");
    assert!(camera.zoom(1.0 / 1.4, at, aspect));
    assert!((camera.pose().target - Camera::new(80.0, 1.5).pose().target).length() < 1e-3);
}

#[test]
fn the_eye_stays_outside_of_the_tissue() {
    let (radius, height) = (90.0, 60.0);
    for turn in [Vec2::ZERO, Vec2::new(40.0, 200.0), Vec2::new(-90.0, -200.0)] {
        let mut camera = Camera::new(80.0, 1.5);
        camera.drag(turn);
        camera.pan(Vec2::new(30.0, 40.0), 600.0);
        camera.zoom(20.0, Vec2::new(0.2, 0.1), 1.5);
        camera.keep_outside(radius, height);
        let eye = camera.eye();
        let is_outside = eye.z > height - 0.01 || eye.truncate().length() > radius - 0.01;
        assert!(is_outside, "{eye} after {turn}");
        let kept = camera;
        camera.keep_outside(radius, height);
        assert!((camera.pose().distance - kept.pose().distance).abs() < 0.01);
    }
}

#[test]
fn a_fit_ends_at_the_view_of_a_new_camera() {
    let mut camera = Camera::new(80.0, 1.5);
    camera.drag(Vec2::new(300.0, 40.0));
    assert!(camera.fit(80.0, 1.5, View::All));
    let mut steps = 0;
    while camera.ease(0.05) {
        steps += 1;
        assert!(steps < 100);
    }
    assert!(steps > 3 && !camera.is_easing());
    assert_eq!(camera.pose(), Camera::new(80.0, 1.5).pose());
    assert!(!camera.fit(80.0, 1.5, View::All));
}

#[test]
fn the_front_view_has_the_whole_body_with_room_above_and_below() {
    let radius = 110.0;
    for aspect in [0.4, 0.7, 1.1, 1.6, 2.5] {
        let mut camera = Camera::new(radius, aspect);
        camera.fit(radius, aspect, View::Front);
        while camera.ease(0.1) {}
        for k in 0..72 {
            let rim = Vec2::from_angle(5.0_f32.to_radians() * k as f32) * radius;
            let at = camera.project(rim.extend(0.0), aspect).expect("in front of the eye");
            assert!(at.x.abs() < 0.97 && at.y.abs() < 0.9, "{at} at {aspect}");
        }
    }
}

#[test]
fn the_body_is_in_the_middle_of_the_opening_view() {
    // A disc with a dome of two fifths of its radius.
    let radius = 110.0;
    for aspect in [0.7, 1.1, 1.6] {
        let camera = Camera::new(radius, aspect);
        let rim = (0..72).map(|k| Vec2::from_angle(5.0_f32.to_radians() * k as f32) * radius);
        let points = rim.map(|p| p.extend(0.0)).chain([Vec3::new(0.0, 0.0, 0.4 * radius)]);
        let heights = points.filter_map(|p| camera.project(p, aspect)).map(|p| p.y);
        let (low, high) = heights.fold((f32::MAX, f32::MIN), |(a, b), y| (a.min(y), b.max(y)));
        // Slightly below, because of the buttons above.
        let middle = 0.5 * (low + high);
        assert!((-0.15..=0.0).contains(&middle), "{low} to {high} at {aspect}");
    }
}

#[test]
fn the_ray_of_a_projected_point_passes_through_the_point() {
    let mut camera = Camera::new(80.0, 1.5);
    camera.drag(Vec2::new(33.0, -17.0));
    let point = Vec3::new(20.0, -30.0, 40.0);
    let at = camera.project(point, 1.5).expect("in front of the eye");
    let ray = camera.ray(at, 1.5);
    let off = (point - ray.origin).cross(ray.direction).length();
    assert!(off < 0.02, "{off} mm");
}

#[test]
fn a_zoom_ends_at_the_tissue_and_goes_no_further() {
    let (radius, height, at) = (90.0, 60.0, Vec2::new(0.3, 0.1));
    let mut camera = Camera::new(80.0, 1.5);
    for _ in 0..20 {
        let factor = camera.zoom_outside(1.4, at, 1.5, radius, height);
        camera.zoom(factor, at, 1.5);
    }
    let kept = camera;
    for _ in 0..5 {
        let factor = camera.zoom_outside(30.0, at, 1.5, radius, height);
        assert!(!camera.zoom(factor, at, 1.5));
        camera.keep_outside(radius, height);
    }
    assert_eq!(camera, kept);
    assert!(camera.pose().distance < 0.6 * Camera::new(80.0, 1.5).pose().distance);
    // Away from the tissue nothing holds.
    assert!((camera.zoom_outside(0.5, at, 1.5, radius, height) - 0.5).abs() < 1e-6);
}

#[test]
fn a_standing_patient_has_the_head_up_and_the_whole_body_in_sight() {
    let (radius, aspect) = (120.0, 0.85);
    let seen = |standing, point: Vec3| {
        let camera = Camera::standing(radius, aspect, standing);
        camera.project(point, aspect).expect("in front of the eye")
    };
    for standing in Standing::ALL {
        let [head, feet] = [Vec3::Y, -Vec3::Y].map(|d| seen(standing, radius * d));
        assert!(head.y > 0.5 && feet.y < -0.5 && head.x.abs() < 0.6, "{standing:?}");
        for k in 0..72 {
            let rim = Vec2::from_angle(5.0_f32.to_radians() * k as f32) * radius;
            for point in [rim.extend(0.0), 0.5 * Vec3::Z * radius] {
                let at = seen(standing, point);
                assert!(at.abs().max_element() < 1.0, "{standing:?}: {point} at {at}");
            }
        }
    }
    // The patient's left side is at the right, and seen from there the front of the chest is at the left.
    assert!(seen(Standing::Front, Vec3::X * radius).x > 0.5);
    let front = seen(Standing::Side, Vec3::Z * radius) - seen(Standing::Side, Vec3::ZERO);
    assert!(front.x < -0.5 && front.y.abs() < 1e-5, "{front}");
    let turned = |point| seen(Standing::ThreeQuarter, point);
    assert!(turned(Vec3::X * radius).x > 0.2 && turned(Vec3::Z * radius).x < 0.0);
    // Each pose from the other side is the mirror image.
    let of_other = [
        (Standing::ThreeQuarter, Standing::OtherThreeQuarter),
        (Standing::Side, Standing::OtherSide),
    ];
    let point = radius * Vec3::new(0.4, 0.3, 0.5);
    for (own, other) in of_other {
        let (here, there) = (seen(own, point), seen(other, point * Vec3::new(-1.0, 1.0, 1.0)));
        assert!((here * Vec2::new(-1.0, 1.0) - there).length() < 1e-5, "{other:?}");
    }
}

#[test]
fn the_side_view_is_that_of_a_standing_patient_and_turns_in_front_of_the_wall() {
    let (radius, aspect) = (110.0, 1.4);
    let mut camera = Camera::new(radius, aspect);
    assert!(camera.fit(radius, aspect, View::Side) && !camera.is_easing());
    assert_eq!(camera.pose(), Camera::standing(radius, aspect, Standing::Side).pose());
    assert!((camera.right_and_up().1 - Vec3::Y).length() < 1e-6, "the head up");
    assert!(!camera.fit(radius, aspect, View::Side));
    for delta in [Vec2::new(900.0, 900.0), Vec2::new(-900.0, -900.0)] {
        camera.drag(delta);
        assert!(camera.eye().z > -0.1 && camera.right_and_up().1.y > 0.3, "{:?}", camera.eye());
    }
    // Another view is that of a new camera again.
    assert!(camera.fit(radius, aspect, View::All));
    assert_eq!(camera, Camera::new(radius, aspect));
}

#[test]
fn a_mirrored_camera_shows_the_mirror_image_and_follows_the_hand() {
    let (aspect, at) = (1.5, Vec2::new(0.3, -0.2));
    let mut camera = Camera::new(80.0, aspect);
    camera.drag(Vec2::new(25.0, -14.0));
    let mut mirrored = camera;
    mirrored.mirror(true);
    let flip = |p: Vec2| Vec2::new(-p.x, p.y);
    for point in [Vec3::new(20.0, -30.0, 40.0), Vec3::new(-60.0, 10.0, 0.0)] {
        let image = camera.project(point, aspect).map(flip);
        assert_eq!(mirrored.project(point, aspect), image, "to the last bit");
    }
    let (ray, image) = (camera.ray(at, aspect), mirrored.ray(flip(at), aspect));
    assert!((ray.direction - image.direction).length() < 1e-5);
    // Mirrored movements keep the images alike.
    let delta = Vec2::new(7.0, 3.0);
    assert!(camera.drag(delta) && mirrored.drag(flip(delta)));
    assert!(camera.pan(delta, 600.0) && mirrored.pan(flip(delta), 600.0));
    assert!(camera.zoom(1.3, at, aspect) && mirrored.zoom(1.3, flip(at), aspect));
    assert_eq!(camera.pose(), mirrored.pose());
}

#[test]
fn zoom_rejects_invalid_factors() {
    let mut camera = Camera::new(80.0, 1.5);
    for factor in [f32::NAN, -1.0, 0.0, f32::INFINITY] {
        assert!(!camera.zoom(factor, Vec2::ZERO, 1.5), "{factor}");
    }
    camera.zoom(1e9, Vec2::ZERO, 1.5);
    assert!(camera.pose().distance >= DISTANCE_MM.0);
}
