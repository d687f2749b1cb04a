//! Checkpoints: the file, with the hash that goes with it too, and a state that is read into a world.
#![no_main]

use std::cell::RefCell;
use std::path::Path;

use libfuzzer_sys::fuzz_target;
use riprap::checkpoint;
use riprap::run::build;
use riprap::scene::parse;
use riprap::scene::resolve::Scene;
use riprap::world::World;

/// Every kind of pair and wall in few numbers.
const SCENE: &str = include_str!("../checkpoint.ron");

fn world() -> World {
    let file = parse::read(SCENE).expect("the scene is right");
    let scene = Scene::resolve(file, Path::new(".")).expect("it can be done");
    build(&scene).expect("it can be built")
}

/// A world after some steps, and its state.
fn start() -> (World, Vec<u8>) {
    let mut world = world();
    for _ in 0..3 {
        let step = world.next_step(1.0).expect("it has a step");
        world.step(step).expect("it goes on");
    }
    let state = world.save(Vec::new()).expect("it can be saved");
    (world, state)
}

thread_local! {
    static START: RefCell<(World, Vec<u8>)> = RefCell::new(start());
}

fuzz_target!(|bytes: &[u8]| {
    let path = Path::new("x.bin");
    let _ = checkpoint::read(path, bytes, &[0; 32]);
    let mut sealed = [b"riprap checkpoint\n".as_slice(), &1_u32.to_le_bytes(), bytes].concat();
    sealed.extend(blake3::hash(&sealed).as_bytes());
    let _ = checkpoint::read(path, &sealed, &[0; 32]);
    START.with_borrow_mut(|(world, state)| {
        try_to_read(world, bytes);
        // what was changed in some places only, after its first byte says where
        if let Some((&place, patch)) = bytes.split_first() {
            let mut changed = state.clone();
            let from = usize::from(place) * changed.len() / 256;
            let n = patch.len().min(changed.len() - from);
            changed[from..from + n].copy_from_slice(&patch[..n]);
            try_to_read(world, &changed);
        }
        world.read(state).expect("its own state");
    });
});

/// A world that could not read what it was given is in no state to go on.
fn try_to_read(one: &mut World, bytes: &[u8]) {
    if one.read(bytes).is_err() {
        *one = world();
    }
}
