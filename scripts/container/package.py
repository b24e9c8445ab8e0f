"""A recipe for Spack: packages/taut/package.py of a repository of recipes."""
from spack.package import CMakePackage, depends_on, version  # type: ignore[import]


class Taut(CMakePackage):
    """MPI-parallel solver for cloth that does not stretch."""

    version("main", branch="main")

    depends_on("cmake@3.20:", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("mpi")
    depends_on("petsc@3.18: +double~complex+mpi+mumps")
    depends_on("hdf5+mpi")
    depends_on("metis")
    depends_on("scotch+mpi")
    depends_on("zlib-api")
    depends_on("eigen@3.4:")
    depends_on("embree@3")
    depends_on("cgal")
    depends_on("boost")
    depends_on("geos@3.11:")
    depends_on("yaml-cpp")
    depends_on("cli11")
    depends_on("fmt")
    depends_on("nlohmann-json")

    def cmake_args(self):
        return [self.define("BUILD_TESTING", False)]
