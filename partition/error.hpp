#pragma once
#include <stdexcept>

namespace taut {

/// Something the user can cure: a case, a mesh, an option, an output folder. Ends the program with exit
/// code 2 and this message, which names the place and the cure. Thrown with the same text on every rank of
/// the communicator (see `broadcast` and `agree` in comm.hpp), so that all ranks leave together.
class InputError : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

} // namespace taut
