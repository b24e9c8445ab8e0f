// Case files. A line "#set key=value" is what --set gives; for YAML it is a comment.
#include "partition/error.hpp"
#include "src/config/case.hpp"
#include "tests/fuzz/target.hpp"

#include <sstream>
#include <string>
#include <vector>

namespace {

std::vector<taut::Override> overrides_in(const std::string& text) {
  std::vector<taut::Override> overrides;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const auto equals = line.find('=');
    if (line.starts_with("#set ") && equals != std::string::npos)
      overrides.push_back({line.substr(5, equals - 5), line.substr(equals + 1)});
  }
  return overrides;
}

/// Written and read; no case that was read may be refused then.
taut::Case read_again(const taut::Case& input) {
  try {
    return taut::read_case(taut::write_case(input), input.file.string());
  } catch (const taut::InputError& e) {
    throw taut::fuzz::Contradiction(std::string("a case that was written is refused: ") + e.what());
  }
}

} // namespace

void taut::fuzz::read_input(std::string_view bytes) {
  const std::string text(bytes);
  const Case read = read_case(text, "folder/case.yaml", overrides_in(text));
  if (!(read_again(read) == read))
    throw Contradiction("a case that was written is not the case that was read");
}
