//! The list of codes, in the order of the guide.

/// Writes the list of codes once: as an enum, as text, and as a list of all.
macro_rules! codes {
    ($($(#[$doc:meta])* $name:ident = $text:literal,)+) => {
        /// Code of an error or a warning: its cause, whatever the words of the message.
        ///
        /// Codes are stable: scripts may rely on them. A new cause is a new code.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Code {
            $($(#[$doc])* $name,)+
        }

        impl Code {
            /// All codes, in the order of the guide.
            pub const ALL: &[Self] = &[$(Self::$name),+];

            /// The code as it is printed, and as `riprap explain` takes it.
            pub const fn as_str(self) -> &'static str {
                match self {
                    $(Self::$name => $text,)+
                }
            }
        }
    };
}

codes! {
    // files and syntax
    /// Text that does not follow the notation of scenes.
    SceneSyntax = "scene-syntax",
    /// A field that does not exist.
    UnknownField = "unknown-field",
    /// A kind that a field does not have.
    UnknownKind = "unknown-kind",
    /// A field without default that was left out.
    MissingField = "missing-field",
    /// A field or an entry of a list that is written twice.
    WrittenTwice = "written-twice",
    /// A list without the entry that it needs.
    EmptyList = "empty-list",
    /// A setting of the command line that leads to no field.
    UnusableOverride = "unusable-override",
    /// A name that nothing has.
    UnknownName = "unknown-name",
    /// A name that is taken, empty, or does not fit a table.
    UnusableName = "unusable-name",
    /// A number that is infinite or NaN.
    NumberNotFinite = "number-not-finite",
    /// A number beyond its limits.
    ValueOutOfRange = "value-out-of-range",
    /// Numbers that must increase and do not: corners, times, the smallest and the largest.
    ValuesOutOfOrder = "values-out-of-order",
    /// A direction of no length, or one that is not horizontal.
    UnusableDirection = "unusable-direction",
    /// A number that looks as if it were in another unit.
    SuspiciousUnits = "suspicious-units",
    /// A quantity in a unit that its field does not take.
    WrongUnit = "wrong-unit",
    /// Gravity that does not act downward or is not the Earth's.
    UnexpectedGravity = "unexpected-gravity",
    /// Grains and water that do not go together as they are.
    GrainsInWater = "grains-in-water",
    /// Options that exclude each other.
    IncompatibleOptions = "incompatible-options",
    /// An option that changes nothing here.
    OptionWithoutEffect = "option-without-effect",
    /// A file that cannot be read.
    FileNotReadable = "file-not-readable",
    /// A file out of the folder of the scene.
    FileOutsideFolder = "file-outside-folder",
    /// A file that does not follow its format.
    UnusableFile = "unusable-file",
    /// A file too large to be used.
    FileTooLarge = "file-too-large",

    // geometry
    /// Something out of the domain.
    OutsideDomain = "outside-domain",
    /// A shape that is no solid.
    InvalidShape = "invalid-shape",
    /// A mesh with holes, turned triangles or cavities.
    MeshNotClosed = "mesh-not-closed",
    /// A mesh that convex parts do not resemble.
    MeshNotConvex = "mesh-not-convex",
    /// Shells of a mesh that overlap.
    OverlappingShells = "overlapping-shells",
    /// A direction that cannot be periodic.
    UnusablePeriod = "unusable-period",
    /// A side that cannot be a plane of symmetry.
    UnusableSymmetryPlane = "unusable-symmetry-plane",
    /// A terrain without its one block, or a block of it without terrain.
    TerrainBlock = "terrain-block",
    /// A spacing that the sources of the terrain do not allow.
    UnusableTerrainSpacing = "unusable-terrain-spacing",
    /// A place of the terrain without a height.
    TerrainGap = "terrain-gap",
    /// Heights that are hardly those of the ground.
    SuspiciousTerrain = "suspicious-terrain",
    /// A coordinate reference system that cannot be used, or that another file does not have.
    UnusableMapSystem = "unusable-map-system",
    /// An outline that cannot be cut out of the terrain.
    UnusableOutline = "unusable-outline",
    /// A failure surface that is not below the terrain, or dips into the hill.
    FailureSurfaceMisplaced = "failure-surface-misplaced",
    /// More blocks than allowed.
    TooManyBlocks = "too-many-blocks",
    /// A rock mass that no joint crosses.
    NoJointCrosses = "no-joint-crosses",
    /// A rock mass whose blocks are all smaller than the smallest.
    NoBlockLeft = "no-block-left",
    /// Grains that do not fit their region.
    GrainsDoNotFit = "grains-do-not-fit",

    // water
    /// Something that needs water in a scene without.
    NeedsWater = "needs-water",
    /// A basin that does not hold its water.
    LeakingBasin = "leaking-basin",
    /// A seed of a basin that is not in its water.
    SeedMisplaced = "seed-misplaced",
    /// A region that overlaps a block or another region.
    OverlappingRegion = "overlapping-region",
    /// A region in which no particle fits.
    NoParticleFits = "no-particle-fits",
    /// A spacing or number of particles that does not fit the regions.
    SpacingMisfit = "spacing-misfit",
    /// A gap that is narrower than two spacings.
    GapNarrowerThanSpacing = "gap-narrower-than-spacing",
    /// More particles or blocks than the machine or the program holds.
    NotEnoughMemory = "not-enough-memory",
    /// A speed of sound that is low for the speeds expected.
    LowSoundSpeed = "low-sound-speed",
    /// Water so fast that its sound is felt.
    WaterNearSoundSpeed = "water-near-sound-speed",
    /// A viscosity that limits the step far more than sound does.
    ViscosityLimitsStep = "viscosity-limits-step",
    /// A stepping that makes sound grow.
    GrowingSound = "growing-sound",
    /// Water that cannot sleep.
    WaterCannotSleep = "water-cannot-sleep",
    /// Water that does not begin at the plane of symmetry.
    WaterOffSymmetryPlane = "water-off-symmetry-plane",
    /// An inflow or outflow that is too short or in the wrong place.
    UnusableOpening = "unusable-opening",
    /// An absorbing layer that is shorter than the waves.
    AbsorberTooShort = "absorber-too-short",
    /// A wave maker without water before it.
    PaddleWithoutWater = "paddle-without-water",
    /// A wave maker that leaves the domain.
    StrokeLeavesDomain = "stroke-leaves-domain",
    /// Waves that break where they are made.
    BreakingWaves = "breaking-waves",
    /// Waves too long for second-order theory.
    SecondCrest = "second-crest",
    /// A focus before its waves can arrive.
    FocusTooEarly = "focus-too-early",
    /// A gauge of the water on dry land or inside a block.
    DryGauge = "dry-gauge",

    // blocks
    /// Blocks that overlap at the start.
    OverlappingBlocks = "overlapping-blocks",
    /// Contacts so soft that blocks sink into each other.
    SoftContacts = "soft-contacts",
    /// A strength that the weight of the blocks makes nothing of.
    StrengthWithoutEffect = "strength-without-effect",
    /// Something that only a free block can have.
    NeedsFreeBlock = "needs-free-block",
    /// A block that cannot be deformable.
    UnusableDeformable = "unusable-deformable",
    /// A rock bolt or another attachment that cannot be used.
    UnusableAttachment = "unusable-attachment",
    /// A path that a block cannot follow.
    UnusablePath = "unusable-path",
    /// A bend that is tighter than the block, or cut off by an arc.
    TightBend = "tight-bend",
    /// Blocks that are damped for a search for rest.
    DampedForRest = "damped-for-rest",
    /// Blocks that still move when their time to settle is over.
    StillMoving = "still-moving",
    /// A block that meets its mirror image.
    BlockAtSymmetryPlane = "block-at-symmetry-plane",

    // walls
    /// Walls of a kind that does not work with the scheme or with a shape.
    UnusableWalls = "unusable-walls",

    // time step and stability
    /// A particle whose position, velocity or density is not finite.
    ParticleNan = "particle-nan",
    /// A particle far denser than water.
    WaterCompressed = "water-compressed",
    /// A particle faster than sound.
    FasterThanSound = "faster-than-sound",
    /// An implicit viscous step that does not converge.
    ViscousStepUnsolved = "viscous-step-unsolved",
    /// A block whose position or velocity is not finite.
    BlockNan = "block-nan",
    /// Blocks that penetrate each other deeper than a step allows.
    PenetrationTooDeep = "penetration-too-deep",
    /// Contacts that contact dynamics did not solve.
    ContactsUnsolved = "contacts-unsolved",
    /// Friction with which more than one impulse obeys the laws of contact.
    FrictionAbovePainleve = "friction-above-painleve",
    /// A deformable block strained beyond its stress law.
    BlockCrushed = "block-crushed",
    /// A step too small to get anywhere.
    TimeStepCollapsed = "time-step-collapsed",
    /// Energy that rose without a source.
    EnergyFromNowhere = "energy-from-nowhere",
    /// A step that failed and was repeated with half its length.
    StepRepeated = "step-repeated",
    /// Water or blocks that left the domain.
    LeftDomain = "left-domain",

    // running
    /// An argument of the command line that cannot be used.
    UnusableArgument = "unusable-argument",
    /// A file or run folder that would be overwritten.
    WouldOverwrite = "would-overwrite",
    /// A checkpoint that cannot be read by this program.
    CheckpointUnusable = "checkpoint-unusable",
    /// A checkpoint of another scene.
    CheckpointMismatch = "checkpoint-mismatch",
    /// A run folder without a checkpoint to continue from.
    NoCheckpoint = "no-checkpoint",
    /// Signals that the system does not let the program catch.
    SignalsNotCaught = "signals-not-caught",

    // records and output
    /// A file that cannot be written.
    CannotWrite = "cannot-write",
    /// A disk without space.
    DiskFull = "disk-full",
    /// A file of a run that cannot be read.
    UnusableRunFolder = "unusable-run-folder",
    /// An account of energy that does not close.
    EnergyAccount = "energy-account",
    /// A wave lower than three spacings.
    WaveUnresolved = "wave-unresolved",
    /// Particles crushed between solids, or put back in front of walls too often.
    ParticlesCrushed = "particles-crushed",
    /// Tables or surfaces with nothing to compare.
    NothingToCompare = "nothing-to-compare",
    /// A run without anything to draw.
    NothingToDraw = "nothing-to-draw",
    /// A program that riprap calls and that failed.
    ProgramFailed = "program-failed",
    /// An error budget for which there is no estimate.
    NoErrorEstimate = "no-error-estimate",
    /// A study that cannot be run as it is written.
    UnusableStudy = "unusable-study",
}
