"""{title}, handed over at {time} s: a run of GeoClaw on one level, to be extended.

Elevations are over the level of rest. For a larger domain enlarge `lower`, `upper` and `num_cells` and append its topography: where
files overlap GeoClaw takes the finest, so that topo.tt3, which has the ground with the blocks on it, counts if the other is coarser.
"""


def setrun(claw_pkg="geoclaw"):
    from clawpack.clawutil import data

    rundata = data.ClawRunData(claw_pkg, 2)

    claw = rundata.clawdata
    claw.num_dim = 2
    claw.lower[:] = [{west}, {south}]
    claw.upper[:] = [{east}, {north}]
    claw.num_cells[:] = [{nx}, {ny}]
    claw.num_eqn = 3
    claw.num_aux = 1
    claw.capa_index = 0
    claw.t0 = {time}
    claw.output_style = 1
    claw.num_output_times = 10
    claw.tfinal = {time} + 60.0
    claw.output_t0 = True
    claw.output_format = "ascii"
    claw.dt_variable = True
    claw.dt_initial = {step}
    claw.cfl_desired = 0.75
    claw.cfl_max = 1.0
    claw.steps_max = 100000
    claw.order = 2
    claw.dimensional_split = "unsplit"
    claw.transverse_waves = 2
    claw.num_waves = 3
    claw.limiter = ["mc"] * 3
    claw.use_fwaves = True
    claw.source_split = "godunov"
    claw.num_ghost = 2
    claw.bc_lower[:] = ["extrap"] * 2
    claw.bc_upper[:] = ["extrap"] * 2
    claw.checkpt_style = 0

    amr = rundata.amrdata
    amr.amr_levels_max = 1
    amr.aux_type = ["center"]

    geo = rundata.geo_data
    geo.gravity = {gravity}
    geo.coordinate_system = 1
    geo.coriolis_forcing = False
    geo.sea_level = 0.0
    geo.dry_tolerance = 1e-3
    geo.friction_forcing = True
    geo.manning_coefficient = 0.025
    geo.friction_depth = 1e6

    rundata.topo_data.topofiles.append([3, "topo.tt3"])
    # qinit.f90 reads eta.xyz, hu.xyz and hv.xyz
    rundata.qinit_data.qinit_type = 0
    # number, x, y, from, to
    # rundata.gaugedata.gauges.append([1, {middle_x}, {middle_y}, {time}, 1e10])
    return rundata


if __name__ == "__main__":
    setrun().write()
