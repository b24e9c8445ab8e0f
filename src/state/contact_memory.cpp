#include "src/state/contact_memory.hpp"

#include <algorithm>

namespace taut {

namespace {

struct Item {
  ContactKey key;
  ContactEntry entry;
};

int home_of(const DistributedMesh& mesh, const ContactKey& key) {
  return slab_rank(mesh.vertices.total, size_of(mesh.comm), lowest_vertex(key));
}

/// What items hold of one contact adds up, in the order they have.
ContactMemory added_up(std::vector<Item> items) {
  std::stable_sort(items.begin(), items.end(), [](const Item& a, const Item& b) { return a.key < b.key; });
  ContactMemory memory;
  memory.reserve(items.size());
  for (const Item& item : items) memory[item.key] += item.entry;
  return memory;
}

} // namespace

ContactImpulse& ContactImpulse::operator+=(const ContactImpulse& other) {
  normal += other.normal;
  tangent += other.tangent;
  return *this;
}

ContactEntry& ContactEntry::operator+=(const ContactEntry& other) {
  const double both = pressed.normal + other.pressed.normal;
  if (both > 0) drift += other.pressed.normal / both * (other.drift - drift);
  pressed += other.pressed;
  carried += other.carried;
  return *this;
}

Global lowest_vertex(const ContactKey& key) {
  Global lowest = key[0] < -1 ? -2 - key[0] : key[0];
  for (const Global vertex : key)
    if (vertex >= 0) lowest = std::min(lowest, vertex);
  return lowest;
}

ContactMemory bring_home(const DistributedMesh& mesh, const ContactMemory& entries) {
  std::vector<Item> sent;
  std::vector<int> homes;
  for (const auto& [key, entry] : entries) {
    sent.push_back({key, entry});
    homes.push_back(home_of(mesh, key));
  }
  return added_up(exchange(mesh.comm, sent, homes).items);
}

ContactMemory hand_out(const DistributedMesh& mesh, ContactMemory& at_home,
                       const std::vector<ContactKey>& keys) {
  std::vector<int> homes, askers;
  for (const ContactKey& key : keys) homes.push_back(home_of(mesh, key));
  const auto asked = exchange(mesh.comm, keys, homes);
  std::vector<ContactKey> demand = asked.items;
  std::sort(demand.begin(), demand.end());
  std::vector<Item> answers;
  for (int r = 0; r < size_of(mesh.comm); ++r)
    for (Global i = asked.offsets[r]; i < asked.offsets[r + 1]; ++i) {
      const ContactKey& key = asked.items[i];
      const auto found = at_home.find(key);
      if (found == at_home.end()) continue;
      const auto [first, last] = std::equal_range(demand.begin(), demand.end(), key);
      answers.push_back({key, found->second.scaled(1.0 / double(last - first))});
      askers.push_back(r);
    }
  const auto is_handed_out = [&](const auto& entry) {
    return std::binary_search(demand.begin(), demand.end(), entry.first);
  };
  at_home.erase(std::remove_if(at_home.begin(), at_home.end(), is_handed_out), at_home.end());
  return added_up(exchange(mesh.comm, answers, askers).items);
}

} // namespace taut
