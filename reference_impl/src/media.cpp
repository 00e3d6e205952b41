#include "media.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace equilux {

bool is_medium(const World& world, int object) {
  const MaterialDescription& material = material_of(world, object);
  if (!(material.transparency > 0)) return false;
  switch (world.objects[static_cast<std::size_t>(object)].solid) {
    case Solid::sphere:
    case Solid::box:
    case Solid::cylinder_capped:
    case Solid::plane: return true;
    default: return material.ior != 1;
  }
}

double index_inside(const World& world, int object) {
  const double ior = material_of(world, object).ior;
  const auto inside_out = [&](const MeshObject& mesh) { return mesh.object == object && mesh.inside_out; };
  return std::any_of(world.meshes.begin(), world.meshes.end(), inside_out) ? 1 / ior : ior;
}

double Media::index(const World& world, int stack) const {
  return stack < 0 ? 1 : index_inside(world, entries_[static_cast<std::size_t>(stack)].object);
}

double Media::index_without(const World& world, int stack, int object) const {
  const Entry* top = stack < 0 ? nullptr : &entries_[static_cast<std::size_t>(stack)];
  return top != nullptr && top->object == object ? index(world, top->below) : index(world, stack);
}

bool Media::contains(int stack, int object) const {
  for (; stack >= 0; stack = entries_[static_cast<std::size_t>(stack)].below) {
    if (entries_[static_cast<std::size_t>(stack)].object == object) return true;
  }
  return false;
}

int Media::entered(int stack, int object) {
  entries_.push_back({object, stack});
  return static_cast<int>(entries_.size()) - 1;
}

int Media::left(int stack, int object) {
  if (!contains(stack, object)) return stack;
  const Entry top = entries_[static_cast<std::size_t>(stack)];
  return top.object == object ? top.below : entered(left(top.below, object), top.object);
}

namespace {

bool is_inside(Solid solid, const Vec3d& p) {  // in the canonical frame
  switch (solid) {
    case Solid::sphere: return dot(p, p) < 1;
    case Solid::plane: return p.z < 0;
    case Solid::box: return largest(p) < 1;
    case Solid::cylinder_capped: return p.x * p.x + p.y * p.y < 1 && std::fabs(p.z) < 1;
    default: return false;
  }
}

}  // namespace

int Media::around(const World& world, const Vec3dd& origin) {
  std::vector<std::pair<double, int>> inside;  // 1 / volume, which sorts the largest first
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    const Object& object = world.objects[i];
    const int index = static_cast<int>(i);
    if (!is_medium(world, index) || object.solid == Solid::mesh) continue;
    if (!is_inside(object.solid, to_double(object.to_canonical_linear * origin + object.exact.eye))) continue;
    inside.emplace_back(object.solid == Solid::plane ? 0 : std::fabs(to_double(determinant(object.to_canonical_linear))), index);
  }
  std::sort(inside.begin(), inside.end());
  int stack = -1;
  for (const auto& [reciprocal_volume, object] : inside) stack = entered(stack, object);
  return stack;
}

}  // namespace equilux
