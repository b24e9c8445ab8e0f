#include "src/output/checkpoint_format.hpp"

#include <fmt/format.h>

namespace taut {

void check_checkpoint_format(const H5Reader& file) {
  if (const Global found = file.attribute<Global>(checkpoint_format_name); found != checkpoint_format)
    throw InputError(fmt::format("{}: a checkpoint of format {}, this taut reads format {}; resume with the "
                                 "taut that wrote it",
                                 file.path().string(), found, checkpoint_format));
}

} // namespace taut
