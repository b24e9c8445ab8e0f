#include "io/checksum.hpp"
#include "src/command/command.hpp"
#include "src/output/run_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <sstream>

namespace taut::command {

namespace {

namespace fs = std::filesystem;

/// The files of a run that bear checksums, in the order of their names.
std::vector<fs::path> hdf5_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::path& part : {folder, folder / "frames", folder / "checkpoint"}) {
    std::error_code none; // no such folder: no files
    for (const auto& entry : fs::directory_iterator(part, none))
      if (entry.path().extension() == ".h5") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

} // namespace

int check_run(MPI_Comm comm, const fs::path& folder) {
  std::istringstream names(broadcast(comm, [&] {
    std::string lines;
    for (const fs::path& file : hdf5_files(folder)) lines += file.string() + "\n";
    if (lines.empty())
      throw InputError(fmt::format("{}: holds no run (no {}); give the output folder of one, or a case file",
                                   folder.string(), run_files::mesh));
    return lines;
  }));
  int sound = 0, damaged = 0;
  for (std::string file; std::getline(names, file);) {
    const std::string damage = damage_of(comm, file, Checksum::required);
    damage.empty() ? ++sound : ++damaged;
    if (!damage.empty() && rank_of(comm) == 0) fmt::print(stderr, "taut: {}\n", damage);
  }
  if (rank_of(comm) == 0)
    fmt::print("{}: {} files are as they were written, {} are damaged\n", folder.string(), sound, damaged);
  return damaged == 0 ? success : input_error;
}

} // namespace taut::command
