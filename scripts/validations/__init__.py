"""Comparisons of Taut with what is known from elsewhere, a file each, in the order of the table."""
from studies.experiment import Experiment
from validations import (audits, bending_length, cantilever, catenary, cusick, free_fall, incline, lateral_buckling,
                         mesh_convergence, order_in_time, pendulum, rest, static_stretch)

VALIDATIONS = tuple(Experiment.of(module) for module in (
    free_fall, pendulum, static_stretch, catenary, order_in_time, audits, cantilever, lateral_buckling, bending_length,
    cusick, incline, mesh_convergence, rest))
