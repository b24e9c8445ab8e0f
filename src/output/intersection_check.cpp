#include "src/output/intersection_check.hpp"

#include "io/whole_file.hpp"

#include <fmt/format.h>

namespace taut {

namespace {

std::string edge_name(const std::array<Global, 2>& ends) {
  return ends[0] == ends[1] ? fmt::format("vertex {}", ends[0]) : fmt::format("edge {}-{}", ends[0], ends[1]);
}

std::string describe(const Intersection& i, const Cloth& cloth, const Obstacles& obstacles, double time) {
  const bool first_is_cloth = i.first[0] < cloth.mesh.vertices.total;
  const std::string other = i.body >= 0 ? obstacles.body(i.body).name : "the face at " + edge_name(i.second);
  return fmt::format("{} of the cloth and {} intersect at ({:.4g}, {:.4g}, {:.4g}) m, t = {:.6g} s",
                     edge_name(first_is_cloth ? i.first : i.second), other, i.place[0], i.place[1],
                     i.place[2], time);
}

} // namespace

IntersectionCheck::IntersectionCheck(const Cloth& cloth, const Obstacles& obstacles, const Case& input)
    : cloth_(cloth), when_(input.contact.value_or(config::Contact{}).check), obstacles_(obstacles) {}

bool IntersectionCheck::finds_in(const State& state, const std::filesystem::path& file) {
  count_intersections(state);
  if (count_ == 0) return false;
  std::error_code ignored; // writing the file will tell
  if (rank_of(cloth_.mesh.comm) == 0 && file.has_parent_path())
    std::filesystem::create_directories(file.parent_path(), ignored);
  write_text_whole(cloth_.mesh.comm, file, findings());
  return true;
}

void IntersectionCheck::refuse(const State& state, const std::filesystem::path& file) {
  if (!finds_in(state, file)) return;
  throw InputError(fmt::format(
      "the cloth starts with {} intersections; the first: {}; all of them are in {}, "
      "for ParaView; move `start` of the cloth or the obstacle, repair the start shape, or, where they "
      "are shallow, give contact.start: untangle",
      count_, first_, file.string()));
}

void IntersectionCheck::after_step(const State& state, const StepRecord&) {
  if (when_ == config::CheckAt::step) count_intersections(state);
}

void IntersectionCheck::after_frame(const State& state, Global) {
  if (when_ == config::CheckAt::frame) count_intersections(state);
}

void IntersectionCheck::count_intersections(const State& state) {
  obstacles_.place(state.time, bodies_);
  if (!test_) test_.emplace(cloth_, obstacles_);
  const auto found = test_->find(state.positions, bodies_);
  const MPI_Comm comm = cloth_.mesh.comm;
  const Global now = sum_over(comm, Global(found.size()));
  if (now > 0 && count_ == 0) {
    const int speaker = int(-max_over(comm, Global(found.empty() ? -size_of(comm) : -rank_of(comm))));
    first_ = broadcast_text(
        comm, found.empty() ? "" : describe(found.front(), cloth_, obstacles_, state.time), speaker);
    findings_ = found;
  }
  count_ += now;
}

} // namespace taut
