#pragma once
#include "src/contact/box_tree.hpp"
#include "src/contact/obstacles.hpp"
#include "src/state/cloth.hpp"

namespace taut {

/// Where everything that can collide is, and where it is going.
struct Motion {
  std::span<const Vec3> cloth_from, cloth_to;         ///< m, of local vertices, ghosts current
  std::span<const Vec3> obstacles_from, obstacles_to; ///< m
};

/// A vertex of cloth or of an obstacle as all ranks know it.
struct SurfaceVertex {
  int owner;   ///< rank; obstacles belong to every rank
  Local place; ///< at its owner: number of the own cloth vertex, or cloth vertices + number in the obstacles
  Global key;  ///< does not depend on the partition: original number, or vertices of the cloth + number
};

/// Finds pairs of elements that can come near each other, over all ranks: cloth with itself and with
/// obstacles. A pair of elements of two ranks is found by one of them, by a rule that depends on their
/// numbers only; each rank learns the elements of others that come near its own, and no more.
class ElementSearch {
public:
  /// Both must outlive the search. Collective.
  ElementSearch(const Cloth& cloth, const Obstacles& obstacles);

  /// Finds all pairs whose distance can come down to `reach` (m) while all vertices move together along
  /// straight lines, by boxes and balls around them: a superset. Collective.
  void find(const Motion& motion, double reach);

  /// Calls visit(a, b, reach) for every pair found; vertices of the elements are places in the fields below.
  /// `reach` (m, radii in it) is how far apart they may be now to come near enough.
  template<class Visit>
  void for_each_pair(Visit&& visit) const {
    for (const auto& [group, pairs] :
         {std::pair{&own_, &own_pairs_}, {&bodies_, &body_pairs_}, {&received_, &received_pairs_}})
      for (const auto& [i, j] : *pairs) {
        const Ball &a = own_.balls[i], &b = group->balls[j];
        const double reach = reach_ + a.spread + b.spread + (a.motion - b.motion).norm() + b.thickness;
        const double apart = a.radius + b.radius + reach;
        if ((a.centre - b.centre).squaredNorm() <= apart * apart)
          visit(own_.elements[i], group->elements[j], reach);
      }
  }

  /// Of local cloth vertices, then of obstacles, then of what came from other ranks.
  std::span<const SurfaceVertex> vertices() const { return vertices_; }
  std::span<const Vec3> positions() const { return x_; } ///< m
  std::span<const Vec3> displacements() const {          ///< m, less the mean of the cloth
    return u_;
  }

private:
  struct SentElement {
    Element element;
    std::array<SurfaceVertex, 3> vertices;
    std::array<Vec3, 3> x, u;
  };
  struct Ball {
    Vec3 centre, motion; ///< means over the vertices, m
    double radius;       ///< m
    double spread;       ///< m that the vertices' motions differ from the mean at most
    double thickness;    ///< m, the radius of an obstacle
  };
  /// The elements of one source; their vertices are places in `vertices_`.
  struct Group {
    std::vector<Element> elements;
    std::vector<Box> boxes;
    std::vector<Ball> balls;
    BoxTree tree;
  };

  void take_positions(const Motion& motion);
  void bound(Group& group) const;
  Ball ball_around(const Element& element) const;
  void receive_elements();
  void append_elements_near(std::span<const Box> blocks, std::vector<SentElement>& found) const;

  const Cloth& cloth_;
  const Obstacles& obstacles_;
  std::vector<SurfaceVertex> known_; ///< the part of `vertices_` that stays
  std::vector<SurfaceVertex> vertices_;
  std::vector<Vec3> x_, u_;
  double reach_ = 0;
  Group own_, bodies_, received_;
  std::vector<BoxPair> own_pairs_, body_pairs_, received_pairs_; ///< the first of each is one of `own_`
};

} // namespace taut
