//! `riprap render`: from run folders made up here to POV-Ray text, pictures and films.
//!
//! RIPRAP_REQUIRE_POVRAY=1 makes the absence of POV-Ray a failure instead of a skipped check.

use crate::support::synthetic_run::{self, Experiment, Result};
use riprap::render::{RenderError, RenderOptions, RenderSummary, WaterLook, render};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// A tank coarse enough for a test.
fn small_tank() -> Experiment {
    Experiment {
        times: vec![0.0, 0.1],
        ..synthetic_run::tank(0.05)
    }
}

/// Options without POV-Ray, as on a machine that has none.
fn text_only(water: WaterLook) -> RenderOptions {
    RenderOptions {
        water,
        povray: PathBuf::from("no-such-povray"),
        ..RenderOptions::default()
    }
}

fn drawn(run: &Path, options: &RenderOptions) -> Result<(RenderSummary, Vec<String>)> {
    let mut lines = Vec::new();
    let summary = render(run, options, &mut |line| lines.push(line.to_owned()))?;
    Ok((summary, lines))
}

/// Whether POV-Ray is here; a test that needs it passes unseen where it may be absent.
fn has_povray() -> bool {
    let is_present = Command::new("povray").arg("--version").output().is_ok();
    let is_required = std::env::var("RIPRAP_REQUIRE_POVRAY").is_ok_and(|v| v == "1");
    assert!(
        is_present || !is_required,
        "RIPRAP_REQUIRE_POVRAY=1, but there is no povray"
    );
    is_present
}

/// Checks braces, numbers and every mesh; returns how many meshes there are.
fn check_text(text: &str) -> usize {
    assert_eq!(text.matches('{').count(), text.matches('}').count());
    for word in ["NaN", "nan", "inf,", "inf>"] {
        assert!(!text.contains(word), "{word}");
    }
    let numbers = |list: &str| -> Vec<usize> {
        list.split(|c: char| !c.is_ascii_digit())
            .filter_map(|n| n.parse().ok())
            .collect()
    };
    let meshes = text.split("mesh2 {").skip(1);
    meshes
        .map(|mesh| {
            let list = |name: &str| {
                mesh.split(name)
                    .nth(1)
                    .and_then(|m| m.split('}').next())
                    .unwrap_or("")
            };
            let vertices = list("vertex_vectors {");
            let n_vertices = vertices.matches('<').count();
            assert_eq!(
                numbers(vertices.split(',').next().unwrap_or("")),
                [n_vertices]
            );
            let faces = numbers(list("face_indices {"));
            assert_eq!(faces.len(), 1 + 3 * faces[0]);
            let mut is_used = vec![false; n_vertices];
            for &corner in &faces[1..] {
                is_used[corner] = true;
            }
            assert!(is_used.iter().all(|&u| u), "a vertex belongs to no face");
        })
        .count()
}

#[test]
fn every_particle_is_a_sphere_and_the_text_is_well_formed() -> Result<()> {
    let folder = tempfile::tempdir()?;
    for (name, experiment) in [
        ("tank", small_tank()),
        ("flume", synthetic_run::flume(0.35)),
    ] {
        let run = folder.path().join(name);
        synthetic_run::write(&run, &experiment, "", 0)?;
        let (summary, _) = drawn(&run, &text_only(WaterLook::Particles))?;
        assert_eq!(summary.scenes.len(), experiment.times.len());
        for (i, scene) in summary.scenes.iter().enumerate() {
            let text = fs::read_to_string(scene)?;
            let cloud = riprap::vtk::read(&run.join(format!("water_{i:05}.vtp")))?;
            assert_eq!(text.matches("\nsphere {").count(), cloud.points.len());
            // Walls and the block; in strips once each per strip, the block in at least one.
            assert!(summary.camera.panels().len() < check_text(&text));
        }
    }
    Ok(())
}

#[cfg(feature = "surface")]
#[test]
fn a_surface_leaves_the_spray_out_and_draws_it_as_spheres() -> Result<()> {
    let run = tempfile::tempdir()?;
    synthetic_run::write(run.path(), &small_tank(), "", 0)?;
    let (summary, _) = drawn(run.path(), &text_only(WaterLook::Surface))?;
    let text = fs::read_to_string(&summary.scenes[0])?;
    // Walls, block, water.
    assert_eq!(check_text(&text), 3);
    assert!(text.contains("Riprap_Water_Texture"));
    let spheres =
        |path: &PathBuf| fs::read_to_string(path).map(|t| t.matches("\nsphere {").count());
    let drawn: usize = summary
        .scenes
        .iter()
        .map(spheres)
        .sum::<std::io::Result<usize>>()?;
    assert_eq!(drawn, summary.spray);
    // 12 drops per frame; one close to the surface may count as water.
    assert!((20..=24).contains(&drawn), "{drawn}");
    Ok(())
}

#[test]
fn points_that_are_not_finite_are_skipped_and_counted() -> Result<()> {
    let run = tempfile::tempdir()?;
    synthetic_run::write(run.path(), &small_tank(), "", 5)?;
    let (summary, lines) = drawn(run.path(), &text_only(WaterLook::Particles))?;
    check_text(&fs::read_to_string(&summary.scenes[0])?);
    assert_eq!(summary.skipped_points, 5);
    assert!(lines.iter().any(|l| l.contains("5 particles")), "{lines:?}");
    Ok(())
}

#[test]
fn without_povray_the_text_is_written_and_the_user_told_how_to_go_on() -> Result<()> {
    let run = tempfile::tempdir()?;
    synthetic_run::write(run.path(), &small_tank(), "", 0)?;
    let (summary, lines) = drawn(run.path(), &text_only(WaterLook::Particles))?;
    assert!(summary.pictures.is_empty() && summary.film.is_none());
    for name in [
        "frame_00000.pov",
        "frame_00001.pov",
        "scene.inc",
        "materials.inc",
        "labels.inc",
    ] {
        assert!(summary.folder.join(name).is_file(), "{name}");
    }
    let told = lines.iter().find(|l| l.contains("no pictures"));
    assert!(
        told.is_some_and(|l| l.contains("povray +Iframe_00000.pov")),
        "{lines:?}"
    );
    Ok(())
}

#[test]
fn an_edited_include_is_kept() -> Result<()> {
    let run = tempfile::tempdir()?;
    synthetic_run::write(run.path(), &small_tank(), "", 0)?;
    let (summary, _) = drawn(run.path(), &text_only(WaterLook::Particles))?;
    let include = summary.folder.join("materials.inc");
    fs::write(&include, "// mine")?;
    let (_, lines) = drawn(run.path(), &text_only(WaterLook::Particles))?;
    assert_eq!(fs::read_to_string(&include)?, "// mine");
    assert!(
        lines
            .iter()
            .any(|l| l.contains("materials.inc") && l.contains("kept"))
    );
    Ok(())
}

#[test]
fn the_camera_of_the_scene_is_the_camera_of_the_frame() -> Result<()> {
    let run = tempfile::tempdir()?;
    let camera = "camera: Some((position: (1.0, -4.0, 2.0), look_at: (0.5, 0.0, 0.25), field_of_view_deg: 35.0))";
    synthetic_run::write(run.path(), &small_tank(), camera, 0)?;
    let (summary, _) = drawn(run.path(), &text_only(WaterLook::Particles))?;
    let text = fs::read_to_string(&summary.scenes[1])?;
    // A scene of 1 to 10 m is drawn in centimeters: POV-Ray overlooks gaps below 0.001.
    assert!(text.contains("#declare Riprap_Unit = 100;"));
    assert!(text.contains("#declare Riprap_Eye = <100, -400, 200>;"));
    assert!(text.contains("#declare Riprap_Target = <50, 0, 25>;"));
    assert!(text.contains("sky z right -x*image_width/image_height angle 35"));
    Ok(())
}

#[test]
fn what_is_missing_is_named() -> Result<()> {
    let run = tempfile::tempdir()?;
    let failure = |options: &RenderOptions| {
        render(run.path(), options, &mut |_| {})
            .err()
            .map_or(String::new(), |e| e.to_string())
    };
    let options = text_only(WaterLook::Particles);
    let message = failure(&options);
    assert!(
        message.contains("case.ron") && message.contains("run folder"),
        "{message}"
    );

    synthetic_run::write(run.path(), &small_tank(), "", 0)?;
    let message = failure(&RenderOptions {
        frames: Some(7..9),
        ..options.clone()
    });
    assert!(
        message.contains("7..9") && message.contains("0..2"),
        "{message}"
    );
    let message = failure(&RenderOptions {
        every: 0,
        ..options.clone()
    });
    assert!(
        message.contains("every") && message.contains("at least 1"),
        "{message}"
    );

    fs::remove_file(run.path().join("water_00001.vtp"))?;
    let message = failure(&options);
    assert!(message.contains("water_00001.vtp"), "{message}");

    fs::remove_file(run.path().join("water.pvd"))?;
    fs::remove_file(run.path().join("blocks.pvd"))?;
    assert!(matches!(
        render(run.path(), &options, &mut |_| {}),
        Err(RenderError::NoFrames { .. })
    ));
    Ok(())
}

#[test]
fn a_running_job_without_summary_is_drawn() -> Result<()> {
    let run = tempfile::tempdir()?;
    synthetic_run::write(run.path(), &small_tank(), "", 0)?;
    fs::remove_file(run.path().join("summary.json"))?;
    let (summary, lines) = drawn(run.path(), &text_only(WaterLook::Particles))?;
    assert_eq!(summary.scenes.len(), 2);
    assert!(lines[0].contains("particle spacing 0.0500 m"), "{lines:?}");
    Ok(())
}

#[test]
fn povray_makes_pictures_of_the_right_size_and_ffmpeg_a_film() -> Result<()> {
    if !has_povray() {
        return Ok(());
    }
    let run = tempfile::tempdir()?;
    synthetic_run::write(run.path(), &small_tank(), "", 0)?;
    let options = RenderOptions {
        size: (97, 54),
        ..RenderOptions::default()
    };
    let (summary, _) = drawn(run.path(), &options)?;
    assert_eq!(summary.pictures.len(), 2);
    let file = std::io::BufReader::new(fs::File::open(&summary.pictures[0])?);
    let mut reader = png::Decoder::new(file).read_info()?;
    let mut pixels = vec![0; reader.output_buffer_size().unwrap_or_default()];
    let info = reader.next_frame(&mut pixels)?;
    assert_eq!((info.width, info.height), (97, 54));
    let mut colors: Vec<&[u8]> = pixels.chunks(info.color_type.samples()).collect();
    colors.sort_unstable();
    colors.dedup();
    assert!(100 < colors.len(), "{} colors", colors.len());

    // The frames are 0.1 s apart: real time at 10 per second.
    if let Some(film) = summary.film {
        assert!((film.speed - 1.0).abs() < 1e-9 && 0 < fs::metadata(film.path)?.len());
    }
    // A kept frame renders alone, and at the same size.
    let status = Command::new("povray")
        .arg("frame_00001.pov")
        .current_dir(&summary.folder)
        .output()?;
    assert!(
        status.status.success(),
        "{}",
        String::from_utf8_lossy(&status.stderr)
    );
    Ok(())
}

#[test]
#[ignore = "pictures to look at: 3 min; RIPRAP_GALLERY names the folder"]
#[expect(
    clippy::print_stdout,
    reason = "seconds per frame, for whoever looks at the pictures"
)]
fn gallery() -> Result<()> {
    let folder = PathBuf::from(std::env::var("RIPRAP_GALLERY")?);
    for (name, experiment) in [
        ("tank", synthetic_run::tank(0.02)),
        ("flume", synthetic_run::flume(0.14)),
        ("fine_tank", synthetic_run::tank(0.0125)),
    ] {
        let run = folder.join(name);
        synthetic_run::write(&run, &experiment, "", 0)?;
        for (water, look) in [
            (WaterLook::Particles, "particles"),
            (WaterLook::Surface, "surface"),
        ] {
            let options = RenderOptions {
                water,
                frames: Some(2..3),
                ..RenderOptions::default()
            };
            let start = Instant::now();
            let summary = render(&run, &options, &mut |line| println!("{line}"))?;
            println!("{name} {look}: {:.1} s", start.elapsed().as_secs_f64());
            std::fs::rename(
                &summary.pictures[0],
                folder.join(format!("{name}_{look}.png")),
            )?;
        }
    }
    Ok(())
}
