#include "src/forces/folds.hpp"

#include "partition/triangle_hinges.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace taut {

namespace {

// On regular meshes eigenvalues are up to 1.7 B (squares cut along one diagonal).
constexpr double largest_over_rigidity = 4;
// On squares cut in turn the first form gives way by a third in bending, the second is twice too stiff in
// twist; so mixed they have the product of both of a plate, which is what counts in lateral buckling.
constexpr double share_of_quadratics = 0.75;
// Of stiffnesses, so that those that are zero can be inverted.
constexpr double smallest_over_largest = 1e-3;

bool is_left(const TriangleStencil& t, std::size_t k) { return t.place[k][2] < 3; }

/// Where an apex of a fold lies (corner 2, left, or 3, right) if its edge runs from `a` to `b`. `hand` is 1,
/// or -1 where weft lies to the right of warp.
Vec2 apex_beside(const HingeStencil& f, int corner, const Vec2& a, const Vec2& b, int hand) {
  const Vec3 e = (f.rest[1] - f.rest[0]).normalized(), to_apex = f.rest[corner] - f.rest[0];
  const Vec2 along = (b - a).normalized(), left(-hand * along[1], hand * along[0]);
  const double height = (to_apex - to_apex.dot(e) * e).norm();
  return a + to_apex.dot(e) * along + (corner == 2 ? height : -height) * left;
}

/// The triangle in its plane, along warp and weft.
std::array<Vec2, 3> unfold_triangle(const TriangleStencil& t, std::span<const HingeStencil> hinges,
                                    int hand) {
  const HingeStencil& first = hinges[std::size_t(t.folds[0])];
  const Vec2 a = Vec2::Zero(), b = first.length() * first.run;
  return {a, b, apex_beside(first, is_left(t, 0) ? 2 : 3, a, b, hand)};
}

/// A texture may show a face from behind: weft then lies to the right of warp. The second fold tells.
int hand_of(const TriangleStencil& t, std::span<const HingeStencil> hinges) {
  if (t.folds[1] < 0) return 1;
  const auto alignment = [&](int hand) {
    const auto x = unfold_triangle(t, hinges, hand);
    const Vec2 edge = x[std::size_t(t.place[1][1])] - x[std::size_t(t.place[1][0])];
    return edge.dot(hinges[std::size_t(t.folds[1])].run);
  };
  return alignment(1) >= alignment(-1) ? 1 : -1;
}

/// The patch in its plane: where its six vertices lie along warp and weft.
std::array<Vec2, 6> unfold(const TriangleStencil& t, std::span<const HingeStencil> hinges) {
  const int hand = hand_of(t, hinges);
  const auto [a, b, c] = unfold_triangle(t, hinges, hand);
  std::array<Vec2, 6> x{a, b, c, c, c, c};
  for (std::size_t k = 0; k < 3 && t.folds[k] >= 0; ++k)
    x[3 + k] = apex_beside(hinges[std::size_t(t.folds[k])], is_left(t, k) ? 3 : 2,
                           x[std::size_t(t.place[k][0])], x[std::size_t(t.place[k][1])], hand);
  return x;
}

/// z over fold k for p = 1, q = 1, s = 1: its row applied to u^2/2, v^2/2 and u v.
Eigen::RowVector3d curvature_of_quadratics(const HingeStencil& f, const TriangleStencil& t, std::size_t k,
                                           const std::array<Vec2, 6>& x) {
  Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
  const auto row = isometric_row(f.rest);
  const std::size_t far = is_left(t, k) ? 3 : 2;
  for (std::size_t c = 0; c < 4; ++c) {
    const Vec2& at = x[c == far ? 3 + k : std::size_t(t.place[k][c])];
    sum += row[c] * Eigen::RowVector3d(0.5 * at[0] * at[0], 0.5 * at[1] * at[1], at[0] * at[1]);
  }
  return sum / f.area;
}

using Form = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;
using Map = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 3, 3>; ///< between folds and (p, q, s)

/// A/2 z^T (R D^-1 R^T)^-1 z, without A/2.
Form form_of_quadratics(const Map& r, const Vec3& d) {
  const Form compliance = r * d.cwiseInverse().asDiagonal() * r.transpose();
  const Eigen::SelfAdjointEigenSolver<Form> modes(compliance);
  const auto stiffness = modes.eigenvalues().cwiseInverse().cwiseMin(largest_over_rigidity * d.maxCoeff());
  return modes.eigenvectors() * stiffness.asDiagonal() * modes.eigenvectors().transpose();
}

/// A/2 k^T D k for k = sum z_e A_e / 2A n_e n_e^T, without A/2. At a border the turn over it is what costs
/// least.
Form form_in_equilibrium(const TriangleStencil& t, std::span<const HingeStencil> hinges, Eigen::Index n,
                         const std::array<Vec2, 6>& x, const Vec3& d, double area) {
  Map g(n, 3), border(3 - n, 3);
  const auto square = [](const Vec2& a, const Vec2& b) { // p, q, s of n n^T
    const Vec2 along = (b - a).normalized();
    return Eigen::RowVector3d(along[1] * along[1], along[0] * along[0], -along[0] * along[1]);
  };
  std::array<bool, 3> is_inner{};
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto& place = t.place[std::size_t(k)];
    g.row(k) = hinges[std::size_t(t.folds[std::size_t(k)])].area / (2 * area) *
               square(x[std::size_t(place[0])], x[std::size_t(place[1])]);
    is_inner[std::size_t(3 - place[0] - place[1])] = true; // the side opposite to this corner
  }
  for (std::size_t c = 0, k = 0; c < 3; ++c)
    if (!is_inner[c]) border.row(Eigen::Index(k++)) = square(x[(c + 1) % 3], x[(c + 2) % 3]);
  const auto rigidity = d.asDiagonal();
  const Form known = g * rigidity * g.transpose();
  if (n == 3) return known;
  const Form coupled = g * rigidity * border.transpose(), free = border * rigidity * border.transpose();
  return known - coupled * free.inverse() * coupled.transpose();
}

/// Fills `rows` of the stencil, see folds_of.
void find_rows(TriangleStencil& t, std::span<const HingeStencil> hinges, const Rigidity& b) {
  const auto x = unfold(t, hinges);
  const Eigen::Index n = std::count_if(t.folds.begin(), t.folds.end(), [](auto k) { return k >= 0; });
  Map r(n, 3);
  for (Eigen::Index k = 0; k < n; ++k)
    r.row(k) = curvature_of_quadratics(hinges[std::size_t(t.folds[std::size_t(k)])], t, std::size_t(k), x);
  Vec3 d(b.warp, b.weft, 2 * b.twist);
  d = d.cwiseMax(smallest_over_largest * d.maxCoeff());
  const double area = 0.5 * std::abs(x[1][0] * x[2][1] - x[1][1] * x[2][0]);
  const Form form = share_of_quadratics * form_of_quadratics(r, d) +
                    (1 - share_of_quadratics) * form_in_equilibrium(t, hinges, n, x, d, area);
  const Eigen::SelfAdjointEigenSolver<Form> modes(form);
  for (Eigen::Index m = 0; m < n; ++m)
    for (Eigen::Index k = 0; k < n; ++k)
      t.rows[std::size_t(m)][std::size_t(k)] =
          std::sqrt(area * std::max(modes.eigenvalues()[m], 0.0)) * modes.eigenvectors()(k, m);
}

/// Without its rows.
TriangleStencil stencil_of(const TrianglePatch& patch, const DistributedMesh& mesh,
                           std::span<const std::int32_t> fold_of_hinge) {
  TriangleStencil t{patch.vertices, {-1, -1, -1}, {}, {}};
  for (std::size_t k = 0; k < 3 && patch.hinges[k] >= 0; ++k) {
    const Hinge& h = mesh.hinges[std::size_t(patch.hinges[k])];
    t.folds[k] = fold_of_hinge[std::size_t(patch.hinges[k])];
    const std::array<Local, 4> corners{h.edge[0], h.edge[1], h.left[0], h.right[0]};
    for (std::size_t c = 0; c < 4; ++c)
      t.place[k][c] = int(std::find(t.vertices.begin(), t.vertices.end(), corners[c]) - t.vertices.begin());
  }
  return t;
}

double along_edge(const Rigidity& b, const Vec2& run) {
  return b.warp * run[1] * run[1] + b.weft * run[0] * run[0];
}

/// Between two faces, halfway.
Rigidity mean(const Rigidity& a, const Rigidity& b) {
  return {0.5 * (a.warp + b.warp), 0.5 * (a.weft + b.weft), 0.5 * (a.twist + b.twist),
          0.5 * (a.seam + b.seam)};
}

bool is_on_seam(const Cloth& cloth, const Hinge& hinge) {
  const Piece& piece = cloth.pieces[cloth.piece_of(hinge.edge[0])];
  const auto has = [&](const garment::NamedSeam& s, Local v) {
    return std::binary_search(s.vertices.begin(), s.vertices.end(),
                              cloth.mesh.vertices.original[v] - piece.first_vertex);
  };
  const auto& seams = piece.parts.seams;
  return std::any_of(seams.begin(), seams.end(),
                     [&](const auto& s) { return has(s, hinge.edge[0]) && has(s, hinge.edge[1]); });
}

/// Of the angle: of the area that the fold has for itself, and what a seam is stiffer.
double stiffness_of(const HingeStencil& f, const Rigidity& b, double alone, bool on_seam) {
  const double own = along_edge(b, f.run), squared_length = (f.rest[1] - f.rest[0]).squaredNorm();
  double stiffness = 0;
  if (alone >= 1e-6 * f.area) stiffness = own * squared_length / (f.area * f.area) * alone;
  if (on_seam) stiffness += std::max(b.seam - own, 0.0) * squared_length / f.area;
  return stiffness;
}

} // namespace

Folds folds_of(const Cloth& cloth, const PerSection<Rigidity>& rigidity) {
  const DistributedMesh& mesh = cloth.mesh;
  const auto rigidity_of = [&](Global cell) { return rigidity.of(cloth.section_of(cell)); };
  Folds folds;
  std::vector<std::int32_t> fold_of_hinge(mesh.hinges.size(), -1);
  std::vector<double> alone; // area that a fold has for itself
  for (std::size_t k = 0; k < mesh.hinges.size(); ++k) {
    if (!rigidity_of(mesh.hinges[k].cells[0])) continue;
    fold_of_hinge[k] = std::int32_t(folds.hinges.size());
    alone.push_back(folds.hinges.emplace_back(hinge_stencil(mesh, mesh.hinges[k])).area);
  }
  for (const TrianglePatch& patch : triangle_patches(mesh)) {
    TriangleStencil t = stencil_of(patch, mesh, fold_of_hinge);
    const auto b = rigidity_of(mesh.hinges[std::size_t(patch.hinges[0])].cells[is_left(t, 0) ? 0 : 1]);
    if (!b) continue;
    if (std::max({b->warp, b->weft, b->twist}) > 0) find_rows(t, folds.hinges, *b);
    for (std::size_t k = 0; k < 3 && t.folds[k] >= 0; ++k)
      alone[std::size_t(t.folds[k])] -=
          folds.hinges[std::size_t(t.folds[k])].area_of_side(is_left(t, k) ? 0 : 1);
    folds.triangles.push_back(t);
  }
  for (std::size_t k = 0; k < mesh.hinges.size(); ++k) {
    if (fold_of_hinge[k] < 0) continue;
    const auto fold = std::size_t(fold_of_hinge[k]);
    const auto& [left, right] = mesh.hinges[k].cells;
    const Rigidity b = mean(*rigidity_of(left), *rigidity_of(right));
    folds.hinges[fold].stiffness =
        stiffness_of(folds.hinges[fold], b, alone[fold], b.seam > 0 && is_on_seam(cloth, mesh.hinges[k]));
  }
  return folds;
}

} // namespace taut
