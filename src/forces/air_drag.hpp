#pragma once
#include "src/forces/force.hpp"

namespace taut {

/// Pressure drag of the air on faces: f = -1/2 rho c_d A |u_n| u_n n, with u_n the normal component of the
/// face's velocity relative to the wind. |u_n| is that of the step's start; u_n itself is implicit. A quarter
/// of it acts on each vertex of a quad. Line elements have no face and feel none.
///
/// The wind blows with `air.wind`, plus a gust along it: speed * sin(2 pi (s / length - t / period)), where s
/// is the distance along the wind.
class AirDrag : public Force {
public:
  AirDrag(const Cloth& cloth, const config::Air& air) : cloth_(cloth), air_(air) {}

  std::string_view name() const override { return "air_drag"; }
  bool is_internal() const override { return false; }
  double energy(const State&) const override { return 0; }
  void add_to(StepSystem& system, const State& state) override;

  /// m/s
  Vec3 wind_at(const Vec3& position, double time) const;

private:
  const Cloth& cloth_;
  config::Air air_;
};

} // namespace taut
