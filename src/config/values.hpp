#pragma once
#include "partition/types.hpp"
#include "src/config/key.hpp"
#include "src/config/tree.hpp"

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

/// Reading single values from a tree; whatever does not fit is an `InputError`.
namespace taut::config {

/// A value about to be read.
struct Spot {
  const Tree& tree;
  std::string path; ///< "time.max_step"
  const Key& key;

  [[noreturn]] void fail(const std::string& message) const; ///< "place: path: message"
  Spot item(std::size_t i) const { return {tree.items[i], path + "." + std::to_string(i), key}; }
};

/// Throws that the value is not what was `wanted`.
[[noreturn]] void fail_type(const Spot& spot, std::string_view wanted);

void read(const Spot& spot, double& value);
void read(const Spot& spot, int& value);
void read(const Spot& spot, Global& value);
void read(const Spot& spot, bool& value);
void read(const Spot& spot, std::string& value);
void read(const Spot& spot, std::filesystem::path& value);
void read(const Spot& spot, Vec2& value);
void read(const Spot& spot, Vec3& value);
void read(const Spot& spot, std::array<int, 2>& value);

/// The index of the word in `words`.
std::size_t read_word(const Spot& spot, std::span<const std::string> words);

} // namespace taut::config
