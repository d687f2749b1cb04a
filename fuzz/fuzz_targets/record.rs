//! Records of motions and accelerations, and the motions that they drive.
#![no_main]

use libfuzzer_sys::fuzz_target;
use riprap::scene::file::MotionFile;
use riprap::scene::motion::recorded;

fuzz_target!(|text: &str| {
    let file = || "x.csv".to_owned();
    let table = MotionFile::Table { file: file() };
    let shaking = MotionFile::Shaking {
        direction: (1.0, 0.0, 0.0),
        file: file(),
    };
    for motion in [table, shaking] {
        if let Ok(riprap_dda::Motion::Prescribed(motion)) =
            recorded(&motion, "blocks[0].motion", text)
        {
            for time in [-1.0, 0.0, 0.37, 1e9] {
                let _ = (motion.velocity(time), motion.spin(time));
            }
        }
    }
});
