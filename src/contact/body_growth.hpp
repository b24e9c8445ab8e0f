#pragma once
#include "src/contact/obstacles.hpp"

#include <filesystem>

/// Bodies that grow from slim to full in a garment, and stay back where it is too tight for them.
namespace taut {

/// How they go on from a state: each vertex at the pace 1 - p/q of its body's time of growth, by the pressure
/// p of the cloth on it and that to which it gives way, q = P (1 + d/2cm), or back again, by at most that
/// pace. P is that of config::Growth, d how far the vertex stays back. So a garment has time to slide to
/// where it is wide enough, and where it never is, the body stays back as a soft one is pressed in. Where q
/// was P, all the same how far, nothing kept a belt where it was: a body gave way to one side of it by 87 mm,
/// by 11 mm now. p is the mean over about two edges of the cloth around. The same on all ranks. Collective.
BodyGrowth growth_after(const Cloth& cloth, const Obstacles& obstacles, const State& state);

/// Whether nothing grows any more, or only as slowly as what presses makes way.
bool has_grown(const Obstacles& obstacles, const State& state);

/// What bodies are short of.
struct HeldBack {
  std::vector<Vec3> ways;    ///< m, of the vertices of a body, from where they would be
  Global vertices = 0;       ///< that are held back by more than a tenth of a millimetre
  double farthest = 0;       ///< m
  Vec3 place = Vec3::Zero(); ///< m, where that is
};
HeldBack held_back(const Obstacles& obstacles, int body, double time);

/// Ways of the vertices of a body (m) in a file. Collective; throw InputError.
void write_ways(MPI_Comm comm, const std::filesystem::path& file, std::span<const Vec3> ways);
std::vector<Vec3> read_ways(MPI_Comm comm, const std::filesystem::path& file, std::size_t vertices);

} // namespace taut
