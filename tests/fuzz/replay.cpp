// Gives a target the files named on the command line, one after the other.
#include "tests/fuzz/target.hpp"

#include <fmt/format.h>
#include <mpi.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  for (int k = 1; k < argc; ++k) {
    fmt::print("{}\n", argv[k]);
    std::fflush(stdout); // the last name is that of the file which ended the program
    std::ifstream in(argv[k], std::ios::binary);
    taut::fuzz::try_input(std::string(std::istreambuf_iterator<char>(in), {}));
  }
  MPI_Finalize();
  return argc > 1 ? 0 : 1;
}
