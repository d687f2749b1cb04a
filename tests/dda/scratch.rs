use crate::setup::*;
use crate::structures::*;
use riprap_dda::*;
#[test]
fn arch_watch() {
    let thickness = 0.15;
    for e in [0.0, 1.0] {
        let material = Material {
            friction_angle: 1.2,
            contact_stiffness: 2e10,
            restitution: e,
            ..rock()
        };
        let mut blocks = blocks(arch(24, thickness), material, down());
        let mut now = 0.0;
        let mut k = 0;
        let s = blocks.energies().balance();
        while now < 0.03 {
            let dt = blocks.critical_time_step().dt.min(1e-2);
            let r = blocks.advance(now, dt, 1);
            now += dt;
            k += 1;
            let e = blocks.energies();
            if k % 40 == 0 || r.is_err() {
                println!(
                    "t {now:.5} dt {dt:.2e} kin {:.3e} el {:.3e} fr {:.3e} da {:.3e} err {:.3e}",
                    e.kinetic,
                    e.elastic,
                    e.friction,
                    e.damping,
                    e.balance() - s
                );
            }
            if let Err(e) = r {
                println!("{e}");
                for c in blocks.contacts().iter().filter(|c| c.blocks == (4, 5)) {
                    println!("{c:?}");
                }
                break;
            }
        }
    }
}
