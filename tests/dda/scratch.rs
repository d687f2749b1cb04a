use crate::setup::*;
use riprap_dda::{Material, Motion};
#[test]
fn creep() {
    for f in [0.0, 0.3] {
        let stone = block(cuboid([0.0; 3], [0.4; 3]), Motion::Free);
        let mut blocks = blocks(
            vec![floor(), stone],
            Material {
                friction_angle: f,
                ..rock()
            },
            on_slope(0.5),
        );
        let mut t = 0.0;
        let mut k = 0;
        let s = ledger(&blocks.energies());
        while t < 0.3 {
            let dt = 0.5 * blocks.critical_time_step().dt;
            blocks.advance(t, dt, 1).unwrap();
            t += dt;
            k += 1;
            if k < 12 || k % 40 == 0 {
                let e = blocks.energies();
                println!(
                    "t {t:.5} err {:+.3e} kin {:.3e} pot {:.3e} el {:.3e} fr {:.3e} da {:.3e} n {} vx {:.3e}",
                    ledger(&e) - s,
                    e.kinetic,
                    e.potential,
                    e.elastic,
                    e.friction,
                    e.damping,
                    blocks.contacts().len(),
                    blocks.velocity(1).x
                );
            }
        }
    }
}
