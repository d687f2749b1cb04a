use crate::setup::*;
use crate::structures::*;
use riprap_dda::*;
#[test]
fn arch_watch() {
    let thickness = 0.15;
    for e in [0.0] {
    let material = Material { friction_angle: 1.2, contact_stiffness: 2e10, restitution: e, ..rock() };
    let mut blocks = blocks(arch(24, thickness), material, down());
    let mut now = 0.0; let mut k = 0;
    let s = blocks.energies().balance();
    let mut last = 0.0;
    while now < 0.009 {
        let dt = blocks.critical_time_step().dt.min(1e-2);
        blocks.advance(now, dt, 1).unwrap();
        now += dt; k += 1;
        let e = blocks.energies();
        if now > 0.0085 { 
            let err = e.balance() - s;
            println!("t {now:.6} derr {:.3e} kin {:.3e} el {:.3e}", err - last, e.kinetic, e.elastic);
            last = err;
            for p in 3..4 {
                let c: Vec<_> = blocks.contacts().iter().filter(|c| c.blocks == (p, p + 1)).collect();
                if let Some(f) = c.first() {
                    let rate: Vec<String> = c.iter().map(|c| format!("{:.2e}/{:.1e}/{:.1e}", c.overlap, c.normal_force, (blocks.velocity_at(p+1, &c.point) - blocks.velocity_at(p, &c.point)).dot(&c.normal))).collect();
                    println!("   pair {p} n {} normal {:.6} {:.6} {:.6} {rate:?} key {}", c.len(), f.normal.x, f.normal.y, f.normal.z, f.key);
                }
            }
        }
    }
    }
}
