#pragma once

/// Files of a run, by their names in its folder.
namespace taut::run_files {

constexpr const char* case_as_run = "case.yaml";
constexpr const char* mesh = "mesh.h5";
constexpr const char* steps = "steps.csv";
constexpr const char* findings = "findings.vtp";
constexpr const char* summary = "summary.json";
constexpr const char* lock = "lock"; ///< while somebody writes there

} // namespace taut::run_files
