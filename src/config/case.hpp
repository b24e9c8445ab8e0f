#pragma once
#include "partition/error.hpp"
#include "partition/types.hpp"
#include "src/config/cloth.hpp"
#include "src/config/gravity.hpp"
#include "src/config/scene.hpp"
#include "src/config/solver.hpp"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// The case: what to simulate, as plain data in SI units. The initial value of a member is the default of its
/// key; names, units, ranges and meanings of all keys stand in describe_*.hpp.
namespace taut {

struct Case {
  std::string name;
  std::vector<config::Cloth> cloths{1}; ///< at least one; their vertices are numbered one after the other
  std::vector<config::Pin> pins;
  config::Gravity gravity;
  std::vector<config::Attachment> attachments;
  std::optional<config::Air> air; ///< absent: vacuum
  std::vector<config::Obstacle> obstacles;
  std::optional<config::Sewing> sewing;   ///< absent: the panels of patterns stay apart
  std::optional<config::Contact> contact; ///< absent: its defaults if there are obstacles, otherwise none
  config::Time time;
  config::Velocity velocity;
  config::Inextensibility inextensibility;
  config::Partition partition;
  config::Checkpoint checkpoint;
  config::Output output;
  std::string petsc; ///< PETSc options of the linear solvers, as words

  config::ContactModel contact_model() const {
    if (contact) return contact->model;
    return obstacles.empty() ? config::ContactModel::none : config::ContactModel::constraint;
  }
  bool has_contact() const { return contact_model() != config::ContactModel::none; }

  std::filesystem::path file; ///< not a key: the case file, for messages and for the paths in it
  std::filesystem::path folder() const { return file.parent_path(); } ///< empty is the working folder
  bool operator==(const Case&) const = default;
};

/// `--set key=value`: `key` is a path such as "time.max_step" or "pins.0.release", also written
/// "pins[0].release"; `value` is YAML.
struct Override {
  std::string key;
  std::string value;
};

/// Reads a case from YAML text; `file_name` names it in messages, gives `file` and the default of `name`:
/// what stands before its extension, of a case.yaml its folder. Overrides are applied in order. An override
/// that adds `cloth.mesh` takes the place of a `cloth.grid` in the file (likewise for all keys of which
/// exactly one is to be given). Throws `InputError` for the first mistake found: "file:line:column: ...", or
/// "--set key=value: ...".
Case read_case(const std::string& text, const std::string& file_name,
               std::span<const Override> overrides = {});

/// The case as YAML with every default filled in (optional blocks that are absent stay so). Read again under
/// the same file name it gives an equal case.
std::string write_case(const Case& input);

/// JSON Schema (draft 2020-12) of the case file.
std::string case_schema();

/// Markdown table of all keys: key, type, unit, default, meaning.
std::string case_table();

} // namespace taut
