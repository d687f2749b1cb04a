//! The state of a world as bytes: saved in a run, read back into the world of the same scene.

use super::World;
use super::pistons::{AbsorbingPiston, State};
use crate::saved::{Read, Saved};

impl World {
    /// Appends the state to some bytes.
    ///
    /// # Errors
    ///
    /// None is expected: the format accepts any world.
    pub fn save(&self, out: Vec<u8>) -> Saved {
        // no `..`: a new column cannot be forgotten
        let Self {
            blocks,
            water,
            progress,
            bodies,
            pistons,
            // constants
            gravity: _,
            weakenings: _,
        } = self;
        let states: Vec<_> = pistons.iter().map(AbsorbingPiston::state).collect();
        let out = postcard::to_extend(&(progress, &bodies.dry, &bodies.accounts, states), out)?;
        let out = blocks.save(out)?;
        let Some(water) = water else { return Ok(out) };
        let out = water.fluid.save(out)?;
        let out = water.interface.save(out)?;
        let out = water.joints.save(out)?;
        let out = water.openings.save(out)?;
        let out = match &water.grains {
            None => out,
            Some(grains) => grains.save(out)?,
        };
        match &water.walls {
            None => Ok(out),
            Some(walls) => walls.save(out),
        }
    }

    /// Restores the state from the front of bytes written by [`Self::save`] in a run of the same scene; returns the rest.
    /// The continuation is bitwise identical.
    ///
    /// # Errors
    ///
    /// The bytes end early, are invalid, or belong to another scene. The world can then not be continued.
    pub fn read<'a>(&mut self, bytes: &'a [u8]) -> Read<'a> {
        let bodies = &mut self.bodies;
        let n_blocks = bodies.dry.len();
        let wanted: Vec<usize> = (bodies.accounts.iter()).map(|a| a.block).collect();
        let (states, rest): (Vec<State>, _);
        ((self.progress, bodies.dry, bodies.accounts, states), rest) =
            postcard::take_from_bytes(bytes)?;
        if bodies.dry.len() != n_blocks || states.len() != self.pistons.len() {
            return Err(postcard::Error::DeserializeBadEncoding);
        }
        for (piston, state) in self.pistons.iter_mut().zip(states) {
            piston.restore(state);
        }
        let bytes = self.blocks.read(rest)?;
        // a run taken further may record other blocks
        self.keep_accounts(&wanted);
        let Some(water) = &mut self.water else {
            return Ok(bytes);
        };
        let bytes = water.fluid.read(bytes)?;
        let bytes = water.interface.read(bytes)?;
        let bytes = water.joints.read(bytes)?;
        let bytes = water.openings.read(bytes)?;
        let bytes = match &mut water.grains {
            None => bytes,
            Some(grains) => grains.read(bytes)?,
        };
        match &mut water.walls {
            None => Ok(bytes),
            Some(walls) => walls.read(bytes, &mut water.fluid, &self.blocks),
        }
    }
}
