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
  int owner;    ///< rank; obstacles belong to every rank
  Local place;  ///< at its owner: number of the own cloth vertex, or cloth vertices + number in the obstacles
  Global key;   ///< does not depend on the partition: original number, or vertices of the cloth + number
  Global joint; ///< the key of what it is sewn to, or its own: vertices with the same are one for contact
};

/// Finds pairs of elements that can come near each other, over all ranks: cloth with itself and with
/// obstacles. A pair of elements of two ranks is found by one of them, by a rule that depends on their
/// numbers only; each rank learns the elements of others that come near its own, and no more.
class ElementSearch {
public:
  /// Both must outlive the search. Obstacles stop `strings` of this rank as they stop edges; nothing else
  /// does. Collective.
  ElementSearch(const Cloth& cloth, const Obstacles& obstacles, std::span<const Element> strings = {});

  /// Finds all pairs whose distance can come down to `reach` (m) while all vertices move together along
  /// straight lines, to where the motion ends or, of cloth, anywhere within `slack` (m) of that, by boxes
  /// around them: a superset. Any motion will do; where the boxes made for motions before hold this one too,
  /// their pairs are kept [BW98 section 6, coherency]. Collective.
  void find(const Motion& motion, double reach, double slack);

  /// The motion starts somewhere on the way of the one before, and ends elsewhere. Appends to the pairs what
  /// is near where elements left their boxes, and makes those across ranks anew. Collective.
  void follow(const Motion& motion);

  /// m by which two elements end nearer to each other than by the motion before, at most.
  double strayed(const BoxPair& pair) const {
    const Common &a = strays_[pair.first], &b = strays_[pair.second];
    return (a.mean - b.mean).norm() + a.spread + b.spread;
  }

  /// Whether the boxes around what two elements sweep overlap; the slack aside.
  bool meets(const BoxPair& pair) const { return swept_[pair.first].overlaps(swept_[pair.second]); }

  /// The pairs of elements of this rank's cloth with each other and with obstacles; the first is cloth.
  std::span<const BoxPair> pairs() const { return pairs_; }

  /// The pairs of an element of this rank's cloth and one of another's.
  std::span<const BoxPair> pairs_across() const { return pairs_across_; }

  /// Its vertices are places in the fields below.
  const Element& element(Local k) const { return elements_[k]; }

  /// How far apart the features of two elements may be and still come down to `reach`, the slack aside.
  struct Range {
    double near; ///< m, where the motion ends
    double far;  ///< m, now; radii of obstacles in it
  };
  Range range(const BoxPair& pair) const {
    const Ball &a = balls_[pair.first], &b = balls_[pair.second];
    return {reach_, reach_ + a.motion.spread + b.motion.spread + (a.motion.mean - b.motion.mean).norm() +
                        b.thickness};
  }

  /// The joints of its vertices; beyond its corners there are none.
  const std::array<Global, 3>& joints(Local k) const { return joints_[k]; }

  /// Of length 1, between the middles of two elements.
  Vec3 direction(const BoxPair& pair) const {
    return (balls_[pair.first].centre - balls_[pair.second].centre).normalized();
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
    Box box;
  };
  /// Of what an element's vertices do.
  struct Common {
    Vec3 mean;     ///< m
    double spread; ///< m that a vertex differs from it at most
  };
  struct Ball {
    Vec3 centre; ///< m
    Common motion;
    double thickness; ///< m, the radius of an obstacle
  };

  bool may_meet(Local i, Local j) const;
  static Common common_to(const Element& element, std::span<const Vec3> of_vertices);
  void take_motion(const Motion& motion);
  void begin();
  std::vector<Local> outgrown() const;
  void extend(const std::vector<Local>& grown);
  Ball ball_around(const Element& element) const;
  double radius_of(const Element& element) const; ///< m, of an obstacle's
  Box box_around(const Element& element, std::span<const Box> of_vertices) const;
  std::vector<Box> boxes_at(std::span<const Local> elements) const;
  void find_across();
  void receive_elements();
  void append_elements_near(std::span<const Box> blocks, std::vector<SentElement>& found) const;

  const Cloth& cloth_;
  const Obstacles& obstacles_;
  std::vector<SurfaceVertex> known_; ///< the part of `vertices_` that stays
  std::vector<SurfaceVertex> vertices_;
  std::vector<Vec3> x_, u_;
  std::vector<Vec3> ends_; ///< m, of what is known; in a frame that moves like the cloth on the mean
  double reach_ = 0, slack_ = 0;
  std::vector<Element> elements_; ///< of this rank's cloth, of the obstacles, from other ranks
  std::vector<std::array<Global, 3>> joints_;
  Local cells_, own_, known_elements_; ///< so many are of this rank's cells, with strings, with obstacles
  std::vector<Box> swept_;             ///< by elements, in that frame
  std::vector<Box> boxes_;             ///< of what is known, with room around what is swept
  BoxTree own_tree_, obstacle_tree_;   ///< as the boxes were made
  std::vector<Local> grown_;           ///< elements whose boxes have grown since, in order
  std::vector<bool> is_grown_;
  std::vector<Ball> balls_;
  std::vector<Common> strays_; ///< of where elements end from where they ended by the motion before
  std::vector<BoxPair> pairs_, pairs_across_;
};

} // namespace taut
