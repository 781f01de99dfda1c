//! The macro that makes the suite the tests of a crate.

/// Makes a test of each hard case, and of each closed mesh, for the structures that a function returns.
///
/// The argument is the path of a function that returns `Vec<`[`Structure`](crate::test_support::hard_cases::Structure)`>`. A failure
/// names the test, and in it the structure, the case, the transformation and the ray.
#[macro_export]
macro_rules! hard_case_tests {
    ($structures:path) => {
        $crate::hard_case_tests! { @cases $structures;
            case_01_ray_in_a_splitting_plane 1,
            case_02_triangle_in_a_splitting_plane 2,
            case_03_origin_on_a_splitting_plane 3,
            case_04_ray_in_a_box_face 4,
            case_05_negative_zeros 5,
            case_06_denormal_directions 6,
            case_07_axis_ray_on_a_rounded_face 7,
            case_08_shared_edges 8,
            case_09_vertices_of_high_valence 9,
            case_10_all_hits_on_edges 10,
            case_11_t_junction_with_a_gap 11,
            case_12_exact_t_junction 12,
            case_13_needle 13,
            case_14_grazed_sliver 14,
            case_15_distant_coplanar_edges 15,
            case_16_ray_in_the_plane 16,
            case_17_coplanar_overlap 17,
            case_18_duplicates 18,
            case_19_concentric_shells 19,
            case_20_deep_nesting 20,
            case_21_small_on_large 21,
            case_22_moved_far 22,
            case_23_far_origin 23,
            case_24_huge_coordinates 24,
            case_25_tiny_triangles 25,
            case_26_denormal_vertices 26,
            case_27_start_on_the_surface 27,
            case_28_origin_close_to_the_surface 28,
            case_29_interval_ends 29,
            case_30_invalid_intervals 30,
            case_31_degenerate_triangles 31,
            case_32_dropped_triangles 32,
            case_33_few_triangles 33,
            case_34_flat_scene 34,
            case_35_grazing_a_floor 35,
            case_36_long_triangle 36,
            case_37_ray_along_a_general_plane 37,
            case_38_acute_wedge 38,
            case_39_sliver_cells 39,
            case_40_turned_prism 40,
            case_41_nearly_coplanar_planes 41,
            case_42_far_from_the_node 42,
            case_43_sheared 43,
            case_44_directions_of_any_length 44,
            case_45_close_spheres 45,
        }
        $crate::hard_case_tests! { @closed $structures;
            closed_tetrahedron "tetrahedron",
            closed_cube "cube",
            closed_octahedron "octahedron",
            closed_sphere "sphere",
            closed_torus "torus",
            closed_blob_of_integers "blob of integers",
            closed_mesh_far_from_zero "irregular mesh far from zero",
            closed_needles "needles",
        }
    };
    (@cases $structures:path; $($name:ident $number:literal,)+) => {
        $(
            #[test]
            fn $name() {
                $crate::test_support::hard_cases::check_case($number, &$structures());
            }
        )+

        #[test]
        fn all_45_cases_have_a_test() {
            let tested: Vec<u8> = vec![$($number),+];
            assert_eq!(tested, (1..=45).collect::<Vec<u8>>());
        }
    };
    (@closed $structures:path; $($name:ident $mesh:literal,)+) => {
        $(
            #[test]
            fn $name() {
                $crate::test_support::hard_cases::check_closed_mesh($mesh, &$structures());
            }
        )+

        #[test]
        fn all_closed_meshes_have_a_test() {
            let meshes = $crate::test_support::hard_cases::closed_meshes();
            let names: Vec<&str> = meshes.iter().map(|case| case.name).collect();
            assert_eq!(names, vec![$($mesh),+]);
        }
    };
}
