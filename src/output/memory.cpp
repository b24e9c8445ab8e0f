#include "src/output/memory.hpp"

#include <sys/resource.h>

namespace taut {

double peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * double(usage.ru_maxrss);
}

} // namespace taut
