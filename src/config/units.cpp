#include "src/config/units.hpp"

#include <algorithm>
#include <array>
#include <numbers>

namespace taut::config {

namespace {

constexpr std::array names{
    UnitName{Unit::none, "", "a ratio", "it", "1 %"},
    UnitName{Unit::metre, "m", "length", "metres", "50 cm"},
    UnitName{Unit::second, "s", "time", "seconds", "10 ms"},
    UnitName{Unit::hertz, "Hz", "frequency", "hertz", "30 Hz"},
    UnitName{Unit::per_second, "1/s", "rate", "1/s", "0.5 1/s"},
    UnitName{Unit::radian, "rad", "angle", "radians", "90 deg"},
    UnitName{Unit::metre_per_second, "m/s", "speed", "metres per second", "20 km/h"},
    UnitName{Unit::metre_per_second2, "m/s^2", "acceleration", "m/s^2", "9.81 m/s^2"},
    UnitName{Unit::kilogram_per_metre3, "kg/m^3", "density", "kg/m^3", "1.2 kg/m^3"},
    UnitName{Unit::cloth_density, "kg/m^2 (kg/m on a line)", "cloth density", "kg/m^2 (kg/m on a line)",
             "200 g/m^2"},
    UnitName{Unit::cloth_bending, "N m (N m^2 on a line)", "bending stiffness", "N m (N m^2 on a line)",
             "10 uN m"},
    UnitName{Unit::cloth_stretch, "N/m (N on a line)", "stretch stiffness", "N/m (N on a line)", "500 N/m"},
    UnitName{Unit::newton, "N", "force", "newtons", "10 N"},
    UnitName{Unit::newton_per_metre, "N/m", "shear stiffness", "N/m", "10 N/m"},
    UnitName{Unit::pascal, "Pa", "pressure", "pascals", "1 kPa"},
    UnitName{Unit::per_newton, "1/N", "compliance", "1/N", "1e-4 1/N"},
};

constexpr double standard_gravity = 9.80665; // m/s^2; a gram-force is a thousandth of it in N

constexpr std::array scales{
    Scale{Unit::none, "%", 1, 100},
    Scale{Unit::metre, "m"},
    Scale{Unit::metre, "cm", 1, 100},
    Scale{Unit::metre, "mm", 1, 1000},
    Scale{Unit::metre, "in", 0.0254},
    Scale{Unit::second, "s"},
    Scale{Unit::second, "ms", 1, 1000},
    Scale{Unit::second, "us", 1, 1e6},
    Scale{Unit::second, "min", 60, 1},
    Scale{Unit::hertz, "Hz"},
    Scale{Unit::hertz, "1/s"},
    Scale{Unit::per_second, "1/s"},
    Scale{Unit::per_second, "Hz"},
    Scale{Unit::radian, "rad"},
    Scale{Unit::radian, "deg", std::numbers::pi, 180},
    Scale{Unit::metre_per_second, "m/s"},
    Scale{Unit::metre_per_second, "cm/s", 1, 100},
    Scale{Unit::metre_per_second, "mm/s", 1, 1000},
    Scale{Unit::metre_per_second, "km/h", 10, 36},
    Scale{Unit::metre_per_second2, "m/s^2"},
    Scale{Unit::kilogram_per_metre3, "kg/m^3"},
    Scale{Unit::cloth_density, "kg/m^2"},
    Scale{Unit::cloth_density, "g/m^2", 1, 1000},
    Scale{Unit::cloth_density, "g/m2", 1, 1000},
    Scale{Unit::cloth_density, "gsm", 1, 1000},
    Scale{Unit::cloth_density, "kg/m"},
    Scale{Unit::cloth_density, "g/m", 1, 1000},
    Scale{Unit::cloth_bending, "N m"},
    Scale{Unit::cloth_bending, "mN m", 1, 1000},
    Scale{Unit::cloth_bending, "uN m", 1, 1e6},
    Scale{Unit::cloth_bending, "\u00b5N m", 1, 1e6}, // micro sign
    Scale{Unit::cloth_bending, "\u03bcN m", 1, 1e6}, // Greek mu
    Scale{Unit::cloth_bending, "mN mm", 1, 1e6},
    Scale{Unit::cloth_bending, "gf cm^2/cm", standard_gravity, 1e5}, // of the Kawabata evaluation system
    Scale{Unit::cloth_bending, "gf cm2/cm", standard_gravity, 1e5},
    Scale{Unit::cloth_bending, "N m^2"},
    Scale{Unit::cloth_stretch, "N/m"},
    Scale{Unit::cloth_stretch, "N"},
    Scale{Unit::newton, "N"},
    Scale{Unit::newton, "kN", 1000, 1},
    Scale{Unit::newton_per_metre, "N/m"},
    Scale{Unit::newton_per_metre, "gf/(cm deg)", 0.1 * standard_gravity * 180, std::numbers::pi},
    Scale{Unit::pascal, "Pa"},
    Scale{Unit::pascal, "kPa", 1000, 1},
    Scale{Unit::per_newton, "1/N"},
};

} // namespace

const UnitName& name_of(Unit unit) {
  return *std::find_if(names.begin(), names.end(), [&](const UnitName& n) { return n.unit == unit; });
}

const Scale* find_scale(Unit unit, std::string_view symbol) {
  const auto found = std::find_if(scales.begin(), scales.end(),
                                  [&](const Scale& s) { return s.unit == unit && s.symbol == symbol; });
  return found == scales.end() ? nullptr : &*found;
}

std::vector<std::string_view> symbols_of(Unit unit) {
  std::vector<std::string_view> symbols;
  for (const Scale& s : scales)
    if (s.unit == unit) symbols.push_back(s.symbol);
  return symbols;
}

} // namespace taut::config
