#include "src/config/values.hpp"
#include "partition/error.hpp"
#include "src/config/suggest.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>
#include <type_traits>

namespace taut::config {

namespace {

std::string_view trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

void check_range(const Spot& spot, double value, std::string_view text) {
  if (!spot.key.range.contains(value))
    spot.fail(fmt::format("{} is out of range; it must be {}", text, spot.key.range.text()));
}

[[noreturn]] void fail_number(const Spot& spot) {
  const UnitName& unit = name_of(spot.key.unit);
  fail_type(spot, spot.key.unit == Unit::none
                      ? "a number, e.g. 0.5"
                      : fmt::format("a number in {}, or e.g. '{}'", unit.plural, unit.example));
}

/// YAML's spellings of infinity and "not a number", and those of C++.
bool is_not_finite(std::string_view text) {
  std::string word(text.substr(text.starts_with('-') || text.starts_with('+') ? 1 : 0));
  std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return std::tolower(c); });
  return word == ".inf" || word == ".nan" || word == "inf" || word == "nan" || word == "infinity";
}

void check_turn(const Spot& spot, double number) {
  if (spot.key.unit != Unit::radian || std::abs(number) <= full_turn) return;
  spot.fail(
      fmt::format("{} without a unit would be radians, more than a full turn; write '{} deg', or '{} rad' if "
                  "that is meant",
                  number, number, number));
}

double in_si(const Spot& spot, double number, std::string_view symbol) {
  if (symbol.empty()) {
    check_turn(spot, number);
    return number;
  }
  if (const Scale* scale = find_scale(spot.key.unit, symbol)) return number * scale->times / scale->over;
  const UnitName& unit = name_of(spot.key.unit);
  spot.fail(fmt::format("'{}' is not a unit of {}; write {} as a number, or e.g. '{}' (units: {})", symbol,
                        unit.quantity, unit.plural, unit.example,
                        fmt::join(symbols_of(spot.key.unit), ", ")));
}

template<std::integral Whole>
void read_whole(const Spot& spot, Whole& value) {
  const std::string& text = spot.tree.text;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (spot.tree.kind == Tree::Kind::scalar && error == std::errc::result_out_of_range && stop == end)
    spot.fail(
        fmt::format("{} is out of range; it must be at most {}", text, std::numeric_limits<Whole>::max()));
  if (spot.tree.kind != Tree::Kind::scalar || error != std::errc{} || stop != end)
    fail_type(spot, "a whole number, e.g. 10");
  check_range(spot, static_cast<double>(value), text);
}

/// Reads as many values as `values` has places.
template<class Values>
void read_row(const Spot& spot, Values& values, std::string_view example) {
  const auto size = static_cast<std::size_t>(values.size());
  if (spot.tree.kind != Tree::Kind::list || spot.tree.items.size() != size)
    fail_type(spot, fmt::format("a list of {} numbers, e.g. {}", size, example));
  for (std::size_t i = 0; i < size; ++i) read(spot.item(i), values[i]);
}

} // namespace

void Spot::fail(const std::string& message) const {
  throw InputError(fmt::format("{}: {}: {}", tree.place, path, message));
}

void fail_type(const Spot& spot, std::string_view wanted) {
  spot.fail(fmt::format("expected {}, found {}", wanted, spot.tree.found()));
}

void read(const Spot& spot, double& value) {
  if (spot.tree.kind != Tree::Kind::scalar) fail_number(spot);
  std::string_view text = trim(spot.tree.text);
  if (is_not_finite(text)) spot.fail(fmt::format("{} is not a finite number; write a finite one", text));
  const std::string_view digits = text.starts_with('+') ? text.substr(1) : text;
  const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range)
    spot.fail(fmt::format("{} is beyond what a number can hold (about 1e-308 to 1e308)", text));
  if (error != std::errc{} || !std::isfinite(value)) fail_number(spot);
  const auto length = static_cast<std::size_t>(stop - digits.data());
  value = in_si(spot, value, trim(digits.substr(length)));
  if (!std::isfinite(value)) spot.fail(fmt::format("{} is not a finite number; write a finite one", text));
  check_range(spot, value, text);
}

void read(const Spot& spot, int& value) { read_whole(spot, value); }

void read(const Spot& spot, Global& value) { read_whole(spot, value); }

void read(const Spot& spot, bool& value) {
  const std::string& text = spot.tree.text;
  if (spot.tree.kind != Tree::Kind::scalar || (text != "true" && text != "false"))
    fail_type(spot, "true or false");
  value = text == "true";
}

void read(const Spot& spot, std::string& value) {
  if (spot.tree.kind != Tree::Kind::scalar) fail_type(spot, "a text");
  if (!spot.key.words.empty()) read_word(spot, spot.key.words);
  value = spot.tree.text;
}

void read(const Spot& spot, std::filesystem::path& value) {
  if (spot.tree.kind != Tree::Kind::scalar || spot.tree.text.empty())
    fail_type(spot, "the path of a file, e.g. shirt.obj");
  value = spot.tree.text;
}

void read(const Spot& spot, Vec2& value) { read_row(spot, value, "[1, 0.5]"); }

void read(const Spot& spot, Vec3& value) { read_row(spot, value, "[0, 0, 1]"); }

void read(const Spot& spot, std::array<int, 2>& value) { read_row(spot, value, "[20, 20]"); }

std::size_t read_word(const Spot& spot, std::span<const std::string> words) {
  const std::string choices = fmt::format("{}", fmt::join(words, ", "));
  if (spot.tree.kind != Tree::Kind::scalar) fail_type(spot, "one of " + choices);
  const auto found = std::find(words.begin(), words.end(), spot.tree.text);
  if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
  const auto meant = nearest(spot.tree.text, words);
  spot.fail(fmt::format("unknown word '{}'{}; choose one of {}", spot.tree.text,
                        meant ? fmt::format(" (did you mean '{}'?)", *meant) : "", choices));
}

} // namespace taut::config
