#include "src/config/require_file.hpp"

#include "partition/comm.hpp"

#include <fmt/format.h>

namespace taut::config {

void require_file(MPI_Comm comm, const Case& input, const std::string& key,
                  const std::filesystem::path& file) {
  on_rank_0(comm, [&] {
    std::error_code none;
    if (!std::filesystem::is_regular_file(input.folder() / file, none))
      throw InputError(fmt::format("{}: {}: {}: no such file; paths are relative to the case file",
                                   input.file.string(), key, file.string()));
  });
}

} // namespace taut::config
