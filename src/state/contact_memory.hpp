#pragma once
#include "partition/distributed_mesh.hpp"

#include <boost/container/flat_map.hpp>

#include <array>

/// What contacts did in the last step. An entry is known by the original numbers of its vertices and lives on
/// one rank, its *home*: the one whose slab of the vertices, in input order, holds the lowest of them. So
/// neither the partition nor which rank finds a contact matters, and each entry is there once.
namespace taut {

/// Names two features in contact, whichever pairs found them: the vertices in play, in an order of their own,
/// -1 for none. Cloth vertices have their original numbers, those of obstacles the numbers after them. Of two
/// edges, the first number n stands as -2 - n.
using ContactKey = std::array<Global, 4>;

/// What has been pressed and rubbed between two features: in newtons, or in kg m within a step, newtons times
/// the step squared.
struct ContactImpulse {
  double normal = 0;
  Vec3 tangent = Vec3::Zero();

  ContactImpulse scaled(double factor) const { return {normal * factor, tangent * factor}; }
  ContactImpulse& operator+=(const ContactImpulse& other);
};

struct ContactEntry {
  ContactImpulse pressed;    ///< N, by the last step
  ContactImpulse carried;    ///< N, what of it is in State::contact_force
  Vec3 drift = Vec3::Zero(); ///< m, from where they stick to each other to where they are

  /// A part of the forces; the drift is the same for each.
  ContactEntry scaled(double factor) const { return {pressed.scaled(factor), carried.scaled(factor), drift}; }
  /// The drift is the mean of both, by what pressed them.
  ContactEntry& operator+=(const ContactEntry& other);
};
using ContactMemory = boost::container::flat_map<ContactKey, ContactEntry>;

/// The lowest number of its vertices, which is of the cloth; -1 if it names none.
Global lowest_vertex(const ContactKey& key);

/// The entries whose home this rank is, from those of all ranks; what several ranks hold of one contact adds
/// up. The lowest vertices must be vertices of the cloth. Collective.
ContactMemory bring_home(const DistributedMesh& mesh, const ContactMemory& entries);

/// Takes the entries of `keys`, where there are such, out of their homes. One that several ranks ask for is
/// shared equally among them. Collective.
ContactMemory hand_out(const DistributedMesh& mesh, ContactMemory& at_home,
                       const std::vector<ContactKey>& keys);

} // namespace taut
