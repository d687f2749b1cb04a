//! The fluid's sums over neighbors: settings become types here, once per sum and not once per pair.

use std::marker::PhantomData;

use crate::boundary::screens::{Facet, Screens};
use crate::fluid::Settings;
use crate::kernel::{AnyKernel, KernelChoice, PairKernel, PointKernel, Viscous, WendlandC2};
use crate::neighbors::cells::CellGrid;
use crate::neighbors::lists::{Lists, Surroundings};
use crate::neighbors::points::Frame;
use crate::neighbors::rest::Still;
use crate::neighbors::sweep::{
    AnyPoints, Between, PackedIn, Receivers, Sources, Sum, Term, Veil, dispatch, sweep, sweep_as,
};
use crate::scheme::{DensityDiffusion, Viscosity};
use crate::simd::lanes::{Lanes, Machine};
use crate::terms::continuity::{
    AnyDiffusion, Continuity, Diffusion, GradientDiffusion, JumpDiffusion, NoDiffusion, Rate,
    RateOwn,
};
use crate::terms::disorder::{Disorder, Spread};
use crate::terms::extrapolation::{Extrapolated, Extrapolation};
use crate::terms::gradient::{Gradient, Strain, StrainSums};
use crate::terms::momentum::{
    AnyViscosity, Central, ForceDensity, ForceOwn, Momentum, PairPressure, PairViscosity,
    Published, Shear, SumOfPressures, VariableShear, WeightedByDensity,
};
use crate::terms::summation::Summation;
use crate::{Fluid, Vec3};

/// Points in their cells.
#[derive(Clone, Copy)]
pub(crate) struct Neighborhood<'a> {
    pub grid: &'a CellGrid,
    pub frame: &'a Frame,
    pub points: &'a AnyPoints,
    /// Farthest that they, or the receivers, may be from where they were sorted; m.
    pub moved: f64,
    pub veil: Option<Veil<'a>>,
}

/// Occlusion between receivers and points at given positions; `None` without thin solids.
pub(crate) fn veil<'a>(
    screens: &'a Screens,
    positions: &'a [Vec3],
    between: Between<'a>,
) -> Option<Veil<'a>> {
    (0 < screens.len()).then_some(Veil {
        screens,
        positions,
        between,
    })
}

/// Wall points that receive.
#[derive(Clone, Copy)]
pub(crate) struct Places<'a> {
    /// m.
    pub positions: &'a [Vec3],
    /// Faces of thin solids that they are behind.
    pub facets: &'a [Facet],
}

/// Setup common to all sums.
struct Setup<'a> {
    settings: &'a Settings,
    from: Neighborhood<'a>,
    receivers: Receivers<'a>,
    /// Neighbor lists of all receivers.
    lists: Option<&'a Lists>,
}

impl Setup<'_> {
    fn sources<R: PackedIn>(&self) -> Sources<'_, R> {
        Sources {
            grid: self.from.grid,
            frame: self.from.frame,
            points: R::of(self.from.points),
            veil: self.from.veil,
            mirrors: self.settings.mirrors(),
            support_radius: self.settings.support_radius(),
            moved: self.from.moved,
        }
    }

    fn kernel<L: Lanes, K: PairKernel<L>>(&self, machine: L::Machine) -> K {
        let s = self.settings;
        let kernel = PointKernel::new(s.scheme.kernel, s.support_radius(), s.dimensions);
        K::new(machine, &kernel)
    }
}

/// Source of the neighbors of a sum: a type, so that unused combinations are not compiled.
trait Way {
    /// Sums a term into `out`; returns the number of neighbors.
    fn sum<L, T>(setup: &Setup, machine: L::Machine, term: &T, out: &mut [T::Out]) -> u64
    where
        L: Lanes,
        L::Machine: Machine,
        L::Record: Default + PackedIn,
        T: Term<L>;
}

/// Within the fluid: by the lists, if there are any.
struct Within;

impl Way for Within {
    fn sum<L, T>(setup: &Setup, machine: L::Machine, term: &T, out: &mut [T::Out]) -> u64
    where
        L: Lanes,
        L::Machine: Machine,
        L::Record: Default + PackedIn,
        T: Term<L>,
    {
        let (sources, receivers) = (setup.sources(), setup.receivers);
        match setup.lists {
            Some(lists) => lists.sum::<L, T>(machine, term, &sources, receivers.positions, out),
            // only particles that moved farther than the skin without a sort have none
            None => sweep_as::<L, T, true>(machine, term, &sources, receivers, out),
        }
    }
}

/// Between the fluid and its walls.
struct Across;

impl Way for Across {
    fn sum<L, T>(setup: &Setup, machine: L::Machine, term: &T, out: &mut [T::Out]) -> u64
    where
        L: Lanes,
        L::Machine: Machine,
        L::Record: Default + PackedIn,
        T: Term<L>,
    {
        sweep::<L, T>(machine, term, &setup.sources(), setup.receivers, out)
    }
}

/// Runs `$self.with::<L, K>($machine)` for the kernel of the settings: Wendland's by itself where registers are fast,
/// any of them by its choice at run time elsewhere.
macro_rules! for_kernel {
    ($self:ident, $machine:ident, $lanes:ident) => {
        match $self.setup.settings.scheme.kernel {
            KernelChoice::WendlandC2 if $lanes::IS_SPECIALIZED => {
                $self.with::<$lanes, WendlandC2<$lanes>>($machine)
            }
            _ => $self.with::<$lanes, AnyKernel<$lanes>>($machine),
        }
    };
}

/// Makes a struct a [`Sum`] by its `with`.
macro_rules! sum_over_kernels {
    ($name:ident $(, $way:ident)?) => {
        impl $(<$way: Way>)? Sum for $name<'_ $(, $way)?> {
            fn run<L>(self, machine: L::Machine)
            where
                L: Lanes,
                L::Machine: Machine,
                L::Record: Default + PackedIn,
            {
                for_kernel!(self, machine, L)
            }
        }
    };
}

impl Fluid {
    fn neighborhood<'a>(&'a self, points: &'a AnyPoints, between: Between<'a>) -> Neighborhood<'a> {
        Neighborhood {
            veil: veil(&self.screens, &self.particles.position, between),
            grid: &self.grid,
            frame: &self.frame,
            points,
            moved: self.moved(),
        }
    }

    /// Sums over the fluid for all its particles.
    fn to_everyone<'a>(&'a self, points: &'a AnyPoints) -> Setup<'a> {
        Setup {
            settings: &self.settings,
            from: self.neighborhood(points, Between::Particles),
            receivers: Receivers {
                positions: &self.particles.position,
                chosen: None,
            },
            lists: self.listed(),
        }
    }

    /// The lists of neighbors, where they hold.
    fn listed(&self) -> Option<&Lists> {
        (self.lists.are_made() && self.is_sorted()).then_some(&self.lists)
    }

    /// Particles that sums are made for: those that are awake, and those that sleep right beside them.
    pub fn n_receivers(&self) -> u64 {
        let listed = self.listed().filter(|_| self.may_sleep());
        listed.map_or(self.particles.len() as u64, Lists::n_receivers)
    }

    /// Lists the neighbors of all particles, packed in `points`, if they were not since the last sort.
    fn list(&mut self, points: &AnyPoints) {
        if self.lists.are_made() || !self.is_sorted() {
            return;
        }
        // both of a pair may have moved since the sort, and will not move as far again
        let skin = self.skin() - 2.0 * self.moved();
        self.list_within(self.settings.support_radius() + skin, points);
    }

    /// Lists for all particles the points within a radius (m), up to support and skin.
    pub(crate) fn list_within(&mut self, radius: f64, points: &AnyPoints) {
        let mut lists = std::mem::take(&mut self.lists);
        let listing = Listing {
            from: Surroundings {
                grid: &self.grid,
                frame: &self.frame,
                mirrors: self.settings.mirrors(),
                positions: &self.particles.position,
                rests: self.rests(),
                radius,
                reach: self.settings.support_radius() + self.skin(),
            },
            points,
            lists: &mut lists,
        };
        dispatch(self.settings.scheme.precision, listing);
        self.lists = lists;
    }

    /// Sums over walls for some of the particles.
    fn to_some<'a>(&'a self, walls: Neighborhood<'a>, chosen: &'a [u32]) -> Setup<'a> {
        Setup {
            settings: &self.settings,
            from: walls,
            receivers: some(&self.particles.position, chosen),
            lists: None,
        }
    }

    /// Sums over the fluid for some of many wall points.
    fn to_places<'a>(&'a self, places: Places<'a>, chosen: &'a [u32]) -> Setup<'a> {
        let between = Between::WallsAndParticles(places.facets);
        Setup {
            settings: &self.settings,
            from: self.neighborhood(&self.scratch.points, between),
            receivers: some(places.positions, chosen),
            lists: None,
        }
    }

    /// Packs velocity, density minus the reference density, and volume.
    fn pack_flow(&mut self, points: &mut AnyPoints) {
        let p = &self.particles;
        let reference = self.settings.reference_density;
        let still = Still::kept(self.sleep.as_deref(), |kept| kept.flow);
        points.pack_moving(
            self.settings.scheme.precision,
            &self.frame,
            (&p.position, still),
            |a| {
                let (v, rho) = (p.velocity[a], p.density[a]);
                [v.x, v.y, v.z, rho - reference, p.mass[a] / rho]
            },
        );
        if let Some(sleep) = &mut self.sleep {
            sleep.kept.flow = true;
        }
    }

    /// Storage of the packed flow: that of the force sums, or a separate one if the former must be kept.
    fn flow_points(&mut self) -> &mut AnyPoints {
        match self.sleep {
            None => &mut self.scratch.points,
            Some(_) => &mut self.scratch.flow,
        }
    }

    /// Packs velocity, pressure and volume, for [`forces`] and walls.
    pub(crate) fn pack_forces(&mut self) {
        let p = &self.particles;
        let still = Still::kept(self.sleep.as_deref(), |kept| kept.forces);
        self.scratch.points.pack_moving(
            self.settings.scheme.precision,
            &self.frame,
            (&p.position, still),
            |a| {
                let v = p.velocity[a];
                [v.x, v.y, v.z, p.pressure[a], p.mass[a] / p.density[a]]
            },
        );
        if let Some(sleep) = &mut self.sleep {
            sleep.kept.forces = true;
        }
    }
}

struct Listing<'a> {
    from: Surroundings<'a>,
    points: &'a AnyPoints,
    lists: &'a mut Lists,
}

impl Sum for Listing<'_> {
    fn run<L>(self, machine: L::Machine)
    where
        L: Lanes,
        L::Machine: Machine,
        L::Record: Default + PackedIn,
    {
        let points = L::Record::of(self.points);
        self.lists.make::<L>(machine, self.from, points);
    }
}

struct Summations<'a> {
    setup: Setup<'a>,
    out: &'a mut [f64],
    n_found: &'a mut u64,
}
sum_over_kernels!(Summations);

impl Summations<'_> {
    fn with<L, K>(self, machine: L::Machine)
    where
        L: Lanes,
        L::Machine: Machine,
        L::Record: Default + PackedIn,
        K: PairKernel<L>,
    {
        let term = Summation::new(machine, self.setup.kernel::<L, K>(machine));
        *self.n_found = Within::sum::<L, _>(&self.setup, machine, &term, self.out);
    }
}

/// Density by summation, times a factor; returns the number of ordered pairs.
pub(crate) fn summation(fluid: &mut Fluid, factor: f64) -> u64 {
    let mut points = std::mem::take(&mut fluid.scratch.points);
    let mut density = std::mem::take(&mut fluid.particles.density);
    let mut n_found = 0;
    let mass = &fluid.particles.mass;
    points.pack(
        fluid.settings.scheme.precision,
        &fluid.frame,
        &fluid.particles.position,
        |a| [0.0, 0.0, 0.0, 0.0, mass[a] * factor],
    );
    fluid.list(&points);
    dispatch(
        fluid.settings.scheme.precision,
        Summations {
            setup: fluid.to_everyone(&points),
            out: &mut density,
            n_found: &mut n_found,
        },
    );
    fluid.particles.density = density;
    fluid.scratch.points = points;
    n_found - fluid.particles.len() as u64
}

struct Rates<'a> {
    setup: Setup<'a>,
    own: RateOwn<'a>,
    /// Gradients of density, packed, for Antuono's diffusion.
    gradients: &'a AnyPoints,
    out: &'a mut [Rate],
    n_found: &'a mut u64,
}
sum_over_kernels!(Rates);

impl Rates<'_> {
    fn with<L, K>(self, machine: L::Machine)
    where
        L: Lanes,
        L::Machine: Machine,
        L::Record: Default + PackedIn,
        K: PairKernel<L>,
    {
        let s = self.setup.settings;
        let h = s.smoothing_length;
        let jump = |gravity: Vec3, delta: f64| {
            let hydrostatic = gravity * (-s.reference_density / (s.sound_speed * s.sound_speed));
            JumpDiffusion::new(machine, hydrostatic, h, delta * h * s.sound_speed)
        };
        let diffusion = match s.scheme.diffusion {
            DensityDiffusion::None => AnyDiffusion::None(NoDiffusion(L::splat(machine, 0.0))),
            DensityDiffusion::MolteniColagrossi(delta) => {
                AnyDiffusion::Jump(jump(Vec3::zeros(), delta))
            }
            DensityDiffusion::Fourtakas(delta) => AnyDiffusion::Jump(jump(s.gravity, delta)),
            DensityDiffusion::Antuono(delta) => {
                let gradients = L::Record::of(self.gradients).records();
                let strength = delta * h * s.sound_speed;
                AnyDiffusion::Gradient(GradientDiffusion::new(machine, h, strength, gradients))
            }
        };
        match diffusion {
            AnyDiffusion::Jump(jump) if K::IS_SPECIALIZED => {
                self.diffused::<L, K, _>(machine, jump);
            }
            any => self.diffused::<L, K, _>(machine, any),
        }
    }

    fn diffused<L, K, D>(self, machine: L::Machine, diffusion: D)
    where
        L: Lanes,
        L::Machine: Machine,
        L::Record: Default + PackedIn,
        K: PairKernel<L>,
        D: Diffusion<L>,
    {
        let term = Continuity::new(
            machine,
            self.setup.kernel::<L, K>(machine),
            diffusion,
            self.own,
            self.setup.settings.reference_density,
        );
        *self.n_found = Within::sum::<L, _>(&self.setup, machine, &term, self.out);
    }
}

/// Rates of density in the fluid; returns the number of ordered pairs.
pub(crate) fn rates(fluid: &mut Fluid) -> u64 {
    let mut points = std::mem::take(fluid.flow_points());
    let mut out = std::mem::take(&mut fluid.scratch.rates);
    fluid.pack_flow(&mut points);
    out.resize(fluid.particles.len(), Rate::default());
    fluid.list(&points);
    let mut n_found = 0;
    dispatch(
        fluid.settings.scheme.precision,
        Rates {
            setup: fluid.to_everyone(&points),
            own: RateOwn {
                velocity: &fluid.particles.velocity,
                density: &fluid.particles.density,
            },
            gradients: &fluid.scratch.extra,
            out: &mut out,
            n_found: &mut n_found,
        },
    );
    *fluid.flow_points() = points;
    fluid.scratch.rates = out;
    n_found - fluid.n_receivers()
}

struct Gradients<'a> {
    setup: Setup<'a>,
    density: &'a [f64],
    out: &'a mut [[f64; 3]],
}
sum_over_kernels!(Gradients);

impl Gradients<'_> {
    fn with<L, K>(self, machine: L::Machine)
    where
        L: Lanes,
        L::Machine: Machine,
        L::Record: Default + PackedIn,
        K: PairKernel<L>,
    {
        let settings = self.setup.settings;
        let term = Gradient::new(
            machine,
            self.setup.kernel::<L, K>(machine),
            self.density,
            settings.reference_density,
            settings.dimensions,
        );
        Within::sum::<L, _>(&self.setup, machine, &term, self.out);
    }
}

/// Renormalised gradients of density, packed for the sums, into the scratch.
pub(crate) fn density_gradients(fluid: &mut Fluid) {
    let mut points = std::mem::take(fluid.flow_points());
    let mut out = std::mem::take(&mut fluid.scratch.gradients);
    let mut packed = std::mem::take(&mut fluid.scratch.extra);
    fluid.pack_flow(&mut points);
    out.resize(fluid.particles.len(), [0.0; 3]);
    fluid.list(&points);
    dispatch(
        fluid.settings.scheme.precision,
        Gradients {
            setup: fluid.to_everyone(&points),
            density: &fluid.particles.density,
            out: &mut out,
        },
    );
    packed.pack_values(fluid.settings.scheme.precision, out.len(), |a| {
        let [x, y, z] = out[a];
        [x, y, z, 0.0, 0.0, 0.0, 0.0, 0.0]
    });
    *fluid.flow_points() = points;
    fluid.scratch.gradients = out;
    fluid.scratch.extra = packed;
}

struct Strains<'a, W> {
    setup: Setup<'a>,
    way: PhantomData<W>,
    velocity: &'a [Vec3],
    out: &'a mut [StrainSums],
}
sum_over_kernels!(Strains, W);

impl<W: Way> Strains<'_, W> {
    fn with<L, K>(self, machine: L::Machine)
    where
        L: Lanes,
        L::Machine: Machine,
        L::Record: Default + PackedIn,
        K: PairKernel<L>,
    {
        let kernel = self.setup.kernel::<L, K>(machine);
        let dimensions = self.setup.settings.dimensions;
        let term = Strain::new(machine, kernel, self.velocity, dimensions);
        W::sum::<L, _>(&self.setup, machine, &term, self.out);
    }
}

/// Sums of the gradient of velocity in the fluid into the scratch; after [`Fluid::pack_forces`].
pub(crate) fn strains(fluid: &mut Fluid) {
    let points = std::mem::take(&mut fluid.scratch.points);
    let mut out = std::mem::take(&mut fluid.scratch.strains);
    out.resize(fluid.particles.len(), StrainSums::default());
    fluid.list(&points);
    dispatch(
        fluid.settings.scheme.precision,
        Strains {
            setup: fluid.to_everyone(&points),
            way: PhantomData::<Within>,
            velocity: &fluid.particles.velocity,
            out: &mut out,
        },
    );
    fluid.scratch.points = points;
    fluid.scratch.strains = out;
}

/// Strain rates of some particles due to wall points, which hold velocity and volume.
pub(crate) fn wall_strains(
    fluid: &Fluid,
    walls: Neighborhood,
    chosen: &[u32],
    out: &mut [StrainSums],
) {
    dispatch(
        fluid.settings.scheme.precision,
        Strains {
            setup: fluid.to_some(walls, chosen),
            way: PhantomData::<Across>,
            velocity: &fluid.particles.velocity,
            out,
        },
    );
}

struct Spreads<'a, W> {
    setup: Setup<'a>,
    way: PhantomData<W>,
    out: &'a mut [Spread],
}
sum_over_kernels!(Spreads, W);

impl<W: Way> Spreads<'_, W> {
    fn with<L, K>(self, machine: L::Machine)
    where
        L: Lanes,
        L::Machine: Machine,
        L::Record: Default + PackedIn,
        K: PairKernel<L>,
    {
        let term = Disorder::new(machine, self.setup.kernel::<L, K>(machine));
        W::sum::<L, _>(&self.setup, machine, &term, self.out);
    }
}

/// Spread of the fluid's particles into the scratch.
pub(crate) fn spreads(fluid: &mut Fluid) {
    let mut points = std::mem::take(fluid.flow_points());
    let mut out = std::mem::take(&mut fluid.scratch.spreads);
    fluid.pack_flow(&mut points);
    out.resize(fluid.particles.len(), Spread::default());
    fluid.list(&points);
    dispatch(
        fluid.settings.scheme.precision,
        Spreads {
            setup: fluid.to_everyone(&points),
            way: PhantomData::<Within>,
            out: &mut out,
        },
    );
    *fluid.flow_points() = points;
    fluid.scratch.spreads = out;
}

/// Receivers and sources of a force sum.
#[derive(Clone, Copy)]
enum Forcing {
    FluidAndFluid,
    WallOnFluid,
    FluidOnWall,
}

struct Forces<'a> {
    setup: Setup<'a>,
    own: ForceOwn<'a>,
    forcing: Forcing,
    shear: Shearing<'a>,
    out: &'a mut [ForceDensity],
}
sum_over_kernels!(Forces);

/// Viscosity model of a force sum.
#[derive(Clone, Copy)]
pub(crate) enum Shearing<'a> {
    /// A common value.
    Uniform(Viscosity),
    /// Viscosities of the fluid's particles.
    OfParticles(&'a AnyPoints),
}

impl<'a> Shearing<'a> {
    /// That within a fluid.
    pub(crate) fn within(fluid: &'a Fluid) -> Self {
        if fluid.varies_viscosity() {
            Self::OfParticles(&fluid.scratch.viscosities)
        } else {
            Self::Uniform(fluid.settings.scheme.viscosity)
        }
    }
}

impl Forces<'_> {
    fn with<L, K>(self, machine: L::Machine)
    where
        L: Lanes,
        L::Machine: Machine,
        L::Record: Default + PackedIn,
        K: PairKernel<L>,
    {
        let s = self.setup.settings;
        let wall = || WeightedByDensity::new(machine, s.reference_density, s.sound_speed);
        let viscosities = match self.shear {
            Shearing::Uniform(viscosity) => {
                return match self.forcing {
                    Forcing::FluidAndFluid => {
                        self.pressed::<L, K, _, Within>(machine, SumOfPressures, viscosity);
                    }
                    Forcing::WallOnFluid | Forcing::FluidOnWall => {
                        self.pressed::<L, K, _, Across>(machine, wall(), viscosity);
                    }
                };
            }
            Shearing::OfParticles(viscosities) => L::Record::of(viscosities).records(),
        };
        let h = s.smoothing_length;
        match self.forcing {
            Forcing::FluidAndFluid => {
                let shear = VariableShear::<L, true, true>::new(machine, viscosities, h);
                self.sheared::<L, K, _, _, Within>(machine, SumOfPressures, shear);
            }
            Forcing::WallOnFluid => {
                let shear = VariableShear::<L, true, false>::new(machine, viscosities, h);
                self.sheared::<L, K, _, _, Across>(machine, wall(), shear);
            }
            Forcing::FluidOnWall => {
                let shear = VariableShear::<L, false, true>::new(machine, viscosities, h);
                self.sheared::<L, K, _, _, Across>(machine, wall(), shear);
            }
        }
    }

    fn pressed<L, K, P, W>(self, machine: L::Machine, pressure: P, viscosity: Viscosity)
    where
        L: Lanes,
        L::Machine: Machine,
        L::Record: Default + PackedIn,
        K: PairKernel<L>,
        P: PairPressure<L>,
        W: Way,
    {
        let s = self.setup.settings;
        let h = s.smoothing_length;
        let rho = s.reference_density;
        let laminar_factor = 2.0 * (s.dimensions.count() + 2.0);
        let any = match viscosity {
            Viscosity::None
            // these are of particles, see `Shearing`
            | Viscosity::Rheological { .. }
            | Viscosity::SubParticleScale { .. } => AnyViscosity::Inviscid,
            Viscosity::Published { dynamic_viscosity } => {
                let kernel = Viscous::new(s.support_radius(), s.dimensions);
                AnyViscosity::Published(Published::new(machine, dynamic_viscosity, &kernel))
            }
            Viscosity::Artificial { alpha } => {
                let factor = rho * alpha * s.sound_speed * h;
                AnyViscosity::Artificial(Central::new(machine, factor, h))
            }
            Viscosity::Laminar {
                kinematic_viscosity,
            } => {
                let factor = laminar_factor * rho * kinematic_viscosity;
                AnyViscosity::Laminar(Central::new(machine, factor, h))
            }
            Viscosity::Morris {
                kinematic_viscosity,
            } => AnyViscosity::Shear(Shear::new(machine, 2.0 * rho * kinematic_viscosity, h)),
        };
        match any {
            AnyViscosity::Artificial(term) if K::IS_SPECIALIZED => {
                self.sheared::<L, K, _, _, W>(machine, pressure, term);
            }
            AnyViscosity::Laminar(term) if K::IS_SPECIALIZED => {
                self.sheared::<L, K, _, _, W>(machine, pressure, term);
            }
            any => self.sheared::<L, K, _, _, W>(machine, pressure, any),
        }
    }

    fn sheared<L, K, P, V, W>(self, machine: L::Machine, pressure: P, viscosity: V)
    where
        L: Lanes,
        L::Machine: Machine,
        L::Record: Default + PackedIn,
        K: PairKernel<L>,
        P: PairPressure<L>,
        V: PairViscosity<L>,
        W: Way,
    {
        let kernel = self.setup.kernel::<L, K>(machine);
        let term = Momentum::new(machine, kernel, pressure, viscosity, self.own);
        W::sum::<L, _>(&self.setup, machine, &term, self.out);
    }
}

/// Forces of pressure and viscosity in the fluid, per volume, into the scratch; after
/// [`Fluid::pack_forces`].
pub(crate) fn forces(fluid: &mut Fluid) {
    let points = std::mem::take(&mut fluid.scratch.points);
    let mut out = std::mem::take(&mut fluid.scratch.forces);
    out.resize(fluid.particles.len(), ForceDensity::default());
    fluid.list(&points);
    dispatch(
        fluid.settings.scheme.precision,
        Forces {
            setup: fluid.to_everyone(&points),
            own: ForceOwn {
                velocity: &fluid.particles.velocity,
                pressure: &fluid.particles.pressure,
            },
            forcing: Forcing::FluidAndFluid,
            shear: Shearing::within(fluid),
            out: &mut out,
        },
    );
    fluid.scratch.points = points;
    fluid.scratch.forces = out;
}

/// Some of many receivers.
fn some<'a>(positions: &'a [Vec3], chosen: &'a [u32]) -> Receivers<'a> {
    Receivers {
        positions,
        chosen: Some(chosen),
    }
}

struct WallRates<'a> {
    setup: Setup<'a>,
    own: RateOwn<'a>,
    out: &'a mut [Rate],
}
sum_over_kernels!(WallRates);

impl WallRates<'_> {
    fn with<L, K>(self, machine: L::Machine)
    where
        L: Lanes,
        L::Machine: Machine,
        L::Record: Default + PackedIn,
        K: PairKernel<L>,
    {
        let term = Continuity::new(
            machine,
            self.setup.kernel::<L, K>(machine),
            NoDiffusion(L::splat(machine, 0.0)),
            self.own,
            self.setup.settings.reference_density,
        );
        Across::sum::<L, _>(&self.setup, machine, &term, self.out);
    }
}

/// Rates of density of some particles from wall points, which hold velocity and volume.
pub(crate) fn wall_rates(fluid: &Fluid, walls: Neighborhood, chosen: &[u32], out: &mut [Rate]) {
    dispatch(
        fluid.settings.scheme.precision,
        WallRates {
            setup: fluid.to_some(walls, chosen),
            own: RateOwn {
                velocity: &fluid.particles.velocity,
                density: &fluid.particles.density,
            },
            out,
        },
    );
}

/// Spread of some particles as far as wall points make it.
pub(crate) fn wall_spreads(fluid: &Fluid, walls: Neighborhood, chosen: &[u32], out: &mut [Spread]) {
    dispatch(
        fluid.settings.scheme.precision,
        Spreads {
            setup: fluid.to_some(walls, chosen),
            way: PhantomData::<Across>,
            out,
        },
    );
}

/// Forces per volume of wall points, which hold velocity, pressure and volume, on some particles.
pub(crate) fn wall_forces(
    fluid: &Fluid,
    walls: Neighborhood,
    chosen: &[u32],
    shear: Shearing,
    out: &mut [ForceDensity],
) {
    dispatch(
        fluid.settings.scheme.precision,
        Forces {
            setup: fluid.to_some(walls, chosen),
            own: ForceOwn {
                velocity: &fluid.particles.velocity,
                pressure: &fluid.particles.pressure,
            },
            forcing: Forcing::WallOnFluid,
            shear,
            out,
        },
    );
}

/// Forces per volume of the fluid on some wall points, with given velocities and
/// pressures; after [`Fluid::pack_forces`].
pub(crate) fn reactions(
    fluid: &Fluid,
    places: Places,
    (velocity, pressure): (&[Vec3], &[f64]),
    chosen: &[u32],
    shear: Shearing,
    out: &mut [ForceDensity],
) {
    dispatch(
        fluid.settings.scheme.precision,
        Forces {
            setup: fluid.to_places(places, chosen),
            own: ForceOwn { velocity, pressure },
            forcing: Forcing::FluidOnWall,
            shear,
            out,
        },
    );
}

struct Extrapolations<'a> {
    setup: Setup<'a>,
    with_slopes: bool,
    out: &'a mut [Extrapolated],
}
sum_over_kernels!(Extrapolations);

impl Extrapolations<'_> {
    fn with<L, K>(self, machine: L::Machine)
    where
        L: Lanes,
        L::Machine: Machine,
        L::Record: Default + PackedIn,
        K: PairKernel<L>,
    {
        let s = self.setup.settings;
        let kernel = self.setup.kernel::<L, K>(machine);
        let (rho, c) = (s.reference_density, s.sound_speed);
        if self.with_slopes {
            let term = Extrapolation::<L, K, true>::new(machine, kernel, rho, c);
            Across::sum::<L, _>(&self.setup, machine, &term, self.out);
        } else {
            let term = Extrapolation::<L, K, false>::new(machine, kernel, rho, c);
            Across::sum::<L, _>(&self.setup, machine, &term, self.out);
        }
    }
}

/// Pressure and velocity of the fluid extrapolated to some points, with or without the response slopes; after
/// [`Fluid::pack_forces`].
pub(crate) fn extrapolation(
    fluid: &Fluid,
    places: Places,
    chosen: &[u32],
    with_slopes: bool,
    out: &mut [Extrapolated],
) {
    dispatch(
        fluid.settings.scheme.precision,
        Extrapolations {
            setup: fluid.to_places(places, chosen),
            with_slopes,
            out,
        },
    );
}
