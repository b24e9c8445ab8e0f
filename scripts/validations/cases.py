"""Cases that validations share, as dicts, and what is known of their motion."""
import math

G = 9.81  # m/s^2
EXACT = {"velocity": {"solver": "mumps"}, "inextensibility": {"solver": "mumps", "strain": 1e-9, "compliance": 0}}


def steps_of(end, step, frames=1, **more):
    return {"end": end, "frame_rate": frames / end, "max_step": step, **more}


def order(fine, coarse, ratio=2):
    """Of an error that falls from `coarse` to `fine` where the step is divided by `ratio`."""
    return math.log(coarse / fine) / math.log(ratio)


def points(keys, *rows):
    return [dict(zip(keys, row)) for row in rows]


def of(rows, **wanted):
    """The rows with these values, in their order."""
    return [row for row in rows if all(row[key] == value for key, value in wanted.items())]


def one(rows, **wanted):
    return of(rows, **wanted)[0]


def values(rows, key):
    """The different values of a column, in their order."""
    return list(dict.fromkeys(row[key] for row in rows))
