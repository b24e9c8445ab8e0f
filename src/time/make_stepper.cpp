#include "src/time/make_stepper.hpp"

#include "src/constraints/choose_set.hpp"
#include "src/time/newton_step.hpp"
#include "src/time/predict_and_filter.hpp"
#include "src/time/predict_with_solids.hpp"
#include "src/time/xpbd.hpp"

namespace taut {

std::unique_ptr<Stepper> make_stepper(const StepperParts& parts, const Case& input) {
  if (input.inextensibility.method == config::InextensibilityMethod::xpbd)
    return std::make_unique<Xpbd>(parts);
  if (input.inextensibility.method == config::InextensibilityMethod::newton)
    return for_chosen_set(parts.cloth, parts.resolved.inextensibility,
                          [&]<ConstraintSetInNewton Set>() -> std::unique_ptr<Stepper> {
                            return std::make_unique<NewtonStep<Set>>(parts, input);
                          });
  if (input.contact_model() == config::ContactModel::penalty && !parts.obstacles.empty())
    return std::make_unique<PredictWithSolids>(parts, input);
  return std::make_unique<PredictAndFilter>(parts, input);
}

} // namespace taut
