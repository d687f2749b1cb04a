//! An example of each type of scenes, as the reference shows it; each is read as its type and validated against the schema.

use riprap::scene::file;
use riprap::scene::locate::Syntax;
use riprap::scene::{parse, schema};
use serde_json::Value;

use crate::schema::validator::{faults, faults_of};

/// Reads an example as its type; JSON of it.
type Check = fn(&str) -> Result<Value, String>;

/// Type, example, and reader of the type.
pub type Example = (&'static str, &'static str, Check);

macro_rules! examples {
    ($($name:ident: $text:literal;)+) => {
        pub const EXAMPLES: &[Example] = &[$((
            stringify!($name),
            $text,
            |text| {
                let value: file::$name = parse::read_as(text).map_err(|error| error.message)?;
                serde_json::to_value(value).map_err(|error| error.to_string())
            },
        )),+];
    };
}

examples! {
    SceneFile: r#"(
    title: "box on a plane of 30 degrees",
    domain: (min: (-10, -5, -10), max: (10, 5, 10)),
    materials: [(name: "rock", density: 2600, friction_angle_deg: 20)],
    blocks: [
        (name: "plane", material: "rock", motion: Fixed,
         shape: Box(min: (-9, -2, -1), max: (9, 2, 0)),
         placement: (rotate: (axis: (0, 1, 0), angle_deg: 30))),
        (name: "box", material: "rock",
         shape: Box(min: (-0.5, -0.5, 0), max: (0.5, 0.5, 0.3)),
         placement: (rotate: (axis: (0, 1, 0), angle_deg: 30))),
    ],
    time: (duration: 1.0),
)"#;
    DomainFile: "// a flume in a vertical plane\n(min: (0, 0, 0), max: (12, 0.1, 1), dimensions: Two)";
    Axis: "Y";
    SideFile: "XMax";
    OutOfDomainFile: "Fail";
    DimensionsFile: "Two";
    TimeFile: "(duration: 8, settle: 1)";
    RestFile: "(speed: 1e-3, time: 0.5)";
    SettlingFile: r#"// grains behind a gate
(speed: 1e-3, at_most: 5, gates: ["gate"])"#;
    MaterialFile: r#"(name: "granite", density: 2650, friction_angle_deg: 35, cohesion: 2e5, restitution: 0.4,
 elastic: (young_modulus: 5e10, poisson_ratio: 0.25))"#;
    ElasticFile: "(young_modulus: 5e10, poisson_ratio: 0.25)";
    JointFile: r#"// weakens to 60 % of its friction within ten seconds
(between: ("granite", "shale"), friction_angle_deg: 24, friction_ramp: [(0, 1), (10, 0.6)])"#;
    BlockFile: r#"(name: "wedge", material: "rock", shape: Wedge(length: 2, height: 1, width: 1),
 placement: (translate: (0.5, 0, 0.2)), velocity: (1, 0, 0))"#;
    JointFacesFile: r#"(set: "bedding", faces: [0, 3])"#;
    PlacementFile: "(rotate: (axis: (0, 1, 0), angle_deg: 30), translate: (0, 0, 2))";
    RotationFile: "(axis: (0, 0, 1), angle_deg: 45, about: (1, 1, 0))";
    MotionFile: "// a piston\nSinusoid(direction: (1, 0, 0), amplitude: 0.05, period: 2, ramp: 4)";
    DeformableFile: "(model: Corotational, initial_stress: (0, 0, -1e5, 0, 0, 0))";
    DeformableModelFile: "Affine";
    HoldFile: "// slides in the x-z plane without turning\n(directions: [Y], turning: Held)";
    TurningFile: "About(Y)";
    AttachmentFile: r#"RockBolt(from: "wedge", from_point: (0, 0, 2), to: "slope", to_point: (0, 0, -1),
         stiffness: 2e7, pretension: 5e4, yield_force: 2e5)"#;
    RockMassFile: r#"(name: "cliff", material: "rock", boundary: Box(min: (0, 0, 0), max: (20, 10, 15)),
 joint_sets: [(dip_deg: 60, dip_direction_deg: 90, spacing: 2),
              (dip_deg: 80, dip_direction_deg: 0, spacing: 3, scatter_deg: 5)],
 merge_slivers: (volume_share: 0.02))"#;
    SliversFile: "(volume_share: 0.05, aspect: 12)";
    JointSetFile: "(dip_deg: 60, dip_direction_deg: 90, spacing: 2, persistence: 0.8, spacing_scatter: 0.2)";
    GrainsFile: r#"(name: "gravel", material: "rock", region: Cylinder(base: (0, 0, 0), radius: 1, height: 2),
 diameter: (0.08, 0.12), mixed_with: [(diameter: (0.02, 0.03), volume_share: 0.3)], seed: 3)"#;
    GrainSizeFile: "(diameter: (0.02, 0.03), volume_share: 0.3)";
    GrainRegionFile: "Box(min: (0, 0, 0), max: (1, 1, 2))";
    InWaterFile: "Averaged";
    GrainExchangeFile: "(drag: Gidaspow, kernel_radius: 3)";
    DragLawFile: "DiFelice";
    AddedMassFile: "On";
    FluidFile: r#"(resolution: Spacing(0.05), regions: [(name: "sea", shape: Below(level: 0.6, seed: (5, 0, 0.3)))])"#;
    ResolutionFile: "Spacing(0.05)";
    LatticeFile: "Staggered";
    RegionFile: r#"(name: "column", shape: Box(min: (0, 0, 0), max: (1, 1, 2)))"#;
    RegionShapeFile: "Below(level: 0.6, seed: (5, 0, 0.3))";
    FlowFile: "StandingWave(height: 0.01, length: 2, depth: 0.5, crest: 0)";
    RheologyFile: "Bingham(dynamic_viscosity: 2, yield_stress: 60, regularization: Bilinear(200))";
    RegularizationFile: "Papanastasiou(500)";
    GaugeFile: r#"RunUp(name: "shore", from: (340, 100), to: (250, 100))"#;
    GaugeKindFile: "SurfaceElevation";
    ForcesFile: r#"(blocks: ["caisson"], interval: 0.01)"#;
    TrajectoriesFile: "(interval: 0.02)";
    HandoffFile: r#"(times: Auto, formats: [NetCdf, Geoclaw], lines: [(name: "mouth", from: (-400, 600), to: (500, 600))])"#;
    HandoffTimesFile: "At([20, 24, 28])";
    HandoffFormat: "Geoclaw";
    HandoffLineFile: r#"(name: "mouth", from: (-400, 600), to: (500, 600))"#;
    MapsFile: "(spacing: 10, arrival_threshold: 0.1)";
    MassFile: r#"// blocks slide.0001, slide.0002 and so on
(name: "slide", blocks: "slide.")"#;
    CounterFile: r#"// pebbles that have passed the first weir
Plane(name: "weir_1", point: (4, 0, 0), normal: (1, 0, 0), blocks: "pebble_")"#;
    ReactionFile: r#"// thrust of the pebbles on the wall
(name: "thrust", between: ("pebble_*", "wall"), direction: (1, 0, 0))"#;
    BarrierFile: r#"// a slit dam of two piles at the foot of a slope along x
(name: "dam", blocks: ["pile_*"], flow: (1, 0, 0), cell: 0.05, upstream: 1)"#;
    InterfaceFile: "(walls: Particles, slip: None)";
    WallMethodFile: "Particles";
    SlipFile: "Friction(20)";
    ContactSolverFile: "GaussSeidel";
    BlockIntegratorFile: "ContactDynamics(time_step: 0.005, tolerance: 1e-6)";
    NumericsFile: "(preset: Reference, bulk_viscosity: 0.1, sleeping: ())";
    Preset: "Standard";
    KernelFile: "WendlandC2";
    DensityFile: "Continuity";
    StateEquationFile: "Tait";
    DensityDiffusionFile: "Fourtakas(0.1)";
    ViscosityFile: "SubParticleScale(0.12)";
    ViscousStepFile: "Explicit";
    ShiftingFile: "Fickian(2)";
    SteppingFile: "KickDriftKick";
    PrecisionFile: "Double";
    NegativePressure: "Clamped";
    SleepingFile: "(displacement: 0.01)";
    RestingFile: "(displacement: 0.002, load: 0.1)";
    StepBoundFile: "Eigenvalues";
    ContactDetectionFile: "Verified";
    NormalLawFile: "Hertz";
    RollingLawFile: "Relative";
    StaticDampingFile: "Local(0.7)";
    AbsorberFile: r#"// one wave length before the end of the flume
(name: "beach", min: (24, 0, 0), max: (30, 0.1, 1), towards: XMax)"#;
    InflowFile: r#"(name: "river", min: (0, 0, 0), max: (1, 2, 1), towards: XMax,
 velocity: [(0, 0), (2, 0.5)], depth: [(0, 0.2)])"#;
    OutflowFile: r#"(name: "sea", min: (9, 0, 0), max: (10, 2, 1), towards: XMax, depth: [(0, 0.2)])"#;
    OutputFile: "(frame_interval: 0.1, gauge_interval: 0.01, face_pressures: true)";
    WaterFramesFile: "// a quarter of the water near the wall\n(interval: 0.5, stride: 4, box: (min: (8, 0, 0), max: (10, 2, 3)))";
    BlockTableFile: r#"// a heap of thousands of grains
(blocks: ["grain_*"], interval: 0.5, format: Npy)"#;
    TableFormatFile: "Npy";
    FramesFile: "(interval: 0.02)";
    BoxFile: "(min: (8, 0, 0), max: (10, 2, 3))";
    WaterField: "Pressure";
    BlockField: "ForceFluid";
    CameraFile: "(position: (5, -20, 8), look_at: (5, 0, 1), field_of_view_deg: 35)";
    ShapeFile: "Extrusion(polygon: [(0, 0), (4, 0), (4, 1), (1, 2), (0, 2)], axis: Y, from: -1, to: 1)";
    SplitFile: "(most_parts: 64, volume_error: 0.005)";
    PartFile: "// a tetrahedron\n(vertices: [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],\n faces: [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])";
    TerrainFile: r#"(sources: [(file: "survey.tif"), (file: "bathymetry.xyz", height_shift: -1.2)],
 origin: (412000, 6904000, 0), crs: "EPSG:25832")"#;
    HeightsFile: r#"(file: "bathymetry.asc", height_scale: 0.3048, heights: (-500, -0.1))"#;
    GapsFile: "Filled(50)";
    ExcavationFile: r#"(outline: File("quarry.geojson"), failure_surface: Raster(file: "quarry_floor.asc"))"#;
    SlideFile: r#"(name: "slide", material: "rock",
 outline: Corners([(100, 60), (200, 60), (200, 140), (100, 140)]),
 failure_surface: Plane(point: (200, 100, 90), dip_deg: 30, dip_direction_deg: 90),
 joint_sets: [(dip_deg: 90, dip_direction_deg: 270, spacing: 20)])"#;
    OutlineFile: "Corners([(100, 60), (200, 60), (200, 140), (100, 140)])";
    FailureSurfaceFile: "Plane(point: (200, 100, 90), dip_deg: 30, dip_direction_deg: 90)";
    WavesFile: "Irregular(height: 0.12, period: 2, seed: 7)";
    SpectrumFile: "Jonswap(3.3)";
}

#[test]
fn examples_are_of_their_type() {
    let schema = schema::of_scenes();
    let defined = schema["$defs"].as_object().unwrap();
    assert_eq!(EXAMPLES.len(), defined.len() + 1);
    for (name, text, read) in EXAMPLES {
        let value = read(text).unwrap_or_else(|error| panic!("{name}: {error}\n{text}"));
        let found = match *name {
            "SceneFile" => faults(&schema, &value),
            name => faults_of(&schema, name, &value),
        };
        assert!(found.is_empty(), "{name}: {found:#?}");
    }
}

/// The whole scene of the reference runs through every check.
#[test]
fn the_scene_of_the_reference_is_right() {
    let (_, text, _) = EXAMPLES[0];
    let found = crate::languages::answers("scene.ron", text, &[]);
    assert!(found.is_empty(), "{found:?}");
    assert!(parse::read_in(text, Syntax::Ron).is_ok());
}
