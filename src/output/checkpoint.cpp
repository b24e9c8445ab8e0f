#include "src/output/checkpoint.hpp"

#include "io/hdf5.hpp"
#include "src/output/checkpoint_cut.hpp"
#include "src/output/checkpoint_format.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <sstream>

namespace taut {

namespace {

namespace fs = std::filesystem;

constexpr const char *case_name = "case", *numbers_name = "numbers";

/// Everything in a checkpoint but the case, once, for writing and for reading.
template<class C, class V>
void visit_checkpoint(C& checkpoint, V& visit) {
  visit("time", checkpoint.state.time);
  visit("step", checkpoint.state.step);
  visit("previous_dt", checkpoint.state.previous_dt); // before the fields that are there if it is not 0
  visit("longest_step", checkpoint.step_size.step);
  visit("successes", checkpoint.step_size.successes);
  visit("patience", checkpoint.step_size.patience);
  visit("failures", checkpoint.step_size.failures);
  visit("grew", checkpoint.step_size.grew);
  visit("rejected_steps", checkpoint.rejected_steps);
  visit("start_depth", checkpoint.state.start_depth);
  visit("steps_with_cut", checkpoint.balance.steps);
  visit("waste", checkpoint.balance.waste);
  visit("least_waste", checkpoint.balance.least);
  visit_totals(checkpoint.totals, visit);
  visit_fields(checkpoint.state, visit);
}

class Writing {
public:
  Writing(H5Writer& file, const DistributedMesh& mesh) : file_(file), mesh_(mesh) {}

  template<class Number>
  void operator()(const char* name, Number value) {
    numbers_ +=
        fmt::format("{} {}\n", name, +value); // a bool as 0 or 1; a double so that it reads back exactly
  }

  const std::string& numbers() const { return numbers_; }

  void added_up(const char* name, std::vector<double> values) {
    sum_in_place(mesh_.comm, values);
    const auto total = Global(values.size()), mine = rank_of(mesh_.comm) == 0 ? total : 0;
    file_.write<double>(name, std::span(values).first(mine), 1, {0, mine, total});
  }
  void on_all_if_any(const char* name, const std::vector<double>& values) {
    const auto total = Global(values.size()), mine = rank_of(mesh_.comm) == 0 ? total : 0;
    if (total > 0) file_.write<double>(name, std::span(values).first(mine), 1, {0, mine, total});
  }
  template<class T>
  void on_vertices(const char* name, const std::vector<T>& field) {
    write_field<T>(name, mesh_.vertex_order, field);
  }
  template<class T>
  void on_edges(const char* name, const std::vector<T>& field) {
    write_field<T>(name, mesh_.edge_order, field);
  }
  template<class T>
  void on_vertices_if_any(const char* name, const std::vector<T>& field) {
    if (any_of(mesh_.comm, !field.empty())) on_vertices(name, field);
  }
  template<class T>
  void on_edges_if_any(const char* name, const std::vector<T>& field) {
    if (any_of(mesh_.comm, !field.empty())) on_edges(name, field);
  }
  void on_contacts(const std::string& name, const ContactMemory& contacts) {
    std::vector<Global> keys;
    std::vector<double> forces, drifts;
    for (const auto& [key, entry] : contacts) {
      keys.insert(keys.end(), key.begin(), key.end());
      for (const ContactImpulse& p : {entry.pressed, entry.carried})
        forces.insert(forces.end(), {p.normal, p.tangent.x(), p.tangent.y(), p.tangent.z()});
      drifts.insert(drifts.end(), entry.drift.begin(), entry.drift.end());
    }
    const auto mine = Global(contacts.size());
    const Slab rows{exclusive_sum(mesh_.comm, mine), mine, sum_over(mesh_.comm, mine)};
    file_.write<Global>(name + "/keys", keys, 4, rows);
    file_.write<double>(name + "/forces", forces, 8, rows);
    file_.write<double>(name + "/drifts", drifts, 3, rows);
  }

private:
  template<class T>
  void write_field(const char* name, const OriginalOrder& order, const std::vector<T>& field) {
    const std::vector<T> rows = order.to_slab<T>(field);
    constexpr int columns = sizeof(T) / sizeof(double);
    const auto* numbers = reinterpret_cast<const double*>(rows.data());
    file_.write<double>(name, {numbers, rows.size() * columns}, columns, order.slab());
  }

  H5Writer& file_;
  const DistributedMesh& mesh_;
  std::string numbers_; ///< "name value" lines: one attribute costs no more than one number would
};

class Reading {
public:
  Reading(const H5Reader& file, const DistributedMesh& mesh) : file_(file), mesh_(mesh) {
    std::istringstream lines(file.attribute<std::string>(numbers_name));
    for (std::string name, value; lines >> name >> value;) numbers_[name] = value;
  }

  template<class Number>
  void operator()(const char* name, Number& value) {
    using Parsed = std::conditional_t<std::is_same_v<Number, bool>, int, Number>;
    const std::string& text = numbers_[name];
    Parsed parsed{};
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), parsed);
    if (error != std::errc{} || stop != text.data() + text.size())
      refuse(name, fmt::format("'{}' is not its value", text));
    value = Number(parsed);
  }

  void added_up(const char* name, std::vector<double>& values) {
    const Global total = file_.rows(name), mine = rank_of(mesh_.comm) == 0 ? total : 0;
    values = read_rows<double>(name, {0, mine, total});
    values.resize(total, 0.0);
  }
  void on_all_if_any(const char* name, std::vector<double>& values) {
    if (!file_.has(name)) return;
    added_up(name, values);
    sum_in_place(mesh_.comm, values);
  }
  template<class T>
  void on_vertices(const char* name, std::vector<T>& field) {
    read_field(name, mesh_.vertex_order, field, mesh_.vertices.size());
    mesh_.vertex_halo.update(field);
  }
  template<class T>
  void on_edges(const char* name, std::vector<T>& field) {
    read_field(name, mesh_.edge_order, field, mesh_.edges.size());
    mesh_.edge_halo.update(field);
  }
  template<class T>
  void on_vertices_if_any(const char* name, std::vector<T>& field) {
    if (file_.has(name)) on_vertices(name, field);
  }
  template<class T>
  void on_edges_if_any(const char* name, std::vector<T>& field) {
    if (file_.has(name)) on_edges(name, field);
  }
  void on_contacts(const std::string& name, ContactMemory& contacts) {
    const std::string keys_name = name + "/keys";
    const Slab rows = slab_of(file_.rows(keys_name), size_of(mesh_.comm), rank_of(mesh_.comm));
    const std::vector<ContactKey> keys = read_keys(keys_name, rows);
    const auto forces = read_rows<std::array<double, 8>>(name + "/forces", rows);
    const auto drifts = read_rows<Vec3>(name + "/drifts", rows);
    std::vector<ContactMemory::value_type> read; // in the order of whichever ranks wrote them
    for (std::size_t i = 0; i < keys.size(); ++i) {
      const auto& f = forces[i];
      read.push_back({keys[i], {{f[0], Vec3(f[1], f[2], f[3])}, {f[4], Vec3(f[5], f[6], f[7])}, drifts[i]}});
    }
    contacts = bring_home(mesh_, ContactMemory(read.begin(), read.end()));
  }

private:
  std::vector<ContactKey> read_keys(const std::string& name, Slab rows) const {
    if (file_.columns(name) != 4) refuse(name, "it does not have 4 columns");
    const std::vector<Global> numbers = file_.read<Global>(name, rows);
    std::vector<ContactKey> keys(rows.count);
    for (std::size_t i = 0; i < numbers.size(); ++i) keys[i / 4][i % 4] = numbers[i];
    const bool sound = std::all_of(keys.begin(), keys.end(), [&](const ContactKey& key) {
      return lowest_vertex(key) >= 0 && lowest_vertex(key) < mesh_.vertices.total;
    });
    if (any_of(mesh_.comm, !sound)) refuse(name, "it names a contact without the cloth");
    return keys;
  }

  template<class T>
  std::vector<T> read_rows(const std::string& name, Slab rows) {
    constexpr int columns = sizeof(T) / sizeof(double);
    if (file_.columns(name) != columns) refuse(name, fmt::format("it does not have {} columns", columns));
    const std::vector<double> numbers = file_.read<double>(name, rows);
    const bool finite =
        std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
    if (any_of(mesh_.comm, !finite)) refuse(name, "it holds a number that is not finite");
    std::vector<T> values(rows.count);
    std::copy(numbers.begin(), numbers.end(), reinterpret_cast<double*>(values.data()));
    return values;
  }
  template<class T>
  void read_field(const char* name, const OriginalOrder& order, std::vector<T>& field, Local size) {
    const std::vector<T> rows = read_rows<T>(name, order.slab());
    field.resize(size);
    order.from_slab<T>(rows, field);
  }
  [[noreturn]] void refuse(const std::string& name, const std::string& reason) const {
    throw InputError(fmt::format("{}: {}: {}; this is no sound checkpoint of the run", file_.path().string(),
                                 name, reason));
  }

  const H5Reader& file_;
  const DistributedMesh& mesh_;
  std::map<std::string, std::string> numbers_;
};

/// What no run leaves, though it is a number.
void check_values(const fs::path& path, const Checkpoint& c) {
  const auto require = [&](bool plausible, const char* name, auto value) {
    if (!plausible)
      throw InputError(fmt::format("{}: {}: {} cannot be its value; this is no sound checkpoint of the run",
                                   path.string(), name, value));
  };
  const auto is_length = [](double seconds) { return seconds >= 0 && std::isfinite(seconds); };
  require(is_length(c.state.time), "time", c.state.time);
  require(c.state.step >= 0, "step", c.state.step);
  require(is_length(c.state.previous_dt) && c.state.previous_dt <= c.state.time, "previous_dt",
          c.state.previous_dt);
  require(is_length(c.step_size.step) && c.step_size.step > 0, "longest_step", c.step_size.step);
  require(c.step_size.successes >= 0, "successes", c.step_size.successes);
  require(c.step_size.patience > 0, "patience", c.step_size.patience);
  require(c.rejected_steps >= 0, "rejected_steps", c.rejected_steps);
}

} // namespace

void write_checkpoint(const fs::path& path, const DistributedMesh& mesh, const CheckpointView& checkpoint) {
  write_whole(mesh.comm, path, [&](H5Writer& file) {
    file.attribute(checkpoint_format_name, checkpoint_format);
    file.attribute(case_name, checkpoint.case_text);
    Writing writing(file, mesh);
    visit_checkpoint(checkpoint, writing);
    file.attribute(numbers_name, writing.numbers());
    write_cut(file, mesh);
  });
}

Checkpoint read_checkpoint(const fs::path& path, const DistributedMesh& mesh) {
  const H5Reader file(mesh.comm, path, Checksum::required);
  check_checkpoint_format(file);
  Checkpoint checkpoint;
  checkpoint.case_text = file.attribute<std::string>(case_name);
  Reading reading(file, mesh);
  visit_checkpoint(checkpoint, reading);
  check_values(path, checkpoint);
  return checkpoint;
}

std::string read_case_of_checkpoint(MPI_Comm comm, const fs::path& path) {
  const H5Reader file(comm, path, Checksum::required);
  check_checkpoint_format(file);
  return file.attribute<std::string>(case_name);
}

fs::path checkpoint_file(const fs::path& run_folder, Global step) {
  return run_folder / "checkpoint" / fmt::format("step_{:09}.h5", step);
}

Global step_of_checkpoint(const fs::path& file) {
  const std::string name = file.stem().string();
  constexpr std::string_view prefix = "step_";
  Global step = -1;
  if (file.extension() != ".h5" || !name.starts_with(prefix)) return -1;
  const char* const end = name.data() + name.size();
  const auto [stop, error] = std::from_chars(name.data() + prefix.size(), end, step);
  return error == std::errc{} && stop == end ? step : -1;
}

std::vector<fs::path> checkpoints_in(const fs::path& run_folder) {
  std::vector<fs::path> files;
  std::error_code none; // no such folder: no checkpoints
  for (const auto& entry : fs::directory_iterator(run_folder / "checkpoint", none))
    if (step_of_checkpoint(entry.path()) >= 0) files.push_back(entry.path());
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return step_of_checkpoint(a) > step_of_checkpoint(b);
  });
  return files;
}

} // namespace taut
