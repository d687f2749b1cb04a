use crate::setup::*;
use crate::structures::*;
use riprap_dda::*;
#[test]
fn arch_watch() {
    for (f, fr) in [(1.03, 1.2), (1.1, 1.2), (1.3, 1.2), (1.1, 0.8)] {
    let material = Material { friction_angle: fr, contact_stiffness: 2e10, ..rock() };
    let mut blocks = blocks(arch(24, f * 0.1075), material, down());
    let (mut now, mut next) = (0.0, 0.0); let mut n = 0;
    println!("thickness {f} friction {fr}");
    let s = blocks.energies().balance();
    while now < 8.0 {
        if now >= next { next += 1.0;
          let e = blocks.energies();
          println!("t {now:.2} steps {n} crown {:.5} quarter {:.5} {:.5} side {:.5} overlap {:.2e} kin {:.2e} err {:.2e} fr {:.2e} da {:.2e} y {:.2e}", blocks.centroid(11).z, blocks.centroid(5).x, blocks.centroid(5).z, blocks.centroid(18).x+blocks.centroid(5).x, blocks.max_overlap_over_size(), e.kinetic, e.balance()-s, e.friction, e.damping, blocks.centroid(11).y);
        }
        let dt = blocks.critical_time_step().dt.min(1e-2);
        if let Err(e) = blocks.advance(now, dt, 1) { println!("{e}"); break; }
        now += dt; n += 1;
        if blocks.centroid(11).z < 9.4 { println!("fell at {now}"); 
        break; }
    }
    for b in 0..24 { print!("{:.3} ", blocks.orientation(b).scaled_axis().y); } println!();
    }
}
