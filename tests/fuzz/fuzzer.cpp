// What libFuzzer calls.
#include "tests/fuzz/target.hpp"

#include <mpi.h>

#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) { return MPI_Init(argc, argv); }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  taut::fuzz::try_input({reinterpret_cast<const char*>(data), size});
  return 0;
}
