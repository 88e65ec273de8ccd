use super::*;

#[test]
fn balanced_cells_are_about_as_high_as_wide() {
    for (thickness_mm, spacing_mm, cells) in [
        (8.5, 4.06, 2),
        (8.5, 2.03, 4),
        (15.0, 3.9, 4),
        (15.0, 1.95, 6),
        (40.0, 4.0, 6),
        (4.5, 8.0, 2),
        (3.0, 8.0, 1),
    ] {
        let found = balanced_cells(&[thickness_mm], spacing_mm);
        assert_eq!(found, cells, "{thickness_mm} mm on {spacing_mm} mm");
    }
    assert_eq!(balanced_cells(&[], 8.0), 1);
}

#[test]
fn cells_are_shared_out_by_height() {
    assert_eq!(shared_out(&[10.0], 2), [2]);
    assert_eq!(shared_out(&[5.0, 10.0], 4), [1, 3]);
    assert_eq!(shared_out(&[1.0, 1.0, 30.0], 2), [1, 1, 1]);
    assert_eq!(shared_out(&[], 4), [0; 0]);
}

#[test]
fn layers_of_nodes_lie_on_the_faces_of_the_solids_on_every_grid() {
    let rest = Rest::layered(Sheet::new(33, 60.0), &[6.0, 12.0], 3);
    for rest in [rest.coarser().unwrap(), rest] {
        assert_eq!(rest.outer_faces().collect::<Vec<_>>(), [1, 3]);
        let heights: Vec<f64> = (0..rest.layers()).map(|l| rest.node(l, 0).z).collect();
        assert_eq!(heights, [0.0, 6.0, 12.0, 18.0]);
    }
    assert_eq!(Rest::of_sheet(Sheet::new(9, 60.0)).layers(), 1);
}

#[test]
fn a_mound_of_thickness_raises_the_layers_along_the_normals() {
    let mound = |place: DVec2| 1.0 + 1.6 * (-place.length_squared() / 2025.0).exp();
    let field = |of: &dyn Fn(DVec2) -> f64| {
        let place = |k: usize| DVec2::new((k % 41) as f64 - 20.0, (k / 41) as f64 - 20.0) * 5.0;
        let factors = (0..41 * 41).map(|k| of(place(k))).collect();
        ThicknessField::new(5.0, [41; 2], factors).unwrap()
    };
    let even = Rest::layered(Sheet::new(33, 100.0), &[6.0, 12.0], 3);
    assert_eq!(even.clone().thickened(field(&|_| 1.0)), even);
    let curved = Chest::Curved { across_mm: 140.0, along_mm: f64::INFINITY };
    for chest in [Chest::Flat, curved] {
        let rest = even.clone().thickened(field(&mound)).over(chest.clone());
        for rest in [rest.coarser().unwrap(), rest] {
            assert_eq!(rest.mirrored(), [true; 2]);
            let (places, kinds) = (rest.sheet().rest().iter(), rest.sheet().kinds());
            for (k, place) in places.enumerate().filter(|&(k, _)| kinds[k] != NodeKind::Outside) {
                let place = place.clamp_length_max(100.0);
                for (layer, height) in [0.0, 6.0, 12.0, 18.0].into_iter().enumerate() {
                    let expected = chest.point(place, height * mound(place));
                    assert!(rest.node(layer, k).distance(expected) < 2e-3, "{place}");
                }
            }
        }
    }
    let aside = even.thickened(field(&|place| mound(place - DVec2::new(0.0, 20.0))));
    assert_eq!(aside.mirrored(), [true, false]);
}
