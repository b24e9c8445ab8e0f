#pragma once
#include <string_view>
#include <vector>

/// Units of the case file. A quantity is a plain number in its SI unit, or a text such as "10 ms".
namespace taut::config {

enum class Unit {
  none,
  metre,
  second,
  hertz,
  per_second,
  radian,
  metre_per_second,
  metre_per_second2,
  kilogram_per_metre3,
  cloth_density, ///< kg/m^2 on a surface, kg/m on a line
  cloth_bending, ///< N m on a surface, N m^2 on a line
  cloth_stretch, ///< N/m on a surface, N on a line
  newton,
  newton_per_metre,
  pascal,
  per_newton,
};

/// rad, a full turn as it is usually rounded: a larger angle is written with its unit, as degrees without one
/// are the usual mistake.
inline constexpr double full_turn = 6.2832;

/// How messages and documents speak of a unit.
struct UnitName {
  Unit unit;
  std::string_view symbol;   ///< "s"
  std::string_view quantity; ///< "time"
  std::string_view plural;   ///< "seconds"
  std::string_view example;  ///< "10 ms"
};

const UnitName& name_of(Unit unit);

/// A scale in which a quantity may be written: a number x stands for x * times / over in SI units. Two
/// integers rather than one factor, for "3 ms" is to be exactly the number 0.003.
struct Scale {
  Unit unit;
  std::string_view symbol;
  double times = 1;
  double over = 1;
};

/// The scale called `symbol` for quantities in `unit`; nullptr if there is none.
const Scale* find_scale(Unit unit, std::string_view symbol);

/// Those of all its scales.
std::vector<std::string_view> symbols_of(Unit unit);

} // namespace taut::config
