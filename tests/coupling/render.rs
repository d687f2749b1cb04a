//! `riprap render`: from run folders made up here to POV-Ray text, pictures and films.
//!
//! RIPRAP_REQUIRE_POVRAY=1 makes the absence of POV-Ray a failure instead of a skipped check.

mod synthetic_run;

use riprap::render::{RenderOptions, WaterLook, render};
use std::path::PathBuf;
use std::time::Instant;
use synthetic_run::Result;

#[test]
#[ignore = "pictures to look at: 3 min; RIPRAP_GALLERY names the folder"]
fn gallery() -> Result<()> {
    let folder = PathBuf::from(std::env::var("RIPRAP_GALLERY")?);
    for (name, experiment) in [
        ("tank", synthetic_run::tank(0.02)),
        ("flume", synthetic_run::flume(0.14)),
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
