#pragma once

namespace taut {

/// Largest resident size of this process so far, bytes.
double peak_memory();

} // namespace taut
