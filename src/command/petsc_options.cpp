#include "src/command/petsc_options.hpp"

#include "partition/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <iterator>
#include <sstream>

namespace taut::command {

namespace {

struct Option {
  std::string name;
  std::string value; ///< empty: it has none
};

constexpr std::array<std::string_view, 4> solvers{"-velocity_", "-projection_", "-kkt_", "-stiffness_"};

bool is_name(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && std::isalpha(static_cast<unsigned char>(word[1]));
}

bool is_of_solver(const Option& option) {
  return std::any_of(solvers.begin(), solvers.end(),
                     [&](std::string_view prefix) { return option.name.starts_with(prefix); });
}

void add(std::vector<Option>& options, std::span<const std::string> words) {
  bool value_may_follow = false;
  std::vector<Option> added;
  for (const std::string& word : words) {
    if (is_name(word))
      added.push_back({word, ""});
    else if (value_may_follow)
      added.back().value = word;
    else
      throw InputError(
          fmt::format("'{}' is no PETSc option: those are words such as -projection_ksp_monitor, "
                      "each followed by its value if it has one",
                      word));
    value_may_follow = is_name(word);
  }
  for (const Option& option : added) {
    std::erase_if(options, [&](const Option& o) { return o.name == option.name; });
    options.push_back(option);
  }
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

} // namespace

std::vector<std::string> options_of_environment() {
  const char* const text = std::getenv("PETSC_OPTIONS");
  return words_of(text ? text : "");
}

std::string merged_petsc_options(const std::string& kept, std::span<const std::string> given) {
  std::vector<Option> options;
  add(options, words_of(kept));
  add(options, given);
  std::erase_if(options, [](const Option& o) { return !is_of_solver(o); });
  std::vector<std::string> words;
  for (const Option& o : options) words.push_back(o.value.empty() ? o.name : o.name + " " + o.value);
  return fmt::format("{}", fmt::join(words, " "));
}

} // namespace taut::command
