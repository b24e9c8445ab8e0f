#pragma once
#include <span>
#include <string>
#include <vector>

namespace taut::command {

/// The words of the environment variable PETSC_OPTIONS.
std::vector<std::string> options_of_environment();

/// The PETSc options of a case, `kept`, with those that were given for this program added, or in their place
/// where both name the same. Only those of solvers belong to the case: others, as -log_view, are of the
/// program. Throws InputError for a word that is neither an option nor the value of one: PETSc passes over
/// it.
std::string merged_petsc_options(const std::string& kept, std::span<const std::string> given);

} // namespace taut::command
