use crate::setup::*;
use crate::structures::*;
use riprap_dda::*;
#[test]
fn arch_watch() {
    let thickness = 0.15;
    let material = Material { friction_angle: 1.2, contact_stiffness: 2e10, ..rock() };
    let mut blocks = blocks(arch(24, thickness), material, down());
    let mut now = 0.0;
    while now < 6.0 {
        let dt = blocks.critical_time_step().dt.min(1e-2);
        if let Err(e) = blocks.advance(now, dt, 1) {
            println!("{e}");
            let hull = |b: usize| Polyhedron::convex_hull(&blocks.world_polygons(b).0).unwrap();
            let (a, b) = (hull(4), hull(5));
            let axes = separating_axes(&a, &b);
            println!("{axes:?}\n best {:?} true gap {:.3e}", axes.best(), gap_along(&a, &b, &axes.best().normal));
            println!("face true {:.3e}", gap_along(&a, &b, &axes.face_a.normal));
            break;
        }
        now += dt;
    }
}
