//! GLB, as phones write it.

use super::*;

#[test]
fn damaged_glb_is_rejected_in_one_line() {
    // A table of inputs.
    let _alone = ALONE.lock();
    let whole = glb(&phone_json(), &phone_data());
    assert!(check_surface(&whole, ""));
    let length = whole.len();
    let with = |at: usize, bytes: &[u8]| {
        let mut damaged = whole.clone();
        damaged[at..at + bytes.len()].copy_from_slice(bytes);
        damaged
    };
    let data = length - 76 - 8;
    for (bytes, expected) in [
        (whole[..8].to_vec(), "damaged: byte 8: it ends in a header of GLB".to_owned()),
        (with(4, &[1]), "the file is glTF 1; allowed: glTF 2, as GLB, or PLY or STL".to_owned()),
        (
            whole[..length - 9].to_vec(),
            format!("damaged: it ends after {} of {length} bytes", length - 9),
        ),
        (with(8, &[255; 4]), format!("damaged: it ends after {length} of 4294967295 bytes")),
        (with(12, &[255; 4]), "damaged: byte 12: no whole part \"JSON\"".to_owned()),
        (with(16, b"TEXT"), "damaged: byte 12: no whole part \"JSON\"".to_owned()),
        (with(data, &[255; 4]), format!("damaged: byte {data}: no whole part \"BIN\\x00\"")),
        (with(40, b"\""), "damaged: line 1, column 22 of its description (JSON)".to_owned()),
    ] {
        assert_eq!(line_of(&bytes, ""), expected);
    }
    let cases: Vec<(&str, Value, &str)> = vec![
        (
            "/accessors/0/count",
            json!(4_000_000_000_u64),
            "damaged: its list of numbers 0 (accessors) needs 48000000000 bytes, there are 48",
        ),
        (
            "/accessors/0/count",
            json!(u64::MAX),
            "damaged: its list of numbers 0 (accessors) ends beyond the file",
        ),
        (
            "/accessors/0/count",
            json!(-4),
            "damaged: its list of numbers 0 (accessors) has no length (count)",
        ),
        (
            "/accessors/0/type",
            json!("VEC2"),
            "damaged: its list of numbers 0 (accessors) has not three numbers for each place",
        ),
        (
            "/accessors/1/componentType",
            json!(5124),
            "damaged: its list of numbers 1 (accessors) has numbers of an unknown kind (componentType)",
        ),
        (
            "/accessors/1/sparse",
            json!({ "count": 1 }),
            "the surface is stored with gaps (sparse); export it as PLY or STL",
        ),
        (
            "/accessors/1/bufferView",
            json!(null),
            "damaged: its list of numbers 1 (accessors) has no place in the file (bufferView)",
        ),
        ("/accessors/1/bufferView", json!(7), "damaged: number 7 of 3 bufferViews is missing"),
        (
            "/accessors/1/byteOffset",
            json!(8),
            "damaged: its list of numbers 1 (accessors) needs 20 bytes, there are 12",
        ),
        (
            "/bufferViews/0/byteStride",
            json!(u64::MAX),
            "damaged: its list of numbers 0 (accessors) ends beyond the file",
        ),
        (
            "/bufferViews/0/byteOffset",
            json!(70),
            "damaged: its list of numbers 0 (accessors) ends beyond the file",
        ),
        (
            "/bufferViews/0/byteOffset",
            json!(u64::MAX),
            "damaged: its list of numbers 0 (accessors) ends beyond the file",
        ),
        (
            "/buffers/0/uri",
            json!("mesh.bin"),
            "the surface is in a second file; export it in one file, as PLY or STL",
        ),
        (
            "/meshes/0/primitives/0/attributes/POSITION",
            json!(3),
            "damaged: number 3 of 3 accessors is missing",
        ),
        ("/nodes/0/mesh", json!(1), "damaged: number 1 of 1 meshes is missing"),
        (
            "/nodes/0/rotation",
            json!([0, 0, 0, 0]),
            "damaged: the place of part 0 (nodes) is not finite",
        ),
        ("/nodes/0/scale", json!([1, 2]), "damaged: the place of part 0 (nodes) is not finite"),
        ("/nodes/0/children", json!([1]), "damaged: part 1 (nodes) stands in itself or twice"),
        ("/nodes/1/children", json!([0, 0]), "damaged: part 0 (nodes) stands in itself or twice"),
        ("/nodes/1/children", json!([9]), "damaged: number 9 of 2 nodes is missing"),
        (
            "/scenes/0/nodes",
            json!([]),
            "the file has 0 points and no surface; export the surface as triangles, as PLY or STL",
        ),
        (
            "/meshes/0/primitives/0/mode",
            json!(1),
            "the file has 0 points and no surface; export the surface as triangles, as PLY or STL",
        ),
        (
            "/extensionsRequired",
            json!(["KHR_draco_mesh_compression"]),
            "the surface is compressed (KHR_draco_mesh_compression); export it without compression, as PLY or STL",
        ),
    ];
    for (path, value, expected) in cases {
        let mut json = phone_json();
        let (parent, name) = path.rsplit_once('/').unwrap();
        json.pointer_mut(parent).unwrap()[name] = value;
        assert_eq!(line_of(&glb(&json, &phone_data()), ""), expected, "{path}");
    }
    // A list of 1 MB in an unknown place, and lists in lists.
    let long = glb(&json!({ "a": vec![0; 500_000] }), &[]);
    assert_eq!(
        line_of(&long, ""),
        "the file has 0 points and no surface; export the surface as triangles, as PLY or STL"
    );
    let mut deep = glb(&json!("x".repeat(10_000)), &[]);
    deep[20..10_020].fill(b'[');
    assert_eq!(line_of(&deep, ""), "damaged: line 1, column 128 of its description (JSON)");
}
