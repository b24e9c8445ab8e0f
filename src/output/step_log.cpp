#include "src/output/step_log.hpp"

#include "io/whole_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <sstream>

namespace taut {

namespace {

using Row = std::vector<std::string>;

Row columns_for(const std::vector<std::string>& potentials, std::size_t pins) {
  Row columns{"step",
              "time_s",
              "dt_s",
              "rejected",
              "strain_max",
              "strain_rms",
              "depth_m",
              "projection_iterations",
              "projection_ksp_iterations",
              "velocity_ksp_iterations",
              "residual",
              "contacts",
              "kinetic_J"};
  for (const std::string& p : potentials) columns.push_back(p + "_J");
  columns.insert(columns.end(), {"velocity_s", "projection_s", "contact_s"});
  for (std::size_t k = 0; k < pins; ++k)
    for (const char axis : {'x', 'y', 'z'}) columns.push_back(fmt::format("pin{}_{}_N", k, axis));
  return columns;
}

Row split(const std::string& line) {
  Row cells{""};
  for (const char c : line) {
    if (c == ',')
      cells.emplace_back();
    else
      cells.back() += c;
  }
  return cells;
}

/// The next row that is whole, or an empty one: a run that was cut off may have left half a row at the end.
Row next_row(std::istream& in) {
  std::string line;
  if (!std::getline(in, line) || in.eof()) return {};
  return split(line);
}

/// The rows up to `last_step` as text, their cells in the order of `columns`; a column the file does not have
/// stays empty.
std::string rows_so_far(std::istream& in, const Row& columns, Global last_step) {
  const Row header = next_row(in);
  std::string text;
  for (Row row = next_row(in); !row.empty(); row = next_row(in)) {
    if (row.size() != header.size() || std::atoll(row[0].c_str()) > last_step) continue;
    Row cells;
    for (const std::string& c : columns) {
      const auto place = std::find(header.begin(), header.end(), c);
      cells.push_back(place == header.end() ? "" : row[place - header.begin()]);
    }
    text += fmt::format("{}\n", fmt::join(cells, ","));
  }
  return text;
}

std::string cannot_be_written(const std::filesystem::path& file) {
  return fmt::format("{}: cannot be written: {}; {}", file.string(), std::strerror(errno), writing_cure);
}

} // namespace

StepLog::StepLog(MPI_Comm comm, std::filesystem::path file, const std::vector<std::string>& potentials,
                 std::size_t pins, Global last_step)
    : comm_(comm), file_(std::move(file)) {
  std::string text;
  if (rank_of(comm) == 0) {
    const Row columns = columns_for(potentials, pins);
    text = fmt::format("{}\n", fmt::join(columns, ","));
    std::ifstream in(file_);
    if (last_step > 0) text += rows_so_far(in, columns, last_step);
  }
  write_text_whole(comm, file_, text);
  on_rank_0(comm, [&] {
    out_.open(file_, std::ios::app);
    if (!out_) throw InputError(cannot_be_written(file_));
  });
}

void StepLog::after_step(const State& state, const StepRecord& r) {
  std::optional<std::string> fault;
  if (out_.is_open()) {
    out_ << fmt::format("{},{:.9g},{:.9g},{},{:.6g},{:.6g},{:.9g},{},{},{},{:.4g},{},{:.9g}", state.step,
                        state.time, r.dt, r.rejected, r.strain.max, r.strain.rms, r.depth,
                        r.counts.iterations, r.counts.linear_iterations, r.counts.velocity_iterations,
                        r.residual, r.counts.contacts, r.energies.kinetic);
    for (const double e : r.energies.potential) out_ << fmt::format(",{:.9g}", e);
    out_ << fmt::format(",{:.4g},{:.4g},{:.4g}", r.counts.velocity_seconds, r.counts.projection_seconds,
                        r.counts.contact_seconds);
    for (const Vec3& f : r.pin_forces) out_ << fmt::format(",{:.6g},{:.6g},{:.6g}", f[0], f[1], f[2]);
    out_ << '\n';
    if (!out_.flush()) fault = cannot_be_written(file_);
  }
  agree(comm_, fault);
}

} // namespace taut
