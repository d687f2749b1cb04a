use crate::setup::*;
use crate::structures::*;
use riprap_dda::*;
#[test]
fn arch_watch() {
    for (f, e, share, fr, kk) in [(1.3, 0.3, 1.0, 1.2, 2e10), (1.03, 0.3, 1.0, 1.2, 2e11), (1.06, 0.3, 1.0, 1.2, 2e10)] {
        let material = Material {
            friction_angle: fr,
            contact_stiffness: kk,
            restitution: e,
            ..rock()
        };
        let mut blocks = blocks(arch(24, f * 0.1075), material, down());
        let (mut now, mut next) = (0.0, 0.0);
        let mut n = 0;
        println!("thickness {f} e {e} share {share} friction {fr}");
        let s = blocks.energies().balance();
        let mut classes: std::collections::BTreeMap<u32, u64> = std::collections::BTreeMap::new();
        let mut kinds = std::collections::BTreeMap::new();
        let mut last: Vec<(usize, Vec3, usize)> = vec![];
        let mut flips = 0;
        while now < 3.0 {
            if now >= next {
                next += 0.5;
                let e = blocks.energies();
                println!(
                    "t {now:.2} steps {n} crown {:.5} kin {:.2e} err {:.2e} fr {:.2e} da {:.2e} flips {flips} {kinds:?} {classes:?}",
                    blocks.centroid(11).z,
                    e.kinetic,
                    e.balance() - s,
                    e.friction,
                    e.damping
                );
            }
            let dt = share * blocks.critical_time_step().dt.min(1e-2);
            if let Err(e) = blocks.advance(now, dt, 1) {
                println!("{e}");
                break;
            }
            now += dt;
            n += 1;
            let mut present: Vec<(usize, Vec3, usize)> = vec![];
            for c in blocks.contacts() {
                match present.last_mut() {
                    Some(l) if l.0 == c.blocks.0 && c.blocks.1 < 24 => l.2 += 1,
                    _ => present.push((c.blocks.0, c.normal, 1)),
                }
            }
            for p in &present {
                *kinds.entry(p.2).or_insert(0) += 1;
                if let Some(l) = last.iter().find(|l| l.0 == p.0) {
                    if (l.1 - p.1).norm() > 1e-7 || l.2 != p.2 {
                        flips += 1;
                    }
                }
            }
            last = present;
        }
    }
}
