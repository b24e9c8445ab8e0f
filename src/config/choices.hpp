#pragma once
#include <array>
#include <string_view>

/// What a case can choose between, and the words for it.
namespace taut::config {

enum class LinearSolver { cg, mumps };
enum class ConstraintSolver { projected, modified_cg };
enum class Integrator { implicit_euler, bdf2, imex };
enum class InextensibilityMethod {
  fast_projection,
  newton,
  icd,
  sap,
  shake,
  rattle,
  jacobi,
  gauss_seidel,
  xpbd,
  springs,
  none
};
enum class Constrain { edges, vertices };
enum class ShakeMatrix { newton, lagged };
enum class ContactModel { constraint, impulse, penalty, none };
enum class FilterOrder { contact_last, contact_first };
enum class StartContact { refuse, untangle };
enum class CheckAt { frame, step, none };
enum class GridCells { quads, triangles, alternating_triangles };
enum class ShearModel { baraff_witkin, diagonals };
enum class BendingModel { yarn, isometric, discrete_shells, baraff_witkin };
enum class RestAngles { flat, mesh };
enum class RestShape { mesh, texture };
enum class PartitionMethod { metis, ptscotch, stripes };
enum class Field { position, velocity, owner_rank, strain, tension, reaction, contact, yarn };
enum class FrameFormat { xdmf, pc2 };
enum class UpAxis { y, z };

/// The words of a choice in the case file, in the order of the enumerators.
constexpr std::array<std::string_view, 2> words_of(LinearSolver) { return {"cg", "mumps"}; }
constexpr std::array<std::string_view, 3> words_of(Integrator) { return {"implicit_euler", "bdf2", "imex"}; }
constexpr std::array<std::string_view, 11> words_of(InextensibilityMethod) {
  return {"fast_projection", "newton",       "icd",  "sap",     "shake", "rattle",
          "jacobi",          "gauss_seidel", "xpbd", "springs", "none"};
}
constexpr std::array<std::string_view, 2> words_of(Constrain) { return {"edges", "vertices"}; }
constexpr std::array<std::string_view, 2> words_of(ShakeMatrix) { return {"newton", "lagged"}; }
constexpr std::array<std::string_view, 4> words_of(ContactModel) {
  return {"constraint", "impulse", "penalty", "none"};
}
constexpr std::array<std::string_view, 2> words_of(FilterOrder) { return {"contact_last", "contact_first"}; }
constexpr std::array<std::string_view, 2> words_of(StartContact) { return {"refuse", "untangle"}; }
constexpr std::array<std::string_view, 3> words_of(CheckAt) { return {"frame", "step", "none"}; }
constexpr std::array<std::string_view, 3> words_of(GridCells) {
  return {"quads", "triangles", "alternating_triangles"};
}
constexpr std::array<std::string_view, 2> words_of(ShearModel) { return {"baraff_witkin", "diagonals"}; }
constexpr std::array<std::string_view, 4> words_of(BendingModel) {
  return {"yarn", "isometric", "discrete_shells", "baraff_witkin"};
}
constexpr std::array<std::string_view, 2> words_of(RestAngles) { return {"flat", "mesh"}; }
constexpr std::array<std::string_view, 2> words_of(RestShape) { return {"mesh", "texture"}; }
constexpr std::array<std::string_view, 2> words_of(ConstraintSolver) { return {"projected", "modified_cg"}; }
constexpr std::array<std::string_view, 3> words_of(PartitionMethod) {
  return {"metis", "ptscotch", "stripes"};
}
constexpr std::array<std::string_view, 8> words_of(Field) {
  return {"position", "velocity", "owner_rank", "strain", "tension", "reaction", "contact", "yarn"};
}
constexpr std::array<std::string_view, 2> words_of(FrameFormat) { return {"xdmf", "pc2"}; }
constexpr std::array<std::string_view, 2> words_of(UpAxis) { return {"y", "z"}; }

template<class Choice>
constexpr std::string_view word_of(Choice choice) {
  return words_of(choice)[std::size_t(choice)];
}

} // namespace taut::config
