#pragma once
#include "partition/comm.hpp"

#include <cstdlib>
#include <filesystem>

namespace taut::test {

/// A folder of the test's own, the same on all ranks of MPI_COMM_WORLD, gone at the end.
class Folder {
public:
  Folder() {
    path_ = broadcast(MPI_COMM_WORLD, [] {
      std::string name = (std::filesystem::temp_directory_path() / "taut-test-XXXXXX").string();
      return std::string(mkdtemp(name.data()));
    });
  }
  ~Folder() {
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank_of(MPI_COMM_WORLD) == 0) std::filesystem::remove_all(path_);
  }
  Folder(const Folder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  std::size_t files() const {
    MPI_Barrier(MPI_COMM_WORLD);
    return std::distance(std::filesystem::directory_iterator(path_), {});
  }

private:
  std::filesystem::path path_;
};

} // namespace taut::test
