#include "tests/fuzz/target.hpp"

#include "partition/error.hpp"

#include <cstdlib>
#include <fstream>
#include <string>

namespace taut::fuzz {

namespace {

namespace fs = std::filesystem;

/// Gone at the end of the program, unless it crashes.
class Folder {
public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "taut-fuzz-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder can be made");
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  const fs::path& path() const { return path_; }

private:
  fs::path path_;
};

} // namespace

void try_input(std::string_view bytes) {
  try {
    read_input(bytes);
  } catch (const InputError&) { // refused, in words
  }
}

fs::path write_input(std::string_view name, std::string_view bytes) {
  static const Folder folder;
  fs::path path = folder.path() / name;
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

} // namespace taut::fuzz
