#include "src/filters/make_filter.hpp"

#include "src/constraints/choose_set.hpp"
#include "src/filters/fast_projection.hpp"
#include "src/filters/icd.hpp"
#include "src/filters/rattle.hpp"
#include "src/filters/sap.hpp"
#include "src/filters/shake.hpp"
#include "src/filters/spring_tension.hpp"
#include "src/filters/strain_limiting.hpp"

namespace taut {

std::unique_ptr<VelocityFilter> make_filter(const Cloth& cloth, const Pattern& pattern,
                                            const config::Inextensibility& options) {
  using enum config::InextensibilityMethod;
  switch (options.method) {
  case fast_projection:
    return for_chosen_set(cloth, options, [&]<ConstraintSet Set>() -> std::unique_ptr<VelocityFilter> {
      return std::make_unique<FastProjection<Set>>(cloth, options);
    });
  case icd:
    return std::make_unique<Icd>(cloth, pattern, options);
  case sap:
    return std::make_unique<Sap>(cloth, pattern, options);
  case shake:
    return std::make_unique<Shake>(cloth, options);
  case rattle:
    return std::make_unique<Rattle>(cloth, options);
  case jacobi:
  case gauss_seidel:
    return std::make_unique<StrainLimiting>(cloth, options);
  case springs:
    return std::make_unique<SpringTension>(cloth, options);
  case newton:
  case xpbd:
  case none:
    break;
  }
  return nullptr;
}

} // namespace taut
