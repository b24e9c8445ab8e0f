#pragma once
#include <filesystem>
#include <set>

namespace taut {

/// What those who write for a run have written so far, in this program.
struct Written {
  std::set<std::filesystem::path> files; ///< of frames, since the last checkpoint
  double seconds = 0;                    ///< that writing took
};

} // namespace taut
