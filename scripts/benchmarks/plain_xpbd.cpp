// The cloth of cases/two-pins by plain XPBD, as a game engine has it: plain_xpbd SIDE SUBSTEPS END
//
// Extended position-based dynamics with small substeps [Macklin et al. 2019, algorithm 1, one iteration]: a
// square of 1 m, SIDE x SIDE vertices, two corners held, let go flat; sides of quads as constraints without
// compliance, and nothing else: no shear, no bending, no damping. A substep solves the edges of one colour
// after another: first those of the warp with an even column, then odd, then the weft. In the order of the
// mesh it diverges on fine ones. SUBSTEPS are those of 10 ms. Prints, as JSON, CPU seconds a simulated
// second, the largest strain at the end of any 10 ms, and how deep the lowest vertex came.
#include <Eigen/Core>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

namespace {

using Vec3 = Eigen::Vector3d;

class Sheet {
public:
  explicit Sheet(int side)
      : side_(side), length_(1.0 / (side - 1)), v_(std::size_t(side) * side, Vec3::Zero()) {
    for (int i = 0; i < side; ++i)
      for (int j = 0; j < side; ++j) x_.emplace_back(j * length_, i * length_, 0.0);
    old_ = x_;
    free_.assign(x_.size(), 1.0);
    free_[0] = free_[std::size_t(side) - 1] = 0.0;
  }

  void substep(double h) {
    for (std::size_t k = 0; k < x_.size(); ++k) {
      old_[k] = x_[k];
      v_[k].z() -= free_[k] * 9.81 * h;
      x_[k] += h * v_[k];
    }
    for (int colour = 0; colour < 2; ++colour)
      for (int i = 0; i < side_; ++i)
        for (int j = colour; j + 1 < side_; j += 2) project(place(i, j), place(i, j + 1));
    for (int colour = 0; colour < 2; ++colour)
      for (int i = colour; i + 1 < side_; i += 2)
        for (int j = 0; j < side_; ++j) project(place(i, j), place(i + 1, j));
    for (std::size_t k = 0; k < x_.size(); ++k) v_[k] = (x_[k] - old_[k]) / h;
  }

  double strain() const {
    double most = 0;
    const auto measure = [&](std::size_t a, std::size_t b) {
      const double strain = std::abs((x_[b] - x_[a]).norm() / length_ - 1.0);
      most = strain <= most ? most : strain; // a NaN stays
    };
    for (int i = 0; i < side_; ++i)
      for (int j = 0; j < side_; ++j) {
        if (j + 1 < side_) measure(place(i, j), place(i, j + 1));
        if (i + 1 < side_) measure(place(i, j), place(i + 1, j));
      }
    return most;
  }

  double depth() const {
    double depth = 0;
    for (const Vec3& x : x_) depth = std::max(depth, -x.z());
    return depth;
  }

private:
  std::size_t place(int i, int j) const { return std::size_t(i) * side_ + j; }

  void project(std::size_t a, std::size_t b) {
    const double weights = free_[a] + free_[b];
    if (weights == 0) return;
    const Vec3 d = x_[b] - x_[a];
    const double norm = d.norm();
    const Vec3 step = (norm - length_) / (norm * weights) * d;
    x_[a] += free_[a] * step;
    x_[b] -= free_[b] * step;
  }

  int side_;
  double length_; ///< of an edge, m
  std::vector<Vec3> x_, old_, v_;
  std::vector<double> free_; ///< 0: held; masses are equal, as along the border nothing asks for others
};

} // namespace

int main(int argc, char** argv) {
  const int side = argc > 1 ? std::atoi(argv[1]) : 0, substeps = argc > 2 ? std::atoi(argv[2]) : 0;
  const double end = argc > 3 ? std::atof(argv[3]) : 0;
  if (side < 2 || substeps < 1 || !(end > 0)) {
    std::fputs("usage: plain_xpbd SIDE SUBSTEPS END\n", stderr);
    return 2;
  }
  constexpr double step = 0.01; // s
  const int steps = int(std::lround(end / step));
  Sheet sheet(side);
  double strain = 0, depth = 0;
  const std::clock_t began = std::clock();
  for (int k = 0; k < steps; ++k) {
    for (int s = 0; s < substeps; ++s) sheet.substep(step / substeps);
    const double now = sheet.strain();
    strain = now <= strain ? strain : now;
    depth = std::max(depth, sheet.depth());
  }
  const double cpu = double(std::clock() - began) / CLOCKS_PER_SEC;
  std::printf("{\"side\": %d, \"substeps\": %d, \"cpu_s_per_s\": %.6g, \"strain\": %.6g, \"depth\": %.6g}\n",
              side, substeps, cpu / end, std::isfinite(strain) ? strain : 1e300, depth);
}
