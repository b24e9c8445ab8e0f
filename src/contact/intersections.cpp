#include "src/contact/intersections.hpp"

#include "src/contact/closest.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

namespace taut {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_3 point(const Vec3& x) { return {x[0], x[1], x[2]}; }

} // namespace

Intersections::Intersections(const Cloth& cloth, const Obstacles& obstacles)
    : cloth_(cloth), obstacles_(obstacles), search_(cloth, obstacles) {}

std::vector<Intersection> Intersections::find(std::span<const Vec3> cloth, std::span<const Vec3> obstacles) {
  found_.clear();
  search_.find({cloth, cloth, obstacles, obstacles}, 0.0, 0.0);
  for (const auto pairs : {search_.pairs(), search_.pairs_across()})
    for (const auto& [a, b] : pairs) compare(search_.element(a), search_.element(b));
  look_behind_planes();
  return found_;
}

void Intersections::compare(const Element& a, const Element& b) {
  if (b.is_triangle()) pierce(a, b);
  if (a.is_triangle()) pierce(b, a);
  if (b.body >= 0 && obstacles_.body(b.body).radius > 0) come_inside(a, b);
}

/// Every edge and every face meet once: the edge as part of the element that represents it.
void Intersections::pierce(const Element& edges, const Element& face) {
  const auto vertices = search_.vertices();
  const auto x = search_.positions();
  const auto& f = face.vertices;
  for (int k = 0; k < edges.corners; ++k) {
    if (!edges.represents_edge(k)) continue;
    const Local a = edges.vertices[k], b = edges.edge_end(k);
    bool apart = true;
    for (const Local v : f)
      apart = apart && vertices[v].joint != vertices[a].joint && vertices[v].joint != vertices[b].joint;
    if (apart && CGAL::do_intersect(Kernel::Segment_3(point(x[a]), point(x[b])),
                                    Kernel::Triangle_3(point(x[f[0]]), point(x[f[1]]), point(x[f[2]]))))
      add(a, b, face, std::max(edges.body, face.body));
  }
}

/// Of bodies with a radius: the distance to their core.
void Intersections::come_inside(const Element& cloth, const Element& body) {
  const auto x = search_.positions();
  const double radius = obstacles_.body(body.body).radius;
  double distance = HUGE_VAL;
  if (cloth.is_triangle())
    for (int k = 0; k < body.corners; ++k)
      distance = std::min(distance, closest_vertex_face({x[body.vertices[k]], x[cloth.vertices[0]],
                                                         x[cloth.vertices[1]], x[cloth.vertices[2]]})
                                        .distance);
  if (body.is_triangle())
    for (int k = 0; k < cloth.corners; ++k)
      distance = std::min(distance, closest_vertex_face({x[cloth.vertices[k]], x[body.vertices[0]],
                                                         x[body.vertices[1]], x[body.vertices[2]]})
                                        .distance);
  for (int k = 0; k < cloth.corners; ++k)
    for (int j = 0; j < body.corners; ++j)
      distance = std::min(distance, closest_edge_edge({x[cloth.vertices[k]], x[cloth.edge_end(k)],
                                                       x[body.vertices[j]], x[body.edge_end(j)]})
                                        .distance);
  if (distance < radius) add(cloth.vertices[0], cloth.vertices[1], body, body.body);
}

void Intersections::look_behind_planes() {
  const auto x = search_.positions();
  const Local first = cloth_.mesh.vertices.size();
  for (const Obstacles::Plane& plane : obstacles_.planes())
    for (Local i = 0; i < cloth_.mesh.vertices.owned; ++i)
      if (plane.normal.dot(x[i] - x[first + plane.point]) < obstacles_.body(plane.body).radius) {
        const Global key = search_.vertices()[i].key, on_plane = search_.vertices()[first + plane.point].key;
        found_.push_back({{key, key}, {on_plane, on_plane}, x[i], plane.body});
      }
}

void Intersections::add(Local first, Local first_end, const Element& second, int body) {
  const auto vertices = search_.vertices();
  found_.push_back({{vertices[first].key, vertices[first_end].key},
                    {vertices[second.vertices[0]].key, vertices[second.edge_end(0)].key},
                    search_.positions()[first],
                    body});
}

} // namespace taut
