#pragma once
#include "src/config/case.hpp"
#include "src/contact/surface.hpp"
#include "src/state/state.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>

namespace taut {

/// The bodies that cloth collides with, held whole on every rank: planes, and points, segments and triangles
/// with a radius around them (a sphere is a point, a capsule a segment). Surfaces have two sides: which way a
/// mesh is oriented, and whether it is closed, does not matter.
class Obstacles {
public:
  /// Reads the meshes. Throws InputError for what is wrong with them. Collective.
  Obstacles(MPI_Comm comm, const Case& input);

  /// A half-space: cloth stays on the side `normal` points to.
  struct Plane {
    Local point; ///< a vertex that lies on it
    Vec3 normal; ///< of length 1
    int body;
  };

  struct Body {
    std::string name;
    double radius;         ///< m around its vertices, segments or triangles; the body's thickness is in it
    double friction;       ///< Coulomb's coefficient against cloth
    bool is_round = false; ///< made of points or segments: a sphere, a capsule
    Global rims = 0;       ///< edges of a mesh that have a triangle on one side only, as around holes
    Global yielding = 0;   ///< vertices that give way for `room`
    double yields = 0;     ///< m, by how much at most
  };

  Local vertices() const { return Local(start_.size()); }
  std::span<const Element> elements() const { return elements_; }
  std::span<const Plane> planes() const { return planes_; }
  int bodies() const { return int(bodies_.size()); }
  bool all_rest() const; ///< none moves or changes its shape
  const Body& body(int k) const { return bodies_[k]; }
  bool empty() const { return bodies_.empty(); }
  int body_of(Local vertex) const { return body_of_[vertex]; }
  std::vector<std::array<Local, 3>> triangles_of(int body) const; ///< numbers of vertices of the body
  Local first_of(int body) const {                                ///< its first vertex
    return Local(std::find(body_of_.begin(), body_of_.end(), body) - body_of_.begin());
  }

  std::span<const Vec3> start() const { return start_; } ///< of all vertices, as the case gives them; m

  /// Where a point of a body is at `time` that is at `start` in the case, by its keyframes alone. m.
  Vec3 moved(int body, const Vec3& start, double time) const;

  /// A place that moves with a body: of one that changes its shape, in the frame of a triangle.
  struct Anchor {
    int body;
    Local element; ///< of the nearest triangle; -1 of a body that moves by its keyframes alone
    Vec3 in_frame; ///< m: in its frame, or as the case gives the body
  };
  /// That moves with a body from `place` (m) at time 0 on.
  Anchor anchor(int body, const Vec3& place) const;
  Vec3 follow(const Anchor& anchor, double time) const; ///< where it is, m

  /// The rotation of a body from one time to another, by its keyframes.
  Mat3 turned(int body, double from, double to) const;

  struct Nearest {
    int body = -1;
    double distance =
        HUGE_VAL; ///< m from its surface; negative inside of one with a radius, or behind a plane
  };
  /// From the surface that an element or a plane stands for, as above.
  double distance_to(const Element& element, const Vec3& place, std::span<const Vec3> positions) const;
  double distance_to(const Plane& plane, const Vec3& place, std::span<const Vec3> positions) const;

  /// The body nearest to a place, with the vertices of all at `positions` (m).
  Nearest nearest(const Vec3& place, std::span<const Vec3> positions) const;

  /// Whether bodies grow from slim to full (config::Obstacle::growth), and how far they have: `growth`, since
  /// a time, for all vertices.
  bool grow() const;
  void set_growth(BodyGrowth growth, double since);
  const std::optional<config::Growth>& growth_of(int body) const { return inputs_[body].growth; }
  double slimness(Local vertex, double time) const; ///< 1: as slim as can be, 0: full
  Vec3 way_to_slim(Local vertex) const;             ///< m, from where it is when the body is full

  /// Where all vertices are at `time`: in the sequence of the body's meshes, if it has one, then turned and
  /// moved by the keyframes; linear between meshes and between keyframes. m.
  void place(double time, std::vector<Vec3>& positions) const;

private:
  /// Of the vertices of one body, those from `first` on.
  struct Frames {
    Local first;
    double fps;
    std::vector<std::vector<Vec3>> positions; ///< of each mesh

    Vec3 at(Local vertex, double time) const;
  };
  void make_room(int body);
  void hold_back(MPI_Comm comm, const Case& input, int body);
  void make_slim(MPI_Comm comm, int body);
  Vec3 place_of(Local vertex, double time) const;
  Eigen::Affine3d frame_of(Local element, double time) const;
  void add_mesh(MPI_Comm comm, const Case& input, int body);
  void add(MPI_Comm comm, const Case& input, int body);
  void add_union(MPI_Comm comm, const Case& input, int body);
  void add_sheet(const config::Plane& plane, int body);
  Local add_vertex(int body, const Vec3& position);
  void add_triangles(std::span<const std::array<Local, 3>> triangles, int body);

  std::vector<config::Obstacle> inputs_;
  std::vector<Body> bodies_;
  std::vector<Vec3> start_;
  std::vector<int> body_of_;
  std::vector<Element> elements_;
  std::vector<Plane> planes_;
  std::map<int, Frames> frames_; ///< of bodies that have a sequence
  std::vector<Vec3> slim_;       ///< m, see ways_to_slim; of the vertices of bodies that grow
  BodyGrowth growth_;
  double grown_since_ = 0; ///< s
};

} // namespace taut
