#include "src/config/reader.hpp"
#include "src/config/suggest.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace taut {

namespace config {

Reader::Reader(const Spot& spot, const std::vector<std::string>& names) : map_(spot.tree), path_(spot.path) {
  if (map_.kind == Tree::Kind::nothing)
    spot.fail("expected a block of keys, found nothing; write {} for its defaults");
  if (map_.kind != Tree::Kind::map)
    fail_type(spot, fmt::format("a block of keys ({})", fmt::join(names, ", ")));
  for (const Entry& entry : map_.entries) {
    if (std::find(names.begin(), names.end(), entry.key) != names.end()) continue;
    const auto meant = nearest(entry.key, names);
    const std::string help = meant ? fmt::format("did you mean '{}'?", *meant)
                                   : fmt::format("known here: {}", fmt::join(names, ", "));
    throw InputError(fmt::format("{}: unknown key '{}' ({})", entry.place, entry.key, help));
  }
}

void Reader::exactly_one(std::initializer_list<std::string_view> names) {
  const auto is_one = [&](const Entry& e) {
    return std::find(names.begin(), names.end(), e.key) != names.end();
  };
  const auto overrides = [&](const Entry& e) { return e.origin == Origin::override && is_one(e); };
  if (std::any_of(map_.entries.begin(), map_.entries.end(), overrides))
    std::erase_if(map_.entries, [&](const Entry& e) { return e.origin == Origin::file && is_one(e); });

  const auto end = map_.entries.end();
  const auto first = std::find_if(map_.entries.begin(), end, is_one);
  if (first == end) fail(fmt::format("give one of the keys {}", fmt::join(names, ", ")));
  const auto second = std::find_if(first + 1, end, is_one);
  if (second != end)
    throw InputError(fmt::format("{}: {} and {} exclude each other; keep one", second->place,
                                 path_of(second->key), path_of(first->key)));
}

void Reader::check(std::string_view name, bool holds, std::string_view cure) const {
  if (holds) return;
  throw InputError(fmt::format("{}: {}: {}", find_deepest(map_, name).place, path_of(name), cure));
}

std::string Reader::path_of(std::string_view name) const {
  return path_.empty() ? std::string(name) : fmt::format("{}.{}", path_, name);
}

void Reader::fail(const std::string& message) const {
  throw InputError(path_.empty() ? fmt::format("{}: {}", map_.place, message)
                                 : fmt::format("{}: {}: {}", map_.place, path_, message));
}

void Reader::fail_missing(std::string_view name, const Key& key) const {
  fail(fmt::format("missing key '{}' ({}); add it", name, key.meaning));
}

namespace {

/// That of the file, or of the folder of a case.yaml: where it is, not how the path calls it.
std::string default_name(const std::filesystem::path& file) {
  std::error_code failed; // without a working folder, or without a name
  const std::filesystem::path whole = std::filesystem::absolute(file, failed).lexically_normal();
  const std::filesystem::path& place = failed ? file : whole;
  const std::string folder = place.parent_path().filename().string(), stem = place.stem().string();
  return stem != "case" || folder.empty() || folder == "." || folder == ".." ? stem : folder;
}

/// The material that stands before the keys of `material` are read; an unknown fabric is for the reader to
/// refuse.
template<class M>
M initial_material(const Tree& cloth) {
  M material;
  const Entry* name = cloth.find("fabric");
  if (const Fabric* fabric = name ? find_fabric(name->value.text) : nullptr) {
    material.density = fabric->density;
    material.bending = fabric->bending;
    material.shear = fabric->shear;
  }
  return material;
}

/// Whether a cloth is a garment.
bool has_pattern(const Tree& root) {
  const Entry *one = root.find("cloth"), *several = root.find("cloths");
  const auto is_garment = [](const Tree& cloth) { return cloth.find("pattern") != nullptr; };
  return (one && is_garment(one->value)) ||
         (several && std::any_of(several->value.items.begin(), several->value.items.end(), is_garment));
}

/// Whether a garment is to be worn until it rests.
bool wants_garment_at_rest(const Tree& root) {
  const Entry* time = root.find("time");
  return has_pattern(root) && time && time->value.find("until_rest");
}

/// The method that stands before its key is read: Newton's, unless something asks for what it does not do, or
/// is expensive with, as contact (Case::contact_model) is where rest is not asked for.
InextensibilityMethod initial_method(const Tree& root) {
  const Entry *contact = root.find("contact"), *obstacles = root.find("obstacles"),
              *keys = root.find("inextensibility");
  const Entry* model = contact ? contact->value.find("model") : nullptr;
  const bool has_contact =
      contact ? !model || model->value.text != "none" : obstacles && !obstacles->value.items.empty();
  const bool asks = root.find("velocity") || root.find("petsc") ||
                    (keys && (keys->value.find("solver") || keys->value.find("faces")));
  const bool is_expensive = has_contact && !wants_garment_at_rest(root);
  return is_expensive || asks ? InextensibilityMethod::fast_projection : InextensibilityMethod::newton;
}

} // namespace

void read(const Spot& spot, Gravity& value) {
  const auto& items = spot.tree.items;
  if (items.empty() || items.front().kind != Tree::Kind::map) {
    value.keyframes.assign(1, {});
    return read(spot, value.keyframes.front().value);
  }
  read(spot, value.keyframes);
}

void read(const Spot& spot, Cloth& value) {
  value.material = initial_material<Material>(spot.tree);
  read_keys(spot, value);
}

void read(const Spot& spot, Panel& value) {
  value.material = initial_material<PanelMaterial>(spot.tree);
  read_keys(spot, value);
}

} // namespace config

Case read_case(const std::string& text, const std::string& file_name, std::span<const Override> overrides) {
  using namespace config;
  Tree root = parse_case(text, file_name);
  for (const Override& o : overrides) apply_override(root, o.key, o.value);

  const std::filesystem::path file(file_name);
  Case input;
  input.name = default_name(file);
  input.file = file;
  input.inextensibility.method = initial_method(root);
  const Key whole;
  read(Spot{root, "", whole}, input);
  return input;
}

} // namespace taut
