//! Hostile input: what fuzzing found stays mended, files stay where they may be, and nothing is started that memory has no
//! room for.

use std::path::{Path, PathBuf};

use crate::support::{case, riprap, run, summary, words};
use riprap::checkpoint;
use riprap::memory::{Available, Estimate};
use riprap::run::build as build_world;
use riprap::scene;
use riprap::scene::access::{Access, FilesFrom};
use riprap::scene::cloud::cloud_of;
use riprap::scene::file::MotionFile;
use riprap::scene::geotiff::raster_from;
use riprap::scene::mesh::{solid_from, surface_from, survey_from};
use riprap::scene::motion::recorded;
use riprap::scene::parse::{self, Override};
use riprap::scene::raster::terrain_from;
use riprap::scene::resolve::Scene;
use riprap::table::table_from;
use riprap::trade::plan;

/// Files of `fuzz/corpus`, by the target they were kept for.
fn corpus(target: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../fuzz/corpus")
        .join(target);
    let mut files: Vec<_> = folder
        .read_dir()
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    files.sort();
    assert!(!files.is_empty(), "no corpus for {target}");
    files
        .into_iter()
        .map(|path| (path.clone(), std::fs::read(path).unwrap()))
        .collect()
}

fn texts(target: &str) -> impl Iterator<Item = String> {
    let files = corpus(target).into_iter();
    files.filter_map(|(_, content)| String::from_utf8(content).ok())
}

/// The fuzz targets on a stable compiler: no panic.
#[test]
fn kept_inputs_of_fuzzing_are_read_or_refused() {
    for (target, extension) in [
        ("stl", "stl"),
        ("obj", "obj"),
        ("ply", "ply"),
        ("vtk", "vtk"),
        ("vtk", "vtp"),
    ] {
        for (_, content) in corpus(target) {
            let _ = survey_from(&content, extension, 1.0);
            let _ = solid_from(&content, extension, 1.0);
            let _ = surface_from(&content, extension, 0.001);
        }
    }
    for (_, content) in corpus("raster") {
        let _ = terrain_from(&content, (0.0, 0.0));
    }
    for (_, content) in corpus("geotiff") {
        let _ = raster_from(&content);
    }
    for (_, content) in corpus("las") {
        if let Ok(cloud) = cloud_of(&content) {
            let _ = cloud.grid(None);
        }
    }
    for text in texts("table") {
        if let Ok(table) = table_from(Path::new("x.csv"), &text) {
            for column in &table.columns {
                let _ = table.column(&column.header());
            }
        }
    }
    for text in texts("record") {
        let file = || "x.csv".to_owned();
        let direction = (1.0, 0.0, 0.0);
        let shaking = MotionFile::Shaking {
            direction,
            file: file(),
        };
        for motion in [MotionFile::Table { file: file() }, shaking] {
            let _ = recorded(&motion, "blocks[0].motion", &text);
        }
    }
    for text in texts("study") {
        let _ = plan::read_text("x.ron", &text);
    }
    for text in texts("scene") {
        let _ = scene::load_text("x.ron", &text, &[], &small_machine());
    }
}

/// Clouds of LAS and LAZ and images of GeoTIFF with bytes changed at random, lengths in their headers first of all: no panic, and no
/// memory beyond what the file can hold, which the test would be killed for.
#[test]
fn changed_clouds_and_images_are_read_or_refused() {
    let mut state = 1_u64;
    let mut random = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize
    };
    let seeds = |target: &str| {
        corpus(target)
            .into_iter()
            .filter(|(path, _)| path.to_string_lossy().contains("seed"))
    };
    for (target, (path, seed)) in ["las", "geotiff"]
        .into_iter()
        .flat_map(|t| seeds(t).map(move |s| (t, s)))
    {
        for round in 0..400 {
            let mut content = seed.clone();
            for _ in 0..1 + round % 4 {
                // heads, where lengths are, as often as the rest
                let n = if random() % 2 == 0 {
                    content.len().min(400)
                } else {
                    content.len()
                };
                let at = random() % n;
                content[at] = [0, 1, 0x7f, 0xff, random() as u8][random() % 5];
            }
            if round % 7 == 0 {
                content.truncate(random() % content.len());
            }
            println!("{} round {round}", path.display());
            if target == "geotiff" {
                let _ = raster_from(&content);
            } else if let Ok(cloud) = cloud_of(&content) {
                let _ = cloud.grid(None);
            }
        }
    }
}

/// The same of checkpoints: the file, sealed with the hash that goes with it too, and bytes as the state of a world or in
/// the place of some of its own.
#[test]
fn kept_states_of_fuzzing_are_read_or_refused() {
    let build = || {
        let file = parse::read(include_str!("../../fuzz/checkpoint.ron")).unwrap();
        build_world(&Scene::resolve(file, Path::new(".")).unwrap()).unwrap()
    };
    let mut world = build();
    for _ in 0..3 {
        let step = world.next_step(1.0).unwrap();
        world.step(step).unwrap();
    }
    let state = world.save(Vec::new()).unwrap();
    let path = Path::new("x.bin");
    for (_, bytes) in corpus("checkpoint") {
        let _ = checkpoint::read(path, &bytes, &[0; 32]);
        let mut sealed = [
            b"riprap checkpoint\n".as_slice(),
            &1_u32.to_le_bytes(),
            &bytes,
        ]
        .concat();
        sealed.extend(blake3::hash(&sealed).as_bytes());
        let _ = checkpoint::read(path, &sealed, &[0; 32]);
        let mut changed = state.clone();
        if let Some((&place, patch)) = bytes.split_first() {
            let from = usize::from(place) * changed.len() / 256;
            let n = patch.len().min(changed.len() - from);
            changed[from..from + n].copy_from_slice(&patch[..n]);
        }
        for bytes in [&bytes, &changed] {
            if world.read(bytes).is_err() {
                world = build();
            }
        }
        world.read(&state).unwrap();
        assert_eq!(world.save(Vec::new()).unwrap(), state);
    }
}

fn small_machine() -> Access<'static> {
    Access {
        folder: Path::new("no such folder"),
        files: FilesFrom::SceneFolder,
        memory: Some(Available { bytes: 40_000_000 }),
    }
}

/// A block from a mesh, and one that moves by a record.
fn scene_with_files(mesh: &str, record: &str) -> String {
    format!(
        "(title: \"files\", domain: (min: (-9, -9, -9), max: (9, 9, 9)),
          materials: [(name: \"rock\", density: 2500, friction_angle_deg: 30)],
          blocks: [(name: \"a\", material: \"rock\", motion: Fixed, shape: Mesh(file: {mesh:?}, scale: 1)),
                   (name: \"b\", material: \"rock\", motion: Table(file: {record:?}),
                    shape: Box(min: (3, 3, 3), max: (4, 4, 4)))],
          time: (duration: 0.01))"
    )
}

const TETRAHEDRON: &str =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
const RECORD: &str = "0,0,0,0\n1,0.1,0,0\n";

/// A folder with a scene's folder in it, and a mesh and a record both beside and inside that.
fn folder_of_scene(text: &str) -> (tempfile::TempDir, PathBuf) {
    let outside = tempfile::tempdir().unwrap();
    let inside = outside.path().join("scene");
    std::fs::create_dir_all(inside.join("sub")).unwrap();
    for folder in [outside.path(), &inside, &inside.join("sub")] {
        std::fs::write(folder.join("a.obj"), TETRAHEDRON).unwrap();
        std::fs::write(folder.join("gauges.csv"), RECORD).unwrap();
    }
    let scene = inside.join("s.ron");
    std::fs::write(&scene, text).unwrap();
    (outside, scene)
}

#[test]
fn files_of_a_scene_stay_in_its_folder_unless_allowed() {
    let (outside, scene) = folder_of_scene(&scene_with_files("sub/a.obj", "gauges.csv"));
    let path = scene.to_str().unwrap();
    assert!(riprap(&["check", path]).status.success());
    let absolute = outside.path().join("a.obj");
    let absolute = absolute.to_str().unwrap();
    for mesh in ["../a.obj", "sub/../../a.obj", absolute] {
        std::fs::write(&scene, scene_with_files(mesh, "gauges.csv")).unwrap();
        for command in ["check", "run"] {
            let output = riprap(&[command, path]);
            assert_eq!(output.status.code(), Some(2), "{}", words(&output));
            let said = words(&output);
            // line and column of the field
            assert!(said.contains("s.ron:3:83: error: block `a`: "), "{said}");
            assert!(
                said.contains("leads out of the scene's folder, to "),
                "{said}"
            );
            assert!(said.contains("--allow-outside"), "{said}");
            assert!(said.contains(" [file-outside-folder]\n"), "{said}");
        }
        let output = riprap(&["check", path, "--allow-outside"]);
        assert!(output.status.success(), "{}", words(&output));
    }
    std::fs::write(&scene, scene_with_files("a.obj", "../gauges.csv")).unwrap();
    let said = words(&riprap(&["check", path]));
    assert!(said.contains("s.ron:4:"), "{said}");
    assert!(
        said.contains("`../gauges.csv`: leads out of the scene's folder"),
        "{said}"
    );
}

#[cfg(unix)]
#[test]
fn a_link_out_of_the_folder_is_refused_and_one_inside_is_not() {
    let (outside, scene) = folder_of_scene(&scene_with_files("link.obj", "gauges.csv"));
    let path = scene.to_str().unwrap();
    let link = scene.with_file_name("link.obj");
    std::os::unix::fs::symlink(outside.path().join("a.obj"), &link).unwrap();
    let output = riprap(&["check", path]);
    assert_eq!(output.status.code(), Some(2));
    let said = words(&output);
    assert!(
        said.contains("`link.obj`: leads out of the scene's folder, to "),
        "{said}"
    );
    assert!(riprap(&["check", path, "--allow-outside"]).status.success());
    std::fs::remove_file(&link).unwrap();
    std::os::unix::fs::symlink(scene.with_file_name("a.obj"), &link).unwrap();
    assert!(riprap(&["check", path]).status.success());
    // a folder that is a link
    std::fs::write(&scene, scene_with_files("way/a.obj", "gauges.csv")).unwrap();
    std::os::unix::fs::symlink(outside.path(), scene.with_file_name("way")).unwrap();
    assert!(words(&riprap(&["check", path])).contains("leads out of the scene's folder"));
}

/// Inputs from outside, and inputs with the name of an output, are renamed in the run folder; the archived case runs by
/// itself.
#[test]
fn inputs_are_kept_inside_the_run_folder_under_safe_names() {
    let (outside, scene) = folder_of_scene(&scene_with_files("../a.obj", "gauges.csv"));
    let folder = outside.path().join("runs/one");
    run(&scene, &folder, &["--allow-outside"]);
    assert_eq!(
        std::fs::read_to_string(outside.path().join("a.obj")).unwrap(),
        TETRAHEDRON
    );
    assert!(!outside.path().join("runs/a.obj").exists());
    let kept = std::fs::read_to_string(folder.join("case.ron")).unwrap();
    let kept = parse::read(&kept).unwrap();
    let mut names = kept.referenced_files();
    names.sort_unstable();
    assert_eq!(names, ["inputs/1_a.obj", "inputs/1_gauges.csv"]);
    assert_eq!(
        std::fs::read_to_string(folder.join("inputs/1_a.obj")).unwrap(),
        TETRAHEDRON
    );
    assert_eq!(
        std::fs::read_to_string(folder.join("inputs/1_gauges.csv")).unwrap(),
        RECORD
    );
    // what the run wrote itself
    assert!(
        std::fs::read_to_string(folder.join("gauges.csv"))
            .unwrap()
            .starts_with("time [s]")
    );
    let again = run(
        &folder.join("case.ron"),
        &outside.path().join("runs/two"),
        &[],
    );
    assert_eq!(again["state_hash"], summary(&folder)["state_hash"]);
    // a case that is run into its own folder keeps its files
    run(&folder.join("case.ron"), &folder, &["--force"]);
    assert_eq!(
        std::fs::read_to_string(folder.join("inputs/1_a.obj")).unwrap(),
        TETRAHEDRON
    );
}

#[cfg(unix)]
#[test]
fn what_is_no_file_is_not_read() {
    let (_outside, scene) = folder_of_scene(&scene_with_files("a.obj", "/dev/zero"));
    let output = riprap(&["check", scene.to_str().unwrap(), "--allow-outside"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        words(&output).contains("`/dev/zero`: is not a regular file"),
        "{}",
        words(&output)
    );
    let endless = riprap(&["check", "/dev/zero"]);
    assert_eq!(endless.status.code(), Some(2));
    assert!(
        words(&endless).contains("the scene has more than"),
        "{}",
        words(&endless)
    );
}

/// Bytes that `check` and `run` announce.
fn announced(case: &Path, sets: &[&str]) -> f64 {
    let overrides: Vec<Override> = sets.iter().map(|set| set.parse().unwrap()).collect();
    let (scene, _) = scene::load(case, &overrides).unwrap();
    Estimate::of(&scene).total()
}

/// Water in a plane and in space, both kinds of walls, wedges, spheres and jointed rock.
#[test]
fn a_run_takes_no_more_memory_than_announced() {
    let short = ["time.duration=0.002", "time.settle=0"];
    let cases: [(&str, &[&str]); 6] = [
        ("still_tank.ron", &[]),
        ("dam_break.ron", &[]),
        (
            "sliding_wedge.ron",
            &[
                "fluid.resolution=Spacing(0.05)",
                "domain.max=(5.3, 0.3, 1.8)",
                "blocks.wedge.shape.to=0.3",
            ],
        ),
        ("dam_break_cube.ron", &["fluid.resolution=Spacing(0.02)"]),
        ("heap.ron", &["grains[0].count=700"]),
        ("arch.ron", &[]),
    ];
    for (name, sets) in cases {
        let sets = [&short[..], sets].concat();
        let announced = announced(&case(name), &sets);
        let folder = tempfile::tempdir().unwrap();
        let mut arguments = vec!["--force"];
        sets.iter().for_each(|set| arguments.extend(["--set", set]));
        let summary = run(&case(name), folder.path(), &arguments);
        let peak = summary["peak_memory"].as_f64().unwrap();
        println!(
            "{name}: announced {announced:.3e}, peak {peak:.3e}, x {:.2}",
            announced / peak
        );
        // 0 where the system does not tell
        assert!(peak <= announced, "{name}: {peak} of {announced} bytes");
    }
    let output = riprap(&["check", case("arch.ron").to_str().unwrap()]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let megabytes = (announced(&case("arch.ron"), &[]) / 1e6).ceil();
    assert!(
        text.contains(&format!("up to {megabytes} MB: blocks")),
        "{text}"
    );
}

/// Absurd sizes are refused by name, at once: nothing of the size is made.
#[test]
fn what_needs_more_memory_than_there_is_is_refused_by_check_and_run() {
    let refused = |name: &str, sets: &[&str], expected: &[&str]| {
        for command in ["check", "run"] {
            let path = case(name);
            let mut arguments = vec![command, path.to_str().unwrap()];
            arguments.extend(sets);
            let output = riprap(&arguments);
            let said = words(&output);
            assert_eq!(output.status.code(), Some(2), "{said}");
            for words in expected {
                assert!(said.contains(words), "{said}");
            }
        }
    };
    // 1e12 and more particles
    let fine = ["--set", "fluid.resolution=Spacing(0.00001)"];
    refused(
        "sliding_wedge.ron",
        &fine,
        &["fluid.resolution", "lattice nodes"],
    );
    let many = ["--set", "fluid.resolution=Count(4000000000)"];
    refused(
        "sliding_wedge.ron",
        &many,
        &["particles", "GB", "the machine has", "fluid.resolution"],
    );
    let balls = ["--set", "grains[0].count=1000000000"];
    refused("heap.ron", &balls, &["1000000000 spheres are more than"]);
    let joints = ["--set", "rock_masses[0].joint_sets[0].spacing=1e-7"];
    refused(
        "rock_slope.ron",
        &joints,
        &["the joints would make about", "widen its spacing"],
    );
}

#[test]
fn both_figures_and_the_field_are_told_where_a_machine_is_too_small() {
    let text = std::fs::read_to_string(case("still_tank.ron")).unwrap();
    let on = |bytes: u64| {
        let reach = Access {
            memory: Some(Available { bytes }),
            ..small_machine()
        };
        scene::load_text("still_tank.ron", &text, &[], &reach)
            .map(|(scene, _)| scene)
            .map_err(|error| error.to_string())
    };
    let needed = Estimate::of(&on(1_000_000_000).unwrap()).total();
    assert!(on(needed.ceil() as u64).is_ok());
    let said = on(needed as u64 - 1).unwrap_err();
    let both = format!("the run needs up to {:.0} MB: water", (needed / 1e6).ceil());
    assert!(said.contains(&both), "{said}");
    let there = format!("the machine has {:.3} GB", needed / 1e9);
    assert!(said.contains(&there), "{said}");
    assert!(said.contains("coarsen `fluid.resolution`"), "{said}");
    // before the water is filled in
    let said = on(500_000).unwrap_err();
    assert!(
        said.contains("particles or more, which need at least 0.0"),
        "{said}"
    );
}
