#include "src/config/fabrics.hpp"

#include <algorithm>
#include <array>

namespace taut::config {

namespace {

struct Sheet {
  double thickness; ///< m
  double young;     ///< Pa
  double poisson;
};

/// A fabric as a thin elastic sheet: bending E h^3 / (12 (1 - nu^2)), shear E h / (2 (1 + nu)).
constexpr Fabric from_sheet(std::string_view name, double density, const Sheet& s, std::string_view source) {
  const double h = s.thickness;
  return {name, density, s.young * h * h * h / (12 * (1 - s.poisson * s.poisson)),
          s.young * h / (2 * (1 + s.poisson)), source};
}

constexpr std::array<double, 3> along(double warp, double bias, double weft) { return {warp, bias, weft}; }

/// A fabric as measured for ARCSim: the mean over three directions of the bending stiffness at the smallest
/// curvature; half the shear coefficient at no strain, which belongs to half the shear angle.
constexpr Fabric from_arcsim(std::string_view name, double density, const std::array<double, 3>& bending,
                             double shear_coefficient, std::string_view source) {
  return {name, density, (bending[0] + bending[1] + bending[2]) / 3, shear_coefficient / 2, source};
}

constexpr std::array table{
    from_sheet(
        "cotton", 472.641509 * 0.318e-3, {0.318e-3, 0.821e6, 0.243},
        "Codim-IPC, Python/Drivers/FEMDiscreteShellBase.py, '100% cotton' (h 0.318 mm, E 0.821 MPa, nu "
        "0.243); stiffness of an elastic sheet"),
    from_sheet("wool", 413.380282 * 0.568e-3, {0.568e-3, 0.170e6, 0.277},
               "Codim-IPC, Python/Drivers/FEMDiscreteShellBase.py, '100% wool' (h 0.568 mm, E 0.170 MPa, nu "
               "0.277); stiffness of an elastic sheet"),
    from_sheet(
        "silk", 0.083, {0.18e-3, 0.57e6, 0},
        "Codim-IPC, Python/Drivers/FEMDiscreteShellBase.py, 'silk' (h 0.18 mm, E 0.57 MPa); stiffness of "
        "an elastic sheet with nu 0; its density 83 taken as g/m^2"),
    from_sheet(
        "canvas", 0.294, {0.53e-3, 2.009e6, 0},
        "Codim-IPC, Python/Drivers/FEMDiscreteShellBase.py, 'canvas' (h 0.53 mm, E 2.009 MPa); stiffness "
        "of an elastic sheet with nu 0; its density 294 taken as g/m^2"),
    from_arcsim(
        "denim", 0.324, along(64.196457e-6, 73.384567e-6, 96.951576e-6), 53.387184,
        "ARCSim, materials/11oz-black-denim.json (99% cotton 1% spandex, jeans), of the database of Wang, "
        "Ramamoorthi and O'Brien 2011; mean of directions at the smallest curvature"),
    from_arcsim(
        "polyester", 0.128, along(51.713814e-6, 40.659470e-6, 31.282822e-6), 19.189022,
        "ARCSim, materials/white-dots-on-blk.json (100% polyester, tablecloth), of the database of Wang, "
        "Ramamoorthi and O'Brien 2011; mean of directions at the smallest curvature"),
    from_arcsim(
        "polycotton", 0.220, along(125.409805e-6, 107.997696e-6, 125.409805e-6), 104.759674,
        "ARCSim, materials/royal-target.json (65% cotton 35% polyester, pants), of the database of Wang, "
        "Ramamoorthi and O'Brien 2011; mean of directions at the smallest curvature"),
    from_arcsim(
        "interlock", 0.187, along(23.191698e-6, 24.749964e-6, 14.267624e-6), 36.860302,
        "ARCSim, materials/gray-interlock.json (60% cotton 40% polyester, t-shirt), of the database of "
        "Wang, Ramamoorthi and O'Brien 2011; mean of directions at the smallest curvature"),
    from_arcsim(
        "ponte", 0.284, along(36.348366e-6, 33.013252e-6, 37.157593e-6), 31.896357,
        "ARCSim, materials/camel-ponte-roma.json (60% polyester 40% rayon, jacket), of the database of "
        "Wang, Ramamoorthi and O'Brien 2011; mean of directions at the smallest curvature"),
};

} // namespace

std::span<const Fabric> fabrics() { return table; }

std::vector<std::string> fabric_names() {
  std::vector<std::string> names;
  for (const Fabric& f : table) names.emplace_back(f.name);
  return names;
}

const Fabric* find_fabric(std::string_view name) {
  const auto found =
      std::find_if(table.begin(), table.end(), [&](const Fabric& f) { return f.name == name; });
  return found == table.end() ? nullptr : &*found;
}

} // namespace taut::config
