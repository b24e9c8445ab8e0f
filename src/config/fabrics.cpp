#include "src/config/fabrics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace taut::config {

namespace {

constexpr DrapeBand silk_band{20, 40, "Matsudaira and Yang 2003, woven silks"};
constexpr DrapeBand cotton_band{60, 76, "about the 68.4 that Gan, Ly and Steven 1991 measured"};
constexpr DrapeBand wool_band{40, 70,
                              "worsted suitings, as calibration notes of ppf-contact-solver collect them"};
constexpr DrapeBand denim_band{70, 90,
                               "heavy twills, as calibration notes of ppf-contact-solver collect them"};
constexpr DrapeBand limp_band{20, 40,
                              "limp synthetics, as calibration notes of ppf-contact-solver collect them"};

/// Where no sheet of measured values goes with a measured drape: the bending stiffness at which this program
/// drapes within the band, on a cloth of the weight of the trade.
constexpr Fabric by_drape(std::string_view name, double density, double bending, double shear,
                          std::string_view source, const DrapeBand& published, int drape) {
  return {name, density, bending, shear, source, published, drape};
}

constexpr std::array<double, 3> along(double warp, double bias, double weft) { return {warp, bias, weft}; }

/// A fabric as measured for ARCSim: the mean over three directions of the bending stiffness at the smallest
/// curvature; half the shear coefficient at no strain, which belongs to half the shear angle.
constexpr Fabric from_arcsim(std::string_view name, double density, const std::array<double, 3>& bending,
                             double shear_coefficient, std::string_view source, const DrapeBand& published,
                             int drape) {
  return {name,      density, (bending[0] + bending[1] + bending[2]) / 3, shear_coefficient / 2, source,
          published, drape};
}

// From sheets of the Kawabata evaluation system.
constexpr double gf_cm2_per_cm = 9.80665e-5;                   // N m
constexpr double gf_per_cm_deg = 0.980665 * 57.29577951308232; // N/m per radian

constexpr std::array table{
    by_drape(
        "silk", 0.083, 1.5e-6, 20,
        "weight of Codim-IPC's silk, whose sheet (E 0.57 MPa, h 0.18 mm) would bend with 0.28 uN m and drape "
        "at 10 %; bending by drape",
        silk_band, 29),
    by_drape("habotai", 0.040, 0.7e-6, 15, "40 g/m^2, light silk for linings; bending by drape", silk_band,
             32),
    by_drape("crepe", 0.095, 1.5e-6, 15, "95 g/m^2, crepe de chine; bending by drape", silk_band, 25),
    by_drape("cotton", 0.1503, 12e-6, 80,
             "weight of Codim-IPC's cotton, whose sheet (E 0.821 MPa, h 0.318 mm) would bend with 2.3 uN m "
             "and drape "
             "at 14 %; bending by drape",
             cotton_band, 68),
    by_drape("poplin", 0.120, 9e-6, 80, "120 g/m^2, shirts; bending by drape", cotton_band, 66),
    Fabric{"wool", 0.2635, 0.1357 * gf_cm2_per_cm, 0.968 * gf_per_cm_deg,
           "Kawabata 1980, mean of men's winter suitings: B 0.136 gf cm^2/cm, G 0.97 gf/(cm deg), 264 g/m^2; "
           "bending "
           "and drape agree",
           wool_band, 53},
    by_drape("tropical", 0.180, 8e-6, 40, "180 g/m^2, light suiting; bending by drape", wool_band, 49),
    by_drape("flannel", 0.250, 18e-6, 45, "250 g/m^2, milled suiting; bending by drape", wool_band, 60),
    from_arcsim(
        "denim", 0.324, along(64.196457e-6, 73.384567e-6, 96.951576e-6), 53.387184,
        "ARCSim, materials/11oz-black-denim.json (99% cotton 1% spandex, jeans), of the database of Wang, "
        "Ramamoorthi and O'Brien 2011; mean of directions at the smallest curvature; bending and drape agree",
        denim_band, 82),
    Fabric{"canvas",
           0.294,
           24.9e-6,
           532.4,
           "Codim-IPC, Python/Drivers/FEMDiscreteShellBase.py, 'canvas' (h 0.53 mm, E 2.009 MPa); stiffness "
           "of an "
           "elastic sheet with nu 0; its density 294 taken as g/m^2; drapes at 68 to 74 %, by how many folds "
           "it finds",
           {},
           71},
    by_drape("flag", 0.070, 1.6e-6, 15, "70 g/m^2, light nylon; bending by drape", limp_band, 34),
    from_arcsim(
        "polyester", 0.128, along(51.713814e-6, 40.659470e-6, 31.282822e-6), 19.189022,
        "ARCSim, materials/white-dots-on-blk.json (100% polyester, tablecloth), of the database of Wang, "
        "Ramamoorthi and O'Brien 2011; mean of directions at the smallest curvature",
        {}, 84),
    from_arcsim(
        "polycotton", 0.220, along(125.409805e-6, 107.997696e-6, 125.409805e-6), 104.759674,
        "ARCSim, materials/royal-target.json (65% cotton 35% polyester, pants), of the database of Wang, "
        "Ramamoorthi and O'Brien 2011; mean of directions at the smallest curvature",
        {}, 92),
    from_arcsim("interlock", 0.187, along(23.191698e-6, 24.749964e-6, 14.267624e-6), 36.860302,
                "ARCSim, materials/gray-interlock.json (60% cotton 40% polyester, t-shirt; a knit), of the "
                "database of "
                "Wang, Ramamoorthi and O'Brien 2011; mean of directions at the smallest curvature",
                {}, 66),
    from_arcsim("ponte", 0.284, along(36.348366e-6, 33.013252e-6, 37.157593e-6), 31.896357,
                "ARCSim, materials/camel-ponte-roma.json (60% polyester 40% rayon, jacket; a knit), of the "
                "database of "
                "Wang, Ramamoorthi and O'Brien 2011; mean of directions at the smallest curvature",
                {}, 69),
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

std::string_view verdict(const Fabric& f) {
  if (f.published.source.empty()) return "no band found";
  return f.drape >= f.published.low && f.drape <= f.published.high ? "drapes as published"
                                                                   : "drapes otherwise";
}

std::string fabric_table() {
  std::string text =
      "| fabric | g/m^2 | bending, uN m | shear, N/m | bending length, mm | drape, % | published, % | "
      "verdict | values from | band from |\n|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Fabric& f : table) {
    const bool has_band = !f.published.source.empty();
    text += fmt::format("| `{}` | {:.0f} | {:.3g} | {:.3g} | {:.1f} | {} | {} | {} | {} | {} |\n", f.name,
                        1000 * f.density, 1e6 * f.bending, f.shear,
                        1000 * std::cbrt(f.bending / (9.81 * f.density)), f.drape,
                        has_band ? fmt::format("{} to {}", f.published.low, f.published.high) : "",
                        verdict(f), f.source, f.published.source);
  }
  return text;
}

} // namespace taut::config
