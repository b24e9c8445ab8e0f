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

} // namespace

Pressed& Pressed::operator+=(const Pressed& other) {
  normal += other.normal;
  tangent += other.tangent;
  return *this;
}

ContactEntry& ContactEntry::operator+=(const ContactEntry& other) {
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
  ContactMemory at_home;
  for (const Item& item : exchange(mesh.comm, sent, homes).items) at_home[item.key] += item.entry;
  return at_home;
}

ContactMemory hand_out(const DistributedMesh& mesh, ContactMemory& at_home,
                       const std::vector<ContactKey>& keys) {
  std::vector<int> homes, askers;
  for (const ContactKey& key : keys) homes.push_back(home_of(mesh, key));
  const auto asked = exchange(mesh.comm, keys, homes);
  std::map<ContactKey, int> demand;
  for (const ContactKey& key : asked.items) ++demand[key];
  std::vector<Item> answers;
  for (int r = 0; r < size_of(mesh.comm); ++r)
    for (Global i = asked.offsets[r]; i < asked.offsets[r + 1]; ++i) {
      const ContactKey& key = asked.items[i];
      const auto found = at_home.find(key);
      if (found == at_home.end()) continue;
      answers.push_back({key, found->second.scaled(1.0 / demand[key])});
      askers.push_back(r);
    }
  for (const ContactKey& key : asked.items) at_home.erase(key);
  ContactMemory mine;
  for (const Item& item : exchange(mesh.comm, answers, askers).items) mine.emplace(item.key, item.entry);
  return mine;
}

} // namespace taut
