#pragma once
#include <petscsys.h>

#include <string>
#include <vector>

namespace taut::test {

struct PetscSetting {
  std::string name, value;
};

/// PETSc options while this lives.
class OptionsInForce {
public:
  explicit OptionsInForce(std::vector<PetscSetting> settings) : settings_(std::move(settings)) {
    for (const auto& [name, value] : settings_) PetscOptionsSetValue(nullptr, name.c_str(), value.c_str());
  }
  ~OptionsInForce() {
    for (const auto& [name, value] : settings_) PetscOptionsClearValue(nullptr, name.c_str());
  }
  OptionsInForce(const OptionsInForce&) = delete;

private:
  std::vector<PetscSetting> settings_;
};

} // namespace taut::test
