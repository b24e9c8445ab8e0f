#pragma once
#include <filesystem>
#include <stdexcept>
#include <string_view>

/// A fuzz target reads bytes as Taut reads a user's file, with the ordinary readers. What a reader refuses is
/// `InputError`; anything else (another exception, a crash, a hang, memory without measure) is a finding.
/// Built by clang++ as build type Sanitize, a target is a fuzzer; by other compilers it replays the files it
/// is given.
namespace taut::fuzz {

/// Each target defines it. May throw InputError.
void read_input(std::string_view bytes);

/// The reader contradicts itself.
class Contradiction : public std::logic_error {
public:
  using std::logic_error::logic_error;
};

/// Runs `read_input`, which may refuse what it is given.
void try_input(std::string_view bytes);

/// Writes `bytes` to a file of this name in a folder of this process.
std::filesystem::path write_input(std::string_view name, std::string_view bytes);

} // namespace taut::fuzz
